// Integration against solutions in closed form: orders, tolerances, events, samples, refusals. The explicit methods,
// which stand first in the table; test_implicit.c has the others.
#include "integrate/control.h"
#include "integrate/problem.h"
#include "integrate/stepper.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 2048, NY = 4 };

// What a run leaves behind; also the user data of all problems here.
struct record {
    struct ct_ctx ctx;
    struct ct_integrate_stats stats;
    int nstep, nsample, nevent;
    double step[MOST], event[MOST], sample[MOST], value[MOST][NY];
    signed char crossed[MOST][NY];
    bool is_time[MOST];
    size_t used[MOST]; // of the arena at each step
    const double *due; // time events, ended by INFINITY
    int ny, nroot, mode, accepted;
    double limit;                       // meaning depends on the problem
    void (*exact)(double t, double *y); // NULL: unknown
    double worst_step, worst_sample;    // against `exact`
    int stop_after;                     // steps, 0: never
};

static void check_below(const char *what, double got, double limit)
{
    if (!(got <= limit)) {
        printf("%s: got %.6g, wanted at most %.6g\n", what, got, limit);
        fail();
    }
}

static void check_close(const char *what, double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance)) {
        printf("%s: got %.17g, wanted %.17g within %g\n", what, got, want, tolerance);
        fail();
    }
}

static double distance(const struct record *r, double t, const double *y)
{
    double z[NY], worst = 0;
    r->exact(t, z);
    for (int i = 0; i < r->ny; i++)
        worst = fmax(worst, fabs(z[i] - y[i]));
    return worst;
}

static bool at_step(void *user, double t, const double *y)
{
    struct record *r = user;
    if (r->nstep < MOST) {
        r->used[r->nstep] = ct_arena_used(r->ctx.model);
        r->step[r->nstep] = t;
    }
    r->nstep++;
    if (r->exact)
        r->worst_step = fmax(r->worst_step, distance(r, t, y));
    return r->nstep != r->stop_after;
}

static bool at_sample(void *user, double t, const double *y)
{
    struct record *r = user;
    assert_true(r->nsample < MOST);
    r->sample[r->nsample] = t;
    memcpy(r->value[r->nsample++], y, (size_t)r->ny * sizeof *y);
    if (r->exact)
        r->worst_sample = fmax(r->worst_sample, distance(r, t, y));
    return true;
}

static double next_due(void *user, double t)
{
    const double *due = ((struct record *)user)->due;
    while (*due <= t)
        due++;
    return *due;
}

static enum ct_eval note_event(void *user, double t, double *y, const signed char *crossed,
                               bool is_time)
{
    struct record *r = user;
    (void)y;
    assert_true(r->nevent < MOST);
    r->event[r->nevent] = t;
    r->is_time[r->nevent] = is_time;
    memcpy(r->crossed[r->nevent++], crossed, (size_t)r->nroot);
    return CT_EVAL_OK;
}

static bool run(struct record *r, const struct ct_method *method, struct ct_problem p,
                struct ct_integrate_options o, double *y)
{
    p.user = r;
    r->ny = p.ny;
    r->nroot = p.nroot;
    o.at_step = at_step;
    o.at_sample = at_sample;
    if (o.rtol == 0)
        o.rtol = o.atol;
    return ct_integrate(&r->ctx, method, &p, &o, y, &r->stats);
}

static struct record *begin(void)
{
    struct record *r = calloc(1, sizeof *r);
    r->ctx.model = ct_arena_create();
    return r;
}

static void end(struct record *r)
{
    ct_arena_destroy(r->ctx.model);
    free(r);
}

static void check_fine(const struct record *r, bool ok)
{
    ct_ctx_print(&r->ctx, stdout);
    assert_true(ok);
}

static void check_error(const struct record *r, bool ok, enum ct_code code)
{
    assert_false(ok);
    assert_int_equal(r->ctx.nerror, 1);
    assert_int_equal(r->ctx.diagnostic[0].code, code);
}

static void fill_even(double *s, int n, double t1)
{
    for (int i = 0; i < n; i++)
        s[i] = t1 * i / (n - 1);
}

// --- the problems ---------------------------------------------------------------------------

// Kepler's orbit of eccentricity 0.3: smooth, nonlinear, errors accumulate.
static const double eccentricity = 0.3;

static void kepler_exact(double t, double *y)
{
    double E = t;
    for (int i = 0; i < 50; i++) // Newton's method on E - e sin E = t
        E -= (E - eccentricity * sin(E) - t) / (1 - eccentricity * cos(E));
    const double d = 1 - eccentricity * cos(E), b = sqrt(1 - eccentricity * eccentricity);
    y[0] = cos(E) - eccentricity;
    y[1] = b * sin(E);
    y[2] = -sin(E) / d;
    y[3] = b * cos(E) / d;
}

static enum ct_eval kepler(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    const double r = hypot(y[0], y[1]), r3 = r * r * r;
    dy[0] = y[2];
    dy[1] = y[3];
    dy[2] = -y[0] / r3;
    dy[3] = -y[1] / r3;
    return CT_EVAL_OK;
}

// y = sin 3t, which attracts: errors of steps die out, those of interpolation are seen alone.
static void attractor_exact(double t, double *y)
{
    y[0] = sin(3 * t);
}

static enum ct_eval attractor(void *user, double t, const double *y, double *dy)
{
    (void)user;
    dy[0] = 3 * cos(3 * t) - 2 * (y[0] - sin(3 * t)) * (1 + y[0] * y[0]);
    return CT_EVAL_OK;
}

