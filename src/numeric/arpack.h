// A few eigenvalues of large symmetric generalised problems by shift-invert Lanczos: a named
// wrapper of ARPACK.
//
// Source: Lehoucq, Sorensen and Yang (1998), key lehoucq1998.
#ifndef CT_NUMERIC_ARPACK_H
#define CT_NUMERIC_ARPACK_H

#include "base/arena.h"

#include <stdbool.h>

/// A linear operator OP that is symmetric in the inner product of M: x' M OP y = y' M OP x. M may
/// be singular if OP maps its null space to 0.
struct ct_operator {
    /// y (n, out) = OP x; Mx (n) = M x
    void (*apply)(void *data, double *y, const double *x, const double *Mx);
    /// y (n, out) = M x
    void (*metric)(void *data, double *y, const double *x);
    void *data;
};

/**
 * The eigenvalues of OP that are largest by size, to round-off.
 *
 * op      in   n unknowns
 * nev     in   how many are wanted, nev > 0
 * room    in   no more independent vectors are in the range of OP and M-orthogonal to `converged`;
 *              room > 0
 * converged   in   n x nconverged, vectors found before, unit in M: the search is in their
 *              complement
 * start   in   n, where to begin
 * theta   out  nev
 * V       out  n x nev, V' M V = 1
 * a       in   workspace
 *
 * Returns how many have converged, fewer than nev where there is no room for more; -1 where ARPACK
 * fails.
 */
int ct_arpack_largest(struct ct_arena *a, const struct ct_operator *op, int n, int nev,
                      int room, const double *converged, int nconverged, const double *start,
                      double *theta, double *V);

#endif
