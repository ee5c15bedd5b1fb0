// Equations of motion as C source; see export.h.
#include "codegen/export.h"

#include "codegen/c.h"
#include "expr/print.h"

#include <stdio.h>
#include <string.h>

struct text {
    struct ct_arena *arena;
    const char *name;
    char *s;
    size_t n, cap;
};

// ---- text -------------------------------------------------------------------------------------

static void put(struct text *t, const char *s)
{
    for (; *s; s++)
        CT_PUSH(t->arena, t->s, t->n, t->cap, *s);
}

static void __attribute__((format(printf, 2, 3))) putf(struct text *t, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    put(t, ct_arena_vprintf(t->arena, fmt, ap));
    va_end(ap);
}

// Text with the name in place of each @, in capitals in place of each $.
static void put_named(struct text *t, const char *s)
{
    for (; *s; s++) {
        if (*s != '@' && *s != '$') {
            CT_PUSH(t->arena, t->s, t->n, t->cap, *s);
            continue;
        }
        for (const char *c = t->name; *c; c++) {
            const bool small = *c >= 'a' && *c <= 'z';
            CT_PUSH(t->arena, t->s, t->n, t->cap,
                    *s == '$' && small ? (char)(*c - 'a' + 'A') : *c);
        }
    }
}

static const char *finish(struct text *t)
{
    CT_PUSH(t->arena, t->s, t->n, t->cap, '\0');
    return t->s;
}

// A comment may not end early.
static const char *comment_text(struct ct_arena *a, const char *s)
{
    char *copy = ct_arena_strdup(a, s);
    for (char *c = copy; *c; c++)
        if (*c == '*' || *c == '\n' || *c == '\\')
            *c = ' ';
    return copy;
}

// ---- header -----------------------------------------------------------------------------------

static void put_constant(struct text *t, const char *name, size_t value, const char *comment)
{
    put_named(t, "    $_");
    putf(t, "%s = %zu,%s%s%s\n", name, value, *comment ? " /* " : "", comment,
         *comment ? " */" : "");
}

static void put_layout(struct text *t, const struct ct_export *x)
{
    const struct ct_equations *e = x->e;
    put(t, "enum {\n");
    put_constant(t, "NQ", e->nq, "coordinates");
    put_constant(t, "NU", e->nu, "speeds");
    put_constant(t, "NROW", e->nrow, "constraints");
    put_constant(t, "NM", e->nM, "entries of M, lower triangle");
    put_constant(t, "NJ", e->nJ, "entries of J");
    put(t, "\n    /* in[] */\n");
    put_constant(t, "T", 0, "time");
    put_constant(t, "PARAMETER", 1, "the model's parameters");
    put_constant(t, "Q", x->at_q, "coordinates");
    put_constant(t, "U", x->at_u, "speeds");
    put_constant(t, "MODE", x->at_switch, "sides of comparisons, 0 or 1");
    put_constant(t, "MEMORY", x->at_memory, "angles and rotations followed from step to step");
    put_constant(t, "NINPUT", x->ninput, "");
    put(t, "\n    /* out[] of motion */\n");
    put_constant(t, "OUT_M", 0, "");
    put_constant(t, "OUT_Q", e->nM, "");
    put_constant(t, "OUT_J", e->nM + e->nu, "");
    put_constant(t, "OUT_GAM", e->nM + e->nu + e->nJ, "");
    put_constant(t, "OUT_RATE", e->nM + e->nu + e->nJ + e->nrow, "derivatives of q");
    put_constant(t, "NMOTION", x->motion->nout, "");
    put(t, "\n    /* out[] of constraint */\n");
    put_constant(t, "OUT_PHI", 0, "");
    put_constant(t, "OUT_V", e->nrow, "");
    put_constant(t, "OUT_J2", 2 * e->nrow, "J again");
    put_constant(t, "NCONSTRAINT", x->constraint->nout, "");
    if (x->lanes > 1)
        put_constant(t, "LANES", x->lanes, "inputs side by side");
    put(t, "\n    /* doubles of work for accelerations */\n");
    const size_t n = e->nu + e->nrow, all = x->motion->nout + n * (n + 2);
    const size_t fixed = x->solved ? x->solved->nout : 0;
    put_constant(t, "NWORK", all > fixed ? all : fixed, "");
    put(t, "};\n\n");
}

