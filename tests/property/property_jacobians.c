// Jacobians against central differences in quadruple precision, at random states of shipped
// systems:
//
//     K = dr/dq, C = dr/du, M = dr/du', D = dv/dq, J = dv/du      entry by entry and along directions
//     du'/dq, du'/du of independent speeds                         the lower rows of A, x' = A x, that linearisations give
//
// The accelerations that are differenced come from M u' - J' lam = Q, J u' = -gam, solved in
// quadruple precision, so that neither the residual nor its derivatives take part.
#include "tests/property/system.h"

#include "analysis/state_space.h"
#include "formulate/residual/residual.h"
#include "solve/evaluator/quad_program.h"

#ifdef CT_HAVE_QUADMATH

// Differences over 2 h and h, extrapolated, err by (h / L)^4, 1e-16 for lengths of L = 1e-3, and
// 1e-34 / h.
static const double step = 1e-7;
// Round-off in double precision is left: 1e-14 in the residual; masses that differ much (arm and
// wrist of puma560) lose four digits of the accelerations.
static const double residual_tolerance = 1e-12, acceleration_tolerance = 1e-10;

typedef void (*function)(void *user, const ct_quad *input, ct_quad *out);

// slope (n, out) = the derivative of f at input (ninput) along d (ninput).
static void differentiate(struct ct_arena *a, function f, void *user, size_t n,
                          const double *input, const double *d, size_t ninput, double *slope)
{
    ct_quad *at = CT_NEWN(a, ct_quad, ninput), *out[4];
    for (int k = 0; k < 4; k++) { // at -2 h, -h, h, 2 h
        const ct_quad h = (k < 2 ? k - 2 : k - 1) * (ct_quad)step;
        out[k] = CT_NEWN(a, ct_quad, n + 1);
        for (size_t i = 0; i < ninput; i++)
            at[i] = input[i] + h * d[i];
        f(user, at, out[k]);
    }
    for (size_t i = 0; i < n; i++)
        slope[i] = (double)((8 * (out[2][i] - out[1][i]) - (out[3][i] - out[0][i]))
                            / (12 * (ct_quad)step));
}

// d (ninput, out): the motion of the input that moves places by dq, speeds by du, u' by da (nu
// each; NULL: not).
static void move_input(struct ct_evaluator *m, double *d, const double *dq, const double *du,
                       const double *da)
{
    const size_t bytes = m->nu * sizeof *dq;
    double *u = m->input + m->at_u;
    memset(d, 0, m->ninput * sizeof *d);
    if (dq) {                          // q' = Z(q) u
        memcpy(d + m->at_u, u, bytes); // kept there
        memcpy(u, dq, bytes);
        ct_program_run(&m->motion, m->input);
        memcpy(u, d + m->at_u, bytes);
        memset(d + m->at_u, 0, bytes);
        memcpy(d + m->at_q, m->rate, m->nq * sizeof *d);
    }
    if (du)
        memcpy(d + m->at_u, du, bytes);
    if (da)
        memcpy(d + m->at_a, da, bytes);
}

static double *unit_vector(struct ct_arena *a, size_t n, size_t k)
{
    double *e = CT_NEWN(a, double, n + 1);
    e[k] = 1;
    return e;
}

// The largest difference of two tables (n x m), each row relative to its largest entry; what
// vanishes, to that of the table.
static double compare(const double *got, const double *want, size_t n, size_t m)
{
    const double vanishing = 1e-14;
    double worst = 0, all = 0;
    for (size_t i = 0; i < n * m; i++)
        all = fmax(all, fabs(want[i]));
    for (size_t i = 0; i < n; i++) {
        double size = 0, difference = 0;
        for (size_t k = 0; k < m; k++) {
            size = fmax(size, fabs(want[i + n * k]));
            difference = fmax(difference, fabs(got[i + n * k] - want[i + n * k]));
            assert_true(isfinite(got[i + n * k]) && isfinite(want[i + n * k]));
        }
        if (size <= vanishing * all)
            size = all;
        worst = fmax(worst, difference > 0 ? difference / size : 0);
    }
    return worst;
}

// ---- the residual -------------------------------------------------------------------------------

static void evaluate_residual(void *user, const ct_quad *input, ct_quad *out)
{
    ct_quad_evaluate(user, input, out);
}

static const double *scatter(double *A, size_t n, const struct ct_slope *s, size_t ns,
                             const double *value)
{
    for (size_t i = 0; i < ns; i++)
        A[s[i].row + n * s[i].direction] = value[i];
    return value + ns;
}

