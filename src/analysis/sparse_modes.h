// Modes of large systems: sparse matrices, the lowest few eigenvalues only.
#ifndef CT_ANALYSIS_SPARSE_MODES_H
#define CT_ANALYSIS_SPARSE_MODES_H

#include "analysis/eigenvalues.h"
#include "analysis/sparse_linearization.h"

/**
 * The lowest modes of a system at rest without dampers and forces that have no potential; with
 * loops without drivers, too.
 *
 * Eigenvalues of [K - s M, J'; J, 0]^-1 M by ARPACK, next to the shift s. Equal eigenvalues are
 * found by searches in the complement of what was found before.
 *
 * l     in   the state in l->y; no matrices are needed
 * mode  out  `count` of them at most, ascending
 * how   out  for reports
 *
 * *applies is false, and nothing else is done, where the system is not of this kind or its
 * constraints are redundant.
 *
 * Errors   CT_E_SINGULAR
 * Source   Lehoucq, Sorensen and Yang (1998), key lehoucq1998
 */
bool ct_sparse_modes(struct ct_ctx *ctx, struct ct_arena *a, struct ct_linear *l, size_t count,
                     struct ct_motion_mode **mode, size_t *nmode, const char **how,
                     bool *applies);

/// The `count` eigenvalues w2 [1/s^2] (out, ascending) of K y = w2 M y next to zero, at an
/// equilibrium in l. False where there are fewer, or the system is not of the kind of
/// ct_sparse_modes.
bool ct_sparse_modes_stiffness(struct ct_linear *l, size_t count, double *w2);

/**
 * The lowest positive factors c with det(K + c (K_loaded - K)/factor) = 0 along the rows, the
 * linear problem of buckling.
 *
 * The same search with K as its metric. K is positive: the equilibrium without the load is stable.
 *
 * l       in   at the equilibrium with factor 0, as ct_equilibrium_find_sparse leaves it
 * loaded  in   evaluated at the equilibrium with `factor`
 * c       out  count, ascending
 * shape   out  nu x count
 *
 * Returns how many there are; 0, too, where the system is not of the kind of ct_sparse_modes.
 */
size_t ct_sparse_modes_factors(struct ct_linear *l, const struct ct_point *loaded,
                               double factor, size_t count, double *c, double *shape);

#endif
