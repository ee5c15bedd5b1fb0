// The matrix of the iteration, (8.2), as a list of entries against the full one, and what it costs.
#include "tests/check.h"

#include "formulate/formulate.h"
#include "integrate/implicit/newton_iteration.h"
#include "numeric/dense.h"
#include "numeric/factors.h"
#include "solve/constraint/dae.h"
#include "solve/run/run.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#if CT_HAS_KLU

static const char *const slider_crank = "../systems/slider_crank_flexible/model.yaml";
static const char *const spin_up = "../systems/spin_up_beam/model.yaml";
static const char *const free_beam = "unit/models/free_beam.yaml";
// beams that do not stretch
static const char *const arm = "unit/models/bent_arm.yaml";
static const char *const cranks = "unit/models/bent_cranks.yaml";
static const char *const mast = "unit/models/bent_mast.yaml";

// A model read, formulated and started.
struct job {
    struct ct_ctx ctx;
    struct ct_model model;
    struct ct_equations e;
    struct ct_run *run;
    struct ct_dae dae;
};

// elements: of all beams; 0: the model's own.
static void open_job(struct job *j, const char *name, enum ct_tree_choice tree, int elements)
{
    const struct ct_formulate_options o
        = {.tree = tree, .with_energy = true, .with_outputs = true, .with_residual = true};
    const struct ct_formulate_options measuring = {.tree = CT_TREE_JOINTS, .measure_all = true};
    struct ct_equations measured;
    struct ct_tree_report report;
    struct ct_initial_state start;
    *j = (struct job){.ctx = {.model = ct_arena_create(), .scratch = ct_arena_create()}};
    const char *path = ct_arena_printf(j->ctx.model, "%s/%s", getenv("CT_TEST_DIR"), name);
    const struct ct_set set[] = {{ct_arena_printf(j->ctx.model, "n=%d", elements)},
                                 {ct_arena_printf(j->ctx.model, "m=%d", elements)}};
    const size_t nset = elements == 0 ? 0 : name == slider_crank || name == cranks ? 2 : 1;
    const bool ok
        = ct_model_read(&j->ctx, path, set, nset, &j->model)
       && ct_formulate(&j->ctx, j->ctx.model, &j->model, &o, &j->e, &report)
       && ct_formulate(&j->ctx, j->ctx.model, &j->model, &measuring, &measured, &report)
       && ct_assembly_solve(&j->ctx, j->ctx.model, &j->model, &measured, &start)
       && (j->run = ct_run_create(&j->ctx, j->ctx.model, &j->model, &j->e, &start));
    ct_ctx_print(&j->ctx, stdout);
    assert_true(ok);
    j->dae = *ct_dae_create(j->ctx.model, ct_run_partition(j->run));
}

static void close_job(struct job *j)
{
    ct_arena_destroy(j->ctx.model);
    ct_arena_destroy(j->ctx.scratch);
}

static uint64_t seed = 1;

// Between -1 and 1; multiplicative congruential.
static double random_number(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(int64_t)(seed >> 11) / (double)(1ll << 52) - 1;
}

static void randomise(double *x, int n)
{
    for (int i = 0; i < n; i++)
        x[i] = random_number();
}

// ---- sparse against full ------------------------------------------------------------------------

// Both ways to solve the same systems: [0] full, [1] sparse.
struct pair {
    struct ct_dae dae[2];
    struct ct_problem problem[2];
    struct ct_newton_iteration *it[2];
    double *y, *q, *u, *a, *lam;
};

static void create_pair(struct job *j, struct pair *p, bool is_stabilised)
{
    struct ct_arena *a = j->ctx.model;
    const int nu = j->dae.nu, nq = j->dae.nq;
    bool *asked = CT_NEWN(a, bool, nu + 1);
    for (int k = 0; k < nu; k += 3) // some
        asked[k] = true;
    *p = (struct pair){.y = CT_NEWN(a, double, nq + nu + 1)};
    for (int k = 0; k < 2; k++) {
        p->dae[k] = j->dae;
        p->dae[k].plan[is_stabilised]
            = k ? ct_newton_pattern_create_always(a, &j->dae, is_stabilised) : NULL;
        assert_true(k == 0 || p->dae[k].plan[is_stabilised]);
        p->problem[k] = (struct ct_problem){.ny = nq + nu,
                                            .dae = &p->dae[k],
                                            .requested_speeds = asked,
                                            .requested_positions = asked};
        p->it[k] = ct_newton_iteration_create(a, &p->problem[k], is_stabilised, is_stabilised);
    }
    memcpy(p->y, ct_run_state(j->run), (size_t)nq * sizeof *p->y);
    double *d = CT_NEWN(a, double, nu + 1);
    randomise(d, nu);
    for (int k = 0; k < nu; k++)
        d[k] *= 1e-3;
    p->q = CT_NEWN(a, double, nq + 1);
    p->u = CT_NEWN(a, double, nu + 1);
    p->a = CT_NEWN(a, double, nu + 1);
    p->lam = CT_NEWN(a, double, j->dae.most_rows + 1);
    j->dae.retract(j->dae.user, p->y, d, p->q);
    randomise(p->u, nu);
    randomise(p->a, nu);
    randomise(p->lam, j->dae.most_rows);
    memcpy(p->y + nq, p->u, (size_t)nu * sizeof *p->u);
}

