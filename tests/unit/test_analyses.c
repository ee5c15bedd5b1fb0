// Equilibria, natural motions, linear models, driven motions and buckling against closed forms.
#include "tests/check.h"

#include <cotree/cotree.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

static char folder[] = "/tmp/cotree-test-XXXXXX";
static char path[64], other[64], table[64];

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    snprintf(path, sizeof path, "%s/model.yaml", folder);
    snprintf(other, sizeof other, "%s/other.yaml", folder);
    snprintf(table, sizeof table, "%s/table.csv", folder);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    remove(path);
    remove(other);
    remove(table);
    return rmdir(folder);
}

static void write_text(const char *file, const char *text)
{
    FILE *f = fopen(file, "w");
    assert_non_null(f);
    assert_true(fputs(text, f) >= 0 && fclose(f) == 0);
}

static void *checked(struct ct_ctx *ctx, void *p)
{
    if (!p) {
        ct_ctx_print_diagnostics(ctx, stderr);
        fail();
    }
    return p;
}

static struct ct_system *load_with(struct ct_ctx *ctx, const char *text,
                                   const struct ct_system_options *options)
{
    write_text(path, text);
    return checked(ctx, ct_system_load(ctx, path, options));
}

// ---- natural motions ----------------------------------------------------------------------------

struct want {
    double omega, damping;
};

// All modes of a model about a configuration: as many as wanted, to round-off of well conditioned
// problems.
static void check_modes(const char *text, const char *about, const struct want *want, size_t n)
{
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = load_with(ctx, text, NULL);
    struct ct_modes *modes = checked(
        ctx,
        ct_modes_create(ctx, sys, &(struct ct_modes_options){.about = about, .count = 50}));
    assert_int_equal(ct_modes_count(modes), n);
    for (size_t i = 0; i < n; i++) {
        const struct ct_mode_info m = ct_modes_info(modes, i);
        CHECK_CLOSE(m.omega, want[i].omega, 1e-11, 1e-12);
        CHECK_CLOSE(m.damping, want[i].damping, 1e-11, 1e-12);
        CHECK_CLOSE(m.frequency_hz * 2 * 3.14159265358979323846, m.omega, 1e-15, 0);
    }
    ct_modes_destroy(modes);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}
#define CHECK_MODES(text, about, ...)                                                          \
    check_modes((text), (about), (const struct want[]){__VA_ARGS__},                           \
                sizeof((const struct want[]){__VA_ARGS__}) / sizeof(struct want))

static void two_masses_between_walls(void **state)
{
    (void)state;
    // equal masses, three equal springs: k/m and 3 k/m; dampers c = b k give the damping b omega /
    // 2
    CHECK_MODES(
        "cotree: 1\n"
        "bodies: {ground: {points: {wall: [2, 0, 0]}}, a: {mass: 1}, b: {mass: 1}}\n"
        "joints:\n"
        "  left: {type: prismatic, from: ground, to: a, stiffness: 100, damping: 0.2}\n"
        "  middle: {type: prismatic, from: a, to: b, stiffness: 100, damping: 0.2}\n"
        "  right: {type: prismatic, from: ground, to: b, stiffness: 100, damping: 0.2}\n",
        "initial", {10, 0.01}, {sqrt(300), 0.001 * sqrt(300)});
}

static void a_free_cart_with_a_damper(void **state)
{
    (void)state;
    CHECK_MODES("cotree: 1\n"
                "bodies: {cart: {mass: 4}}\n"
                "joints: {rail: {type: prismatic, from: ground, to: cart, damping: 2}}\n",
                NULL, {0, 0}, {0.5, 1});
}

static void an_upright_pendulum_grows_and_decays(void **state)
{
    (void)state;
    CHECK_MODES("cotree: 1\n"
                "gravity: [0, -9, 0]\n"
                "bodies: {rod: {mass: 1, com: [0, 1, 0]}}\n"
                "joints: {pin: {type: revolute, from: ground, to: rod}}\n",
                "equilibrium", {3, -1}, {3, 1});
}

static void a_massless_coordinate_follows_its_springs(void **state)
{
    (void)state;
    // springs of 100 and 300 N/m in a row: 75 N/m
    CHECK_MODES("cotree: 1\n"
                "bodies: {ring: {}, block: {mass: 2}}\n"
                "joints:\n"
                "  inner: {type: prismatic, from: ground, to: ring, stiffness: 100}\n"
                "  outer: {type: prismatic, from: ring, to: block, stiffness: 300}\n",
                NULL, {sqrt(37.5), 0});
}

static void a_massless_coordinate_with_a_damper_creeps(void **state)
{
    (void)state;
    // a damper and a spring in a row: s (m c s^2 + m k s + k c) = 0
    const double m = 2, c = 5, k = 300, root = sqrt(m * k * m * k - 4 * m * c * k * c);
    CHECK_MODES("cotree: 1\n"
                "bodies: {ring: {}, block: {mass: 2}}\n"
                "joints:\n"
                "  inner: {type: prismatic, from: ground, to: ring, damping: 5}\n"
                "  outer: {type: prismatic, from: ring, to: block, stiffness: 300}\n",
                NULL, {0, 0}, {(m * k - root) / (2 * m * c), 1},
                {(m * k + root) / (2 * m * c), 1});
}

