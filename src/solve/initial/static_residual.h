// Static residual of the initial equilibrium, Q + J' lam = 0 and phi = 0 at zero speeds, with its
// derivative and Newton's method. Only some of the speeds are unknown directions; the other
// coordinates stay fixed.
#ifndef CT_SOLVE_INITIAL_STATIC_RESIDUAL_H
#define CT_SOLVE_INITIAL_STATIC_RESIDUAL_H

#include "solve/evaluator/evaluator.h"

/// Orthonormal vectors (n each), one after the other.
struct ct_basis {
    size_t n, count;
    double *v;
};

/// Add the component of v (n, overwritten) that is orthogonal to the basis. False if it is zero.
bool ct_basis_extend(struct ct_basis *s, double *v);

struct ct_static_residual {
    struct ct_evaluator *m;
    const struct ct_equations *e;
    size_t n, nlam, nslope; // unknown directions; independent rows; derivatives
    int *u, *index;         // speeds of the directions; by speed: its index among them, or -1
    int *row, *lam_index;   // independent rows; by row: its index among them, or -1
    struct ct_slope *slope; // of the forces by positions and multipliers
    double *y, *lam;        // state; multipliers (nrow)
    double *A, *step;       // factors of the derivative, (n + nlam) square; a motion (nu)
    int *pivot;
    double stiffness; // unit of the multipliers
    double *offset;   // by gap of the equations, 4 each: its value, or quaternion, at the start
    struct ct_program values; // forces (n), phi (nrow), slopes
};

struct ct_static_residual ct_static_residual_create(struct ct_arena *a, struct ct_evaluator *m);
/// Compile programs of Q + J' lam in the unknown directions at zero speeds, phi, and derivatives.
void ct_static_residual_derive(struct ct_static_residual *s, struct ct_arena *a);
/// Choose rows that are independent in the unknown directions at s->y; multipliers of other rows
/// become zero.
void ct_static_residual_choose_rows(struct ct_static_residual *s, struct ct_arena *a);
/// Forces, phi and derivatives at s->y and s->lam.
void ct_static_residual_evaluate(struct ct_static_residual *s);
/// A = [K  c J'; c J  0] with K = d(force)/d(coordinate) and c = s->stiffness, the size of K.
/// Multipliers have the unit c.
void ct_static_residual_fill(struct ct_static_residual *s);
/// Newton's method from s->y. Steps are halved until the next correction with the same derivative
/// is smaller. False if it does not converge.
bool ct_static_residual_iterate(struct ct_static_residual *s, struct ct_arena *a);
/// At an equilibrium: the speeds at which it moves with time,
/// K u + J' lam' = -df/dt - K_s u_s and J u = -v.
///
/// v       in      (nrow) rates of the rows due to u_s
/// u       in/out  (nu) in: speeds u_s of the fixed coordinates; out: all speeds
///
/// False where the equilibrium is not determined.
bool ct_static_residual_rates(struct ct_static_residual *s, struct ct_arena *a, const double *v,
                              double *u);

#endif
