// Error estimate of a step of Radau IIA, for states and for outputs.  (theory 8.4)
//
// The error of states is that of an embedded formula of order 3, filtered by the real system of the
// Newton iteration. The error of a speed belongs to the slow motion or to a fast vibration. In a
// vibration it is the frequency times the error of position, which counts already. So where no
// output depends on speeds, the error of fast vibrations in speeds is left out. Otherwise undamped
// vibrations would have to be resolved for their speeds alone.
//
//     counted   s = (c^2 M + c C + K)^-1 c^2 M e_u,   c = 10 max (|u| + a)/(min(|q|, 1) + a)          (8.10)
//
// counts, together with the error of positions e_d. This low-pass filter leaves c^2/(c^2 + omega^2)
// of a vibration of frequency omega. The energy of the fast part acts on the motion, so that part
// is held to the square root of the tolerance. Where outputs would not change without the
// vibration, positions are filtered, too.
//
// The dissipation of vibrations adds up over all steps. Where outputs depend on them, the
// dissipation of steps like this one up to the end of the run is an error of this step.  (8.21),
// (8.22)
//
// Sensitive outputs (8.11), such as forces of stiff springs, amplify errors of states. Their errors
// are estimated at the end of the step, for the Newton iteration, and between steps. Source: Hairer
// and Wanner (1996), IV.8, key hairer1996; formulation 8.4.
#include "integrate/implicit/radau.h"

#include <math.h>
#include <string.h>

// The factor on the absolute tolerance of outputs. Derived: Radau damps small vibrations that the
// error estimate does not see. By (8.7) less than ten absolute tolerances are lost in 1e5 radians.
static const double near_zero = 0.05;

// The least error of a step where outputs are sensitive (8.11). Their error contains the error of
// speeds from the step before, not from this one, so steps may grow by half at most.
// Derived: (0.9/1.5)^4, with the safety factor 0.9 and an error of order 4.
static const double least_sensitive_error = 0.13;

// Vibrations of less energy than this many tolerances may be damped altogether.
// Definition: outputs are promised within ten tolerances, docs/cli.md.
static const double promised_tolerances = 10;
// The part of the promised error that damped vibrations may take, (8.10) and (8.22).
// Default: longer steps against what is left to all other errors. Test: vibration_error
static const double vibration_share = 0.75;

// Derived: a step dissipates z^6/7200 of a vibration with z = omega h < 1, and its filtered error
// estimate is z^4/(60 gamma), from the stability function of the method.  (8.21)
static const double of_vibration = 7200, of_error = 60 * GAMMA;
// All steps of a run dissipate 1 - 1/e of a vibration with z = z0. `dissipation` is estimated at
// `separation` z0 and `all` at z0/`separation`. Default: nearer to z0 less than a third of the loss
// is seen, farther from z0 its size is less certain. Test: vibration_error
static const double separation = 2;
// An estimate of dissipation is at least this part of the last one, as vibrations of several
// frequencies are in phase only at some times. Default: longer steps against errors of outputs.
// Test: vibration_error
static const double kept_part = 0.9;

// Steps between estimates of fast modes where leaving them out did not help, and between estimates
// of dissipation. Chosen: an estimate takes about the work of a step with new factors, so
// estimates take at most a fifteenth of the work.
enum { STEPS_BETWEEN = 15 };

