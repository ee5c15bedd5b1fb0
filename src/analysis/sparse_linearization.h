// The equations and their derivatives at a state as sparse numbers: for systems that are too
// large for full matrices, and that are linearised at a few places only.
//
//     r = M u' - Q - J' lam,    K = dr/dq, C = dr/du, M = dr/du'
//
// Entries have a row and a direction; zeros are left out.
//
// Derivatives are taken where the numbers are, node by node of the expressions of r
// (ct_ex_jacobian_at), so that what is zero at the state costs nothing and no further
// expressions are made.
#ifndef CT_ANALYSIS_SPARSE_LINEARIZATION_H
#define CT_ANALYSIS_SPARSE_LINEARIZATION_H

#include "analysis/linearization.h"
#include "numeric/sparse.h"

struct ct_point {
    struct ct_linear *l;
    struct ct_arena *a; // of the last evaluation
    double *r, *value;
    struct ct_seed *seed;
    size_t nseed;
    struct ct_number *K, *C, *M; // in `all`
    size_t nK, nC, nM;
    const double *phi, *v, *J; // of the rows; entries as e->J lists them
};

/// At the state of l, with the accelerations and multipliers there. The equations have the rows
/// of their residual. Everything lives in arenas under l->arena.
struct ct_point *ct_point_create(struct ct_linear *l);
/// One that all analyses at l use in turn; it is made when it is first asked for.
struct ct_point *ct_point_here(struct ct_linear *l);
/// At l->y, l->t, l->a, l->lam. False if something is not finite. No diagnostic.
bool ct_point_evaluate(struct ct_point *p);
/// y (nu, out) = A x
void ct_point_apply(double *y, const struct ct_number *A, size_t n, const double *x, size_t nu);

/// Largest |value| of n entries.
double ct_point_largest(const struct ct_number *A, size_t n);

/// Factors of [ stiffness K + mass M, J'; J, 0 ] at the last evaluation, which they live with.
/// NULL where it is singular or sparse factors are not available.
struct ct_sparse *ct_point_factor(struct ct_point *p, double stiffness, double mass);
/// d (nu, out): the shortest vector with J d = -r, by sparse factors; J is that of the last
/// ct_evaluator_constraint. False where they are not available or J has not full rank.
bool ct_point_shortest(struct ct_linear *l, double *d, const double *r);

#endif
