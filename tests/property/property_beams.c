// Beams: reactions and stress resultants do not depend on the trees and obey Newton and Euler, for
// the whole and for the part between two sections; textbook cantilevers; what the kinematic signals
// mean.
#include "tests/property/system.h"
#include "tests/property/vector.h"

static const double tolerance = 1e-9; // solutions of small, well conditioned systems

// ---- vectors ------------------------------------------------------------------------------------

static struct vector signal_of(const struct variant *v, const char *owner, const char *property)
{
    struct vector r;
    for (int i = 0; i < 3; i++)
        r.e[i] = v->result[variant_result(
            v, text_of(v->arena, "%s.%s.%c", owner, property, "xyz"[i]))];
    return r;
}

// Components in a frame -> ground.
static struct vector turned(const struct variant *v, const char *frame, struct vector a)
{
    struct vector r = {{0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r.e[i] += a.e[j]
                    * v->result[variant_result(
                        v, text_of(v->arena, "%s.rotation.%c%c", frame, "xyz"[i], "xyz"[j]))];
    return r;
}

static void put_out(struct system *s, const char *frame)
{
    static const char *const property[]
        = {"position", "acceleration", "rotation", "force", "moment"};
    for (size_t i = 0; i < COUNT(property); i++)
        system_output(s, text_of(s->ctx.model, "%s.%s", frame, property[i]));
}

// ---- states -------------------------------------------------------------------------------------

// A random state of joints and bodies with random elastic coordinates, brought onto the
// constraints.
static void move_anywhere(struct system *s, struct variant *v, double t, double amplitude)
{
    struct ct_initial_state state;
    assert_true(system_random_state(s, t, 0.5, &state));
    variant_set(v, &state, t);
    for (size_t k = 0; k < v->e.nu; k++)
        if (v->e.u[k].beam) {
            v->y[v->e.u[k].q] = amplitude * chance();
            v->y[v->e.nq + k] = amplitude * chance();
        }
    variant_renew(v, t);
    assert_true(ct_partition_choose(v->s));
    assert_int_equal(ct_partition_project(v->s, t, v->y), CT_EVAL_OK);
    variant_renew(v, t);
}

// The state of v in other coordinates: those that v has, too, are the same; those of joints are
// results of v.
static void take_over(const struct variant *v, struct variant *w, double t)
{
    for (size_t k = 0; k < w->e.nu; k++) {
        const struct ct_u *u = &w->e.u[k];
        double *q = &w->y[u->q], *rate = &w->y[w->e.nq + k];
        bool is_shared = false;
        for (size_t i = 0; i < v->e.nu && !is_shared; i++) {
            is_shared = !strcmp(v->e.u[i].name, u->name);
            *q = v->y[v->e.u[i].q >= 0 ? v->e.u[i].q : 0];
            *rate = v->y[v->e.nq + i];
        }
        if (is_shared)
            continue;
        *q = v->result[variant_result(v, w->e.q[u->q].name)];
        *rate = v->result[variant_result(v, u->name)];
    }
    variant_renew(w, t);
}

// ---- trees --------------------------------------------------------------------------------------

// %s: keys of the beam; frames the beam hangs from and the knob sits at.
static const char hanging[]
    = "cotree: 1\n"
      "gravity: [0.3, -1, -9.81]\n"
      "bodies:\n"
      "  rod:\n"
      "    type: beam\n"
      "    length: 1.3\n"
      "    E: 3e4\n"
      "    G: 1e4\n"
      "    area: 1e-2*(1.2 - 0.3*x)\n"
      "    Iy: 2e-4\n"
      "    Iz: 1e-4*(1 - 0.2*x)\n"
      "    mass_per_length: 0.7\n"
      "    %s\n"
      "    points:\n"
      "      side: [0.37, 0.1, -0.05]\n"
      "      mid: length/2\n"
      "      far: 0.9\n"
      "      tip: {at: length, rotate: [z, 0.3]}\n"
      "  fork: {mass: 0.2, inertia: [0.01, 0.02, 0.015], com: [0.1, 0, 0.02]}\n"
      "  knob: {mass: 0.4, inertia: [0.01, 0.02, 0.015, 0.001, 0, 0.002], com: [0.05, 0, "
      "0.02]}\n"
      "joints:\n"
      "  base: {type: universal, from: ground, to: %s}\n"
      "  arm: {type: revolute, axis: y, from: rod.mid, to: fork}\n"
      "  grip: {type: weld, from: %s, to: knob}\n"
      "forces:\n"
      "  push: {type: force, at: rod.side, value: [1, -2, 0.7*sin(3*rod.tip.deflection.y)]}\n"
      "  pull: {type: spring, from: fork, to: rod.far, stiffness: 3, damping: 0.2, length: "
      "0.1}\n";

static const char *const kinds[] = {
    "formulation: linear\n    elements: 1",
    "formulation: linear\n    elements: 2\n    rotary_inertia: true",
    ("formulation: foreshortening\n    elements: 2\n    shapes: {v: [x^2, x^3], w: x^2, rx: x, "
     "u: [x]}"),
    "formulation: linear\n    elements: 2\n    shapes: {v: [x^2, x^3], w: x^2, rx: x}",
    "formulation: foreshortening\n    elements: 2\n    damping: {beta: 0.01}",
    "formulation: foreshortening\n    elements: [0.5, length]\n    frame: chord",
    "formulation: foreshortening\n    elements: 2\n    deformation: [bending-y, bending-z]",
    ("formulation: foreshortening\n    theory: timoshenko\n    shear_factor: [5/6, 0.3]\n    "
     "elements: 3\n"
     "    rotary_inertia: true"),
    ("formulation: linear\n    elements: 3\n    mass: lumped\n"
     "    rotary_inertia: [0.02, 0.01, 0.01]"),
    "formulation: linear\n    twist: quadratic\n    stretch: quadratic\n    elements: 2",
    ("formulation: foreshortening\n    twist: quadratic\n    stretch: quadratic\n    elements: "
     "2\n"
     "    rotary_inertia: [0.02, 0.01, 0.01]"),
};

static bool same_results(struct system *s, const struct variant *v, const struct variant *w,
                         const char *how)
{
    bool ok = true;
    double scale = 1;
    for (size_t i = 0; i < v->e.nresult; i++)
        scale = fmax(scale, fabs(v->result[i]));
    for (size_t i = 0; i < v->e.nresult; i++)
        ok &= agree(s->name, text_of(v->arena, "%s, %s", v->e.result[i].name, how),
                    w->result[i], v->result[i], scale, tolerance);
    return ok;
}

static void put_out_hanging(struct system *s)
{
    static const char *const frame[] = {"rod", "rod.side", "rod.mid", "rod.far", "rod.tip"};
    system_no_outputs(s);
    system_output_motion(s);
    system_output_reactions(s);
    for (size_t i = 0; i < COUNT(frame); i++)
        put_out(s, frame[i]);
}

// Joints as chords give multipliers, as branches cutset sums; forces and torques from different
// trees.
static bool trees_agree(struct system *s)
{
    static const char *const trans[] = {"rod", "arm", "grip"}, *const rot[]
                                                               = {"base", "arm", "grip"};
    const struct ct_formulate_options mixed = {.tree = CT_TREE_GIVEN,
                                               .with_outputs = true,
                                               .trans = trans,
                                               .ntrans = COUNT(trans),
                                               .rot = rot,
                                               .nrot = COUNT(rot)};
    const struct ct_formulate_options *const other[] = {&by_joints, &mixed};
    static const char *const how[] = {"joints", "translation by bodies"};
    struct variant v, w;
    bool ok = true;
    put_out_hanging(s);
    variant_open(s, &by_bodies, &v);
    move_anywhere(s, &v, 0.3, 0.05);
    assert_true(variant_solve(&v));
    assert_true(v.e.nrow == 3 + 1 + 5 + 6);
    for (size_t i = 0; i < COUNT(other); i++) {
        variant_open(s, other[i], &w);
        take_over(&v, &w, 0.3);
        assert_true(variant_solve(&w));
        ok &= same_results(s, &v, &w, how[i]);
        variant_close(&w);
    }
    variant_close(&v);
    return ok;
}

static void reactions_and_resultants_do_not_depend_on_the_trees(void **state)
{
    (void)state;
    static const char *const ends[] = {"rod", "rod.tip"};
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < COUNT(kinds); i++)
        for (int inward = 0; inward < 2; inward++) {
            struct ct_arena *a = ct_arena_create();
            struct system s;
            system_open_text(&s, kinds[i],
                             text_of(a, hanging, kinds[i], ends[inward], ends[!inward]));
            ok &= trees_agree(&s);
            system_close(&s);
            ct_arena_destroy(a);
        }
    assert_true(ok);
}

// ---- Newton and Euler ---------------------------------------------------------------------------

// The whole system: momentum about the ground origin changes as weight, the push and the base's
// reaction ask for. Its rate is a central difference along the motion.
static bool system_is_balanced(struct system *s, double total_mass)
{
    const double h = 1e-5, truncation = 1e-6; // h^2 times third derivatives of stiff beams
    struct variant v;
    put_out_hanging(s);
    system_output(s, "system.momentum");
    system_output(s, "system.angular_momentum");
    system_output(s, "system.com");
    system_output(s, "push.force");
    variant_open(s, &by_joints, &v);
    move_anywhere(s, &v, 0.3, 0.05);
    assert_true(variant_solve(&v));
    const size_t nq = v.e.nq, n = nq + v.e.nu;
    double *y = CT_NEWN(v.arena, double, n), *rate = CT_NEWN(v.arena, double, n);
    memcpy(y, v.y, n * sizeof *y);
    for (size_t k = 0; k < v.e.nu; k++) { // plain coordinates: q' = u
        rate[v.e.u[k].q] = y[nq + k];
        rate[nq + k] = v.s->a[k];
    }
    // the spring is inside; universal and revolute have plain angles
    const struct vector base = signal_of(&v, "base", "force"),
                        push = signal_of(&v, "push", "force");
    const struct vector torque = signal_of(&v, "base", "torque");
    const struct vector com = signal_of(&v, "system", "com");
    struct vector weight, force, moment;
    for (int i = 0; i < 3; i++)
        weight.e[i] = total_mass * ct_model_number(&s->model, s->model.gravity.e[i]);
    const char *held = s->model.frame[s->model.joint[0].to].name;
    force = plus(plus(base, 1, push), 1, weight);
    moment = plus(torque, 1, cross(signal_of(&v, held, "position"), base));
    moment = plus(moment, 1, cross(signal_of(&v, "rod.side", "position"), push));
    moment = plus(moment, 1, cross(com, weight));
    struct vector dp = {{0}}, dL = {{0}};
    for (int side = -1; side <= 1; side += 2) {
        for (size_t i = 0; i < n; i++)
            v.y[i] = y[i] + side * h * rate[i];
        variant_renew(&v, 0.3);
        assert_true(variant_solve(&v));
        dp = plus(dp, side / (2 * h), signal_of(&v, "system", "momentum"));
        dL = plus(dL, side / (2 * h), signal_of(&v, "system", "angular_momentum"));
    }
    bool ok = true;
    for (int i = 0; i < 3; i++) {
        ok &= agree(s->name, "momentum", dp.e[i], force.e[i], 1 + norm(force), truncation);
        ok &= agree(s->name, "angular momentum", dL.e[i], moment.e[i], 1 + norm(moment),
                    truncation);
    }
    variant_close(&v);
    return ok;
}

static void reactions_change_the_momentum(void **state)
{
    (void)state;
    static const char *const ends[] = {"rod", "rod.tip"};
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < COUNT(kinds); i++) {
        struct ct_arena *a = ct_arena_create();
        struct system s;
        system_open_text(&s, kinds[i],
                         text_of(a, hanging, kinds[i], ends[i % 2], ends[!(i % 2)]));
        ok &= system_is_balanced(&s, 0.7 * 1.3 + 0.2 + 0.4);
        system_close(&s);
        ct_arena_destroy(a);
    }
    assert_true(ok);
}

