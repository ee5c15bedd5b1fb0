// SIMD vectors of two doubles.
//
// What always holds: each element is rounded as in scalar code.
#ifndef CT_NUMERIC_SIMD2_H
#define CT_NUMERIC_SIMD2_H

enum { CT_SIMD2 = 2 }; // Definition: doubles in the type

#if defined(__GNUC__)

typedef double ct_simd2
    __attribute__((vector_size(CT_SIMD2 * sizeof(double)), aligned(sizeof(double)), may_alias));

static inline ct_simd2 ct_simd2_load(const double *x)
{
    return *(const ct_simd2 *)x;
}

static inline void ct_simd2_store(double *x, ct_simd2 y)
{
    *(ct_simd2 *)x = y;
}

/// sum + c x
static inline ct_simd2 ct_simd2_add(ct_simd2 sum, ct_simd2 x, double c)
{
    return sum + x * c;
}

/// sum + (x y)^2
static inline ct_simd2 ct_simd2_add_square(ct_simd2 sum, ct_simd2 x, ct_simd2 y)
{
    const ct_simd2 product = x * y;
    return sum + product * product;
}

static inline double ct_simd2_sum(ct_simd2 x)
{
    return x[0] + x[1];
}

#else

typedef struct {
    double part[CT_SIMD2];
} ct_simd2;

static inline ct_simd2 ct_simd2_load(const double *x)
{
    return (ct_simd2){{x[0], x[1]}};
}

static inline void ct_simd2_store(double *x, ct_simd2 y)
{
    x[0] = y.part[0];
    x[1] = y.part[1];
}

/// sum + c x
static inline ct_simd2 ct_simd2_add(ct_simd2 sum, ct_simd2 x, double c)
{
    return (ct_simd2){{sum.part[0] + x.part[0] * c, sum.part[1] + x.part[1] * c}};
}

/// sum + (x y)^2
static inline ct_simd2 ct_simd2_add_square(ct_simd2 sum, ct_simd2 x, ct_simd2 y)
{
    const double a = x.part[0] * y.part[0], b = x.part[1] * y.part[1];
    return (ct_simd2){{sum.part[0] + a * a, sum.part[1] + b * b}};
}

static inline double ct_simd2_sum(ct_simd2 x)
{
    return x.part[0] + x.part[1];
}

#endif

#endif
