// Events, drivers on chords and jumps of their rates.
#include "tests/property/mechanism.h"
#include "tests/property/system.h"

struct rows {
    double *value;
    size_t n, most;
};

static bool at_row(void *user, double t, const double *value, size_t n)
{
    struct rows *r = user;
    (void)t;
    assert_true(r->n < r->most);
    memcpy(r->value + r->n++ * n, value, n * sizeof *value);
    return true;
}

// Rows of a run, sample by sample; false (with diagnostics in v->ctx) if it fails.
static bool run(struct system *s, struct variant *v, double duration, size_t nsample,
                double **value)
{
    struct rows r = {CT_NEWN(v->arena, double, nsample * v->e.nresult + 1), 0, nsample};
    struct ct_run_report report;
    const struct ct_run_options o = {.method = ct_method_find("dop853"),
                                     .duration = duration,
                                     .rtol = 1e-11,
                                     .atol = 1e-13,
                                     .nsample = nsample,
                                     .rate_jumps = s->model.simulation.rate_jumps,
                                     .row = at_row,
                                     .user = &r};
    struct ct_run *run = ct_run_create(&v->ctx, v->arena, &s->model, &v->e, &s->start);
    *value = r.value;
    return run && ct_run_simulate(run, &o, &report);
}

// Last row of a model's run on the given trees.
static double *last_row(struct system *s, struct variant *v,
                        const struct ct_formulate_options *o, double duration)
{
    double *value;
    variant_open(s, o, v);
    if (!run(s, v, duration, 2, &value)) {
        print_error("%s: no run\n", s->name);
        ct_ctx_print(&v->ctx, stderr);
        fail();
    }
    return value + v->e.nresult;
}

static void expect_end(const char *name, const char *text, double duration, const double *want,
                       size_t n, double tolerance)
{
    static const struct ct_formulate_options *const how[]
        = {&by_joints, &by_bodies, &by_choice};
    for (size_t i = 0; i < COUNT(how); i++) {
        struct system s;
        struct variant v;
        bool ok = true;
        system_open_text(&s, name, text);
        const double *got = last_row(&s, &v, how[i], duration);
        assert_int_equal(v.e.nresult, n);
        for (size_t k = 0; k < n; k++)
            ok &= agree(name, text_of(v.arena, "%s, trees %zu", v.e.result[k].name, i), got[k],
                        want[k], 1 + fabs(want[k]), tolerance);
        variant_close(&v);
        system_close(&s);
        assert_true(ok);
    }
}

// ---- comparisons --------------------------------------------------------------------------------

#define SLIDE(effort, initial)                                                                 \
    "cotree: 1\nbodies: {a: {mass: 2, inertia: 1}}\n"                                          \
    "joints: {s: {type: prismatic, from: ground, to: a, effort: \"" effort                     \
    "\", initial: {" initial "}}}\n"                                                           \
    "outputs: [s.q, s.u]\n"

static void forces_switch_where_they_should(void **state)
{
    (void)state;
    const double pi = 3.14159265358979323846, tolerance = 1e-9;
    const struct {
        const char *name, *text;
        double duration, q, u;
    } c[] = {
        // 2 N for a second, then -1 N for another
        {"time", SLIDE("if(t < 1, 2, -1)", "q: 0, u: 0"), 2, 1.25, 0.5},
        // a wall of 8 N/m beyond 1 m, met at 1 m/s: it takes half a period, omega = 2
        {"wall", SLIDE("if(s.q > 1, -8*(s.q - 1), 0)", "q: 0, u: 1"), 3, pi / 2 - 1, -1},
        {"friction", SLIDE("-sign(s.u)", "q: 0, u: 4"), 4, 12, 2},
        {"abs", SLIDE("abs(t - 1)", "q: 0, u: 0"), 2, 0.5, 0.5},
        {"max", SLIDE("max(0, t - 1)", "q: 0, u: 0"), 2, 1.0 / 12, 0.25},
        {"min", SLIDE("min(t, 1)", "q: 0, u: 0"), 2, 7.0 / 12, 0.75},
        // a comparison within a comparison: 2 N in the first second, then until 1.5 s 4 N, then
        // none
        {"nested", SLIDE("if(t < 1, 2, if(t < 1.5, 4, 0))", "q: 0, u: 0"), 2,
         0.5 + 0.5 + 0.25 + 1, 2},
    };
    for (size_t i = 0; i < COUNT(c); i++)
        expect_end(c[i].name, c[i].text, c[i].duration, (double[]){c[i].q, c[i].u}, 2,
                   tolerance);
}

