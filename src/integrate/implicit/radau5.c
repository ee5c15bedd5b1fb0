// Radau IIA of three stages and order 5 on the stabilised index-2 form.
//
//     d' = T^-1(d) u + J' eta,   r(t, q, u, u', lam) = 0,   Phi(q) = 0,   v(q, u) = 0,   q = q0 (+) d
//
// Collocation at three points of the step; d and u are of order 5, lam of order 3. Stages are found
// by a simplified Newton iteration. The inverse of the Runge-Kutta matrix has one real and two
// complex eigenvalues, so a correction takes one real and one complex linear system. Positions are
// expressed by increments d from the start of the step, so that quaternions keep their norm and the
// method its order. The Newton matrix approximates T^-1 by 1 + d~/2; chains of many spherical
// joints converge slowly with less.
//
// The error estimate is that of an embedded formula of order 3 that uses the start as an additional
// stage, filtered by the real system; eta and lam do not count. Dense output is the collocation
// polynomial.
//
// Source: Hairer and Wanner (1996), IV.8 and VII.4, key hairer1996; formulation 8.4.
#include "integrate/implicit/radau.h"

#include <complex.h>
#include <math.h>
#include <string.h>

// Scales of the Lagrange polynomials: one over c_i times its differences to the other two nodes.
static const double SCALE[STAGES]
    = {1 / (C1 * (C1 - C2) * (C1 - 1)), 1 / (C2 * (C2 - C1) * (C2 - 1)),
       1 / ((1 - C1) * (1 - C2))};

// A^-1
static const double INVERSE[STAGES][STAGES]
    = {{2 + SQRT6 / 2, -6. / 5 + 29 * SQRT6 / 30, 2. / 5 - 4 * SQRT6 / 15},
       {-6. / 5 - 29 * SQRT6 / 30, 2 - SQRT6 / 2, 2. / 5 + 4 * SQRT6 / 15},
       {-1 + 8 * SQRT6 / 3, -1 - 8 * SQRT6 / 3, 5}};

// Weights of the stages in the error estimate.
static const double E[STAGES] = {-(13 + 7 * SQRT6) / 3, (-13 + 7 * SQRT6) / 3, -1. / 3};

static void create_stages(struct ct_arena *a, struct ct_radau_stages *s,
                          const struct ct_dae *dae)
{
    s->d = CT_NEWN(a, double, STAGES * dae->nu + 1);
    s->u = CT_NEWN(a, double, STAGES * dae->nu + 1);
    s->lam = CT_NEWN(a, double, STAGES * dae->most_rows + 1);
    s->eta = CT_NEWN(a, double, STAGES * dae->most_rows + 1);
}

static void *create(struct ct_arena *a, const struct ct_method *method,
                    const struct ct_problem *p)
{
    struct ct_radau *s = CT_NEW(a, struct ct_radau);
    const int nu = p->dae->nu, m = p->dae->most_rows;
    (void)method;
    s->dae = p->dae;
    s->it = ct_newton_iteration_create(a, p, true, true);
    create_stages(a, &s->before, p->dae);
    create_stages(a, &s->now, p->dae);
    create_stages(a, &s->change, p->dae);
    double **const stages_of_speeds[] = {&s->F, &s->r};
    double **const stages_of_rows[] = {&s->phi, &s->v};
    double **const speeds[] = {&s->rate,
                               &s->u,
                               &s->u_dot,
                               &s->d,
                               &s->largest_speed,
                               &s->vibration_scale,
                               &s->largest_position};
    for (size_t i = 0; i < COUNT(stages_of_speeds); i++)
        *stages_of_speeds[i] = CT_NEWN(a, double, STAGES *nu + 1);
    for (size_t i = 0; i < COUNT(stages_of_rows); i++)
        *stages_of_rows[i] = CT_NEWN(a, double, STAGES *m + 1);
    for (size_t i = 0; i < COUNT(speeds); i++)
        *speeds[i] = CT_NEWN(a, double, nu + 1);
    s->predicted = CT_NEWN(a, double, 2 * nu + 1);
    s->lam = CT_NEWN(a, double, m + 1);
    s->q = CT_NEWN(a, double, p->dae->nq + 1);
    s->gain = CT_NEWN(a, double, p->ny);
    s->defect = CT_NEWN(a, double, p->ny);
    s->power = CT_NEWN(a, double, p->ny);
    s->power1 = CT_NEWN(a, double, p->ny);
    s->is_fresh = true;
    return s;
}