enum { MOST = 2000 };

// |b - A x| / (|b| + |A| |x|) of the worst row, for the matrix for 1/w and right-hand side as full
// matrices have them.
static double backward_error(const struct ct_newton_iteration *it, double _Complex w,
                             const double _Complex *x, const double _Complex *b)
{
    const int n = it->n, nu = it->nu;
    double worst = 0;
    for (int i = 0; i < n; i++) {
        double _Complex left = b[i];
        double size = cabs(b[i]);
        for (int j = 0; j < n; j++) {
            const double _Complex a = it->S[i + n * j] + w * it->X[i + n * j]
                                    + (i < nu ? w * w : w) * it->W[i + n * j];
            left -= a * x[j];
            size += cabs(a * x[j]);
        }
        worst = fmax(worst, cabs(left) / (size + 1e-300));
    }
    return worst;
}

// The larger of both errors, full and sparse, of solutions for one right-hand side, c = s.
static void compare_solutions(struct pair *p, double _Complex s, double error[2])
{
    static double r[MOST], phi[MOST], v[MOST], d[MOST], eta[MOST], lam[MOST];
    static double _Complex x[MOST], b[MOST];
    const int nu = p->it[0]->nu, m = p->it[0]->m, n = p->it[0]->n;
    const bool is_complex = cimag(s) > 0;
    const int parts = is_complex ? 2 : 1, rows = is_complex ? m : 0;
    memset(v, 0, sizeof v);
    randomise(r, parts * nu);
    randomise(phi, parts * m);
    if (p->it[0]->is_stabilised)
        randomise(v, parts * m);
    for (int k = 0; k < 2; k++) {
        struct ct_newton_iteration *it = p->it[k];
        if (is_complex)
            ct_newton_iteration_solve_complex(it, d, eta, lam, r, phi, v);
        else
            ct_newton_iteration_solve(it, d, eta, lam, r, phi, v);
        for (int i = 0; i < nu; i++) {
            x[i] = CMPLX(d[i], is_complex ? d[i + nu] : 0);
            b[i] = -CMPLX(r[i], is_complex ? r[i + nu] : 0) / (s * s);
        }
        for (int i = 0; i < m; i++) {
            x[nu + i] = CMPLX(eta[i], is_complex ? eta[i + rows] : 0);
            x[n - m + i] = CMPLX(lam[i], is_complex ? lam[i + rows] : 0) / (s * s);
            b[n - m + i] = -CMPLX(v[i], is_complex ? v[i + rows] : 0) / s;
            b[nu + i] = -CMPLX(phi[i], is_complex ? phi[i + rows] : 0);
        }
        error[k] = fmax(error[k], backward_error(p->it[0], 1 / s, x, b));
    }
}

