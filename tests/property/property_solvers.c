// Forms solve the equations that dense matrices with full pivoting solve: for every closed shipped
// system, on several trees, at places that have nothing to do with the one where pivots were
// chosen.
#include "tests/property/system.h"

#include <float.h>

enum { STATES = 4 };

// Pivots may have become small here. Then a form says so, and its result is not used.
static const double weak = 1e-3;

static struct ct_solver *form_of(struct variant *v, const struct ct_solver_kind *kind)
{
    const struct ct_partition *s = v->s;
    const struct ct_partition_sets p
        = {s->row, s->dependent, s->independent, (size_t)s->rank, v->m->nu - (size_t)s->rank};
    ct_evaluator_dynamics(v->m);
    return ct_solver_create(v->arena, v->m, &p, 0, kind, NULL);
}

// u' and lam against the dense solution; near a singular configuration that is no reference.
static bool same_accelerations(const struct system *s, struct variant *v, struct ct_solver *f,
                               size_t *n)
{
    struct ct_evaluator *m = v->m;
    double *a = CT_NEWN(v->arena, double, m->nu + 1);
    const double strength = ct_solver_solve(f, m, a);
    ct_evaluator_dynamics(m);
    assert_int_equal(ct_partition_accelerate(v->s), CT_EVAL_OK);
    if (!(strength > weak) || v->s->sigma < weak)
        return true;
    ++*n;
    bool ok = same(s->name, "u'", a, v->s->a, m->nu, 1e-9);
    ct_solver_check(f, m);
    ok &= same(s->name, "u' refined", f->a, v->s->a, m->nu, 1e-10);
    ok &= agree(s->name, "residual", f->refined_remainder, 0, 1, 1e-11);
    ct_partition_multipliers(v->s);
    if (f->rank == m->nrow)
        ok &= same(s->name, "lam", f->lam, v->s->lam, m->nrow, 1e-9);
    return ok;
}

// J_d dq = -Phi, J_d du = -v in the kept rows, and nothing in the independent places.
static bool same_corrections(const struct system *s, struct variant *v, struct ct_solver *f)
{
    struct ct_evaluator *m = v->m;
    bool ok = true;
    if (!(ct_solver_close(f, m) > weak))
        return true;
    ct_evaluator_constraint(m);
    ok &= same(s->name, "Phi", f->phi, m->phi, m->nrow, 0);
    ok &= same(s->name, "v", f->v, m->v, m->nrow, 0);
    for (size_t i = 0; i < f->rank; i++) {
        const size_t row = (size_t)f->row[i];
        double q = m->phi[row], u = m->v[row];
        for (size_t j = 0; j < m->nu; j++) {
            q += m->J[row + m->nrow * j] * f->dq[j];
            u += m->J[row + m->nrow * j] * f->du[j];
        }
        ok &= agree(s->name, "Phi + J dq", q, 0, fmax(1e-3, largest_of(m->phi, m->nrow)),
                    1e-11);
        ok &= agree(s->name, "v + J du", u, 0, fmax(1e-3, largest_of(m->v, m->nrow)), 1e-11);
    }
    for (size_t j = 0; j < m->nu - f->rank; j++)
        ok &= agree(s->name, "independent", f->dq[v->s->independent[j]], 0, 1, 0);
    return ok;
}

// Off the constraints by a little, as stages and states before a projection are.
static void disturb(struct variant *v, double amplitude)
{
    for (size_t i = 0; i < v->m->nq + v->m->nu; i++)
        v->m->input[v->m->at_q + i] += amplitude * chance();
}

static bool check_form(struct system *s, struct variant *v, const struct ct_solver_kind *kind,
                       size_t *n)
{
    struct ct_solver *f = form_of(v, kind);
    bool ok = true;
    if (kind == &ct_solver_symbolic_kkt
        && (size_t)v->s->rank == v->m->nu) { // nothing to solve with M
        assert_null(f);
        return true;
    }
    assert_non_null(f);
    for (int k = 0; k < STATES; k++) {
        struct ct_initial_state state;
        if (!system_random_state(s, 0, 0.4, &state))
            continue;
        variant_set(v, &state, 0);
        ok &= same_accelerations(s, v, f, n);
        disturb(v, 1e-3);
        ok &= same_corrections(s, v, f);
    }
    ct_solver_destroy(v->m, f);
    return ok;
}