static void restart(void *work)
{
    struct ct_radau *s = work;
    s->is_fresh = true;
    s->was_tried = false;
    s->vibration_check.h = 0;
    s->dissipation = (struct ct_dissipation_error){0};
    ct_newton_iteration_forget(s->it);
}

static void accept(void *work)
{
    struct ct_radau *s = work;
    const struct ct_radau_stages spare = s->before;
    s->before = s->now;
    s->now = spare;
    s->is_fresh = s->was_tried = false;
}

// ---- the polynomial -----------------------------------------------------------------------------

// w (out): weights of the stages in the collocation polynomial at x of the step, which is zero at x
// = 0.
static void lagrange(double *w, double x)
{
    const double a = x - C[0], b = x - C[1], c = x - C[2];
    w[0] = x * b * c * SCALE[0];
    w[1] = x * a * c * SCALE[1];
    w[2] = x * a * b * SCALE[2];
}

// The same for multipliers: the parabola through the three stages, as there is no value at the
// start.
static void lagrange_inner(double *w, double x)
{
    const double a = x - C[0], b = x - C[1], c = x - C[2];
    w[0] = b * c * SCALE[0] * C[0];
    w[1] = a * c * SCALE[1] * C[1];
    w[2] = a * b * SCALE[2] * C[2];
}

// Weights for a step of size h. Most steps are as long as the one before.
static void find_weights(struct ct_radau *s, double h)
{
    const double ratio = s->is_fresh ? 0 : h / s->before.h;
    for (int i = 0; i < STAGES && s->h != h; i++) {
        for (int j = 0; j < STAGES; j++)
            s->slope[i][j] = INVERSE[i][j] / h;
        s->defect_of[i] = E[i] / h;
    }
    s->h = h;
    for (int i = 0; i < STAGES && s->ratio != ratio; i++) {
        lagrange(s->extrapolation[i], 1 + C[i] * ratio);
        s->extrapolation[i][STAGES - 1] -= 1;
        lagrange_inner(s->extrapolation_lam[i], 1 + C[i] * ratio);
    }
    s->ratio = ratio;
}

// Starting values of the stages: by extrapolation of the last collocation polynomial, or along a
// line.
static void predict(struct ct_radau *s, double h, const double *u0, const double *u_dot0)
{
    const int nu = s->dae->nu, m = s->it->m;
    struct ct_radau_stages *now = &s->now;
    now->h = h;
    for (int i = 0; i < STAGES; i++) {
        double *d = now->d + i * nu, *u = now->u + i * nu;
        if (s->is_fresh) {
            for (int k = 0; k < nu; k++) {
                d[k] = C[i] * h * u0[k];
                u[k] = C[i] * h * u_dot0[k];
            }
        } else {
            ct_radau_weigh(d, s->extrapolation[i], s->before.d, nu);
            ct_radau_weigh(u, s->extrapolation[i], s->before.u, nu);
        }
        for (int k = 0; k < m; k++)
            now->eta[k + i * m] = 0;
        if (s->knows_multipliers)
            ct_radau_weigh(now->lam + i * m, s->extrapolation_lam[i], s->before.lam, m);
        else
            ct_stepper_copy(now->lam + i * m, s->lam, m);
    }
}

// ---- the iteration ------------------------------------------------------------------------------

// Position and speed of stage i.
static inline void set_stage(struct ct_radau *s, const double *y, int i)
{
    const int nq = s->dae->nq, nu = s->dae->nu;
    ct_newton_iteration_move(s->dae, y, s->now.d + i * nu, s->q);
    for (int k = 0; k < nu; k++)
        s->u[k] = y[nq + k] + s->now.u[k + i * nu];
}

