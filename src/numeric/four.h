// Four numbers handled at once.
//
// What always holds: each has the roundings of its own, as if it were alone. Only pointers are handed over, since how a four is handed
// over depends on what processor code is for.
#ifndef CT_NUMERIC_FOUR_H
#define CT_NUMERIC_FOUR_H

enum { CT_FOUR = 4 };

#if defined(__GNUC__)

typedef double ct_four
    __attribute__((vector_size(CT_FOUR * sizeof(double)), aligned(sizeof(double)), may_alias));

#define CT_FOUR_INLINE __attribute__((always_inline)) static inline

/// y (out) = c in all four.
CT_FOUR_INLINE void ct_four_fill(ct_four *y, double c)
{
    *y = (ct_four){c, c, c, c};
}

/// sum += x
CT_FOUR_INLINE void ct_four_add(ct_four *sum, const double *x)
{
    *sum += *(const ct_four *)x;
}

/// sum += c x
CT_FOUR_INLINE void ct_four_add_times(ct_four *sum, double c, const double *x)
{
    *sum += c * *(const ct_four *)x;
}

/// sum += x y, each with each
CT_FOUR_INLINE void ct_four_add_product(ct_four *sum, const double *x, const double *y)
{
    *sum += *(const ct_four *)x * *(const ct_four *)y;
}

/// x (4, out)
CT_FOUR_INLINE void ct_four_put(double *x, const ct_four *y)
{
    *(ct_four *)x = *y;
}

#else

typedef struct {
    double part[CT_FOUR];
} ct_four;

#define CT_FOUR_INLINE static inline

/// y (out) = c in all four.
CT_FOUR_INLINE void ct_four_fill(ct_four *y, double c)
{
    for (int i = 0; i < CT_FOUR; i++)
        y->part[i] = c;
}

/// sum += x
CT_FOUR_INLINE void ct_four_add(ct_four *sum, const double *x)
{
    for (int i = 0; i < CT_FOUR; i++)
        sum->part[i] += x[i];
}

/// sum += c x
CT_FOUR_INLINE void ct_four_add_times(ct_four *sum, double c, const double *x)
{
    for (int i = 0; i < CT_FOUR; i++)
        sum->part[i] += c * x[i];
}

/// sum += x y, each with each
CT_FOUR_INLINE void ct_four_add_product(ct_four *sum, const double *x, const double *y)
{
    for (int i = 0; i < CT_FOUR; i++)
        sum->part[i] += x[i] * y[i];
}

/// x (4, out)
CT_FOUR_INLINE void ct_four_put(double *x, const ct_four *y)
{
    for (int i = 0; i < CT_FOUR; i++)
        x[i] = y->part[i];
}

#endif

#endif
