// What every test program needs: cmocka with the headers it wants before it, and CHECK_CLOSE.
#ifndef CT_TESTS_CHECK_H
#define CT_TESTS_CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

/// |got - want| <= atol + rtol |want|. Say beside each use where the tolerances come from.
#define CHECK_CLOSE(got, want, rtol, atol)                                                     \
    check_close((got), (want), (rtol), (atol), __FILE__, __LINE__)

static inline void check_close(double got, double want, double rtol, double atol,
                               const char *file, int line)
{
    if (fabs(got - want) <= atol + rtol * fabs(want)) // false for NaN
        return;
    print_error("got %.17g, wanted %.17g, difference %.3g\n", got, want, got - want);
    _fail(file, line);
}

#endif
