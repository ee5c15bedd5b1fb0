// Static buckling: load factors at which the stiffness of an equilibrium vanishes in some
// direction.  (section 9.5)
#ifndef CT_ANALYSIS_BUCKLING_H
#define CT_ANALYSIS_BUCKLING_H

#include "analysis/equilibrium.h"

struct ct_buckling_factor {
    double factor; // of the load
    double linear; // from (K_0 + c K_1) phi = 0
    bool is_exact; // the stiffness at the equilibrium under the load vanishes there
    bool is_limit; // the path of equilibria ends there
};

struct ct_buckling_list {
    struct ct_buckling_factor *factor;
    size_t n;
    bool has_potential; // K is symmetric: a static criterion tells all
};

/**
 * The lowest positive factors of the load whose factor is input `at` of the evaluator.
 *
 * K_1 is the slope of the stiffness along the path of equilibria at factor 0: (K_0 + c K_1) phi
 * = 0 is the linear problem. Its factors give the first step along the path. There each factor
 * is found by the eigenvalue of the stiffness that changes its sign.
 *
 * l        in    at the equilibrium with factor 0: linearised, or, of a large system, as
 *                ct_equilibrium_find_sparse leaves it
 *          out   anywhere on the path
 * list     out   ascending, `count` of them at most; in l->arena
 * applies  out   false, and nothing is said, where l has no dense matrices and sparse ones do
 *                not serve: something can move freely, the equilibrium is not stable without
 *                the load, or the load has no potential
 *
 * Errors   CT_E_NO_BUCKLING when there is none; CT_E_SINGULAR
 * Source   Roberts (1991), chapter 4, key roberts1991
 */
bool ct_buckling_find(struct ct_linear *l, size_t at, size_t count,
                      struct ct_buckling_list *list, bool *applies);

/// Take l along the path from one factor to another, in as many steps as it needs. False where
/// the path ends.
bool ct_buckling_load(struct ct_linear *l, size_t at, double factor);

#endif
