// Every formulation of an open system gives the same accelerations: by cutset sums, by composite
// bodies, by articulated bodies, each in closed form, and the numerical solution of M u' = Q.
#include "formulate/recursive/member.h"
#include "tests/property/mechanism.h"
#include "tests/property/system.h"

#include "numeric/dense.h"

#include <float.h>

static const char *const form_name[] = {"auto", "cutsets", "composite", "articulated"};
// Accelerations agree to this, relative to the largest, or to what a few round-off errors of M do
// to them.
static const double tolerance = 1e-11;
// Those of beams, whose elastic forces are small differences, to this.
static const double tolerance_of_beams = 1e-10;

// Ten round-off errors of M that change the largest acceleration by more than this, by a condition
// number of 5e10: M counts as singular, nothing can be compared.
static const double most_sensitive = 1e-4;

struct tally {
    size_t systems, tried[CT_NFORMULATION];
    size_t states,
        singular; // singular: to round-off, as where a beam without torsion turns about its axis
};

// u' by Cholesky of M, each entry changed by `roundoff` of it, refined with residuals in extended
// precision.
static bool reference_accelerations(struct ct_evaluator *m, double roundoff, double *a)
{
    const size_t n = m->nu;
    double *L = test_calloc(n * n, sizeof *L), *r = test_calloc(n, sizeof *r),
           *M = test_calloc(n * n, sizeof *M);
    for (size_t i = 0; i < m->e->nM && roundoff > 0; i++)
        m->M[i] *= 1 + roundoff * chance();
    ct_evaluator_fill_mass(m, M, n);
    memcpy(L, M, n * n * sizeof *L);
    memcpy(a, m->Q, n * sizeof *a);
    const bool ok = ct_cholesky(L, (int)n, (int)n);
    if (ok)
        ct_cholesky_solve(a, L, (int)n, (int)n, 1, (int)n);
    for (int again = 0; again < 2 && ok; again++) {
        for (size_t i = 0; i < n; i++) {
            long double sum = m->Q[i];
            for (size_t k = 0; k < n; k++)
                sum -= (long double)M[i + n * k] * a[k];
            r[i] = (double)sum;
        }
        ct_cholesky_solve(r, L, (int)n, (int)n, 1, (int)n);
        for (size_t i = 0; i < n; i++)
            a[i] += r[i];
    }
    test_free(L);
    test_free(r);
    test_free(M);
    return ok;
}

// Beams bend by their coordinates in the state, at rates of the same size.
static void put_state(struct variant *v, const struct ct_initial_state *state)
{
    variant_set(v, state, 0.1);
    for (size_t k = 0; k < v->e.nu; k++)
        if (v->e.u[k].beam)
            v->y[v->e.nq + k] = 3 * v->y[v->e.u[k].q] - 0.002;
    ct_evaluator_set(v->m, 0.1, v->y);
    ct_evaluator_dynamics(v->m);
}

static void bend(struct system *s, const struct variant *v, struct ct_initial_state *state)
{
    state->nelastic = v->e.nu;
    state->elastic = CT_NEWN(s->ctx.model, double, v->e.nu + 1);
    for (size_t k = 0; k < v->e.nu; k++)
        state->elastic[k] = 0.02 * chance();
}

// The reference at a state (first nu of want) and how far it moves, relative to the largest, with a
// few round-off errors of M; infinite where these make M singular.
static double find_reference(struct variant *v, const struct ct_initial_state *state,
                             double *want)
{
    const size_t n = v->m->nu;
    double scale = 1e-3, change = 0;
    put_state(v, state);
    if (!reference_accelerations(v->m, 0, want)
        || !reference_accelerations(v->m, 10 * DBL_EPSILON, want + n))
        return INFINITY;
    for (size_t i = 0; i < n; i++) {
        scale = fmax(scale, fabs(want[i]));
        change = fmax(change, fabs(want[i] - want[n + i]));
    }
    return change / scale;
}

