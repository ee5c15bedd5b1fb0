// Sizes and operation counts of the equations against the table of formulation 10: n_u, m,
// multiplications and additions of M (lower), Q, J and gam, functions, entries of M. Lengths,
// masses and inertias are parameters.
#include "expr/tape.h"
#include "formulate/recursive/composite_body.h"
#include "formulate/topology/tree_selection.h"
#include "tests/property/system.h"

struct row {
    const char *T, *R; // branches, blank-separated
    size_t nu, nrow;
    long multiplications, additions, functions;
    size_t nM;
};

static struct ct_tape_counts count(struct variant *v)
{
    const struct ct_equations *e = &v->e;
    ct_ex *all = CT_NEWN(v->arena, ct_ex, e->nM + e->nu + e->nJ + e->nrow + 1);
    size_t n = 0;
    for (size_t i = 0; i < e->nM; i++)
        all[n++] = e->M[i].value;
    for (size_t i = 0; i < e->nu; i++)
        all[n++] = e->Q[i];
    for (size_t i = 0; i < e->nJ; i++)
        all[n++] = e->J[i].value;
    for (size_t i = 0; i < e->nrow; i++)
        all[n++] = e->row[i].gam;
    return ct_ex_count(v->arena, e->x, all, n);
}

static size_t split(struct ct_arena *a, const char *text, const char **word)
{
    size_t n = 0;
    for (const char *p = text; *p; p += strspn(p, " ")) {
        const size_t length = strcspn(p, " ");
        word[n++] = ct_arena_strndup(a, p, length);
        p += length;
    }
    return n;
}

static bool count_is_kept(struct system *s, const struct row *r)
{
    const char *T[64], *R[64];
    const struct ct_formulate_options o = {.tree = CT_TREE_GIVEN,
                                           .trans = T,
                                           .ntrans = split(s->ctx.model, r->T, T),
                                           .rot = R,
                                           .nrot = split(s->ctx.model, r->R, R)};
    struct variant v;
    variant_open(s, &o, &v);
    const struct ct_tape_counts c = count(&v);
    print_message("%-40.40s | %zu %zu | %ld/%ld/%ld of %ld/%ld/%ld | %zu of %zu\n", r->T,
                  v.e.nu, v.e.nrow, c.multiplications, c.additions, c.functions,
                  r->multiplications, r->additions, r->functions, v.e.nM, r->nM);
    const bool ok = v.e.nu == r->nu && v.e.nrow == r->nrow && v.e.nM <= r->nM
                 && c.multiplications + c.divisions <= r->multiplications
                 && c.additions <= r->additions && c.functions <= r->functions;
    if (!ok)
        print_error("%s: more than the table says: T = %s, R = %s\n", s->name, r->T, r->R);
    variant_close(&v);
    return ok;
}

static void counts_are_kept(struct system *s, const struct row *row, size_t n)
{
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        ok &= count_is_kept(s, &row[i]);
    system_close(s);
    assert_true(ok);
}

static void slider_crank_needs_no_more_than_the_table_says(void **state)
{
    (void)state;
    static const char text[]
        = "cotree: 1\ngravity: [0, -g, 0]\n"
          "parameters: {g: 9.81, r: 0.2, l: 0.4, c1: 0.1, c2: 0.2, m1: 1, m2: 2, m3: 3, J1: "
          "0.1, J2: 0.2}\n"
          "bodies:\n"
          "  m1: {mass: m1, inertia: J1, com: [c1, 0, 0], points: {end: [r, 0, 0]}}\n"
          "  m2: {mass: m2, inertia: J2, com: [c2, 0, 0], points: {end: [l, 0, 0]}}\n"
          "  m3: {mass: m3}\n"
          "joints:\n"
          "  h1: {type: revolute, from: ground, to: m1, initial: {q: 0.8}}\n"
          "  h2: {type: revolute, from: m1.end, to: m2, initial: {q: -1.1, guess: true}}\n"
          "  h3: {type: revolute, from: m2.end, to: m3, initial: {q: 0.3, guess: true}}\n"
          "  s4: {type: prismatic, from: ground, to: m3, initial: {q: 0.5, guess: true}}\n";
    static const struct row row[] = {
        {"m1 m2 m3", "m1 m2 m3", 9, 8, 24, 2, 4, 9},
        {"h1 h2 s4", "h1 h2 s4", 3, 2, 48, 31, 4, 4},
        {"h1 h2 h3", "h1 h2 h3", 3, 2, 64, 45, 4, 6},
        {"h1 h2 h3", "h1 h2 s4", 2, 1, 64, 42, 4, 3},
        {"h1 h2 h3", "m1 m2 s4", 2, 1, 64, 34, 4, 3},
        {"h1 h3 s4", "m1 m2 s4", 3, 2, 40, 18, 4, 4},
    };
    struct system s;
    system_open_text(&s, "slider-crank", text);
    counts_are_kept(&s, row, COUNT(row));
}

