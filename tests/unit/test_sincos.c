// Own sine and cosine: within one unit in the last place, many at once with the bits of one.
#include "expr/sincos.h"
#include "random_ex.h"
#include "tests/check.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

// Error in units of the last place of what is wanted; long double has 11 bits more.
static double error_in_ulp(double got, long double want)
{
    const double w = fabs((double)want), ulp = nextafter(w, INFINITY) - w;
    return (double)(fabsl((long double)got - want) / ulp);
}

static const double most_error = 0.8; // units in the last place

static void check_angle(double a)
{
    double s, c;
    ct_sincos(a, &s, &c);
    const double e[2]
        = {error_in_ulp(s, sinl((long double)a)), error_in_ulp(c, cosl((long double)a))};
    if (e[0] > most_error || e[1] > most_error)
        fail_msg("at %.17g: errors of %.3f and %.3f units in the last place", a, e[0], e[1]);
}

static double uniform(struct random *r)
{
    return (double)random_below(r, 1u << 30) / (1u << 29) - 1;
}

static void errors_stay_below_one_unit_in_the_last_place(void **unused)
{
    (void)unused;
    static const double range[] = {1e-300, 1e-8, 0.1, 1, 4, 100, 1e4, 1e6, 1e9, 1e300};
    struct random r = random_start(__func__);
    if (LDBL_MANT_DIG < 64)
        skip(); // nothing to compare with
    for (size_t k = 0; k < sizeof range / sizeof *range; k++)
        for (int i = 0; i < 20000; i++)
            check_angle(range[k] * uniform(&r));
}

// Where one of them nearly vanishes, the reduction must keep the digits that cancel.
static void near_multiples_of_a_quarter_turn(void **unused)
{
    (void)unused;
    const long double quarter = 1.57079632679489661923132169163975144L;
    if (LDBL_MANT_DIG < 64)
        skip();
    for (long n = -600000; n <= 600000; n += n < -1000 || n > 1000 ? 997 : 1) {
        const double a = (double)((long double)n * quarter);
        check_angle(a);
        check_angle(nextafter(a, INFINITY));
        check_angle(nextafter(a, -INFINITY));
    }
}

static void many_have_the_bits_of_one(void **unused)
{
    (void)unused;
    enum { MOST = 23 };
    struct random r = random_start(__func__);
    double a[MOST], s[MOST + 1], c[MOST + 1];
    for (int round = 0; round < 2000; round++) {
        const size_t n = random_below(&r, MOST + 1);
        for (size_t i = 0; i < n; i++)
            a[i] = random_below(&r, 20) ? 50 * uniform(&r)
                 : random_below(&r, 2)  ? NAN
                                        : 1e12 * uniform(&r);
        s[n] = c[n] = 17;
        ct_sincos_many(a, s, c, n);
        for (size_t i = 0; i < n; i++) {
            double one[2];
            ct_sincos(a[i], &one[0], &one[1]);
            const bool same
                = !memcmp(&one[0], &s[i], sizeof *s) && !memcmp(&one[1], &c[i], sizeof *c);
            if (!same && !isnan(a[i]))
                fail_msg("%zu of %zu, at %.17g: %.17g %.17g, alone %.17g %.17g", i, n, a[i],
                         s[i], c[i], one[0], one[1]);
            assert_true(!isnan(a[i]) || (isnan(s[i]) && isnan(c[i])));
        }
        assert_true(s[n] == 17 && c[n] == 17); // nothing behind is written
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_stay_below_one_unit_in_the_last_place),
        cmocka_unit_test(near_multiples_of_a_quarter_turn),
        cmocka_unit_test(many_have_the_bits_of_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
