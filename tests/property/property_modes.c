// Whatever the trees: the same equilibrium, the same natural motions about it. With the derivative
// of the multipliers' forces; without it they differ.
#include "tests/property/system.h"

#include "analysis/eigenvalues.h"
#include "analysis/equilibrium.h"

enum { MOST = 64 };

// Eigenvalues of well conditioned problems of a few unknowns, about places known to 1e-13.
static const double tolerance = 1e-8;

struct motions {
    size_t n;
    double re[MOST], im[MOST];
};

static const char crank_on_springs[]
    = "cotree: 1\n"
      "gravity: [0, -9.81, 0]\n"
      "bodies:\n"
      "  crank: {mass: 0.4, inertia: 1e-3, com: [0.08, 0, 0], points: {pin: [0.15, 0, 0]}}\n"
      "  rod: {mass: 0.7, inertia: 5e-3, com: [0.15, 0, 0], points: {pin: [0.3, 0, 0]}}\n"
      "  slider: {mass: 0.5}\n"
      "joints:\n"
      "  main: {type: revolute, from: ground, to: crank, stiffness: 3, rest: 0.9, damping: "
      "0.02,\n"
      "    initial: {q: 0.8}}\n"
      "  big_end: {type: revolute, from: crank.pin, to: rod, initial: {q: -1.15, guess: "
      "true}}\n"
      "  small_end: {type: revolute, from: rod.pin, to: slider, initial: {q: 0.35, guess: "
      "true}}\n"
      "  guide: {type: prismatic, from: ground, to: slider, axis: x, stiffness: 200, rest: "
      "0.35,\n"
      "    damping: 0.5, initial: {q: 0.4, guess: true}}\n";

// A four-bar out of its plane's ken: four hinges in space, three of their five loop equations
// redundant.
static const char bars_in_space[]
    = "cotree: 1\n"
      "gravity: [0, -9.81, 1]\n"
      "bodies:\n"
      "  ground: {points: {right: [0.5, 0, 0]}}\n"
      "  crank: {mass: 1, inertia: [0.01, 0.02, 0.02], com: [0.1, 0, 0], points: {pin: [0.2, "
      "0, 0]}}\n"
      "  coupler: {mass: 2, inertia: [0.01, 0.05, 0.05], com: [0.25, 0.05, 0], points: {pin: "
      "[0.5, 0, 0]}}\n"
      "  rocker: {mass: 1.5, inertia: [0.01, 0.03, 0.03], com: [0.2, 0, 0], points: {pin: "
      "[0.4, 0, 0]}}\n"
      "joints:\n"
      "  a: {type: revolute, from: ground, to: crank, stiffness: 20, rest: 1, damping: 0.3, "
      "initial: {q: 1.1}}\n"
      "  b: {type: revolute, from: crank.pin, to: coupler, initial: {q: -1, guess: true}}\n"
      "  c: {type: revolute, from: coupler.pin, to: rocker.pin, stiffness: 4, initial: {q: 1, "
      "guess: true}}\n"
      "  d: {type: revolute, from: ground.right, to: rocker, initial: {q: 1.2, guess: true}}\n";

// Rods, a ball joint and a bushing: quaternions, chords of several kinds.
static const char tripod[]
    = "cotree: 1\n"
      "gravity: [0, 0, -9.81]\n"
      "bodies:\n"
      "  ground: {points: {e1: [0.5, 0, 0], e2: [-0.3, 0.4, 0], f: [0, 0, 0.1]}}\n"
      "  plate: {mass: 3, inertia: [0.1, 0.15, 0.2, 0.01, 0, 0.02],\n"
      "    points: {p1: [0.3, 0, 0], p2: [-0.2, 0.3, 0], p3: [-0.1, -0.4, 0.05]}}\n"
      "  arm: {mass: 0.5, inertia: 0.02, com: [0, 0, 0.2], points: {top: [0, 0, 0.4]}}\n"
      "joints:\n"
      "  ball: {type: spherical, from: ground.f, to: arm, initial: {rotate: [x, 0.2]}}\n"
      "  head: {type: universal, from: arm.top, to: plate.p3}\n"
      "  rod1: {type: distance, from: ground.e1, to: plate.p1}\n"
      "forces:\n"
      "  s1: {type: spring, from: ground.e1, to: plate.p1, stiffness: 50, length: 0.4, "
      "damping: 3}\n"
      "  s2: {type: spring, from: ground.e2, to: plate.p2, stiffness: 400, length: 0.5, "
      "damping: 4}\n"
      "  mount: {type: bushing, from: ground, to: arm.top, stiffness: [900, 800, 700, 60, 50, "
      "40],\n"
      "    damping: [1, 2, 3, 0.1, 0.2, 0.3]}\n";

// ---- motions on trees ---------------------------------------------------------------------------