// (8.10), (8.13), (8.21): what is slow of errors, the energy of the rest, and what states that are
// outputs feel of it.
static double compare_vibrations(struct pair *p)
{
    const int nu = p->it[0]->nu;
    static double d[MOST], u[MOST], ample[MOST];
    static double ahead[2 * MOST];
    static const double size[MOST] = {1};
    double found[2][10];
    const struct ct_tolerance tolerance = {1e-6, 1e-6};
    randomise(d, nu);
    randomise(u, nu);
    const struct ct_band band = {.rate = 1e3,
                                 .times = 1,
                                 .small = 1,
                                 .least = 1e-3,
                                 .largest_position = size,
                                 .largest_speed = size,
                                 .predicted = ahead};
    for (int k = 0; k < nu; k++)
        ample[k] = 1;
    for (int k = 0; k < 2; k++) {
        double *x = found[k];
        x[0] = ct_newton_iteration_slow_norm(p->it[k], &p->problem[k], &tolerance, p->y, ample,
                                             d, u, &x[1]);
        assert_true(isfinite(x[0]));
        ct_newton_iteration_note_energy(p->it[k], 1e-3, u);
        x[2] = p->it[k]->energy;
        const struct ct_vibration w = ct_newton_iteration_vibration(p->it[k], 3.6, 1e-3, d, u);
        x[3] = w.present;
        x[4] = w.dissipation;
        ct_newton_iteration_predict_energy(p->it[k], 1e-3, 1, u);
        x[5] = p->it[k]->energy;
        ct_newton_iteration_predict_motion(p->it[k], &p->problem[k], 0, p->y, u, ahead);
        x[6] = ahead[0];
        x[7] = ct_newton_iteration_output_change_in_band(p->it[k], &p->problem[k], &band, 0,
                                                         p->y, d, u);
        x[8] = ct_newton_iteration_slow_norm(p->it[k], &p->problem[k], &tolerance, p->y, ample,
                                             d, u,
                                             &x[9]); // the factors of (8.10) are back
    }
    double worst = 0;
    for (int i = 0; i < 10; i++)
        worst = fmax(worst, fabs(found[0][i] - found[1][i]) / (fabs(found[0][i]) + 1e-300));
    for (int k = 0; k < nu; k++)
        assert_int_equal(p->it[0]->is_slow[k], p->it[1]->is_slow[k]);
    return worst;
}

static const double real_pace = 4;
static const double _Complex complex_pace = CMPLX(2.7, 3);

// At the same point, with derivatives anew.
static void renew(struct pair *p, double h)
{
    struct ct_integrate_stats stats = {0};
    for (int k = 0; k < 2; k++) {
        struct ct_newton_iteration *it = p->it[k];
        ct_newton_iteration_begin(it, NULL, h, p->y);
        ct_newton_iteration_forget(it);
        assert_int_equal(ct_newton_iteration_refresh(it, 0, p->q, p->u, p->a, p->lam, &stats),
                         CT_EVAL_OK);
        const double c = real_pace / h;
        assert_true(ct_newton_iteration_factor_anew(
            it, c, c * c, it->is_stabilised ? complex_pace / h : 0, &stats));
    }
    assert_int_equal(p->it[0]->m, p->it[1]->m);
}

static void compare_at(const char *name, struct pair *p, double h)
{
    double error[2] = {0};
    renew(p, h);
    const bool is_stabilised = p->it[0]->is_stabilised;
    const bool has_inner = p->dae[0].jacobian_pattern->nauxiliary > 0;
    compare_solutions(p, real_pace / h, error);
    if (is_stabilised)
        compare_solutions(p, complex_pace / h, error);
    const double vibrations = is_stabilised ? compare_vibrations(p) : 0;
    printf("%s, h = %g: %d speeds, %d rows; full %.0e, sparse %.0e, vibrations %.0e\n", name, h,
           p->it[0]->nu, p->it[0]->m, error[0], error[1], vibrations);
    // pivots are a thousandth of their columns at least, and lose as much again before others are
    // sought; inner values can be larger than what comes of them
    const double lost = has_inner ? 1e7 : 1e6;
    assert_true(error[1] <= lost * DBL_EPSILON);
    assert_true(vibrations <= 1e-6); // differences of what is slow and of all
}

// Rows drop out and come back, as they do where others have become the independent ones.
static void change_rows(struct job *j, struct pair *p, const char *name)
{
    struct ct_partition *s = ct_run_partition(j->run);
    if (s->rank < 2)
        return;
    const int rank = s->rank, first = s->row[0];
    s->row[0] = s->row[rank - 1];
    s->rank = rank - 1;
    s->switches++;
    compare_at(name, p, 1e-3);
    s->row[0] = first;
    s->rank = rank;
    s->switches++;
    compare_at(name, p, 1e-3);
}

static void compare(const char *name, enum ct_tree_choice tree, int elements)
{
    static const double steps[] = {1e-5, 1e-3, 1e-1};
    for (int is_stabilised = 0; is_stabilised < 2; is_stabilised++) {
        struct job j;
        struct pair p;
        open_job(&j, name, tree, elements);
        create_pair(&j, &p, is_stabilised);
        for (size_t i = 0; i < COUNT(steps); i++)
            compare_at(name, &p, steps[i]);
        change_rows(&j, &p, name);
        close_job(&j);
    }
}