static enum ct_eval find_residuals(struct ct_radau *s, double t, const double *y,
                                   struct ct_integrate_stats *stats)
{
    const struct ct_dae *dae = s->dae;
    const int nu = dae->nu, m = s->it->m;
    const struct ct_radau_stages *z = &s->now;
    for (int i = 0; i < STAGES; i++) {
        double *F = s->F + i * nu;
        const double *rate = dae->is_plain ? s->u : s->rate;
        set_stage(s, y, i);
        if (!dae->is_plain)
            dae->chart_rate(dae->user, z->d + i * nu, s->u, s->rate);
        ct_radau_weigh(F, s->slope[i], z->d, nu);
        for (int k = 0; k < nu; k++)
            F[k] -= rate[k];
        if (m)
            ct_newton_iteration_add_constraint_force(s->it, F, F, -1, z->eta + i * m, nu, m);
        ct_radau_weigh(s->u_dot, s->slope[i], z->u, nu);
        stats->evaluations++;
        const enum ct_eval e
            = dae->residual(dae->user, t + C[i] * z->h, s->q, s->u, s->u_dot, z->lam + i * m,
                            s->r + i * nu, s->phi + i * m, s->v + i * m);
        if (e != CT_EVAL_OK)
            return e;
    }
    return CT_EVAL_OK;
}

// Transforms stages z (n x 3) to the basis of eigenvectors (T^-1) or back (T).
static inline void transform(double *z, const double (*turn)[STAGES], int n)
{
    for (int k = 0; k < n; k++) {
        const double x[STAGES] = {z[k], z[k + n], z[k + 2 * n]};
        for (int i = 0; i < STAGES; i++)
            z[k + i * n] = turn[i][0] * x[0] + turn[i][1] * x[1] + turn[i][2] * x[2];
    }
}

// The elimination of speeds in solve_complex, for sparse matrices.
static void eliminate_speeds_sparse(struct ct_radau *s, double a, double b)
{
    const struct ct_newton *matrix = s->it->sparse;
    const int nu = s->it->nu, m = s->it->m;
    const double *F = s->F + nu, *G = F + nu;
    double *r = s->r + nu, *v = s->v + m;
    ct_newton_add_motion(matrix, r, a, F, -b, G);
    ct_newton_add_motion(matrix, r + nu, a, G, b, F);
    ct_newton_add_rows(matrix, v, 1, F);
    ct_newton_add_rows(matrix, v + m, 1, G);
}

// Solves the complex system, c = a + i b. Real and imaginary part are the second and third
// component.
static inline void solve_complex(struct ct_radau *s, const int nu, const int m)
{
    struct ct_newton_iteration *it = s->it;
    const double a = ALPHA / s->h, b = BETA / s->h, *F = s->F + nu, *G = F + nu;
    double *r = s->r + nu, *v = s->v + m, *d = s->change.d + nu, *u = s->change.u + nu,
           *eta = s->change.eta + m;
    const bool is_sparse = nu > CT_MOST_INVERTED && it->sparse;
    if (is_sparse)
        eliminate_speeds_sparse(s, a, b);
    for (int j = 0; j < nu && !is_sparse; j++) {
        const double *M = it->M + nu * j, *damping = it->C + nu * j, *J = it->J + m * j;
        ct_vector_add(r, a * F[j] - b * G[j], M, (size_t)nu);
        ct_vector_add(r, F[j], damping, (size_t)nu);
        ct_vector_add(r + nu, a * G[j] + b * F[j], M, (size_t)nu);
        ct_vector_add(r + nu, G[j], damping, (size_t)nu);
        ct_vector_add(v, F[j], J, (size_t)m);
        ct_vector_add(v + m, G[j], J, (size_t)m);
    }
    ct_newton_iteration_solve_complex(it, d, eta, s->change.lam + m, r, s->phi + m, v);
    for (int k = 0; k < nu; k++) {
        u[k] = a * d[k] - b * d[k + nu] + F[k];
        u[k + nu] = a * d[k + nu] + b * d[k] + G[k];
    }
    for (int i = 0; i < m; i++) {
        const double x = eta[i], y = eta[i + m];
        eta[i] = a * x - b * y;
        eta[i + m] = a * y + b * x;
    }
    for (int i = 0; i < STAGES - 1; i++) {
        if (!s->dae->is_plain)
            ct_newton_iteration_add_rotation(it, u + i * nu, -1, d + i * nu);
        if (m)
            ct_newton_iteration_add_constraint_force(it, u + i * nu, u + i * nu, -1,
                                                     eta + i * m, nu, m);
    }
}