// y = (cos t, -sin t)
static void oscillator_exact(double t, double *y)
{
    y[0] = cos(t);
    y[1] = -sin(t);
}

static enum ct_eval oscillator(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -y[0];
    return CT_EVAL_OK;
}

// A ball over a floor at height 0 under gravity 2, restitution in `limit`.
static enum ct_eval ball(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -2;
    return CT_EVAL_OK;
}

static enum ct_eval height(void *user, double t, const double *y, double *g)
{
    (void)user;
    (void)t;
    g[0] = y[0];
    return CT_EVAL_OK;
}

static enum ct_eval bounce(void *user, double t, double *y, const signed char *crossed,
                           bool is_time)
{
    struct record *r = user;
    note_event(user, t, y, crossed, is_time);
    if (crossed[0] < 0)
        y[1] *= -r->limit;
    return CT_EVAL_OK;
}

static const struct ct_problem bouncing
    = {.ny = 2, .rhs = ball, .nroot = 1, .root = height, .event = bounce};

// ... with what is due as well
static const struct ct_problem bouncing_on_time = {.ny = 2,
                                                   .rhs = ball,
                                                   .nroot = 1,
                                                   .root = height,
                                                   .next_time_event = next_due,
                                                   .event = bounce};

// --- orders and tolerances -------------------------------------------------------------------

static void methods_are_found_by_name(void **unused)
{
    (void)unused;
    for (int i = 0; i < ct_nmethod; i++)
        assert_ptr_equal(ct_method_find(ct_methods[i]->name), ct_methods[i]);
    assert_null(ct_method_find("euler"));
}

static double kepler_error(const struct ct_method *method, int nstep)
{
    struct record *r = begin();
    double y[NY];
    kepler_exact(0, y);
    r->exact = kepler_exact;
    check_fine(r, run(r, method, (struct ct_problem){.ny = 4, .rhs = kepler},
                      (struct ct_integrate_options){.t1 = 4, .step = 4.0 / nstep}, y));
    assert_int_equal(r->stats.steps, nstep);
    const double error = distance(r, 4, y);
    end(r);
    return error;
}

static void halving_a_fixed_step_shows_the_order(void **unused)
{
    (void)unused;
    // steps small enough for the leading term, errors above 1e-13 for rounding
    static const struct {
        const char *name;
        int nstep;
    } cases[] = {{"rk4", 320}, {"dopri5", 160}, {"dop853", 40}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct ct_method *m = ct_method_find(cases[i].name);
        const double order
            = log2(kepler_error(m, cases[i].nstep) / kepler_error(m, 2 * cases[i].nstep));
        printf("%s: order %.2f\n", m->name, order);
        check_close("order", order, m->order, 0.45);
    }
}

static enum ct_eval even(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    (void)y;
    dy[0] = 1. / 3;
    return CT_EVAL_OK;
}

// Summed without care, a hundred thousand steps leave an error of some hundred roundings or more.
static void roundings_of_many_steps_do_not_add_up(void **unused)
{
    (void)unused;
    static const char *const names[] = {"rk4", "dopri5", "dop853"};
    for (size_t i = 0; i < COUNT(names); i++) {
        struct record *r = begin();
        double y[1] = {1};
        check_fine(r,
                   run(r, ct_method_find(names[i]), (struct ct_problem){.ny = 1, .rhs = even},
                       (struct ct_integrate_options){.t1 = 1, .step = 1e-5}, y));
        check_close(names[i], y[0], 4. / 3, 2 * DBL_EPSILON);
        end(r);
    }
}

// Largest error of one step, and of its interpolants without and with preparation.
static void local_errors(const struct ct_method *m, double h, double *step, double *rough,
                         double *fine)
{
    const struct ct_problem p = {.ny = 4, .rhs = kepler};
    struct ct_integrate_stats stats = {0};
    struct record r = {.ny = 4, .exact = kepler_exact};
    double y[NY], dy[NY], y1[NY], dy1[NY], out[NY], err, t = 0.5;
    struct ct_arena *arena = ct_arena_create();
    void *work = m->create(arena, m, &p);
    kepler_exact(t, y);
    kepler(NULL, t, y, dy);
    assert_int_equal(m->step(&p, t, h, y, dy, NULL, y1, dy1, &err, work, &stats), CT_EVAL_OK);
    *step = distance(&r, t + h, y1);
    *rough = *fine = 0;
    for (int i = 1; i < 20 && (m->has_rough_dense || !m->prepare); i++) {
        m->dense(&p, h, i / 20.0, y, y1, work, out);
        *rough = fmax(*rough, distance(&r, t + h * i / 20, out));
    }
    if (m->prepare)
        assert_int_equal(m->prepare(&p, t, h, y, y1, work, &stats), CT_EVAL_OK);
    for (int i = 0; i <= 20; i++) {
        m->dense(&p, h, i / 20.0, y, y1, work, out);
        *fine = fmax(*fine, distance(&r, t + h * i / 20, out));
    }
    ct_arena_destroy(arena);
}

