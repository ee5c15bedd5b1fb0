// Times behind the constants of src/numeric and src/expr that choose between two ways to the same
// result.
//
//     kernels
//
// Each line: the size, the time of one way and of the other [ns], of nine samples the least.
#include "expr/sincos.h"
#include "numeric/dense.h"
#include "numeric/inverse.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { MOST = 12, NSAMPLE = 9, NCALL = 20000, NSOLVE = 8 };

static double a[MOST * MOST], b[MOST * MOST], x[MOST * MOST], y[MOST * MOST];
static int pivot[MOST], size;

static void angles_alone(void)
{
    for (int i = 0; i < size; i++)
        ct_sincos(x[i], &y[i], &b[i]);
}

static void angles_together(void)
{
    ct_sincos_many(x, y, b, (size_t)size);
}

static void solve_inverse(void)
{
    memcpy(b, a, sizeof a);
    ct_inverse(b, pivot, size);
    for (int k = 0; k < NSOLVE; k++)
        ct_inverse_apply(y, b, x, size);
}

static void solve_factors(void)
{
    memcpy(b, a, sizeof a);
    ct_lu(b, pivot, size, size);
    for (int k = 0; k < NSOLVE; k++) {
        memcpy(y, x, (size_t)size * sizeof *y);
        ct_lu_solve(y, b, pivot, size, size, 1, size, false);
    }
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

static double time_of(void (*f)(void), int calls)
{
    double least = INFINITY;
    for (int s = 0; s < NSAMPLE; s++) {
        const double start = now();
        for (int i = 0; i < calls; i++)
            f();
        least = fmin(least, (now() - start) / calls);
    }
    return least;
}

static void compare(const char *what, void (*one)(void), void (*other)(void), int from, int to,
                    int calls)
{
    printf("%s\n", what);
    for (size = from; size <= to; size += 1)
        printf("  %3d %9.1f %9.1f\n", size, time_of(one, calls), time_of(other, calls));
}

int main(void)
{
    for (int i = 0; i < MOST * MOST; i++)
        a[i] = x[i] = sin(i + 1.0);
    compare("sines: ct_sincos each, ct_sincos_many", angles_alone, angles_together, 1, 8,
            NCALL);
    compare("factors and 8 solutions: ct_inverse, ct_lu", solve_inverse, solve_factors, 1, 12,
            NCALL / 20);
    return 0;
}