// Accelerations of one form at a state against those of the reference.
static bool form_agrees(struct system *s, enum ct_formulation form, struct variant *v,
                        const struct ct_initial_state *state, const double *want,
                        double sensitivity)
{
    double *a = test_calloc(v->m->nu, sizeof *a), scale = 1e-3, worst = 0;
    char what[64];
    put_state(v, state);
    assert_true(ct_evaluator_solved(v->m, a));
    for (size_t i = 0; i < v->m->nu; i++) {
        scale = fmax(scale, fabs(want[i]));
        worst = fmax(worst, isnan(a[i]) ? INFINITY : fabs(a[i] - want[i]));
    }
    snprintf(what, sizeof what, "u' by %s", form_name[form]);
    test_free(a);
    const double most = v->e.nu && v->e.u[v->e.nu - 1].beam ? tolerance_of_beams : tolerance;
    return agree(s->name, what, worst, 0, scale, fmax(most, sensitivity));
}

static bool forms_agree(struct system *s, enum ct_tree_choice tree, struct tally *tally)
{
    struct variant v[CT_NFORMULATION];
    bool ok = true;
    for (int form = 0; form < CT_NFORMULATION; form++) {
        const struct ct_formulate_options o
            = {.tree = tree, .with_solution = true, .formulation = (enum ct_formulation)form};
        variant_open(s, &o, &v[form]);
        if (v[form].e.nrow || !v[form].e.nu) {
            variant_close(&v[form]);
            return ok;
        }
        tally->tried[form] += v[form].e.formulation == (enum ct_formulation)form;
    }
    tally->systems++;
    for (int k = 0; k < 3; k++) {
        struct ct_initial_state state;
        double *want = test_calloc(2 * v[0].m->nu, sizeof *want);
        if (system_random_state(s, 0.1, 0.5, &state)) {
            bend(s, &v[0], &state);
            const double sensitivity = find_reference(&v[0], &state, want);
            tally->states++;
            const bool is_singular = sensitivity > most_sensitive;
            tally->singular += is_singular;
            for (int form = 0; form < CT_NFORMULATION && !is_singular; form++)
                if (v[form].e.solution)
                    ok &= form_agrees(s, (enum ct_formulation)form, &v[form], &state, want,
                                      sensitivity);
        }
        test_free(want);
    }
    for (int form = 0; form < CT_NFORMULATION; form++)
        variant_close(&v[form]);
    return ok;
}

static bool all_trees_agree(struct system *s, struct tally *tally)
{
    bool ok = true;
    system_no_outputs(s);
    ok &= forms_agree(s, CT_TREE_AUTO, tally);
    ok &= forms_agree(s, CT_TREE_JOINTS, tally);
    return ok;
}

static void forms_agree_on_shipped_systems(void **state)
{
    (void)state;
    struct tally tally = {0};
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nshipped; i++) {
        struct system s;
        system_open_file(&s, shipped[i]);
        ok &= all_trees_agree(&s, &tally);
        system_close(&s);
    }
    print_message("%zu open: %zu composite, %zu articulated\n", tally.systems,
                  tally.tried[CT_FORMULATION_COMPOSITE],
                  tally.tried[CT_FORMULATION_ARTICULATED]);
    assert_true(ok);
    assert_true(tally.systems >= 16);
    assert_true(tally.tried[CT_FORMULATION_ARTICULATED] >= 16);
}

static void forms_agree_on_small_mechanisms(void **state)
{
    (void)state;
    struct tally tally = {0};
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nmechanism; i++)
        for (int r = 0; r < 3; r++) {
            struct system s;
            struct ct_arena *a = ct_arena_create();
            const unsigned reversed = r == 0 || mechanisms[i].is_irreversible ? 0
                                    : r == 1                                  ? ~0u
                                                                              : 5u;
            system_open_text(&s, mechanisms[i].name,
                             mechanism_text(a, &mechanisms[i], NULL, reversed, false));
            ok &= all_trees_agree(&s, &tally);
            system_close(&s);
            ct_arena_destroy(a);
        }
    print_message("%zu open: %zu composite, %zu articulated\n", tally.systems,
                  tally.tried[CT_FORMULATION_COMPOSITE],
                  tally.tried[CT_FORMULATION_ARTICULATED]);
    assert_true(ok);
}

// ---- back ends ----------------------------------------------------------------------------------