// Gauss-Legendre on (0, 1), 6 points: exact for what an element's acceleration times its place is.
static const double gauss[6][2]
    = {{0.033765242898423986, 0.08566224618958517}, {0.16939530676686775, 0.18038078652406930},
       {0.38069040695840155, 0.23395696728634552},  {0.61930959304159845, 0.23395696728634552},
       {0.83060469323313225, 0.18038078652406930},  {0.96623475710157601, 0.08566224618958517}};

static const char cut_rod[]
    = "cotree: 1\n"
      "gravity: [0.3, -1, -9.81]\n"
      "bodies:\n"
      "  rod:\n"
      "    type: beam\n"
      "    length: 1.3\n"
      "    elements: [0.6, 1.3]\n"
      "    E: 3e4\n"
      "    area: 1e-2\n"
      "    Iy: 2e-4\n"
      "    Iz: 1e-4\n"
      "    mass_per_length: 0.7\n"
      "    deformation: [bending-y, bending-z%s]\n"
      "    %s\n"
      "    points: {near: 0.4, far: 0.9, mid: 0.7, side: [0.55, 0.1, -0.05], tip: length%s}\n"
      "  fork: {mass: 0.2, inertia: [0.01, 0.02, 0.015], com: [0.1, 0, 0.02]}\n"
      "joints:\n"
      "  base: {type: universal, from: ground, to: rod}\n"
      "  arm: {type: revolute, axis: y, from: rod.mid, to: fork}\n"
      "forces:\n"
      "  push: {type: force, at: rod.side, value: [1, -2, 0.7]}\n"
      "  end: {type: torque, on: rod.tip, value: [0.1, -0.2, 0.3]}\n";