static bool find_motions(struct system *s, struct variant *v, bool with_multipliers,
                         struct motions *out)
{
    struct ct_linear *l = ct_linear_create(&v->ctx, v->arena, v->m);
    struct ct_equilibrium_result result;
    struct ct_motion_mode *mode;
    const char *how;
    ct_initial_state_apply(&s->start, v->m, l->y);
    memset(l->y + v->m->nq, 0, v->m->nu * sizeof *l->y);
    if (!ct_linear_close(l) || !ct_equilibrium_find(l, &result))
        return false;
    if (!with_multipliers) { // K of the forces alone
        for (size_t i = 0; i < v->m->nrow; i++)
            v->m->input[v->m->at_lam + i] = 0;
        ct_evaluator_tangent(v->m);
        const size_t n = v->m->nu * v->m->nu;
        double *K = CT_NEWN(v->arena, double, 3 * n);
        ct_evaluator_scatter(v->m, K, K + n, K + 2 * n);
        for (int j = 0; j < l->nfree; j++)
            for (int i = 0; i < l->nfree; i++) {
                l->Kr[i + l->nfree * j] = 0;
                for (int p = 0; p < l->nu; p++)
                    for (int q = 0; q < l->nu; q++)
                        l->Kr[i + l->nfree * j]
                            += l->Z[p + l->nu * i] * K[p + l->nu * q] * l->Z[q + l->nu * j];
            }
    }
    if (!ct_modes_solve(&v->ctx, v->arena, l, &mode, &out->n, &how))
        return false;
    assert_true(out->n <= MOST);
    for (size_t i = 0; i < out->n; i++) {
        out->re[i] = mode[i].re;
        out->im[i] = mode[i].im;
    }
    return true;
}

static double distance(const struct motions *a, const struct motions *b)
{
    double worst = a->n == b->n ? 0 : INFINITY;
    for (size_t i = 0; i < a->n && i < b->n; i++) {
        const double size = hypot(a->re[i], a->im[i]);
        worst = fmax(worst, hypot(a->re[i] - b->re[i], a->im[i] - b->im[i]) / fmax(size, 1e-3));
    }
    return worst;
}

// Every step-th pair of trees. Returns the largest distance to the motions of the first; counts the
// pairs.
static double compare_pairs(struct system *s, bool keep_all, bool with_multipliers, size_t step,
                            size_t *tried)
{
    const struct tree_list T = system_trees(s, keep_all, false),
                           R = system_trees(s, keep_all, true);
    struct motions first, here;
    double worst = 0;
    *tried = 0;
    for (size_t k = 0; k < T.n * R.n; k += step) {
        struct ct_formulate_options o = trees_given(&T.tree[k / R.n], &R.tree[k % R.n]);
        o.keep_all = keep_all;
        o.with_residual = true;
        struct variant v;
        variant_open(s, &o, &v);
        if (!find_motions(s, &v, with_multipliers, *tried ? &here : &first)) {
            print_error("%s: no motions on pair %zu\n", s->name, k);
            ct_ctx_print(&v.ctx, stderr);
            fail();
        }
        if (*tried)
            worst = fmax(worst, distance(&first, &here));
        variant_close(&v);
        (*tried)++;
    }
    return worst;
}

static void check(const char *name, const char *text, bool keep_all, size_t step, size_t least)
{
    struct system s;
    size_t tried;
    system_open_text(&s, name, text);
    if (keep_all)
        system_keep_all(&s);
    system_no_outputs(&s);
    const double worst = compare_pairs(&s, keep_all, true, step, &tried);
    print_message("%s: %zu pairs, largest difference %.2g\n", name, tried, worst);
    assert_true(worst < tolerance);
    assert_true(tried >= least);
    system_close(&s);
}

static void a_slider_crank_has_the_same_motions_on_all_pairs_of_trees(void **state)
{
    (void)state;
    check("crank on springs", crank_on_springs, false, 1, 78);
}

static void redundant_loops_have_the_same_motions_on_all_trees(void **state)
{
    (void)state;
    check("bars in space", bars_in_space, true, 5, 30);
}

static void ball_joints_and_rods_have_the_same_motions_on_all_trees(void **state)
{
    (void)state;
    check("tripod", tripod, false, 1, 20);
}

static void a_flexible_loop_has_the_same_motions_on_some_trees(void **state)
{
    (void)state;
    struct system s;
    size_t tried;
    system_open_file(&s, "systems/slider_crank_flexible/model.yaml");
    system_no_outputs(&s);
    const double worst = compare_pairs(&s, false, true, 37, &tried);
    print_message("flexible slider-crank: %zu pairs, largest difference %.2g\n", tried, worst);
    assert_true(worst < tolerance);
    assert_true(tried >= 5);
    system_close(&s);
}

static void multipliers_count(void **state)
{
    (void)state;
    struct system s;
    size_t tried;
    system_open_text(&s, "crank on springs", crank_on_springs);
    system_no_outputs(&s);
    const double worst = compare_pairs(&s, false, false, 7, &tried);
    print_message("without multipliers: largest difference %.2g\n", worst);
    assert_true(worst > 0.01);
    system_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slider_crank_has_the_same_motions_on_all_pairs_of_trees),
        cmocka_unit_test(redundant_loops_have_the_same_motions_on_all_trees),
        cmocka_unit_test(ball_joints_and_rods_have_the_same_motions_on_all_trees),
        cmocka_unit_test(a_flexible_loop_has_the_same_motions_on_some_trees),
        cmocka_unit_test(multipliers_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
