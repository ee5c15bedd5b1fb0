// Beams that do not stretch in closed loops, with the foreshortening at the starts of elements for
// further unknowns (beam_augmented.h): the same equations, the same solution, and cost in
// proportion to the elements.
#include "formulate/closed_form/beam_augmented.h"
#include "tests/property/system.h"

#include <float.h>

static const struct ct_formulate_options by_joints_solved
    = {.tree = CT_TREE_JOINTS, .with_solution = true},
    all_kept = {.tree = CT_TREE_JOINTS, .with_solution = true, .keep_all = true};

// ---- loops of beams -----------------------------------------------------------------------------

struct loop {
    const char *name;
    char *(*text)(struct ct_arena *a, const struct loop *l, int n);
    const char *beam, *body, *joint; // more of each
    bool keep_all;                   // with rows that depend on others
    int few; // elements from which operations are counted; 0: they are not
};

// A slider-crank with its rod, and what is welded to it, in a plane.
static char *rod_text(struct ct_arena *a, const struct loop *l, int n)
{
    return text_of(
        a,
        "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n"
        "  crank: {mass: 0.3, inertia: 3e-4, com: [0.05, 0, 0], points: {pin: [0.1, 0, 0]}}\n"
        "  rod: {type: beam, length: 0.3, elements: %d, density: 2700, E: 7e10, "
        "deformation: [bending-z], formulation: foreshortening, points: {mid: 0.14, tip: "
        "length}, %s}\n"
        "  slider: {mass: 0.4}\n%s"
        "joints:\n"
        "  main: {type: revolute, from: ground, to: crank, initial: {q: 0.5, u: 10}}\n"
        "  big_end: {type: revolute, from: crank.pin, to: rod, initial: {q: -0.6, guess: "
        "true}}\n"
        "  small_end: {type: revolute, from: rod.tip, to: slider, initial: {q: 0.15, guess: "
        "true}}\n"
        "  guide: {type: prismatic, from: ground, to: slider, axis: x, initial: {q: 0.38, "
        "guess: "
        "true}}\n%s",
        n, l->beam, l->body, l->joint);
}

// A four-bar of two beams, one after the other.
static char *two_text(struct ct_arena *a, const struct loop *l, int n)
{
    return text_of(
        a,
        "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n  ground: {points: {foot: [1, 0, 0]}}\n"
        "  crank: {mass: 1, inertia: 1/12, com: [1/2, 0, 0], points: {end: [1, 0, 0]}}\n"
        "  rocker: {type: beam, length: 1, elements: %d, density: 3000, E: 7e10, area: 4e-4, "
        "Iz: "
        "2e-7, "
        "deformation: [bending-z], formulation: foreshortening, points: {end: length}, %s}\n"
        "  coupler: {type: beam, length: 1, elements: 7, density: 3000, E: 7e10, area: 4e-4, "
        "Iz: "
        "2e-7, "
        "deformation: [bending-z], formulation: foreshortening, points: {end: length}}\n%s"
        "joints:\n"
        "  a: {type: revolute, from: ground, to: crank, initial: {q: 1, u: -1}}\n"
        "  b: {type: revolute, from: crank.end, to: coupler, initial: {q: -1, guess: true}}\n"
        "  c: {type: revolute, from: coupler.end, to: rocker.end, initial: {q: 1, guess: "
        "true}}\n"
        "  d: {type: revolute, from: ground.foot, to: rocker, initial: {q: 1, guess: "
        "true}}\n%s",
        n, l->beam, l->body, l->joint);
}

// The rod between a ball and a universal joint, its slider along an axis beside the plane of the
// crank.
static char *space_text(struct ct_arena *a, const struct loop *l, int n)
{
    return text_of(
        a,
        "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n  ground: {points: {rail: [0, 0, 0.05]}}\n"
        "  crank: {mass: 0.3, inertia: [1e-4, 3e-4, 3e-4], com: [0.05, 0, 0], points: {pin: "
        "[0.1, 0, 0]}}\n"
        "  rod: {type: beam, length: 0.3, elements: %d, density: 2700, E: 7e10, G: 2.6e10, "
        "area: "
        "1e-4, J: 2e-9, Iy: 1e-9, "
        "Iz: 2e-9, deformation: [bending-y, bending-z, torsion], formulation: foreshortening, "
        "points: {mid: 0.14, tip: length}, %s}\n"
        "  slider: {mass: 0.4, inertia: [1e-4, 2e-4, 2e-4]}\n%s"
        "joints:\n"
        "  main: {type: revolute, from: ground, to: crank, initial: {q: 0.5, u: 10}}\n"
        "  big_end: {type: spherical, from: crank.pin, to: rod}\n"
        "  small_end: {type: universal, from: rod.tip, to: slider, axes: [y, z], initial: {q: "
        "[0.1, 0.1], guess: true}}\n"
        "  guide: {type: prismatic, from: ground.rail, to: slider, axis: x, initial: {q: 0.38, "
        "guess: true}}\n%s",
        n, l->beam, l->body, l->joint);
}