static void four_bar_needs_no_more_than_the_table_says(void **state)
{
    (void)state;
    static const char text[]
        = "cotree: 1\ngravity: [0, -g, 0]\n"
          "parameters: {g: 9.81, a: 0.2, b: 0.5, c: 0.4, d: 0.5, c1: 0.1, c2: 0.2, c3: 0.3, "
          "m1: 1, m2: 2, m3: 3, "
          "J1: 0.1, J2: 0.2, J3: 0.3}\n"
          "bodies:\n"
          "  ground: {points: {far: [d, 0, 0]}}\n"
          "  m1: {mass: m1, inertia: J1, com: [c1, 0, 0], points: {end: [a, 0, 0]}}\n"
          "  m2: {mass: m2, inertia: J2, com: [c2, 0, 0], points: {end: [b, 0, 0]}}\n"
          "  m3: {mass: m3, inertia: J3, com: [c3, 0, 0], points: {end: [c, 0, 0]}}\n"
          "joints:\n"
          "  h1: {type: revolute, from: ground, to: m1, initial: {q: pi/2}}\n"
          "  h2: {type: revolute, from: m1.end, to: m2, initial: {q: -1.2, guess: true}}\n"
          "  h3: {type: revolute, from: m2.end, to: m3.end, initial: {q: 1.2, guess: true}}\n"
          "  h4: {type: revolute, from: ground.far, to: m3, initial: {q: 1.6, guess: true}}\n";
    static const struct row row[] = {
        {"m1 m2 m3", "m1 m2 m3", 9, 8, 36, 4, 6, 9},
        {"h1 h2 h3", "h1 h2 h3", 3, 2, 86, 68, 6, 6},
        {"h1 h2 h3", "m1 m2 m3", 3, 2, 86, 45, 6, 6},
        {"h1 h2 h4", "m1 m2 m3", 3, 2, 68, 33, 6, 4},
        {"h1 h3 h4", "m1 m2 m3", 3, 2, 68, 33, 6, 4},
    };
    struct system s;
    system_open_text(&s, "four-bar", text);
    counts_are_kept(&s, row, COUNT(row));
}

static void andrews_mechanism_needs_no_more_than_the_table_says(void **state)
{
    (void)state;
    static const struct row row[] = {
        {"beta theta gamma delta phi epsilon omega", "beta theta gamma delta phi epsilon omega",
         7, 6, 181, 135, 15, 10},
        {"beta theta gamma delta phi epsilon omega", "K1 K2 K3 K4 K5 K6 K7", 7, 6, 181, 111, 15,
         10},
        {"K1 K2 K3 K4 K5 K6 K7", "K1 K2 K3 K4 K5 K6 K7", 21, 20, 101, 36, 15, 21},
    };
    struct system s;
    system_open_file(&s, "systems/andrews/model.yaml");
    counts_are_kept(&s, row, COUNT(row));
}