// Full matrices of beams with inner values are compared with differences in property_jacobians.c.
static void inner_values_change_nothing(void **unused)
{
    (void)unused;
    static const struct {
        const char *name;
        int elements;
    } beams[] = {{arm, 40}, {cranks, 20}, {mast, 15}};
    for (size_t i = 0; i < COUNT(beams); i++) {
        struct job j;
        open_job(&j, beams[i].name, CT_TREE_JOINTS, beams[i].elements);
        printf("%s: %zu inner values\n", beams[i].name, j.e.residual->nauxiliary);
        assert_true(j.e.residual->nauxiliary > 0);
        assert_non_null(j.dae.plan[1]);
        close_job(&j);
        compare(beams[i].name, CT_TREE_JOINTS, beams[i].elements);
    }
}

static void sparse_matrices_have_the_solutions_of_full_ones(void **unused)
{
    (void)unused;
    compare(spin_up, CT_TREE_JOINTS, 8);
    compare(free_beam, CT_TREE_JOINTS, 6);
    compare(slider_crank, CT_TREE_JOINTS, 6);
    compare("../systems/flexible_four_bar/model.yaml", CT_TREE_AUTO, 0);
    compare("../systems/stewart/model.yaml", CT_TREE_ABSOLUTE, 0);
    compare("../systems/bricard/model.yaml", CT_TREE_ABSOLUTE, 0); // with a redundant row
    compare("../systems/chain40/model.yaml", CT_TREE_JOINTS, 0);
    compare("../systems/chain40/model.yaml", CT_TREE_ABSOLUTE, 0);
}

// ---- pivots -------------------------------------------------------------------------------------

// A pivot that was sound is next to nothing in the next matrix: its factors are no longer used.
static void unsound_pivots_are_sought_anew(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    const int row[] = {0, 1, 0, 1}, column[] = {0, 0, 1, 1};
    int place[4], first[] = {0, 1};
    double sound[] = {2, 1, 1, 2}, unsound[] = {1e-14, 1, 1, 1}, x[] = {1, 2};
    struct ct_pattern *p = ct_pattern_create(a, 2, row, column, 4, place);
    assert_true(ct_pattern_order(a, p, sound, first));
    struct ct_factors *f = ct_factors_create(a, p, false);
    assert_true(ct_factors_compute(f, sound));
    sound[0] = 3;
    assert_true(ct_factors_compute(f, sound));
    assert_int_equal(ct_factors_npivoting(f), 1);
    assert_true(ct_factors_compute(f, unsound));
    assert_int_equal(ct_factors_npivoting(f), 2);
    ct_factors_solve(f, x); // x + y = 2, 1e-14 x + y = 1
    assert_true(fabs(x[0] - 1) < 1e-13 && fabs(x[1] - 1) < 1e-13);
    ct_arena_destroy(a);
}

// L L' with small pivots, a band and a border, as of a beam on a hinge that is eliminated from its
// free end: what lies beside the diagonal is larger, and as a pivot it would fill the rest.
static void positive_definite_matrices_do_not_fill(void **unused)
{
    (void)unused;
    enum { N = 100 };
    struct ct_arena *a = ct_arena_create();
    double L[N][N] = {{0}}, value[6 * N] = {0};
    int row[6 * N], column[6 * N], place[6 * N], first[N], n = 0;
    for (int i = 0; i < N; i++) {
        first[i] = i;
        for (int j = 0; j <= i; j++)
            L[i][j] = i == j ? 1e-2 : j == i - 1 || i == N - 1 ? 1 + 0.5 * random_number() : 0;
    }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            if (abs(i - j) <= 1 || i == N - 1 || j == N - 1) {
                row[n] = i;
                column[n++] = j;
            }
    struct ct_pattern *p = ct_pattern_create(a, N, row, column, n, place);
    for (int k = 0; k < n; k++)
        for (int j = 0; j < N; j++)
            value[place[k]] += L[row[k]][j] * L[column[k]][j];
    assert_true(ct_pattern_order(a, p, value, first));
    struct ct_factors *f = ct_factors_create(a, p, false);
    assert_true(ct_factors_compute(f, value));
    assert_true(ct_factors_fill(f) <= 6 * N); // L and U have up to three a column
    ct_arena_destroy(a);
}