// One cubic element, free in space: w^2 = 720 and 8400 EI/(m L^4). Its turn about its own axis
// moves no mass and nothing holds it: it is no motion, and takes no part in the others.
static void a_coordinate_without_mass_and_stiffness_is_no_mode(void **state)
{
    (void)state;
#define FREE_BEAM(more)                                                                        \
    "cotree: 1\n"                                                                              \
    "bodies: {b: {type: beam, length: 1, E: 1, area: 1, Iz: 1, mass_per_length: 1,\n"          \
    "    formulation: linear, deformation: [bending-z]" more "}}\n"
    CHECK_MODES(FREE_BEAM(""), NULL, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {sqrt(720), 0},
                {sqrt(8400), 0});
    CHECK_MODES(FREE_BEAM(", frame: chord"), NULL, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0},
                {sqrt(720), 0}, {sqrt(8400), 0});
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys
        = load_with(ctx, FREE_BEAM(", elements: 16, damping: {beta: 1e-5}"), NULL);
    assert_null(ct_modes_create(ctx, sys, &(struct ct_modes_options){.count = 50}));
    assert_int_equal(ct_ctx_fault(ctx), CT_FAULT_MODEL);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

static void a_pendulum_on_a_turning_shaft(void **state)
{
    (void)state;
    // hangs out by cos theta = g/(l W^2) and swings there at W sin theta
    const double cosine = 9.81 / (0.5 * 36);
    CHECK_MODES("cotree: 1\n"
                "gravity: [0, 0, -9.81]\n"
                "bodies:\n"
                "  shaft: {inertia: 0.1}\n"
                "  arm: {mass: 2, com: [0, 0, -0.5]}\n"
                "joints:\n"
                "  bearing: {type: revolute, from: ground, to: shaft, motion: 6*t}\n"
                "  hinge: {type: revolute, from: shaft, to: arm, axis: y, initial: {q: 0.3}}\n",
                "equilibrium", {6 * sqrt(1 - cosine * cosine), 0});
}

static void a_sleeping_top_seen_from_the_top(void **state)
{
    (void)state;
    // A W^2 - C w W + m g h = 0 in space; the body's axes turn at w
    const double A = 0.12, C = 0.02, w = 100, mgh = 0.3 * 9.81;
    const double root = sqrt(C * w * C * w - 4 * A * mgh);
    CHECK_MODES(
        "cotree: 1\n"
        "gravity: [0, 0, -9.81]\n"
        "bodies: {top: {mass: 1, com: [0, 0, 0.3], inertia: [0.03, 0.03, 0.02]}}\n"
        "joints: {foot: {type: spherical, from: ground, to: top, initial: {u: [0, 0, 100]}}}\n",
        "initial", {0, 0}, {w - (C * w + root) / (2 * A), 0},
        {w - (C * w - root) / (2 * A), 0});
}

static void a_motion_is_linearised_at_a_time(void **state)
{
    (void)state;
    // a pendulum in a field that turns off: nothing but the spring is left after 1 s
    CHECK_MODES("cotree: 1\n"
                "bodies: {rod: {mass: 1, com: [0, -1, 0]}}\n"
                "joints: {pin: {type: revolute, from: ground, to: rod, stiffness: 4,\n"
                "  effort: \"if(t < 1, -12*pin.q, 0)\", initial: {q: 0.1}}}\n"
                "simulation: {duration: 5}\n",
                "2", {2, 0});
}

