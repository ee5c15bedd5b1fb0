// States that are stepped, set and asked; diagnostics one by one; systems shared among threads;
// what callers may do wrong.
#include <cotree/cotree.h>

#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char arm[]
    = "cotree: 1\n"
      "gravity: [0, -g, 0]\n"
      "parameters: {m: 2, l: 1, g: 9.81, Iz: m*l^2/12}\n"
      "inputs:\n"
      "  tau: {value: 0, unit: N*m}\n"
      "bodies:\n"
      "  link: {mass: m, com: [l/2, 0, 0], inertia: [0.01, Iz, Iz], points: {tip: [l, 0, 0]}}\n"
      "joints:\n"
      "  pivot: {type: revolute, from: ground, to: link, effort: tau, initial: {q: 1, u: 0}}\n"
      "outputs: [pivot.q, energy.total]\n"
      "simulation: {duration: 1, samples: 11, tolerance: 1e-9}\n";

static struct ct_ctx *ctx;
static struct ct_system *sys;

static int load(void **state)
{
    (void)state;
    ctx = ct_ctx_create();
    sys = ct_system_load_text(ctx, arm, strlen(arm), "arm.yaml", NULL);
    return !sys;
}

static int unload(void **state)
{
    (void)state;
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
    return 0;
}

static struct ct_system *load_shipped(const char *name)
{
    char path[1024];
    const char *tests = getenv("CT_TEST_DIR");
    snprintf(path, sizeof path, "%s/../systems/%s/model.yaml", tests ? tests : "tests", name);
    struct ct_system *s = ct_system_load(ctx, path, NULL);
    assert_non_null(s);
    return s;
}

static int code_of_last(void)
{
    struct ct_diagnostic d;
    assert_true(ct_ctx_count(ctx) > 0);
    assert_true(ct_ctx_diagnostic(ctx, ct_ctx_count(ctx) - 1, &d));
    ct_ctx_clear(ctx);
    return d.code;
}

#define CLOSE(got, want, tolerance) assert_true(fabs((got) - (want)) <= (tolerance))

// ---- names --------------------------------------------------------------------------------------

static void names_have_values_units_and_places(void **state)
{
    (void)state;
    struct ct_item item;
    assert_int_equal(ct_system_count(sys, CT_PARAMETER), 4);
    assert_int_equal(ct_system_count(sys, CT_INPUT), 1);
    assert_int_equal(ct_system_count(sys, CT_STATE), 0);
    assert_int_equal(ct_system_count(sys, CT_COMPONENT), 2);
    assert_true(ct_system_item(sys, CT_INPUT, 0, &item));
    assert_string_equal(item.name, "tau");
    assert_string_equal(item.unit, "N*m");
    assert_true(item.value == 0 && item.line == 5);
    assert_true(ct_system_item(sys, CT_COORDINATE, 0, &item));
    assert_string_equal(item.name, "pivot.q");
    assert_string_equal(item.unit, "rad");
    assert_true(item.value == 1);
    assert_true(ct_system_find(sys, CT_FRAME, "link.tip") > 0);
    assert_int_equal(ct_system_find(sys, CT_FRAME, "tip"), -1);
    assert_int_equal(ct_system_find(sys, CT_OUTPUT, "energy.total"), 1);
    assert_false(ct_system_item(sys, CT_INPUT, 1, &item));
}

// ---- steps --------------------------------------------------------------------------------------

// At every output of a system, to within ten times the tolerance of its largest value or one.
static void compare_with_run(const char *name, const char *method, int n)
{
    struct ct_system *s = load_shipped(name);
    const struct ct_sim_options o = {.method = method, .tolerance = 1e-8};
    struct ct_sim_options until = o;
    until.until = n * 0x1p-9;
    until.samples = 2;
    struct ct_sim *sim = ct_sim_create(ctx, s, &until);
    struct ct_data *d = ct_data_create(ctx, s, &o);
    assert_non_null(d);
    assert_true(ct_sim_run(ctx, sim, NULL));
    for (int i = 0; i < n; i++)
        assert_true(ct_data_step(ctx, d, 0x1p-9));
    assert_true(ct_data_time(d) == n * 0x1p-9);
    for (size_t i = 0; i < ct_system_count(s, CT_OUTPUT); i++) {
        const double want = ct_sim_value(sim, ct_system_column(s, i));
        CLOSE(ct_data_value(d, CT_OUTPUT, i), want, 1e-7 * fmax(1, fabs(want)));
    }
    ct_data_destroy(d);
    ct_sim_destroy(sim);
    ct_system_destroy(s);
}

static void steps_lead_where_a_run_leads(void **state)
{
    (void)state;
    compare_with_run("double_pendulum", NULL, 200);
    compare_with_run("slider_crank", NULL, 300);
    compare_with_run("four_bar", NULL, 300);
    compare_with_run("puma560", "radau5", 20);
    compare_with_run("heavy_top", NULL, 100);
}