// The filtered error of the embedded formula at the start y, whose rates are u and u_dot.
static inline double filtered_error_for(struct ct_radau *s, const double *u,
                                        const double *u_dot, const int nu, const int m)
{
    struct ct_newton_iteration *it = s->it;
    const struct ct_radau_stages *z = &s->now;
    double *F = s->F, *defect = s->rate;
    ct_radau_weigh(F, s->defect_of, z->d, nu);
    ct_radau_weigh(defect, s->defect_of, z->u, nu);
    for (int k = 0; k < nu; k++) { // as residuals: the error is the correction they lead to
        F[k] = -(F[k] + u[k]);
        defect[k] = -(defect[k] + u_dot[k]);
        s->r[k] = 0;
    }
    const bool is_sparse = nu > CT_MOST_INVERTED && it->sparse;
    if (is_sparse)
        ct_newton_add_mass(it->sparse, s->r, 1, defect);
    for (int j = 0; j < nu && !is_sparse; j++)
        for (int k = 0; k < nu; k++)
            s->r[k] += it->M[k + nu * j] * defect[j];
    for (int i = 0; i < m; i++)
        s->phi[i] = s->v[i] = 0;
    ct_radau_solve(s, nu, m);
    return ct_newton_iteration_norm(it, s->change.d, s->change.u, nu, 1);
}

static double filtered_error(struct ct_radau *s, const double *u, const double *u_dot)
{
    const int nu = s->it->nu, m = s->it->m;
    return m || nu > 2 ? filtered_error_for(s, u, u_dot, nu, m)
         : nu == 1     ? filtered_error_for(s, u, u_dot, 1, 0)
                       : filtered_error_for(s, u, u_dot, 2, 0);
}

// The scale of errors in fast speeds. Vibrations act on the motion by their energy, the square of
// their speeds. So the scale is the square root of the accuracy times the largest speed so far.
static void find_vibration_scale(struct ct_radau *s, const struct ct_problem *p,
                                 const double *u)
{
    const double small = s->step_tolerance.atol / s->step_tolerance.rtol;
    const double root = sqrt(p->accuracy > 0 ? p->accuracy : s->step_tolerance.rtol);
    for (int k = 0; k < s->dae->nu; k++) {
        s->largest_speed[k] = ct_larger(s->largest_speed[k], fabs(u[k]));
        s->vibration_scale[k] = root * (s->largest_speed[k] + small);
    }
}

// The dissipation of vibrations as an error of order 3. Dissipation over the run, `rate`, grows
// with h^5. The loss of the whole vibration, `all`, does not depend on h, so it enters with a power
// that limits steps less while it is small.  (8.13), (8.22)
static double order_3_error(double rate, double all)
{
    const double order = 4. / 5; // Derived: an error estimate of h^4, a loss rate of h^5
    return ct_smaller(pow(rate, order), pow(all, 1 / order));
}

// The energy that a step dissipates from vibrations, as an error of order 3. It is 1 where the same
// dissipation up to the end of the run, or the loss of all vibrations if that is less, reaches the
// accuracy. If the work is an output, the energy counts against the work, which may be much less
// than the energy of the motion.
static double dissipation_of_step(struct ct_radau *s, const struct ct_problem *p,
                                  const struct ct_vibration *v, const double *y,
                                  const double *u_dot)
{
    struct ct_newton_iteration *it = s->it;
    const double small = s->step_tolerance.atol / s->step_tolerance.rtol,
                 allowed = promised_tolerances * p->accuracy,
                 dissipated = v->dissipation / s->now.h * p->duration;
    ct_newton_iteration_note_energy(it, small, y + s->dae->nq);
    if (v->present > allowed * it->energy)
        ct_newton_iteration_predict_energy(it, small, p->duration, u_dot);
    const bool counts = p->keeps_energy || v->present > allowed * it->energy;
    const double may = counts ? p->accuracy * it->energy : INFINITY;
    s->largest_work = ct_larger(s->largest_work, fabs(y[p->ny - 1]));
    const double of_work
        = p->keeps_work ? 2 * vibration_share * allowed * (s->largest_work + small) : INFINITY;
    const double least = ct_smaller(may, of_work);
    return order_3_error(dissipated / least, v->present / least);
}