static void interpolants_have_their_order(void **unused)
{
    (void)unused;
    static const struct {
        const char *name;
        double h, rough, fine; // powers of h
    } cases[] = {{"rk4", 0.05, 4, 4}, {"dopri5", 0.05, 5, 6}, {"dop853", 0.1, 0, 8}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct ct_method *m = ct_method_find(cases[i].name);
        double step[2], rough[2], fine[2];
        for (int k = 0; k < 2; k++)
            local_errors(m, cases[i].h / (1 + k), &step[k], &rough[k], &fine[k]);
        printf("%s: powers of the step %.2f, interpolants %.2f %.2f\n", m->name,
               log2(step[0] / step[1]), log2(rough[0] / rough[1]), log2(fine[0] / fine[1]));
        if (cases[i].rough > 0)
            check_close("rough", log2(rough[0] / rough[1]), cases[i].rough, 0.45);
        check_close("fine", log2(fine[0] / fine[1]), cases[i].fine, 0.45);
    }
}

static void errors_follow_the_tolerance(void **unused)
{
    (void)unused;
    double times[201];
    fill_even(times, 201, 20);
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        double before = INFINITY;
        for (int digits = 5; digits <= 11; digits += 2) {
            struct record *r = begin();
            double y[NY];
            kepler_exact(0, y);
            r->exact = kepler_exact;
            const double tol = pow(10, -digits);
            check_fine(r, run(r, ct_methods[m], (struct ct_problem){.ny = 4, .rhs = kepler},
                              (struct ct_integrate_options){
                                  .t1 = 20, .atol = tol, .sample = times, .nsample = 201},
                              y));
            printf("%s %g: %ld steps, %ld evaluations, error %.1e, of samples %.1e\n",
                   ct_methods[m]->name, tol, r->stats.steps, r->stats.evaluations,
                   r->worst_step, r->worst_sample);
            assert_int_equal(r->nsample, 201);
            // a hundredfold tolerance is about a hundredfold error: at least ten
            check_below("ladder", r->worst_sample, before / 10);
            // the interpolant adds nothing to what has accumulated
            check_below("samples", r->worst_sample, 1.2 * r->worst_step);
            before = r->worst_sample;
            end(r);
        }
        check_below("at 1e-11", before, 1e-7);
    }
}

static void samples_of_dopri5_are_as_good_as_steps(void **unused)
{
    (void)unused;
    double times[2001], y[NY] = {0};
    fill_even(times, 2001, 20);
    struct record *r = begin();
    r->exact = attractor_exact;
    check_fine(r,
               run(r, ct_method_find("dopri5"), (struct ct_problem){.ny = 1, .rhs = attractor},
                   (struct ct_integrate_options){
                       .t1 = 20, .atol = 1e-10, .sample = times, .nsample = 2001},
                   y));
    check_below("samples", r->worst_sample, 1.1 * r->worst_step);
    check_below("steps", r->worst_step, 1e-9); // ten tolerances
    end(r);
}

// --- time events -----------------------------------------------------------------------------

// y' = (-1)^mode y: the solution is exp of a zigzag with corners at the events.
static enum ct_eval zigzag(void *user, double t, const double *y, double *dy)
{
    (void)t;
    dy[0] = ((struct record *)user)->mode % 2 ? -y[0] : y[0];
    return CT_EVAL_OK;
}

static enum ct_eval turn(void *user, double t, double *y, const signed char *crossed,
                         bool is_time)
{
    ((struct record *)user)->mode++;
    return note_event(user, t, y, crossed, is_time);
}

static void steps_end_exactly_on_time_events(void **unused)
{
    (void)unused;
    static const double due[] = {0.3, 1.1, 1.1 + 1e-9, 2.7, 3, INFINITY};
    const double want = exp(0.3 - 0.8 + 1e-9 - (1.6 - 1e-9) + 0.3);
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++)
        for (int is_fixed = 0; is_fixed < 2; is_fixed++) {
            struct record *r = begin();
            r->due = due;
            double y[NY] = {1};
            check_fine(
                r, run(r, ct_methods[m],
                       (struct ct_problem){
                           .ny = 1, .rhs = zigzag, .next_time_event = next_due, .event = turn},
                       (struct ct_integrate_options){
                           .t1 = 3, .atol = 1e-12, .step = is_fixed ? 1e-3 : 0},
                       y));
            assert_int_equal(r->nevent, 5); // the one at the end, too
            for (int i = 0; i < 5; i++)
                assert_true(r->event[i] == due[i] && r->is_time[i]);
            check_close("y", y[0], want, 5e-11); // as a smooth run at this tolerance
            end(r);
        }
}

// --- state events ----------------------------------------------------------------------------

static void a_bouncing_ball_hits_when_it_should(void **unused)
{
    (void)unused;
    const double restitution = 0.8;
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        r->limit = restitution;
        double y[NY] = {1, 0}; // falls for 1 s, hits with 2 m/s
        check_fine(r, run(r, ct_methods[m], bouncing,
                          (struct ct_integrate_options){.t1 = 8, .atol = 1e-9}, y));
        double t = 1, v = 2;
        int n = 0;
        for (; t < 8; n++) {
            check_close("time of an impact", r->event[n], t, 1e-11); // 1e-12 of 8 s
            assert_int_equal(r->crossed[n][0], -1);
            v *= restitution;
            t += v; // flight: 2 v / g
        }
        assert_int_equal(r->nevent, n);
        t -= v;
        check_close("height", y[0], v * (8 - t) - (8 - t) * (8 - t), 1e-9);
        end(r);
    }
}