// What the part between two sections needs is what the sections' resultants give it: accelerations
// are those of frames on the axis, which the flexible arms know, not the beam's inertia.
static bool part_is_balanced(struct system *s)
{
    static const double end[] = {0.4, 0.6, 0.9};
    struct variant v;
    put_out_hanging(s);
    system_output(s, "rod.near.position");
    put_out(s, "rod.near");
    for (int i = 0; i < 12; i++)
        put_out(s, text_of(s->ctx.model, "rod.g%d", i));
    variant_open(s, &by_joints, &v);
    move_anywhere(s, &v, 0, 0.05);
    assert_true(variant_solve(&v));
    const struct vector from = signal_of(&v, "rod.near", "position");
    const struct vector to = plus(signal_of(&v, "rod.far", "position"), -1, from);
    struct vector F = {{0}}, T = {{0}};
    for (int i = 0; i < 12; i++) {
        const char *name = text_of(v.arena, "rod.g%d", i);
        const double m = 0.7 * gauss[i % 6][1] * (end[i / 6 + 1] - end[i / 6]);
        struct vector a = signal_of(&v, name, "acceleration");
        for (int k = 0; k < 3; k++)
            a.e[k] = m * (a.e[k] - ct_model_number(&s->model, s->model.gravity.e[k]));
        F = plus(F, 1, a);
        T = plus(T, 1, cross(plus(signal_of(&v, name, "position"), -1, from), a));
    }
    // what it passes on to the fork and what pushes it
    const struct vector fork = turned(&v, "rod.mid", signal_of(&v, "arm", "force"));
    const struct vector twist = turned(&v, "rod.mid", signal_of(&v, "arm", "torque"));
    const struct vector mid = plus(signal_of(&v, "rod.mid", "position"), -1, from);
    const struct vector side = plus(signal_of(&v, "rod.side", "position"), -1, from);
    const struct vector push = {{1, -2, 0.7}};
    F = plus(plus(F, 1, fork), -1, push);
    T = plus(plus(T, 1, twist), 1, cross(mid, fork));
    T = plus(T, -1, cross(side, push));
    // the part beyond pulls it by the resultants at `far`, it pulls the part before by those at
    // `near`
    const struct vector f0 = turned(&v, "rod.near", signal_of(&v, "rod.near", "force"));
    const struct vector f1 = turned(&v, "rod.far", signal_of(&v, "rod.far", "force"));
    const struct vector m0 = turned(&v, "rod.near", signal_of(&v, "rod.near", "moment"));
    const struct vector m1 = turned(&v, "rod.far", signal_of(&v, "rod.far", "moment"));
    const struct vector given = plus(f1, -1, f0);
    const struct vector turning = plus(plus(m1, -1, m0), 1, cross(to, f1));
    // at the ends: the joint holds the whole; the torque is all that is there
    const struct vector held = plus(turned(&v, "rod", signal_of(&v, "rod", "force")), 1,
                                    signal_of(&v, "base", "force"));
    const struct vector held_m = plus(turned(&v, "rod", signal_of(&v, "rod", "moment")), 1,
                                      signal_of(&v, "base", "torque"));
    const struct vector last = turned(&v, "rod.tip", signal_of(&v, "rod.tip", "moment"));
    const struct vector end_torque = {{0.1, -0.2, 0.3}};
    bool ok = true;
    for (int i = 0; i < 3; i++) {
        ok &= agree(s->name, "force", given.e[i], F.e[i], 1 + norm(F), tolerance);
        ok &= agree(s->name, "moment", turning.e[i], T.e[i], 1 + norm(T), tolerance);
        ok &= agree(s->name, "force at the start", held.e[i], 0, norm(f0), tolerance);
        ok &= agree(s->name, "moment at the start", held_m.e[i], 0, norm(m0), tolerance);
        ok &= agree(s->name, "moment at the end", last.e[i], end_torque.e[i], 1, tolerance);
    }
    variant_close(&v);
    return ok;
}