// A band matrix with a border: each entry against a solution for a column of the identity.
static void entries_of_the_inverse_are_those_of_solutions(void **unused)
{
    (void)unused;
    enum { N = 30, MOST_ENTRIES = 9 * N };
    struct ct_arena *a = ct_arena_create();
    int row[MOST_ENTRIES], column[MOST_ENTRIES], place[MOST_ENTRIES], first[N], n = 0;
    double value[MOST_ENTRIES] = {0}, z[MOST_ENTRIES], x[N];
    for (int i = 0; i < N; i++) {
        first[i] = N - 1 - i;
        for (int j = 0; j < N; j++)
            if (abs(i - j) <= 2 || i == 7 || j == 7) {
                row[n] = i;
                column[n++] = j;
            }
    }
    struct ct_pattern *p = ct_pattern_create(a, N, row, column, n, place);
    struct ct_factors *f = NULL;
    for (int trial = 0; trial < 3; trial++) {
        for (int k = 0; k < n; k++)
            value[place[k]] = random_number() * exp(3 * random_number());
        if (!f) {
            assert_true(ct_pattern_order(a, p, value, first));
            f = ct_factors_create(a, p, false);
        }
        assert_true(ct_factors_compute(f, value));
        ct_factors_inverse(f, z);
        for (int i = 0; i < N; i++) {
            memset(x, 0, sizeof x);
            x[i] = 1;
            ct_factors_solve(f, x); // column i of the inverse
            const double size = ct_vector_largest(x, N);
            for (int k = 0; k < n; k++)
                if (row[k] == i)
                    assert_true(fabs(z[place[k]] - x[column[k]]) <= 1e-10 * size);
        }
    }
    ct_arena_destroy(a);
}

// ---- what it costs ------------------------------------------------------------------------------

// Of a step: derivatives, factors and solutions.
static double work_of_step(const char *name, int elements)
{
    struct job j;
    open_job(&j, name, CT_TREE_JOINTS, elements);
    const struct ct_dae *dae = &j.dae;
    const int n = dae->nu + 2 * dae->most_rows, solutions = 8;
    const struct ct_newton_work w = ct_newton_work(dae->plan[1], n);
    printf("%s, %d elements: n %d, %s, assembly %.3g, factorization %.3g, solution %.3g\n",
           name, elements, n, dae->plan[1] ? "sparse" : "full", w.assembly, w.factorization,
           w.solution);
    close_job(&j);
    return w.assembly + w.factorization + solutions * w.solution;
}

static void steps_of_beams_cost_in_proportion_to_their_elements(void **unused)
{
    (void)unused;
    static const struct {
        const char *name;
        int few;
        double spread; // inner values are chosen by steps
    } beams[] = {{spin_up, 20, 1.1},
                 {free_beam, 20, 1.1},
                 {slider_crank, 20, 1.1},
                 {arm, 40, 1.1},
                 {cranks, 20, 1.2}};
    for (size_t i = 0; i < COUNT(beams); i++) {
        const int n = beams[i].few;
        const double few = work_of_step(beams[i].name, n),
                     many = work_of_step(beams[i].name, 4 * n);
        printf("%.2f times the work of %d elements\n", many / few, n);
        assert_true(many < beams[i].spread * 4 * few);
    }
}

// Eight beams, end to end, in coordinates of their neighbours: a few inner values would be
// predicted to take a little less.
static void what_takes_little_is_not_searched_for_inner_values(void **unused)
{
    (void)unused;
    struct job j;
    open_job(&j, "reference/B12_K8.yaml", CT_TREE_JOINTS, 0);
    assert_int_equal(j.dae.nu, 48);
    assert_int_equal(j.e.residual->nauxiliary, 0);
    close_job(&j);
}

static void small_systems_keep_full_matrices(void **unused)
{
    (void)unused;
    static const char *const names[]
        = {"../systems/four_bar/model.yaml", "../systems/puma560/model.yaml",
           "../systems/chain40/model.yaml"};
    for (size_t i = 0; i < COUNT(names); i++) {
        struct job j;
        open_job(&j, names[i], CT_TREE_JOINTS, 0);
        assert_null(j.dae.plan[0]);
        assert_null(j.dae.plan[1]);
        close_job(&j);
    }
    struct job few, many; // where both take as long lies between, (8.16)
    open_job(&few, spin_up, CT_TREE_JOINTS, 2);
    open_job(&many, spin_up, CT_TREE_JOINTS, 20);
    printf("%d and %d speeds\n", few.dae.nu, many.dae.nu);
    assert_null(few.dae.plan[1]);
    assert_non_null(many.dae.plan[1]);
    close_job(&few);
    close_job(&many);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(sparse_matrices_have_the_solutions_of_full_ones),
        cmocka_unit_test(inner_values_change_nothing),
        cmocka_unit_test(unsound_pivots_are_sought_anew),
        cmocka_unit_test(positive_definite_matrices_do_not_fill),
        cmocka_unit_test(entries_of_the_inverse_are_those_of_solutions),
        cmocka_unit_test(steps_of_beams_cost_in_proportion_to_their_elements),
        cmocka_unit_test(what_takes_little_is_not_searched_for_inner_values),
        cmocka_unit_test(small_systems_keep_full_matrices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

int main(void)
{
    return 77; // skipped
}

#endif
