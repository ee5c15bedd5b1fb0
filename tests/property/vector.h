// Vectors of three numbers.
#ifndef CT_TEST_PROPERTY_VECTOR_H
#define CT_TEST_PROPERTY_VECTOR_H

#include <math.h>

struct vector {
    double e[3];
};

/// a + f b
static inline struct vector plus(struct vector a, double f, struct vector b)
{
    for (int i = 0; i < 3; i++)
        a.e[i] += f * b.e[i];
    return a;
}

static inline struct vector cross(struct vector a, struct vector b)
{
    struct vector c;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        c.e[i] = a.e[j] * b.e[k] - a.e[k] * b.e[j];
    }
    return c;
}

static inline double dot(struct vector a, struct vector b)
{
    return a.e[0] * b.e[0] + a.e[1] * b.e[1] + a.e[2] * b.e[2];
}

static inline double norm(struct vector a)
{
    return sqrt(dot(a, a));
}

#endif
