// Static and steady equilibrium: a position in which the coordinates that no driver prescribes
// stay constant (theory 9.3).
#ifndef CT_ANALYSIS_EQUILIBRIUM_H
#define CT_ANALYSIS_EQUILIBRIUM_H

#include "analysis/linearization.h"

/// Relative size of a step [m, rad]: if a step is below this and not less than half the one
/// before, it is round-off and the search ends. Derived: from this size Newton's method reaches
/// round-off in one step.
#define CT_EQUILIBRIUM_FINE 1e-8

struct ct_equilibrium_result {
    int iterations;
    double last_step; // last step relative to the coordinates: the remaining error
};

/**
 * Finds the equilibrium that is reached by descending the potential from the position in l->y.
 * The speeds in l->y are kept.
 *
 * Each step is Newton's step with the opposite sign in directions of negative stiffness, so
 * that the forces do positive work along it. The length of a step is limited. A step is halved
 * while the forces at its end point back. Near a stable equilibrium this is Newton's method
 * with the exact stiffness. Forces without a potential can lead a descent in a circle; if there
 * are any, Newton's method alone is tried first.
 *
 * l     out  at the equilibrium, as ct_linear_rest leaves it
 *
 * Errors   CT_E_EQUILIBRIUM if none is found, naming the coordinate that still moves;
 * CT_E_SINGULAR
 * Source   Dauphin and others (2014) for the signs of the steps, key dauphin2014
 */
bool ct_equilibrium_find(struct ct_linear *l, struct ct_equilibrium_result *out);

/// The same for models with states, whose rates vanish as well, by Newton's method
/// (equilibrium_states.c).
bool ct_equilibrium_find_with_states(struct ct_linear *l, struct ct_equilibrium_result *out);

/// The same for systems too large for dense matrices, with sparse factors. The equations must
/// have a residual. Sets a and lam in l, but no matrices. If the system moves or sparse factors
/// are not available, sets *applies to false and searches nothing.
bool ct_equilibrium_find_sparse(struct ct_linear *l, struct ct_equilibrium_result *out,
                                bool *applies);

/// Newton's method alone, from a position near an equilibrium that may be unstable; for
/// following a path of equilibria. Uses sparse factors if l has no dense matrices. Then l has
/// no matrices at the end. No diagnostic.
bool ct_equilibrium_rates(struct ct_linear *l, struct ct_equilibrium_result *out);

#endif