// ---- jumps of driven rates ----------------------------------------------------------------------

// Two bars on a plane, the first one driven: m = 1, c = 0.4 beyond l = 0.5, J = 0.1.
#define BARS(motion, more)                                                                     \
    "cotree: 1\nbodies:\n  a: {mass: 2, inertia: 0.3, com: [0.2, 0, 0], points: {end: [0.5, "  \
    "0, 0]}}\n"                                                                                \
    "  b: {mass: 1, inertia: 0.1, com: [0.4, 0, 0]}\n"                                         \
    "joints:\n  x: {type: revolute, from: ground, to: a, motion: " motion "}\n"                \
    "  y: {type: revolute, from: a.end, to: b}\n" more                                         \
    "outputs: [y.u, energy.work, energy.total]\n"

// Momentum along y stays: (J + m c^2)(u_x + u_y) + m l c u_x = 0.
static void a_jump_of_a_driven_rate_is_an_impulse(void **state)
{
    (void)state;
    const double J = 0.1 + 0.16, u = 2, uy = -(1 + 0.2 / J) * u;
    const double va = 0.4, vb = 0.5 * u + 0.4 * (u + uy), wb = u + uy;
    const double T = 0.5 * (2 * va * va + 0.3 * u * u + vb * vb + 0.1 * wb * wb);
    expect_end("jump", BARS("\"if(t < 1, 0, 2*(t - 1))\"", ""), 1, (double[]){uy, T, 0}, 3,
               1e-9);
}

// Speeds that keep their values, on trees through joints: y stands still relative to a.
static void a_continuous_jump_leaves_the_other_speeds(void **state)
{
    (void)state;
    const double u = 2, va = 0.4;
    const double vb0 = 0.9 * u,
                 T0 = 0.5 * (2 * va * va + 0.3 * u * u + vb0 * vb0 + 0.1 * u * u);
    struct system s;
    struct variant v;
    system_open_text(
        &s, "continuous",
        BARS("\"if(t < 1, 0, 2*(t - 1))\"", "simulation: {rate_jumps: continuous}\n"));
    const double *got = last_row(&s, &v, &by_joints, 1);
    const bool ok = agree("continuous", "y.u", got[0], 0, 1, 1e-9)
                  & agree("continuous", "energy.work", got[1], T0, 1, 1e-9)
                  & agree("continuous", "energy.total", got[2], 0, 1, 1e-9);
    variant_close(&v);
    system_close(&s);
    assert_true(ok);
}

static void short_ramps_come_to_the_impulse(void **state)
{
    (void)state;
    const double uy = -(1 + 0.2 / 0.26) * 2;
    double error[2];
    for (int k = 0; k < 2; k++) {
        // the rate grows to 2 within h: q = (t - 1)^2/h, then 2 (t - 1) - h
        const double h = k ? 1e-4 : 1e-3;
        struct ct_arena *a = ct_arena_create();
        struct system s;
        struct variant v;
        const char *text = text_of(
            a,
            BARS("\"if(t < 1, 0, if(t < 1 + %.17g, (t - 1)^2/%.17g, 2*(t - 1) - %.17g))\"", ""),
            h, h, h);
        system_open_text(&s, "ramp", text);
        error[k] = fabs(last_row(&s, &v, &by_bodies, 1 + h)[0] - uy);
        variant_close(&v);
        system_close(&s);
        ct_arena_destroy(a);
    }
    print_message("ramps of 1e-3 and 1e-4 s: off by %.3g and %.3g\n", error[0], error[1]);
    assert_true(error[0] < 1e-2 && error[1] < error[0] / 5);
}

static void a_jump_of_a_place_is_an_error(void **state)
{
    (void)state;
    static const struct ct_formulate_options *const how[]
        = {&by_joints, &by_bodies, &by_choice};
    for (size_t i = 0; i < COUNT(how); i++) {
        struct system s;
        struct variant v;
        double *value;
        system_open_text(&s, "place", BARS("\"if(t < 1, 0, 0.1)\"", ""));
        variant_open(&s, how[i], &v);
        assert_false(run(&s, &v, 2, 3, &value));
        assert_true(v.ctx.ndiagnostic > 0);
        if (v.ctx.diagnostic[0].code != CT_E_DRIVER_JUMP)
            ct_ctx_print(&v.ctx, stderr);
        assert_int_equal(v.ctx.diagnostic[0].code, CT_E_DRIVER_JUMP);
        variant_close(&v);
        system_close(&s);
    }
}

