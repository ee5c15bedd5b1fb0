// Static buckling: the load factors at which the stiffness of an equilibrium becomes singular
// (section 9.5).
#ifndef CT_ANALYSIS_BUCKLING_H
#define CT_ANALYSIS_BUCKLING_H

#include "analysis/equilibrium.h"

struct ct_buckling_factor {
    double factor; // multiplies the load
    double linear; // the factor of the linear problem (K_0 + c K_1) phi = 0
    bool is_exact; // the stiffness of the equilibrium under the load is singular there
    bool is_limit; // a limit point: the path of equilibria ends there
};

struct ct_buckling_list {
    struct ct_buckling_factor *factor;
    size_t n;
    bool has_potential; // K is symmetric, so that the static criterion decides about stability
};

/**
 * Finds the lowest positive factors of the load whose factor is input `at` of the evaluator.
 *
 * K_1 is the slope of the stiffness along the path of equilibria at factor 0. The linear
 * problem (K_0 + c K_1) phi = 0 gives the length of the first step along the path. On the path
 * each factor is located by the eigenvalue of the stiffness that changes its sign.
 *
 * l        in    at the equilibrium with factor 0: linearised, or, for a large system, as
 *                ct_equilibrium_find_sparse leaves it
 *          out   at some point of the path
 * list     out   ascending, at most `count` factors; in l->arena
 * applies  out   false, without a diagnostic, if l has no dense matrices and sparse ones do not
 *                serve: a rigid-body motion exists, the equilibrium is unstable without the
 *                load, or the load has no potential
 *
 * Errors   CT_E_NO_BUCKLING if there is no factor; CT_E_SINGULAR
 * Source   Roberts (1991), chapter 4, key roberts1991
 */
bool ct_buckling_find(struct ct_linear *l, size_t at, size_t count,
                      struct ct_buckling_list *list, bool *applies);

/// Moves l along the path of equilibria from its present factor to `factor`, in as many steps
/// as needed. False if the path ends before.
bool ct_buckling_load(struct ct_linear *l, size_t at, double factor);

#endif
