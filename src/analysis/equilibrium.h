// Static and steady equilibrium: the place where the unknown coordinates stay.  (formulation 9.3)
#ifndef CT_ANALYSIS_EQUILIBRIUM_H
#define CT_ANALYSIS_EQUILIBRIUM_H

#include "analysis/linearization.h"

struct ct_equilibrium_result {
    int iterations;
    double last_step; // of the coordinates, against their size: what is left
};

/**
 * From the place in l->y down to the nearest equilibrium; the speeds in l->y are held.
 *
 * Each step goes to where the forces, linearised, vanish, but against them where the stiffness is negative, so that
 * it always does work; it is limited, and halved while it goes past the place where the forces turn round. Beside a
 * stable equilibrium this is Newton's method with the exact stiffness. Forces without a potential may push round in a circle:
 * with them Newton's method alone comes first.
 *
 * held  in   nu, true for coordinates that keep their values; NULL: none
 * l     out  at the equilibrium, by ct_linear_rest
 *
 * Errors   CT_E_EQUILIBRIUM when none is found, naming what moves; CT_E_SINGULAR
 * Source   Dauphin and others (2014) for the sign of the steps, key dauphin2014
 */
bool ct_equilibrium_find(struct ct_linear *l, const bool *held,
                         struct ct_equilibrium_result *out);

/// The same of systems too large for full matrices, with sparse factors. The equations have the rows of their residual.
/// Leaves a and lam in l, no matrices. *applies is false, and no equilibrium is sought, where something moves, or
/// factors are not available.
bool ct_equilibrium_find_sparse(struct ct_linear *l, struct ct_equilibrium_result *out,
                                bool *applies);

/// Say that none is found, and that the coordinate of speed k goes on to move: CT_E_EQUILIBRIUM.
bool ct_equilibrium_missing(const struct ct_linear *l, int k);

/// Newton alone, from a place next to an equilibrium, stable or not: along a path of loads. No diagnostic.
bool ct_equilibrium_rates(struct ct_linear *l, struct ct_equilibrium_result *out);
/// The same of large systems: no matrices are left in l.
bool ct_equilibrium_rates_sparse(struct ct_linear *l, struct ct_equilibrium_result *out);

#endif
