// The folder integrate/implicit holds implicit methods for stiff problems with constraints: Radau
// IIA of order 5 (radau5.c) and the generalised-alpha family (alpha.c). They share a simplified
// Newton iteration with dense or sparse matrices, and an error estimate that recognises fast modes.
//
// This file is the interface of the simplified Newton iteration. Every method here solves linear
// systems of one form. The unknowns are corrections of positions d, of the multipliers eta, which
// enforce Phi = 0 in addition to v = 0, and of the multipliers lam of the equations of motion.
// (8.2), (8.4)
//
//     [ M + x C + y K   -(M + x C) J'   -J' ] ( d        )     ( y r   )         speeds change by c d,
//     [ J                0               0  ] ( eta      ) = - ( phi   )         accelerations by c/x d
//     [ J + z D         -J J'            0  ] ( y lam    )     ( z v   )         (less the part J' eta of d)
// with x = c/e, y = 1/e, z = 1/c, where c = d(speed)/d(position) and e =
// d(acceleration)/d(position). With this scaling the condition number does not depend on the step.
// The complex system of Radau IIA has a complex c. The index-3 form has neither eta nor the last
// row. Radau IIA collocates d' = T^-1(d) u. There speeds change by (c - N) d with N d = d x w / 2
// for rotations at angular velocities w: C becomes C - M N, K becomes K - C N and D becomes D - J
// N. The columns of eta do not change. What always holds: M, C, K, J, D come from the last call of
// `tangent`. They are evaluated again when convergence has become slow, and the matrix is factored
// again when c or e have changed.
#ifndef CT_INTEGRATE_IMPLICIT_NEWTON_ITERATION_H
#define CT_INTEGRATE_IMPLICIT_NEWTON_ITERATION_H

#include "integrate/implicit/newton_sparse.h"
#include "integrate/stepper.h"
#include "numeric/inverse.h"

#include <math.h>

enum ct_convergence { CT_ITERATING, CT_CONVERGED, CT_DIVERGED };

/// Workspace to measure round-off of forces and constraints.
struct ct_roundoff_probe {
    double *q, *d;    // positions near those of the step, and their distance  (nq), (nu)
    double *r, *rows; // residuals of motion and of constraints there  (nu), (rows x 2)
    double *phi;      // residuals of constraints at the start of the step  (rows x 2)
    double *a, *lam;  // accelerations and multipliers of the derivatives  (nu), (rows)
    double *zero;     // (rows)
};

struct ct_newton_iteration {
    const struct ct_dae *dae;
    const struct ct_groups *groups; // of the states
    bool is_stabilised;
    int nu, m, n;             // speeds, rows, equations
    long version;             // of the rows
    bool has_tangent, is_new; // derivatives: known; evaluated, or tried, in this step
    bool is_outdated;         // large changes of multipliers require new derivatives
    bool is_assembled;        // S, X, W belong to the present derivatives
    struct ct_newton *sparse; // sparse matrices and factors; NULL: the dense ones that follow
    double *M, *C, *K, *J, *D;
    double *S, *X, *W; // the matrix is S + x X + (y or z) W  (n x n)
    double c, e;       // of the factors; 0: none
    double by_r, by_v; // -1/e, -1/c
    int rows;          // leading dimension of G and Gi
    double *G;         // inverse of a small system, else its LU factors  (rows x n)
    double
        *Gi; // inverse of a small complex system: real parts, imaginary parts (rows x n, twice)
    double _Complex *Gc, z; // or its LU factors (n x n); z = 1/c of the complex system
    double one;             // for n = 1: the solution of the real system over the residual
    double _Complex onec;   // the same for the complex system
    int *pivot, *pivotc;
    double *H, slow; // LU factors of the low-pass filter, its cutoff [1/s]; 0: not factored
    int *pivot_slow;
    bool is_band_factor; // H has the factors for the cutoff of a band instead
    double energy;       // twice the largest kinetic energy, found or predicted so far
    double largest_mass; // the largest entry of `mass` at the last estimate of the energy
    bool *is_slow;       // per speed: does more than half of it pass the low-pass filter?  (nu)
    double *mass;        // the diagonal of M  (nu)
    double *w;     // speeds at which derivatives were evaluated (nu), for N; NULL: without N
    double *b, *x; // right-hand side (n, complex 2 n), solution (rows, complex 2 rows)
    double _Complex *bc;
    double per_speed;       // 1/nu; 0: there are none
    double *inverse_weight; // one over the weights of positions and speeds in the norm  (2 nu)
    double *error_state;    // workspace: an error of the states  (ny)
    double *fast;           // workspace: positions and speeds of fast modes  (2 nu)
    const double *y;        // state at the start of the step
    double t;               // time of the derivatives
    double
        *roundoff; // corrections caused by round-off of forces and constraints, (8.17)  (2 nu)
    bool has_roundoff; // it belongs to the present factors
    struct ct_roundoff_probe probe;
    // convergence
    int count;                   // corrections so far
    double kappa, roundoff_size; // sizes of corrections: converged; not above round-off
    double kappa_for;            // the tolerance that kappa belongs to
    bool runs_to_roundoff;       // there is no tolerance: iterate down to round-off
    double least;                // a change of positions by less is round-off  [m, rad]
    double roundoff_position, roundoff_speed; // half a unit round-off of the largest one
    double size;                              // of the last correction
    double rate, slowest;                     // convergence rate: the last two, the largest
    double tail; // the remaining error after a correction, over its size
    int most;    // largest number of corrections
};