static void shapes_have_names(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys
        = load_with(ctx,
                    "cotree: 1\n"
                    "bodies: {a: {mass: 1}, b: {mass: 1}}\n"
                    "joints:\n"
                    "  left: {type: prismatic, from: ground, to: a, stiffness: 100}\n"
                    "  right: {type: prismatic, from: ground, to: b, stiffness: 900}\n",
                    NULL);
    struct ct_modes *modes = checked(ctx, ct_modes_create(ctx, sys, NULL));
    double re, im;
    assert_true(ct_modes_shape(modes, 1, "right.q", &re, &im));
    CHECK_CLOSE(re, 1, 0, 1e-14);
    assert_true(ct_modes_shape(modes, 1, "left.q", &re, &im));
    CHECK_CLOSE(re, 0, 0, 1e-14);
    assert_false(ct_modes_shape(modes, 1, "wrong.q", &re, &im));
    assert_null(ct_modes_create(ctx, sys, &(struct ct_modes_options){.about = "equilibirum"}));
    assert_int_equal(ct_ctx_fault(ctx), CT_FAULT_OPTION);
    ct_modes_destroy(modes);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

static double flapping(const char *speed, const char *plane)
{
    static const char text[]
        = "cotree: 1\n"
          "parameters: {W: 0}\n"
          "bodies:\n"
          "  hub: {inertia: 1}\n"
          "  beam: {type: beam, length: 1, elements: 6, mass_per_length: 1, E: 1, nu: 0.3, "
          "area: 1, Iy: 1, Iz: 1,\n"
          "    formulation: foreshortening, deformation: [%s]}\n"
          "joints:\n"
          "  bearing: {type: revolute, from: ground, to: hub, motion: W*t}\n"
          "  clamp: {type: weld, from: hub, to: beam}\n";
    char model[sizeof text + 32];
    struct ct_ctx *ctx = ct_ctx_create();
    snprintf(model, sizeof model, text, plane);
    struct ct_system *sys
        = load_with(ctx, model, &(struct ct_system_options){.set = &speed, .nset = 1});
    struct ct_modes *modes = checked(ctx, ct_modes_create(ctx, sys, NULL));
    const double omega = ct_modes_info(modes, 0).omega;
    ct_modes_destroy(modes);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
    return omega * omega;
}

static void a_turning_beam_stiffens_by_southwell(void **state)
{
    (void)state;
    // 1.1933 for slow turning and no hub, out of the plane; one less in it
    CHECK_CLOSE((flapping("W=0.1", "bending-y") - flapping("W=0", "bending-y")) / 0.01, 1.1933,
                0, 1e-4);
    CHECK_CLOSE((flapping("W=0.1", "bending-z") - flapping("W=0", "bending-z")) / 0.01, 0.1933,
                0, 1e-4);
}

// A row of masses on rails of their own, springs between neighbours, and one to ground if it is
// held there.
static char *row_of_masses(int n, bool is_held)
{
    const size_t room = 256 * (size_t)n + 512;
    char *text = malloc(room);
    assert_non_null(text);
    size_t at = (size_t)snprintf(text, room, "cotree: 1\nbodies:\n");
    for (int i = 1; i <= n; i++)
        at += (size_t)snprintf(text + at, room - at, "  m%d: {mass: 2}\n", i);
    at += (size_t)snprintf(text + at, room - at, "joints:\n");
    for (int i = 1; i <= n; i++)
        at += (size_t)snprintf(
            text + at, room - at,
            "  r%d: {type: prismatic, from: ground, to: m%d, initial: {q: %d}}\n", i, i, i);
    at += (size_t)snprintf(text + at, room - at, "forces:\n");
    for (int i = is_held ? 0 : 1; i < n; i++) {
        char from[16];
        snprintf(from, sizeof from, i ? "m%d" : "ground", i);
        at += (size_t)snprintf(
            text + at, room - at,
            "  s%d: {type: spring, from: %s, to: m%d, stiffness: 800, length: 1}\n", i, from,
            i + 1);
    }
    return text;
}

// So many that only the lowest are sought, on sparse matrices.
static void rows_of_many_masses(void **state)
{
    (void)state;
    enum { N = 310, COUNT = 6 };
    const double pi = 3.14159265358979323846;
    for (int held = 0; held < 2; held++) {
        struct ct_ctx *ctx = ct_ctx_create();
        char *text = row_of_masses(N, held);
        struct ct_system *sys = load_with(ctx, text, NULL);
        struct ct_modes *modes = checked(
            ctx, ct_modes_create(ctx, sys, &(struct ct_modes_options){.count = COUNT}));
        assert_int_equal(ct_modes_count(modes), COUNT);
        for (int i = 0; i < COUNT; i++) {
            const double angle = held ? (2 * i + 1) * pi / (2 * (2 * N + 1)) : i * pi / (2 * N);
            // the round-off errors of a stiffness whose slowest mode is a hundred thousandth of the
            // fastest
            CHECK_CLOSE(ct_modes_info(modes, (size_t)i).omega, 2 * 20 * sin(angle), 1e-9, 1e-9);
        }
        ct_modes_destroy(modes);
        ct_system_destroy(sys);
        ct_ctx_destroy(ctx);
        free(text);
    }
}

// ---- equilibria ---------------------------------------------------------------------------------

static struct ct_equilibrium *find_equilibrium(struct ct_ctx *ctx, struct ct_system *sys)
{
    return checked(ctx, ct_equilibrium_create(ctx, sys, NULL));
}

static const char two_rods[]
    = "cotree: 1\n"
      "gravity: [0, -9.81, 0]\n"
      "parameters: {first: 2.5, second: 1.5}\n"
      "bodies:\n"
      "  a: {mass: 1, com: [0, -1, 0], points: {tip: [0, -1, 0]}}\n"
      "  b: {mass: 1, com: [0, -1, 0]}\n"
      "joints:\n"
      "  upper: {type: revolute, from: ground, to: a, initial: {q: first}}\n"
      "  lower: {type: revolute, from: a.tip, to: b, initial: {q: second}}\n"
      "outputs: [b.com.y]\n";

static void pendulums_find_their_lower_equilibrium(void **state)
{
    (void)state;
    static const char *const starts[][2]
        = {{"first=2.5", "second=1.5"}, {"first=3", "second=0.1"}, {"first=-1", "second=3"}};
    struct ct_ctx *ctx = ct_ctx_create();
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        struct ct_system *sys = load_with(
            ctx, two_rods, &(struct ct_system_options){.set = starts[i], .nset = 2});
        struct ct_equilibrium *q = find_equilibrium(ctx, sys);
        CHECK_CLOSE(ct_equilibrium_value(q, "b.com.y"), -2, 1e-15, 0);
        assert_true(ct_equilibrium_is_stable(q));
        ct_equilibrium_destroy(q);
        ct_system_destroy(sys);
    }
    ct_ctx_destroy(ctx);
}

