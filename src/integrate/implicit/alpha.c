// One step of the generalised-alpha family; see alpha.h. It is a simplified Newton iteration for
// the increment d of positions, on which speeds and accelerations depend linearly.
//
// Sources: Bruls, Cardona and Arnold (2012), key bruls2012; error estimate and change of the step
// size: theory 8.2. In the term J' eta the matrix J is that of the last derivatives. This does not
// change the order, as eta is as small as the error of the step.
#include "integrate/implicit/alpha.h"
#include "integrate/implicit/newton_iteration.h"

#include <math.h>
#include <string.h>

// Data at the end of a step, for the next one.
struct memory {
    double h;                // of the step that ends here
    double *a, *u_dot, *lam; // (nu), (nu), (rows)
    double *jerk;            // u'' in the middle of that step  (nu)
    double *slope,
        *slope_difference; // first and second divided differences of u'  (nu)
    double *lam_slope, *lam_slope_difference; // the same of lam  (rows)
    double *a_roundoff,
        *jerk_roundoff; // round-off errors of a and `jerk`, with constraints  (nu)
    double *rate;       // rates of quadratures at the start of that step  (ny)
};

// Coefficients of a step of size h after one of size `before`: derivatives of speeds, of a and of
// accelerations by positions in a correction, and (8.1).
struct factors {
    double h, before, by_speed, by_u_dot;
    double a_by_speed, u_dot_by_speed;  // of a correction of speeds
    double per_h, per_two_steps, ratio; // 1/h, 1/(h + before), h/before
    double per_gamma_h, a0_factor;      // 1/(gamma h), (1 - gamma)/gamma
    // (8.1): a = u_dot1_weight u' at the end + u_dot0_weight u' at the start - a0_weight a0
    double u_dot1_weight, u_dot0_weight, a0_weight;
    double u_a0, u_a, d_a0, d_a; // changes of speeds and positions by a0 and a
};

// A correction of positions, of speeds and of multipliers.
struct correction {
    const double *d, *u, *lam;
};

struct state {
    const struct ct_dae *dae;
    const struct ct_alpha *c;
    struct ct_newton_iteration *it;
    struct factors f;
    double a_factor;                            // 1/(1 - alpha_m)
    double position_factor, speed_error_factor; // (8.3) over h^2, (8.8) over h^3 u'''
    bool is_fresh, has_jerk;               // there is no step before; u'' at the start is known
    struct memory memory[2], *start, *end; // of the step
    double *a0, *jerk;                     // (nu): a at the start, for this step's size; u''
    // increment of positions (nu), speeds (nu) and positions (nq) at the end
    double *d, *u, *q;
    double *speed_roundoff; // error of speeds that the Newton iteration leaves  (nu)
    double *dd, *du; // corrections (nu each), stored in turn in (ny + nu), followed by zeros
    double *eta, *dlam;
    double *r, *phi, *v; // stored in turn
    struct correction last_correction;
    double *rate1, *out;      // for dense output: d' at the end; an increment (nu)
    double *end_rate, *error; // rates at the end and errors, of quadratures alone  (ny)
};

// The leading error of speeds is h^3 u''' times this.  (8.8)
static double speed_factor(const struct ct_alpha *c)
{
    const double delta = c->alpha_m - c->alpha_f;
    const double a = (1 - c->alpha_f - (1 - c->alpha_m) * (1 + 2 * delta) - delta * delta) / 2;
    return 1. / 12 - delta * delta / 2 + a;
}