/// Allocates the iteration, with the complex system on request.
struct ct_newton_iteration *ct_newton_iteration_create(struct ct_arena *a,
                                                       const struct ct_problem *p,
                                                       bool is_stabilised, bool is_complex);

/// Called at the start of a step h: sets the weights of the norm and the present rows. True if the
/// rows have changed, so that multipliers must be found again. tolerance == NULL: iterate down to
/// round-off.
bool ct_newton_iteration_begin(struct ct_newton_iteration *it,
                               const struct ct_tolerance *tolerance, double h, const double *y);

/// A correction of positions below this many round-off errors of the largest one ends the
/// iteration. With a tolerance the same holds for speeds that move positions by less in the step.
/// Default: steps refused for round-off against the error of positions. Test: implicit
static const double ct_position_roundoff = 8;

/// Is the convergence rate so slow that new derivatives pay?
static inline bool ct_newton_iteration_is_slow(double rate)
{
    return rate > 0.1;
}
/// Must derivatives be evaluated again? They are kept while convergence is not slow.
static inline bool ct_newton_iteration_is_old(const struct ct_newton_iteration *it)
{
    return !it->has_tangent || it->is_outdated || ct_newton_iteration_is_slow(it->rate);
}
/// Discards the derivatives, after an event or a singular configuration.
static inline void ct_newton_iteration_forget(struct ct_newton_iteration *it)
{
    it->has_tangent = false;
}
/// Multipliers lam (n) have been corrected by dlam. Near a singular configuration constraint rows
/// change mostly in length. With old derivatives positions still converge, but each step multiplies
/// the error of lam by 1 - J/J_old, so large corrections call for new derivatives.
static inline void ct_newton_iteration_note_multipliers(struct ct_newton_iteration *it,
                                                        const double *lam, const double *dlam,
                                                        int n)
{
    double size = 0, change = 0;
    for (int i = 0; i < n; i++) {
        size = ct_larger(size, fabs(lam[i]));
        change = ct_larger(change, fabs(dlam[i]));
    }
    it->is_outdated = change > size / 2;
}
/// Evaluates the derivatives at a point, if they are too old. The matrix must be factored after
/// that.
enum ct_eval ct_newton_iteration_refresh(struct ct_newton_iteration *it, double t,
                                         const double *q, const double *u, const double *a,
                                         const double *lam, struct ct_integrate_stats *stats);
/// Factors for c and e, unless they are there; false if singular. s: c of the complex system, e =
/// s^2, or 0.
bool ct_newton_iteration_factor_anew(struct ct_newton_iteration *it, double c, double e,
                                     double _Complex s, struct ct_integrate_stats *stats);
static inline bool ct_newton_iteration_factor(struct ct_newton_iteration *it, double c,
                                              double e, double _Complex s,
                                              struct ct_integrate_stats *stats)
{
    // Factors for a step that differs by less are used again.
    // Derived: they add at most 2e-3 to the convergence rate, which costs no correction.
    const double same_step = 1e-3;
    const bool are_near
        = fabs(it->c - c) <= same_step * fabs(c) && fabs(it->e - e) <= same_step * fabs(e);
    return are_near || ct_newton_iteration_factor_anew(it, c, e, s, stats);
}

/// A (n x n, leading dimension lda, out): the dense matrix for c and e.
void ct_newton_iteration_fill(struct ct_newton_iteration *it, double *A, int lda, double c,
                              double e);

/// d (nu, out), eta (m, out; zero in the index-3 form), lam (m, out) from r (nu), phi, v (m).
void ct_newton_iteration_solve_system(struct ct_newton_iteration *it, double *d, double *eta,
                                      double *lam, const double *r, const double *phi,
                                      const double *v);