static void an_unstable_equilibrium_is_one(void **state)
{
    (void)state;
    static const char *const upright[] = {"first=pi", "second=0"};
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys
        = load_with(ctx, two_rods, &(struct ct_system_options){.set = upright, .nset = 2});
    struct ct_equilibrium *q = find_equilibrium(ctx, sys);
    CHECK_CLOSE(ct_equilibrium_value(q, "b.com.y"), 2, 1e-15, 0);
    assert_false(ct_equilibrium_is_stable(q));
    ct_equilibrium_destroy(q);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

static void what_nothing_holds_is_named(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys
        = load_with(ctx,
                    "cotree: 1\n"
                    "bodies: {a: {mass: 1}}\n"
                    "joints: {rail: {type: prismatic, from: ground, to: a, effort: 1}}\n",
                    NULL);
    assert_null(ct_equilibrium_create(ctx, sys, NULL));
    assert_int_equal(ct_ctx_fault(ctx), CT_FAULT_MODEL);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

// The static deflection q L^4/(8 EI) + P L^3/(3 EI), which cubic elements have at their nodes
// exactly.
static void a_beam_starts_in_its_static_shape(void **state)
{
    (void)state;
    static const char text[]
        = "cotree: 1\n"
          "gravity: [0, -9.81, 0]\n"
          "bodies:\n"
          "  beam: {type: beam, length: 2, elements: 3, density: 1000, E: 1e9, nu: 0.3, area: "
          "0.01, Iz: 1e-5,\n"
          "    deformation: [bending-z], initial: equilibrium, points: {tip: length}}\n"
          "  ball: {mass: 3}\n"
          "joints:\n"
          "  hinge: {type: revolute, from: ground, to: beam, motion: 0.4*sin(t)}\n"
          "  socket: {type: weld, from: beam.tip, to: ball}\n"
          "outputs: [beam.tip.deflection.y, hinge.q]\n"
          "simulation: {duration: 1, samples: 2}\n";
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = load_with(ctx, text, NULL);
    struct ct_sim *sim = checked(ctx, ct_sim_create(ctx, sys, NULL));
    const double EI = 1e4, weight = 98.1, end = 3 * 9.81;
    CHECK_CLOSE(ct_sim_value(sim, "beam.tip.deflection.y"),
                -(weight * 16 / 8 + end * 8 / 3) / EI, 1e-12, 0);
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

// ---- buckling -----------------------------------------------------------------------------------

static void check_buckling(const char *text, const char *load, const double *want, size_t n)
{
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = load_with(ctx, text, NULL);
    struct ct_buckling *s = checked(
        ctx, ct_buckling_create(ctx, sys, &(struct ct_buckling_options){.load = load}));
    assert_int_equal(ct_buckling_count(s), n);
    for (size_t i = 0; i < n; i++)
        CHECK_CLOSE(ct_buckling_factor(s, i), want[i], 1e-12, 0);
    assert_true(isnan(ct_buckling_factor(s, n)));
    ct_buckling_destroy(s);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

static void one_link_buckles_at_k_over_l(void **state)
{
    (void)state;
    check_buckling("cotree: 1\n"
                   "bodies: {link: {mass: 1, inertia: 1, points: {tip: [0, 2, 0]}}}\n"
                   "joints: {foot: {type: revolute, from: ground, to: link, stiffness: 100}}\n"
                   "forces: {push: {type: force, at: link.tip, value: [0, -1, 0]}}\n",
                   "push", (const double[]){50}, 1);
}

static void two_links_buckle_twice(void **state)
{
    (void)state;
    // K = k [2 -1; -1 1] - P L 1 in absolute angles
    check_buckling("cotree: 1\n"
                   "bodies:\n"
                   "  a: {mass: 1, inertia: 1, points: {tip: [0, 2, 0]}}\n"
                   "  b: {mass: 1, inertia: 1, points: {tip: [0, 2, 0]}}\n"
                   "joints:\n"
                   "  foot: {type: revolute, from: ground, to: a, stiffness: 100}\n"
                   "  knee: {type: revolute, from: a.tip, to: b, stiffness: 100}\n"
                   "forces: {push: {type: force, at: b.tip, value: [0, -1, 0]}}\n",
                   "push", (const double[]){50 * (3 - sqrt(5)) / 2, 50 * (3 + sqrt(5)) / 2}, 2);
}

static void a_mast_buckles_under_its_weight(void **state)
{
    (void)state;
    check_buckling("cotree: 1\n"
                   "gravity: [0, -10, 0]\n"
                   "bodies: {mast: {mass: 3, inertia: 1, com: [0, 2, 0]}}\n"
                   "joints: {foot: {type: revolute, from: ground, to: mast, stiffness: 90}}\n",
                   "gravity", (const double[]){1.5}, 1);
}

static void a_shallow_strut_snaps_through(void **state)
{
    (void)state;
    // one inclined spring, a = 1, y = 0.5 free: P = k (l0/l - 1) y is largest where l^3 = l0 a^2
    const double l0 = sqrt(1.25), l = cbrt(l0), y = sqrt(l * l - 1);
    check_buckling("cotree: 1\n"
                   "bodies: {ground: {points: {support: [1, 0, 0]}}, head: {mass: 1}}\n"
                   "joints: {guide: {type: prismatic, from: ground, to: head, axis: y,\n"
                   "  initial: {q: 0.5}}}\n"
                   "forces:\n"
                   "  strut: {type: spring, from: ground.support, to: head, stiffness: 1000,\n"
                   "    length: sqrt(1.25)}\n"
                   "  push: {type: force, at: head, value: [0, -1, 0]}\n",
                   "push", (const double[]){1000 * (l0 / l - 1) * y}, 1);
}

static void a_following_load_does_not_buckle_two_links(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys
        = load_with(ctx,
                    "cotree: 1\n"
                    "bodies:\n"
                    "  a: {mass: 1, inertia: 1, points: {tip: [0, 1, 0]}}\n"
                    "  b: {mass: 1, inertia: 1, points: {tip: [0, 1, 0]}}\n"
                    "joints:\n"
                    "  foot: {type: revolute, from: ground, to: a, stiffness: 100}\n"
                    "  knee: {type: revolute, from: a.tip, to: b, stiffness: 100}\n"
                    "forces: {push: {type: force, at: b.tip, value: [0, -1, 0], in: b}}\n",
                    NULL);
    assert_null(ct_buckling_create(ctx, sys, &(struct ct_buckling_options){.load = "push"}));
    assert_null(ct_buckling_create(ctx, sys, &(struct ct_buckling_options){.load = "pull"}));
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

// ---- linear models ------------------------------------------------------------------------------

// A four-bar with a weight and springs, at its equilibrium; a torque on one of its bars swings it a
// little.
static const char swinging[]
    = "cotree: 1\n"
      "gravity: [0, -9.81, 0]\n"
      "parameters: {start: 1, size: 0}\n"
      "bodies:\n"
      "  ground: {points: {right: [0.5, 0, 0]}}\n"
      "  crank: {mass: 1, inertia: 0.01, com: [0.1, 0, 0], points: {pin: [0.2, 0, 0]}}\n"
      "  coupler: {mass: 2, inertia: 0.05, com: [0.25, 0.05, 0], points: {pin: [0.5, 0, 0]}}\n"
      "  rocker: {mass: 1.5, inertia: 0.03, com: [0.2, 0, 0], points: {pin: [0.4, 0, 0]}}\n"
      "joints:\n"
      "  a: {type: revolute, from: ground, to: crank, stiffness: 20, rest: 1, damping: 0.05,\n"
      "    initial: {q: start, u: 0}, effort: \"size*sin(3*t)\"}\n"
      "  b: {type: revolute, from: crank.pin, to: coupler, initial: {q: -1, guess: true}}\n"
      "  c: {type: revolute, from: coupler.pin, to: rocker.pin, stiffness: 4,\n"
      "    initial: {q: 1, guess: true}}\n"
      "  d: {type: revolute, from: ground.right, to: rocker, initial: {q: 1.2, guess: true}}\n"
      "outputs: [a.q, d.u, coupler.com.y, d.force.x, a.a, d.force.y]\n"
      "simulation: {duration: 2, samples: 201, tolerance: 1e-11}\n";

enum { OUTPUTS = 6 };

struct comparison {
    const double *A, *B, *C, *D, *y0;
    size_t n;
    double x[8], worst[OUTPUTS], largest[OUTPUTS], size;
    double t;
};

static void rates(const struct comparison *s, double t, const double *x, double *dx)
{
    for (size_t i = 0; i < s->n; i++) {
        dx[i] = s->B[i] * s->size * sin(3 * t);
        for (size_t k = 0; k < s->n; k++)
            dx[i] += s->A[i + s->n * k] * x[k];
    }
}

static void rk4_step(struct comparison *s, double t, double h)
{
    double k[4][8], x[8];
    static const double node[4] = {0, 0.5, 0.5, 1},
                        weight[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
    for (int j = 0; j < 4; j++) {
        for (size_t i = 0; i < s->n; i++)
            x[i] = s->x[i] + (j ? h * node[j] * k[j - 1][i] : 0);
        rates(s, t + node[j] * h, x, k[j]);
    }
    for (int j = 0; j < 4; j++)
        for (size_t i = 0; i < s->n; i++)
            s->x[i] += h * weight[j] * k[j][i];
}

// A sample of the nonlinear run against the linear model, integrated up to there.
static bool compare(void *user, double t, const double *value, size_t n)
{
    struct comparison *s = user;
    assert_int_equal(n, OUTPUTS);
    for (int i = 0; t > 0 && i < 20; i++)
        rk4_step(s, s->t + i * (t - s->t) / 20, (t - s->t) / 20);
    s->t = t;
    for (size_t i = 0; i < n; i++) {
        double y = s->D[i] * s->size * sin(3 * t);
        for (size_t k = 0; k < s->n; k++)
            y += s->C[i + n * k] * s->x[k];
        s->worst[i] = fmax(s->worst[i], fabs(value[i] - s->y0[i] - y));
        s->largest[i] = fmax(s->largest[i], fabs(y));
    }
    return true;
}

static void the_linear_model_moves_as_the_system_does(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = load_with(ctx, swinging, NULL);
    struct ct_equilibrium *q = find_equilibrium(ctx, sys);
    char start[64];
    snprintf(start, sizeof start, "start=%.17g", ct_equilibrium_value(q, "a.q"));
    ct_equilibrium_destroy(q);
    ct_system_destroy(sys);
    // the difference is of second order: a thousandth of the motion for a thousandth of a radian
    static const char *const trees[] = {"auto", "joints", "absolute"};
    for (size_t i = 0; i < 3; i++) {
        const char *const set[] = {start, "size=1e-3"};
        sys = load_with(ctx, swinging,
                        &(struct ct_system_options){.set = set, .nset = 2, .tree = trees[i]});
        struct ct_linearization *l = checked(ctx, ct_linearize(ctx, sys, NULL));
        size_t rows, columns;
        struct comparison s = {.size = 1e-3};
        s.A = ct_linearization_matrix(l, 'A', &s.n, &columns);
        s.B = ct_linearization_matrix(l, 'B', &rows, &columns);
        s.C = ct_linearization_matrix(l, 'C', &rows, &columns);
        s.D = ct_linearization_matrix(l, 'D', &rows, &columns);
        s.y0 = ct_linearization_matrix(l, 'y', &rows, &columns);
        assert_int_equal(s.n, 2);
        assert_string_equal(ct_linearization_name(l, 'u', 0), "a.effort");
        assert_string_equal(ct_linearization_name(l, 'y', 1), "d.u");
        assert_null(ct_linearization_name(l, 'u', 1));
        struct ct_sim *sim = checked(ctx, ct_sim_create(ctx, sys, NULL));
        assert_true(ct_sim_run(ctx, sim, &(struct ct_sim_results){.row = compare, .user = &s}));
        for (int k = 0; k < OUTPUTS; k++) {
            assert_true(s.largest[k] > 1e-6);
            CHECK_CLOSE(s.worst[k], 0, 0, 2e-3 * s.largest[k]);
        }
        ct_sim_destroy(sim);
        ct_linearization_destroy(l);
        ct_system_destroy(sys);
    }
    ct_ctx_destroy(ctx);
}

static unsigned long number(const unsigned char *b, int size)
{
    unsigned long v = 0;
    for (int i = size; i-- > 0;)
        v = v << 8 | b[i];
    return v;
}

// What is compressed (RFC 1951) behind a local header.
static size_t inflate_all(const unsigned char *packed, size_t n, unsigned char *to, size_t room)
{
    z_stream z = {.next_in = (Bytef *)(uintptr_t)packed, .avail_in = (uInt)n};
    z.next_out = to;
    z.avail_out = (uInt)room;
    assert_int_equal(inflateInit2(&z, -15), Z_OK);
    assert_int_equal(inflate(&z, Z_FINISH), Z_STREAM_END);
    inflateEnd(&z);
    return room - z.avail_out;
}

// The file as its two formats describe it, read by hand.
static void npz_holds_the_matrices(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = load_with(ctx, swinging, NULL);
    struct ct_linearization *l = checked(
        ctx, ct_linearize(ctx, sys,
                          &(struct ct_linearize_options){.about = "equilibrium",
                                                         .inputs = "a.effort,size,d.effort"}));
    snprintf(table, sizeof table, "%s/table.npz", folder);
    assert_true(ct_linearization_write(ctx, l, table));
    static unsigned char all[65536];
    FILE *f = fopen(table, "rb");
    const size_t n = fread(all, 1, sizeof all, f);
    fclose(f);
    remove(table);
    snprintf(table, sizeof table, "%s/table.csv", folder);
    const unsigned char *end = all + n - 22;
    assert_int_equal(number(end, 4), 0x06054b50);
    const unsigned char *entry = all + number(end + 16, 4);
    assert_int_equal(number(end + 10, 2), 10);
    entry += 46 + number(entry + 28, 2); // A, then B
    assert_int_equal(number(entry, 4), 0x02014b50);
    assert_memory_equal(entry + 46, "B.npy", 5);
    const unsigned char *local = all + number(entry + 42, 4);
    assert_int_equal(number(local, 4), 0x04034b50);
    static unsigned char npy[65536];
    assert_int_equal(number(local + 8, 2), 8);
    const size_t size = inflate_all(local + 30 + number(local + 26, 2), number(local + 18, 4),
                                    npy, sizeof npy);
    assert_int_equal(number(local + 14, 4), crc32(0, npy, (uInt)size));
    assert_memory_equal(npy, "\x93NUMPY\1\0", 8);
    const unsigned char *data = npy + 10 + number(npy + 8, 2);
    assert_int_equal((data - npy) % 64, 0);
    assert_memory_equal(npy + 10, "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }",
                        58);
    assert_int_equal(number(entry + 24, 4), (unsigned long)(data - npy) + 48);
    assert_int_equal(size, number(entry + 24, 4));
    size_t rows, columns;
    const double *B = ct_linearization_matrix(l, 'B', &rows, &columns);
    double read[6];
    memcpy(read, data, sizeof read);
    assert_int_equal(rows * columns, 6);
    for (int i = 0; i < 6; i++)
        assert_true(read[i] == B[i]);
    assert_true(B[1] != 0 && B[3] == 0 && B[5] != 0); // sin(0) multiplies the parameter
    ct_linearization_destroy(l);
    assert_null(ct_linearize(ctx, sys, &(struct ct_linearize_options){.inputs = "a.efort"}));
    assert_null(ct_linearize(ctx, sys, &(struct ct_linearize_options){.inputs = ""}));
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

// Version 4: five integers, the name, the numbers by columns.
static void mat_holds_the_matrices(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = load_with(ctx, swinging, NULL);
    struct ct_linearization *l
        = checked(ctx, ct_linearize(ctx, sys, &(struct ct_linearize_options){0}));
    snprintf(table, sizeof table, "%s/table.mat", folder);
    assert_true(ct_linearization_write(ctx, l, table));
    static unsigned char all[65536];
    FILE *f = fopen(table, "rb");
    const size_t n = fread(all, 1, sizeof all, f);
    fclose(f);
    remove(table);
    snprintf(table, sizeof table, "%s/table.csv", folder);
    static const char *const names[]
        = {"A", "B", "C", "D", "x0", "xdot0", "y0", "states", "inputs", "outputs"};
    const unsigned char *at = all;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const bool is_text = i >= 7;
        const unsigned long rows = number(at + 4, 4), columns = number(at + 8, 4);
        assert_int_equal(number(at, 4), is_text);
        assert_int_equal(number(at + 12, 4), 0);
        assert_int_equal(number(at + 16, 4), strlen(names[i]) + 1);
        assert_string_equal((const char *)at + 20, names[i]);
        at += 20 + strlen(names[i]) + 1;
        if (i < 4) {
            size_t n_rows, n_columns;
            const double *M = ct_linearization_matrix(l, names[i][0], &n_rows, &n_columns);
            assert_int_equal(rows, n_rows);
            assert_int_equal(columns, n_columns);
            assert_memory_equal(at, M, rows * columns * sizeof *M);
        } else if (is_text && rows) { // the first letter of the first name
            double letter;
            memcpy(&letter, at, sizeof letter);
            assert_true(letter >= 'a' && letter <= 'z');
        }
        at += rows * columns * sizeof(double);
    }
    assert_int_equal(at - all, n);
    ct_linearization_destroy(l);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

// ---- driven motions -----------------------------------------------------------------------------

// How the crank is moved comes last.
#define CRANK_AND_SLIDER(main)                                                                 \
    "cotree: 1\n"                                                                              \
    "gravity: [0, -9.81, 0]\n"                                                                 \
    "simulation: {duration: 1.5, samples: 3001, tolerance: 1e-10}\n"                           \
    "outputs: [main.q, main.u, guide.q, energy.total]\n"                                       \
    "bodies:\n"                                                                                \
    "  crank: {mass: 0.4, inertia: 1e-3, com: [0.08, 0, 0], points: {pin: [0.15, 0, 0]}}\n"    \
    "  rod: {mass: 0.7, inertia: 5e-3, com: [0.15, 0, 0], points: {pin: [0.3, 0, 0]}}\n"       \
    "  slider: {mass: 0.5}\n"                                                                  \
    "joints:\n"                                                                                \
    "  big_end: {type: revolute, from: crank.pin, to: rod,\n"                                  \
    "    initial: {q: -1.15, guess: true}}\n"                                                  \
    "  small_end: {type: revolute, from: rod.pin, to: slider,\n"                               \
    "    initial: {q: 0.35, guess: true}}\n"                                                   \
    "  guide: {type: prismatic, from: ground, to: slider, axis: x, damping: 3,\n"              \
    "    initial: {q: 0.4, guess: true}}\n"                                                    \
    "  main: {type: revolute, from: ground, to: crank, " main "}\n"

static double last_value(struct ct_ctx *ctx, const char *text, bool is_driven, const char *file,
                         const char *column)
{
    struct ct_system *sys
        = load_with(ctx, text, &(struct ct_system_options){.columns = CT_COLUMNS_EFFORTS});
    struct ct_sim *sim = checked(ctx, ct_sim_create(ctx, sys, NULL));
    const struct ct_sim_results results = {.path = file};
    if (!(is_driven ? ct_sim_follow : ct_sim_run)(ctx, sim, &results)) {
        ct_ctx_print_diagnostics(ctx, stderr);
        fail();
    }
    const double value = ct_sim_value(sim, column);
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    return value;
}

static void efforts_of_inverse_give_the_motion_back(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    const char *driven = CRANK_AND_SLIDER("motion: \"0.7 + 4*t + 2*sin(3*t)\"");
    const double angle = 0.7 + 6 + 2 * sin(4.5);
    const double place = last_value(ctx, driven, true, table, "guide.q");
    CHECK_CLOSE(place, 0.15 * cos(angle) + sqrt(0.09 - pow(0.15 * sin(angle), 2)), 1e-13, 0);
    // with the cubic through samples 0.5 ms apart the effort is known to 1e-10
    const char *pushed
        = CRANK_AND_SLIDER("initial: {q: 0.7, u: 10},\n    effort: {table: table.csv, "
                           "column: main.effort, interpolate: cubic}");
    CHECK_CLOSE(last_value(ctx, pushed, false, NULL, "main.q"), angle, 0, 1e-7);
    CHECK_CLOSE(last_value(ctx, pushed, false, NULL, "guide.q"), place, 0, 1e-7);
    ct_ctx_destroy(ctx);
}

static void driven_motions_are_those_of_a_run(void **state)
{
    (void)state;
    // rates jump at 0.5 s: places do not, and the work of the impulse is booked
    struct ct_ctx *ctx = ct_ctx_create();
    const char *driven
        = CRANK_AND_SLIDER("motion: \"if(t < 0.5, 0.7 + 4*t, 2.7 + 9*(t-0.5))\"");
    static const char *const columns[] = {"main.q",      "guide.q",       "energy.total",
                                          "main.effort", "guide.force.y", "small_end.force.x"};
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
        const double followed = last_value(ctx, driven, true, NULL, columns[i]);
        CHECK_CLOSE(last_value(ctx, driven, false, NULL, columns[i]), followed, 1e-8, 1e-9);
    }
    ct_ctx_destroy(ctx);
}

static void a_freedom_without_a_motion_is_named(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = load_with(ctx, two_rods, NULL);
    struct ct_sim *sim
        = checked(ctx, ct_sim_create(ctx, sys, &(struct ct_sim_options){.until = 1}));
    assert_false(ct_sim_follow(ctx, sim, NULL));
    assert_int_equal(ct_ctx_fault(ctx), CT_FAULT_MODEL);
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_masses_between_walls),
        cmocka_unit_test(a_free_cart_with_a_damper),
        cmocka_unit_test(an_upright_pendulum_grows_and_decays),
        cmocka_unit_test(a_massless_coordinate_follows_its_springs),
        cmocka_unit_test(a_massless_coordinate_with_a_damper_creeps),
        cmocka_unit_test(a_coordinate_without_mass_and_stiffness_is_no_mode),
        cmocka_unit_test(a_pendulum_on_a_turning_shaft),
        cmocka_unit_test(a_sleeping_top_seen_from_the_top),
        cmocka_unit_test(a_motion_is_linearised_at_a_time),
        cmocka_unit_test(shapes_have_names),
        cmocka_unit_test(a_turning_beam_stiffens_by_southwell),
        cmocka_unit_test(rows_of_many_masses),
        cmocka_unit_test(pendulums_find_their_lower_equilibrium),
        cmocka_unit_test(an_unstable_equilibrium_is_one),
        cmocka_unit_test(what_nothing_holds_is_named),
        cmocka_unit_test(a_beam_starts_in_its_static_shape),
        cmocka_unit_test(one_link_buckles_at_k_over_l),
        cmocka_unit_test(two_links_buckle_twice),
        cmocka_unit_test(a_mast_buckles_under_its_weight),
        cmocka_unit_test(a_shallow_strut_snaps_through),
        cmocka_unit_test(a_following_load_does_not_buckle_two_links),
        cmocka_unit_test(the_linear_model_moves_as_the_system_does),
        cmocka_unit_test(npz_holds_the_matrices),
        cmocka_unit_test(mat_holds_the_matrices),
        cmocka_unit_test(efforts_of_inverse_give_the_motion_back),
        cmocka_unit_test(driven_motions_are_those_of_a_run),
        cmocka_unit_test(a_freedom_without_a_motion_is_named),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
