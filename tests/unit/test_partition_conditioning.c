// When a coordinate partitioning is chosen anew, when a projection is accurate enough, when fixed
// pivots are no longer trusted.  (6.3)
#include "tests/check.h"

#include "solve/constraint/partition_conditioning.h"

// A choice with kappa 2 and sigma 0.5, with or without redundant rows.
static bool is_degraded(double kappa, double sigma, bool is_redundant)
{
    return ct_partition_is_degraded(kappa, 2, sigma, 0.5, 0.5, is_redundant);
}

// Errors of dependent speeds are kappa times those of independent ones: a choice that costs a digit
// and a half is replaced, one that has lost a factor of five is not, as a choice makes a solver.
static void a_choice_that_loses_more_than_a_digit_is_replaced(void **unused)
{
    (void)unused;
    assert_false(is_degraded(10, 0.5, false));
    assert_true(is_degraded(60, 0.5, false));
    assert_false(is_degraded(2, 0.1, false));
    assert_true(is_degraded(2, 0.5 / 30, false));
}

// However poor the choice was when it was made.
static void no_choice_loses_more_than_four_digits(void **unused)
{
    (void)unused;
    assert_false(ct_partition_is_degraded(300, 200, 0.5, 0.5, 0.5, false));
    assert_true(ct_partition_is_degraded(5e3, 4e3, 0.5, 0.5, 0.5, false));
}

// Kept rows that become dependent while others are there to replace them give wrong accelerations
// in stages: they are replaced before they have lost a factor of four.
static void redundant_rows_are_chosen_anew_earlier(void **unused)
{
    (void)unused;
    assert_false(is_degraded(2, 0.3, true));
    assert_true(is_degraded(2, 0.5 / 4, true));
    assert_false(is_degraded(2, 0.5 / 4, false));
}

// Near a singular configuration a choice has a small sigma from the start. It lasts while sigma
// stays within a tenth, and is replaced when it has changed by a half, either way.
static void a_poor_choice_does_not_last(void **unused)
{
    (void)unused;
    assert_false(ct_partition_is_degraded(2, 2, 0.011, 0.01, 0.5, true));
    assert_true(ct_partition_is_degraded(2, 2, 0.015, 0.01, 0.5, true));
    assert_true(ct_partition_is_degraded(2, 2, 0.0065, 0.01, 0.5, true));
    assert_false(ct_partition_is_degraded(2, 2, 0.45, 0.3, 0.5, true));
}

// What a projection leaves is divided by sigma twice where sigma is a fifth or less, and not where
// it is nearly 1.
static void projections_are_more_accurate_near_singular_configurations(void **unused)
{
    (void)unused;
    const double left = 0.9 * ct_position_tolerance;
    assert_true(ct_is_projected(0.9, left, 1));
    assert_false(ct_is_projected(0.2, left, 1));
    assert_true(ct_is_projected(0.2, left * 0.2 * 0.2, 1));
}

// Strength of pivots at which they are no longer trusted, from 1 when sigma was found.
static double lowest_strength(bool is_alike, double at_sigma)
{
    const struct ct_strength s = {1, at_sigma, 1, is_alike};
    double low, high;
    ct_strength_range(&s, &low, &high);
    return low;
}

// Sigma is found anew when strength has halved; if both change alike, when it has fallen tenfold.
static void pivots_are_trusted_while_sigma_is_known(void **unused)
{
    (void)unused;
    assert_in_range((int)(100 * lowest_strength(false, 1)), 50, 90);
    assert_in_range((int)(100 * lowest_strength(true, 1)), 10, 40);
}

// Pivots of a thousandth leave thirteen digits; whatever sigma is, weaker ones are not used.
static void weak_pivots_are_not_trusted(void **unused)
{
    (void)unused;
    const double low = lowest_strength(true, 1e-6);
    assert_true(low > 2e-4 && low < 5e-3);
}

// Strength and sigma are taken to change alike if a change by a half has left their ratio within
// some per cent.
static void strength_extrapolates_sigma_where_both_change_alike(void **unused)
{
    (void)unused;
    struct ct_strength s = {0.5, 1, 1, false};
    ct_strength_compare(&s, 0.505);
    assert_true(s.is_alike);
    CHECK_CLOSE(ct_strength_sigma(&s), 0.505, 1e-15, 0); // one product and one quotient
    s.now = 0.25;
    ct_strength_compare(&s, 0.505 / 2 * 1.15);
    assert_false(s.is_alike);
    s = (struct ct_strength){0.999, 1, 1, true};
    ct_strength_compare(&s, 0.5); // a change that tells nothing
    assert_true(s.is_alike);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_choice_that_loses_more_than_a_digit_is_replaced),
        cmocka_unit_test(no_choice_loses_more_than_four_digits),
        cmocka_unit_test(redundant_rows_are_chosen_anew_earlier),
        cmocka_unit_test(a_poor_choice_does_not_last),
        cmocka_unit_test(projections_are_more_accurate_near_singular_configurations),
        cmocka_unit_test(pivots_are_trusted_while_sigma_is_known),
        cmocka_unit_test(weak_pivots_are_not_trusted),
        cmocka_unit_test(strength_extrapolates_sigma_where_both_change_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