// Worst of K, C, M, D, J at the input of v, with the derivatives in a form.
static double compare_residual(struct variant *v, const struct system *s,
                               enum ct_slope_form form)
{
    struct ct_arena *a = v->arena;
    struct ct_equations e = v->e;
    ct_residual_derive(e.build, form);
    const struct ct_residual *f = e.residual = e.build->eqs->residual;
    assert_int_equal(f->along != NULL, form == CT_SLOPES_ALONG);
    struct ct_evaluator *m = ct_evaluator_create(a, &s->model, &e);
    memcpy(m->input, v->m->input, m->ninput * sizeof *m->input);
    ct_evaluator_tangent(m);
    const size_t nu = m->nu, nrow = m->nrow, nout = nu + 2 * nrow;
    enum { K, C, M, D, J, NTABLE };
    double *got[NTABLE], *want[NTABLE], worst = 0;
    for (int i = 0; i < NTABLE; i++) {
        got[i] = CT_NEWN(a, double, (nu + nrow) * nu + 1);
        want[i] = CT_NEWN(a, double, (nu + nrow) * nu + 1);
    }
    const double *value = ct_evaluator_scatter(m, got[K], got[C], got[M]);
    value = scatter(got[D], nrow, f->dv, f->ndv, value);
    for (size_t i = 0; i < e.nJ; i++)
        got[J][(size_t)e.J[i].row + nrow * (size_t)e.J[i].column] = value[i];
    struct ct_quad_program p = ct_quad_load(a, &m->residual); // r, phi, v
    double *d = CT_NEWN(a, double, m->ninput), *slope = CT_NEWN(a, double, nout + 1);
    for (size_t k = 0; k < nu; k++) {
        const double *unit = unit_vector(a, nu, k);
        move_input(m, d, unit, NULL, NULL);
        differentiate(a, evaluate_residual, &p, nout, m->input, d, m->ninput, slope);
        memcpy(want[K] + nu * k, slope, nu * sizeof *slope);
        memcpy(want[D] + nrow * k, slope + nu + nrow, nrow * sizeof *slope);
        move_input(m, d, NULL, unit, NULL);
        differentiate(a, evaluate_residual, &p, nout, m->input, d, m->ninput, slope);
        memcpy(want[C] + nu * k, slope, nu * sizeof *slope);
        memcpy(want[J] + nrow * k, slope + nu + nrow, nrow * sizeof *slope);
        move_input(m, d, NULL, NULL, unit);
        differentiate(a, evaluate_residual, &p, nout, m->input, d, m->ninput, slope);
        memcpy(want[M] + nu * k, slope, nu * sizeof *slope);
    }
    for (int i = 0; i < NTABLE; i++) {
        const double w = compare(got[i], want[i], i < D ? nu : nrow, nu);
        if (!(w <= residual_tolerance))
            print_error("%s, %s: %c errs by %.1e of a row\n", s->name,
                        form == CT_SLOPES_ALONG ? "along directions" : "entries", "KCMDJ"[i],
                        w);
        worst = fmax(worst, w);
    }
    return worst;
}

// ---- accelerations ------------------------------------------------------------------------------

struct accelerations {
    const struct ct_evaluator *m;
    struct ct_quad_program motion; // M, Q, J, gam, q'
    ct_quad *out, *A;              // of the motion; n x (n + 1), n = nu + nrow, by rows
};

// x (n, out) from A x = b, the rows of [A, b] one after the other, by elimination with row pivots.
static void solve(ct_quad *A, size_t n, ct_quad *x)
{
    const size_t w = n + 1;
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            if (fabs((double)A[i * w + k]) > fabs((double)A[pivot * w + k]))
                pivot = i;
        for (size_t j = k; j < w; j++) {
            const ct_quad kept = A[k * w + j];
            A[k * w + j] = A[pivot * w + j];
            A[pivot * w + j] = kept;
        }
        for (size_t i = k + 1; i < n; i++) {
            const ct_quad factor = A[i * w + k] / A[k * w + k];
            for (size_t j = k; j < w && factor != 0; j++)
                A[i * w + j] -= factor * A[k * w + j];
        }
    }
    for (size_t k = n; k-- > 0;) {
        x[k] = A[k * w + n];
        for (size_t j = k + 1; j < n; j++)
            x[k] -= A[k * w + j] * x[j];
        x[k] /= A[k * w + k];
    }
}

// out: u', -lam
static void evaluate_accelerations(void *user, const ct_quad *input, ct_quad *out)
{
    const struct accelerations *s = user;
    const struct ct_equations *e = s->m->e;
    const size_t nu = e->nu, n = nu + e->nrow, w = n + 1;
    ct_quad_evaluate(&s->motion, input, s->out);
    memset(s->A, 0, n * w * sizeof *s->A);
    const ct_quad *value = s->out;
    for (size_t i = 0; i < e->nM; i++, value++) {
        const size_t r = (size_t)e->M[i].row, c = (size_t)e->M[i].column;
        s->A[r * w + c] = s->A[c * w + r] = *value;
    }
    for (size_t i = 0; i < nu; i++)
        s->A[i * w + n] = *value++;
    for (size_t i = 0; i < e->nJ; i++, value++) {
        const size_t r = nu + (size_t)e->J[i].row, c = (size_t)e->J[i].column;
        s->A[r * w + c] = s->A[c * w + r] = *value;
    }
    for (size_t i = nu; i < n; i++)
        s->A[i * w + n] = -*value++;
    solve(s->A, n, out);
}

