// The self-test of exported C; see export.h.
//
// Templates of C: @ stands for the model's name, $ for the same in capitals.
#include "codegen/export.h"
#include "codegen/export_text.h"

#include "codegen/c.h"
#include "expr/print.h"

static const char text_run[]
    = "/* The time and q, eleven times. */\n"
      "static int run(double duration, int nstep)\n"
      "{\n"
      "    static double in[$_NINPUT], work[$_NWORK];\n"
      "    int i, k;\n"
      "    for (i = 0; i < $_NINPUT; i++)\n"
      "        in[i] = @_start[i];\n"
      "    for (k = 0; k <= 10 * nstep; k++) {\n"
      "        if (k % nstep == 0) {\n"
      "            printf(\"%.17g\", in[$_T]);\n"
      "            for (i = 0; i < $_NQ; i++)\n"
      "                printf(\",%.17g\", in[$_Q + i]);\n"
      "            putchar('\\n');\n"
      "        }\n"
      "        if (k < 10 * nstep && @_step(in, duration / (10.0 * nstep), work)) {\n"
      "            printf(\"no step at t = %.17g\\n\", in[$_T]);\n"
      "            return 1;\n"
      "        }\n"
      "    }\n"
      "    return 0;\n"
      "}\n"
      "\n";

static const char text_compare[]
    = "static int compare(const char *what, const double *got, const double *want, int n,\n"
      "                   double tolerance)\n"
      "{\n"
      "    double scale = 1;\n"
      "    int i, wrong = 0;\n"
      "    for (i = 0; i < n; i++)\n"
      "        scale = fabs(want[i]) > scale ? fabs(want[i]) : scale;\n"
      "    for (i = 0; i < n; i++)\n"
      "        if (!(fabs(got[i] - want[i]) <= tolerance * scale) && !(isnan(got[i]) && "
      "isnan(want[i]))) {\n"
      "            printf(\"%s[%d]: got %.17g, wanted %.17g\\n\", what, i, got[i], want[i]);\n"
      "            wrong++;\n"
      "        }\n"
      "    return wrong;\n"
      "}\n"
      "\n";

static const char text_lanes[]
    = "static void take_lane(const double *all, int lane, int n, double *one)\n"
      "{\n"
      "    int i;\n"
      "    for (i = 0; i < n; i++)\n"
      "        one[i] = all[$_LANES * i + lane];\n"
      "}\n"
      "\n"
      "static int compare_lanes(void)\n"
      "{\n"
      "    enum { most = $_NMOTION + $_NCONSTRAINT + 1 };\n"
      "    static double in[$_LANES * $_NINPUT], out[$_LANES * most], one[most];\n"
      "    int i, k, l, wrong = 0;\n"
      "    for (k = 0; k < nstate; k++) {\n"
      "        for (i = 0; i < $_NINPUT; i++)\n"
      "            for (l = 0; l < $_LANES; l++)\n"
      "                in[$_LANES * i + l] = input[(k + l) % nstate][i];\n"
      "        @_motion_lanes(in, out);\n"
      "        for (l = 0; l < $_LANES; l++) {\n"
      "            take_lane(out, l, $_NMOTION, one);\n"
      "            wrong += compare(\"motion in a lane\", one, motion[(k + l) % nstate], "
      "$_NMOTION, 1e-12);\n"
      "        }\n"
      "        @_constraint_lanes(in, out);\n"
      "        for (l = 0; l < $_LANES; l++) {\n"
      "            take_lane(out, l, $_NCONSTRAINT, one);\n"
      "            wrong += compare(\"constraint in a lane\", one, constraint[(k + l) % "
      "nstate],\n"
      "                             $_NCONSTRAINT, 1e-12);\n"
      "        }\n"
      "    }\n"
      "    return wrong;\n"
      "}\n"
      "\n";