static void stewart_platform_needs_no_more_than_the_table_says(void **state)
{
    (void)state;
    static const struct row row[] = {
        {"u1 u2 u3 u4 u5 u6 p1 p2 p3 p4 p5 p6 s1", "u1 u2 u3 u4 u5 u6 p1 p2 p3 p4 p5 p6 s1", 21,
         15, 1885, 1201, 24, 51},
        {"u1 u2 u3 u4 u5 u6 s1 s2 s3 s4 s5 s6 p1", "u1 u2 u3 u4 u5 u6 p1 p2 p3 p4 p5 p6 s1", 16,
         10, 2575, 1777, 24, 96},
        {"u1 u2 u3 u4 u5 u6 s1 s2 s3 s4 s5 s6 plate",
         "u1 u2 u3 u4 u5 u6 p1 p2 p3 p4 p5 p6 plate", 18, 12, 2010, 1306, 24, 102},
        {"u1 u2 u3 u4 u5 u6 p1 p2 p3 p4 p5 p6 plate",
         "u1 u2 u3 u4 u5 u6 p1 p2 p3 p4 p5 p6 plate", 24, 18, 1644, 933, 24, 45},
        {"low1 low2 low3 low4 low5 low6 up1 up2 up3 up4 up5 up6 plate",
         "low1 low2 low3 low4 low5 low6 up1 up2 up3 up4 up5 up6 plate", 78, 72, 3402, 2355, 0,
         117},
    };
    struct system s;
    struct ct_arena *a = ct_arena_create();
    const char *points = "", *plate = "", *bodies = "", *joints = "";
    for (int i = 0; i < 6; i++) {
        const double base = 0.17 + 1.0472 * (i + i % 2), top = 0.87 + 1.0472 * (i - i % 2);
        points = text_of(a, "%s b%d: [%.6g, %.6g, 0],", points, i + 1, 0.5 * cos(base),
                         0.5 * sin(base));
        plate = text_of(a, "%s p%d: [%.6g, %.6g, 0],", plate, i + 1, 0.3 * cos(top),
                        0.3 * sin(top));
        bodies = text_of(a,
                         "%s  low%d: {mass: m1, inertia: [J1, J1, K1], com: [0, 0, c1]}\n"
                         "  up%d: {mass: m2, inertia: [J2, J2, K2], com: [0, 0, c2]}\n",
                         bodies, i + 1, i + 1);
        joints = text_of(a,
                         "%s  u%d: {type: universal, from: ground.b%d, to: low%d}\n"
                         "  p%d: {type: prismatic, from: low%d, to: up%d, axis: z, initial: "
                         "{q: 0.8, guess: true}}\n"
                         "  s%d: {type: spherical, from: up%d, to: plate.p%d}\n",
                         joints, i + 1, i + 1, i + 1, i + 1, i + 1, i + 1, i + 1, i + 1, i + 1);
    }
    system_open_text(&s, "Stewart platform",
                     text_of(a,
                             "cotree: 1\ngravity: [0, 0, -g]\n"
                             "parameters: {g: 9.81, m: 20, J: 0.5, K: 0.95, c: 0.02, m1: 1.6, "
                             "J1: 0.03, K1: 8e-4, "
                             "c1: 0.2, m2: 0.8, J2: 0.014, K2: 3e-4, c2: -0.2}\n"
                             "bodies:\n  ground: {points: {%s}}\n"
                             "  plate: {mass: m, inertia: [J, J, K], com: [0, 0, c], points: "
                             "{%s}}\n%sjoints:\n%s",
                             points, plate, bodies, joints));
    counts_are_kept(&s, row, COUNT(row));
    ct_arena_destroy(a);
}

// ---- open chains --------------------------------------------------------------------------------