static void the_part_between_two_sections_is_balanced(void **state)
{
    (void)state;
    static const struct {
        const char *axial, *keys;
    } kind[] = {
        {", axial", "formulation: linear"},
        {"", "formulation: linear"},
        {", axial", "formulation: foreshortening"},
        {", axial", "formulation: foreshortening\n    frame: chord"},
        {"", "formulation: foreshortening"},
    };
    static const double end[] = {0.4, 0.6, 0.9};
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < COUNT(kind); i++) {
        struct ct_arena *a = ct_arena_create();
        struct system s;
        const char *points = "";
        for (int k = 0; k < 12; k++)
            points = text_of(a, "%s, g%d: %.17g", points, k,
                             end[k / 6] + gauss[k % 6][0] * (end[k / 6 + 1] - end[k / 6]));
        system_open_text(&s, kind[i].keys,
                         text_of(a, cut_rod, kind[i].axial, kind[i].keys, points));
        ok &= part_is_balanced(&s);
        system_close(&s);
        ct_arena_destroy(a);
    }
    assert_true(ok);
}

// ---- statics ------------------------------------------------------------------------------------

// A clamped beam with end forces, an end torque and its weight. Loads are small, so that
// second-order terms are below round-off.
static const char cantilever[]
    = "cotree: 1\n"
      "gravity: [0, -2e-7, 0]\n"
      "bodies:\n"
      "  rod:\n"
      "    type: beam\n"
      "    length: 2\n"
      "    elements: %d\n"
      "    E: 7\n"
      "    G: 3\n"
      "    area: 1.5\n"
      "    Iy: 2\n"
      "    Iz: 1\n"
      "    J: 2.5\n"
      "    mass_per_length: 0.1\n"
      "    rotary_inertia: true\n"
      "    formulation: %s\n"
      "    points: {a: 0.3, b: 1.5, tip: length}\n"
      "joints:\n"
      "  clamp: {type: weld, from: ground, to: rod}\n"
      "forces:\n"
      "  load: {type: force, at: rod.tip, value: [3e-7, 1e-7, -2e-7]}\n"
      "  twist: {type: torque, on: rod.tip, value: [4e-8, 0, 0]}\n";

