// Numbers that are small fractions: 13/35, 11/210.
#ifndef CT_EXPR_FRACTION_H
#define CT_EXPR_FRACTION_H

#include <stdbool.h>

/// Is v the double nearest to a fraction *n / *d with d up to 10^6, |n d| up to 10^9, and no
/// decimal, which a person may have typed? Decimals: six digits, or divisors made of twos and
/// fives. Then n/d in double arithmetic gives the bits of v. Source: continued fractions; an
/// approximation closer than 1/(2 d^2) is one of their convergents.
bool ct_fraction_find(double v, double *n, double *d);

/// The double nearest to such a fraction within 8 eps of v; otherwise v.
double ct_fraction_snap(double v);

/// v for printing: such a fraction within 64 eps, or the decimal of 13 digits where v differs from
/// it by round-off; otherwise v.
double ct_fraction_tidy(double v);

/// The power k, 1, 2, -1 or -2, with v = *n / *d pi^k within 8 eps, n and d up to 1000; 0: none.
int ct_fraction_of_pi(double v, double *n, double *d);

#endif
