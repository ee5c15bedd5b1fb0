// Static and steady equilibrium: the position in which the unknown coordinates stay (theory 9.3).
#ifndef CT_ANALYSIS_EQUILIBRIUM_H
#define CT_ANALYSIS_EQUILIBRIUM_H

#include "analysis/linearization.h"

/// [m, rad] From here on a step that is not shorter than half the last one ends the search: it
/// is round-off. Derived: Newton's method goes from there to round-off in one step.
#define CT_EQUILIBRIUM_FINE 1e-8

struct ct_equilibrium_result {
    int iterations;
    double last_step; // of the coordinates, against their size: what is left
};

/**
 * The equilibrium that is reached from the position in l->y down the potential; the speeds in
 * l->y are held.
 *
 * Each step is that of Newton's method, with the opposite sign in directions of negative
 * stiffness, so that the forces always do positive work along it. It is limited in length, and
 * halved while the forces at its end point back. Near a stable equilibrium this is Newton's
 * method with the exact stiffness. Forces without a potential may lead such a descent in a
 * circle: with them Newton's method alone is tried first.
 *
 * l     out  at the equilibrium, by ct_linear_rest
 *
 * Errors   CT_E_EQUILIBRIUM when none is found, naming what moves; CT_E_SINGULAR
 * Source   Dauphin and others (2014) for the sign of the steps, key dauphin2014
 */
bool ct_equilibrium_find(struct ct_linear *l, struct ct_equilibrium_result *out);

/// The same of models with states, whose rates vanish as well: Newton's method (equilibrium_states.c).
bool ct_equilibrium_find_with_states(struct ct_linear *l, struct ct_equilibrium_result *out);

/// The same of systems too large for dense matrices, with sparse factors. The equations have the
/// rows of their residual. Sets a and lam in l, no matrices. *applies is false, and no
/// equilibrium is sought, where something moves, or factors are not available.
bool ct_equilibrium_find_sparse(struct ct_linear *l, struct ct_equilibrium_result *out,
                                bool *applies);

/// Newton's method alone, from a position next to an equilibrium, stable or not: along a path of
/// loads. With sparse factors where l has no dense matrices; then none are left in it. No diagnostic.
bool ct_equilibrium_rates(struct ct_linear *l, struct ct_equilibrium_result *out);

#endif