static bool check_trees(struct system *s, const struct ct_formulate_options *o,
                        const struct ct_solver_kind *kind, size_t *n)
{
    struct variant v;
    bool ok = true;
    variant_open(s, o, &v);
    variant_set(&v, &s->start, 0);
    ct_evaluator_constraint(v.m);
    assert_true(ct_partition_choose(v.s));
    // an open system has no rows
    if (v.m->nrow && v.m->nu + v.m->nrow < 120)
        ok = check_form(s, &v, kind, n);
    variant_close(&v);
    return ok;
}

static void check_kind(const struct ct_solver_kind *kind)
{
    static const struct ct_formulate_options *const options[]
        = {&by_joints, &by_bodies, &by_joints_spatial};
    bool ok = true;
    size_t n = 0;
    chance_start();
    for (size_t i = 0; i < nshipped; i++)
        for (size_t k = 0; k < COUNT(options); k++) {
            struct system s;
            system_open_file(&s, shipped[i]);
            if (options[k]->keep_all)
                system_keep_all(&s);
            system_no_outputs(&s);
            ok &= check_trees(&s, options[k], kind, &n);
            system_close(&s);
        }
    assert_true(ok);
    assert_true(n > 80); // places where they were compared
}

static void symbolic_solvers_solve_the_equations(void **state)
{
    (void)state;
    check_kind(&ct_solver_symbolic);
}

static void the_solver_of_one_system_solves_the_equations(void **state)
{
    (void)state;
    check_kind(&ct_solver_symbolic_kkt);
}

static void sparse_solvers_solve_the_equations(void **state)
{
    (void)state;
    if (!CT_HAS_KLU)
        skip();
    check_kind(&ct_solver_sparse);
}

// Whatever has become of the pivots, what ct_partition_solve gives is right: it tells where the
// form is of no use.
static void weak_solvers_are_not_used(void **state)
{
    (void)state;
    bool ok = true;
    long fixed = 0, pivoted = 0;
    chance_start();
    for (size_t i = 0; i < nshipped; i++) {
        struct system s;
        struct variant v;
        struct ct_initial_state place;
        system_open_file(&s, shipped[i]);
        system_no_outputs(&s);
        variant_open(&s, &by_bodies, &v);
        variant_set(&v, &s.start, 0);
        assert_true(ct_partition_choose(v.s));
        double *a = CT_NEWN(v.arena, double, v.m->nu + 1);
        for (int k = 0; k < 10 && v.s->has_solver; k++) {
            if (!system_random_state(&s, 0, 2, &place))
                continue;
            variant_set(&v, &place, 0);
            const enum ct_eval e = ct_partition_solve(v.s);
            memcpy(a, v.s->a, v.m->nu * sizeof *a);
            ct_evaluator_dynamics(v.m);
            if (ct_partition_accelerate(v.s) != CT_EVAL_OK || v.s->sigma < weak)
                continue;
            assert_int_equal(e, CT_EVAL_OK);
            ok &= same(s.name, "u'", a, v.s->a, v.m->nu, 1e-9);
        }
        fixed += v.s->solves.fixed;
        pivoted += v.s->solves.pivoted;
        variant_close(&v);
        system_close(&s);
    }
    assert_true(ok);
    assert_true(fixed > 10);
    assert_true(pivoted > 10);
}

// What rows leave after a projection of y (ny, in and out), over what round-off would leave.
static double left_after_projection(struct variant *v, double *y)
{
    struct ct_evaluator *m = v->m;
    const double u = fmax(1, largest_of(y + m->nq, m->nu));
    if (ct_partition_project(v->s, 0, y) != CT_EVAL_OK)
        return INFINITY;
    ct_evaluator_set(m, 0, y);
    ct_evaluator_constraint(m);
    return fmax(largest_of(m->phi, m->nrow), largest_of(m->v, m->nrow) / u) / 1e-12;
}

// From any distance: near ones are corrected with one evaluation, from far ones the terms of second
// order would be seen.
static bool projections_end_on_rows_of(struct system *s, const struct ct_formulate_options *o,
                                       size_t *n)
{
    struct variant v;
    struct ct_initial_state place;
    bool ok = true;
    variant_open(s, o, &v);
    variant_set(&v, &s->start, 0);
    ct_evaluator_constraint(v.m);
    assert_true(ct_partition_choose(v.s));
    double *y = CT_NEWN(v.arena, double, v.m->nq + v.m->nu + 1);
    for (double far = 1e-2; far > 1e-13 && v.s->has_solver && v.m->nu < 40; far /= 10) {
        if (!system_random_state(s, 0, 0.2, &place))
            continue;
        variant_set(&v, &place, 0);
        disturb(&v, far);
        memcpy(y, v.m->input + v.m->at_q, (v.m->nq + v.m->nu) * sizeof *y);
        const double left = left_after_projection(&v, y);
        if (v.s->sigma < 1e-2 || v.s->kappa > 100) // nearly singular: round-off counts more
            continue;
        ok &= agree(s->name, "what rows leave", left, 0, 1, 1);
        ++*n;
    }
    variant_close(&v);
    return ok;
}