static void a_state_event_on_a_time_event_loses_neither(void **unused)
{
    (void)unused;
    // on the impact at 1 s, and before and after it by less and by more than is resolved
    for (int k = -3; k <= 3; k++)
        for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
            struct record *r = begin();
            const double due[] = {1 + k * abs(k) * 3e-13, INFINITY};
            r->limit = 1;
            r->due = due;
            double y[NY] = {1, 0};
            check_fine(r, run(r, ct_methods[m], bouncing_on_time,
                              (struct ct_integrate_options){.t1 = 2.5, .atol = 1e-9}, y));
            int ntime = 0, nimpact = 0;
            for (int i = 0; i < r->nevent; i++) {
                ntime += r->is_time[i];
                nimpact += r->crossed[i][0];
                if (r->is_time[i])
                    assert_true(r->event[i] == due[0]);
            }
            assert_int_equal(ntime, 1);
            assert_int_equal(nimpact, -1);
            check_close("height", y[0], 0.75, 1e-9);
            end(r);
        }
}

static void infinitely_many_bounces_are_an_error(void **unused)
{
    (void)unused;
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        r->limit = 0.5; // rests after 1 + 2 (0.5 + 0.25 + ...) = 3 s
        double y[NY] = {1, 0};
        const bool ok = run(r, ct_methods[m], bouncing,
                            (struct ct_integrate_options){.t1 = 10, .atol = 1e-9}, y);
        check_error(r, ok, CT_E_EVENT_PILE);
        check_close("time", r->stats.last_time, 3, 1e-8);
        check_below("depth", fabs(y[0]), 1e-9);
        end(r);
    }
}

static enum ct_eval near_top(void *user, double t, const double *y, double *g)
{
    (void)t;
    const struct record *r = user;
    static const double scale[] = {1, -1, 5};
    for (int i = 0; i < r->nroot; i++)
        // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): nroot is at most 3
        g[i] = scale[i] * (y[0] - r->limit);
    return CT_EVAL_OK;
}

static void crossings_close_together_are_both_seen(void **unused)
{
    (void)unused;
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        r->limit = 0.99; // above it for 0.283 s of each 6.28 s
        double y[NY] = {1, 0};
        check_fine(r, run(r, ct_methods[m],
                          (struct ct_problem){.ny = 2,
                                              .rhs = oscillator,
                                              .nroot = 1,
                                              .root = near_top,
                                              .event = note_event},
                          (struct ct_integrate_options){.t1 = 40, .atol = 1e-5}, y));
        assert_int_equal(r->nevent, 13);
        end(r);
    }
}

static void events_are_as_accurate_as_steps(void **unused)
{
    (void)unused;
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        r->limit = 0.3;
        r->exact = oscillator_exact;
        double y[NY] = {1, 0};
        check_fine(r, run(r, ct_methods[m],
                          (struct ct_problem){.ny = 2,
                                              .rhs = oscillator,
                                              .nroot = 1,
                                              .root = near_top,
                                              .event = note_event},
                          (struct ct_integrate_options){.t1 = 12, .atol = 1e-9}, y));
        const double pi = acos(-1), a = acos(0.3), want[] = {a, 2 * pi - a, 2 * pi + a};
        assert_int_equal(r->nevent, 4);
        for (int i = 0; i < 3; i++) {
            // at a slope of 0.95 the time is off by no more than the state is
            check_close("time", r->event[i], want[i], 1.2 * r->worst_step);
            assert_int_equal(r->crossed[i][0], i % 2 ? 1 : -1);
        }
        end(r);
    }
}

static void roots_that_fire_together_fire_once(void **unused)
{
    (void)unused;
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        r->limit = 0.5;
        double y[NY] = {1, 0};
        check_fine(r, run(r, ct_methods[m],
                          (struct ct_problem){.ny = 2,
                                              .rhs = oscillator,
                                              .nroot = 3,
                                              .root = near_top,
                                              .event = note_event},
                          (struct ct_integrate_options){.t1 = 6, .atol = 1e-8}, y));
        assert_int_equal(r->nevent, 2);
        for (int i = 0; i < 2; i++) {
            const int s = i ? 1 : -1;
            assert_int_equal(r->crossed[i][0], s);
            assert_int_equal(r->crossed[i][1], -s);
            assert_int_equal(r->crossed[i][2], s);
        }
        end(r);
    }
}

// A relay: y' = 1 up to y = 1, then y' = -1 down to 0, and so on. The root is the distance to the
// next turn, so that it jumps at each event.
static enum ct_eval relay(void *user, double t, const double *y, double *dy)
{
    (void)t;
    (void)y;
    dy[0] = ((struct record *)user)->mode % 2 ? -1 : 1;
    return CT_EVAL_OK;
}

static enum ct_eval to_turn(void *user, double t, const double *y, double *g)
{
    (void)t;
    g[0] = ((struct record *)user)->mode % 2 ? y[0] : 1 - y[0];
    return CT_EVAL_OK;
}

static void a_root_may_jump_at_its_event(void **unused)
{
    (void)unused;
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        double y[NY] = {0};
        check_fine(r,
                   run(r, ct_methods[m],
                       (struct ct_problem){
                           .ny = 1, .rhs = relay, .nroot = 1, .root = to_turn, .event = turn},
                       (struct ct_integrate_options){.t1 = 5.5, .atol = 1e-8}, y));
        assert_int_equal(r->nevent, 5);
        for (int i = 0; i < 5; i++)
            check_close("turn", r->event[i], i + 1, 1e-11);
        check_close("y", y[0], 0.5, 1e-11);
        end(r);
    }
}

static enum ct_eval nothing_moves(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    (void)y;
    dy[0] = 0;
    return CT_EVAL_OK;
}