void *ct_alpha_create(struct ct_arena *a, const struct ct_method *method,
                      const struct ct_problem *p)
{
    struct state *s = CT_NEW(a, struct state);
    s->dae = p->dae;
    s->start = &s->memory[0];
    s->end = &s->memory[1];
    s->c = method->coefficients;
    s->a_factor = 1 / (1 - s->c->alpha_m);
    s->position_factor = s->c->beta + 1. / 12 - s->c->gamma / 2;
    s->speed_error_factor = speed_factor(s->c);
    s->it = ct_newton_iteration_create(a, p, s->c->is_stabilised, false);
    double **const speeds[] = {&s->start->slope,
                               &s->start->slope_difference,
                               &s->end->slope,
                               &s->end->slope_difference,
                               &s->start->a,
                               &s->start->u_dot,
                               &s->start->jerk,
                               &s->end->a,
                               &s->end->u_dot,
                               &s->end->jerk,
                               &s->a0,
                               &s->jerk,
                               &s->d,
                               &s->u,
                               &s->rate1,
                               &s->out,
                               &s->speed_roundoff,
                               &s->start->a_roundoff,
                               &s->start->jerk_roundoff,
                               &s->end->a_roundoff,
                               &s->end->jerk_roundoff};
    double **const rows[] = {&s->start->lam,
                             &s->end->lam,
                             &s->start->lam_slope,
                             &s->end->lam_slope,
                             &s->start->lam_slope_difference,
                             &s->end->lam_slope_difference,
                             &s->eta,
                             &s->dlam};
    for (size_t i = 0; i < COUNT(speeds); i++)
        *speeds[i] = CT_NEWN(a, double, p->dae->nu + 1);
    for (size_t i = 0; i < COUNT(rows); i++)
        *rows[i] = CT_NEWN(a, double, p->dae->most_rows + 1);
    s->q = CT_NEWN(a, double, p->dae->nq + 1);
    s->r = CT_NEWN(a, double, p->dae->nu + 2 * p->dae->most_rows + 1);
    s->dd = CT_NEWN(a, double, p->ny + p->dae->nu);
    s->du = s->dd + p->dae->nu;
    double **const states[] = {&s->start->rate, &s->end->rate, &s->end_rate, &s->error};
    for (size_t i = 0; i < COUNT(states); i++)
        *states[i] = CT_NEWN(a, double, p->ny);
    s->is_fresh = true;
    return s;
}

void ct_alpha_restart(void *work)
{
    struct state *s = work;
    s->is_fresh = true;
    s->has_jerk = false;
    ct_newton_iteration_forget(s->it);
}

void ct_alpha_accept(void *work)
{
    struct state *s = work;
    struct memory *spare = s->start;
    s->start = s->end;
    s->end = spare;
    s->is_fresh = false;
}

static void find_factors(struct state *s, double h)
{
    const struct ct_alpha *c = s->c;
    const double before = s->is_fresh ? INFINITY : s->start->h;
    if (s->f.h == h && s->f.before == before)
        return;
    const double by_a = 1 / (c->beta * h * h), by_speed = c->gamma / (c->beta * h);
    const double by_u_dot = by_a * (1 - c->alpha_m) / (1 - c->alpha_f);
    s->f = (struct factors){.h = h,
                            .before = before,
                            .by_speed = by_speed,
                            .by_u_dot = by_u_dot,
                            .a_by_speed = by_a / by_speed,
                            .u_dot_by_speed = by_u_dot / by_speed,
                            .per_h = 1 / h,
                            .per_two_steps = 1 / (h + before),
                            .ratio = h / before,
                            .per_gamma_h = 1 / (c->gamma * h),
                            .a0_factor = (1 - c->gamma) / c->gamma,
                            .u_dot1_weight = (1 - c->alpha_f) * s->a_factor,
                            .u_dot0_weight = c->alpha_f * s->a_factor,
                            .a0_weight = c->alpha_m * s->a_factor,
                            .u_a0 = h * (1 - c->gamma),
                            .u_a = h * c->gamma,
                            .d_a0 = h * h * (0.5 - c->beta),
                            .d_a = h * h * c->beta};
}

// ---- the start of a step ------------------------------------------------------------------------

// u'' at the start, by a difference along the motion over a hundredth of the step, where neither
// round-off nor truncation error matters.
static enum ct_eval find_jerk(struct state *s, const struct ct_problem *p, double t, double h,
                              const double *y, const double *dy, double *y1, double *dy1,
                              struct ct_integrate_stats *stats)
{
    const int nu = s->dae->nu, nq = s->dae->nq;
    const double ahead = h / 100;
    for (int i = 0; i < p->ny; i++)
        y1[i] = y[i] + ahead * dy[i];
    const enum ct_eval e = ct_stepper_rhs(p, t + ahead, y1, dy1, stats);
    for (int k = 0; k < nu && e == CT_EVAL_OK; k++)
        s->jerk[k] = (dy1[nq + k] - dy[nq + k]) / ahead;
    s->has_jerk = e == CT_EVAL_OK;
    return e;
}

// Multipliers of newly selected rows.
static enum ct_eval start_multipliers(struct state *s, double t, const double *y)
{
    for (int i = 0; i < s->it->m; i++)
        s->start->lam_slope[i] = s->start->lam_slope_difference[i] = 0;
    return s->dae->start(s->dae->user, t, y, s->du, s->start->lam);
}