// A coupler on two balls; what is welded to it turns it about its axis.
static char *ball_text(struct ct_arena *a, const struct loop *l, int n)
{
    return coupler_text(a, n, l->beam, l->body, l->joint);
}

#define EVEN "area: 1e-4, Iz: 1e-9, "
#define COLLAR "  lump: {mass: 0.02, inertia: [1e-5, 1e-5, 1e-5], com: [0, 0.01, 0]}\n"
#define AT_SECTION "  seat: {type: weld, from: rod.mid, to: lump}\n"
#define AT_START "  seat: {type: weld, from: rod, to: lump}\n"

static const struct loop loops[] = {
    {"clamped", rod_text, EVEN "frame: clamped", "", "", false, 12},
    {"chord", rod_text, EVEN "frame: chord", "", "", false, 12},
    {"Timoshenko", rod_text,
     EVEN "theory: timoshenko, nu: 0.3, rotary_inertia: true, shear_factor: 0.85", "", "",
     false, 16},
    {"rotary inertia", rod_text, EVEN "frame: chord, rotary_inertia: true", "", "", false, 0},
    {"tapered", rod_text, "area: 1e-4*(1 - x), Iz: 1e-9*(1 - x)^3", "", "", false, 0},
    {"body at a section", rod_text, EVEN "frame: chord",
     "  lump: {mass: 0.05, inertia: 1e-5, com: [0, 0.01, 0]}\n",
     "  seat: {type: weld, from: rod.mid, to: lump}\n", false, 0},
    {"lumped", rod_text, EVEN "mass: lumped, frame: chord", "", "", false, 12},
    {"lumped, body at a section", rod_text, EVEN "mass: lumped, frame: chord",
     "  lump: {mass: 0.05, inertia: 1e-5, com: [0, 0.01, 0]}\n",
     "  seat: {type: weld, from: rod.mid, to: lump}\n", false, 16},
    {"two beams", two_text, "frame: clamped", "", "", false, 12},
    {"two beams, a chord", two_text, "frame: chord", "", "", false, 0},
    {"redundant rows", two_text, "frame: clamped", "", "", true, 0},
    {"space", space_text, "frame: clamped", "", "", false, 12},
    {"space, chord", space_text, "frame: chord, rotary_inertia: true", "", "", false, 0},
    {"lumped in a loop of two", two_text, "mass: lumped, frame: chord", "", "", false, 12},
    {"lumped on balls", ball_text, "mass: lumped, frame: chord", COLLAR, AT_SECTION, false, 12},
    {"lumped on balls, body at the start", ball_text, "mass: lumped, frame: clamped", COLLAR,
     AT_START, false, 0},
    {"lumped on balls, rotary inertia", ball_text,
     "mass: lumped, frame: clamped, rotary_inertia: [8e-6, 3e-6, 5e-6]", COLLAR, AT_SECTION,
     false, 0},
    {"lumped on balls, Timoshenko", ball_text,
     "mass: lumped, frame: chord, theory: timoshenko, shear_factor: 0.85", COLLAR, AT_SECTION,
     false, 0},
    {"space, body at a section", space_text, "frame: clamped",
     "  lump: {mass: 0.05, inertia: [1e-5, 1e-5, 1e-5], com: [0, 0.01, 0]}\n",
     "  seat: {type: weld, from: rod.mid, to: lump}\n", false, 0},
};

static void loop_open(struct system *s, const struct loop *l, int n, struct variant *v)
{
    struct ct_arena *a = ct_arena_create();
    assert_non_null(a);
    system_open_text(s, l->name, l->text(a, l, n));
    if (l->keep_all)
        system_keep_all(s);
    system_no_outputs(s);
    variant_open(s, l->keep_all ? &all_kept : &by_joints_solved, v);
    variant_set(v, &s->start, 0);
    const bool is_chosen = ct_partition_choose(v->s);
    if (!is_chosen)
        print_error("%s: no rows and columns\n", l->name);
    assert_true(is_chosen);
    ct_arena_destroy(a);
}

// Beams bend by a tenth of a radian or so, at rates of the same size; the loops need not be closed
// for that.
static void bend(struct variant *v)
{
    struct ct_evaluator *m = v->m;
    for (size_t k = 0; k < m->nu; k++) {
        const struct ct_u *u = &v->e.u[k];
        const double size = !u->beam ? 0.1 : u->kind == CT_ELASTIC_TURN ? 0.1 : 0.005;
        if (u->q < 0)
            continue;
        if (u->beam)
            m->input[m->at_q + (size_t)u->q] = size * chance();
        m->input[m->at_u + k] = 10 * size * chance();
    }
}