// What the inputs are called in the model.
static void put_names(struct text *t, const struct ct_export *x)
{
    const struct ct_equations *e = x->e;
    put(t, "/* in[] by name:\n");
    for (size_t i = 0; i < e->x->nsym; i++)
        if (e->x->sym[i].kind == CT_SYM_PARAM)
            putf(t, " *   %4zu  %s\n", 1 + (size_t)e->x->sym[i].index,
                 comment_text(t->arena, e->x->sym[i].name));
    for (size_t i = 0; i < e->nq; i++)
        putf(t, " *   %4zu  %s\n", x->at_q + i, comment_text(t->arena, e->q[i].name));
    for (size_t i = 0; i < e->nu; i++)
        putf(t, " *   %4zu  %s\n", x->at_u + i, comment_text(t->arena, e->u[i].name));
    put(t, " */\n");
}

const char *ct_export_header(struct ct_arena *a, const struct ct_export *x)
{
    struct text t = {.arena = a, .name = x->name};
    putf(&t, "/* %s: equations of motion\n", comment_text(a, x->title));
    put_named(&t, " *\n"
                  " *     M(q, t) u' = Q(q, u, t) + J(q, t)' lam\n"
                  " *     phi(q, t) = 0,   v = J u + phi_t = 0,   J u' + gam = 0\n"
                  " *\n"
                  " * SI units and radians. Entry k of M stands at row @_M_row[k], column\n"
                  " * @_M_column[k] and, being symmetric, at the mirrored place; J likewise.\n"
                  " */\n"
                  "#ifndef $_H\n#define $_H\n\n"
                  "#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n");
    put_layout(&t, x);
    put_names(&t, x);
    put_named(
        &t, "\n"
            "extern const int @_M_row[], @_M_column[], @_J_row[], @_J_column[];\n"
            "/* Inputs at the start. */\n"
            "extern const double @_start[$_NINPUT];\n\n"
            "void @_motion(const double *in, double *out);\n"
            "void @_constraint(const double *in, double *out);\n"
            "/* u' [$_NU] at in; work [$_NWORK]. Redundant rows do no harm. Returns the rank\n"
            " * of the equations for u' and lam. */\n"
            "int @_accelerations(const double *in, double *a, double *work);\n\n");
    if (x->lanes > 1)
        put_named(&t, "/* The programs for $_LANES inputs side by side: entry i of lane l at "
                      "$_LANES * i + l. */\n"
                      "void @_motion_lanes(const double *in, double *out);\n"
                      "void @_constraint_lanes(const double *in, double *out);\n\n");
    put_named(&t, "#ifdef __cplusplus\n}\n#endif\n\n#endif\n");
    return finish(&t);
}

// ---- source -----------------------------------------------------------------------------------

static void put_indices(struct text *t, const char *name, const struct ct_entry *entry,
                        size_t n, bool rows)
{
    put_named(t, "const int @_");
    putf(t, "%s[] = {", name);
    for (size_t k = 0; k < n; k++)
        putf(t, "%s%d,", k % 16 ? " " : "\n    ", rows ? entry[k].row : entry[k].column);
    put(t, n ? "\n};\n" : "0};\n");
}

static void put_numbers(struct text *t, const double *v, size_t n)
{
    put(t, "{");
    for (size_t k = 0; k < n; k++)
        putf(t, "%s%s,", k % 4 ? " " : "\n    ", ct_number_c(t->arena, v[k]));
    put(t, n ? "\n}" : "0}");
}