// Knots of a linear table are jumps of the rate, too.
static void a_knot_of_a_linear_table_is_an_impulse(void **state)
{
    (void)state;
    char folder[] = "/tmp/cotree-property-XXXXXX";
    assert_non_null(mkdtemp(folder));
    struct ct_arena *a = ct_arena_create();
    const char *table = text_of(a, "%s/drive.csv", folder);
    FILE *f = fopen(table, "w");
    assert_non_null(f);
    fputs("t,q\n0,0\n1,0\n3,4\n", f);
    fclose(f);
    const double uy = -(1 + 0.2 / 0.26) * 2;
    static const struct ct_formulate_options *const how[] = {&by_joints, &by_bodies};
    bool ok = true;
    for (size_t i = 0; i < COUNT(how); i++) {
        struct system s;
        struct variant v;
        system_open_text(&s, text_of(a, "%s/model.yaml", folder),
                         BARS("{table: drive.csv, column: q, interpolate: linear}", ""));
        const double *got = last_row(&s, &v, how[i], 1);
        ok &= agree("table", "y.u", got[0], uy, 1, 1e-9);
        ok &= agree("table", "energy.total", got[2], 0, 1, 1e-9);
        variant_close(&v);
        system_close(&s);
    }
    remove(table);
    remove(folder);
    ct_arena_destroy(a);
    assert_true(ok);
}

// A four-bar whose driver sits on the chord of the trees through joints or not: same jump.
static void jumps_in_loops_do_not_depend_on_the_trees(void **state)
{
    (void)state;
    static const char text[]
        = "cotree: 1\ngravity: [0, -9.81, 0]\nbodies:\n  ground: {points: {far: [0.5, 0, 0]}}\n"
          "  a: {mass: 1, inertia: 0.01, com: [0.1, 0, 0], points: {end: [0.2, 0, 0]}}\n"
          "  b: {mass: 2, inertia: 0.04, com: [0.25, 0, 0], points: {end: [0.5, 0, 0]}}\n"
          "  c: {mass: 1, inertia: 0.02, com: [0.2, 0, 0], points: {end: [0.4, 0, 0]}}\n"
          "  d: {mass: 0.5, inertia: 0.01, com: [0.1, 0.1, 0]}\n"
          "joints:\n"
          "  crank: {type: revolute, from: ground, to: a, motion: \"if(t < 0.1, 1 + t, 1.1 + "
          "3*(t - 0.1))\"}\n"
          "  coupler: {type: revolute, from: a.end, to: b, initial: {q: -1, guess: true}}\n"
          "  rocker: {type: revolute, from: ground.far, to: c, initial: {q: 1.6, guess: "
          "true}}\n"
          "  top: {type: revolute, from: b.end, to: c.end, initial: {q: 1.2, guess: true}}\n"
          "  tail: {type: revolute, from: b, to: d, initial: {q: 0.3, u: 1}}\n"
          "outputs: [crank.u, coupler.u, rocker.u, tail.u, energy.total, energy.work, tail.q, "
          "crank.effort]\n";
    double first[8];
    struct system s;
    struct variant v;
    system_open_text(&s, "loop", text);
    memcpy(first, last_row(&s, &v, &by_joints, 0.3), sizeof first);
    variant_close(&v);
    system_close(&s);
    assert_true(agree("loop", "crank.u", first[0], 3, 1, 1e-9));
    expect_end("loop", text, 0.3, first, 8, 1e-8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_switch_where_they_should),
        cmocka_unit_test(a_jump_of_a_driven_rate_is_an_impulse),
        cmocka_unit_test(a_continuous_jump_leaves_the_other_speeds),
        cmocka_unit_test(short_ramps_come_to_the_impulse),
        cmocka_unit_test(a_jump_of_a_place_is_an_error),
        cmocka_unit_test(a_knot_of_a_linear_table_is_an_impulse),
        cmocka_unit_test(jumps_in_loops_do_not_depend_on_the_trees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
