// Integration where a step or a run cannot go on: refused stages, errors with their times, limits,
// endless runs.
#include "tests/unit/integration.h"

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

static enum ct_eval look_ahead(void *user, double t, const double *y, const double *dy,
                               bool is_across)
{
    (void)y, (void)dy, (void)is_across;
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

// Two thousandths of the steps allowed tell that there are too many; steps that grow may still
// arrive.
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

// A pendulum: its period from rest at 1 rad is 2 pi over the arithmetic-geometric mean of 1 and
// cos(1/2), here from 40 digits.
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

// Errors grow with the square of the number of turns, unless steps know of it; with few turns
// nothing changes.
static void many_periods_tighten_the_tolerance(void **unused)
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_refused_or_undefined_stage_shortens_the_step),
        cmocka_unit_test(a_step_that_must_vanish_is_an_error_with_its_time),
        cmocka_unit_test(a_fatal_answer_stops_at_once),
        cmocka_unit_test(a_fixed_step_is_not_shortened),
        cmocka_unit_test(limits_and_senseless_options_are_errors),
        cmocka_unit_test(endless_runs_end_early),
        cmocka_unit_test(many_periods_tighten_the_tolerance),
        cmocka_unit_test(the_caller_may_stop_a_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
