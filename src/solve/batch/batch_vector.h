// Arithmetic on one number of each lane. Included where it is compiled for the processor's vectors:
// batch_step.c.
#ifndef CT_SOLVE_BATCH_BATCH_VECTOR_H
#define CT_SOLVE_BATCH_BATCH_VECTOR_H

#include "solve/batch/batch_internal.h"

#include <limits.h>
#include <math.h>

#ifdef __GNUC__
#pragma GCC diagnostic ignored                                                                 \
    "-Wpsabi" // all of this is compiled into the functions that call it
#endif

static inline set set_of(mask m)
{
    static const mask bit = {1, 2, 4, 8};
    const mask on = m & bit;
    return (set)(on[0] | on[1] | on[2] | on[3]);
}

static inline mask mask_of(set s)
{
    static const mask bit = {1, 2, 4, 8};
    const long long all = (long long)s;
    return ((mask){all, all, all, all} & bit) != 0;
}

static inline vec all_lanes(double v)
{
    return (vec){v, v, v, v};
}

// a where the mask is, else b.
static inline vec choose(mask m, vec a, vec b)
{
    return (vec)(((mask)a & m) | ((mask)b & ~m));
}

static inline vec magnitude(vec v)
{
    static const mask sign = {LLONG_MIN, LLONG_MIN, LLONG_MIN, LLONG_MIN};
    return (vec)((mask)v & ~sign);
}

// max(a, |v|) by lane; NaN in v is ignored.
static inline vec larger(vec a, vec v)
{
    const vec size = magnitude(v);
    return choose(size > a, size, a);
}

// min(a, |v|).
static inline vec smaller(vec a, vec v)
{
    const vec size = magnitude(v);
    return choose(size < a, size, a);
}

// Where all n numbers are finite: 0 * inf is NaN.
static inline mask is_finite(const vec *v, int n)
{
    vec zero = {0};
    for (int i = 0; i < n; i++)
        zero += 0 * v[i];
    return zero == 0;
}

static inline set finite(const vec *v, int n)
{
    return set_of(is_finite(v, n));
}

// Copies from (n) to `to` in these lanes.
static inline void put(vec *to, const vec *from, int n, set lanes)
{
    const mask m = mask_of(lanes);
    for (int i = 0; i < n; i++)
        to[i] = choose(m, from[i], to[i]);
}

static inline void copy(vec *to, const vec *from, int n)
{
    for (int i = 0; i < n; i++)
        to[i] = from[i];
}

#endif