static inline void add(double *z, const double *change, int n)
{
    for (int i = 0; i < n; i++)
        z[i] += change[i];
}

// Solves for corrections, adds them to the stages and returns their norm.
static inline double correct_stages(struct ct_radau *s, const int nu, const int m)
{
    transform(s->F, T_INVERSE, nu);
    transform(s->r, T_INVERSE, nu);
    transform(s->phi, T_INVERSE, m);
    transform(s->v, T_INVERSE, m);
    ct_radau_solve(s, nu, m);
    solve_complex(s, nu, m);
    transform(s->change.d, T, nu);
    transform(s->change.u, T, nu);
    transform(s->change.lam, T, m);
    transform(s->change.eta, T, m);
    add(s->now.d, s->change.d, STAGES * nu);
    add(s->now.u, s->change.u, STAGES * nu);
    add(s->now.lam, s->change.lam, STAGES * m);
    add(s->now.eta, s->change.eta, STAGES * m);
    if (m)
        ct_newton_iteration_note_multipliers(s->it, s->now.lam, s->change.lam, STAGES * m);
    return ct_newton_iteration_norm(s->it, s->change.d, s->change.u, nu, STAGES);
}

static enum ct_eval correct(struct ct_radau *s, double t, const double *y,
                            enum ct_convergence *verdict, struct ct_integrate_stats *stats)
{
    const int nu = s->it->nu, m = s->it->m;
    const enum ct_eval e = find_residuals(s, t, y, stats);
    if (e != CT_EVAL_OK)
        return e;
    // constant sizes let the compiler unroll loops for one and two degrees of freedom and for a
    // planar loop of three coordinates
    const double size = nu == 3 && m == 2 ? correct_stages(s, 3, 2)
                      : m || nu > 2       ? correct_stages(s, nu, m)
                      : nu == 1           ? correct_stages(s, 1, 0)
                                          : correct_stages(s, 2, 0);
    *verdict
        = ct_newton_iteration_test_convergence(s->it, size, s->change.d, s->change.u, STAGES);
    return CT_EVAL_OK;
}

// New derivatives, if they are too old. They are evaluated at the predicted second stage, in the
// middle of the step; in a first step, which has no good prediction, at the start.
static enum ct_eval refresh(struct ct_radau *s, double t, double h, const double *y,
                            const double *dy, struct ct_integrate_stats *stats)
{
    const int nq = s->dae->nq, middle = 1;
    if (!ct_newton_iteration_is_old(s->it))
        return CT_EVAL_OK;
    if (s->is_fresh)
        return ct_newton_iteration_refresh(s->it, t, y, y + nq, dy + nq, s->lam, stats);
    set_stage(s, y, middle);
    ct_radau_weigh(s->u_dot, s->slope[middle], s->now.u, s->dae->nu);
    return ct_newton_iteration_refresh(s->it, t + C[middle] * h, s->q, s->u, s->u_dot, s->lam,
                                       stats);
}

// Newton corrections until convergence or divergence.
static enum ct_eval correct_until(struct ct_radau *s, double t, const double *y, enum ct_eval e,
                                  enum ct_convergence *verdict,
                                  struct ct_integrate_stats *stats)
{
    while (e == CT_EVAL_OK && *verdict == CT_ITERATING)
        e = correct(s, t, y, verdict, stats);
    return e;
}

static enum ct_eval iterate(struct ct_radau *s, double t, double h, const double *y,
                            const double *dy, struct ct_integrate_stats *stats)
{
    const int nq = s->dae->nq;
    const double c = GAMMA / h;
    find_weights(s, h);
    do {
        enum ct_convergence verdict = CT_ITERATING;
        predict(s, h, y + nq, dy + nq);
        enum ct_eval e = refresh(s, t, h, y, dy, stats);
        if (e == CT_EVAL_OK
            && !ct_newton_iteration_factor(s->it, c, c * c, (ALPHA + BETA * I) / h, stats))
            e = CT_EVAL_RETRY;
        ct_newton_iteration_start(s->it);
        e = correct_until(s, t, y, e, &verdict, stats);
        if (e == CT_EVAL_FATAL || verdict == CT_CONVERGED)
            return e;
    } while (ct_newton_iteration_can_refresh(s->it));
    return CT_EVAL_RETRY;
}