enum { L = 2 };
static const double q = 0.1 * 2e-7, N = 3e-7, P = 1e-7, R = -2e-7, T = 4e-8;

// Textbook: displacements u, v, w, twist and slopes of the axis.
static void exact_shape(double x, double out[6])
{
    const double EIz = 7, EIy = 14, EA = 10.5, GJ = 7.5;
    out[0] = N * x / EA;
    out[1] = P * x * x * (3 * L - x) / (6 * EIz)
           - q * x * x * (6 * L * L - 4 * L * x + x * x) / (24 * EIz);
    out[2] = R * x * x * (3 * L - x) / (6 * EIy);
    out[3] = T * x / GJ;
    out[4] = -R * x * (2 * L - x) / (2 * EIy);
    out[5]
        = P * x * (2 * L - x) / (2 * EIz) - q * x * (3 * L * L - 3 * L * x + x * x) / (6 * EIz);
}

// Moments and forces there: M = P (L - x) - q (L - x)^2/2.
static bool section_is_exact(const struct system *s, const struct variant *v, const char *frame,
                             double x)
{
    const double f[3] = {N, P - q * (L - x), R};
    const double m[3] = {T, -R * (L - x), P * (L - x) - q * (L - x) * (L - x) / 2};
    bool ok = true;
    for (int i = 0; i < 3; i++) {
        ok &= agree(s->name, text_of(v->arena, "force %c at %s", "xyz"[i], frame),
                    signal_of(v, frame, "force").e[i], f[i], 1e-7, 1e-6);
        ok &= agree(s->name, text_of(v->arena, "moment %c at %s", "xyz"[i], frame),
                    signal_of(v, frame, "moment").e[i], m[i], 1e-7, 1e-6);
    }
    return ok;
}

