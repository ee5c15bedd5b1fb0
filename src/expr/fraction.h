// Recognition of doubles that are small fractions, such as 13/35 and 11/210.
#ifndef CT_EXPR_FRACTION_H
#define CT_EXPR_FRACTION_H

#include <stdbool.h>

/// Is v the double nearest to a fraction *n / *d with d up to 10^6 and |n d| up to 10^9? A v that a
/// person may have typed as a decimal is excluded: at most six digits, or d a product of twos and
/// fives. If true, n/d in double arithmetic gives v to the bit. Source: continued fractions; every
/// fraction closer to v than 1/(2 d^2) is one of the convergents.
bool ct_fraction_find(double v, double *n, double *d);

/// The double nearest to such a fraction, if one lies within 8 eps of v; otherwise v.
double ct_fraction_snap(double v);

/// v for printing: such a fraction if one lies within 64 eps; the decimal of 13 digits if v differs
/// from it by round-off only; otherwise v.
double ct_fraction_tidy(double v);

/// The exponent k of 1, 2, -1 or -2 for which v = (*n / *d) pi^k within 8 eps, n and d up to 1000;
/// 0 if there is none.
int ct_fraction_of_pi(double v, double *n, double *d);

#endif
