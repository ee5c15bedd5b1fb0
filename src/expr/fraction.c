// See fraction.h.
#include "expr/fraction.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double largest_divisor = 5000, largest_number = 10000;
static const double few_roundings = 8 * DBL_EPSILON;

static bool is_short(double v)
{
    char s[32];
    snprintf(s, sizeof s, "%.6g", v);
    return strtod(s, NULL) == v;
}

static bool find(double v, double tolerance, double *n, double *d)
{
    const double size = fabs(v);
    double p0 = 0, p = 1, q0 = 1, q = 0, x = size; // the last two convergents
    if (!(size < largest_number) || is_short(v))
        return false;
    for (;;) {
        const double whole = floor(x), next_p = whole * p + p0, next_q = whole * q + q0;
        if (next_q > largest_divisor || next_p > largest_number)
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

bool ct_fraction_find(double v, double *n, double *d)
{
    return find(v, 0, n, d);
}

double ct_fraction_snap(double v)
{
    double n, d;
    return find(v, few_roundings, &n, &d) ? n / d : v;
}
