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
 * The eigenvalues of OP of largest magnitude, to round-off.
 *
 * op      in   n unknowns
 * nev     in   number of eigenvalues wanted, nev > 0
 * room    in   bound on the dimension of the range of OP in the M-orthogonal complement of
 *              `converged`; room > 0
 * converged   in   n x nconverged, eigenvectors found before, of unit M-norm: the search is in
 *              their M-orthogonal complement
 * start   in   n, start vector
 * theta   out  nev, eigenvalues
 * V       out  n x nev, eigenvectors, V' M V = 1
 * a       in   workspace
 *
 * Returns the number of converged eigenvalues, fewer than nev if the dimension is too small; -1 if
 * ARPACK fails.
 */
int ct_arpack_largest(struct ct_arena *a, const struct ct_operator *op, int n, int nev,
                      int room, const double *converged, int nconverged, const double *start,
                      double *theta, double *V);

#endif