// [M -J'; J 0] [u'; lam] = [Q; -gam] by elimination with complete pivoting. What cannot be
// eliminated are multipliers that redundant rows leave open; they are set to zero.
static const char solver[]
    = "int @_accelerations(const double *in, double *a, double *work)\n"
      "{\n"
      "    enum { n = $_NU + $_NROW, m = n + 1 };\n"
      "    double *const out = work, *const K = work + $_NMOTION, *const x = K + n * m;\n"
      "    double largest = 0;\n"
      "    int row[n + 1], column[n + 1], i, j, k, rank = fixed_pivots(in, a, work);\n"
      "    if (rank)\n"
      "        return rank;\n"
      "    @_motion(in, out);\n"
      "    for (i = 0; i < n * m; i++)\n"
      "        K[i] = 0;\n"
      "    for (k = 0; k < $_NM; k++) {\n"
      "        K[@_M_row[k] * m + @_M_column[k]] = out[$_OUT_M + k];\n"
      "        K[@_M_column[k] * m + @_M_row[k]] = out[$_OUT_M + k];\n"
      "    }\n"
      "    for (k = 0; k < $_NJ; k++) {\n"
      "        K[($_NU + @_J_row[k]) * m + @_J_column[k]] = out[$_OUT_J + k];\n"
      "        K[@_J_column[k] * m + $_NU + @_J_row[k]] = -out[$_OUT_J + k];\n"
      "    }\n"
      "    for (k = 0; k < $_NU; k++)\n"
      "        K[k * m + n] = out[$_OUT_Q + k];\n"
      "    for (k = 0; k < $_NROW; k++)\n"
      "        K[($_NU + k) * m + n] = -out[$_OUT_GAM + k];\n"
      "    for (i = 0; i < n; i++)\n"
      "        row[i] = column[i] = i;\n"
      "    for (rank = 0; rank < n; rank++) {\n"
      "        int r = rank, c = rank, keep;\n"
      "        double pivot = 0;\n"
      "        for (i = rank; i < n; i++)\n"
      "            for (j = rank; j < n; j++)\n"
      "                if (fabs(K[row[i] * m + column[j]]) > pivot) {\n"
      "                    pivot = fabs(K[row[i] * m + column[j]]);\n"
      "                    r = i;\n"
      "                    c = j;\n"
      "                }\n"
      "        largest = pivot > largest ? pivot : largest;\n"
      "        if (!(pivot > 1e-12 * largest)) /* rounding of n eliminations */\n"
      "            break;\n"
      "        keep = row[r], row[r] = row[rank], row[rank] = keep;\n"
      "        keep = column[c], column[c] = column[rank], column[rank] = keep;\n"
      "        for (i = rank + 1; i < n; i++) {\n"
      "            double *const to = K + row[i] * m, *const from = K + row[rank] * m;\n"
      "            const double f = to[column[rank]] / from[column[rank]];\n"
      "            if (f == 0)\n"
      "                continue;\n"
      "            for (j = rank; j < n; j++)\n"
      "                to[column[j]] -= f * from[column[j]];\n"
      "            to[n] -= f * from[n];\n"
      "        }\n"
      "    }\n"
      "    for (i = 0; i < n; i++)\n"
      "        x[i] = 0;\n"
      "    for (i = rank; i-- > 0;) {\n"
      "        double s = K[row[i] * m + n];\n"
      "        for (j = i + 1; j < rank; j++)\n"
      "            s -= K[row[i] * m + column[j]] * x[column[j]];\n"
      "        x[column[i]] = s / K[row[i] * m + column[i]];\n"
      "    }\n"
      "    for (i = 0; i < $_NU; i++)\n"
      "        a[i] = x[i];\n"
      "    return rank;\n"
      "}\n";

// The same with the pivots of the start, where these are large enough; 0 if they are not.
static const char fixed[]
    = "static int fixed_pivots(const double *in, double *a, double *out)\n"
      "{\n"
      "    const double *const inertia = out + $_NU + $_NQ, *const pivot = inertia + nfree;\n"
      "    int i;\n"
      "    @_solved(in, out);\n"
      "    for (i = 0; i < nfree; i++)\n"
      "        if (!(inertia[i] > 0))\n"
      "            return 0;\n"
      "    for (i = 0; i < npivot; i++)\n"
      "        if (!(fabs(pivot[i]) * scale[i] > weakest))\n"
      "            return 0;\n"
      "    for (i = 0; i < $_NU; i++) {\n"
      "        if (!isfinite(out[i]))\n"
      "            return 0;\n"
      "        a[i] = out[i];\n"
      "    }\n"
      "    return rank_fixed;\n"
      "}\n\n";

static void put_program(struct text *t, const struct ct_export *x, const char *name,
                        const struct ct_listing *l, unsigned lanes)
{
    const struct ct_c_options o = {.name = ct_arena_printf(t->arena, "%s_%s", x->name, name),
                                   .title = name,
                                   .lanes = lanes};
    put(t, ct_c_listing(t->arena, l, &o));
    put(t, "\n");
}

static void put_fixed(struct text *t, const struct ct_export *x)
{
    if (!x->solved || !x->e->nu) {
        put(t, "static int fixed_pivots(const double *in, double *a, double *out)\n{\n"
               "    (void)in;\n    (void)a;\n    (void)out;\n    return 0;\n}\n\n");
        return;
    }
    put_program(t, x, "solved", x->solved, 1);
    putf(t, "enum { nfree = %zu, npivot = %zu, rank_fixed = %zu };\n", x->nfree, x->npivot,
         x->e->nu + x->rank);
    put(t, "static const double scale[] = ");
    put_numbers(t, x->scale, x->npivot);
    putf(t, ";\nstatic const double weakest = %s;\n\n", ct_number_c(t->arena, x->weakest));
    put_named(t, fixed);
}

