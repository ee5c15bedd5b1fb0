// Sparse factors: when pivots are kept, and when solutions are refined.
#include "numeric/factors.h"
#include "numeric/sparse.h"
#include "tests/check.h"

static const int row[] = {0, 1, 0, 1}, column[] = {0, 0, 1, 1};

// [a 1; 1 1] by columns: with a as the first pivot the last one is 1 - 1/a, growth 1/a
static void set(double value[4], double a)
{
    value[0] = a;
    value[1] = value[2] = 1;
    value[3] = -1;
}

// Three of sixteen digits may be lost.
static void pivots_are_kept_up_to_a_growth_of_1000(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    int place[4], first[] = {0, 1};
    double value[4];
    struct ct_pattern *p = ct_pattern_create(a, 2, row, column, 4, place);
    set(value, 1);
    if (!ct_pattern_order(a, p, value, first)) { // without KLU
        ct_arena_destroy(a);
        skip();
    }
    struct ct_factors *f = ct_factors_create(a, p, false);
    assert_true(ct_factors_compute(f, value));
    assert_int_equal(ct_factors_npivoting(f), 1);
    set(value, 1. / 300);
    assert_true(ct_factors_compute(f, value));
    assert_int_equal(ct_factors_npivoting(f), 1);
    set(value, 1. / 3000);
    assert_true(ct_factors_compute(f, value));
    assert_int_equal(ct_factors_npivoting(f), 2);
    ct_arena_destroy(a);
}

// Backward error of a solution whose first pivot is a against entries of 1.
static double error_of(struct ct_sparse *s, double a, bool *is_refined)
{
    double value[4], x[2], worst = 0;
    *is_refined = false;
    for (int k = 1; k < 100; k++) {
        bool refined = false;
        set(value, a * (1 + 0.01 * k));
        assert_true(ct_sparse_factor(s, value));
        const double b[] = {1, 1. / k};
        const double error = ct_sparse_solve(s, x, b, &refined);
        *is_refined = *is_refined || refined;
        worst = error > worst ? error : worst;
    }
    return worst;
}

// What elimination leaves is some units of round-off times the growth.
static void solutions_are_refined_where_pivots_are_small(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    struct ct_sparse *s = ct_sparse_create(a, 2, row, column, 4, CT_SPARSE_DIAGONAL);
    double value[4];
    bool is_refined;
    if (!s) {
        ct_arena_destroy(a);
        skip();
    }
    set(value, 1);
    assert_true(ct_sparse_factor(s, value));
    // some units, and some hundred
    assert_true(error_of(s, 1. / 16, &is_refined) < 1e-14);
    assert_false(is_refined);
    for (double pivot = 1. / 256; pivot > 1e-5; pivot /= 2) {
        assert_true(error_of(s, pivot, &is_refined) < 1e-14);
        assert_true(is_refined);
    }
    ct_arena_destroy(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pivots_are_kept_up_to_a_growth_of_1000),
        cmocka_unit_test(solutions_are_refined_where_pivots_are_small),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
