// Static residual: the forces on what moves, with the multipliers of the rows that hold it.
#ifndef CT_SOLVE_INITIAL_STATIC_RESIDUAL_H
#define CT_SOLVE_INITIAL_STATIC_RESIDUAL_H

#include "solve/evaluator/evaluator.h"

/// Orthonormal vectors (n each), one after the other.
struct ct_basis {
    size_t n, count;
    double *v;
};

/// Add the part of v (n, overwritten) that is new. False if there is none.
bool ct_basis_extend(struct ct_basis *s, double *v);

struct ct_static_residual {
    struct ct_evaluator *m;
    const struct ct_equations *e;
    size_t n, nlam, nslope; // speeds along which places move; rows that count; derivatives
    int *u, *index;         // those speeds; by speed: its place among them, or -1
    int *row, *lam_index;   // kept rows; by row: its place among them, or -1
    struct ct_slope *slope; // of the forces by positions and multipliers
    double *y, *lam;        // state; multipliers (nrow)
    double *A, *step;       // factors of the derivative, (n + nlam) square; a motion (nu)
    int *pivot;
    double stiffness; // unit of the multipliers
    double *offset;   // by gap of the equations, 4 each: its value, or quaternion, at the start
    struct ct_program values; // forces (n), phi (nrow), slopes
};

struct ct_static_residual ct_static_residual_create(struct ct_arena *a, struct ct_evaluator *m);
/// Forces Q + J' lam of what moves, all speeds zero, and their derivatives; phi: as programs.
void ct_static_residual_derive(struct ct_static_residual *s, struct ct_arena *a);
/// Choose the rows that count, independent in the directions that move, where s->y is now;
/// multipliers of the others become zero.
void ct_static_residual_choose_rows(struct ct_static_residual *s, struct ct_arena *a);
/// Forces, phi and derivatives at s->y and s->lam.
void ct_static_residual_evaluate(struct ct_static_residual *s);
/// A = [K  c J'; c J  0] with K = d(force)/d(place), c = s->stiffness its size: multipliers are
/// counted in units of c.
void ct_static_residual_fill(struct ct_static_residual *s);
/// Newton steps from s->y, halved until the next correction with the same derivative is smaller.
/// False if they find nothing.
bool ct_static_residual_iterate(struct ct_static_residual *s, struct ct_arena *a);
/// At an equilibrium: the rates at which it moves with time, K u + J' lam' = -df/dt - K_s u_s and J
/// u = -v.
///
/// v       in      (nrow) rates of the rows while only what stays moves
/// u       in/out  (nu) in: speeds u_s of what stays; out: of what moves, too
///
/// False where the equilibrium is not determined.
bool ct_static_residual_rates(struct ct_static_residual *s, struct ct_arena *a, const double *v,
                              double *u);

#endif
