// Constraints that depend on each other: which, what they leave open, long runs, singular
// configurations; and the linear graphs of real systems.
#include "graph/graph.h"
#include "tests/property/mechanism.h"
#include "tests/property/system.h"

static struct ct_run *open_run(struct system *s, struct variant *v)
{
    struct ct_run *run = ct_run_create(&v->ctx, v->arena, &s->model, &v->e, &s->start);
    if (!run)
        ct_ctx_print(&v->ctx, stderr);
    assert_non_null(run);
    return run;
}

// ---- what is open -------------------------------------------------------------------------------

static void parallel_hinges_in_space_leave_three_reactions_open(void **state)
{
    (void)state;
    static const char *const known[]
        = {"top_pin.force.x",   "top_pin.force.y",    "crank_pin.force.x",
           "crank_pin.force.y", "rocker_pin.force.x", "rocker_pin.torque.z"};
    static const char *const open[]
        = {"top_pin.force.z", "top_pin.torque.x", "top_pin.torque.y", "crank_pin.torque.x",
           "crank_pin.force.z"};
    struct system s;
    struct variant v;
    system_open_file(&s, "systems/spatial_four_bar/model.yaml");
    system_keep_all(&s);
    system_no_outputs(&s);
    system_output_reactions(&s);
    variant_open(&s, &by_joints_spatial, &v);
    struct ct_run *run = open_run(&s, &v);
    bool *row = CT_NEWN(v.arena, bool, v.e.nrow), *result = CT_NEWN(v.arena, bool, v.e.nresult);
    ct_run_find_undetermined(run, 0, ct_run_state(run), row, result);
    const struct ct_partition *embed = ct_run_partition(run);
    assert_int_equal(v.e.nrow, 5);
    assert_int_equal(embed->rank, 2);
    size_t n = 0;
    const char *joint = s.model.joint[v.e.row[0].joint].name;
    for (size_t i = 0; i < v.e.nrow; i++) {
        n += row[i];
        assert_true(strncmp(v.e.row[i].name, joint, strlen(joint)) == 0);
    }
    assert_int_equal(n, 3);
    for (size_t i = 0; i < COUNT(known); i++)
        assert_false(result[variant_result(&v, known[i])]);
    for (size_t i = 0; i < COUNT(open); i++)
        assert_true(result[variant_result(&v, open[i])]);
    variant_close(&v);
    system_close(&s);
}

static void multipliers_have_the_least_norm(void **state)
{
    (void)state;
    static const char *const file[]
        = {"systems/spatial_four_bar/model.yaml", "systems/bricard/model.yaml"};
    chance_start();
    for (size_t i = 0; i < COUNT(file); i++) {
        struct system s;
        struct variant v;
        struct ct_initial_state at;
        system_open_file(&s, file[i]);
        system_keep_all(&s);
        system_no_outputs(&s);
        variant_open(&s, &by_bodies_spatial, &v);
        assert_true(system_random_state(&s, 0, 0.3, &at));
        variant_set(&v, &at, 0);
        assert_true(variant_solve(&v));
        assert_true(v.s->rank < (int)v.e.nrow);
        double *z = CT_NEWN(v.arena, double, v.e.nrow), largest = 1;
        for (size_t r = 0; r < v.e.nrow; r++)
            largest = fmax(largest, fabs(v.s->lam[r]));
        bool ok = true;
        struct ct_null_space *null_space = ct_null_space_create(v.arena, v.s);
        for (size_t r = 0; r < v.e.nrow; r++) { // lam has no part in null(J')
            double part = 0;
            ct_null_space_vector(null_space, (int)r, z);
            for (size_t k = 0; k < v.e.nrow; k++)
                part += z[k] * v.s->lam[k];
            ok &= agree(file[i], v.e.row[r].name, part, 0, largest, 1e-9);
        }
        // and they balance the equations of motion
        const double *M = ct_partition_mass(v.s);
        for (size_t k = 0; k < v.e.nu; k++) {
            double sum = -v.m->Q[k];
            for (size_t l = 0; l < v.e.nu; l++)
                sum += M[k + v.e.nu * l] * v.s->a[l];
            for (size_t r = 0; r < v.e.nrow; r++)
                sum -= v.m->J[r + v.e.nrow * k] * v.s->lam[r];
            ok &= agree(file[i], v.e.u[k].name, sum, 0, 10 * largest, 1e-9);
        }
        assert_true(ok);
        variant_close(&v);
        system_close(&s);
    }
}

