// Numbers recognised as fractions, and how they are printed.
#include "expr/fraction.h"
#include "expr/print.h"
#include "tests/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void fractions_have_the_bits_of_their_quotient(void **state)
{
    (void)state;
    static const double number[][2]
        = {{13, 35},     {11, 210}, {1, 3},     {-26, 35},    {2, 105},     {1, 420},
           {4999, 4998}, {9999, 7}, {17, 3780}, {37, 103950}, {151, 138600}};
    for (size_t i = 0; i < COUNT(number); i++) {
        const double v = number[i][0] / number[i][1];
        double n, d;
        assert_true(ct_fraction_find(v, &n, &d));
        assert_true(n / d == v && d <= 1000000);
        // a neighbour is another number, though near enough to be one spoiled by round-off
        const double next = nextafter(v, 1e9);
        assert_false(ct_fraction_find(next, &n, &d));
        assert_true(ct_fraction_snap(next) == v);
        assert_true(ct_fraction_tidy(v * (1 + 5e-15)) == v);
        assert_true(ct_fraction_tidy(v * (1 + 1e-13)) == v * (1 + 1e-13));
    }
}

static void decimals_and_other_numbers_are_none(void **state)
{
    (void)state;
    static const double number[] = {0,
                                    1,
                                    -3,
                                    0.35,
                                    0.05,
                                    1e-8,
                                    9.81,
                                    152e-3,
                                    7e10,
                                    3.1415926535897931,
                                    INFINITY,
                                    NAN,
                                    1e300,
                                    1.4142135623730951,
                                    1e-300,
                                    1.0 / 1000003,
                                    20000000003.0 / 3};
    for (size_t i = 0; i < COUNT(number); i++) {
        double n, d;
        assert_false(ct_fraction_find(number[i], &n, &d));
    }
}

static void parts_of_pi_are_found_and_printed(void **state)
{
    (void)state;
    const double pi = 3.14159265358979323846;
    const double v[]
        = {pi, 2 * pi, -pi / 3, 4 * pi * pi, 1 / (2 * pi), 0.2 * pi, 1 / (pi * pi)};
    static const char *const text[]
        = {"pi*m", "2*pi*m", "-pi*m/3", "4*pi^2*m", "m/(2*pi)", "pi*m/5", "m/pi^2"};
    struct ct_arena *a = ct_arena_create();
    struct ct_exs x;
    ct_exs_init(&x, a);
    const ct_ex m = ct_ex_sym(&x, CT_SYM_PARAM, "m", 0);
    const struct ct_print p = {.fractions = true};
    for (size_t i = 0; i < COUNT(v); i++) {
        double n, d;
        const int k = ct_fraction_of_pi(v[i], &n, &d);
        assert_true(k != 0 && fabs(n / d * pow(pi, k) - v[i]) <= 1e-15 * fabs(v[i]));
        assert_string_equal(ct_ex_text(a, &x, ct_ex_mul(&x, ct_ex_const(&x, v[i]), m), &p),
                            text[i]);
    }
    static const double none[]
        = {0, 1, 3.14, 3.1416, 6.2831853, 2.718281828459045, 9.81, 1e300};
    for (size_t i = 0; i < COUNT(none); i++) {
        double n, d;
        assert_int_equal(ct_fraction_of_pi(none[i], &n, &d), 0);
    }
    ct_arena_destroy(a);
}

static void noise_of_rounding_is_not_shown(void **state)
{
    (void)state;
    assert_true(ct_fraction_tidy(0.21755580000000002) == 0.2175558);
    assert_true(ct_fraction_tidy(4.000000000000001) == 4);
    assert_true(ct_fraction_tidy(0.12345678901234567) == 0.12345678901234567);
    assert_true(ct_fraction_tidy(9.81) == 9.81);
    assert_true(ct_fraction_tidy(0) == 0);
    assert_true(isinf(ct_fraction_tidy(INFINITY)) && isnan(ct_fraction_tidy(NAN)));
}