// Sets a0 for the size of this step, and the multipliers of the present rows.
static enum ct_eval begin(struct state *s, const struct ct_problem *p, double t, double h,
                          const double *y, const double *dy,
                          const struct ct_tolerance *tolerance, double *y1, double *dy1,
                          struct ct_integrate_stats *stats)
{
    const struct ct_alpha *c = s->c;
    const int nu = s->dae->nu;
    const double *u_dot = dy + s->dae->nq;
    enum ct_eval e = CT_EVAL_OK;
    if (s->is_fresh && !c->starts_anew && !s->has_jerk)
        e = find_jerk(s, p, t, h, y, dy, y1, dy1, stats);
    const bool has_new_rows = ct_newton_iteration_begin(s->it, tolerance, h, y);
    s->phi = s->r + nu;
    s->v = s->phi + s->it->m;
    if (e == CT_EVAL_OK && (s->is_fresh || has_new_rows))
        e = start_multipliers(s, t, y);
    if (e != CT_EVAL_OK)
        return e;
    if (s->is_fresh || c->starts_anew)
        ct_stepper_copy(s->start->u_dot, u_dot, nu);
    find_factors(s, h);
    const double *now = s->start->u_dot, *a = s->start->a, ratio = s->f.ratio;
    if (!s->is_fresh && !c->starts_anew)
        for (int k = 0; k < nu; k++)
            s->a0[k] = now[k] + ratio * (a[k] - now[k]);
    else
        for (int k = 0; k < nu; k++)
            s->a0[k]
                = now[k] + (c->starts_anew ? 0 : (c->alpha_m - c->alpha_f) * h * s->jerk[k]);
    return CT_EVAL_OK;
}

// ---- the iteration ------------------------------------------------------------------------------

// Starting values of the iteration: accelerations and multipliers by extrapolation of their last
// one to three values. Those of the index-3 form have too much round-off to be extrapolated and are
// kept.
static inline void predict_for(struct state *s, double h, const double *y, const int nu)
{
    const struct ct_dae *dae = s->dae;
    const struct factors f = s->f;
    const double *u0 = y + dae->nq;
    const bool is_known = !s->is_fresh && s->c->is_stabilised;
    const double from_start = is_known ? h : 0, from_before = is_known ? h + s->start->h : 0;
    for (int k = 0; k < nu; k++) {
        const double u_dot = s->start->u_dot[k], a0 = s->a0[k];
        const double u_dot1
            = u_dot
            + from_start * (s->start->slope[k] + from_before * s->start->slope_difference[k]);
        const double a = f.u_dot1_weight * u_dot1 + f.u_dot0_weight * u_dot - f.a0_weight * a0;
        s->end->u_dot[k] = u_dot1;
        s->end->a[k] = a;
        s->u[k] = u0[k] + (f.u_a0 * a0 + f.u_a * a);
        s->d[k] = h * u0[k] + (f.d_a0 * a0 + f.d_a * a);
    }
    for (int i = 0; i < s->it->m; i++)
        s->end->lam[i]
            = s->start->lam[i]
            + from_start
                  * (s->start->lam_slope[i] + from_before * s->start->lam_slope_difference[i]);
    ct_newton_iteration_move(dae, y, s->d, s->q);
}

// Constant sizes let the compiler unroll loops for one degree of freedom and for planar loops of
// three coordinates.
static void predict(struct state *s, double h, const double *y)
{
    if (s->dae->nu == 1)
        predict_for(s, h, y, 1);
    else if (s->dae->nu == 3)
        predict_for(s, h, y, 3);
    else
        predict_for(s, h, y, s->dae->nu);
}

// s->last: the correction for the residuals r, phi, v.
static inline void solve(struct state *s, const int nu, const int m)
{
    struct ct_newton_iteration *it = s->it;
    ct_newton_iteration_solve(it, s->dd, s->eta, s->dlam, s->r, s->phi, s->v);
    for (int k = 0; k < nu; k++)
        s->du[k] = s->f.by_speed * s->dd[k];
    if (m)
        ct_newton_iteration_add_constraint_force(it, s->du, s->du, -s->f.by_speed, s->eta, nu,
                                                 m); // eta changes positions alone
    s->last_correction = (struct correction){s->dd, s->du, s->dlam};
}