// ---- runs ---------------------------------------------------------------------------------------

static bool go_on(void *user, double t, const double *value, size_t n)
{
    (void)user;
    (void)t;
    (void)value;
    (void)n;
    return true;
}

static void expect_run(const char *file, const struct ct_formulate_options *o,
                       const char *method, double duration, double energy)
{
    struct system s;
    struct variant v;
    struct ct_run_report report;
    const struct ct_run_options run = {.method = ct_method_find(method),
                                       .duration = duration,
                                       .rtol = 1e-11,
                                       .atol = 1e-12,
                                       .nsample = 101,
                                       .row = go_on};
    system_open_file(&s, file);
    system_no_outputs(&s);
    variant_open(&s, o, &v);
    const bool ok = ct_run_simulate(open_run(&s, &v), &run, &report);
    if (!ok)
        ct_ctx_print(&v.ctx, stderr);
    print_message("%s, %s, %g s: %ld steps, energy %.2g, position %.2g, velocity %.2g\n", file,
                  method, duration, report.stats.steps, report.energy_drift,
                  report.position_constraint, report.velocity_constraint);
    assert_true(ok);
    assert_true(report.energy_drift < energy);
    assert_true(report.position_constraint < 1e-10 && report.velocity_constraint < 1e-9);
    variant_close(&v);
    system_close(&s);
}

static void bricard_mechanism_stays_on_its_manifold(void **state)
{
    (void)state;
    expect_run("systems/bricard/model.yaml", &by_choice, "dop853", 100, 1e-8);
}

// The aligned positions, where rank(J) falls, are passed again and again.
static void four_bars_in_a_row_pass_singular_configurations(void **state)
{
    (void)state;
    static const char *const file[]
        = {"tests/reference/R05_N1.yaml", "tests/reference/R05_N2.yaml",
           "tests/reference/R05_N3.yaml", "tests/reference/R05_N5.yaml",
           "tests/reference/R13_d1.yaml"};
    for (size_t i = 0; i < COUNT(file); i++)
        expect_run(file[i], &by_choice, "dopri5", 10, 1e-8);
}

struct lookout {
    struct ct_run *run;
    double most;
    int nbeside, nfar;
    bool ok;
};

// Each sample is the end of a step.
static bool compare_with_pivot(void *user, double t, const double *value, size_t n)
{
    (void)value;
    (void)n;
    struct lookout *l = user;
    struct ct_partition *s = ct_run_partition(l->run);
    ct_evaluator_constraint(ct_run_evaluator(l->run));
    const double pivot = ct_partition_pivot(s);
    l->most = fmax(l->most, pivot);
    const bool is_beside = pivot<0.3 * l->most, is_far = pivot> 0.7 * l->most;
    l->nbeside += is_beside;
    l->nfar += is_far && t > 0;
    l->ok &= !(is_beside && !s->is_near_singular) && !(is_far && s->is_near_singular);
    return true;
}

// Fixed steps look at J only where the pivots of the form have changed, and seek pivots at every
// evaluation all the same where the mechanism is near a singular configuration, with redundant rows
// or without.
static void fixed_steps_report_singular_configurations(void **state)
{
    (void)state;
    static const char *const method[] = {"rk4", "rk4", "radau5", "radau5"};
    for (size_t i = 0; i < COUNT(method); i++) {
        const bool is_spatial = i % 2;
        struct ct_formulate_options o = is_spatial ? by_joints_spatial : by_choice;
        struct system s;
        struct variant v;
        struct ct_run_report report;
        o.with_residual = true;
        system_open_file(&s, "tests/reference/R13_d0999.yaml");
        if (is_spatial)
            system_keep_all(&s);
        system_no_outputs(&s);
        variant_open(&s, &o, &v);
        struct lookout l = {.run = open_run(&s, &v), .ok = true};
        const struct ct_run_options run = {.method = ct_method_find(method[i]),
                                           .duration = 4,
                                           .step = 1e-3,
                                           .nsample = 401,
                                           .row = compare_with_pivot,
                                           .user = &l};
        const bool ok = ct_run_simulate(l.run, &run, &report);
        if (!ok)
            ct_ctx_print(&v.ctx, stderr);
        print_message("%s: %d samples near a singular configuration, %d far from it\n",
                      method[i], l.nbeside, l.nfar);
        assert_true(ok && l.ok && l.nbeside > 0 && l.nfar > 0);
        assert_int_equal(ct_run_partition(l.run)->rank < (int)v.e.nrow, is_spatial);
        variant_close(&v);
        system_close(&s);
    }
}

