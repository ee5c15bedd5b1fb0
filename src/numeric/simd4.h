// SIMD vectors of four doubles.
//
// What always holds: each element is rounded as in scalar code. Vectors are passed by pointer,
// since the calling convention of a 256-bit vector depends on the target processor.
#ifndef CT_NUMERIC_SIMD4_H
#define CT_NUMERIC_SIMD4_H

enum { CT_SIMD4 = 4 }; // Definition: doubles in the type

#if defined(__GNUC__)

typedef double ct_simd4
    __attribute__((vector_size(CT_SIMD4 * sizeof(double)), aligned(sizeof(double)), may_alias));

#define CT_SIMD4_INLINE __attribute__((always_inline)) static inline

/// y (out) = c in all four.
CT_SIMD4_INLINE void ct_simd4_fill(ct_simd4 *y, double c)
{
    *y = (ct_simd4){c, c, c, c};
}

/// sum += x
CT_SIMD4_INLINE void ct_simd4_add(ct_simd4 *sum, const double *x)
{
    *sum += *(const ct_simd4 *)x;
}

/// sum += c x
CT_SIMD4_INLINE void ct_simd4_add_times(ct_simd4 *sum, double c, const double *x)
{
    *sum += c * *(const ct_simd4 *)x;
}

/// sum += x y, element by element.
CT_SIMD4_INLINE void ct_simd4_add_product(ct_simd4 *sum, const double *x, const double *y)
{
    *sum += *(const ct_simd4 *)x * *(const ct_simd4 *)y;
}

/// x (4, out)
CT_SIMD4_INLINE void ct_simd4_put(double *x, const ct_simd4 *y)
{
    *(ct_simd4 *)x = *y;
}

#else

typedef struct {
    double part[CT_SIMD4];
} ct_simd4;

#define CT_SIMD4_INLINE static inline

/// y (out) = c in all four.
CT_SIMD4_INLINE void ct_simd4_fill(ct_simd4 *y, double c)
{
    for (int i = 0; i < CT_SIMD4; i++)
        y->part[i] = c;
}

/// sum += x
CT_SIMD4_INLINE void ct_simd4_add(ct_simd4 *sum, const double *x)
{
    for (int i = 0; i < CT_SIMD4; i++)
        sum->part[i] += x[i];
}

/// sum += c x
CT_SIMD4_INLINE void ct_simd4_add_times(ct_simd4 *sum, double c, const double *x)
{
    for (int i = 0; i < CT_SIMD4; i++)
        sum->part[i] += c * x[i];
}

/// sum += x y, element by element.
CT_SIMD4_INLINE void ct_simd4_add_product(ct_simd4 *sum, const double *x, const double *y)
{
    for (int i = 0; i < CT_SIMD4; i++)
        sum->part[i] += x[i] * y[i];
}

/// x (4, out)
CT_SIMD4_INLINE void ct_simd4_put(double *x, const ct_simd4 *y)
{
    for (int i = 0; i < CT_SIMD4; i++)
        x[i] = y->part[i];
}

#endif

#endif