// Cubic elements are exact at the nodes: the textbook's values there are an equilibrium.
static bool cantilever_is_exact(struct system *s, int nelement)
{
    static const char *const frame[] = {"rod", "rod.a", "rod.b", "rod.tip"};
    static const double place[] = {0, 0.3, 1.5, L};
    static const char *const kind[] = {"u", "v", "w", "rx", "ry", "rz"};
    struct variant v;
    bool ok = true;
    double shape[6];
    system_no_outputs(s);
    for (size_t i = 0; i < COUNT(frame); i++) {
        put_out(s, frame[i]);
        system_output(s, text_of(s->ctx.model, "%s.slope", frame[i]));
        system_output(s, text_of(s->ctx.model, "%s.deflection", frame[i]));
        system_output(s, text_of(s->ctx.model, "%s.strain", frame[i]));
    }
    variant_open(s, &by_joints, &v);
    for (size_t i = 0; i < v.e.nq; i++)
        for (int node = 1; node <= nelement; node++)
            for (int k = 0; k < 6; k++)
                if (!strcmp(v.e.q[i].name, text_of(v.arena, "rod.%d.%s", node, kind[k]))) {
                    exact_shape((double)L * node / nelement, shape);
                    v.y[i] = shape[k];
                }
    variant_renew(&v, 0);
    assert_true(variant_solve(&v));
    for (size_t k = 0; k < v.e.nu; k++) // loads of 1e-7 would accelerate by as much
        ok &= agree(s->name, v.e.u[k].name, v.s->a[k], 0, 1e-7, 1e-5);
    for (size_t i = 0; i < COUNT(frame); i++)
        ok &= section_is_exact(s, &v, frame[i], place[i]);
    exact_shape(L, shape);
    for (int i = 0; i < 3; i++) {
        ok &= agree(s->name, "tip deflection", signal_of(&v, "rod.tip", "deflection").e[i],
                    shape[i], 1e-7, 1e-6);
        ok &= agree(s->name, "tip slope", signal_of(&v, "rod.tip", "slope").e[i], shape[3 + i],
                    1e-7, 1e-6);
    }
    for (size_t i = 0; i < COUNT(frame); i++)
        ok &= agree(s->name, "strain",
                    v.result[variant_result(&v, text_of(v.arena, "%s.strain", frame[i]))],
                    N / 10.5, 1e-7, 1e-6);
    variant_close(&v);
    return ok;
}

static void cantilevers_are_those_of_the_textbook(void **state)
{
    (void)state;
    static const char *const formulation[] = {"linear", "foreshortening"};
    bool ok = true;
    for (size_t i = 0; i < COUNT(formulation); i++)
        for (int n = 1; n <= 3; n++) {
            struct ct_arena *a = ct_arena_create();
            struct system s;
            system_open_text(&s, formulation[i], text_of(a, cantilever, n, formulation[i]));
            ok &= cantilever_is_exact(&s, n);
            system_close(&s);
            ct_arena_destroy(a);
        }
    assert_true(ok);
}

// ---- what the signals of shape mean -------------------------------------------------------------

// v by the smallest rotation that turns n into x.
static struct vector seen_along(struct vector n, struct vector v)
{
    const struct vector x = {{1, 0, 0}};
    const struct vector k = cross(n, x);
    const double c = n.e[0], dot = k.e[0] * v.e[0] + k.e[1] * v.e[1] + k.e[2] * v.e[2];
    struct vector out = plus(cross(k, v), dot / (1 + c), k);
    return plus(out, c, v);
}