static inline void ct_newton_iteration_solve(struct ct_newton_iteration *it, double *d,
                                             double *eta, double *lam, const double *r,
                                             const double *phi, const double *v)
{
    if (it->n == 1)
        d[0] = it->one * r[0];
    else
        ct_newton_iteration_solve_system(it, d, eta, lam, r, phi, v);
}
/// The same with the complex system. In each vector imaginary parts follow the real parts.
void ct_newton_iteration_solve_complex(struct ct_newton_iteration *it, double *d, double *eta,
                                       double *lam, const double *r, const double *phi,
                                       const double *v);

/// q1 (nq, out) = q (+) d.
static inline void ct_newton_iteration_move(const struct ct_dae *dae, const double *q,
                                            const double *d, double *q1)
{
    if (!dae->is_plain) {
        dae->retract(dae->user, q, d, q1);
        return;
    }
    for (int k = 0; k < dae->nu; k++)
        q1[k] = q[k] + d[k];
}

/// x (nu) += c N d, with `w`.
void ct_newton_iteration_add_rotation(const struct ct_newton_iteration *it, double *x, double c,
                                      const double *d);
void ct_newton_iteration_add_constraint_force_sparse(const struct ct_newton_iteration *it,
                                                     double *out, const double *x, double c,
                                                     const double *eta);
/// r (nu) = M x.
void ct_newton_iteration_multiply_mass(const struct ct_newton_iteration *it, double *r,
                                       const double *x);
/// out (nu) = x + c J' eta (m); out may be x. nu and m are those of the iteration; constants let
/// the compiler unroll loops.
static inline void
ct_newton_iteration_add_constraint_force(const struct ct_newton_iteration *it, double *out,
                                         const double *x, double c, const double *eta,
                                         const int nu, const int m)
{
    const double *J = it->J;
    if (nu > CT_MOST_INVERTED && it->sparse) {
        ct_newton_iteration_add_constraint_force_sparse(it, out, x, c, eta);
        return;
    }
    for (int k = 0; k < nu; k++, J += m) {
        double sum = 0;
        for (int j = 0; j < m; j++)
            sum += J[j] * eta[j];
        out[k] = x[k] + c * sum;
    }
}

static inline double ct_newton_iteration_square(const double *x, const double *inverse_weight,
                                                int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += (x[i] * inverse_weight[i]) * (x[i] * inverse_weight[i]);
    return sum;
}

/// The norm of corrections: root mean square of k changes of positions d and of speeds u (nu x k
/// each) over their weights; u == NULL: of positions alone. nu is that of the iteration; a constant
/// lets the compiler unroll loops.
static inline double ct_newton_iteration_norm(const struct ct_newton_iteration *it,
                                              const double *d, const double *u, const int nu,
                                              int k)
{
    double sum = 0;
    for (int s = 0; s < k; s++)
        sum += ct_newton_iteration_square(d + s * nu, it->inverse_weight, nu);
    for (int s = 0; s < k && u; s++)
        sum += ct_newton_iteration_square(u + s * nu, it->inverse_weight + nu, nu);
    return sqrt(sum * (it->per_speed / ((u ? 2 : 1) * k)));
}

/// The same for positions and for the state variables of the model among the speeds.
static inline double ct_newton_iteration_norm_of_positions(const struct ct_newton_iteration *it,
                                                           const double *d, const double *u,
                                                           const int nu)
{
    const int n = it->dae->nstate, first = nu - n;
    const double sum
        = ct_newton_iteration_square(d, it->inverse_weight, nu)
        + (n ? ct_newton_iteration_square(u + first, it->inverse_weight + nu + first, n) : 0);
    return sqrt(sum * it->per_speed);
}

/// The norm of errors d, u (nu) of positions and speeds at y, with speeds that are not outputs
/// low-pass filtered (8.10). Their fast part counts over `fast_scale` (nu) instead. *slow (out):
/// the same with filtered positions. INFINITY where the filter cannot be factored. `error_state` is
/// overwritten.
double ct_newton_iteration_slow_norm(struct ct_newton_iteration *it, const struct ct_problem *p,
                                     const struct ct_tolerance *tolerance, const double *y,
                                     const double *fast_scale, const double *d, const double *u,
                                     double *slow);

/// Raises `energy` to twice the kinetic energy of these speeds, where speeds below `small` are
/// negligible. To be called after ct_newton_iteration_slow_norm, as the three functions below.
void ct_newton_iteration_note_energy(struct ct_newton_iteration *it, double small,
                                     const double *speeds);