// Reduces the error estimate by its fast modes: in speeds, and in positions where outputs would not
// change without the vibrations.
static void leave_out_fast_modes(struct ct_radau *s, const struct ct_problem *p,
                                 const struct ct_tolerance *tol, double t, const double *y,
                                 const double *dy, double *err, double *loss)
{
    const int nq = s->dae->nq;
    const double *d = s->change.d, *u = s->change.u;
    if (!p->requested_speeds
        || (*err <= 1 && !s->leaves_out_fast_modes && s->checks_to_skip-- > 0))
        return;
    find_vibration_scale(s, p, y + nq);
    double slow, filtered = ct_newton_iteration_slow_norm(s->it, p, tol, y, s->vibration_scale,
                                                          d, u, &slow);
    if (isfinite(filtered) && p->accuracy > 0) {
        const struct ct_vibration v
            = ct_newton_iteration_vibration(s->it, GAMMA, s->now.h, d, u);
        if (loss)
            *loss = dissipation_of_step(s, p, &v, y, dy + nq);
        if (slow < filtered
            && ct_newton_iteration_output_change(s->it, p, &v, t, y, d, u)
                   < vibration_share * promised_tolerances * p->accuracy)
            filtered = slow;
    }
    s->leaves_out_fast_modes = filtered < *err;
    s->checks_to_skip = STEPS_BETWEEN;
    if (s->leaves_out_fast_modes && filtered > 1 && !s->it->is_new)
        ct_newton_iteration_forget(
            s->it); // modes change with the motion: old derivatives take fast modes for slow
    *err = ct_smaller(*err, filtered);
}

// The largest positions and speeds so far.
static void store_largest(struct ct_radau *s, const double *y)
{
    const int nq = s->dae->nq, *q_of = s->dae->q_of;
    for (int k = 0; k < s->dae->nu; k++) {
        s->largest_speed[k] = ct_larger(s->largest_speed[k], fabs(y[nq + k]));
        if (q_of[k] >= 0)
            s->largest_position[k] = ct_larger(s->largest_position[k], fabs(y[q_of[k]]));
    }
}

// The change of outputs without the vibrations of about this frequency, whose amplitude is `times`
// their error estimate, over the change allowed.
static double output_change_without(struct ct_radau *s, const struct ct_problem *p, double t,
                                    const double *y, double rate, double times)
{
    const double small = s->step_tolerance.atol / s->step_tolerance.rtol,
                 may = vibration_share * promised_tolerances;
    const struct ct_band band = {.rate = rate,
                                 .times = times,
                                 .small = small,
                                 .least = near_zero / may * small,
                                 .largest_position = s->largest_position,
                                 .largest_speed = s->largest_speed,
                                 .predicted = s->predicted};
    return ct_newton_iteration_output_change_in_band(s->it, p, &band, t, y, s->change.d,
                                                     s->change.u)
         / (may * p->accuracy);
}

// The amplitude of a vibration with z = omega h over its filtered error estimate.
static double of_amplitude(double z)
{
    return of_error / (z * z * z * z);
}

// The change of outputs by the dissipation of steps like this one up to the end of the run
// (`rate`), and by the loss of all vibrations (`all`). From one estimate to the next both decrease
// at most by the factor `kept_part`. (8.21)
static struct ct_dissipation_error estimate_dissipation_error(struct ct_radau *s,
                                                              const struct ct_problem *p,
                                                              double t, const double *y)
{
    const double h = s->now.h, steps = ct_larger(p->duration / h, 1), h5 = h * h * h * h * h;
    // Derived: by `order_3_error` an error of 1.8e-4, with which a step eight times as long is
    // accepted.
    const double harmless = 1e-3;
    const double z0 = pow(of_vibration / steps, 1. / 6), above = separation * z0,
                 below = z0 / separation;
    const double separation6
        = separation * separation * separation * separation * separation * separation;
    const double all = output_change_without(s, p, t, y, below / h, of_amplitude(below));
    struct ct_dissipation_error m
        = {ct_larger(all, kept_part * s->dissipation.all), kept_part * s->dissipation.rate};
    if (m.all > harmless)
        m.rate = ct_larger(
            output_change_without(s, p, t, y, above / h, separation6 * of_amplitude(above))
                / h5,
            m.rate);
    return m;
}