// Adds the correction and returns its norm.
static inline double add_correction(struct state *s, const int nu, const int m)
{
    const struct factors f = s->f;
    const struct correction c = s->last_correction;
    for (int k = 0; k < nu; k++) {
        const double du = c.u[k];
        s->d[k] += c.d[k];
        s->u[k] += du;
        s->end->a[k] += f.a_by_speed * du;
        s->end->u_dot[k] += f.u_dot_by_speed * du;
    }
    for (int i = 0; i < m; i++)
        s->end->lam[i] += c.lam[i];
    // index-3 form: speeds have round-off over h, so convergence is tested for positions
    return s->c->is_stabilised ? ct_newton_iteration_norm(s->it, c.d, c.u, nu, 1)
                               : ct_newton_iteration_norm_of_positions(s->it, c.d, c.u, nu);
}

static inline double solve_and_add(struct state *s, const int nu, const int m)
{
    solve(s, nu, m);
    return add_correction(s, nu, m);
}

// *size (out): the norm of the correction. Constant sizes let the compiler unroll loops for few
// degrees of freedom.
static enum ct_eval find_correction(struct state *s, double t1, const double *y, double *size)
{
    const struct ct_dae *dae = s->dae;
    const int nu = s->it->nu, m = s->it->m;
    const enum ct_eval e = dae->residual(dae->user, t1, s->q, s->u, s->end->u_dot, s->end->lam,
                                         s->r, s->phi, s->v);
    if (e != CT_EVAL_OK)
        return e;
    *size = m == 2 && nu == 3 ? solve_and_add(s, 3, 2)
          : m || nu > 2       ? solve_and_add(s, nu, m)
          : nu == 1           ? solve_and_add(s, 1, 0)
                              : solve_and_add(s, 2, 0);
    ct_newton_iteration_move(dae, y, s->d, s->q);
    return CT_EVAL_OK;
}

static enum ct_eval correct(struct state *s, double t1, const double *y,
                            enum ct_convergence *verdict, struct ct_integrate_stats *stats)
{
    double size = 0;
    stats->evaluations++;
    const enum ct_eval e = find_correction(s, t1, y, &size);
    if (e == CT_EVAL_OK)
        *verdict = ct_newton_iteration_test_convergence(
            s->it, size, s->last_correction.d,
            s->c->is_stabilised ? s->last_correction.u : NULL, 1);
    return e;
}

// The error of speeds after the last correction; at round-off, the correction itself.
static void store_roundoff(struct state *s)
{
    const double remaining = ct_smaller(s->it->tail, 1);
    for (int k = 0; k < s->it->nu && s->it->m; k++)
        s->speed_roundoff[k] = remaining * fabs(s->last_correction.u[k]);
}

static enum ct_eval iterate(struct state *s, double t1, double h, const double *y,
                            struct ct_integrate_stats *stats)
{
    do {
        enum ct_convergence verdict = CT_ITERATING;
        predict(s, h, y);
        enum ct_eval e = CT_EVAL_OK;
        if (ct_newton_iteration_is_old(s->it))
            e = ct_newton_iteration_refresh(s->it, t1, s->q, s->u, s->end->u_dot, s->end->lam,
                                            stats);
        if (e == CT_EVAL_OK
            && !ct_newton_iteration_factor(s->it, s->f.by_speed, s->f.by_u_dot, 0, stats))
            e = CT_EVAL_RETRY;
        ct_newton_iteration_start(s->it);
        while (e == CT_EVAL_OK && verdict == CT_ITERATING)
            e = correct(s, t1, y, &verdict, stats);
        if (e == CT_EVAL_OK && s->it->m)
            ct_newton_iteration_note_multipliers(s->it, s->end->lam, s->last_correction.lam,
                                                 s->it->m);
        if (e == CT_EVAL_OK && verdict == CT_CONVERGED)
            store_roundoff(s);
        if (e == CT_EVAL_FATAL || verdict == CT_CONVERGED)
            return e;
    } while (ct_newton_iteration_can_refresh(s->it));
    return CT_EVAL_RETRY;
}

// ---- a step -------------------------------------------------------------------------------------

