// The source of an FMU around exported C; see export.h. Names and signatures are those of FMI 2.0
// and 3.0.
//
// The source is one file that includes NAME.c. An instance is `in` with its workspace. The value
// reference of a value is its index in `in`; then follow derivatives of states, outputs, event
// indicators.
//
// Source: Modelica Association, Functional Mock-up Interface, versions 2.0 and 3.0; key fmi2022.
#include "codegen/export.h"
#include "codegen/export_text.h"
#include "codegen/export_fmi2_text.h"
#include "codegen/export_fmi3_text.h"
#include "codegen/export_fmu_text.h"

#include "codegen/c.h"
#include "expr/print.h"

static void put_preamble(struct ct_export_text *t, int version)
{
    ct_export_putf(
        t,
        "/* The functions of FMI %d.0 for model exchange and co-simulation. */\n"
        "%s"
        "#include <stddef.h>\n"
        "%s"
        "#include <stdlib.h>\n"
        "#include <string.h>\n"
        "\n"
        "#ifdef FMI%d_FUNCTION_PREFIX /* for linking several models into one program */\n"
        "#define PASTE(a, b) a##b\n"
        "#define NAME_OF(a, b) PASTE(a, b)\n"
        "#define F(name) NAME_OF(FMI%d_FUNCTION_PREFIX, name)\n"
        "#define API\n"
        "#else\n"
        "#define F(name) name\n"
        "#ifdef _WIN32\n"
        "#define API __declspec(dllexport)\n"
        "#elif defined(__GNUC__)\n"
        "#define API __attribute__((visibility(\"default\")))\n"
        "#else\n"
        "#define API\n"
        "#endif\n"
        "#endif\n"
        "\n",
        version, version == 3 ? "#include <stdbool.h>\n" : "",
        version == 3 ? "#include <stdint.h>\n" : "", version, version);
}

static void put_flags(struct ct_export_text *t, const char *name, const int *v, size_t n)
{
    ct_export_putf(t, "static const int %s[] = ", name);
    ct_export_put_integers(t, v, n);
    ct_export_put(t, ";\n");
}

// For each parameter, inputs included: can it be set, and is it an input?
static void put_parameters(struct ct_export_text *t, const struct ct_export *x)
{
    const size_t n = x->at_q - 1;
    int *settable = CT_NEWN(t->arena, int, n + 1), *is_input = CT_NEWN(t->arena, int, n + 1);
    for (size_t i = 0; i < x->parameters.n; i++) {
        const struct ct_export_item *p = &x->parameters.item[i];
        settable[p->index - 1] = !p->is_derived && !p->is_fixed;
    }
    for (size_t i = 0; i < x->inputs.n; i++)
        settable[x->inputs.item[i].index - 1] = is_input[x->inputs.item[i].index - 1] = 1;
    put_flags(t, "settable", settable, n);
    put_flags(t, "is_input", is_input, n);
}

static void put_program(struct ct_export_text *t, const char *name, const struct ct_listing *l)
{
    const struct ct_c_options o = {.name = ct_arena_printf(t->arena, "%s_%s", t->name, name),
                                   .title = name,
                                   .is_static = true};
    ct_export_put(t, ct_c_listing(t->arena, l, &o));
    ct_export_put(t, "\n");
}

const char *ct_export_fmu(struct ct_arena *a, const struct ct_export *x,
                          const struct ct_export_fmu *f)
{
    struct ct_export_text t = {.arena = a, .name = x->name};
    ct_export_putf(&t, "/* %s: the model of %s.c as an FMU. */\n", ct_c_comment(a, x->title),
                   x->name);
    put_preamble(&t, f->version);
    ct_export_put_lines(&t, f->version == 2 ? text_fmi2_types : text_fmi3_types);
    ct_export_putf(&t, "#include \"%s.c\"\n\n", x->name);
    ct_export_putf(&t, "enum { has_power = %d };\n", x->power != NULL);
    ct_export_putf(&t, "static const char token[] = \"%s\";\n", f->token);
    ct_export_putf(&t,
                   "static const double share_of_steps = %s; /* of the tolerance */\n"
                   "static const double default_tolerance = %s;\n",
                   ct_number_c(a, f->share), ct_number_c(a, f->share * f->tolerance));
    put_parameters(&t, x);
    ct_export_put(&t, "\n");
    put_program(&t, "along", f->along);
    put_program(&t, "along_outputs", f->along_outputs);
    ct_export_put_lines(&t, x->e->nmemory ? text_start_memory : text_no_start_memory);
    if (!ct_export_has_events(x)) {
        ct_export_put_next_stop(&t, 0);
        ct_export_put_lines(&t, text_no_events);
    }
    ct_export_put_lines(&t, ct_export_has_events(x) ? text_separate_events
                                                    : text_no_separate_events);
    ct_export_put_lines(&t, text_instance);
    ct_export_put_lines(&t, f->is_direct ? text_change_of_open_chain : text_change_by_solving);
    ct_export_put_lines(&t, text_directions);
    ct_export_put_lines(&t, f->version == 2 ? text_fmi2_functions : text_fmi3_functions);
    return ct_export_finish(&t);
}
