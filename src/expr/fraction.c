// See fraction.h.
#include "expr/fraction.h"
#include "base/pi.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// Limit on numerator times denominator. Derived: [v, 2 v] holds at most 0.3e9 such fractions and
// 4.5e15 doubles, so a random number lies within 8 doubles of a fraction with probability 10^-6.
static const double largest_product = 1e9;
// Default: divisors of beam elements, up to 138600, and few others are shown. Test: fraction.
static const double largest_divisor = 1e6;
// Derived: the result of up to sixteen operations, each rounded by half a unit in the last place.
static const double few_roundoffs = 8 * DBL_EPSILON;
// Derived: an integral over an element is a sum of up to 64 products; each product and each sum is
// rounded by half a unit.
static const double many_roundoffs = 64 * DBL_EPSILON;

static bool is_short(double v)
{
    char s[32];
    snprintf(s, sizeof s, "%.6g", v);
    return strtod(s, NULL) == v;
}

static bool nearest(double v, double tolerance, double *n, double *d)
{
    const double size = fabs(v);
    double p0 = 0, p = 1, q0 = 1, q = 0, x = size; // the last two convergents
    if (!(size < largest_product))
        return false;
    for (;;) {
        const double whole = floor(x), next_p = whole * p + p0, next_q = whole * q + q0;
        if (next_q > largest_divisor || next_p * next_q > largest_product)
            return false;
        p0 = p;
        q0 = q;
        p = next_p;
        q = next_q;
        if (p > 0 && fabs(p / q - size) <= tolerance * size)
            break;
        if (x == whole)
            return false;
        x = 1 / (x - whole);
    }
    *n = v < 0 ? -p : p;
    *d = q;
    return true;
}

// True if the divisor has no prime factors but 2 and 5: the fraction is then a finite decimal.
static bool is_decimal(double divisor)
{
    while (fmod(divisor, 2) == 0)
        divisor /= 2;
    while (fmod(divisor, 5) == 0)
        divisor /= 5;
    return divisor == 1;
}

bool ct_fraction_find(double v, double *n, double *d)
{
    return !is_short(v) && nearest(v, 0, n, d) && !is_decimal(*d);
}

// 0.21755580000000002 -> 0.2175558
static double without_noise(double v)
{
    char s[32];
    snprintf(s, sizeof s, "%.13g", v);
    const double rounded = strtod(s, NULL);
    return fabs(rounded - v) <= few_roundoffs / 2 * fabs(v) ? rounded : v;
}

double ct_fraction_snap(double v)
{
    double n, d;
    return !is_short(v) && nearest(v, few_roundoffs, &n, &d) ? n / d : v;
}

double ct_fraction_tidy(double v)
{
    double n, d;
    if (is_short(v))
        return v;
    return nearest(v, many_roundoffs, &n, &d) ? n / d : without_noise(v);
}

int ct_fraction_of_pi(double v, double *n, double *d)
{
    static const int powers[] = {1, 2, -1, -2};
    // Derived: four operands are rounded, by up to one unit each: the power, the division, v and
    // its source.
    const double tolerance = 4 * DBL_EPSILON;
    // Derived: there are 0.6e6 such fractions for each of four powers, so a random double lies near
    // one with probability 10^-9.
    const double most = 1000;
    for (size_t i = 0; i < sizeof powers / sizeof *powers && !is_short(v); i++)
        if (nearest(v / pow(CT_PI, powers[i]), tolerance, n, d) && fabs(*n) <= most
            && *d <= most)
            return powers[i];
    return 0;
}