static void projections_end_on_rows(void **state)
{
    (void)state;
    bool ok = true;
    size_t n = 0;
    chance_start();
    for (size_t i = 0; i < nshipped; i++) {
        struct system s;
        system_open_file(&s, shipped[i]);
        system_no_outputs(&s);
        ok &= projections_end_on_rows_of(&s, &by_joints, &n);
        ok &= projections_end_on_rows_of(&s, &by_bodies, &n);
        system_close(&s);
    }
    print_message("%zu projections\n", n);
    assert_true(ok);
    assert_true(n > 200);
}

static struct ct_solve_counts run_for(const char *file, const struct ct_formulate_options *o,
                                      double duration)
{
    const struct ct_run_options options = {.method = ct_method_find("dopri5"),
                                           .duration = duration,
                                           .rtol = 1e-9,
                                           .atol = 1e-11,
                                           .nsample = 20};
    struct system s;
    struct variant v;
    struct ct_run_report report;
    system_open_file(&s, file);
    system_no_outputs(&s);
    variant_open(&s, o, &v);
    struct ct_run *run = ct_run_create(&v.ctx, v.arena, &s.model, &v.e, &s.start);
    assert_non_null(run);
    assert_true(ct_run_simulate(run, &options, &report));
    assert_true(report.solves.fixed > 0);
    assert_true(report.energy_drift < 1e-8);
    variant_close(&v);
    system_close(&s);
    return report.solves;
}

// Past a position that is nearly singular the rows and columns change, and with them the form;
// beside it residuals grow and are taken off. A singular one is crossed with the choice that there
// was before.
static void runs_refine_solutions_and_reorder_pivots(void **state)
{
    (void)state;
    const struct ct_formulate_options joints = {.tree = CT_TREE_JOINTS, .with_energy = true},
                                      bodies = {.tree = CT_TREE_ABSOLUTE, .with_energy = true};
    struct ct_solve_counts s = run_for("systems/n_four_bar/model.yaml", &joints, 2);
    assert_true(s.fixed > 10 * s.pivoted);
    s = run_for("systems/four_bar_near_singular/model.yaml", &joints, 1.5);
    assert_true(s.reordered > 0);
    assert_true(s.fixed > s.pivoted);
    s = run_for("systems/four_bar_near_singular/model.yaml", &bodies, 4);
    assert_true(s.refined > 0);
    assert_true(s.reordered > 0);
}

// A chain of links with a coordinate each for place and angle: everything is coupled with
// everything in the reduced mass matrix, and next to nothing in the sparse one.
static const char *chain_text(struct ct_arena *a, int n)
{
    const char *text = "cotree: 1\nname: chain\ngravity: [0, -9.81, 0]\nbodies:\n";
    for (int i = 1; i <= n; i++)
        text = text_of(a,
                       "%s  link%d: {mass: 1, com: [1/2, 0, 0], inertia: 1/12, points: {end: "
                       "[1, 0, 0]}}\n",
                       text, i);
    text = text_of(a, "%sjoints:\n  pin1: {type: revolute, from: ground, to: link1}\n", text);
    for (int i = 2; i <= n; i++)
        text = text_of(a, "%s  pin%d: {type: revolute, from: link%d.end, to: link%d}\n", text,
                       i, i - 1, i);
    return text;
}

static const struct ct_solver_kind *cheapest_for_chain(int n)
{
    struct system s;
    struct variant v;
    struct ct_arena *a = ct_arena_create();
    assert_non_null(a);
    system_open_text(&s, "chain", chain_text(a, n));
    variant_open(&s, &by_bodies, &v);
    variant_set(&v, &s.start, 0);
    assert_true(ct_partition_choose(v.s));
    const struct ct_solver_kind *kind = v.s->has_solver ? v.s->solver[0]->kind : NULL;
    variant_close(&v);
    system_close(&s);
    ct_arena_destroy(a);
    return kind;
}