// Text and LaTeX show fractions if asked; C never does: its bits are those of the constant.
static void fractions_are_printed_for_people_only(void **state)
{
    (void)state;
    struct ct_arena *a = ct_arena_create();
    struct ct_exs x;
    ct_exs_init(&x, a);
    const ct_ex m = ct_ex_sym(&x, CT_SYM_PARAM, "m", 0);
    const ct_ex k = ct_ex_const(&x, 13.0 / 35);
    const ct_ex e[] = {ct_ex_mul(&x, k, m), ct_ex_add(&x, m, ct_ex_const(&x, 1.0 / 3)),
                       ct_ex_pow(&x, m, ct_ex_const(&x, -1.0 / 3)), k};
    static const char *const text[] = {"13*m/35", "m + 1/3", "m^(-1/3)", "13/35"};
    static const char *const latex[]
        = {"\\frac{13 m}{35}", "m + \\frac{1}{3}", "m^{-\\frac{1}{3}}", "\\frac{13}{35}"};
    static const char *const c[] = {"0.37142857142857144 * m", "m + 0.33333333333333331",
                                    "pow(m, (-0.33333333333333331))", "0.37142857142857144"};
    for (size_t i = 0; i < COUNT(e); i++) {
        struct ct_print p = {.fractions = true};
        assert_string_equal(ct_ex_text(a, &x, e[i], &p), text[i]);
        p.style = CT_PRINT_LATEX;
        assert_string_equal(ct_ex_text(a, &x, e[i], &p), latex[i]);
        p.style = CT_PRINT_C;
        assert_string_equal(ct_ex_text(a, &x, e[i], &p), c[i]);
        p = (struct ct_print){0};
        assert_null(strchr(ct_ex_text(a, &x, e[i], &p), '/'));
    }
    ct_arena_destroy(a);
}

// A part of a fraction that is wider than a line of a page is printed as a factor: lines break
// there, not in \frac.
static void wide_fractions_are_products(void **state)
{
    (void)state;
    struct ct_arena *a = ct_arena_create();
    struct ct_exs x;
    ct_exs_init(&x, a);
    const ct_ex m = ct_ex_sym(&x, CT_SYM_PARAM, "m", 0);
    ct_ex narrow = m, wide = m;
    for (int i = 0; i < CT_LATEX_LINE; i++) {
        const ct_ex k = ct_ex_sym(&x, CT_SYM_PARAM, ct_arena_printf(a, "k%d", i), 0);
        wide = ct_ex_add(&x, wide, k);
        narrow = i ? narrow : ct_ex_add(&x, narrow, k);
    }
    const struct {
        ct_ex above, below;
        const char *start, *end; // of the text
    } of[] = {
        {narrow, m, "\\frac{", "}{m}"},
        {wide, m, "\\frac{1}{m} \\, \\left(", "\\right)"},
        {ct_ex_scale(&x, 3, wide), m, "\\frac{3}{m} \\, \\left(", "\\right)"},
        {ct_ex_mul(&x, m, wide), narrow, "\\frac{1}{m + k_{0}} \\, m \\, \\left(", "\\right)"},
        {m, wide, "m \\, \\left(", "\\right)^{-1}"},
        {CT_EX_ONE, wide, "\\left(", "\\right)^{-1}"},
    };
    const struct ct_print p = {.fractions = true, .style = CT_PRINT_LATEX};
    for (size_t i = 0; i < COUNT(of); i++) {
        const char *s = ct_ex_text(a, &x, ct_ex_div(&x, of[i].above, of[i].below), &p);
        const size_t n = strlen(s), end = strlen(of[i].end);
        assert_memory_equal(s, of[i].start, strlen(of[i].start));
        assert_true(n >= end);
        assert_string_equal(s + n - end, of[i].end);
    }
    ct_arena_destroy(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fractions_have_the_bits_of_their_quotient),
        cmocka_unit_test(decimals_and_other_numbers_are_none),
        cmocka_unit_test(noise_of_rounding_is_not_shown),
        cmocka_unit_test(wide_fractions_are_products),
        cmocka_unit_test(parts_of_pi_are_found_and_printed),
        cmocka_unit_test(fractions_are_printed_for_people_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