// Further corrections after convergence, down to round-off.
static enum ct_eval iterate_to_roundoff(struct ct_radau *s, double t, const double *y,
                                        struct ct_integrate_stats *stats)
{
    enum ct_convergence verdict = CT_ITERATING;
    ct_newton_iteration_continue(s->it);
    return correct_until(s, t, y, CT_EVAL_OK, &verdict, stats);
}

// ---- a step -------------------------------------------------------------------------------------

// Adds the rates of quadratures at stage i, from its derivative dy1.
static void add_power(struct ct_radau *s, int ny, int i, const double *dy1)
{
    for (int k = s->dae->nq + s->dae->nu; k < ny; k++) {
        s->gain[k] += A[STAGES - 1][i] * dy1[k];
        s->defect[k] += (E[0] * A[0][i] + E[1] * A[1][i] + E[2] * A[2][i]) * dy1[k];
    }
}

// y1 and dy1 from the last stage; quadratures and their errors from their rates at the stages,
// where there are any.
static enum ct_eval finish(struct ct_radau *s, const struct ct_problem *p, double t, double h,
                           const double *y, const double *dy, double *y1, double *dy1,
                           struct ct_integrate_stats *stats)
{
    const int nq = s->dae->nq, nu = s->dae->nu, first = nq + nu, last = STAGES - 1;
    const bool has_power = first < p->ny && !s->dae->quadratures_are_constant;
    enum ct_eval e = CT_EVAL_OK;
    for (int k = first; k < p->ny; k++) {
        y1[k] = y[k];
        s->gain[k] = 0;
        s->defect[k] = dy[k];
    }
    for (int i = has_power ? 0 : last; i < STAGES && e == CT_EVAL_OK; i++) {
        set_stage(s, y, i);
        ct_stepper_copy(y1, s->q, nq);
        ct_stepper_copy(y1 + nq, s->u, nu);
        if (i == last && p->project) // removes the error that the iteration leaves
            e = p->project(p->user, t + h, y1);
        if (e == CT_EVAL_OK)
            e = ct_stepper_rhs(p, t + C[i] * h, y1, dy1, stats);
        if (e == CT_EVAL_OK)
            add_power(s, p->ny, i, dy1);
    }
    for (int k = first; k < p->ny; k++) {
        y1[k] += h * s->gain[k];
        s->defect[k] *= h / GAMMA;
    }
    return e;
}

// Starting values of multipliers: those at the end of the last step, or computed at the start.
static enum ct_eval find_multipliers(struct ct_radau *s, double t, const double *y, bool is_new)
{
    const int m = s->it->m;
    if (m == 0)
        return CT_EVAL_OK;
    s->knows_multipliers = !s->is_fresh && !is_new;
    if (!s->knows_multipliers)
        return s->dae->start(s->dae->user, t, y, s->u_dot, s->lam);
    ct_stepper_copy(s->lam, s->before.lam + (STAGES - 1) * m, m);
    return CT_EVAL_OK;
}

// y1 and dy1 from the stages, and the error of the states, where a tolerance is given.
static enum ct_eval finish_with_estimate(struct ct_radau *s, const struct ct_problem *p,
                                         double t, double h, const double *y, const double *dy,
                                         const struct ct_tolerance *estimate_tol, double *y1,
                                         double *dy1, double *err,
                                         struct ct_integrate_stats *stats)
{
    enum ct_eval e = estimate_tol
                       ? ct_radau_estimate(s, p, estimate_tol, t, y, dy, y1, dy1, err, stats)
                       : CT_EVAL_OK;
    if (e == CT_EVAL_OK)
        e = finish(s, p, t, h, y, dy, y1, dy1, stats);
    return e;
}