// Subtracts round-off from the error estimate of speeds. Near singular configurations speeds have a
// round-off error that grows with one over the square of the distance. Divided by h it enters u',
// and (8.8) multiplies it by h again. So the estimate contains it however short the step is, and
// shorter steps would not reduce it.
static inline void subtract_roundoff(struct state *s, double h, const int nu)
{
    const double a0_factor = s->f.a0_factor, per_h = s->f.per_gamma_h;
    const double ratio = s->f.ratio;
    const double speeds
        = s->is_fresh ? 0 : h * h * h * 2 * s->f.per_two_steps * fabs(s->speed_error_factor);
    for (int k = 0; k < nu; k++) {
        const double a0 = ratio * s->start->a_roundoff[k],
                     a1 = s->speed_roundoff[k] * per_h + a0_factor * a0;
        s->end->a_roundoff[k] = a1;
        s->end->jerk_roundoff[k] = s->f.per_h * (a0 + a1);
        const double roundoff
            = speeds
            * (s->end->jerk_roundoff[k] + (s->is_fresh ? 0 : s->start->jerk_roundoff[k]));
        s->du[k] = copysign(ct_larger(0, fabs(s->du[k]) - roundoff), s->du[k]);
    }
}

// The error estimate s->du of state variables of the model, of order 2 as for speeds (8.8). They
// have no round-off of constraints. In a first step the third derivative is not known, so an
// estimate of order 1 serves.
static void find_state_errors(struct state *s, double h)
{
    const double speeds = h * h * h * 2 * s->f.per_two_steps * s->speed_error_factor;
    for (int k = s->dae->nu - s->dae->nstate; k < s->dae->nu; k++)
        s->du[k] = s->is_fresh ? h * s->position_factor * (s->end->a[k] - s->a0[k])
                               : speeds * (s->end->jerk[k] - s->start->jerk[k]);
}

// s->dd and s->du (out) = error estimates of positions and speeds. Returns the norm of errors of
// positions and of state variables of the model.
static inline double find_errors(struct state *s, double h, const int nu)
{
    const double position_factor = h * h * s->position_factor, per_h = s->f.per_h;
    const bool knows_speeds = s->c->is_stabilised && !s->is_fresh;
    const double slope = knows_speeds ? 2 * s->f.per_two_steps : 0;
    const double speeds = h * h * h * slope * s->speed_error_factor;
    for (int k = 0; k < nu; k++) {
        const double change = s->end->a[k] - s->a0[k];
        const double jerk = per_h * change;
        s->dd[k] = position_factor * change;
        s->du[k] = speeds * (jerk - s->start->jerk[k]);
        s->end->jerk[k] = jerk;
    }
    if (s->it->m && s->c->is_stabilised)
        subtract_roundoff(s, h, nu);
    if (s->dae->nstate)
        find_state_errors(s, h);
    return ct_newton_iteration_norm_of_positions(s->it, s->dd, s->du, nu);
}

// The error estimate: leading error terms of positions (8.3) and of speeds (8.8). u''' is a
// difference of u'' in this step and the one before. The error of speeds is zero in a first step,
// and in the index-3 form, whose accelerations have round-off over h^2. It counts in outputs only.
static double estimate(struct state *s, const struct ct_problem *p,
                       const struct ct_tolerance *tolerance, double t1, double h,
                       const double *y1)
{
    const double states = s->dae->nu == 1 ? find_errors(s, h, 1)
                        : s->dae->nu == 3 ? find_errors(s, h, 3)
                                          : find_errors(s, h, s->dae->nu);
    if (s->dae->is_plain) // then s->dd is the error of the whole state
        return ct_stepper_larger_error(p, tolerance, t1, y1, s->dd, states);
    return ct_newton_iteration_error(s->it, p, tolerance, t1, y1, s->dd, s->du, states);
}

// The error of the trapezoidal rule for quadratures: h^2/12 times the change of the slope of their
// rate. Slopes are those of this step and of the one before, zero in a first step.
static double estimate_quadratures(struct state *s, const struct ct_problem *p,
                                   const struct ct_tolerance *tolerance, double h,
                                   const double *y, const double *dy, const double *y1,
                                   const double *dy1)
{
    const int first = s->dae->nq + s->dae->nu;
    if (s->dae->quadratures_are_constant)
        return 0;
    const double ratio = s->is_fresh ? 0 : h / s->start->h;
    for (int i = first; i < p->ny; i++)
        s->error[i] = h / 12 * (dy1[i] - dy[i] - ratio * (dy[i] - s->start->rate[i]));
    return ct_stepper_largest(p, tolerance, first, y, y1, s->error);
}