static const char text_values[]
    = "/* Programs: the library's sines may differ in the last bit elsewhere; sums of n terms "
      "magnify that. Accelerations and\n"
      " * what follows from them are the results of a solve by another elimination. */\n"
      "static int compare_state(int k)\n"
      "{\n"
      "    static double out[$_NMOTION + $_NCONSTRAINT + $_NOUTPUT + $_NROOT + $_NREACTION + "
      "1],\n"
      "        a[$_NU + $_NROW + 1], in[$_NINPUT], work[$_NWORK];\n"
      "    int i, wrong = 0;\n"
      "    @_motion(input[k], out);\n"
      "    wrong += compare(\"motion\", out, motion[k], $_NMOTION, 1e-12);\n"
      "    @_constraint(input[k], out);\n"
      "    wrong += compare(\"constraint\", out, constraint[k], $_NCONSTRAINT, 1e-12);\n"
      "    @_accelerations(input[k], a, work);\n"
      "    wrong += compare(\"acceleration\", a, acceleration[k], $_NU, 1e-8);\n"
      "    wrong += @_multipliers(input[k], a, work) != 0;\n"
      "    wrong += compare(\"multiplier\", a, multiplier[k], $_NROW, 1e-8);\n"
      "    @_outputs(input[k], out);\n"
      "    wrong += compare(\"output\", out, output[k], $_NOUTPUT, 1e-8);\n"
      "    wrong += @_reactions(input[k], out, work) != 0;\n"
      "    wrong += compare(\"reaction\", out, reaction[k], $_NREACTION, 1e-8);\n"
      "    @_roots(input[k], out);\n"
      "    wrong += compare(\"root\", out, root[k], $_NROOT, 1e-12);\n"
      "    for (i = 0; i < $_NINPUT; i++)\n"
      "        in[i] = input[k][i];\n"
      "    for (i = 0; i < $_NROOT; i++)\n"
      "        if (fabs(out[i]) > 0)\n"
      "            in[$_MODE + i] = 1 - in[$_MODE + i];\n"
      "    @_switch(in);\n"
      "    for (i = 0; i < $_NROOT; i++)\n"
      "        if (fabs(out[i]) > 0)\n"
      "            wrong += compare(\"switch\", in + $_MODE + i, input[k] + $_MODE + i, 1, "
      "0);\n"
      "    for (i = 0; i < $_NPARAMETER; i++)\n"
      "        in[$_PARAMETER + i] = raw[k][i];\n"
      "    @_parameters(in);\n"
      "    wrong += compare(\"parameter\", in + $_PARAMETER, parameter[k], $_NPARAMETER, "
      "1e-12);\n"
      "    return wrong;\n"
      "}\n"
      "\n"
      "/* A state off the constraints by some 1e-4 comes back to them. */\n"
      "static int compare_projection(void)\n"
      "{\n"
      "    static double in[$_NINPUT], out[$_NCONSTRAINT + 1], work[$_NWORK];\n"
      "    static const double zero[2 * $_NROW + 1] = {0};\n"
      "    int i;\n"
      "    for (i = 0; i < $_NINPUT; i++)\n"
      "        in[i] = @_start[i];\n"
      "    for (i = 0; i < $_NQ + $_NU; i++)\n"
      "        in[$_Q + i] += 1e-4 * (1 + i % 3);\n"
      "    if (@_project(in, work)) {\n"
      "        printf(\"projection: no state meets the constraints\\n\");\n"
      "        return 1;\n"
      "    }\n"
      "    @_constraint(in, out);\n"
      "    return compare(\"projection\", out, zero, 2 * $_NROW, closed);\n"
      "}\n"
      "\n";

static const char text_motion[]
    = "/* The motion from the start, against one computed by another method with a tight "
      "tolerance. */\n"
      "static int compare_motion(void)\n"
      "{\n"
      "    enum { ny = $_NQ + $_NU };\n"
      "    static double in[$_NINPUT], work[$_NWORK];\n"
      "    double largest[ny + 1];\n"
      "    int i, j, k, wrong = 0;\n"
      "    for (j = 0; j < ny; j++) {\n"
      "        largest[j] = 0;\n"
      "        for (i = 0; i < nsample; i++)\n"
      "            largest[j] = fmax(largest[j], fabs(sample[i * ny + j]));\n"
      "    }\n"
      "    for (i = 0; i < $_NINPUT; i++)\n"
      "        in[i] = @_start[i];\n"
      "    for (i = 0; i < nsample; i++) {\n"
      "        for (k = 0; k < nstep; k++)\n"
      "            if (@_step(in, duration / (nstep * (double)nsample), work)) {\n"
      "                printf(\"motion: no step at t = %.17g\\n\", in[$_T]);\n"
      "                return wrong + 1;\n"
      "            }\n"
      "        for (j = 0; j < ny; j++) {\n"
      "            const double got = in[$_Q + j], want = sample[i * ny + j];\n"
      "            if (!(fabs(got - want) <= drift * (1 + largest[j]))) {\n"
      "                printf(\"motion at t = %.17g, %d: got %.17g, wanted %.17g\\n\", "
      "in[$_T], j, got, want);\n"
      "                wrong++;\n"
      "            }\n"
      "        }\n"
      "    }\n"
      "    return wrong;\n"
      "}\n"
      "\n";

static const char text_main[] = "int main(int argc, char **argv)\n"
                                "{\n"
                                "    const int n = argc > 2 ? atoi(argv[2]) : 100;\n"
                                "    int k, wrong = 0;\n"
                                "    if (argc > 1)\n"
                                "        return run(atof(argv[1]), n > 0 ? n : 1);\n"
                                "    for (k = 0; k < nstate; k++)\n"
                                "        wrong += compare_state(k);\n"
                                "    wrong += compare_projection();\n"
                                "    wrong += compare_motion();\n";

static const char text_end[] = "    printf(\"%d states, %d values wrong\\n\", nstate, wrong);\n"
                               "    return wrong != 0;\n"
                               "}\n";

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
    ct_export_put_named(t, text_motion);
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
    ct_export_put_named(&t, text_run);
    ct_export_put_named(&t, text_compare);
    ct_export_put_named(&t, text_values);
    put_motion(&t, x);
    if (x->lanes > 1)
        ct_export_put_named(&t, text_lanes);
    ct_export_put_named(&t, text_main);
    if (x->lanes > 1)
        ct_export_put(&t, "    wrong += compare_lanes();\n");
    ct_export_put_named(&t, text_end);
    return ct_export_finish(&t);
}