// PUMA geometry, six turning axes: masses, centres of mass, full inertias and lengths are
// parameters.
static const char *arm_text(struct ct_arena *a)
{
    static const char *const end[]
        = {"{at: [0, 0, 0], rotate: [x, -pi/2]}",   "[a2, 0, d3]",
           "{at: [a3, d4, 0], rotate: [x, -pi/2]}", "{at: [0, 0, 0], rotate: [x, pi/2]}",
           "{at: [0, 0, 0], rotate: [x, -pi/2]}",   "[0, 0, 0]"};
    const char *parameters = "g: 9.81, a2: 0.43, a3: 0.02, d3: 0.15, d4: 0.43", *bodies = "",
               *joints = "";
    for (int i = 1; i <= 6; i++) {
        parameters = text_of(a,
                             "%s, m%d: 1, x%d: 0.1, y%d: 0.05, z%d: 0.02, A%d: 1, B%d: 1.1, "
                             "C%d: 1.2, D%d: 0.1, E%d: 0.02, F%d: 0.05",
                             parameters, i, i, i, i, i, i, i, i, i, i);
        bodies = text_of(a,
                         "%s  b%d: {mass: m%d, com: [x%d, y%d, z%d], inertia: [A%d, B%d, C%d, "
                         "D%d, E%d, F%d], points: {end: %s}}\n",
                         bodies, i, i, i, i, i, i, i, i, i, i, i, end[i - 1]);
        const char *from = i == 1 ? "ground" : text_of(a, "b%d.end", i - 1);
        joints
            = text_of(a, "%s  j%d: {type: revolute, from: %s, to: b%d}\n", joints, i, from, i);
    }
    return text_of(a,
                   "cotree: 1\ngravity: [0, 0, -g]\nparameters: {%s}\nbodies:\n%sjoints:\n%s",
                   parameters, bodies, joints);
}

// Goals of the feasibility study for such an arm: 514 and 441 for M and Q, 600 and 506 with the
// solution, 744 and 578 by articulated bodies, 6 divisions and 10 functions.
static void six_axis_arm_needs_no_more_than_its_goals(void **state)
{
    (void)state;
    static const struct {
        enum ct_formulation formulation;
        long multiplications, additions;
    } most[] = {{CT_FORMULATION_COMPOSITE, 600, 506}, {CT_FORMULATION_ARTICULATED, 744, 578}};
    struct system s;
    struct variant v;
    struct ct_arena *a = ct_arena_create();
    system_open_text(&s, "arm", arm_text(a));
    for (size_t i = 0; i < COUNT(most); i++) {
        const struct ct_formulate_options o
            = {.tree = CT_TREE_AUTO, .with_solution = true, .formulation = most[i].formulation};
        variant_open(&s, &o, &v);
        const struct ct_tape_counts c = ct_ex_count(v.arena, v.e.x, v.e.solution, v.e.nu);
        print_message("%ld/%ld/%ld/%ld\n", c.multiplications, c.additions, c.divisions,
                      c.functions);
        assert_in_range(c.multiplications, 1, most[i].multiplications);
        assert_in_range(c.additions, 1, most[i].additions);
        assert_in_range(c.divisions, 1, 6);
        assert_int_equal(c.functions, 10);
        variant_close(&v);
    }
    const struct ct_formulate_options choice = {.tree = CT_TREE_AUTO, .with_solution = true};
    variant_open(&s, &choice, &v);
    assert_int_equal(v.e.formulation, CT_FORMULATION_COMPOSITE);
    ct_ex all[6 + 21]; // Q, M
    struct ct_build *b = v.e.build;
    struct ct_symmetric M = ct_symmetric_create(v.arena, 6);
    ct_composite_derive(b, ct_members_derive(b), b->loads->effort, &M, all);
    assert_in_range(M.nvalue, 1, 21);
    memcpy(all + 6, M.value, M.nvalue * sizeof *all);
    const struct ct_tape_counts c = ct_ex_count(v.arena, v.e.x, all, 6 + M.nvalue);
    print_message("M, Q: %ld/%ld\n", c.multiplications, c.additions);
    assert_in_range(c.multiplications, 1, 514);
    assert_in_range(c.additions, 1, 441);
    variant_close(&v);
    system_close(&s);
    ct_arena_destroy(a);
}

static const char *chain_text(struct ct_arena *a, int n)
{
    const char *bodies = "", *joints = "";
    for (int i = 1; i <= n; i++) {
        const char *from = i == 1 ? "ground" : text_of(a, "b%d.end", i - 1);
        bodies = text_of(a,
                         "%s  b%d: {mass: 1.%d, com: [0.5, 0.01, 0.02], inertia: [0.1, 0.2, "
                         "0.25], points: {end: [1, 0, 0]}}\n",
                         bodies, i, i);
        joints
            = text_of(a, "%s  j%d: {type: spherical, from: %s, to: b%d}\n", joints, i, from, i);
    }
    return text_of(a, "cotree: 1\ngravity: [0, 0, -9.81]\nbodies:\n%sjoints:\n%s", bodies,
                   joints);
}