// Native code, which fuses products and sums of longer programs, against the tape: to round-off, or
// to what a few round-off errors of M do.
static bool back_ends_agree_on(struct system *s)
{
    struct variant v;
    const struct ct_formulate_options o = {.tree = CT_TREE_AUTO, .with_solution = true};
    bool ok = true;
    variant_open(s, &o, &v);
    double *a = test_calloc(4 * v.m->nu + 1, sizeof *a), *native = a + 2 * v.m->nu,
           *tape = native + v.m->nu;
    for (int k = 0; k < 3 && v.e.solution; k++) {
        struct ct_initial_state state;
        if (!system_random_state(s, 0.1, 0.5, &state))
            continue;
        const double sensitivity = find_reference(&v, &state, a);
        ct_evaluator_use(v.arena, v.m, CT_BACKEND_BEST);
        assert_true(ct_evaluator_solved(v.m, native));
        ct_evaluator_use(v.arena, v.m, CT_BACKEND_TAPE);
        assert_true(ct_evaluator_solved(v.m, tape));
        double scale = 1e-3, worst = 0;
        for (size_t i = 0; i < v.m->nu; i++) {
            scale = fmax(scale, fabs(tape[i]));
            worst = fmax(worst, isnan(native[i]) ? INFINITY : fabs(native[i] - tape[i]));
        }
        ok &= agree(s->name, "u', native and tape", worst, 0, scale,
                    fmax(1e-13, 10 * sensitivity));
    }
    test_free(a);
    variant_close(&v);
    return ok;
}

static void back_ends_agree_to_rounding(void **state)
{
    (void)state;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < nshipped; i++) {
        struct system s;
        system_open_file(&s, shipped[i]);
        system_no_outputs(&s);
        ok &= back_ends_agree_on(&s);
        system_close(&s);
    }
    assert_true(ok);
}

// ---- chains of mixed joints ---------------------------------------------------------------------

static const char *const joint_text[] = {
    "type: revolute",
    "type: revolute, axis: [1, 2, -1]",
    "type: revolute, axis: x, motion: \"0.3*sin(t)\"",
    "type: prismatic, axis: y, stiffness: 20, damping: 0.3",
    "type: prismatic, axis: [1, 1, 0]",
    "type: spherical",
    "type: universal, axes: [x, z]",
    "type: cylindrical, axis: y",
    "type: cylindrical, axis: [0, 1, 1], motion: [~, \"t^2\"]",
    "type: screw, axis: z, pitch: 0.3",
    "type: screw, axis: [1, 0, 2], pitch: -0.2",
    "type: planar, normal: x",
    "type: free",
    "type: weld",
    "type: custom, coordinates: [s], translate: [s, \"0.1*s^2\", 0], rotate: [[z, \"0.2*s\"]]",
    "type: custom, coordinates: [a, b], rotate: [[x, \"a + 0.1*a^2\"], [y, b]]",
};

// A tree of n bodies: each hangs on one before it by the joint `first + i`, some seen backwards.
static char *tree_text(struct ct_arena *a, int n, int first)
{
    const char *bodies = "", *joints = "";
    for (int i = 1; i <= n; i++) {
        const int type = (first + i) % (int)COUNT(joint_text),
                  parent = i - 1 - chance_of(i < 3 ? 1 : 2);
        const char *own = text_of(a, "b%d.j", i);
        const char *other = parent ? text_of(a, "b%d.%s", parent, i % 2 ? "p" : "e") : "ground";
        const bool backwards = chance_of(3) == 0;
        bodies = text_of(a,
                         "%s  b%d: {mass: %.3g, com: [%.3g, %.3g, 0.1], inertia: [0.2, 0.25, "
                         "0.3, 0.01, -0.02, 0.03],\n"
                         "    points: {j: {at: [0.1, 0.2, -0.1], rotate: [x, 0.3]}, e: {at: "
                         "[0.5, 0, 0.1], rotate: "
                         "[[z, 0.7], [y, -0.4]]}, p: [0.3, 0.4, 0]}}\n",
                         bodies, i, 1.5 + chance(), 0.3 * chance(), 0.3 * chance());
        joints = text_of(a, "%s  j%d: {%s, from: %s, to: %s}\n", joints, i, joint_text[type],
                         backwards ? own : other, backwards ? other : own);
    }
    return text_of(a,
                   "cotree: 1\ngravity: [1, -2, -9.81]\nbodies:\n%sjoints:\n%sforces:\n"
                   "  s: {type: spring, from: ground, to: b%d.e, stiffness: 30, length: 0.4, "
                   "damping: 0.7}\n"
                   "  w: {type: bushing, from: b1, to: b%d, stiffness: [3, 4, 5, 1, 2, 3], "
                   "damping: [1, 1, 1, 0.1, 0.1, 0.1]}\n"
                   "  f: {type: force, at: b2.p, value: [1, \"2*t\", 3], in: b2}\n"
                   "  t: {type: torque, on: b%d, value: [0.3, 0, -0.2]}\n",
                   bodies, joints, n, n, n);
}

