// Modes of large systems by sparse matrices: the lowest few eigenvalues only.
#ifndef CT_ANALYSIS_SPARSE_MODES_H
#define CT_ANALYSIS_SPARSE_MODES_H

#include "analysis/eigenvalues.h"
#include "analysis/sparse_linearization.h"

/**
 * Finds the lowest modes of a system at rest, without dampers and without forces that have no
 * potential. Loops are allowed if they have no drivers.
 *
 * Eigenvalues of [K - s M, J'; J, 0]^-1 M near the shift s are computed by ARPACK. Multiple
 * eigenvalues are found by repeated searches in the complement of the eigenvectors found
 * before.
 *
 * l     in   the state in l->y; matrices are not needed
 * mode  out  at most `count` modes, ascending
 * how   out  describes the method, for reports
 *
 * Sets *applies to false and does nothing else if the system is not of this kind or its
 * constraints are redundant.
 *
 * Errors   CT_E_SINGULAR
 * Source   Lehoucq, Sorensen and Yang (1998), key lehoucq1998
 */
bool ct_sparse_modes(struct ct_ctx *ctx, struct ct_arena *a, struct ct_linear *l, size_t count,
                     struct ct_motion_mode **mode, size_t *nmode, const char **how,
                     bool *applies);

/// Finds the `count` eigenvalues w2 [1/s^2] (out, ascending) of K y = w2 M y that are closest
/// to zero, at an equilibrium in l. False if there are fewer or the system is not of the kind
/// that ct_sparse_modes requires.
bool ct_sparse_modes_stiffness(struct ct_linear *l, size_t count, double *w2);

/**
 * Finds the lowest positive factors c with det(K + c (K_loaded - K)/factor) = 0 under the
 * constraints: the linear problem of buckling. K must be positive definite, which means that
 * the equilibrium without the load is stable; it is the metric of the search.
 *
 * l       in   at the equilibrium with factor 0, as ct_equilibrium_find_sparse leaves it
 * loaded  in   evaluated at the equilibrium with `factor`
 * c       out  count, ascending
 * shape   out  nu x count
 *
 * Returns the number of factors, which is 0 if the system is not of the kind that
 * ct_sparse_modes requires.
 */
size_t ct_sparse_modes_factors(struct ct_linear *l, const struct ct_point *loaded,
                               double factor, size_t count, double *c, double *shape);

#endif
