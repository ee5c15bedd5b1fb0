// Two numbers handled at once.
//
// What always holds: each has the roundings of its own, as if it were alone.
#ifndef CT_NUMERIC_PAIR_H
#define CT_NUMERIC_PAIR_H

enum { CT_PAIR = 2 };

#if defined(__GNUC__)

typedef double ct_pair
    __attribute__((vector_size(CT_PAIR * sizeof(double)), aligned(sizeof(double)), may_alias));

static inline ct_pair ct_pair_take(const double *x)
{
    return *(const ct_pair *)x;
}

static inline void ct_pair_put(double *x, ct_pair y)
{
    *(ct_pair *)x = y;
}

/// sum + c x
static inline ct_pair ct_pair_add(ct_pair sum, ct_pair x, double c)
{
    return sum + x * c;
}

/// sum + (x y)^2
static inline ct_pair ct_pair_add_square(ct_pair sum, ct_pair x, ct_pair y)
{
    const ct_pair product = x * y;
    return sum + product * product;
}

static inline double ct_pair_sum(ct_pair x)
{
    return x[0] + x[1];
}

#else

typedef struct {
    double part[CT_PAIR];
} ct_pair;

static inline ct_pair ct_pair_take(const double *x)
{
    return (ct_pair){{x[0], x[1]}};
}

static inline void ct_pair_put(double *x, ct_pair y)
{
    x[0] = y.part[0];
    x[1] = y.part[1];
}

/// sum + c x
static inline ct_pair ct_pair_add(ct_pair sum, ct_pair x, double c)
{
    return (ct_pair){{sum.part[0] + x.part[0] * c, sum.part[1] + x.part[1] * c}};
}

/// sum + (x y)^2
static inline ct_pair ct_pair_add_square(ct_pair sum, ct_pair x, ct_pair y)
{
    const double a = x.part[0] * y.part[0], b = x.part[1] * y.part[1];
    return (ct_pair){{sum.part[0] + a * a, sum.part[1] + b * b}};
}

static inline double ct_pair_sum(ct_pair x)
{
    return x.part[0] + x.part[1];
}

#endif

#endif