// The error of a step by dissipation of vibrations. It is estimated where steps have become longer,
// after a refusal for this error, and at regular intervals; in between it is scaled with the length
// of the step. After a refusal it is not scaled, because vibrations that a much longer step does
// not resolve follow no power of h.
static double dissipation_error(struct ct_radau *s, const struct ct_problem *p, double t,
                                const double *y, const double *dy)
{
    const double h = s->now.h;
    if (!p->requested_speeds || !(p->accuracy > 0) || !(p->duration > 0))
        return 0;
    const bool has_refused = s->vibration_check.error > 1;
    if (h <= s->vibration_check.h && !has_refused && s->vibration_check.left-- > 0) {
        const double part = h / s->vibration_check.h;
        return s->vibration_check.error * part * part * part * part;
    }
    store_largest(s, y);
    ct_newton_iteration_predict_motion(s->it, p, t, y, dy + s->dae->nq, s->predicted);
    const struct ct_dissipation_error m = estimate_dissipation_error(s, p, t, y);
    const double error = order_3_error(m.rate * h * h * h * h * h, m.all);
    const bool is_known = isfinite(error), is_doubtful = error > 1 && !s->it->is_new;
    s->vibration_check.h = h;
    s->vibration_check.error = is_known ? error : 0;
    s->vibration_check.left = STEPS_BETWEEN;
    if (is_doubtful)
        ct_newton_iteration_forget(s->it); // as in `leave_out_fast_modes`
    else if (is_known)
        s->dissipation = m;
    return s->vibration_check.error;
}

// The error estimate of the step. If it is too large in a first step or after a refusal it is
// filtered once more, as in RADAU5. This removes the error of stiff components that do not start on
// their slow motion.
enum ct_eval ct_radau_estimate(struct ct_radau *s, const struct ct_problem *p,
                               const struct ct_tolerance *tol, double t, const double *y,
                               const double *dy, double *y1, double *dy1, double *err,
                               struct ct_integrate_stats *stats)
{
    const int nq = s->dae->nq, nu = s->dae->nu;
    double loss = 0;
    *err = filtered_error(s, y + nq, dy + nq);
    leave_out_fast_modes(s, p, tol, t, y, dy, err, &loss);
    loss = ct_larger(loss, dissipation_error(s, p, t, y, dy));
    if (*err < 1 || loss > 1 || !(s->is_fresh || s->was_tried)) {
        *err = ct_larger(*err, loss);
        return CT_EVAL_OK;
    }
    memcpy(y1, y, (size_t)p->ny * sizeof *y);
    s->dae->retract(s->dae->user, y, s->change.d, y1);
    for (int k = 0; k < nu; k++)
        y1[nq + k] += s->change.u[k];
    const enum ct_eval e = ct_stepper_rhs(p, t, y1, dy1, stats);
    if (e != CT_EVAL_OK)
        return e;
    *err = filtered_error(s, y1 + nq, dy1 + nq);
    leave_out_fast_modes(s, p, tol, t, y, dy, err, NULL);
    return CT_EVAL_OK;
}

// The error estimate is of order 3, but the step of order 5. So a tolerance tol of the step is a
// tolerance 0.1 tol^(2/3) of the estimate, as in RADAU5.
static struct ct_tolerance loosen(const struct ct_tolerance *tolerance)
{
    const double tol = tolerance->rtol > 0 ? tolerance->rtol : tolerance->atol;
    const double factor = fmax(1, 0.1 / cbrt(tol));
    return (struct ct_tolerance){factor * tolerance->rtol, factor * tolerance->atol};
}

const struct ct_tolerance *ct_radau_estimate_tolerance(struct ct_radau *s,
                                                       const struct ct_tolerance *tolerance)
{
    if (s->step_tolerance.rtol != tolerance->rtol || s->step_tolerance.atol != tolerance->atol)
        s->estimate_tolerance = loosen(tolerance);
    s->step_tolerance = *tolerance;
    return &s->estimate_tolerance;
}