// A switch by time and one by state, in steps that meet neither.
static void events_are_on_the_way(void **state)
{
    (void)state;
    static const char text[]
        = "cotree: 1\n"
          "bodies: {cart: {mass: 1}}\n"
          "joints: {slide: {type: prismatic, from: ground, to: cart, axis: [1, 0, 0],\n"
          "  effort: 'if(t < 0.25, 0, 1) + if(slide.q > 0.1, 2, 0)'}}\n"
          "outputs: [slide.q, slide.u]\n";
    struct ct_system *s = ct_system_load_text(ctx, text, strlen(text), NULL, NULL);
    struct ct_data *d = ct_data_create(ctx, s, NULL);
    assert_non_null(d);
    for (int i = 0; i < 10; i++)
        assert_true(ct_data_step(ctx, d, 0.1));
    // from 0.25 on q = s^2/2 up to 0.1 at s = sqrt(0.2), then with 3
    const double s1 = sqrt(0.2), rest = 0.75 - s1;
    CLOSE(ct_data_value(d, CT_SPEED, 0), s1 + 3 * rest, 1e-9);
    CLOSE(ct_data_value(d, CT_COORDINATE, 0), 0.1 + s1 * rest + 1.5 * rest * rest, 1e-9);
    ct_data_destroy(d);
    ct_system_destroy(s);
}

// A pulse by time that begins and ends within a step.
static void pulses_of_a_third_of_a_step_are_seen(void **state)
{
    (void)state;
    static const char text[] = "cotree: 1\n"
                               "bodies: {cart: {mass: 1}}\n"
                               "joints: {slide: {type: prismatic, from: ground, to: cart,\n"
                               "  effort: 'if(t < 0.33, 0, if(t < 0.36, 1, 0))'}}\n"
                               "outputs: [slide.u]\n";
    struct ct_system *s = ct_system_load_text(ctx, text, strlen(text), NULL, NULL);
    struct ct_data *d = ct_data_create(ctx, s, NULL);
    assert_non_null(d);
    for (int i = 0; i < 5; i++)
        assert_true(ct_data_step(ctx, d, 0.1));
    CLOSE(ct_data_value(d, CT_SPEED, 0), 0.03, 1e-9);
    ct_data_destroy(d);
    ct_system_destroy(s);
}

static void inputs_are_held_between_steps(void **state)
{
    (void)state;
    struct ct_data *d = ct_data_create(ctx, sys, NULL);
    double a0 = *ct_data_get(ctx, d, CT_Q_ACCELERATION, NULL, NULL);
    assert_true(ct_data_set_one(ctx, d, CT_INPUT, "tau", 3));
    assert_true(ct_data_value(d, CT_INPUT, 0) == 3);
    CLOSE(*ct_data_get(ctx, d, CT_Q_ACCELERATION, NULL, NULL) - a0, 3 / (2.0 / 3), 1e-12);
    // PD control: the energy that the input puts in is what was counted
    for (int i = 0; i < 2000; i++) {
        const double q = ct_data_value(d, CT_COORDINATE, 0), u = ct_data_value(d, CT_SPEED, 0);
        const double tau = -40 * (q - 0.5) - 8 * u + 2 * 9.81 / 2 * cos(q);
        assert_true(ct_data_set(ctx, d, CT_INPUT, &tau, 1));
        assert_true(ct_data_step(ctx, d, 1e-3));
    }
    CLOSE(ct_data_value(d, CT_COORDINATE, 0), 0.5, 1e-3);
    assert_true(ct_data_reset(ctx, d));
    assert_true(ct_data_time(d) == 0 && ct_data_value(d, CT_COORDINATE, 0) == 1);
    assert_true(ct_data_value(d, CT_INPUT, 0) != 0); // kept
    ct_data_destroy(d);
}

// A cart of 1 kg with dry friction of 0.1 N under a force that the program sets, and with drag that
// begins with the square of time.
static void friction_holds_or_lets_go_as_inputs_change(void **state)
{
    (void)state;
    static const char cart[] = "cotree: 1\n"
                               "inputs: {f: {value: 0, unit: N}, g: {value: 0, unit: N}}\n"
                               "bodies: {cart: {mass: 1}}\n"
                               "joints:\n"
                               "  s: {type: prismatic, from: ground, to: cart,\n"
                               "      effort: \"f - 0.1*sign(s.u) + g*t*t\"}\n"
                               "outputs: [s.q]\n"
                               "simulation: {duration: 1}\n";
    enum { E_STUCK = 406 };
    const double dt = 0x1p-7;
    struct ct_system *s = ct_system_load_text(ctx, cart, strlen(cart), "cart.yaml", NULL);
    struct ct_data *d = ct_data_create(ctx, s, NULL);
    assert_true(ct_data_step(ctx, d, dt) && ct_data_step(ctx, d, dt));
    assert_true(ct_data_value(d, CT_COORDINATE, 0) == 0);
    for (int sign = -1; sign <= 1; sign += 2) {
        assert_true(ct_data_set_one(ctx, d, CT_INPUT, "f", sign * 0.05));
        assert_false(ct_data_step(ctx, d, dt));
        assert_int_equal(code_of_last(), E_STUCK);
    }
    assert_true(ct_data_set_one(ctx, d, CT_INPUT, "f", 0.5));
    for (int i = 0; i < 128; i++)
        assert_true(ct_data_step(ctx, d, dt));
    CLOSE(ct_data_value(d, CT_COORDINATE, 0), 0.2, 1e-9);
    assert_true(ct_data_reset(ctx, d));
    assert_true(ct_data_set_one(ctx, d, CT_INPUT, "f", 0));
    assert_true(ct_data_set_one(ctx, d, CT_INPUT, "g", 1));
    assert_false(ct_data_step(ctx, d, dt) && ct_data_step(ctx, d, dt));
    assert_int_equal(code_of_last(), E_STUCK);
    ct_data_destroy(d);
    ct_system_destroy(s);
}