const char *ct_export_source(struct ct_arena *a, const struct ct_export *x)
{
    struct text t = {.arena = a, .name = x->name};
    const struct ct_equations *e = x->e;
    putf(&t, "/* %s: see %s.h. */\n#include \"%s.h\"\n\n", comment_text(a, x->title), x->name,
         x->name);
    put_program(&t, x, "motion", x->motion, 1);
    put_program(&t, x, "constraint", x->constraint, 1);
    if (x->lanes > 1) {
        put_program(&t, x, "motion_lanes", x->motion, x->lanes);
        put_program(&t, x, "constraint_lanes", x->constraint, x->lanes);
    }
    put_indices(&t, "M_row", e->M, e->nM, true);
    put_indices(&t, "M_column", e->M, e->nM, false);
    put_indices(&t, "J_row", e->J, e->nJ, true);
    put_indices(&t, "J_column", e->J, e->nJ, false);
    put_named(&t, "const double @_start[$_NINPUT] = ");
    put_numbers(&t, x->state[0].input, x->ninput);
    put(&t, ";\n\n");
    if (e->nu)
        put_fixed(&t, x);
    put_named(&t, e->nu ? solver
                        : "int @_accelerations(const double *in, double *a, double *work)\n{\n"
                          "    (void)in;\n    (void)a;\n    (void)work;\n    return 0;\n}\n");
    return finish(&t);
}

// ---- self-test --------------------------------------------------------------------------------

static void put_recorded(struct text *t, const char *what, size_t n, size_t k, const double *v)
{
    putf(t, "static const double %s%zu[] = ", what, k);
    put_numbers(t, v, n);
    put(t, ";\n");
}

static void put_list(struct text *t, const char *what, size_t n)
{
    putf(t, "static const double *const %s[] = {", what);
    for (size_t k = 0; k < n; k++)
        putf(t, "%s%s%zu", k ? ", " : "", what, k);
    put(t, "};\n");
}

// How the functions are called for a motion. State: q and u, which stand side by side in the input.
static const char driver[]
    = "enum { nstate_y = $_NQ + $_NU };\n\n"
      "static void derive(const double *in, double *dy)\n"
      "{\n"
      "    static double out[$_NMOTION + 1], work[$_NWORK + 1];\n"
      "    int i;\n"
      "    @_motion(in, out);\n"
      "    for (i = 0; i < $_NQ; i++)\n"
      "        dy[i] = out[$_OUT_RATE + i];\n"
      "    @_accelerations(in, dy + $_NQ, work);\n"
      "}\n\n"
      "/* The classical Runge-Kutta method: no control of errors, no projection onto "
      "constraints,\n"
      " * comparisons as at the start. */\n"
      "static void step(double *in, double h)\n"
      "{\n"
      "    static const double part[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};\n"
      "    static double y[nstate_y + 1], dy[nstate_y + 1], sum[nstate_y + 1];\n"
      "    double *const state = in + $_Q, t = in[$_T];\n"
      "    int i, k;\n"
      "    for (i = 0; i < nstate_y; i++) {\n"
      "        y[i] = state[i];\n"
      "        dy[i] = sum[i] = 0;\n"
      "    }\n"
      "    for (k = 0; k < 4; k++) {\n"
      "        in[$_T] = t + part[k] * h;\n"
      "        for (i = 0; i < nstate_y; i++)\n"
      "            state[i] = y[i] + part[k] * h * dy[i];\n"
      "        derive(in, dy);\n"
      "        for (i = 0; i < nstate_y; i++)\n"
      "            sum[i] += weight[k] * h / 6 * dy[i];\n"
      "    }\n"
      "    in[$_T] = t + h;\n"
      "    for (i = 0; i < nstate_y; i++)\n"
      "        state[i] = y[i] + sum[i];\n"
      "}\n\n"
      "/* The time and q, eleven times. */\n"
      "static int run(double duration, int nstep)\n"
      "{\n"
      "    static double in[$_NINPUT];\n"
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
      "        step(in, duration / (10.0 * nstep));\n"
      "    }\n"
      "    return 0;\n"
      "}\n\n";

