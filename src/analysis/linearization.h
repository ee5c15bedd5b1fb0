// The equations to first order about a state.  (formulation 9.4)
//
// full, nu speeds and nrow rows:
//     M da + C du + K dq = J' dlam + B f,   J dq = 0,   J du + D dq = 0
// reduced, nfree:
//     dq = Z y,   du = Z w + X y,   da = Z w' + X w + X2 y,   y' = w + G y
//     Mr w' + Cr w + Kr y = Z' B f
//
// A state z of the model, a speed in the equations, stands among dq here: z' - rate = 0 has the
// matrices of a coordinate without mass that a damper of one holds.
//
// K has the derivative of -J' lam at the multipliers of the state. dq is a motion in the
// speeds: rotations are varied in the chart at the state. Z has unit rows at the independent
// speeds, so that y are their coordinates and w their speeds; X, X2 and G vanish at rest. What
// does not change with time about a steady motion is exact.
#ifndef CT_ANALYSIS_LINEARIZATION_H
#define CT_ANALYSIS_LINEARIZATION_H

#include "base/ctx.h"
#include "solve/evaluator/evaluator.h"

struct ct_linear {
    struct ct_evaluator *m;
    struct ct_ctx *ctx;
    struct ct_arena *arena;
    int nu, nrow, rank, nfree;
    double t, *y;        // the state: q, u, work
    double *a, *lam;     // u' and multipliers there
    double *a0;          // the part of u' that the drivers ask for: J a0 + gam = 0
    double *force;       // unbalanced, along the independent speeds (nfree)
    double *scale;       // of the forces that meet in each row of r (nu)
    double acceleration; // largest |u'|
    bool is_resting; // at an equilibrium: a is zero, lam holds it, what is left is round-off

    double *M, *C, *K;            // nu x nu
    double *J, *D, *D2;           // nrow x nu: of the speeds, of the accelerations
    int *row;                     // rank kept rows, then the others
    int *dependent, *independent; // speeds: rank, nfree
    double *Z, *X, *X2;           // nu x nfree
    double *G, *Mr, *Cr, *Kr;     // nfree x nfree
    bool is_moving;               // X, X2 or G is not zero

    struct ct_point *point; // sparse matrices; see ct_point_here

    // workspace
    double *r, *A, *b, *d, *work, *Jd;
    int *iwork, *pivot, *column;
};

/// For an evaluator whose equations have a residual. Matrices get their room when they are
/// first asked for. Everything lives in arena.
struct ct_linear *ct_linear_create(struct ct_ctx *ctx, struct ct_arena *arena,
                                   struct ct_evaluator *m);

/// Take l->y to the nearest place and speeds that meet the rows at l->t; memories and
/// comparisons follow. False where Newton does not arrive; no diagnostic.
bool ct_linear_close(struct ct_linear *l);

/// At l->y, l->t: u' = 0 but for what drivers ask for, multipliers that leave the least force
/// unbalanced, all matrices. Errors: CT_E_SINGULAR when something is not finite.
bool ct_linear_rest(struct ct_linear *l);
/// The same with the accelerations of the motion.
bool ct_linear_move(struct ct_linear *l);

/// l->y moved by dq (nu), states of the model as well.
void ct_linear_retract(struct ct_linear *l, const double *dq);
/// Derivatives (n each) by a state of the model where those by the place, the speed and the
/// acceleration of a speed stand: what is known by z and z' moves up to the place and the speed.
static inline void ct_state_take_as_place(double *by_place, double *by_speed,
                                          double *by_acceleration, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        by_place[i] = by_speed[i];
        by_speed[i] = by_acceleration[i];
        by_acceleration[i] = 0;
    }
}

/// dq (nu, out) = Z y.
void ct_linear_expand(const struct ct_linear *l, double *dq, const double *y);
/// v (nfree, out) = Z' f.
void ct_linear_project(const struct ct_linear *l, double *v, const double *f);
/// Name of the coordinate that varies with speed k: "pin.q", "ball.turn2".
const char *ct_linear_coordinate(const struct ct_equations *e, struct ct_arena *a, int k);

#endif