static void parameters_carry_what_is_derived_from_them(void **state)
{
    (void)state;
    struct ct_data *d = ct_data_create(ctx, sys, NULL);
    const long Iz = ct_system_find(sys, CT_PARAMETER, "Iz");
    assert_true(ct_data_set_one(ctx, d, CT_PARAMETER, "m", 6));
    CLOSE(ct_data_value(d, CT_PARAMETER, (size_t)Iz), 0.5, 1e-15);
    CLOSE(*ct_data_get(ctx, d, CT_Q_M, NULL, NULL), 2, 1e-14); // m l^2/3
    assert_true(ct_data_set_one(ctx, d, CT_PARAMETER, "Iz", 1));
    assert_true(ct_data_set_one(ctx, d, CT_PARAMETER, "m", 2));
    CLOSE(*ct_data_get(ctx, d, CT_Q_M, NULL, NULL), 1.5, 1e-14); // it is on its own now
    // another state of the system knows nothing of it
    struct ct_data *other = ct_data_create(ctx, sys, NULL);
    CLOSE(*ct_data_get(ctx, other, CT_Q_M, NULL, NULL), 2.0 / 3, 1e-14);
    ct_data_destroy(other);
    ct_data_destroy(d);
}

static void a_clone_goes_the_same_way(void **state)
{
    (void)state;
    struct ct_data *d = ct_data_create(ctx, sys, NULL);
    assert_true(ct_data_set_one(ctx, d, CT_INPUT, "tau", 2));
    assert_true(ct_data_set_one(ctx, d, CT_PARAMETER, "l", 0.8));
    for (int i = 0; i < 10; i++)
        assert_true(ct_data_step(ctx, d, 0.01));
    struct ct_data *c = ct_data_clone(ctx, d);
    for (int i = 0; i < 10; i++)
        assert_true(ct_data_step(ctx, d, 0.01) && ct_data_step(ctx, c, 0.01));
    assert_true(ct_data_time(c) == ct_data_time(d));
    assert_true(ct_data_value(c, CT_COORDINATE, 0) == ct_data_value(d, CT_COORDINATE, 0));
    ct_data_destroy(d);
    ct_data_destroy(c);
}

// ---- what follows from a state ------------------------------------------------------------------

// M u' = Q + J' lam, J u' + gam = 0, with the signs and orders of the header.
static void equations_hold_with_what_get_gives(void **state)
{
    (void)state;
    static const char *const names[] = {"slider_crank", "stewart", "spatial_four_bar"};
    for (int k = 0; k < 3; k++) {
        struct ct_system *s = load_shipped(names[k]);
        struct ct_data *d = ct_data_create(ctx, s, NULL);
        assert_true(ct_data_step(ctx, d, 0.01));
        size_t n, m, columns;
        const double *M = ct_data_get(ctx, d, CT_Q_M, &n, &columns);
        assert_int_equal(n, columns);
        const double *J = ct_data_get(ctx, d, CT_Q_J, &m, &columns);
        assert_int_equal(n, columns);
        const double *Q = ct_data_get(ctx, d, CT_Q_FORCE, NULL, NULL),
                     *gam = ct_data_get(ctx, d, CT_Q_GAMMA, NULL, NULL),
                     *a = ct_data_get(ctx, d, CT_Q_ACCELERATION, NULL, NULL),
                     *lam = ct_data_get(ctx, d, CT_Q_MULTIPLIERS, NULL, NULL);
        for (size_t i = 0; i < n; i++) {
            double sum = -Q[i], size = fabs(Q[i]);
            for (size_t j = 0; j < n; j++)
                sum += M[i * n + j] * a[j], size += fabs(M[i * n + j] * a[j]);
            for (size_t j = 0; j < m; j++)
                sum -= J[j * n + i] * lam[j], size += fabs(J[j * n + i] * lam[j]);
            CLOSE(sum, 0, 1e-9 * fmax(1, size));
        }
        for (size_t j = 0; j < m; j++) {
            double sum = gam[j], size = fabs(gam[j]);
            for (size_t i = 0; i < n; i++)
                sum += J[j * n + i] * a[i], size += fabs(J[j * n + i] * a[i]);
            CLOSE(sum, 0, 1e-9 * fmax(1, size));
        }
        ct_data_destroy(d);
        ct_system_destroy(s);
    }
}