static struct vector untwisted(const struct variant *v, const char *frame, struct vector a)
{
    struct vector r = {{0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r.e[i] += a.e[j]
                    * v->result[variant_result(
                        v, text_of(v->arena, "%s.rotation.%c%c", frame, "xyz"[j], "xyz"[i]))];
    return r;
}

static struct vector turn_about(int axis, double angle, struct vector v)
{
    struct vector n = {{0}};
    n.e[axis] = 1;
    const double along = v.e[axis];
    struct vector r = plus(cross(n, v), along * (1 - cos(angle)) / sin(angle), n);
    for (int i = 0; i < 3; i++)
        r.e[i] = sin(angle) * r.e[i] + cos(angle) * v.e[i];
    return r;
}

// With a clamped frame the axes of `rod` are the beam's.
static bool shape_is_as_defined(struct system *s)
{
    static const char *const property[] = {"deflection", "chord_deflection", "slope"};
    static const char *const frame[] = {"rod.side", "rod.mid", "rod.tip"};
    static const struct vector rest[] = {{{0.37, 0.1, -0.05}}, {{0.65, 0, 0}}, {{1.3, 0, 0}}};
    struct variant v;
    bool ok = true;
    put_out_hanging(s);
    for (size_t i = 0; i < COUNT(frame); i++)
        for (size_t k = 0; k < COUNT(property); k++)
            system_output(s, text_of(s->ctx.model, "%s.%s", frame[i], property[k]));
    variant_open(s, &by_joints, &v);
    move_anywhere(s, &v, 0.3, 0.1);
    assert_true(variant_solve(&v));
    const struct vector start = signal_of(&v, "rod", "position");
    struct vector chord
        = untwisted(&v, "rod", plus(signal_of(&v, "rod.tip", "position"), -1, start));
    const double length = norm(chord);
    for (int i = 0; i < 3; i++)
        chord.e[i] /= length;
    for (size_t i = 0; i < COUNT(frame); i++) {
        const struct vector place
            = untwisted(&v, "rod", plus(signal_of(&v, frame[i], "position"), -1, start));
        const struct vector deflection = plus(place, -1, rest[i]);
        const struct vector bow = plus(seen_along(chord, place), -1, rest[i]);
        const struct vector slope = signal_of(&v, frame[i], "slope");
        // the section's x axis in the beam; the tip's frame is turned about its z axis by 0.3
        struct vector own = {{1, 0, 0}};
        if (i == 2)
            own = turn_about(2, -0.3, own);
        const struct vector x = untwisted(&v, "rod", turned(&v, frame[i], own));
        struct vector want = {{1, 0, 0}};
        want = turn_about(2, slope.e[2] / 2, turn_about(0, slope.e[0], want));
        want = turn_about(2, slope.e[2] / 2, turn_about(1, slope.e[1], want));
        for (int k = 0; k < 3; k++) {
            ok &= agree(s->name, frame[i], signal_of(&v, frame[i], "deflection").e[k],
                        deflection.e[k], 1, tolerance);
            ok &= agree(s->name, frame[i], signal_of(&v, frame[i], "chord_deflection").e[k],
                        bow.e[k], 1, tolerance);
            ok &= agree(s->name, frame[i], x.e[k], want.e[k], 1, tolerance);
        }
    }
    assert_true(norm(signal_of(&v, "rod.mid", "chord_deflection")) > 1e-3);
    variant_close(&v);
    return ok;
}

static void signals_of_shape_mean_what_the_manual_says(void **state)
{
    (void)state;
    bool ok = true;
    chance_start();
    for (size_t i = 0; i < 3; i++) {
        struct ct_arena *a = ct_arena_create();
        struct system s;
        system_open_text(&s, kinds[i], text_of(a, hanging, kinds[i], "rod", "rod.tip"));
        ok &= shape_is_as_defined(&s);
        system_close(&s);
        ct_arena_destroy(a);
    }
    assert_true(ok);
}

// Shape may steer a force (`push` above); what follows from accelerations may not.
static void a_force_cannot_depend_on_a_section_force(void **state)
{
    (void)state;
    static const char *const signal[] = {"rod.mid.moment.z", "rod.tip.force.x"};
    for (size_t i = 0; i < COUNT(signal); i++) {
        struct ct_arena *a = ct_arena_create();
        struct system s;
        const char *text
            = text_of(a, "%s  feed: {type: force, at: rod.tip, value: [0, %s, 0]}\n",
                      text_of(a, hanging, kinds[0], "rod", "rod.tip"), signal[i]);
        assert_false(system_try_text(&s, "feed", text));
        assert_int_equal(s.ctx.diagnostic[0].code, CT_E_SIGNAL_USE);
        system_close(&s);
        ct_arena_destroy(a);
    }
}

// ---- equations of a source ----------------------------------------------------------------------

// A hinge about y, one linear element, a particle at its tip.
static const char pendulum_beam[]
    = "cotree: 1\n"
      "gravity: [1.1, -2.3, -9.81]\n"
      "bodies:\n"
      "  beam:\n"
      "    type: beam\n"
      "    length: 1.7\n"
      "    density: 5\n"
      "    E: 700\n"
      "    G: 300\n"
      "    area: 0.3\n"
      "    Iy: 0.02\n"
      "    Iz: 0.02\n"
      "    formulation: linear\n"
      "    deformation: [axial, bending-y, bending-z, torsion]\n"
      "    points: {tip: length}\n"
      "  mass: {type: particle, mass: 0.8}\n"
      "joints:\n"
      "  hinge: {type: revolute, axis: y, from: ground, to: beam}\n"
      "  tip: {type: weld, from: beam.tip, to: mass}\n";

// Mass matrix and forces of the system of docs/theory.md, section 3.4, written out by hand; z:
// theta, q7 ... q12, and their rates.
static void source_equations(const double *z, const double *rate, double M[7][7], double Q[7])
{
    const double l = 1.7, m = 5 * 0.3 * l, ms = 0.8, EA = 700 * 0.3, EI = 700 * 0.02;
    const double GIp = 300 * 0.04, Jt = 5 * 0.04 * l / 3, k = EI / (l * l * l);
    const double g[3] = {1.1, -2.3, -9.81}, c = cos(z[0]), s = sin(z[0]);
    const double gx = c * g[0] - s * g[2], gy = g[1], gz = s * g[0] + c * g[2];
    const double q8 = z[2], q9 = z[3], q10 = z[4], q11 = z[5], q12 = z[6], xt = l + z[1];
    const double Om = rate[0], d7 = rate[1], d9 = rate[3], d11 = rate[5];
    const double Wd
        = 13. / 35 * q9 * d9 + 11. / 210 * l * (q9 * d11 + q11 * d9) + l * l / 105 * q11 * d11;
    memset(M, 0, 49 * sizeof(double));
    M[0][0] = m
                * (xt * xt / 3 + 13. / 35 * q9 * q9 + 11. / 105 * l * q9 * q11
                   + l * l * q11 * q11 / 105)
            + ms * (xt * xt + q9 * q9);
    M[0][1] = M[1][0] = m * (7. / 20 * q9 + l / 20 * q11) + ms * q9;
    M[0][3] = M[3][0] = -(7. / 20 * m + ms) * xt;
    M[0][5] = M[5][0] = -m * l / 20 * xt;
    M[1][1] = m / 3 + ms;
    M[2][2] = M[3][3] = 13. / 35 * m + ms;
    M[2][6] = M[6][2] = -11. / 210 * m * l;
    M[3][5] = M[5][3] = 11. / 210 * m * l;
    M[5][5] = M[6][6] = m * l * l / 105;
    M[4][4] = Jt;
    Q[0] = -2 * Om * (m * (xt * d7 / 3 + Wd) + ms * (xt * d7 + q9 * d9))
         + gx * (m * (q9 / 2 + l * q11 / 12) + ms * q9) - gz * (m / 2 + ms) * xt;
    Q[1] = Om * Om * (m / 3 + ms) * xt - 2 * Om * (m * (7. / 20 * d9 + l / 20 * d11) + ms * d9)
         + gx * (m / 2 + ms) - EA / l * z[1];
    Q[2] = gy * (m / 2 + ms) - 12 * k * q8 + 6 * k * l * q12;
    Q[3] = Om * Om * (13. / 35 * m * q9 + 11. / 210 * m * l * q11 + ms * q9)
         + 2 * Om * (7. / 20 * m + ms) * d7 + gz * (m / 2 + ms) - 12 * k * q9 - 6 * k * l * q11;
    Q[4] = -GIp / l * q10;
    Q[5] = Om * Om * (11. / 210 * m * l * q9 + m * l * l / 105 * q11)
         + 2 * Om * (m * l / 20) * d7 + gz * m * l / 12 - 6 * k * l * q9 - 4 * k * l * l * q11;
    Q[6] = -gy * m * l / 12 + 6 * k * l * q8 - 4 * k * l * l * q12;
}

static void the_pendulum_beam_has_the_equations_of_its_source(void **state)
{
    (void)state;
    static const char *const name[] = {"hinge.q",   "beam.1.u",  "beam.1.v", "beam.1.w",
                                       "beam.1.rx", "beam.1.ry", "beam.1.rz"};
    struct system s;
    struct variant v;
    bool ok = true;
    chance_start();
    system_open_text(&s, "pendulum beam", pendulum_beam);
    system_no_outputs(&s);
    variant_open(&s, &by_choice, &v);
    assert_int_equal(v.e.nu, 7);
    for (int k = 0; k < 7; k++)
        assert_string_equal(v.e.q[v.e.u[k].q].name, name[k]);
    for (int trial = 0; trial < 5; trial++) {
        double M[7][7], Q[7];
        for (int k = 0; k < 14; k++)
            v.y[k] = 2 * chance();
        variant_renew(&v, 0);
        source_equations(v.y, v.y + 7, M, Q);
        const double *got = ct_partition_mass(v.s);
        for (int i = 0; i < 7; i++) {
            ok &= agree(s.name, name[i], v.m->Q[i], Q[i], 1 + fabs(Q[i]), 1e-13);
            for (int j = 0; j < 7; j++)
                ok &= agree(s.name, name[i], got[i + 7 * j], M[i][j], 1 + fabs(M[i][j]), 1e-13);
        }
    }
    variant_close(&v);
    system_close(&s);
    assert_true(ok);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reactions_and_resultants_do_not_depend_on_the_trees),
        cmocka_unit_test(reactions_change_the_momentum),
        cmocka_unit_test(the_part_between_two_sections_is_balanced),
        cmocka_unit_test(cantilevers_are_those_of_the_textbook),
        cmocka_unit_test(signals_of_shape_mean_what_the_manual_says),
        cmocka_unit_test(a_force_cannot_depend_on_a_section_force),
        cmocka_unit_test(the_pendulum_beam_has_the_equations_of_its_source),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
