// Events of integration: known times, roots, both at once; what they leave to steps and samples.
#include "integrate/event_location.h"
#include "tests/unit/integration.h"

// --- time events -----------------------------------------------------------------------------

// y' = (-1)^mode y: the solution is exp of a zigzag with corners at the events.
static enum ct_eval zigzag(void *user, double t, const double *y, double *dy)
{
    (void)t;
    dy[0] = ((struct record *)user)->mode % 2 ? -y[0] : y[0];
    return CT_EVAL_OK;
}

static enum ct_eval turn(void *user, double t, double *y, const double *dy,
                         const signed char *crossed, bool is_time)
{
    ((struct record *)user)->mode++;
    return note_event(user, t, y, dy, crossed, is_time);
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
    // above it for 0.283 s, 28 ms, 2.8 ms of each 6.28 s
    static const double limit[] = {0.99, 0.9999, 1 - 1e-6}, atol[] = {1e-5, 1e-8, 1e-8};
    const int cases = COUNT(limit);
    for (int k = 0; k < cases * ct_nmethod && !ct_methods[k / cases]->is_implicit; k++) {
        const int m = k / cases;
        struct record *r = begin();
        r->limit = limit[k % cases];
        double y[NY] = {1, 0};
        check_fine(r, run(r, ct_methods[m],
                          (struct ct_problem){.ny = 2,
                                              .rhs = oscillator,
                                              .nroot = 1,
                                              .root = near_top,
                                              .event = note_event},
                          (struct ct_integrate_options){.t1 = 40, .atol = atol[k % cases]}, y));
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

static enum ct_eval at_the_rate_of_time(void *user, double t, const double *y, double *dy)
{
    (void)user;
    (void)t;
    (void)y;
    dy[0] = 1;
    return CT_EVAL_OK;
}

static enum ct_eval two_waves(void *user, double t, const double *y, double *g)
{
    (void)user;
    (void)t;
    g[0] = cos(4 * acos(-1) * y[0]);
    return CT_EVAL_OK;
}

// The ends of the step and its middle have the same sign and are on a straight line.
static void two_waves_in_a_step_are_seen(void **unused)
{
    (void)unused;
    struct record *r = begin();
    double y[NY] = {0};
    check_fine(r, run(r, ct_method_find("dopri5"),
                      (struct ct_problem){.ny = 1,
                                          .rhs = at_the_rate_of_time,
                                          .nroot = 1,
                                          .root = two_waves,
                                          .event = note_event},
                      (struct ct_integrate_options){.t1 = 1, .atol = 1e-8, .step = 1}, y));
    assert_int_equal(r->nevent, 4);
    for (int i = 0; i < 4; i++)
        check_close("zero", r->event[i], (2 * i + 1) / 8., 1e-11);
    end(r);
}

// Three places of (x - x0)^2 (1 + k (x - x0)), which touches zero and whose curvature changes by
// 60 per cent from place to place; and of a parabola that stays away from zero.
static void a_parabola_tells_of_dips(void **unused)
{
    (void)unused;
    for (int i = -5; i <= 5; i++) {
        double f[3];
        for (int j = 0; j < 3; j++) {
            const double x = j - 1 - i / 10.;
            f[j] = x * x * (1 + 0.2 * x) + 1e-9;
        }
        assert_true(ct_event_location_may_dip(f[0], f[1], f[2]));
    }
    assert_false(ct_event_location_may_dip(1.5, 0.5, 1.5));
}

// y'' = t: zero with its slope at the start. The root fires once, at the start.
static enum ct_eval force_from_zero(void *user, double t, const double *y, double *dy)
{
    (void)user;
    dy[0] = y[1];
    dy[1] = t;
    return CT_EVAL_OK;
}

static void a_root_that_leaves_its_rest_fires_where_it_rested(void **unused)
{
    (void)unused;
    for (int m = 0; m < ct_nmethod && !ct_methods[m]->is_implicit; m++)
        for (int is_fixed = 0; is_fixed < 2; is_fixed++) {
            struct record *r = begin();
            double y[NY] = {0, 0};
            check_fine(r, run(r, ct_methods[m],
                              (struct ct_problem){.ny = 2,
                                                  .rhs = force_from_zero,
                                                  .nroot = 1,
                                                  .root = height,
                                                  .event = note_event},
                              (struct ct_integrate_options){
                                  .t1 = 1, .atol = 1e-8, .step = is_fixed ? 0.01 : 0},
                              y));
            assert_int_equal(r->nevent, 1);
            assert_true(r->event[0] == 0);
            assert_int_equal(r->crossed[0][0], 1);
            check_close("y", y[0], 1.0 / 6, 1e-8);
            end(r);
        }
}

static void a_sample_on_an_event_is_taken_after_it(void **unused)
{
    (void)unused;
    static const double due[] = {0.3, INFINITY};
    static const double times[] = {0, 0.1 + 0.2 /* after 0.3 by a round-off */, 1, 1.5, 1.5};
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_end_exactly_on_time_events),
        cmocka_unit_test(a_bouncing_ball_hits_when_it_should),
        cmocka_unit_test(a_state_event_on_a_time_event_loses_neither),
        cmocka_unit_test(infinitely_many_bounces_are_an_error),
        cmocka_unit_test(crossings_close_together_are_both_seen),
        cmocka_unit_test(events_are_as_accurate_as_steps),
        cmocka_unit_test(roots_that_fire_together_fire_once),
        cmocka_unit_test(a_root_may_jump_at_its_event),
        cmocka_unit_test(a_root_at_rest_on_zero_does_not_fire),
        cmocka_unit_test(two_waves_in_a_step_are_seen),
        cmocka_unit_test(a_parabola_tells_of_dips),
        cmocka_unit_test(a_root_that_leaves_its_rest_fires_where_it_rested),
        cmocka_unit_test(a_sample_on_an_event_is_taken_after_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