static void frames_have_poses(void **state)
{
    (void)state;
    double R[9], p[3];
    struct ct_data *d = ct_data_create(ctx, sys, NULL);
    const size_t tip = (size_t)ct_system_find(sys, CT_FRAME, "link.tip");
    assert_true(ct_data_pose(ctx, d, tip, R, p));
    CLOSE(p[0], cos(1), 1e-15);
    CLOSE(p[1], sin(1), 1e-15);
    CLOSE(R[0], cos(1), 1e-15);
    CLOSE(R[1], -sin(1), 1e-15); // row by row
    CLOSE(R[8], 1, 0);
    assert_true(ct_data_set_one(ctx, d, CT_COORDINATE, "pivot.q", 0));
    assert_true(ct_data_pose(ctx, d, tip, R, p));
    CLOSE(p[0], 1, 1e-15);
    assert_false(ct_data_pose(ctx, d, 100, R, p));
    assert_int_equal(code_of_last(), 500);
    ct_data_destroy(d);
}

static void efforts_give_accelerations_back(void **state)
{
    (void)state;
    const double a = 5;
    double effort;
    struct ct_data *d = ct_data_create(ctx, sys, NULL);
    assert_true(ct_data_inverse(ctx, d, &a, &effort));
    assert_true(ct_data_set_one(ctx, d, CT_INPUT, "tau", effort));
    CLOSE(*ct_data_get(ctx, d, CT_Q_ACCELERATION, NULL, NULL), 5, 1e-12);
    ct_data_destroy(d);
    // in a loop the accelerations of now need no more efforts than there are
    struct ct_system *s = load_shipped("slider_crank");
    d = ct_data_create(ctx, s, NULL);
    const size_t n = ct_system_count(s, CT_SPEED);
    double *now = calloc(n, sizeof *now), *tau = calloc(n, sizeof *tau);
    memcpy(now, ct_data_get(ctx, d, CT_Q_ACCELERATION, NULL, NULL), n * sizeof *now);
    assert_true(ct_data_inverse(ctx, d, now, tau));
    for (size_t i = 0; i < n; i++)
        CLOSE(tau[i], 0, 1e-9);
    for (size_t i = 0; i < n; i++)
        now[i] += 1; // the loop does not allow that
    ct_ctx_clear(ctx);
    assert_false(ct_data_inverse(ctx, d, now, tau));
    assert_int_equal(code_of_last(), 505);
    free(now);
    free(tau);
    ct_data_destroy(d);
    ct_system_destroy(s);
}

static void states_off_the_constraints_are_assembled(void **state)
{
    (void)state;
    struct ct_system *s = load_shipped("four_bar");
    struct ct_data *d = ct_data_create(ctx, s, NULL);
    size_t m;
    const double q = ct_data_value(d, CT_COORDINATE, 0);
    const double *phi;
    struct ct_item item;
    ct_system_item(s, CT_COORDINATE, 0, &item);
    assert_true(ct_data_set_one(ctx, d, CT_COORDINATE, item.name, q + 0.05));
    phi = ct_data_get(ctx, d, CT_Q_PHI, &m, NULL);
    double most = 0;
    for (size_t i = 0; i < m; i++)
        most = fmax(most, fabs(phi[i]));
    assert_true(most > 1e-4); // nothing is assembled by setting
    assert_true(ct_data_assemble(ctx, d));
    phi = ct_data_get(ctx, d, CT_Q_PHI, &m, NULL);
    for (size_t i = 0; i < m; i++)
        CLOSE(phi[i], 0, 1e-12);
    assert_true(ct_data_set_one(ctx, d, CT_COORDINATE, item.name, q + 0.05));
    assert_true(ct_data_step(ctx, d, 1e-3)); // does so first
    phi = ct_data_get(ctx, d, CT_Q_PHI, &m, NULL);
    for (size_t i = 0; i < m; i++)
        CLOSE(phi[i], 0, 1e-10);
    ct_data_destroy(d);
    ct_system_destroy(s);
}