// Of the accelerations of a model that has the form of articulated bodies; has_no_matrix: M, which
// would have n^2 entries, must not even be tried.
static long operations_of(const char *name, const char *text, enum ct_tree_choice tree,
                          bool has_no_matrix)
{
    struct system s;
    struct ct_equations e;
    struct ct_tree_report report;
    const struct ct_formulate_options o = {.tree = tree, .with_solution = true};
    system_open_text(&s, name, text);
    assert_true(ct_formulate(&s.ctx, s.ctx.model, &s.model, &o, &e, &report));
    assert_int_equal(e.formulation, CT_FORMULATION_ARTICULATED);
    assert_false(has_no_matrix && e.has_dynamics);
    const struct ct_tape_counts c = ct_ex_count(s.ctx.scratch, e.x, e.solution, e.nu);
    system_close(&s);
    return c.multiplications + c.additions + c.divisions;
}

static void cost_of_a_long_chain_is_linear(void **state)
{
    (void)state;
    struct ct_arena *a = ct_arena_create();
    const long n20 = operations_of("chain", chain_text(a, 20), CT_TREE_AUTO, true),
               n40 = operations_of("chain", chain_text(a, 40), CT_TREE_AUTO, true),
               n80 = operations_of("chain", chain_text(a, 80), CT_TREE_AUTO, true);
    print_message("20: %ld, 40: %ld, 80: %ld\n", n20, n40, n80);
    assert_int_equal(n80 - n40, 2 * (n40 - n20));
    // of a recursion with every vector and matrix full; the feasibility study has 540 a link
    assert_in_range((n80 - n40) / 40, 1, 540);
    ct_arena_destroy(a);
}

// ---- sections that follow -----------------------------------------------------------------------

// A hub, a lumped beam of n elements and a link behind it; near and far: types of the joints.
struct rod {
    const char *name, *deformation, *more, *near, *far;
    bool is_planar;
};

static const char *rod_text(struct ct_arena *a, const struct rod *r, int n)
{
    return text_of(a,
                   "cotree: 1\ngravity: %s\nbodies:\n"
                   "  hub: {mass: 1, inertia: [0.01, 0.02, 0.03], points: {rim: [0.1, 0, 0]}}\n"
                   "  rod: {type: beam, length: 1.5, elements: %d, mass: lumped, formulation: "
                   "foreshortening, deformation: [%s],\n"
                   "    density: 2700, E: 7e10, area: 2e-4, Iy: 2e-9, Iz: 1e-9, %s points: "
                   "{tip: length, third: length/3}}\n"
                   "  link: {mass: 0.5, inertia: [0.01, 0.012, 0.014], com: [0.2, 0.01, 0]}\n"
                   "joints:\n"
                   "  pin: {type: revolute, axis: z, from: ground, to: hub}\n"
                   "  near: {type: %s, from: hub.rim, to: rod}\n"
                   "  far: {type: %s, to: link}\n",
                   r->is_planar ? "[0, -9.81, 0]" : "[0, 0, -9.81]", n, r->deformation, r->more,
                   r->near, r->far);
}

// Each element adds the same; those at the ends and the order of terms make up for a percent.
static void cost_of_rods_whose_sections_follow_is_linear(void **state)
{
    (void)state;
    static const struct rod rods[] = {
        {"chord", "bending-z", "frame: chord,", "revolute", "revolute, from: rod.tip", true},
        {"hinge between", "bending-z", "frame: chord,", "revolute", "revolute, from: rod.third",
         true},
        {"chord on a ball", "bending-y, bending-z", "frame: chord,", "spherical",
         "revolute, axis: y, from: rod.tip", false},
        {"chord on a ball that stretches", "bending-y, bending-z, axial", "frame: chord,",
         "spherical", "revolute, axis: y, from: rod.tip", false},
        {"hinge at the tip", "bending-y, bending-z", "", "weld",
         "revolute, axis: y, from: rod.tip", false},
    };
    struct ct_arena *a = ct_arena_create();
    for (size_t i = 0; i < 2 * COUNT(rods); i++) {
        const struct rod *r = &rods[i / 2];
        const enum ct_tree_choice tree = i % 2 ? CT_TREE_JOINTS : CT_TREE_AUTO;
        long of[3];
        for (int k = 0; k < 3; k++)
            of[k] = operations_of(r->name, rod_text(a, r, 10 << k), tree, false);
        print_message("%s: 10: %ld, 20: %ld, 40: %ld\n", r->name, of[0], of[1], of[2]);
        assert_true((double)(of[2] - of[1]) < 2.02 * (double)(of[1] - of[0]));
    }
    ct_arena_destroy(a);
}