// In lane l the state k + l, the first one again after the last.
static const char test_lanes[]
    = "static void take_lane(const double *all, int lane, int n, double *one)\n"
      "{\n"
      "    int i;\n"
      "    for (i = 0; i < n; i++)\n"
      "        one[i] = all[$_LANES * i + lane];\n"
      "}\n\n"
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
      "nstate], $_NCONSTRAINT, 1e-12);\n"
      "        }\n"
      "    }\n"
      "    return wrong;\n"
      "}\n\n";

// Programs: the library's sines may differ in the last bit elsewhere; sums of n terms magnify that.
// Accelerations are the result of a solve by another elimination.
static const char test_compare[]
    = "static int compare(const char *what, const double *got, const double *want, int n,\n"
      "                   double tolerance)\n"
      "{\n"
      "    double scale = 1;\n"
      "    int i, wrong = 0;\n"
      "    for (i = 0; i < n; i++)\n"
      "        scale = fabs(want[i]) > scale ? fabs(want[i]) : scale;\n"
      "    for (i = 0; i < n; i++)\n"
      "        if (!(fabs(got[i] - want[i]) <= tolerance * scale)) {\n"
      "            printf(\"%s[%d]: got %.17g, wanted %.17g\\n\", what, i, got[i], want[i]);\n"
      "            wrong++;\n"
      "        }\n"
      "    return wrong;\n"
      "}\n\n";

static const char test_main[]
    = "int main(int argc, char **argv)\n"
      "{\n"
      "    static double out[$_NMOTION + $_NCONSTRAINT + 1], a[$_NU + 1], work[$_NWORK + 1];\n"
      "    const int nstep = argc > 2 ? atoi(argv[2]) : 100;\n"
      "    int k, wrong = 0;\n"
      "    if (argc > 1)\n"
      "        return run(atof(argv[1]), nstep > 0 ? nstep : 1);\n"
      "    for (k = 0; k < nstate; k++) {\n"
      "        @_motion(input[k], out);\n"
      "        wrong += compare(\"motion\", out, motion[k], $_NMOTION, 1e-12);\n"
      "        @_constraint(input[k], out);\n"
      "        wrong += compare(\"constraint\", out, constraint[k], $_NCONSTRAINT, 1e-12);\n"
      "        @_accelerations(input[k], a, work);\n"
      "        wrong += compare(\"acceleration\", a, acceleration[k], $_NU, 1e-8);\n"
      "    }\n";

static const char test_end[] = "    printf(\"%d states, %d values wrong\\n\", nstate, wrong);\n"
                               "    return wrong != 0;\n"
                               "}\n";

const char *ct_export_test(struct ct_arena *a, const struct ct_export *x)
{
    struct text t = {.arena = a, .name = x->name};
    putf(&t,
         "/* %s: compares with recorded values; with a duration [s] and a tenth of the number "
         "of\n"
         " * steps, integrates from the start.\n *\n"
         " *     cc -std=c99 -O2 -o %s_test %s_test.c %s.c -lm && ./%s_test\n"
         " *     ./%s_test 1.5 100\n */\n",
         comment_text(a, x->title), x->name, x->name, x->name, x->name, x->name);
    putf(&t,
         "#include \"%s.h\"\n\n#include <math.h>\n#include <stdio.h>\n#include <stdlib.h>\n\n",
         x->name);
    for (size_t k = 0; k < x->nstate; k++) {
        put_recorded(&t, "input", x->ninput, k, x->state[k].input);
        put_recorded(&t, "motion", x->motion->nout, k, x->state[k].motion);
        put_recorded(&t, "constraint", x->constraint->nout, k, x->state[k].constraint);
        put_recorded(&t, "acceleration", x->e->nu, k, x->state[k].a);
    }
    put_list(&t, "input", x->nstate);
    put_list(&t, "motion", x->nstate);
    put_list(&t, "constraint", x->nstate);
    put_list(&t, "acceleration", x->nstate);
    putf(&t, "enum { nstate = %zu };\n\n", x->nstate);
    if (x->e->nq)
        put_named(&t, driver);
    else // all is given by time
        put(&t, "static int run(double duration, int nstep)\n{\n    (void)duration;\n    "
                "(void)nstep;\n"
                "    return 0;\n}\n\n");
    put_named(&t, test_compare);
    if (x->lanes > 1) {
        put_named(&t, test_lanes);
        put_named(&t, test_main);
        put(&t, "    wrong += compare_lanes();\n");
    } else {
        put_named(&t, test_main);
    }
    put_named(&t, test_end);
    return finish(&t);
}