// The error of positions and speeds that corresponds to a defect (nu) of accelerations: the
// solution of the real system, a change whose stiff forces balance the defect. It is stored after
// the error estimate of the step.
static struct ct_radau_stages solve_for_defect(struct ct_radau *s, const double *defect)
{
    const struct ct_newton_iteration *it = s->it;
    const struct ct_radau_stages estimate = s->change;
    const int nu = it->nu, m = it->m;
    s->change.d += nu;
    s->change.u += nu;
    s->change.lam += m;
    s->change.eta += m;
    memset(s->F, 0, (size_t)nu * sizeof *s->F);
    ct_newton_iteration_multiply_mass(it, s->r, defect);
    for (int i = 0; i < m; i++)
        s->phi[i] = s->v[i] = 0;
    ct_radau_solve(s, nu, m);
    const struct ct_radau_stages found = s->change;
    s->change = estimate;
    return found;
}

double ct_radau_iteration_error(struct ct_radau *s, const struct ct_problem *p,
                                const struct ct_tolerance *estimate_tol, double t1,
                                const double *y1, const double *dy1, double states)
{
    const int nq = s->dae->nq, nu = s->dae->nu, last = STAGES - 1;
    if (!p->sensitive_output_error)
        return 0;
    ct_radau_weigh(s->rate, s->slope[last], s->now.u, nu);
    for (int k = 0; k < nu; k++)
        s->rate[k] -= dy1[nq + k];
    const struct ct_radau_stages e = solve_for_defect(s, s->rate);
    return ct_newton_iteration_sensitive_error(s->it, p, estimate_tol, t1, y1, e.d, e.u,
                                               states);
}

enum ct_eval ct_radau_dense_error(struct ct_radau *s, const struct ct_problem *p, double t,
                                  const double *slope, double *y, double *err,
                                  struct ct_integrate_stats *stats)
{
    const int nq = s->dae->nq, nu = s->dae->nu;
    double *dy = s->defect;
    const enum ct_eval e = ct_stepper_rhs(p, t, y, dy, stats);
    if (e != CT_EVAL_OK)
        return e;
    ct_radau_weigh(s->rate, slope, s->now.u, nu);
    for (int k = 0; k < nu; k++)
        s->rate[k] -= dy[nq + k];
    const struct ct_radau_stages change = solve_for_defect(s, s->rate);
    *err = ct_newton_iteration_sensitive_error(s->it, p, &s->estimate_tolerance, t, y, change.d,
                                               change.u, INFINITY);
    return CT_EVAL_OK;
}

double ct_radau_error_of_outputs(struct ct_radau *s, const struct ct_problem *p, double t1,
                                 const double *y, const struct ct_tolerance *estimate_tol,
                                 const double *y1, double err)
{
    const struct ct_tolerance outputs = {estimate_tol->rtol, near_zero * estimate_tol->atol};
    const struct ct_radau_stages *e = &s->change;
    const int first = s->dae->nq + s->dae->nu;
    err = ct_newton_iteration_error(s->it, p, &outputs, t1, y1, e->d, e->u, err);
    err = ct_larger(err, ct_stepper_largest(p, estimate_tol, first, y, y1, s->defect));
    if (!(err <= 1) || !p->sensitive_output_error)
        return err;
    const double sensitive_error
        = ct_newton_iteration_sensitive_error(s->it, p, &outputs, t1, y1, e->d, e->u, err);
    if (!(sensitive_error > 0))
        return err;
    // an error of speeds from the last step acts as a force that grows with 1/h, for one step
    const double part = s->is_fresh ? 1 : ct_smaller(1, s->now.h / s->before.h);
    return ct_larger(err, ct_larger(part * sensitive_error, least_sensitive_error));
}