static void a_root_at_rest_on_zero_does_not_fire(void **unused)
{
    (void)unused;
    struct record *r = begin();
    double y[NY] = {0};
    check_fine(
        r,
        run(r, ct_method_find("dopri5"),
            (struct ct_problem){
                .ny = 1, .rhs = nothing_moves, .nroot = 1, .root = height, .event = note_event},
            (struct ct_integrate_options){.t1 = 1, .atol = 1e-8}, y));
    assert_int_equal(r->nevent, 0);
    end(r);
}

// --- samples ---------------------------------------------------------------------------------

static void a_sample_on_an_event_is_taken_after_it(void **unused)
{
    (void)unused;
    static const double due[] = {0.3, INFINITY};
    static const double times[] = {0, 0.1 + 0.2 /* after 0.3 by a rounding */, 1, 1.5, 1.5};
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++)
        for (int is_fixed = 0; is_fixed < 2; is_fixed++) {
            struct record *r = begin();
            r->limit = 1;
            r->due = due;
            double y[NY] = {1, 0};
            check_fine(r, run(r, ct_methods[m], bouncing_on_time,
                              (struct ct_integrate_options){.t1 = 1.5,
                                                            .atol = 1e-10,
                                                            .step = is_fixed ? 0.01 : 0,
                                                            .sample = times,
                                                            .nsample = COUNT(times)},
                              y));
            assert_int_equal(r->nsample, COUNT(times));
            for (size_t i = 0; i < COUNT(times); i++)
                assert_true(r->sample[i] == times[i]);
            check_close("before", r->value[1][1], -0.6, 1e-9);
            check_close("on the impact", r->value[2][1], 2, 1e-9);
            check_close("end", r->value[3][1], 1, 1e-9);
            end(r);
        }
}

static void a_run_of_no_length_gives_its_sample(void **unused)
{
    (void)unused;
    static const double now[] = {2};
    struct record *r = begin();
    double y[NY] = {1, 0};
    check_fine(r,
               run(r, ct_method_find("dop853"), (struct ct_problem){.ny = 2, .rhs = oscillator},
                   (struct ct_integrate_options){
                       .t0 = 2, .t1 = 2, .atol = 1e-8, .sample = now, .nsample = 1},
                   y));
    assert_int_equal(r->nsample, 1);
    assert_int_equal(r->nstep, 0);
    assert_true(r->value[0][0] == 1);
    end(r);
}

static void one_sample_at_the_end_is_the_end(void **unused)
{
    (void)unused;
    static const double last[] = {2};
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        double y[NY] = {1, 0};
        check_fine(r, run(r, ct_methods[m], (struct ct_problem){.ny = 2, .rhs = oscillator},
                          (struct ct_integrate_options){
                              .t1 = 2, .atol = 1e-8, .sample = last, .nsample = 1},
                          y));
        assert_int_equal(r->nsample, 1);
        assert_memory_equal(r->value[0], y, 2 * sizeof *y);
        assert_true(r->stats.last_time == 2);
        end(r);
    }
}

static void fixed_steps_are_even_between_samples(void **unused)
{
    (void)unused;
    static const double times[] = {0, 0.25, 1};
    struct record *r = begin();
    double y[NY] = {1, 0};
    check_fine(r, run(r, ct_method_find("rk4"), (struct ct_problem){.ny = 2, .rhs = oscillator},
                      (struct ct_integrate_options){
                          .t1 = 1, .step = 0.1, .sample = times, .nsample = 3},
                      y));
    assert_int_equal(r->nstep, 3 + 8); // ceil(0.25 / 0.1) + ceil(0.75 / 0.1)
    assert_true(r->step[2] == 0.25);
    for (int i = 3; i < 11; i++)
        check_close("step", r->step[i] - r->step[i - 1], 0.75 / 8, 1e-15);
    end(r);
}

// --- refusals and limits ---------------------------------------------------------------------

// Refuses stages that are more than 0.01 ahead of the last accepted step; `mode` is the answer,
// with CT_EVAL_OK a derivative that is not a number.
static enum ct_eval shortsighted(void *user, double t, const double *y, double *dy)
{
    struct record *r = user;
    oscillator(user, t, y, dy);
    if (t <= r->limit + 0.01)
        return CT_EVAL_OK;
    dy[0] = NAN;
    return (enum ct_eval)r->mode;
}

static enum ct_eval look_ahead(void *user, double t, const double *y, const double *dy)
{
    (void)y, (void)dy;
    ((struct record *)user)->limit = t;
    return CT_EVAL_OK;
}

static void a_refused_or_undefined_stage_shortens_the_step(void **unused)
{
    (void)unused;
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++)
        for (int mode = CT_EVAL_OK; mode <= CT_EVAL_RETRY; mode++) {
            struct record *r = begin();
            r->exact = oscillator_exact;
            r->mode = mode;
            double y[NY] = {1, 0};
            check_fine(r, run(r, ct_methods[m],
                              (struct ct_problem){
                                  .ny = 2, .rhs = shortsighted, .accepted = look_ahead},
                              (struct ct_integrate_options){.t1 = 1, .atol = 1e-8}, y));
            assert_true(r->stats.steps >= 100);
            assert_true(r->stats.rejected_steps > 0);
            check_below("error", r->worst_step, 1e-8);
            end(r);
        }
}

