// The self-test of exported C; see export.h.
#include "codegen/export.h"
#include "codegen/export_text.h"
#include "codegen/export_test_text.h"

#include "codegen/c.h"
#include "expr/print.h"

static void put_recorded(struct ct_export_text *t, const char *what, size_t n, size_t k,
                         const double *v)
{
    ct_export_putf(t, "static const double %s%zu[] = ", what, k);
    ct_export_put_numbers(t, v, n);
    ct_export_put(t, ";\n");
}

static void put_list(struct ct_export_text *t, const char *what, size_t n)
{
    ct_export_putf(t, "static const double *const %s[] = {", what);
    for (size_t k = 0; k < n; k++)
        ct_export_putf(t, "%s%s%zu", k ? ", " : "", what, k);
    ct_export_put(t, "};\n");
}

static void put_states(struct ct_export_text *t, const struct ct_export *x)
{
    static const char *const lists[]
        = {"input",  "motion", "constraint", "acceleration", "multiplier",
           "output", "root",   "reaction",   "raw",          "parameter"};
    for (size_t k = 0; k < x->nstate; k++) {
        const struct ct_export_state *s = &x->state[k];
        put_recorded(t, "input", x->ninput, k, s->input);
        put_recorded(t, "motion", x->motion->nout, k, s->motion);
        put_recorded(t, "constraint", x->constraint->nout, k, s->constraint);
        put_recorded(t, "acceleration", x->e->nu, k, s->a);
        put_recorded(t, "multiplier", x->e->nrow, k, s->lam);
        put_recorded(t, "output", x->output->nout, k, s->output);
        put_recorded(t, "root", x->root->nout, k, s->root);
        put_recorded(t, "reaction", x->reaction->nout, k, s->reaction);
        put_recorded(t, "raw", x->at_q - 1, k, s->raw);
        put_recorded(t, "parameter", x->at_q - 1, k, s->parameter);
    }
    for (size_t i = 0; i < COUNT(lists); i++)
        put_list(t, lists[i], x->nstate);
    ct_export_putf(t, "enum { nstate = %zu };\n", x->nstate);
}

static void put_motion(struct ct_export_text *t, const struct ct_export *x)
{
    const struct ct_export_motion *r = &x->run;
    if (!r->nsample) {
        ct_export_put(t, "/* No motion is recorded: none could be computed. */\n"
                         "static int compare_motion(void)\n{\n    return 0;\n}\n\n");
        return;
    }
    ct_export_putf(t, "enum { nsample = %zu, nstep = %ld };\n", r->nsample, r->nstep);
    ct_export_putf(t, "static const double duration = %s, drift = %s;\n",
                   ct_number_c(t->arena, r->duration), ct_number_c(t->arena, r->tolerance));
    ct_export_put(t, "static const double sample[] = ");
    ct_export_put_numbers(t, r->y, r->nsample * (x->e->nq + x->e->nu));
    ct_export_put(t, ";\n\n");
    ct_export_put_lines(t, text_motion);
}

const char *ct_export_test(struct ct_arena *a, const struct ct_export *x)
{
    struct ct_export_text t = {.arena = a, .name = x->name};
    ct_export_putf(
        &t,
        "/* %s: compares with recorded values and a recorded motion; with a duration [s] and a "
        "tenth of\n"
        " * the number of steps, prints a motion from the start.\n *\n"
        " *     cc -std=c99 -O2 -o %s_test %s_test.c %s.c -lm && ./%s_test\n"
        " *     ./%s_test 1.5 100\n */\n",
        ct_c_comment(a, x->title), x->name, x->name, x->name, x->name, x->name);
    ct_export_putf(
        &t,
        "#include \"%s.h\"\n\n#include <math.h>\n#include <stdio.h>\n#include <stdlib.h>\n\n",
        x->name);
    put_states(&t, x);
    ct_export_putf(&t, "static const double closed = %s; /* constraints, [m] and [rad] */\n\n",
                   ct_number_c(a, x->closed));
    ct_export_put_lines(&t, text_run);
    ct_export_put_lines(&t, text_compare);
    ct_export_put_lines(&t, text_values);
    put_motion(&t, x);
    if (x->lanes > 1)
        ct_export_put_lines(&t, text_lanes);
    ct_export_put_lines(&t, text_main);
    if (x->lanes > 1)
        ct_export_put(&t, "    wrong += compare_lanes();\n");
    ct_export_put_lines(&t, text_end);
    return ct_export_finish(&t);
}