// y1 and dy1 from the converged iteration; quadratures by the trapezoidal rule.
static enum ct_eval finish(struct state *s, const struct ct_problem *p, double t1, double h,
                           const double *y, const double *dy, double *y1, double *dy1,
                           struct ct_integrate_stats *stats)
{
    const int nq = s->dae->nq, nu = s->dae->nu;
    ct_stepper_copy(y1, s->q, nq);
    ct_stepper_copy(y1 + nq, s->u, nu);
    ct_stepper_copy(y1 + nq + nu, y + nq + nu, p->ny - nq - nu);
    enum ct_eval e = CT_EVAL_OK;
    if (s->c->is_stabilised && p->project) // removes the error that the iteration leaves
        e = p->project(p->user, t1, y1);
    if (e == CT_EVAL_OK)
        e = ct_stepper_rhs(p, t1, y1, dy1, stats);
    if (s->dae->quadratures_are_constant)
        return e;
    for (int i = nq + nu; i < p->ny && e == CT_EVAL_OK; i++)
        y1[i] = y[i] + h / 2 * (dy[i] + dy1[i]);
    return e;
}

// Divided differences of accelerations and multipliers, for the extrapolation in the next step.
static inline void store_differences(struct state *s, double h, const int nu)
{
    const double per_h = s->f.per_h, per_two_steps = s->f.per_two_steps; // zero in a first step
    for (int k = 0; k < nu; k++) {
        const double slope = per_h * (s->end->u_dot[k] - s->start->u_dot[k]);
        s->end->slope[k] = slope;
        s->end->slope_difference[k] = per_two_steps * (slope - s->start->slope[k]);
    }
    for (int i = 0; i < s->it->m; i++) {
        const double slope = per_h * (s->end->lam[i] - s->start->lam[i]);
        s->end->lam_slope[i] = slope;
        s->end->lam_slope_difference[i] = per_two_steps * (slope - s->start->lam_slope[i]);
    }
    s->end->h = h;
}

enum ct_eval ct_alpha_step(const struct ct_problem *p, double t, double h, const double *y,
                           const double *dy, const struct ct_tolerance *tolerance, double *y1,
                           double *dy1, double *err, void *work,
                           struct ct_integrate_stats *stats)
{
    struct state *s = work;
    const int first = s->dae->nq + s->dae->nu; // of quadratures
    enum ct_eval e = begin(s, p, t, h, y, dy, tolerance, y1, dy1, stats);
    if (e == CT_EVAL_OK)
        e = iterate(s, t + h, h, y, stats);
    if (e == CT_EVAL_OK)
        e = finish(s, p, t + h, h, y, dy, y1, dy1, stats);
    if (e != CT_EVAL_OK)
        return e;
    if (tolerance)
        *err = ct_larger(estimate(s, p, tolerance, t + h, h, y1),
                         estimate_quadratures(s, p, tolerance, h, y, dy, y1, dy1));
    if (s->dae->nu == 1)
        store_differences(s, h, 1);
    else if (s->dae->nu == 3)
        store_differences(s, h, 3);
    else
        store_differences(s, h, s->dae->nu);
    if (s->dae->quadratures_are_constant)
        return CT_EVAL_OK;
    ct_stepper_copy(s->end->rate + first, dy + first, p->ny - first);
    ct_stepper_copy(s->end_rate + first, dy1 + first, p->ny - first);
    return CT_EVAL_OK;
}

// Dense output by cubic Hermite interpolation of the increment of positions, of speeds and of
// quadratures.
void ct_alpha_dense(const struct ct_problem *p, double h, double theta, const double *y,
                    const double *y1, void *work, double *out)
{
    struct state *s = work;
    const int nq = s->dae->nq, nu = s->dae->nu;
    s->dae->chart_rate(s->dae->user, s->d, s->u, s->rate1);
    memset(s->dd, 0, (size_t)nu * sizeof *s->dd);
    ct_stepper_hermite(s->out, theta, h, s->dd, y + nq, s->d, s->rate1, nu);
    s->dae->retract(s->dae->user, y, s->out, out);
    ct_stepper_hermite(out + nq, theta, h, y + nq, s->start->u_dot, y1 + nq, s->end->u_dot, nu);
    const int i = nq + nu;
    ct_stepper_hermite(out + i, theta, h, y + i, s->end->rate + i, y1 + i, s->end_rate + i,
                       p->ny - i);
}
