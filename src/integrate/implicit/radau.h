// Radau IIA of order 5: coefficients, the data of a step, and the solution of the real linear
// system. Shared by radau5.c, the step, and radau_error.c, its error estimate.
#ifndef CT_INTEGRATE_IMPLICIT_RADAU_H
#define CT_INTEGRATE_IMPLICIT_RADAU_H

#include "integrate/implicit/newton_iteration.h"
#include "numeric/dense.h"

enum { STAGES = 3 }; // Definition: of the method.

#define CBRT3 1.4422495703074083823 // Definition: cube root of 3.
/// Definition: the real eigenvalue of the inverse of the Runge-Kutta matrix.
#define GAMMA (3 - CBRT3 + CBRT3 * CBRT3)

// Definition: square roots.
#define SQRT3 1.7320508075688772935
#define SQRT6 2.4494897427831780982

// Definition: nodes of the method.
#define C1 ((4 - SQRT6) / 10)
#define C2 ((4 + SQRT6) / 10)
/// Nodes and Runge-Kutta matrix of the method.
static const double C[STAGES] = {C1, C2, 1};
static const double A[STAGES][STAGES]
    = {{(88 - 7 * SQRT6) / 360, (296 - 169 * SQRT6) / 1800, (-2 + 3 * SQRT6) / 225},
       {(296 + 169 * SQRT6) / 1800, (88 + 7 * SQRT6) / 360, (-2 - 3 * SQRT6) / 225},
       {(16 - SQRT6) / 36, (16 + SQRT6) / 36, 1. / 9}};

// Definition: the eigenvalues of A^-1, the roots of x^3 - 9 x^2 + 36 x - 60: GAMMA and ALPHA +- i
// BETA.
static const double ALPHA = 3 + (CBRT3 - CBRT3 * CBRT3) / 2;
static const double BETA = SQRT3 / 2 * (CBRT3 + CBRT3 * CBRT3);

/// Definition: A^-1 = T diag(GAMMA, [ALPHA -BETA; BETA ALPHA]) T^-1, as in RADAU5.
static const double T[STAGES][STAGES]
    = {{9.1232394870892942792e-02, -0.14125529502095420843, -3.0029194105147424492e-02},
       {0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779},
       {0.96604818261509293619, 1, 0}};
static const double T_INVERSE[STAGES][STAGES]
    = {{4.3255798900631553510, 0.33919925181580986954, 0.54177053993587487119},
       {-4.1787185915519047273, -0.32768282076106238708, 0.47662355450055045196},
       {-0.50287263494578687595, 2.5719269498556054292, -0.59603920482822492497}};

/// Stages of a step, or their corrections, stored stage by stage.
struct ct_radau_stages {
    double h;
    double *d, *u;     // changes of positions and of speeds since the start  (nu x 3)
    double *lam, *eta; // (rows x 3)
};

struct ct_radau {
    const struct ct_dae *dae;
    struct ct_newton_iteration *it;
    bool is_fresh;                      // there is no step before
    bool was_tried;                     // this step was attempted before and refused
    struct ct_radau_stages before, now; // the last accepted step, this one
    struct ct_radau_stages change;      // corrections, first in the basis of eigenvectors
    double h;                           // the step of the weights that follow
    double slope[STAGES][STAGES], defect_of[STAGES]; // A^-1/h and E/h
    double ratio; // this step over the one before, of the weights that follow
    double extrapolation[STAGES][STAGES]; // extrapolation of the last collocation polynomial
    double extrapolation_lam[STAGES][STAGES]; // the same for multipliers
    bool knows_multipliers;                   // those of the last step are for the same rows
    struct ct_tolerance step_tolerance, estimate_tolerance;
    double *rate, *F, *r;        // u' (nu); residuals of d' and u'  (nu x 3)
    double *phi, *v;             // (rows x 3)
    double *q, *u, *u_dot, *lam; // of a stage; of the start  (lam)
    double *d;                   // a change of positions or of speeds  (nu)
    double *gain, *defect;       // of quadratures: over h; error over h / GAMMA  (ny)
    double *power, *power1;      // their rates at both ends  (ny)
    // fast modes in the error estimate, see radau_error.c
    bool leaves_out_fast_modes; // fast modes of speeds did not count at the last estimate
    int checks_to_skip;         // steps until the next estimate
    double *largest_speed;      // largest |u| at estimates so far  (nu)
    double *largest_position;   // largest coordinate of each speed  (nu)
    double *predicted;          // predicted positions and speeds  (2 nu)
    struct ct_dissipation_error {
        double all, rate; // change of outputs: without all vibrations; by dissipation, over h^5
    } dissipation;
    double largest_work; // at estimates so far
    struct {
        double h;     // the step of the last estimate; 0: none
        double error; // its dissipation, as an error of order 3
        int left;     // steps until the next estimate
    } vibration_check;
    double *vibration_scale; // scale of errors in fast modes  (nu)
};