static double predicted_cost(struct system *s, enum ct_tree_choice tree)
{
    struct variant v;
    const struct ct_formulate_options o = {.tree = tree};
    variant_open(s, &o, &v);
    const double cost = ct_equations_cost(v.arena, &v.e);
    variant_close(&v);
    return cost;
}

// To first order in the stretch, a body on a hinge at the tip: on the hub's rim, or hinged there on
// its chord, where columns of M between the base and the beam are sums over all nodes.
static void cost_of_a_lumped_arm_of_first_order_is_linear(void **state)
{
    (void)state;
    static const struct {
        const char *frame, *root;
        int fewest; // below the form that runs from node to node is not the shorter one
    } arms[] = {{"clamped", "weld", 10}, {"chord", "weld", 20}, {"chord", "revolute", 20}};
    struct ct_arena *a = ct_arena_create();
    for (size_t i = 0; i < COUNT(arms); i++) {
        double of[3];
        for (int k = 0; k < 3; k++) {
            struct system s;
            system_open_text(
                &s, "arm",
                text_of(
                    a,
                    "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n"
                    "  hub: {mass: 0.3, inertia: 3e-3, points: {rim: [0.1, 0, 0]}}\n"
                    "  rod: {type: beam, length: 0.6, elements: %d, mass: lumped, frame: %s, "
                    "formulation: stretch-linear, deformation: [bending-z],\n"
                    "    density: 2700, E: 7e10, area: 1e-4, Iz: 1e-9, points: {tip: length}}\n"
                    "  bob: {mass: 0.1, inertia: 1e-4}\n"
                    "joints:\n"
                    "  pin: {type: revolute, from: ground, to: hub}\n"
                    "  root: {type: %s, from: hub.rim, to: rod}\n"
                    "  end: {type: revolute, from: rod.tip, to: bob}\n",
                    arms[i].fewest << k, arms[i].frame, arms[i].root));
            of[k] = predicted_cost(&s, CT_TREE_AUTO);
            system_close(&s);
        }
        print_message("%s, %s: %.0f, twice as many %.0f, four times %.0f\n", arms[i].frame,
                      arms[i].root, of[0], of[1], of[2]);
        assert_true(of[2] - of[1] < 2.02 * (of[1] - of[0]));
    }
    ct_arena_destroy(a);
}

// Nodes of expressions that are made for a slider-crank with a lumped rod of n elements, to first
// order in its stretch.
static size_t nodes_of_a_rod(struct ct_arena *a, int n)
{
    struct system s;
    struct variant v;
    system_open_text(
        &s, "crank",
        text_of(a,
                "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n"
                "  crank: {mass: 1, inertia: 0.01, points: {tip: [0.15, 0, 0]}}\n"
                "  rod: {type: beam, length: 0.5, elements: %d, mass: lumped, formulation: "
                "stretch-linear, deformation: [bending-z], frame: chord,\n"
                "    density: 2700, E: 7e10, area: 1e-4, Iz: 1e-9, points: {tip: length}}\n"
                "  slider: {mass: 0.5, inertia: 1e-3}\n"
                "joints:\n"
                "  main: {type: revolute, from: ground, to: crank, motion: 10*t}\n"
                "  pin: {type: revolute, from: crank.tip, to: rod}\n"
                "  wrist: {type: revolute, from: rod.tip, to: slider}\n"
                "  guide: {type: prismatic, axis: x, from: ground, to: slider}\n",
                n));
    variant_open(&s, &by_choice, &v);
    const size_t nodes = v.e.x->nnode;
    variant_close(&v);
    system_close(&s);
    return nodes;
}