/// Raises `energy` to a prediction for motions that start at rest: the energy from the slow part of
/// these accelerations after the distance `small`, or after `time` if that is less. `error_state`
/// is overwritten.
void ct_newton_iteration_predict_energy(struct ct_newton_iteration *it, double small,
                                        double time, const double *accelerations);

/// Undamped vibrations in a step.
struct ct_vibration {
    double dissipation, present; // twice the energy that the step dissipates, and their energy
    double times;                // their amplitude over their error estimate
};
/// The vibrations in a step h of Radau IIA whose error estimate is d, u (nu); gamma/h is c of its
/// real system. `error_state` is overwritten.  (8.13)
struct ct_vibration ct_newton_iteration_vibration(struct ct_newton_iteration *it, double gamma,
                                                  double h, const double *d, const double *u);
/// The largest relative change of outputs at y without the vibrations v in errors d, u (nu).
/// `error_state` is overwritten.
double ct_newton_iteration_output_change(struct ct_newton_iteration *it,
                                         const struct ct_problem *p,
                                         const struct ct_vibration *v, double t,
                                         const double *y, const double *d, const double *u);

/// Vibrations in a band of frequencies about `rate`, for the band-pass filter.
struct ct_band {
    double rate;  // its frequency  [1/s]
    double times; // their amplitude over their error estimate
    double small; // positions and speeds below it are negligible
    double least; // least scale of outputs
    const double *largest_position, *largest_speed; // largest positions and speeds so far  (nu)
    const double *predicted;                        // predicted positions and speeds  (2 nu)
};
/// ahead (2 nu, out): predicted changes of positions and speeds up to the end of the run, from the
/// low-pass filtered speeds and accelerations a (nu) at y, and not above a unit. The outputs that
/// follow are passed to `predict_output`. `error_state` is overwritten.  (8.22)
void ct_newton_iteration_predict_motion(struct ct_newton_iteration *it,
                                        const struct ct_problem *p, double t, const double *y,
                                        const double *a, double *predicted);
/// The largest relative change of outputs at y by the part of errors d, u (nu) in this band, for
/// any phase of the vibrations. `error_state` is overwritten.  (8.21)
double ct_newton_iteration_output_change_in_band(struct ct_newton_iteration *it,
                                                 const struct ct_problem *p,
                                                 const struct ct_band *b, double t,
                                                 const double *y, const double *d,
                                                 const double *u);

/// Errors d, u (nu) of positions and speeds at y1 as one of the states (ny), in `error_state`.
const double *ct_newton_iteration_states(struct ct_newton_iteration *it, const double *y1,
                                         const double *d, const double *u);
/// The error of a step that ends at y1, time t1: the larger of `states`, the norm of the error of
/// states, and the error of outputs that follows from errors d, u (nu) of positions and speeds.
/// (8.6)
double ct_newton_iteration_error(struct ct_newton_iteration *it, const struct ct_problem *p,
                                 const struct ct_tolerance *tolerance, double t1,
                                 const double *y1, const double *d, const double *u,
                                 double states);

/// The error of sensitive outputs that follows from errors d, u (nu), where 1 is the tolerance;
/// `states` is the norm of the error of the step.  (8.11)
double ct_newton_iteration_sensitive_error(struct ct_newton_iteration *it,
                                           const struct ct_problem *p,
                                           const struct ct_tolerance *tolerance, double t1,
                                           const double *y1, const double *d, const double *u,
                                           double states);

/// The corrections of positions and speeds (2 nu) that round-off of forces and constraints causes,
/// by the factors of the real system. Smaller corrections are round-off. It takes two residuals;
/// zeros where they cannot be computed. `b` is overwritten.  (8.17)
const double *ct_newton_iteration_roundoff(struct ct_newton_iteration *it);

// ---- convergence, see newton_convergence.c ------------------------------------------------------

/// Before the first correction.
void ct_newton_iteration_start(struct ct_newton_iteration *it);
/// After convergence: lets corrections go on until they come to round-off.
void ct_newton_iteration_continue(struct ct_newton_iteration *it);
/// The convergence test, after a correction of norm `size` of positions by d (nu x k) and of speeds
/// by u (nu x k; NULL: not tested).
enum ct_convergence ct_newton_iteration_test_convergence(struct ct_newton_iteration *it,
                                                         double size, const double *d,
                                                         const double *u, int k);
/// After divergence: true if newer derivatives may help.
bool ct_newton_iteration_can_refresh(struct ct_newton_iteration *it);

#endif