// ---- properties ---------------------------------------------------------------------------------

// Column j of P' M_c P and of J_c P as expressions, behind each other (nu + nrow).
static void column_of(const struct variant *v, struct ct_exs *x, size_t j, ct_ex *y, ct_ex *f,
                      ct_ex *out)
{
    const struct ct_beam_augmented *c = v->e.augmented;
    const size_t nu = v->e.nu;
    memset(y, 0, c->n * sizeof *y);
    memset(f, 0, c->n * sizeof *f);
    memset(out, 0, (nu + v->e.nrow) * sizeof *out);
    y[j] = CT_EX_ONE;
    ct_beam_augmented_extend(x, v->arena, c, y);
    for (size_t i = 0; i < c->nM; i++) {
        const struct ct_entry *e = &c->M[i];
        f[e->row] = ct_ex_add_product(x, f[e->row], e->value, y[e->column]);
        if (e->row != e->column)
            f[e->column] = ct_ex_add_product(x, f[e->column], e->value, y[e->row]);
    }
    ct_beam_augmented_project(x, v->arena, c, f);
    memcpy(out, f, nu * sizeof *out);
    for (size_t i = 0; i < c->nJ; i++) {
        ct_ex *to = &out[nu + (size_t)c->J[i].row];
        *to = ct_ex_add_product(x, *to, c->J[i].value, y[c->J[i].column]);
    }
}

// M = P' M_c P and J = J_c P, entry by entry.
static bool matrices_agree(const struct loop *l, struct variant *v)
{
    const size_t nu = v->e.nu, nrow = v->e.nrow, n = nu + nrow, nc = v->e.augmented->n;
    struct ct_evaluator *m = v->m;
    struct ct_exs *x = ct_exs_clone(v->arena, v->e.x);
    ct_ex *y = CT_NEWN(v->arena, ct_ex, nc), *f = CT_NEWN(v->arena, ct_ex, nc),
          *out = CT_NEWN(v->arena, ct_ex, n);
    double *got = CT_NEWN(v->arena, double, n), *value = CT_NEWN(v->arena, double, x->nsym + 1);
    bool ok = true;
    ct_evaluator_dynamics(m);
    const double *M = ct_partition_mass(v->s);
    ct_evaluator_values(m, x, value);
    for (size_t j = 0; j < nu; j++) {
        column_of(v, x, j, y, f, out);
        ct_ex_values(x, v->arena, out, n, value, got);
        ok &= same(l->name, "M", got, M + nu * j, nu, 1e-13);
        for (size_t i = 0; i < nrow; i++)
            ok &= agree(l->name, "J", got[nu + i], m->J[i + nrow * j], 1, 1e-13);
    }
    return ok;
}

// How far a few round-off errors of M move the accelerations, relative to the largest.
static double sensitivity(struct variant *v)
{
    const size_t nu = v->m->nu;
    double *a = CT_NEWN(v->arena, double, nu), most = 0;
    memcpy(a, v->s->a, nu * sizeof *a);
    for (int k = 0; k < 3; k++) {
        ct_evaluator_dynamics(v->m);
        for (size_t i = 0; i < v->e.nM; i++)
            v->m->M[i] *= 1 + 10 * DBL_EPSILON * chance();
        assert_int_equal(ct_partition_accelerate(v->s), CT_EVAL_OK);
        for (size_t i = 0; i < nu; i++)
            most = fmax(most, fabs(v->s->a[i] - a[i]));
    }
    ct_evaluator_dynamics(v->m);
    assert_int_equal(ct_partition_accelerate(v->s), CT_EVAL_OK);
    return most / largest_of(a, nu);
}

// u' and lam by the form against those by dense matrices.
static bool solutions_agree(const struct loop *l, struct variant *v, struct ct_solver *f)
{
    struct ct_evaluator *m = v->m;
    double *a = CT_NEWN(v->arena, double, m->nu + 1);
    assert_true(ct_solver_solve(f, m, a) > 1e-3);
    ct_evaluator_dynamics(m);
    assert_int_equal(ct_partition_accelerate(v->s), CT_EVAL_OK);
    // three random errors are typical ones, not the worst
    const double tol = fmax(1e-10, 10 * sensitivity(v));
    assert_true(tol < 1e-6); // else nothing is compared
    bool ok = same(l->name, "u'", a, v->s->a, m->nu, tol);
    ct_solver_check(f, m);
    ok &= same(l->name, "u' refined", f->a, v->s->a, m->nu, tol);
    ok &= agree(l->name, "residual", f->refined_remainder, 0, 1, 1e-13);
    double *lam = CT_NEWN(v->arena, double, f->rank + 1);
    ct_partition_retained_multipliers(v->s, lam);
    for (size_t i = 0; i < f->rank; i++)
        for (size_t k = 0; k < f->rank; k++)
            if (v->s->row[k] == f->row[i])
                ok &= agree(l->name, "lam", f->lam[i], lam[k], largest_of(lam, f->rank), tol);
    return ok;
}