static void what_cannot_be_set_is_told(void **state)
{
    (void)state;
    const double two[2] = {1, 2}, nan = NAN;
    struct ct_data *d = ct_data_create(ctx, sys, NULL);
    ct_ctx_clear(ctx);
    assert_false(ct_data_set(ctx, d, CT_INPUT, two, 2));
    assert_int_equal(code_of_last(), 500);
    assert_false(ct_data_set(ctx, d, CT_COORDINATE, &nan, 1));
    assert_int_equal(code_of_last(), 500);
    assert_false(ct_data_set(ctx, d, CT_OUTPUT, two, 2));
    assert_int_equal(code_of_last(), 501);
    assert_false(ct_data_set_one(ctx, d, CT_INPUT, "taw", 1));
    struct ct_diagnostic told;
    assert_true(ct_ctx_diagnostic(ctx, 0, &told));
    assert_non_null(strstr(told.message, "did you mean 'tau'?"));
    assert_int_equal(code_of_last(), 503);
    assert_false(ct_data_step(ctx, d, -1));
    assert_int_equal(code_of_last(), 500);
    assert_false(ct_data_set_time(ctx, d, NAN));
    assert_int_equal(code_of_last(), 500);
    assert_true(ct_data_value(d, CT_COORDINATE, 0) == 1); // nothing has changed
    ct_data_destroy(d);
    // whether the mechanism is planar depends on this one
    static const char text[]
        = "cotree: 1\n"
          "parameters: {tilt: 0}\n"
          "bodies: {a: {mass: 1, com: [1, 0, 0]}, b: {mass: 1, com: [1, 0, 0]}}\n"
          "joints:\n"
          "  one: {type: revolute, from: ground, to: a}\n"
          "  two: {type: revolute, from: a, to: b, axis: [tilt, 0, 1]}\n";
    struct ct_system *s = ct_system_load_text(ctx, text, strlen(text), NULL, NULL);
    d = ct_data_create(ctx, s, NULL);
    ct_ctx_clear(ctx);
    assert_false(ct_data_set_one(ctx, d, CT_PARAMETER, "tilt", 1));
    assert_int_equal(code_of_last(), 502);
    assert_true(ct_data_value(d, CT_PARAMETER, 0) == 0);
    ct_data_destroy(d);
    ct_system_destroy(s);
}

// ---- diagnostics --------------------------------------------------------------------------------

static void count_told(void *user, const struct ct_diagnostic *d)
{
    assert_true(d->severity == CT_SEVERITY_ERROR && d->line > 0);
    ++*(int *)user;
}

static void diagnostics_come_one_by_one(void **state)
{
    (void)state;
    static const char text[] = "cotree: 1\nbodies:\n  a: {mass: -1}\n  b: {mas: 2}\n";
    int told = 0;
    struct ct_diagnostic d;
    struct ct_ctx *c = ct_ctx_create();
    ct_ctx_on_diagnostic(c, count_told, &told);
    assert_null(ct_system_load_text(c, text, strlen(text), "two.yaml", NULL));
    assert_int_equal(ct_ctx_count(c), 2);
    assert_int_equal(told, 2);
    assert_true(ct_ctx_diagnostic(c, 0, &d));
    assert_string_equal(d.file, "two.yaml");
    assert_int_equal(d.line, 3);
    assert_true(d.column > 1 && d.code > 0 && *d.message);
    assert_false(ct_ctx_diagnostic(c, 2, &d));
    ct_ctx_clear(c);
    assert_int_equal(ct_ctx_count(c), 0);
    assert_int_equal(ct_ctx_fault(c), CT_FAULT_NONE);
    ct_ctx_destroy(c);
}

static bool stop(void *user, double t, double end)
{
    assert_true(end == 1 && t <= end);
    return ++*(int *)user < 3;
}

static void runs_are_cancelled_at_a_step(void **state)
{
    (void)state;
    int n = 0;
    struct ct_sim *sim = ct_sim_create(ctx, sys, NULL);
    assert_true(ct_sim_run(ctx, sim, &(struct ct_sim_results){.progress = stop, .user = &n}));
    assert_int_equal(n, 3);
    assert_true(ct_sim_time(sim) < 1);
    ct_sim_destroy(sim);
    sim = ct_sim_create(ctx, sys, NULL);
    ct_ctx_cancel(ctx);
    struct ct_diagnostic d;
    assert_false(ct_sim_run(ctx, sim, NULL));
    assert_true(ct_sim_time(sim) < 1);
    assert_true(ct_ctx_was_interrupted(ctx));
    assert_int_equal(ct_ctx_count(ctx), 1);
    assert_true(ct_ctx_diagnostic(ctx, 0, &d));
    assert_int_equal(d.code, 5);
    assert_null(ct_modes_create(ctx, sys, NULL)); // nothing begins before it is cleared
    ct_ctx_clear(ctx);
    assert_false(ct_ctx_was_interrupted(ctx));
    ct_sim_destroy(sim);
    struct ct_modes *modes = ct_modes_create(ctx, sys, NULL);
    assert_non_null(modes);
    ct_modes_destroy(modes);
}

// ---- texts --------------------------------------------------------------------------------------

static void systems_print_alike_after_runs(void **state)
{
    (void)state;
    static const char *const names[] = {"puma560", "stewart", "slider_crank_flexible"};
    for (int i = 0; i < 3; i++) {
        struct ct_system *s = load_shipped(names[i]);
        char *first = ct_system_equations(ctx, s, "all", "text");
        struct ct_sim *sim
            = ct_sim_create(ctx, s, &(struct ct_sim_options){.method = "radau5"});
        assert_non_null(sim);
        char *second = ct_system_equations(ctx, s, "all", "text");
        assert_string_equal(first, second);
        ct_sim_destroy(sim);
        ct_free(first);
        ct_free(second);
        ct_system_destroy(s);
    }
    assert_null(ct_system_graph(ctx, sys, "png"));
    ct_ctx_clear(ctx);
}