// Worst of the accelerations of independent speeds by their positions and speeds. Closed loops at
// rest, where what the linearisation leaves out, the change of the rows with time, is zero.
static double compare_accelerations(struct variant *v, double t)
{
    struct ct_arena *a = v->arena;
    struct ct_evaluator *m = v->m;
    struct ct_linear *l = ct_linear_create(&v->ctx, a, m);
    struct ct_state_space x;
    const size_t nu = m->nu, n = nu + m->nrow;
    memcpy(l->y, v->y, (m->nq + nu + 1) * sizeof *l->y);
    l->t = t;
    if (m->nrow)
        memset(l->y + m->nq, 0, nu * sizeof *l->y);
    assert_true(ct_linear_move(l) && ct_state_space_create(&v->ctx, a, l, &x));
    assert_int_equal(l->rank, m->nrow);
    assert_int_equal(x.n, 2 * l->nfree); // all have mass
    ct_evaluator_set(m, t, l->y);
    struct accelerations q
        = {m, ct_quad_load(a, &m->motion), CT_NEWN(a, ct_quad, m->motion.nout + 1),
           CT_NEWN(a, ct_quad, n * (n + 1))};
    const size_t nfree = (size_t)l->nfree, nx = 2 * nfree;
    double *d = CT_NEWN(a, double, m->ninput), *slope = CT_NEWN(a, double, n + 1);
    double *got = CT_NEWN(a, double, nfree *nx + 1), *want = CT_NEWN(a, double, nfree *nx + 1);
    for (size_t k = 0; k < nx; k++) {
        const bool is_place = k < nfree;
        const size_t j = (size_t)(is_place ? x.place[k] : x.speed[k - nfree]);
        const double *Z = l->Z + nu * j, *X = l->X + nu * j;
        move_input(m, d, is_place ? Z : NULL, is_place ? X : Z, NULL);
        differentiate(a, evaluate_accelerations, &q, n, m->input, d, m->ninput, slope);
        for (size_t i = 0; i < nfree; i++) {
            got[i + nfree * k] = x.A[nfree + i + nx * k];
            want[i + nfree * k] = slope[l->independent[x.speed[i]]];
        }
    }
    return compare(got, want, nfree, nx);
}

// ---- systems ------------------------------------------------------------------------------------

static void compare_all(struct system *s, enum ct_tree_choice tree, double t)
{
    const struct ct_formulate_options o
        = {.tree = tree, .with_energy = true, .with_outputs = true, .with_residual = true};
    struct ct_initial_state state;
    struct variant v;
    variant_open(s, &o, &v);
    assert_int_equal(v.e.x->ntable, 0);
    assert_true(system_random_state(s, t, 0.3, &state));
    variant_set(&v, &state, t);
    for (size_t i = 0; i < v.m->nu; i++) // any will do: r is taken for what it is
        v.m->input[v.m->at_a + i] = 3 * chance();
    for (size_t i = 0; i < v.m->nrow; i++)
        v.m->input[v.m->at_lam + i] = 3 * chance();
    const double entries = compare_residual(&v, s, CT_SLOPES_ENTRIES),
                 along = compare_residual(&v, s, CT_SLOPES_ALONG),
                 accelerations = compare_accelerations(&v, t);
    print_message("%s, tree %d: %zu speeds, %zu rows; entries %.0e, along %.0e; "
                  "accelerations %.0e\n",
                  s->name, tree, v.m->nu, v.m->nrow, entries, along, accelerations);
    assert_true(entries <= residual_tolerance && along <= residual_tolerance);
    assert_true(accelerations <= acceleration_tolerance);
    variant_close(&v);
}

static void jacobians_are_differences(void **unused)
{
    static const char *const name[]
        = {"pendulum",  "double_pendulum", "slider_crank",         "four_bar",    "andrews",
           "heavy_top", "puma560",         "spatial_slider_crank", "spin_up_beam"};
    (void)unused;
    for (size_t i = 0; i < COUNT(name); i++) {
        struct system s;
        char file[100];
        snprintf(file, sizeof file, "systems/%s/model.yaml", name[i]);
        system_open_file(&s, file);
        compare_all(&s, CT_TREE_AUTO, 0.7);
        compare_all(&s, CT_TREE_ABSOLUTE, 0.7);
        system_close(&s);
    }
}

