// The equations of motion to first order about a state (formulation 9.4).
//
// Full equations, for nu speeds and nrow constraint rows:
//     M da + C du + K dq = J' dlam + B f,   J dq = 0,   J du + D dq = 0
// Reduced equations, for nfree independent speeds:
//     dq = Z y,   du = Z w + X y,   da = Z w' + X w + X2 y,   y' = w + G y
//     Mr w' + Cr w + Kr y = Z' B f
//
// A state z of the model is a speed in the equations and a position in dq. Its equation z' -
// rate = 0 then has the matrices of a massless coordinate with a unit damper.
//
// K includes the derivative of -J' lam at the multipliers of the state. dq is a displacement in
// the directions of the speeds: rotations vary by rotation vectors at the state. Z has unit
// rows at the independent speeds, so that y are their displacements and w their speeds. X, X2
// and G vanish at rest.
// The matrices are exact for a steady motion; otherwise they are those of the instant.
#ifndef CT_ANALYSIS_LINEARIZATION_H
#define CT_ANALYSIS_LINEARIZATION_H

#include "base/ctx.h"
#include "solve/evaluator/evaluator.h"

#include <float.h>

/// Round-off of eigenvalues, forces and products of matrices with n rows, relative to the largest
/// terms: what is below counts as zero. Definition: 20 n eps, the threshold of LAPACK's own tests
/// of symmetric eigenvalue problems (sep.in).
static inline double ct_roundoff(int n)
{
    return 20 * n * DBL_EPSILON;
}

struct ct_linear {
    struct ct_evaluator *m;
    struct ct_ctx *ctx;
    struct ct_arena *arena;
    int nu, nrow, rank, nfree;
    double t, *y;        // the state: positions q, speeds u, work
    double *a, *lam;     // accelerations u' and multipliers at the state
    double *a0;          // part of u' that the drivers prescribe: J a0 + gam = 0
    double *force;       // unbalanced force along the independent speeds (nfree)
    double *scale;       // sum of force magnitudes in each row of r (nu)
    double acceleration; // largest |u'|
    bool is_resting;     // at an equilibrium: a = 0, lam balances the forces up to round-off

    double *M, *C, *K;            // nu x nu
    double *J, *D, *D2;           // nrow x nu: derivatives of J u and of J u'
    int *row;                     // the independent rows (rank), then the redundant ones
    int *dependent, *independent; // indices of speeds: rank, nfree
    double *Z, *X, *X2;           // nu x nfree
    double *G, *Mr, *Cr, *Kr;     // nfree x nfree
    bool is_moving;               // X, X2 or G is not zero

    struct ct_point *point; // sparse matrices; see ct_point_here

    // workspace
    double *r, *A, *b, *d, *work, *Jd;
    int *iwork, *pivot, *column;
};

/// Creates a linearisation for an evaluator whose equations have a residual. Dense matrices are
/// allocated when first needed. Everything lives in arena.
struct ct_linear *ct_linear_create(struct ct_ctx *ctx, struct ct_arena *arena,
                                   struct ct_evaluator *m);

/// Moves l->y to the nearest positions and speeds that satisfy the constraints at l->t, and
/// updates memories and switches. False, without a diagnostic, if Newton's method does not
/// converge.
bool ct_linear_close(struct ct_linear *l);

/// Computes all matrices at l->y, l->t for zero accelerations, except those that drivers
/// prescribe. The multipliers leave the least unbalanced force. Errors: CT_E_SINGULAR if a
/// value is not finite.
bool ct_linear_rest(struct ct_linear *l);
/// The same with the accelerations of the motion.
bool ct_linear_move(struct ct_linear *l);

/// A state to come back to.
struct ct_kept_state {
    double *y, *lam, *memory;
};
struct ct_kept_state ct_kept_state_create(const struct ct_linear *l);
void ct_linear_keep(const struct ct_linear *l, struct ct_kept_state *out);
void ct_linear_go_back(struct ct_linear *l, const struct ct_kept_state *to);

/// Moves l->y by dq (nu), states of the model included.
void ct_linear_retract(struct ct_linear *l, const double *dq);
/// For arrays of derivatives (n each) with respect to position, speed and acceleration: the
/// entries of a model state, given with respect to z (speed) and z' (acceleration), move to
/// position and speed.
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
/// Is A (n x n) symmetric but for round-off? A load without potential may be small compared with
/// stiff elements elsewhere, so each pair of entries is compared with the largest of their columns.
bool ct_linear_is_symmetric(struct ct_arena *a, const double *A, int n);
/// The first of the largest entries |v_i + i w_i| (n; w may be NULL). Eigenvectors have half of all
/// digits at least, so that entries are equal if they differ by less.
int ct_linear_largest_entry(const double *v, const double *w, int n);
/// Returns the name of the coordinate that varies with speed k: "pin.q", "ball.turn2".
const char *ct_linear_coordinate(const struct ct_equations *e, struct ct_arena *a, int k);

#endif