static void a_comma_locale_changes_nothing(void **state)
{
    (void)state;
    char *want = ct_system_equations(ctx, sys, "reduced", "json"),
         *want_c = ct_system_equations(ctx, sys, NULL, "c");
    char folder[] = "/tmp/cotree-locale-XXXXXX", command[256];
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command,
             "localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 >/dev/null 2>&1", folder);
    if (system(command) == 0)
        setenv("LOCPATH", folder, 1);
    const char *given = setlocale(LC_ALL, "de_DE.UTF-8");
    snprintf(command, sizeof command, "rm -r %s", folder);
    if (system(command) != 0 || !given) {
        ct_free(want);
        ct_free(want_c);
        skip();
    }
    char *got = ct_system_equations(ctx, sys, "reduced", "json"),
         *got_c = ct_system_equations(ctx, sys, NULL, "c");
    struct ct_sim *sim = ct_sim_create(ctx, sys, NULL);
    assert_true(ct_sim_run(ctx, sim, NULL));
    char *summary = ct_sim_summary(sim);
    char exported[] = "/tmp/cotree-export-XXXXXX";
    assert_non_null(mkdtemp(exported));
    assert_true(ct_sim_export(ctx, sim, "c", exported));
    setlocale(LC_ALL, "C");
    snprintf(command, sizeof command, "cat %s/*.[ch] %s/*.json | grep -q '[0-9],[0-9]'",
             exported, exported);
    assert_int_not_equal(system(command), 0);
    snprintf(command, sizeof command, "rm -r %s", exported);
    assert_int_equal(system(command), 0);
    assert_string_equal(got, want);
    assert_string_equal(got_c, want_c);
    assert_non_null(strstr(summary, "t = 1 s"));
    for (const char *comma = summary; (comma = strchr(comma, ',')); comma++)
        assert_false(comma[1] >= '0' && comma[1] <= '9');
    ct_free(summary);
    ct_free(want);
    ct_free(got);
    ct_free(want_c);
    ct_free(got_c);
    ct_sim_destroy(sim);
}

// ---- threads ------------------------------------------------------------------------------------

static void *use(void *system)
{
    struct ct_system *s = system;
    struct ct_ctx *c = ct_ctx_create();
    struct ct_data *d = ct_data_create(c, s, NULL);
    for (int i = 0; i < 20 && d; i++)
        ct_data_step(c, d, 1e-3);
    ct_data_destroy(d);
    struct ct_item item;
    ct_system_item(s, CT_COORDINATE, 0, &item); // assembles for all
    struct ct_sim *sim = ct_sim_create(
        c, s, &(struct ct_sim_options){.method = "radau5", .until = 0.01, .samples = 2});
    ct_sim_run(c, sim, NULL);
    ct_sim_destroy(sim);
    struct ct_linearization *l = ct_linearize(c, s, NULL);
    ct_linearization_destroy(l);
    char *text = ct_system_equations(c, s, "all", "text");
    ct_ctx_destroy(c);
    return text;
}

static void threads_share_a_system(void **state)
{
    (void)state;
    static const char *const names[] = {"four_bar", "puma560", "slider_crank_flexible"};
    for (int i = 0; i < 3; i++) {
        struct ct_system *s = load_shipped(names[i]);
        pthread_t thread[2];
        void *text[2];
        for (int k = 0; k < 2; k++)
            assert_int_equal(pthread_create(&thread[k], NULL, use, s), 0);
        for (int k = 0; k < 2; k++)
            pthread_join(thread[k], &text[k]);
        assert_non_null(text[0]);
        assert_string_equal(text[0], text[1]);
        ct_free(text[0]);
        ct_free(text[1]);
        ct_system_destroy(s);
    }
}

// ---- what callers may do wrong ------------------------------------------------------------------

static void options_of_other_versions_are_read(void **state)
{
    (void)state;
    // a program whose struct ended before `samples`: what follows is not read
    struct ct_sim_options o
        = {.size = offsetof(struct ct_sim_options, samples), .until = 0.5, .samples = -7};
    struct ct_sim *sim = ct_sim_create(ctx, sys, &o);
    assert_non_null(sim);
    ct_sim_destroy(sim);
    o.size = 0;
    assert_null(ct_sim_create(ctx, sys, &o));
    ct_ctx_clear(ctx);
    char version[32];
    snprintf(version, sizeof version, "%d.%d.%d", CT_VERSION_MAJOR, CT_VERSION_MINOR,
             CT_VERSION_PATCH);
    assert_string_equal(version, ct_version());
}