static void jacobians_of_chains_are_differences(void **unused)
{
    enum { LENGTH = 5 };
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    const char *bodies = "", *joints = "";
    struct system s;
    for (int i = 1; i <= LENGTH; i++) {
        bodies = text_of(a,
                         "%s  b%d: {mass: 1.%d, com: [0.5, 0.01, 0.02], inertia: [0.1, 0.2, "
                         "0.25], points: {end: [1, 0, 0]}}\n",
                         bodies, i, i);
        joints = text_of(
            a, "%s  j%d: {type: spherical, from: %s, to: b%d, damping: [0.1, 0.2, 0.3]}\n",
            joints, i, i > 1 ? text_of(a, "b%d.end", i - 1) : "ground", i);
    }
    system_open_text(
        &s, "chain of ball joints",
        text_of(a, "cotree: 1\nname: balls\ngravity: [0, 0, -9.81]\nbodies:\n%sjoints:\n%s",
                bodies, joints));
    compare_all(&s, CT_TREE_JOINTS, 0);
    compare_all(&s, CT_TREE_ABSOLUTE, 0);
    system_close(&s);
    ct_arena_destroy(a);
}

static void compare_inner(struct system *s)
{
    const struct ct_formulate_options o
        = {.tree = CT_TREE_JOINTS, .with_energy = true, .with_residual = true};
    struct ct_initial_state state;
    struct variant v;
    variant_open(s, &o, &v);
    assert_true(v.e.residual->nauxiliary > 0);
    assert_true(system_random_state(s, 0, 0.1, &state));
    variant_set(&v, &state, 0);
    for (size_t i = 0; i < v.m->nu; i++)
        v.m->input[v.m->at_a + i] = 3 * chance();
    for (size_t i = 0; i < v.m->nrow; i++)
        v.m->input[v.m->at_lam + i] = 3 * chance();
    const double entries = compare_residual(&v, s, CT_SLOPES_ENTRIES),
                 along = compare_residual(&v, s, CT_SLOPES_ALONG);
    print_message("%s: %zu speeds, %zu rows, %zu inner values; entries %.0e, along %.0e\n",
                  s->name, v.m->nu, v.m->nrow, v.e.residual->nauxiliary, entries, along);
    assert_true(entries <= residual_tolerance && along <= residual_tolerance);
    variant_close(&v);
}

// Foreshortened beams without stretch, whose sums along the axis are inner values.
static void jacobians_of_beams_are_differences(void **unused)
{
    (void)unused;
    static const char *const loads[] = {
        "  bob: {mass: 0.3, inertia: 1e-3}\n"
        "  link: {mass: 0.2, inertia: 2e-3, com: [0.1, 0, 0]}\n"
        "joints:\n  root: {type: revolute, from: ground, to: arm, initial: {q: -0.5}}\n"
        "  weld: {type: weld, from: arm.mid, to: bob}\n"
        "  hang: {type: revolute, from: arm.tip, to: link}\n",
        "  slider: {mass: 0.4}\n"
        "  crank: {mass: 0.3, inertia: 3e-3, com: [0.25, 0, 0], points: {pin: [0.5, 0, 0]}}\n"
        "joints:\n  main: {type: revolute, from: ground, to: crank, initial: {q: 0.5}}\n"
        "  big_end: {type: revolute, from: crank.pin, to: arm, initial: {q: -0.6, guess: "
        "true}}\n"
        "  pin: {type: revolute, from: arm.tip, to: slider, initial: {q: 0.1, guess: true}}\n"
        "  guide: {type: prismatic, from: ground, to: slider, axis: x, initial: {q: 2.4, "
        "guess: true}}\n",
    };
    for (size_t i = 0; i < COUNT(loads); i++) {
        struct ct_arena *a = ct_arena_create();
        struct system s;
        system_open_text(
            &s, i ? "beam on a slider" : "pendulum beam with bodies",
            text_of(a,
                    "cotree: 1\nname: arm\ngravity: [0, -9.81, 0]\nbodies:\n"
                    "  arm: {type: beam, length: 2, elements: 40, density: 1200, E: 3e9, area: "
                    "4e-4, Iz: 5e-9, formulation: foreshortening, deformation: [bending-z], "
                    "points: {mid: 1, tip: 2}}\n%s",
                    loads[i]));
        compare_inner(&s);
        system_close(&s);
        ct_arena_destroy(a);
    }
}

#else

static void jacobians_are_differences(void **unused)
{
    (void)unused;
    skip(); // no quadruple precision
}

static void jacobians_of_beams_are_differences(void **unused)
{
    (void)unused;
    skip();
}

#define jacobians_of_chains_are_differences jacobians_are_differences

#endif

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(jacobians_are_differences),
                                       cmocka_unit_test(jacobians_of_chains_are_differences),
                                       cmocka_unit_test(jacobians_of_beams_are_differences)};
    chance_start();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
