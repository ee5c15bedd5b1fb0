// The linearised equations at a state as sparse matrices. They serve systems that are too large
// for dense matrices and are linearised at a few states only.
//
//     r = M u' - Q - J' lam,    K = dr/dq, C = dr/du, M = dr/du'
//
// Entries are (row, column, value); zeros are left out. Derivatives are evaluated numerically,
// node by node, on the expressions of r (ct_ex_jacobian_at). No derivative expressions are
// created, and terms that are zero at the state cost nothing.
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
    struct ct_number *K, *C, *M; // parts of `all`
    size_t nK, nC, nM;
    const double *phi, *v, *J; // of the constraint rows; J as listed by e->J
};

/// Creates sparse matrices for the state of l, with its accelerations and multipliers. The
/// equations must have a residual. Everything lives in arenas under l->arena.
struct ct_point *ct_point_create(struct ct_linear *l);
/// Returns the object that all analyses at l share; creates it at the first call.
struct ct_point *ct_point_here(struct ct_linear *l);
/// Evaluates at l->y, l->t, l->a, l->lam. False, without a diagnostic, if a value is not
/// finite.
bool ct_point_evaluate(struct ct_point *p);
/// y (nu, out) = A x
void ct_point_apply(double *y, const struct ct_number *A, size_t n, const double *x, size_t nu);

/// Largest |value| of n entries.
double ct_point_largest(const struct ct_number *A, size_t n);

/// Factors [ stiffness K + mass M, J'; J, 0 ] at the last evaluation; valid until the next one.
/// NULL if the matrix is singular or sparse factors are not available.
struct ct_sparse *ct_point_factor(struct ct_point *p, double stiffness, double mass);
/// d (nu, out): the vector of least norm with J d = -r, by sparse factors, with J of the last
/// ct_evaluator_constraint. False if these are not available or J does not have full rank.
bool ct_point_shortest(struct ct_linear *l, double *d, const double *r);

#endif