static void what_a_file_plays_cannot_be_set(void **state)
{
    (void)state;
    static const char text[]
        = "cotree: 1\n"
          "inputs: {F: {value: 0, unit: N}}\n"
          "bodies: {b: {mass: 1}}\n"
          "joints: {j: {type: prismatic, axis: x, from: ground, to: b, effort: F}}\n";
    FILE *f = fopen("played.csv", "w");
    assert_non_null(f);
    fputs("t,F\n0,2\n1,2\n", f);
    fclose(f);
    struct ct_ctx *c = ct_ctx_create();
    const struct ct_system_options played = {.input = "played.csv"};
    struct ct_system *s = ct_system_load_text(c, text, sizeof text - 1, NULL, &played);
    struct ct_data *d = ct_data_create(c, s, NULL);
    assert_non_null(d);
    const double zero = 0;
    assert_true(ct_data_set(c, d, CT_INPUT, &zero, 1));    // as it is
    assert_false(ct_data_set_one(c, d, CT_INPUT, "F", 1)); // it would have no effect
    struct ct_diagnostic diagnostic;
    assert_true(ct_ctx_diagnostic(c, 0, &diagnostic));
    assert_int_equal(diagnostic.code, 502);
    assert_true(ct_data_step(c, d, 0.5));
    assert_true(fabs(ct_data_value(d, CT_COORDINATE, 0) - 0.25) < 1e-9);
    ct_data_destroy(d);
    ct_system_destroy(s);
    ct_ctx_destroy(c);
    remove("played.csv");
}

static void nothing_is_done_with_null(void **state)
{
    (void)state;
    size_t n;
    double x[12];
    struct ct_item item;
    struct ct_diagnostic diagnostic;
    struct ct_ctx *const contexts[] = {NULL, ctx};
    for (int i = 0; i < 2; i++) {
        struct ct_ctx *c = contexts[i];
        assert_null(ct_system_load(c, NULL, NULL));
        assert_null(ct_system_load_text(c, NULL, 0, NULL, NULL));
        assert_false(ct_system_draw(c, NULL, NULL));
        assert_false(ct_system_report(c, NULL, NULL));
        assert_null(ct_plot_create(c, NULL, NULL));
        assert_false(ct_plot_write(c, NULL, NULL));
        assert_false(ct_system_print_graph(c, NULL, NULL, stdout));
        assert_false(ct_system_print_equations(c, NULL, NULL, NULL, stdout));
        assert_null(ct_system_graph(c, NULL, NULL));
        assert_null(ct_system_equations(c, NULL, NULL, NULL));
        assert_null(ct_sim_create(c, NULL, NULL));
        assert_false(ct_sim_run(c, NULL, NULL));
        assert_false(ct_sim_follow(c, NULL, NULL));
        assert_false(ct_sim_write_summary(c, NULL, NULL));
        assert_false(ct_sim_export(c, NULL, NULL, NULL));
        assert_false(ct_sim_export_lanes(c, NULL, NULL, NULL, 4));
        assert_null(ct_accuracy_create(c, NULL, NULL));
        assert_false(ct_accuracy_write(c, NULL, NULL));
        assert_false(ct_accuracy_draw(c, NULL, NULL));
        assert_null(ct_study_create(c, NULL, NULL, NULL));
        assert_false(ct_study_run(c, NULL, NULL));
        assert_false(ct_study_write_summary(c, NULL, NULL));
        assert_null(ct_equilibrium_create(c, NULL, NULL));
        assert_false(ct_equilibrium_write(c, NULL, NULL));
        assert_null(ct_modes_create(c, NULL, NULL));
        assert_false(ct_modes_write(c, NULL, NULL));
        assert_false(ct_modes_draw(c, NULL, NULL));
        assert_null(ct_linearize(c, NULL, NULL));
        assert_false(ct_linearization_write(c, NULL, NULL));
        assert_null(ct_buckling_create(c, NULL, NULL));
        assert_false(ct_buckling_write(c, NULL, NULL));
        assert_false(ct_buckling_write_curve(c, NULL, NULL, 3));
        assert_null(ct_data_create(c, NULL, NULL));
        assert_null(ct_data_clone(c, NULL));
        assert_false(ct_data_reset(c, NULL));
        assert_false(ct_data_set(c, NULL, CT_INPUT, x, 1));
        assert_false(ct_data_set_one(c, NULL, CT_INPUT, "x", 1));
        assert_false(ct_data_set_time(c, NULL, 0));
        assert_false(ct_data_assemble(c, NULL));
        assert_null(ct_data_get(c, NULL, CT_Q_M, &n, &n));
        assert_false(ct_data_step(c, NULL, 1));
        assert_false(ct_data_inverse(c, NULL, x, x));
        assert_false(ct_data_pose(c, NULL, 0, x, x + 9));
    }
    assert_null(ct_output_open(NULL, NULL));
    assert_null(ct_output_stream(NULL));
    assert_false(ct_output_close(NULL, NULL, true));
    assert_true(ct_plot_row(NULL, 0, x, 1));
    assert_null(ct_did_you_mean(NULL, NULL, 0));
    assert_null(ct_did_you_mean("x", NULL, 1));
    assert_false(ct_system_draw(NULL, sys, NULL));
    assert_false(ct_system_report(NULL, sys, NULL));
    assert_null(ct_sim_create(NULL, sys, NULL));
    assert_null(ct_data_create(NULL, sys, NULL));
    assert_false(ct_ctx_diagnostic(NULL, 0, &diagnostic));
    assert_int_equal(ct_ctx_count(NULL), 0);
    assert_int_equal(ct_ctx_fault(NULL), CT_FAULT_NONE);
    ct_ctx_print_diagnostics(NULL, stdout);
    ct_ctx_clear(NULL);
    ct_ctx_cancel(NULL);
    ct_ctx_on_diagnostic(NULL, count_told, NULL);
    ct_ctx_destroy(NULL);
    ct_free(NULL);
    assert_null(ct_system_name(NULL));
    assert_null(ct_system_column(NULL, 0));
    assert_int_equal(ct_system_column_count(NULL), 0);
    assert_int_equal(ct_system_count(NULL, CT_FRAME), 0);
    assert_false(ct_system_item(NULL, CT_FRAME, 0, &item));
    assert_int_equal(ct_system_find(NULL, CT_FRAME, "x"), -1);
    assert_true(isnan(ct_sim_time(NULL)) && isnan(ct_sim_value(NULL, "x"))
                && isnan(ct_sim_error(NULL, "x")));
    assert_null(ct_sim_summary(NULL));
    assert_null(ct_sim_summary_json(NULL));
    ct_sim_print_summary(NULL, stdout);
    ct_sim_print_check(NULL, stdout);
    ct_accuracy_print_summary(NULL, stdout);
    assert_int_equal(ct_study_count(NULL), 0);
    assert_int_equal(ct_study_failed(NULL), 0);
    assert_int_equal(ct_study_column_count(NULL), 0);
    assert_null(ct_study_column(NULL, 0));
    ct_study_print_summary(NULL, stdout);
    assert_true(isnan(ct_equilibrium_value(NULL, "x")));
    assert_false(ct_equilibrium_is_stable(NULL));
    ct_equilibrium_print_summary(NULL, stdout);
    assert_int_equal(ct_modes_count(NULL), 0);
    assert_true(ct_modes_info(NULL, 0).omega == 0);
    assert_false(ct_modes_shape(NULL, 0, "x", x, x));
    ct_modes_print_summary(NULL, stdout);
    assert_null(ct_linearization_matrix(NULL, 'A', &n, &n));
    assert_null(ct_linearization_name(NULL, 'x', 0));
    ct_linearization_print_summary(NULL, stdout);
    assert_int_equal(ct_buckling_count(NULL), 0);
    assert_true(isnan(ct_buckling_factor(NULL, 0)));
    ct_buckling_print_summary(NULL, stdout);
    assert_true(isnan(ct_data_time(NULL)) && isnan(ct_data_value(NULL, CT_INPUT, 0)));
    ct_system_destroy(NULL);
    ct_sim_destroy(NULL);
    ct_data_destroy(NULL);
    ct_study_destroy(NULL);
    ct_accuracy_destroy(NULL);
    ct_modes_destroy(NULL);
    ct_equilibrium_destroy(NULL);
    ct_linearization_destroy(NULL);
    ct_buckling_destroy(NULL);
    ct_ctx_clear(ctx);
}

