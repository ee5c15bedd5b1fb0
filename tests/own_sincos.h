// Generated C calls sin and cos of the C library; the tape has its own (expr/sincos.h), right to
// the last place as well, but not to the same bits. To compare everything else bit for bit,
// compiled C is given those of the tape.
#ifndef CT_TEST_OWN_SINCOS_H
#define CT_TEST_OWN_SINCOS_H

#include "expr/sincos.h"
#include "tests/check.h"

#include <dlfcn.h>
#include <string.h>

/// Goes before the generated text.
static const char own_sincos[] = "#include <math.h>\n"
                                 "void (*tape_sincos)(double a, double *s, double *c);\n"
                                 "double own_sin(double a);\n"
                                 "double own_cos(double a);\n"
                                 "double own_sin(double a)\n"
                                 "{\n"
                                 "    double s, c;\n"
                                 "    tape_sincos(a, &s, &c);\n"
                                 "    return s;\n"
                                 "}\n"
                                 "double own_cos(double a)\n"
                                 "{\n"
                                 "    double s, c;\n"
                                 "    tape_sincos(a, &s, &c);\n"
                                 "    return c;\n"
                                 "}\n"
                                 "#define sin own_sin\n"
                                 "#define cos own_cos\n";

/// After dlopen.
static inline void own_sincos_set(void *handle)
{
    void (*const own)(double, double *, double *) = ct_sincos;
    void *place = dlsym(handle, "tape_sincos");
    assert_non_null(place);
    memcpy(place, &own, sizeof own);
}

#endif
