// Sine and cosine of one angle, and of many at once with the same bits.
#ifndef CT_EXPR_SINCOS_H
#define CT_EXPR_SINCOS_H

#include <stddef.h>

/// s = sin(a), c = cos(a), each within 0.8 units in the last place. a [rad]: any; beyond 1e6 those
/// of the C library.
void ct_sincos(double a, double *s, double *c);
/// The same for n angles, four at once where the processor can (AVX2). s, c and a must not overlap.
void ct_sincos_many(const double *a, double *s, double *c, size_t n);

#endif