// The error that the iteration may leave in sensitive outputs (8.11), as part of the tolerance.
// Derived: the same as for states, kappa of RADAU5.
static const double iteration_share = 0.03;

static enum ct_eval step(const struct ct_problem *p, double t, double h, const double *y,
                         const double *dy, const struct ct_tolerance *tolerance, double *y1,
                         double *dy1, double *err, void *work, struct ct_integrate_stats *stats)
{
    struct ct_radau *s = work;
    const struct ct_tolerance *tol
        = tolerance ? ct_radau_estimate_tolerance(s, tolerance) : NULL;
    const int first = s->dae->nq + s->dae->nu; // of quadratures
    const bool has_new_rows = ct_newton_iteration_begin(s->it, tol, h, y);
    enum ct_eval e = find_multipliers(s, t, y, has_new_rows);
    if (e == CT_EVAL_OK)
        e = iterate(s, t, h, y, dy, stats);
    if (e == CT_EVAL_OK)
        e = finish_with_estimate(s, p, t, h, y, dy, tol, y1, dy1, err, stats);
    if (e == CT_EVAL_OK && tol
        && ct_radau_iteration_error(s, p, tol, t + h, y1, dy1, *err) > iteration_share) {
        e = iterate_to_roundoff(s, t, y, stats);
        if (e == CT_EVAL_OK)
            e = finish_with_estimate(s, p, t, h, y, dy, tol, y1, dy1, err, stats);
        if (e == CT_EVAL_OK && ct_radau_iteration_error(s, p, tol, t + h, y1, dy1, *err) > 1)
            e = CT_EVAL_RETRY;
    }
    if (e == CT_EVAL_OK && tol)
        *err = ct_radau_error_of_outputs(s, p, t + h, y, tol, y1, *err);
    s->was_tried = true;
    if (e != CT_EVAL_OK)
        return e;
    ct_stepper_copy(s->power + first, dy + first, p->ny - first);
    ct_stepper_copy(s->power1 + first, dy1 + first, p->ny - first);
    return CT_EVAL_OK;
}

// The collocation polynomial; cubic Hermite for quadratures.
static void dense(const struct ct_problem *p, double h, double theta, const double *y,
                  const double *y1, void *work, double *out)
{
    struct ct_radau *s = work;
    const int nq = s->dae->nq, nu = s->dae->nu;
    double w[STAGES];
    lagrange(w, theta);
    ct_radau_weigh(s->d, w, s->now.d, nu);
    s->dae->retract(s->dae->user, y, s->d, out);
    ct_radau_weigh(s->d, w, s->now.u, nu);
    for (int k = 0; k < nu; k++)
        out[nq + k] = y[nq + k] + s->d[k];
    const int i = nq + nu;
    ct_stepper_hermite(out + i, theta, h, y + i, s->power + i, y1 + i, s->power1 + i,
                       p->ny - i);
}

// w (out): weights of the stages in the polynomial's slope at x of a step h.
static void lagrange_slope(double *w, double x, double h)
{
    const double a = x - C[0], b = x - C[1], c = x - C[2];
    w[0] = (b * c + x * (b + c)) * SCALE[0] / h;
    w[1] = (a * c + x * (a + c)) * SCALE[1] / h;
    w[2] = (a * b + x * (a + b)) * SCALE[2] / h;
}

static enum ct_eval dense_error(const struct ct_problem *p, double t, double h, double theta,
                                double *y, void *work, double *err,
                                struct ct_integrate_stats *stats)
{
    double w[STAGES];
    lagrange_slope(w, theta, h);
    return ct_radau_dense_error(work, p, t + theta * h, w, y, err, stats);
}

const struct ct_method ct_method_radau5 = {
    .name = "radau5",
    .summary
    = "Radau IIA of order 5 on the stabilised index-2 form, for stiffness at high accuracy",
    .source = "hairer1996",
    .order = 5,
    .error_order = 3,
    .is_implicit = true,
    .kept_range = {1, 1.2},
    .most_growth = 8,
    .create = create,
    .restart = restart,
    .accept = accept,
    .step = step,
    .dense = dense,
    .dense_error = dense_error,
};
