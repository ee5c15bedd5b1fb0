// A few eigenvalues of large symmetric generalised problems by shift-invert Lanczos: a named
// wrapper of ARPACK.
//
// Source: Lehoucq, Sorensen and Yang (1998), key lehoucq1998.
#ifndef CT_NUMERIC_ARPACK_H
#define CT_NUMERIC_ARPACK_H

#include "base/arena.h"

#include <stdbool.h>

/// OP = (K - shift M)^-1 M, symmetric in the metric M.
struct ct_operator {
    void (*solve)(void *data, double *y, const double *f);  // y = (K - shift M)^-1 f
    void (*masses)(void *data, double *y, const double *x); // y = M x
    void *data;
};

/// The nev eigenvalues of OP that are largest by size, theta (nev, out), and vectors V (n x nev,
/// out) with V' M V = 1, in the complement of `known` (n x nknown), vectors of unit size found
/// before. start (n): where to begin. 0 < nev < n. Returns how many have converged; -1 where
/// ARPACK is not available or fails. What it needs meanwhile lives in a.
int ct_arpack_largest(struct ct_arena *a, const struct ct_operator *op, int n, int nev,
                      const double *known, int nknown, const double *start, double *theta,
                      double *V);

#endif