// Is a sparse solver of a chain of n links, with 5 n unknowns, considered? cost (out): its
// predicted one over that of the best other solver.
static bool is_sparse_considered(int n, double *cost)
{
    struct system s;
    struct variant v;
    struct ct_arena *a = ct_arena_create();
    system_open_text(&s, "chain", chain_text(a, n));
    variant_open(&s, &by_bodies, &v);
    variant_set(&v, &s.start, 0);
    assert_true(ct_partition_choose(v.s));
    const struct ct_solver_costs c = v.s->costs;
    struct ct_solver *f = form_of(&v, &ct_solver_sparse);
    *cost = f->cost / fmin(c.dense, fmin(c.symbolic, c.symbolic_kkt));
    print_message("%d links: sparse %.0f, symbolic %.0f, one system %.0f, dense %.0f\n", n,
                  f->cost, c.symbolic, c.symbolic_kkt, c.dense);
    ct_solver_destroy(v.m, f);
    variant_close(&v);
    system_close(&s);
    ct_arena_destroy(a);
    return !isnan(c.sparse);
}

// Of fewer than a hundred unknowns it would cost several times the others.
static void small_systems_are_not_sparse(void **state)
{
    (void)state;
    if (!CT_HAS_KLU)
        skip();
    double cost;
    assert_false(is_sparse_considered(4, &cost));
    assert_true(cost > 2);
    assert_false(is_sparse_considered(12, &cost));
    assert_true(cost > 2);
    assert_true(is_sparse_considered(40, &cost));
}

static void the_cheapest_solver_is_chosen(void **state)
{
    (void)state;
    assert_ptr_equal(cheapest_for_chain(3), &ct_solver_symbolic);
    assert_ptr_equal(cheapest_for_chain(60), &ct_solver_symbolic_kkt);
}

// n four-bars in a row, as systems/n_four_bar has them.
static const char *row_text(struct ct_arena *a, int n)
{
    static const char bar[]
        = "{mass: 1, inertia: 1/12, com: [1/2, 0, 0], points: {end: [1, 0, 0]}}";
    const char *text
        = "cotree: 1\nname: row\ngravity: [0, -9.81, 0]\nbodies:\n  ground:\n    points:\n";
    for (int i = 0; i <= n; i++)
        text = text_of(a, "%s      a%d: [%d, 0, 0]\n", text, i, i);
    for (int i = 0; i <= n; i++)
        text = text_of(a, "%s  crank%d: %s\n", text, i, bar);
    for (int i = 1; i <= n; i++)
        text = text_of(a, "%s  coupler%d: %s\n", text, i, bar);
    text = text_of(a, "%sjoints:\n", text);
    for (int i = 0; i <= n; i++)
        text = text_of(a,
                       "%s  foot%d: {type: revolute, from: ground.a%d, to: crank%d, initial: "
                       "{q: 1, u: -1, guess: %s}}\n",
                       text, i, i, i, i ? "true" : "false");
    for (int i = 1; i <= n; i++)
        text
            = text_of(a,
                      "%s  left%d: {type: revolute, from: crank%d.end, to: coupler%d, initial: "
                      "{q: -1, guess: true}}\n"
                      "  right%d: {type: revolute, from: coupler%d.end, to: crank%d.end, "
                      "initial: {q: 1, guess: true}}\n",
                      text, i, i - 1, i, i, i, i);
    return text;
}

// A four-bar whose coupler is a beam of n elements.
static const char *beam_text(struct ct_arena *a, int n)
{
    return text_of(
        a,
        "cotree: 1\nname: beam\ngravity: [0, -9.81, 0]\nbodies:\n"
        "  ground: {points: {foot: [1, 0, 0]}}\n"
        "  crank: {mass: 1, inertia: 1/12, com: [1/2, 0, 0], points: {end: [1, 0, 0]}}\n"
        "  rocker: {mass: 1, inertia: 1/12, com: [1/2, 0, 0], points: {end: [1, 0, 0]}}\n"
        "  coupler: {type: beam, length: 1, elements: %d, density: 3000, E: 7e10, area: 4e-4, "
        "Iz: 2e-7, formulation: foreshortening, points: {end: length}}\n"
        "joints:\n"
        "  a: {type: revolute, from: ground, to: crank, initial: {q: 1, u: -1}}\n"
        "  b: {type: revolute, from: crank.end, to: coupler, initial: {q: -1, guess: true}}\n"
        "  c: {type: revolute, from: coupler.end, to: rocker.end, initial: {q: 1, guess: "
        "true}}\n"
        "  d: {type: revolute, from: ground.foot, to: rocker, initial: {q: 1, guess: true}}\n",
        n);
}