// Defined up to t = 0.5 only; with mode FATAL it gives up there instead.
static enum ct_eval bounded(void *user, double t, const double *y, double *dy)
{
    const struct record *r = user;
    return t > 0.5 ? (enum ct_eval)r->mode : oscillator(user, t, y, dy);
}

static void a_step_that_must_vanish_is_an_error_with_its_time(void **unused)
{
    (void)unused;
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        r->mode = CT_EVAL_RETRY;
        double y[NY] = {1, 0};
        const struct ct_problem p = {.ny = 2, .rhs = bounded};
        check_error(
            r,
            run(r, ct_methods[m], p, (struct ct_integrate_options){.t1 = 1, .atol = 1e-8}, y),
            CT_E_STEP_SMALL);
        check_close("time", r->stats.last_time, 0.5, 1e-12);
        assert_non_null(strstr(r->ctx.diagnostic[0].text, "t = 0.5 "));
        end(r);
    }
}

static void a_fatal_answer_stops_at_once(void **unused)
{
    (void)unused;
    struct record *r = begin();
    r->mode = CT_EVAL_FATAL;
    double y[NY] = {1, 0};
    assert_false(run(r, ct_method_find("dopri5"), (struct ct_problem){.ny = 2, .rhs = bounded},
                     (struct ct_integrate_options){.t1 = 1, .atol = 1e-8}, y));
    assert_int_equal(r->ctx.nerror, 0); // who answers so has said why
    check_below("time", r->stats.last_time, 0.5);
    end(r);
}

static void a_fixed_step_is_not_shortened(void **unused)
{
    (void)unused;
    struct record *r = begin();
    r->mode = CT_EVAL_RETRY;
    double y[NY] = {1, 0};
    check_error(r,
                run(r, ct_method_find("rk4"), (struct ct_problem){.ny = 2, .rhs = bounded},
                    (struct ct_integrate_options){.t1 = 1, .step = 0.1}, y),
                CT_E_STEP_REFUSED);
    end(r);
}

static void limits_and_senseless_options_are_errors(void **unused)
{
    (void)unused;
    static const double backwards[] = {0.5, 0.4}, outside[] = {2};
    static const struct {
        struct ct_integrate_options o;
        enum ct_code code;
    } cases[] = {
        {{.t1 = 100, .atol = 1e-8, .max_steps = 10}, CT_E_STEP_COUNT},
        {{.t1 = -1, .atol = 1e-8}, CT_E_INTEGRATE_OPTION},
        {{.t1 = INFINITY, .atol = 1e-8}, CT_E_INTEGRATE_OPTION},
        {{.t1 = 1}, CT_E_INTEGRATE_OPTION},
        {{.t1 = 1, .atol = NAN}, CT_E_INTEGRATE_OPTION},
        {{.t1 = 1, .step = -1}, CT_E_INTEGRATE_OPTION},
        {{.t1 = 1, .atol = 1, .sample = backwards, .nsample = 2}, CT_E_INTEGRATE_OPTION},
        {{.t1 = 1, .atol = 1, .sample = outside, .nsample = 1}, CT_E_INTEGRATE_OPTION},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct record *r = begin();
        double y[NY] = {1, 0};
        const struct ct_problem p = {.ny = 2, .rhs = oscillator};
        check_error(r, run(r, ct_method_find("dopri5"), p, cases[i].o, y), cases[i].code);
        end(r);
    }
    struct record *r = begin();
    double y[NY] = {NAN, 0};
    const struct ct_problem p = {.ny = 2, .rhs = oscillator};
    const struct ct_integrate_options o = {.t1 = 1, .atol = 1e-8};
    check_error(r, run(r, ct_method_find("dopri5"), p, o, y), CT_E_STATE_REFUSED);
    end(r);
}

// An oscillator whose turns become ever slower: the phase is 100 log(1 + t).
static enum ct_eval slowing(void *user, double t, const double *y, double *dy)
{
    (void)user;
    dy[0] = 100 / (1 + t) * y[1];
    dy[1] = -100 / (1 + t) * y[0];
    return CT_EVAL_OK;
}

// Two thousandths of the steps allowed tell that there are too many; steps that grow may still arrive.
static void endless_runs_end_early(void **unused)
{
    (void)unused;
    const struct ct_method *method = ct_method_find("dopri5");
    const struct ct_integrate_options o = {.t1 = 1e4, .atol = 1e-8, .max_steps = 1000000};
    struct ct_integrate_options endless = o;
    double y[NY] = {1, 0};
    struct record *r = begin();
    endless.t1 = 1e7;
    check_error(r, run(r, method, (struct ct_problem){.ny = 2, .rhs = oscillator}, endless, y),
                CT_E_STEP_COUNT);
    assert_int_equal(r->stats.steps, 2000);
    end(r);
    r = begin();
    double z[NY] = {1, 0};
    check_fine(r, run(r, method, (struct ct_problem){.ny = 2, .rhs = slowing}, o, z));
    assert_true(fabs(z[0] - cos(100 * log1p(1e4))) < 1e-3);
    assert_true(r->stats.steps > 4000 && r->step[999] < 1e4 / 3000); // far too slow at first
    end(r);
}

// A pendulum: its period from rest at 1 rad is 2 pi over the arithmetic-geometric mean of 1 and cos(1/2), here from 40 digits.
static enum ct_eval swinging(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -sin(y[0]);
    return CT_EVAL_OK;
}