// Making them takes no more than the square of the elements: M and J have an entry for each two
// nodes.
static void making_a_lumped_rod_of_first_order_is_no_sum_of_sums(void **state)
{
    (void)state;
    struct ct_arena *a = ct_arena_create();
    const size_t few = nodes_of_a_rod(a, 20), many = nodes_of_a_rod(a, 40);
    print_message("20: %zu, 40: %zu\n", few, many);
    assert_true((double)many < 4.2 * (double)few);
    ct_arena_destroy(a);
}

// In a loop nothing is gained by angles through such sections: the mass matrix is needed, and
// counted from ground less of it moves.
static void rods_in_loops_keep_their_angles(void **state)
{
    (void)state;
    struct system s;
    system_open_text(
        &s, "crank",
        "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n"
        "  crank: {mass: 1, inertia: 0.01, points: {tip: [0.15, 0, 0]}}\n"
        "  rod: {type: beam, length: 0.5, elements: 20, mass: lumped, formulation: "
        "foreshortening,\n"
        "    density: 2700, E: 7e10, area: 2e-4, Iz: 1e-9, deformation: "
        "[bending-z], frame: chord, points: {tip: length}}\n"
        "  slider: {mass: 0.5, inertia: 0.01}\n"
        "joints:\n"
        "  pin: {type: revolute, from: ground, to: crank, initial: {q: 0.3}}\n"
        "  near: {type: revolute, from: crank.tip, to: rod}\n"
        "  far: {type: revolute, from: rod.tip, to: slider}\n"
        "  guide: {type: prismatic, axis: x, from: ground, to: slider}\n");
    assert_true(predicted_cost(&s, CT_TREE_AUTO) <= predicted_cost(&s, CT_TREE_ABSOLUTE));
    system_close(&s);
}

// ---- choices ------------------------------------------------------------------------------------

static void chosen_trees_give_few_coordinates(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        size_t least, most;
    } wanted[] = {{"systems/andrews/model.yaml", 7, 7},
                  {"systems/slider_crank/model.yaml", 2, 3},
                  {"systems/four_bar/model.yaml", 3, 3},
                  {"systems/spatial_slider_crank/model.yaml", 2, 5},
                  {"systems/stewart/model.yaml", 16, 24},
                  {"systems/pendulum/model.yaml", 1, 1},
                  {"systems/tumbling_body/model.yaml", 6, 6},
                  {"systems/chain40/model.yaml", 40, 40}};
    for (size_t i = 0; i < COUNT(wanted); i++) {
        struct system s;
        struct variant v;
        system_open_file(&s, wanted[i].file);
        system_no_outputs(&s);
        variant_open(&s, &by_choice, &v);
        print_message("%s: %zu, %s\n", wanted[i].file, v.e.nu, v.report.how);
        assert_in_range(v.e.nu, wanted[i].least, wanted[i].most);
        assert_true(v.report.cost <= v.report.cost_least_weight);
        variant_close(&v);
        system_close(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slider_crank_needs_no_more_than_the_table_says),
        cmocka_unit_test(four_bar_needs_no_more_than_the_table_says),
        cmocka_unit_test(andrews_mechanism_needs_no_more_than_the_table_says),
        cmocka_unit_test(stewart_platform_needs_no_more_than_the_table_says),
        cmocka_unit_test(six_axis_arm_needs_no_more_than_its_goals),
        cmocka_unit_test(cost_of_a_long_chain_is_linear),
        cmocka_unit_test(cost_of_rods_whose_sections_follow_is_linear),
        cmocka_unit_test(cost_of_a_lumped_arm_of_first_order_is_linear),
        cmocka_unit_test(making_a_lumped_rod_of_first_order_is_no_sum_of_sums),
        cmocka_unit_test(rods_in_loops_keep_their_angles),
        cmocka_unit_test(chosen_trees_give_few_coordinates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
