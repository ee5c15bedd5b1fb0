// What errors of states mean for outputs, as the control of steps is told.  (8.6)
#include "tests/unit/integration.h"

#include "solve/output_error/output_error.h"

#include <float.h>

// The error of an output of 1 that changes to `off`, where one of its round-off errors is
// `roundoff`.
static double judge(struct ct_tolerance tolerance, double roundoff, double off)
{
    const double at = 1, probed = at + roundoff * (CT_PERTURBATION / DBL_EPSILON);
    struct ct_arena *a = ct_arena_create();
    struct ct_output_error_record r = ct_output_error_record(a, CT_OUTPUTS_OF_STATES, 1);
    const double error = ct_output_error_evaluate(&r, &at, &probed, &off, &tolerance, 1);
    ct_arena_destroy(a);
    return error;
}

// One of which round-off errors leave no six digits asks for nothing: steps would follow them.
static void outputs_count_from_six_digits_on(void **unused)
{
    (void)unused;
    const struct ct_tolerance usual = {1e-6, 1e-12};
    check_below("error of an output of five digits", judge(usual, 1 / 2e5, 2), 0);
    check_below("what an output of seven digits lacks", 1, judge(usual, 1 / 5e6, 2));
}

// A step is not refused for the last digit of an output, and is for its last two.
static void the_last_digit_rejects_no_step(void **unused)
{
    (void)unused;
    const struct ct_tolerance below_roundoff = {1e-18, 0};
    const double roundoff = 0x1p-40;
    check_below("error of ten round-off errors",
                judge(below_roundoff, roundoff, 1 + 10 * roundoff), 1);
    check_below("1, for a hundred", 1, judge(below_roundoff, roundoff, 1 + 100 * roundoff));
}

struct looks {
    int n, longest; // estimates in 200 steps; steps without one between two of them
    int measured;   // those with a measurement of round-off
};

// What is looked at where states err by `states` tolerances a step and an output by ratio times as
// much, a ratio that grows by the factor `growth` from step to step.
static struct looks count_looks(enum ct_output_kind kind, double states, double ratio,
                                double growth)
{
    const struct ct_tolerance tolerance = {1e-6, 0};
    const double at = 1;
    struct ct_arena *a = ct_arena_create();
    struct ct_output_error_record r = ct_output_error_record(a, kind, 1);
    struct looks looks = {0};
    for (int step = 0, last = 0; step < 200; step++, ratio *= growth) {
        const double off = at + ratio * states * tolerance.rtol, probed = at + DBL_EPSILON;
        if (!ct_output_error_is_due(&r))
            continue;
        const bool is_measured = r.without_measurement == 0;
        if (!is_measured)
            r.without_measurement--;
        ct_output_error_evaluate(&r, &at, is_measured ? &probed : &at, &off, &tolerance,
                                 states);
        looks.n++;
        looks.measured += is_measured;
        looks.longest = looks.longest > step - last - 1 ? looks.longest : step - last - 1;
        last = step;
    }
    ct_arena_destroy(a);
    return looks;
}

// Estimates take an evaluation each. One in six to twelve steps is enough for an output that errs
// far less than the states do; one in ten to twenty where the ratio of both stays the same.
static void estimates_are_few_where_they_tell_nothing_new(void **unused)
{
    (void)unused;
    const struct looks small = count_looks(CT_OUTPUTS_OF_STATES, 0.5, 0.1, 1),
                       steady = count_looks(CT_OUTPUTS_OF_STATES, 0.5, 4, 1),
                       growing = count_looks(CT_OUTPUTS_OF_STATES, 0.5, 4, 1.1),
                       half = count_looks(CT_OUTPUTS_OF_STATES, 0.5, 1, 1.03);
    assert_in_range(small.longest, 5, 11);
    assert_in_range(steady.longest, 9, 19);
    assert_in_range(steady.n, 10, 25);
    assert_int_equal(growing.longest, 0);
    assert_int_equal(half.longest, 0);
}

// A ratio near 1 matters, however steady: it is seen in each step at first. Tolerances of checks:
// 1 + 1e-6 has an error of 1e-10 of its small part.
static void an_output_that_errs_as_states_do_counts(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    struct ct_output_error_record r = ct_output_error_record(a, CT_OUTPUTS_OF_STATES, 1);
    const struct ct_tolerance tolerance = {1e-6, 0};
    const double at = 1, off = at + 0.5e-6;
    ct_output_error_evaluate(&r, &at, &at, &off, &tolerance, 0.5);
    check_close("half a tolerance, extrapolated", ct_output_error_extrapolated(&r, 0.5), 0.5,
                1e-9);
    assert_int_equal(r.skip, 0);
    const double little = at + 0.02e-6; // 1/25 of the error of the states
    ct_output_error_evaluate(&r, &at, &at, &little, &tolerance, 0.5);
    check_close("a negligible error, extrapolated", ct_output_error_extrapolated(&r, 0.5), 0,
                0);
    ct_arena_destroy(a);
}

// While the first steps grow, errors of states are far below their tolerance, and a ratio to them
// says nothing.
static void steps_that_are_still_growing_give_no_ratio(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    struct ct_output_error_record r = ct_output_error_record(a, CT_OUTPUTS_OF_STATES, 1);
    const struct ct_tolerance tolerance = {1e-6, 0};
    const double at = 1, off = at + 0.5e-6;
    ct_output_error_evaluate(&r, &at, &at, &off, &tolerance, 0.004);
    check_close("ratio at a 250th of the tolerance", r.ratio, 0, 0);
    ct_output_error_evaluate(&r, &at, &at, &off, &tolerance, 0.1);
    check_close("ratio at a tenth of the tolerance", r.ratio, 5, 1e-8);
    ct_arena_destroy(a);
}

// Round-off is measured by one more evaluation: in few of the estimates where it does not matter.
static void round_off_is_measured_in_few_estimates(void **unused)
{
    (void)unused;
    const struct looks looks = count_looks(CT_OUTPUTS_OF_STATES, 0.5, 4, 1.1);
    assert_int_equal(looks.n, 200);
    assert_in_range(looks.measured, 8, 25);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outputs_count_from_six_digits_on),
        cmocka_unit_test(the_last_digit_rejects_no_step),
        cmocka_unit_test(estimates_are_few_where_they_tell_nothing_new),
        cmocka_unit_test(an_output_that_errs_as_states_do_counts),
        cmocka_unit_test(steps_that_are_still_growing_give_no_ratio),
        cmocka_unit_test(round_off_is_measured_in_few_estimates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