/// out (n) = sum of the stages z (n x 3) with weights w.
static inline void ct_radau_weigh(double *out, const double *w, const double *z, int n)
{
    for (int k = 0; k < n; k++)
        out[k] = w[0] * z[k] + w[1] * z[k + n] + w[2] * z[k + 2 * n];
}

/// Solves the real system, that of the first component in the basis of eigenvectors. Changes of u
/// are eliminated: r += (c M + C) F and v += J F before the solution, and u changes by (c - N) d -
/// J' c eta + F.
static inline void ct_radau_solve(struct ct_radau *s, const int nu, const int m)
{
    struct ct_newton_iteration *it = s->it;
    const double c = it->c, *F = s->F;
    double *d = s->change.d, *u = s->change.u, *eta = s->change.eta;
    const bool is_sparse = nu > CT_MOST_INVERTED && it->sparse;
    if (is_sparse) {
        ct_newton_add_motion(it->sparse, s->r, c, F, 0, NULL);
        ct_newton_add_rows(it->sparse, s->v, 1, F);
    }
    for (int j = 0; j < nu && !is_sparse; j++) {
        ct_vector_add(s->r, c * F[j], it->M + nu * j, (size_t)nu);
        ct_vector_add(s->r, F[j], it->C + nu * j, (size_t)nu);
        ct_vector_add(s->v, F[j], it->J + m * j, (size_t)m);
    }
    ct_newton_iteration_solve(it, d, eta, s->change.lam, s->r, s->phi, s->v);
    for (int k = 0; k < nu; k++)
        u[k] = c * d[k] + F[k];
    if (!s->dae->is_plain)
        ct_newton_iteration_add_rotation(it, u, -1, d);
    for (int i = 0; i < m; i++)
        eta[i] *= c;
    if (m)
        ct_newton_iteration_add_constraint_force(it, u, u, -1, eta, nu, m);
}

/// The error estimate of the states: its norm in *err, the estimate in s->change. tol: the
/// tolerance of the estimate.
enum ct_eval ct_radau_estimate(struct ct_radau *s, const struct ct_problem *p,
                               const struct ct_tolerance *tol, double t, const double *y,
                               const double *dy, double *y1, double *dy1, double *err,
                               struct ct_integrate_stats *stats);
/// The larger of err, the error of the states, and the errors of outputs and quadratures.
double ct_radau_error_of_outputs(struct ct_radau *s, const struct ct_problem *p, double t1,
                                 const double *y, const struct ct_tolerance *estimate_tol,
                                 const double *y1, double err);
/// The tolerance of the error estimate, which is of order 3, that belongs to a tolerance of the
/// step.
const struct ct_tolerance *ct_radau_estimate_tolerance(struct ct_radau *s,
                                                       const struct ct_tolerance *tolerance);
/// The error that the Newton iteration leaves in sensitive outputs (8.11) at the end of the step,
/// y1, dy1, where 1 is the tolerance. Small errors of positions are large errors of stiff forces.
double ct_radau_iteration_error(struct ct_radau *s, const struct ct_problem *p,
                                const struct ct_tolerance *estimate_tol, double t1,
                                const double *y1, const double *dy1, double states);
/// ct_method.dense_error; slope: weights of the stages in the rates there.
enum ct_eval ct_radau_dense_error(struct ct_radau *s, const struct ct_problem *p, double t,
                                  const double *slope, double *y, double *err,
                                  struct ct_integrate_stats *stats);

#endif