// ---- linear graphs ------------------------------------------------------------------------------

// A_f B_f' = 0 exactly, and through times across sums to zero for any nodal potentials and chord
// throughs.
static void tree_is_orthogonal(struct variant *v, const struct ct_tree *t)
{
    const struct ct_graph *g = v->e.graph;
    const size_t ne = (size_t)g->nedge;
    struct ct_incidence A, B;
    ct_cutsets_derive(v->arena, g, t, &A);
    ct_circuits_derive(v->arena, g, t, &B);
    int *product = CT_NEWN(v->arena, int, (size_t)A.nrow *(size_t)B.nrow + 1);
    double *across = CT_NEWN(v->arena, double, ne + 1),
           *through = CT_NEWN(v->arena, double, ne + 1);
    double *potential = CT_NEWN(v->arena, double, (size_t)g->nnode),
           *loop = CT_NEWN(v->arena, double, (size_t)B.nrow + 1);
    for (int i = 1; i < g->nnode; i++)
        potential[i] = chance();
    for (int e = 0; e < g->nedge; e++) {
        across[e] = potential[g->edge[e].head] - potential[g->edge[e].tail];
        for (int i = A.start[e]; i < A.start[e + 1]; i++)
            for (int k = B.start[e]; k < B.start[e + 1]; k++)
                product[A.row[i] + A.nrow * B.row[k]] += A.value[i] * B.value[k];
    }
    for (int i = 0; i < A.nrow * B.nrow; i++)
        assert_int_equal(product[i], 0);
    for (int i = 0; i < t->nchord; i++)
        through[t->chord[i]] = chance();
    for (int i = 0; i < t->nchord; i++) // through_t = -A_cut through_c
        for (int k = A.start[t->chord[i]]; k < A.start[t->chord[i] + 1]; k++)
            through[t->branch[A.row[k]]] -= A.value[k] * through[t->chord[i]];
    double power = 0;
    for (int e = 0; e < g->nedge; e++) {
        power += through[e] * across[e];
        for (int k = B.start[e]; k < B.start[e + 1]; k++)
            loop[B.row[k]] += B.value[k] * across[e];
    }
    assert_true(fabs(power) < 1e-12 * (double)(ne + 1));
    for (int i = 0; i < B.nrow; i++)
        assert_true(fabs(loop[i]) < 1e-13 * (double)(ne + 1));
}

static void cutsets_and_circuits_of_real_systems_are_orthogonal(void **state)
{
    (void)state;
    chance_start();
    for (size_t i = 0; i < nshipped + nmechanism; i++) {
        static const struct ct_formulate_options *const how[]
            = {&by_joints, &by_bodies, &by_choice};
        struct system s;
        struct ct_arena *a = ct_arena_create();
        if (i < nshipped)
            system_open_file(&s, shipped[i]);
        else
            system_open_text(&s, mechanisms[i - nshipped].name,
                             mechanism_text(a, &mechanisms[i - nshipped], NULL, 0, true));
        system_no_outputs(&s);
        for (size_t k = 0; k < COUNT(how); k++) {
            struct variant v;
            variant_open(&s, how[k], &v);
            assert_null(ct_tree_check(v.e.graph, v.e.T));
            assert_null(ct_tree_check(v.e.graph, v.e.R));
            tree_is_orthogonal(&v, v.e.T);
            tree_is_orthogonal(&v, v.e.R);
            variant_close(&v);
        }
        system_close(&s);
        ct_arena_destroy(a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parallel_hinges_in_space_leave_three_reactions_open),
        cmocka_unit_test(multipliers_have_the_least_norm),
        cmocka_unit_test(bricard_mechanism_stays_on_its_manifold),
        cmocka_unit_test(four_bars_in_a_row_pass_singular_configurations),
        cmocka_unit_test(fixed_steps_report_singular_configurations),
        cmocka_unit_test(cutsets_and_circuits_of_real_systems_are_orthogonal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
