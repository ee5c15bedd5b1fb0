// Sine and cosine of one angle, and of many at once with the same bits.
#ifndef CT_EXPR_SINCOS_H
#define CT_EXPR_SINCOS_H

#include <stddef.h>

/// s = sin(a), c = cos(a), each within 0.8 units in the last place. a [rad]; for |a| > 1e6 the
/// functions of the C library are used.
void ct_sincos(double a, double *s, double *c);
/// The same for n angles, four at a time on processors with AVX2. s, c and a must not overlap.
void ct_sincos_many(const double *a, double *s, double *c, size_t n);

#endif