static void forms_agree_on_trees_of_mixed_joints(void **state)
{
    (void)state;
    struct tally tally = {0};
    bool ok = true;
    chance_start();
    for (int i = 0; i < 2 * (int)COUNT(joint_text); i++) {
        struct system s;
        struct ct_arena *a = ct_arena_create();
        system_open_text(&s, text_of(a, "tree %d", i), tree_text(a, 3 + i % 3, i));
        system_no_outputs(&s);
        ok &= forms_agree(&s, CT_TREE_JOINTS, &tally);
        system_close(&s);
        ct_arena_destroy(a);
    }
    print_message("%zu open: %zu composite, %zu articulated\n", tally.systems,
                  tally.tried[CT_FORMULATION_COMPOSITE],
                  tally.tried[CT_FORMULATION_ARTICULATED]);
    assert_true(ok);
    assert_true(tally.tried[CT_FORMULATION_ARTICULATED] == tally.systems);
}

// ---- beams --------------------------------------------------------------------------------------

static const char *const beam_text[] = {
    "formulation: linear, rotary_inertia: [1e-3, 2e-3, 2e-3]",
    "formulation: foreshortening, elements: 2",
    "formulation: foreshortening, deformation: [bending-y, bending-z], elements: 4",
    "formulation: foreshortening, frame: chord, damping: {alpha: 0.1, beta: 0.01}",
    "formulation: linear, theory: timoshenko, shear_factor: 0.8, rotary_inertia: true",
    "formulation: foreshortening, modes: 2, elements: 3",
    "formulation: foreshortening, elements: 3, rotary_inertia: true",
    "formulation: linear, mass: lumped, rotary_inertia: [1e-3, 2e-3, 2e-3], elements: 2",
    ("formulation: foreshortening, elements: 2, twist: quadratic, stretch: quadratic, "
     "rotary_inertia: true"),
};
static const char *const spatial_joint[] = {"weld",
                                            "spherical",
                                            "universal",
                                            "revolute, axis: [1, 2, 0]",
                                            "prismatic, axis: y",
                                            "free",
                                            "cylindrical, axis: y"};
static const char *const planar_joint[]
    = {"weld", "revolute", "weld", "prismatic, axis: y", "planar", "revolute, motion: 0.3*t^2"};