// Error after so many whole periods.
static double error_of_swings(int count, double least_rtol, long *steps)
{
    static const double period = 6.69997566437045271;
    struct record *r = begin();
    double y[NY] = {1, 0};
    check_fine(r, run(r, ct_method_find("dop853"),
                      (struct ct_problem){.ny = 2, .nq = 1, .nu = 1, .rhs = swinging},
                      (struct ct_integrate_options){
                          .t1 = count * period, .atol = 1e-9, .least_rtol = least_rtol},
                      y));
    *steps = r->stats.steps;
    end(r);
    return hypot(y[0] - 1, y[1]);
}

// Errors grow with the square of the number of turns, unless steps know of it; with few turns nothing changes.
static void many_turns_ask_for_better_steps(void **unused)
{
    (void)unused;
    long steps, better_steps;
    assert_true(error_of_swings(10, 0, &steps) == error_of_swings(10, 1e-14, &better_steps));
    assert_true(steps == better_steps);
    const double few = error_of_swings(10, 0, &steps), many = error_of_swings(300, 0, &steps);
    const double better = error_of_swings(300, 1e-14, &better_steps);
    printf("error after 10 swings %.1e, after 300 %.1e; with a share of the tolerance %.1e in "
           "%ld steps instead of %ld\n",
           few, many, better, better_steps, steps);
    assert_true(many > 100 * few && better < many / 50 && better_steps < 3 * steps);
}

static void the_caller_may_stop_a_run(void **unused)
{
    (void)unused;
    struct record *r = begin();
    r->stop_after = 3;
    double y[NY] = {1, 0};
    check_fine(r,
               run(r, ct_method_find("dopri5"), (struct ct_problem){.ny = 2, .rhs = oscillator},
                   (struct ct_integrate_options){.t1 = 10, .atol = 1e-8}, y));
    assert_int_equal(r->nstep, 3);
    assert_true(r->stats.last_time == r->step[2] && r->step[2] < 10);
    end(r);
}

// --- what is watched, projected and allocated ------------------------------------------------

// The oscillator and the integral of a signal much faster than it.
static enum ct_eval with_quadrature(void *user, double t, const double *y, double *dy)
{
    dy[2] = sin(200 * t);
    return oscillator(user, t, y, dy);
}

static void a_quadrature_does_not_shorten_steps(void **unused)
{
    (void)unused;
    static const bool all[] = {true, true, true}, two[] = {true, true, false};
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        long steps[3];
        for (int k = 0; k < 3; k++) {
            struct record *r = begin();
            double y[NY] = {1, 0, 0};
            check_fine(r, run(r, ct_methods[m],
                              (struct ct_problem){.ny = k ? 3 : 2,
                                                  .rhs = k ? with_quadrature : oscillator,
                                                  .watched = k == 1 ? two : all},
                              (struct ct_integrate_options){.t1 = 10, .atol = 1e-8}, y));
            steps[k] = r->stats.steps;
            end(r);
        }
        assert_int_equal(steps[1], steps[0]);
        assert_true(steps[2] > 3 * steps[0]);
    }
}

static void a_group_is_measured_by_its_largest_member(void **unused)
{
    (void)unused;
    static const int of[] = {0, -1, 0, 1};
    double size[2];
    const struct ct_groups g = {2, of, size};
    const double y[] = {1e-9, 2, -3, 0}, y1[] = {0, 1, 4, 0.5}, e[] = {4, 2, 8, 1};
    const struct ct_tolerance tolerance = {.rtol = 1};
    struct ct_problem p = {.ny = 4, .groups = &g};
    assert_true(fabs(ct_stepper_norm(&p, &tolerance, y, y1, e) - sqrt((1 + 1 + 4 + 4) / 4.))
                < 1e-15);
    p.groups = NULL;
    assert_true(ct_stepper_norm(&p, &tolerance, y, y1, e) > 1e9);
    // an oscillation has the size of its amplitude, not of the place that passes through zero
    static const int both[] = {0, 0};
    const struct ct_groups one = {1, both, size};
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        long steps[2];
        for (int k = 0; k < 2; k++) {
            struct record *r = begin();
            double state[NY] = {1, 0};
            check_fine(r, run(r, ct_methods[m],
                              (struct ct_problem){
                                  .ny = 2, .rhs = oscillator, .groups = k ? &one : NULL},
                              (struct ct_integrate_options){.t1 = 100, .atol = 1e-12}, state));
            steps[k] = r->stats.steps;
            end(r);
        }
        assert_true(steps[1] < steps[0]);
    }
}

// A pendulum of length 1 in gravity 1 as a point (x, y, x', y') on a circle.
static enum ct_eval point_on_circle(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    const double r2 = y[0] * y[0] + y[1] * y[1], v2 = y[2] * y[2] + y[3] * y[3];
    const double lam = (v2 - y[1]) / r2; // from x x'' + y y'' + v2 = 0
    dy[0] = y[2];
    dy[1] = y[3];
    dy[2] = -lam * y[0];
    dy[3] = -lam * y[1] - 1;
    return CT_EVAL_OK;
}

static enum ct_eval onto_circle(void *user, double t, double *y)
{
    (void)user;
    (void)t;
    const double r = hypot(y[0], y[1]);
    y[0] /= r;
    y[1] /= r;
    const double outwards = y[0] * y[2] + y[1] * y[3];
    y[2] -= outwards * y[0];
    y[3] -= outwards * y[1];
    return CT_EVAL_OK;
}

static enum ct_eval pendulum(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    dy[0] = y[1];
    dy[1] = -sin(y[0]);
    return CT_EVAL_OK;
}

