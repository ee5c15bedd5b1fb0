// What errors of states mean for outputs, as the control of steps is told.  (8.6)
#include "tests/unit/integration.h"

#include "solve/output_error/output_error.h"

#include <float.h>

// The error of an output that is so many of its round-off errors, wholly wrong.
static double judge(double roundoffs)
{
    const struct ct_tolerance tolerance = {1e-6, 1e-12};
    const double at = 1, off = 2,
                 probed = at + ct_output_error_perturbation(0) / (DBL_EPSILON * roundoffs);
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
    check_below("error of an output of five digits", judge(2e5), 0);
    check_below("what an output of seven digits lacks", 1, judge(5e6));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(outputs_count_from_six_digits_on)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