// A tree of beams and, at every third place, rigid bodies; some hang from their tips, points are on
// the axis and off it.
static char *beams_text(struct ct_arena *a, int n, int first, bool is_planar)
{
    const char *bodies = "", *joints = "";
    for (int i = 1; i <= n; i++) {
        const int parent = i - 1 - chance_of(i < 3 ? 1 : 2);
        const char *const *types = is_planar ? planar_joint : spatial_joint;
        const int ntype = is_planar ? (int)COUNT(planar_joint) : (int)COUNT(spatial_joint);
        const bool is_beam = i % 3 != 0, backwards = chance_of(3) == 0;
        const char *own = chance_of(3) ? text_of(a, "b%d", i) : text_of(a, "b%d.e", i);
        const char *other = parent ? text_of(a, "b%d.%s", parent, i % 2 ? "p" : "e") : "ground";
        if (is_beam)
            bodies = text_of(
                a,
                "%s  b%d: {type: beam, length: 1, %s, mass_per_length: %.3g, E: 3e4, nu: 0.3, "
                "area: 1e-2, Iy: 2e-4, Iz: 1e-4,\n"
                "    points: {p: 0.5, e: {at: [1, 0.1, %s], rotate: [z, 0.7]}}}\n",
                bodies, i, beam_text[(first + i) % (int)COUNT(beam_text)], 1.5 + chance(),
                is_planar ? "0" : "0.05");
        else
            bodies = text_of(
                a,
                "%s  b%d: {mass: 1.2, com: [0.1, 0.2, 0], inertia: [0.2, 0.25, 0.3],\n"
                "    points: {e: {at: [0.5, 0, 0], rotate: [z, -0.4]}, p: [0.3, "
                "0.4, 0]}}\n",
                bodies, i);
        joints = text_of(a, "%s  j%d: {type: %s, from: %s, to: %s}\n", joints, i,
                         types[(first + i) % ntype], backwards ? own : other,
                         backwards ? other : own);
    }
    return text_of(a,
                   "cotree: 1\ngravity: [1, -2, %s]\nbodies:\n%sjoints:\n%sforces:\n"
                   "  s: {type: spring, from: ground, to: b%d.e, stiffness: 30, length: 0.4}\n"
                   "  f: {type: force, at: b2.p, value: [1, \"2*t\", 0], in: b2}\n"
                   "  t: {type: torque, on: b1.e, value: [0, 0, -0.2]}\n",
                   is_planar ? "0" : "-9.81", bodies, joints, n);
}

// Beams whose sections have no inertia about the axes of bending and follow the other nodes, but
// where moments act on them.
static const struct {
    bool stretches;
    const char *text;
} massless[] = {
    {false, "elements: 2, formulation: foreshortening"},
    {true, "elements: 2, formulation: linear"},
    {true, "elements: 4, formulation: foreshortening"},
    {false, "elements: 2, formulation: foreshortening, theory: timoshenko, shear_factor: 0.8"},
    {false, "elements: 4, formulation: linear"},
    {false, "elements: 4, formulation: foreshortening, damping: {alpha: 0.1, beta: 0.01}"},
};
static const char *const spatial_hinge[]
    = {"revolute, axis: y", "spherical", "revolute, axis: z"};

// As beams_text. Beams are clamped to rigid bodies, or hang on hinges or balls on their chords:
// else their ends move no mass.
static char *followers_text(struct ct_arena *a, int n, int first, bool is_planar)
{
    const char *bodies = "", *joints = "";
    for (int i = 1; i <= n; i++) {
        const int parent = i - 1 - chance_of(i < 3 ? 1 : 2), kind = first + i;
        const bool is_beam = i % 3 != 1, backwards = chance_of(3) == 0,
                   on_beam = parent % 3 != 1,
                   is_clamped = is_beam && !(parent && on_beam) && chance_of(2);
        const char *own
            = is_clamped || chance_of(3) ? text_of(a, "b%d", i) : text_of(a, "b%d.e", i);
        const char *other = parent ? text_of(a, "b%d.%s", parent, i % 2 ? "p" : "e") : "ground";
        const char *hinge = is_planar          ? "revolute"
                          : is_beam && on_beam ? "spherical"
                                               : spatial_hinge[kind % 3];
        if (is_beam)
            bodies = text_of(
                a,
                "%s  b%d: {type: beam, length: 1, %s, deformation: [%s%s], mass: lumped,%s\n"
                "    rotary_inertia: [1e-2, 0, 0], mass_per_length: %.3g, E: 3e4, nu: 0.3, "
                "area: "
                "1e-2, Iy: 2e-4, Iz: 1e-4, points: {p: 0.5, e: 1}}\n",
                bodies, i, massless[kind % (int)COUNT(massless)].text,
                is_planar ? "bending-z" : "bending-y, bending-z",
                massless[kind % (int)COUNT(massless)].stretches ? ", axial" : "",
                is_clamped ? "" : " frame: chord,", 1.5 + chance());
        else
            bodies = text_of(a,
                             "%s  b%d: {mass: 1.2, com: [0.1, 0.2, 0], inertia: [0.2, 0.25, "
                             "0.3], points: {e: [0.5, 0, 0], p: [0.3, 0.4, 0]}}\n",
                             bodies, i);
        joints = text_of(a, "%s  j%d: {type: %s, from: %s, to: %s}\n", joints, i,
                         is_clamped ? "weld" : hinge, backwards ? own : other,
                         backwards ? other : own);
    }
    return text_of(a,
                   "cotree: 1\ngravity: [1, -2, %s]\nbodies:\n%sjoints:\n%sforces:\n"
                   "  s: {type: spring, from: ground, to: b%d.e, stiffness: 30, length: 0.4}\n"
                   "  f: {type: force, at: b2.p, value: [1, \"2*t\", 0]}\n",
                   is_planar ? "0" : "-9.81", bodies, joints, n);
}

