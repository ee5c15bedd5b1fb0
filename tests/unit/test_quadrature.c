// Gauss-Legendre points and integrals of expressions.
#include "expr/quadrature.h"
#include "tests/check.h"

struct fixture {
    struct ct_arena *a;
    struct ct_exs x;
    ct_ex s, p;
};

static void begin(struct fixture *f)
{
    f->a = ct_arena_create();
    ct_exs_init(&f->x, f->a);
    f->p = ct_ex_sym(&f->x, CT_SYM_PARAM, "p", 0);
    f->s = ct_ex_sym(&f->x, CT_SYM_LOCAL, "s", 0);
}

// The two-point rule is 1/2 -+ 1/(2 sqrt 3), the three-point rule 1/2 -+ sqrt(3/5)/2 with 5/18,
// 8/18, 5/18.
static void points_of_small_rules_are_known_numbers(void **unused)
{
    (void)unused;
    double p[3], w[3];
    ct_gauss(1, p, w);
    CHECK_CLOSE(p[0], 0.5, 1e-15, 0);
    CHECK_CLOSE(w[0], 1, 1e-15, 0);
    ct_gauss(2, p, w);
    CHECK_CLOSE(p[0], 0.5 - 0.5 / sqrt(3), 1e-15, 0);
    CHECK_CLOSE(w[1], 0.5, 1e-15, 0);
    ct_gauss(3, p, w);
    CHECK_CLOSE(p[2], 0.5 + 0.5 * sqrt(0.6), 1e-15, 0);
    CHECK_CLOSE(w[0], 5.0 / 18, 1e-14, 0);
    CHECK_CLOSE(w[1], 8.0 / 18, 1e-14, 0);
}

// x^k over (0, 1) is 1/(k + 1) for k < 2 n and is missed at k = 2 n, where n is small.
static void a_rule_is_exact_up_to_its_degree(void **unused)
{
    (void)unused;
    double p[CT_GAUSS_MOST], w[CT_GAUSS_MOST];
    for (int n = 1; n <= CT_GAUSS_MOST; n++) {
        ct_gauss(n, p, w);
        for (int k = 0; k <= 2 * n; k++) {
            double sum = 0;
            for (int i = 0; i < n; i++)
                sum += w[i] * pow(p[i], k);
            if (k < 2 * n)
                CHECK_CLOSE(sum, 1.0 / (k + 1), 2e-14, 0); // n terms, points to an eps
            else if (n < 8)
                assert_true(fabs(sum - 1.0 / (k + 1)) > 1e-11);
        }
        for (int i = 1; i < n; i++)
            assert_true(p[i] > p[i - 1]);
    }
}

static void degrees_are_those_of_polynomials_as_written(void **unused)
{
    (void)unused;
    struct fixture f;
    begin(&f);
    struct ct_exs *x = &f.x;
    const ct_ex linear = ct_ex_sub(x, f.p, ct_ex_mul(x, f.p, f.s));
    const ct_ex cubed = ct_ex_pow(x, linear, ct_ex_const(x, 3));
    assert_int_equal(ct_ex_degree(x, f.p, f.s), 0);
    assert_int_equal(ct_ex_degree(x, linear, f.s), 1);
    assert_int_equal(ct_ex_degree(x, cubed, f.s), 3);
    assert_int_equal(ct_ex_degree(x, ct_ex_mul(x, cubed, linear), f.s), 4);
    assert_int_equal(ct_ex_degree(x, ct_ex_div(x, cubed, f.p), f.s), 3);
    assert_int_equal(ct_ex_degree(x, ct_ex_fun(x, CT_OP_SIN, f.p), f.s), 0);
    assert_int_equal(ct_ex_degree(x, ct_ex_div(x, f.p, linear), f.s), -1);
    assert_int_equal(ct_ex_degree(x, ct_ex_fun(x, CT_OP_SQRT, linear), f.s), -1);
    assert_int_equal(ct_ex_degree(x, ct_ex_pow(x, f.s, f.p), f.s), -1);
    // constant by pieces is no polynomial
    const ct_ex jump = ct_ex_if(x, ct_ex_fun2(x, CT_OP_LT, f.s, f.p), CT_EX_ONE, CT_EX_ZERO);
    assert_int_equal(ct_ex_degree(x, jump, f.s), -1);
    ct_arena_destroy(f.a);
}

// int_p^2p (1 - s)^3 ds at p = 0.25 and of exp(s) with 8 points: the remainder is 1e-20.
static void integrals_are_expressions_of_what_is_left(void **unused)
{
    (void)unused;
    struct fixture f;
    begin(&f);
    struct ct_exs *x = &f.x;
    const ct_ex cubed = ct_ex_pow(x, ct_ex_sub(x, CT_EX_ONE, f.s), ct_ex_const(x, 3));
    const double value[] = {0.25, 0};
    const ct_ex to = ct_ex_scale(x, 2, f.p);
    CHECK_CLOSE(ct_ex_value(x, ct_ex_integral(x, cubed, f.s, f.p, to, 2), value),
                (pow(0.75, 4) - pow(0.5, 4)) / 4, 1e-14, 0);
    const ct_ex grows = ct_ex_fun(x, CT_OP_EXP, f.s);
    const ct_ex integral = ct_ex_integral(x, grows, f.s, f.p, to, 8);
    CHECK_CLOSE(ct_ex_value(x, integral, value), exp(0.5) - exp(0.25), 1e-14, 0);
    assert_int_equal(ct_ex_kinds(x, integral), 1u << CT_SYM_PARAM);
    ct_arena_destroy(f.a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_of_small_rules_are_known_numbers),
        cmocka_unit_test(a_rule_is_exact_up_to_its_degree),
        cmocka_unit_test(degrees_are_those_of_polynomials_as_written),
        cmocka_unit_test(integrals_are_expressions_of_what_is_left),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
