// The tolerance of steps in periodic motion: from how many periods on it is reduced, and by how much.
#include "tests/check.h"

#include "integrate/periodic_tolerance.h"

// The factor on the tolerance in a harmonic oscillation of so many periods in a run, after two of
// them.
static double factor_of(double periods)
{
    enum { STEPS = 200 };
    const double pi = acos(-1), end = 2 * pi * periods;
    const struct ct_tolerance tolerance = {1e-6, 1e-9};
    struct ct_periodic_tolerance r = ct_periodic_tolerance_start(0, end, &tolerance);
    const double y0[] = {1, 0};
    double y[] = {1, 0};
    for (int i = 1; i <= STEPS; i++) {
        const double t = 4 * pi * i / STEPS;
        const double y1[] = {cos(t), -sin(t)};
        ct_periodic_tolerance_step(&r, t, y0, y, y1, 1, 1);
        y[0] = y1[0];
        y[1] = y1[1];
    }
    return r.factor;
}

// A run of ten periods keeps its tolerance; with a hundred the error of a step acts on so many
// periods that the tolerance is less than a tenth.
static void long_runs_have_a_tolerance_that_falls_with_the_square_of_periods(void **unused)
{
    (void)unused;
    assert_true(factor_of(10) == 1);
    assert_true(factor_of(100) < 0.1);
    // one per cent: the periods counted so far are not whole
    CHECK_CLOSE(factor_of(1000) / factor_of(500), 0.25, 0.01, 0);
}

// A steady rotation has no periods, however many turns it makes.
static void rotations_are_no_periods(void **unused)
{
    (void)unused;
    const struct ct_tolerance tolerance = {1e-6, 1e-9};
    struct ct_periodic_tolerance r = ct_periodic_tolerance_start(0, 1e4, &tolerance);
    for (int i = 0; i < 1000; i++)
        ct_periodic_tolerance_step(&r, i + 1., (double[]){0, 1}, (double[]){i, 1},
                                   (double[]){i + 1., 1}, 1, 1);
    assert_true(r.factor == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_runs_have_a_tolerance_that_falls_with_the_square_of_periods),
        cmocka_unit_test(rotations_are_no_periods),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