static double operations_for(const char *(*text)(struct ct_arena *a, int n), int n)
{
    struct system s;
    struct variant v;
    struct ct_arena *a = ct_arena_create();
    assert_non_null(a);
    system_open_text(&s, "row", text(a, n));
    variant_open(&s, &by_joints, &v);
    variant_set(&v, &s.start, 0);
    assert_true(ct_partition_choose(v.s));
    assert_true(v.s->has_solver);
    const double operations = v.s->solver[0]->operations;
    variant_close(&v);
    system_close(&s);
    ct_arena_destroy(a);
    return operations;
}

// Twice the loops, twice the operations.
static void cost_grows_with_the_number_of_loops(void **state)
{
    (void)state;
    const double few = operations_for(row_text, 10), many = operations_for(row_text, 20),
                 most = operations_for(row_text, 40);
    assert_true(few > 0);
    assert_true(many - few > 0);
    assert_true(fabs((most - many) / (many - few) - 2) < 0.05);
}

// Twice the elements, twice the operations, though the columns next to the cut are joined to all of
// them.
static void cost_grows_with_the_number_of_elements(void **state)
{
    (void)state;
    const double few = operations_for(beam_text, 5), many = operations_for(beam_text, 10),
                 most = operations_for(beam_text, 20);
    assert_true(few > 0);
    assert_true(many - few > 0);
    assert_true(fabs((most - many) / (many - few) - 2) < 0.1);
}

// u' by the form of a system near its start: from the tape, and from native code where there is
// any. Their number.
static size_t solve_by_both(const char *path, double a[2][16])
{
    struct system s;
    struct variant v;
    system_open_file(&s, path);
    system_no_outputs(&s);
    variant_open(&s, &by_joints, &v);
    variant_set(&v, &s.start, 0);
    ct_evaluator_constraint(v.m);
    assert_true(ct_partition_choose(v.s));
    struct ct_solver *f = form_of(&v, &ct_solver_symbolic);
    const size_t nu = v.m->nu;
    assert_true(nu <= 16);
    disturb(&v, 1e-3);
    ct_evaluator_use(v.arena, v.m, CT_BACKEND_TAPE);
    ct_solver_solve(f, v.m, a[0]);
    ct_evaluator_use(v.arena, v.m, CT_BACKEND_BEST);
    ct_solver_solve(f, v.m, a[1]);
    variant_close(&v);
    system_close(&s);
    return nu;
}

// The program of a form has the same bits in every back end where it is short; native code fuses
// products with sums in longer ones, which changes round-off errors: there are a thousand of them
// at most.
static void back_ends_agree(void **state)
{
    static const char *const longer[]
        = {"systems/andrews/model.yaml", "systems/bricard/model.yaml"};
    double a[2][16];
    (void)state;
    chance_start();
    size_t nu = solve_by_both("systems/n_four_bar/model.yaml", a);
    assert_memory_equal(a[0], a[1], nu * sizeof a[0][0]);
    for (size_t i = 0; i < COUNT(longer); i++) {
        nu = solve_by_both(longer[i], a);
        assert_true(same(longer[i], "u' of native code", a[1], a[0], nu, 1e-12));
        assert_true(memcmp(a[0], a[1], nu * sizeof a[0][0]) != 0 || !ct_native_is_available(4));
    }
}

int main(void)
{
    const struct CMUnitTest tests[]
        = {cmocka_unit_test(symbolic_solvers_solve_the_equations),
           cmocka_unit_test(the_solver_of_one_system_solves_the_equations),
           cmocka_unit_test(sparse_solvers_solve_the_equations),
           cmocka_unit_test(weak_solvers_are_not_used),
           cmocka_unit_test(projections_end_on_rows),
           cmocka_unit_test(runs_refine_solutions_and_reorder_pivots),
           cmocka_unit_test(the_cheapest_solver_is_chosen),
           cmocka_unit_test(small_systems_are_not_sparse),
           cmocka_unit_test(cost_grows_with_the_number_of_loops),
           cmocka_unit_test(cost_grows_with_the_number_of_elements),
           cmocka_unit_test(back_ends_agree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
