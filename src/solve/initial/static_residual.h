// Static residual of the initial equilibrium, Q + J' lam = 0 and phi = 0 at zero speeds, with
// its derivative and Newton's method. The unknowns are a subset of the coordinates, given by
// their speeds, and the multipliers of independent rows. The other coordinates are held.
#ifndef CT_SOLVE_INITIAL_STATIC_RESIDUAL_H
#define CT_SOLVE_INITIAL_STATIC_RESIDUAL_H

#include "solve/evaluator/evaluator.h"

/// Orthonormal vectors (n each), one after the other.
struct ct_basis {
    size_t n, count;
    double *v;
};

/// Append the normalised component of v (n, overwritten) that is orthogonal to the basis. False
/// if v depends linearly on it.
bool ct_basis_extend(struct ct_basis *s, double *v);

struct ct_static_residual {
    struct ct_evaluator *m;
    const struct ct_equations *e;
    size_t n, nlam, nslope; // unknown coordinates; independent rows; derivatives
    int *u, *index;         // (n) their speeds; (nu) index among the unknowns, or -1
    int *row, *lam_index;   // (nlam) independent rows; (nrow) index among these, or -1
    struct ct_slope *slope; // of the forces by positions and multipliers
    double *y, *lam;        // state q, u; multipliers (nrow)
    double *A, *step;       // LU factors of the derivative, (n + nlam) square; increment (nu)
    int *pivot;
    double stiffness; // unit of the multipliers
    // (4 noffset) initial values of constraint offsets: a length or a quaternion
    double *offset;
    struct ct_program values; // forces (n), phi (nrow), slopes
};

struct ct_static_residual ct_static_residual_create(struct ct_arena *a, struct ct_evaluator *m);
/// Compile programs of Q + J' lam for the unknowns at zero speeds, phi, and derivatives.
void ct_static_residual_derive(struct ct_static_residual *s, struct ct_arena *a);
/// Choose rows whose coefficients of the unknowns are independent at s->y. Multipliers of other
/// rows become zero.
void ct_static_residual_choose_rows(struct ct_static_residual *s, struct ct_arena *a);
/// Forces, phi and derivatives at s->y and s->lam.
void ct_static_residual_evaluate(struct ct_static_residual *s);
/// A = [K  c J'; c J  0] with K = d(force)/d(coordinate). c = s->stiffness, the largest entry
/// of K, is the unit of the multipliers.
void ct_static_residual_fill(struct ct_static_residual *s);
/// Newton's method from s->y, damped by the natural monotonicity test: a step is halved until
/// the next correction with the same derivative is smaller. False if it does not converge.
bool ct_static_residual_iterate(struct ct_static_residual *s, struct ct_arena *a);
/// Speeds at which the equilibrium moves with time, K u + J' lam' = -df/dt - K_s u_s and J u =
/// -v.
///
///     v       in      (nrow) rates of the rows due to u_s
///     u       in/out  (nu) in: speeds u_s of the held coordinates; out: all speeds
///
/// False where the derivative is singular.
bool ct_static_residual_rates(struct ct_static_residual *s, struct ct_arena *a, const double *v,
                              double *u);

#endif