// Turns of sections by what follows, where a system has the form of articulated bodies.
static size_t count_turned(struct system *s)
{
    const struct ct_formulate_options o = {.tree = CT_TREE_JOINTS,
                                           .with_solution = true,
                                           .formulation = CT_FORMULATION_ARTICULATED};
    struct variant v;
    size_t n = 0;
    variant_open(s, &o, &v);
    const struct ct_members *all = ct_members_derive(v.e.build);
    for (size_t i = 1; all && i < all->n; i++) {
        const struct ct_member *m = &all->member[i];
        for (int k = 0; m->beam && k < m->nfree; k++)
            n += m->screw[k].speed < 0 && !ct_ex3_is_zero(m->screw[k].rotation);
    }
    variant_close(&v);
    return n;
}

static void forms_agree_on_trees_of_beams(void **state)
{
    (void)state;
    struct tally tally = {0};
    size_t nplanar = 0;
    bool ok = true;
    chance_start();
    for (int i = 0; i < 16; i++) {
        struct system s;
        struct ct_arena *a = ct_arena_create();
        const bool is_planar = i % 2;
        system_open_text(&s, text_of(a, "beams %d", i),
                         beams_text(a, 2 + i % 3, i / 2, is_planar));
        system_no_outputs(&s);
        nplanar += s.assembly.is_planar;
        ok &= all_trees_agree(&s, &tally);
        system_close(&s);
        ct_arena_destroy(a);
    }
    print_message("%zu open, %zu models planar: %zu articulated; %zu of %zu states singular\n",
                  tally.systems, nplanar, tally.tried[CT_FORMULATION_ARTICULATED],
                  tally.singular, tally.states);
    assert_true(ok);
    assert_true(nplanar >= 4);
    assert_true(10 * tally.singular < tally.states);
    assert_true(tally.tried[CT_FORMULATION_ARTICULATED] >= 28);
}

// Sections that follow turn what hangs on them, and beams on their chords themselves.
static void forms_agree_where_sections_follow(void **state)
{
    (void)state;
    struct tally tally = {0};
    size_t nplanar = 0, nturned = 0;
    bool ok = true;
    chance_start();
    for (int i = 0; i < 24; i++) {
        struct system s;
        struct ct_arena *a = ct_arena_create();
        system_open_text(&s, text_of(a, "sections %d", i),
                         followers_text(a, 3 + i % 3, i / 2, i % 2));
        system_no_outputs(&s);
        nplanar += s.assembly.is_planar;
        nturned += count_turned(&s);
        ok &= all_trees_agree(&s, &tally);
        system_close(&s);
        ct_arena_destroy(a);
    }
    print_message(
        "%zu open, %zu models planar: %zu articulated, %zu turns by what follows; %zu "
        "of %zu states singular\n",
        tally.systems, nplanar, tally.tried[CT_FORMULATION_ARTICULATED], nturned,
        tally.singular, tally.states);
    assert_true(ok);
    assert_true(nplanar >= 6);
    assert_true(10 * tally.singular < tally.states);
    assert_true(nturned >= 24);
    assert_true(tally.tried[CT_FORMULATION_ARTICULATED] >= 36);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forms_agree_on_shipped_systems),
        cmocka_unit_test(forms_agree_on_small_mechanisms),
        cmocka_unit_test(forms_agree_on_trees_of_mixed_joints),
        cmocka_unit_test(forms_agree_on_trees_of_beams),
        cmocka_unit_test(forms_agree_where_sections_follow),
        cmocka_unit_test(back_ends_agree_to_rounding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