static void projection_keeps_steps_and_samples_on_the_circle(void **unused)
{
    (void)unused;
    double times[101];
    fill_even(times, 101, 20);
    struct record *want = begin();
    double angle[NY] = {2, 0};
    check_fine(want, run(want, ct_method_find("dop853"),
                         (struct ct_problem){.ny = 2, .rhs = pendulum},
                         (struct ct_integrate_options){
                             .t1 = 20, .atol = 1e-13, .sample = times, .nsample = 101},
                         angle));
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        double y[NY] = {sin(2), -cos(2), 0, 0};
        check_fine(
            r, run(r, ct_methods[m],
                   (struct ct_problem){.ny = 4, .rhs = point_on_circle, .project = onto_circle},
                   (struct ct_integrate_options){
                       .t1 = 20, .atol = 1e-9, .sample = times, .nsample = 101},
                   y));
        for (int i = 0; i < 101; i++) {
            const double *z = r->value[i], phi = want->value[i][0];
            check_close("length", hypot(z[0], z[1]), 1, 4 * DBL_EPSILON);
            check_close("radial speed", z[0] * z[2] + z[1] * z[3], 0, 4 * DBL_EPSILON);
            check_close(
                "angle",
                atan2(z[0] * cos(phi) + z[1] * sin(phi), z[0] * sin(phi) - z[1] * cos(phi)), 0,
                1e-6); // a thousand tolerances in 20 s
        }
        end(r);
    }
    end(want);
}

static void nothing_is_allocated_while_stepping(void **unused)
{
    (void)unused;
    double times[101];
    fill_even(times, 101, 8);
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++) {
        struct record *r = begin();
        r->limit = 0.9;
        double y[NY] = {1, 0};
        check_fine(r, run(r, ct_methods[m], bouncing,
                          (struct ct_integrate_options){
                              .t1 = 8, .atol = 1e-9, .sample = times, .nsample = 101},
                          y));
        assert_true(r->nevent > 2);
        for (int i = 1; i < r->nstep; i++)
            assert_int_equal(r->used[i], r->used[0]);
        end(r);
    }
}

// Powers of errors in step control have four digits, whatever the error and the order.
static void next_steps_are_those_of_the_pi_controller(void **unused)
{
    const double safety = 0.8, least = 0.2, most = 5;
    (void)unused;
    for (int order = 2; order <= 8; order += 3) {
        const struct ct_method method = {.error_order = order};
        struct ct_control c = ct_control_start();
        double before = 1e-4;
        c.h = 0.1;
        double error = 0.9;
        for (int i = 0; i < 28; i++, error *= 0.37) { // down to 1e-12
            const double h = c.h, beta = 0.2 / (order + 1);
            const double power = 1. / (order + 1) - 0.75 * beta;
            const double factor = safety * pow(error, -power) * pow(before, beta);
            const double wanted = h * fmin(fmax(factor, least), most);
            ct_control_accept(&c, &method, h, error);
            assert_true(fabs(c.h / wanted - 1) < 3e-4);
            before = fmax(error, 1e-4);
        }
        c.h = 1;
        ct_control_accept(&c, &method, c.h, 0);
        assert_true(c.h == most);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(next_steps_are_those_of_the_pi_controller),
        cmocka_unit_test(methods_are_found_by_name),
        cmocka_unit_test(halving_a_fixed_step_shows_the_order),
        cmocka_unit_test(roundings_of_many_steps_do_not_add_up),
        cmocka_unit_test(interpolants_have_their_order),
        cmocka_unit_test(errors_follow_the_tolerance),
        cmocka_unit_test(samples_of_dopri5_are_as_good_as_steps),
        cmocka_unit_test(steps_end_exactly_on_time_events),
        cmocka_unit_test(a_bouncing_ball_hits_when_it_should),
        cmocka_unit_test(a_state_event_on_a_time_event_loses_neither),
        cmocka_unit_test(infinitely_many_bounces_are_an_error),
        cmocka_unit_test(crossings_close_together_are_both_seen),
        cmocka_unit_test(events_are_as_accurate_as_steps),
        cmocka_unit_test(roots_that_fire_together_fire_once),
        cmocka_unit_test(a_root_may_jump_at_its_event),
        cmocka_unit_test(a_root_at_rest_on_zero_does_not_fire),
        cmocka_unit_test(a_sample_on_an_event_is_taken_after_it),
        cmocka_unit_test(a_run_of_no_length_gives_its_sample),
        cmocka_unit_test(one_sample_at_the_end_is_the_end),
        cmocka_unit_test(fixed_steps_are_even_between_samples),
        cmocka_unit_test(a_refused_or_undefined_stage_shortens_the_step),
        cmocka_unit_test(a_step_that_must_vanish_is_an_error_with_its_time),
        cmocka_unit_test(a_fatal_answer_stops_at_once),
        cmocka_unit_test(a_fixed_step_is_not_shortened),
        cmocka_unit_test(limits_and_senseless_options_are_errors),
        cmocka_unit_test(endless_runs_end_early),
        cmocka_unit_test(many_turns_ask_for_better_steps),
        cmocka_unit_test(the_caller_may_stop_a_run),
        cmocka_unit_test(a_quadrature_does_not_shorten_steps),
        cmocka_unit_test(a_group_is_measured_by_its_largest_member),
        cmocka_unit_test(projection_keeps_steps_and_samples_on_the_circle),
        cmocka_unit_test(nothing_is_allocated_while_stepping),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
