// Shortest decimals: the table of powers of ten, and that numbers read back, from the fewest
// digits, the closest ones.
#include "base/decimal.h"
#include "tests/check.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

// ---- the table ------------------------------------------------------------------------------

// A whole number, words of 32 bits, the lowest first. Room for 2^1088.
enum { WORDS = 36, BITS = 1088 };
struct whole {
    uint32_t w[WORDS];
};

static void multiply(struct whole *n, uint32_t by)
{
    uint64_t carry = 0;
    for (int i = 0; i < WORDS; i++) {
        carry += (uint64_t)n->w[i] * by;
        n->w[i] = (uint32_t)carry;
        carry >>= 32;
    }
    assert_int_equal(carry, 0);
}

static bool divide(struct whole *n, uint32_t by)
{
    uint64_t rest = 0;
    for (int i = WORDS; i-- > 0;) {
        rest = rest << 32 | n->w[i];
        n->w[i] = (uint32_t)(rest / by);
        rest %= by;
    }
    return rest != 0;
}

// The 128 leading bits, rounded upwards where bits below them, or a rest, are not 0.
static void leading_bits(const struct whole *n, bool has_rest, uint64_t g[2])
{
    int top = WORDS * 32 - 1;
    while (!(n->w[top / 32] >> top % 32 & 1))
        top--;
    g[0] = g[1] = 0;
    for (int i = 0; i < 128; i++) {
        const int at = top - i;
        const uint64_t bit = at >= 0 ? n->w[at / 32] >> at % 32 & 1 : 0;
        g[i / 64] = g[i / 64] << 1 | bit;
    }
    for (int at = top - 128; at >= 0; at--)
        has_rest |= n->w[at / 32] >> at % 32 & 1;
    if (has_rest && ++g[1] == 0)
        g[0]++;
}

static void the_table_holds_powers_of_ten(void **state)
{
    (void)state;
    uint64_t g[2];
    struct whole n = {{1}};
    for (int k = 0; k <= 324; k++, multiply(&n, 5)) { // 10^k = 5^k 2^k
        leading_bits(&n, false, g);
        assert_memory_equal(g, ct_decimal_power(k), sizeof g);
    }
    n = (struct whole){{0}};
    n.w[BITS / 32] = 1;
    bool has_rest = false;
    for (int k = -1; k >= -292;
         k--) { // the rest of the rest: floor(floor(n / 5) / 5) = floor(n / 25)
        has_rest |= divide(&n, 5);
        leading_bits(&n, has_rest, g);
        assert_memory_equal(g, ct_decimal_power(k), sizeof g);
    }
}

// ---- numbers --------------------------------------------------------------------------------

static void check_text(double v, const char *want)
{
    char text[CT_DECIMAL_SIZE];
    assert_int_equal(ct_decimal_format(text, v), strlen(want));
    assert_string_equal(text, want);
}

static void numbers_have_the_form_of_printf(void **state)
{
    (void)state;
    check_text(0, "0");
    check_text(-0.0, "-0");
    check_text(0.1, "0.1");
    check_text(1.0 / 3, "0.3333333333333333");
    check_text(-2.5, "-2.5");
    check_text(100, "100");
    check_text(1e16, "10000000000000000");
    check_text(1e17, "1e+17");
    check_text(9007199254740993.0, "9007199254740992");
    check_text(1e-4, "0.0001");
    check_text(0.00012345, "0.00012345");
    check_text(1.5e-5, "1.5e-05");
    check_text(1e23, "1e+23");
    check_text(9.5e-300, "9.5e-300");
    check_text(DBL_MAX, "1.7976931348623157e+308");
    check_text(DBL_MIN, "2.2250738585072014e-308");
    check_text(4.9406564584124654e-324, "5e-324");
}

static uint64_t next(uint64_t *s) // SplitMix64
{
    uint64_t z = *s += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

// Of all exponents: any fraction, powers of two and their neighbours, integers, decimals of few
// digits.
static double draw(uint64_t *s, long i)
{
    const uint64_t fraction = (UINT64_C(1) << 52) - 1;
    uint64_t bits = next(s) & (UINT64_MAX >> 1);
    double v;
    if (i % 6 == 1)
        bits &= ~fraction;
    else if (i % 6 == 2)
        bits |= fraction;
    if (i % 6 == 3)
        return (double)(bits >> next(s) % 63);
    memcpy(&v, &bits, sizeof v);
    if (i % 6 == 4 && isfinite(v)) {
        char text[40];
        snprintf(text, sizeof text, "%.*g", 1 + (int)(next(s) % 16), v);
        v = strtod(text, NULL);
    }
    return v;
}

// The digits of v rounded to n of them, by printf.
static double rounded(char digit[24], double v, int n)
{
    char text[48];
    snprintf(text, sizeof text, "%.*e", n - 1, v);
    int count = 0;
    for (const char *p = text; *p != 'e'; p++)
        if (*p >= '0' && *p <= '9')
            digit[count++] = *p;
    digit[count] = 0;
    return strtod(text, NULL);
}

// CT_DECIMALS: how many.
static void random_numbers_are_shortest_and_closest(void **state)
{
    (void)state;
    const char *wanted = getenv("CT_DECIMALS");
    const long n = wanted ? (long)atof(wanted) : 300000;
    uint64_t seed = 2021;
    for (long i = 0; i < n; i++) {
        const double v = draw(&seed, i);
        char text[CT_DECIMAL_SIZE], digit[24], by_printf[24];
        if (!isfinite(v))
            continue;
        ct_decimal_format(text, v);
        const double back = strtod(text, NULL);
        assert_memory_equal(&back, &v, sizeof v);
        const int count = snprintf(digit, sizeof digit, "%llu",
                                   (unsigned long long)ct_decimal_shortest(v).digits);
        if (count > 1 && rounded(by_printf, v, count - 1) == v)
            fail_msg("%s: fewer digits read back", text);
        // where the closest decimal of so many digits reads back, it is the one
        if (rounded(by_printf, v, count) == v && strcmp(by_printf, digit) != 0)
            fail_msg("%s: %s is closer", text, by_printf);
    }
}

static void a_number_takes_a_fifth_of_a_microsecond_at_most(void **state)
{
    (void)state;
    enum { N = 200000 };
    char text[CT_DECIMAL_SIZE];
    uint64_t seed = 7;
    double best = INFINITY;
    for (int repeat = 0; repeat < 5; repeat++) {
        const clock_t start = clock();
        for (int i = 0; i < N; i++)
            ct_decimal_format(text, (double)next(&seed) * 0x1p-63 - 1);
        best = fmin(best, (double)(clock() - start) / CLOCKS_PER_SEC / N);
    }
    print_message("%.3f us a number\n", 1e6 * best);
#ifdef __OPTIMIZE__ // and without sanitizers
    assert_true(best < 0.2e-6);
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_table_holds_powers_of_ten),
        cmocka_unit_test(numbers_have_the_form_of_printf),
        cmocka_unit_test(random_numbers_are_shortest_and_closest),
        cmocka_unit_test(a_number_takes_a_fifth_of_a_microsecond_at_most),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