// The run has no outputs, and fails: there is still a summary.
static void a_failed_run_without_outputs_has_a_summary(void **state)
{
    (void)state;
    static const char text[]
        = "cotree: 1\n"
          "bodies: {cart: {mass: 1}}\n"
          "joints: {slide: {type: prismatic, from: ground, to: cart, axis: [1, 0, 0],\n"
          "  effort: 1/(0.5 - t)^2}}\n"
          "simulation: {duration: 1}\n";
    struct ct_system *s = ct_system_load_text(ctx, text, strlen(text), NULL, NULL);
    struct ct_sim *sim = ct_sim_create(ctx, s, NULL);
    assert_false(ct_sim_run(ctx, sim, NULL));
    char *summary = ct_sim_summary(sim);
    assert_non_null(summary);
    ct_free(summary);
    ct_sim_destroy(sim);
    ct_system_destroy(s);
    ct_ctx_clear(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_have_values_units_and_places),
        cmocka_unit_test(steps_lead_where_a_run_leads),
        cmocka_unit_test(events_are_on_the_way),
        cmocka_unit_test(pulses_of_a_third_of_a_step_are_seen),
        cmocka_unit_test(inputs_are_held_between_steps),
        cmocka_unit_test(friction_holds_or_lets_go_as_inputs_change),
        cmocka_unit_test(parameters_carry_what_is_derived_from_them),
        cmocka_unit_test(a_clone_goes_the_same_way),
        cmocka_unit_test(equations_hold_with_what_get_gives),
        cmocka_unit_test(frames_have_poses),
        cmocka_unit_test(efforts_give_accelerations_back),
        cmocka_unit_test(states_off_the_constraints_are_assembled),
        cmocka_unit_test(what_cannot_be_set_is_told),
        cmocka_unit_test(diagnostics_come_one_by_one),
        cmocka_unit_test(runs_are_cancelled_at_a_step),
        cmocka_unit_test(systems_print_alike_after_runs),
        cmocka_unit_test(a_comma_locale_changes_nothing),
        cmocka_unit_test(threads_share_a_system),
        cmocka_unit_test(options_of_other_versions_are_read),
        cmocka_unit_test(what_a_file_plays_cannot_be_set),
        cmocka_unit_test(nothing_is_done_with_null),
        cmocka_unit_test(a_failed_run_without_outputs_has_a_summary),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