static struct ct_partition_sets partition_of(const struct variant *v)
{
    const struct ct_partition *s = v->s;
    return (struct ct_partition_sets){.row = s->row,
                                      .dependent = s->dependent,
                                      .independent = s->independent,
                                      .rank = (size_t)s->rank,
                                      .nfree = v->m->nu - (size_t)s->rank};
}

// The order of the shortest system.
static const struct ct_pivot_order *order_of(struct variant *v)
{
    struct ct_partition_sets p = partition_of(v);
    p.value = ct_solver_values(v->arena, v->m);
    const struct ct_pivot_order *o = ct_pivot_order_find(v->arena, &v->e, &p, v->m->motion.out,
                                                         v->m->Q + v->m->nu, INFINITY);
    assert_non_null(o);
    return o;
}

static void the_augmented_form_gives_the_same_motion(void **state)
{
    (void)state;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < COUNT(loops); i++) {
        struct system s;
        struct variant v;
        loop_open(&s, &loops[i], 15, &v);
        assert_non_null(v.e.augmented);
        assert_true(!loops[i].keep_all || v.s->rank < (int)v.m->nrow);
        ct_evaluator_dynamics(v.m);
        assert_true(order_of(&v)->is_augmented);
        const struct ct_partition_sets p = partition_of(&v);
        struct ct_solver *f
            = ct_solver_create(v.arena, v.m, &p, 0, &ct_solver_symbolic_kkt, NULL);
        assert_non_null(f);
        for (int k = 0; k < 3; k++) {
            ok &= matrices_agree(&loops[i], &v);
            ok &= solutions_agree(&loops[i], &v, f);
            bend(&v);
        }
        ct_solver_destroy(v.m, f);
        variant_close(&v);
        system_close(&s);
    }
    assert_true(ok);
}

static double operations_for(const struct loop *l, int n)
{
    struct system s;
    struct variant v;
    loop_open(&s, l, n, &v);
    assert_true(v.s->has_solver);
    const double operations = v.s->solver[0]->operations;
    variant_close(&v);
    system_close(&s);
    return operations;
}

// Twice the elements, twice the operations.
static void cost_grows_with_the_number_of_elements(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(loops); i++) {
        const int n = loops[i].few;
        if (!n)
            continue;
        const double few = operations_for(&loops[i], n),
                     many = operations_for(&loops[i], 2 * n),
                     most = operations_for(&loops[i], 4 * n);
        print_message("%-24s %.0f %.0f %.0f\n", loops[i].name, few, many, most);
        assert_true(many - few > 0);
        assert_true(fabs((most - many) / (many - few) - 2) < 0.1);
    }
}

// Where sections follow with shear, least degree by itself joins nodes from all over a long beam:
// what is left couples all of them.
static void sections_are_eliminated_along_the_beam(void **state)
{
    (void)state;
    const struct loop l = {"lumped on balls, Timoshenko",
                           ball_text,
                           "mass: lumped, theory: timoshenko, shear_factor: 0.85, frame: chord",
                           COLLAR,
                           AT_SECTION,
                           false,
                           24};
    double of[3];
    for (int k = 0; k < 3; k++)
        of[k] = operations_for(&l, l.few << k);
    print_message("%-24s %.0f %.0f %.0f\n", l.name, of[0], of[1], of[2]);
    assert_true(of[2] - of[1] < 2.4 * (of[1] - of[0])); // 20 % for the way it begins
    struct system s;
    struct variant v;
    loop_open(&s, &l, 2 * l.few, &v);
    ct_evaluator_dynamics(v.m);
    assert_int_equal(order_of(&v)->way, CT_KKT_POSITIONS);
    variant_close(&v);
    system_close(&s);
}

// Few elements take fewer operations without: nothing is derived for them.
static void short_beams_have_no_augmented_form(void **state)
{
    (void)state;
    struct system s;
    struct variant v;
    loop_open(&s, &loops[0], 4, &v);
    assert_null(v.e.augmented);
    variant_close(&v);
    system_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[]
        = {cmocka_unit_test(the_augmented_form_gives_the_same_motion),
           cmocka_unit_test(cost_grows_with_the_number_of_elements),
           cmocka_unit_test(sections_are_eliminated_along_the_beam),
           cmocka_unit_test(short_beams_have_no_augmented_form)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
