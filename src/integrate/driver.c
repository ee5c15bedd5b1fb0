// The integration loop ct_integrate: steps, their size, events and samples.
//
//     fit -> attempt (step, project) -> search for an event -> [attempt again up to it]
//         -> samples on the way -> commit -> event -> sample on it
//
// A step that the method, the projection or a root function refuses, or whose error is too large,
// is repeated with a shorter length; until `commit` the run has not changed. Step size control:
// step_control.h.
#include "integrate/driver.h"

#include <math.h>
#include <string.h>

// The absolute tolerance of a crossing is ct_crossing_roundoff. If the crossing must begin nearer
// to the singular configuration than planned, the tolerance is multiplied by the square of that
// ratio, up to this part of the accuracy (8.28). Default: with less, crossings fail for round-off.
// Test: singular_approach.
static const double most_roundoff_share = 0.1;

static const struct ct_mark nowhere = {0};

// --- before the first step ------------------------------------------------------------------

static bool samples_ascend(const struct ct_integrate_options *o)
{
    for (size_t i = 0; i < o->nsample; i++)
        if (!(o->sample[i] >= (i ? o->sample[i - 1] : o->t0) && o->sample[i] <= o->t1))
            return false;
    return true;
}

static bool check_options(struct ct_ctx *ctx, const struct ct_integrate_options *o)
{
    if (!(isfinite(o->t0) && isfinite(o->t1) && o->t1 >= o->t0))
        return ct_error(
            ctx, nowhere, CT_E_INTEGRATE_OPTION,
            "cannot integrate from t = %g to t = %g: the end must not be before the "
            "start",
            o->t0, o->t1);
    if (!(o->step >= 0 && o->first_step >= 0))
        return ct_error(ctx, nowhere, CT_E_INTEGRATE_OPTION, "a step size must be positive");
    if (o->step == 0 && !(o->rtol >= 0 && o->atol > 0 && isfinite(o->rtol + o->atol)))
        return ct_error(ctx, nowhere, CT_E_INTEGRATE_OPTION,
                        "tolerances rtol = %g, atol = %g: wanted rtol >= 0 and atol > 0",
                        o->rtol, o->atol);
    if (!samples_ascend(o))
        return ct_error(ctx, nowhere, CT_E_INTEGRATE_OPTION,
                        "sample times must ascend and lie between t = %g and t = %g", o->t0,
                        o->t1);
    return true;
}

static void allocate(struct ct_driver *r)
{
    struct ct_arena *a = r->ctx->model;
    double **const vectors[]
        = {&r->y0,    &r->y,      &r->dy,    &r->y1,       &r->dy1,
           &r->moved, &r->dmoved, &r->point, &r->roundoff, &r->arithmetic_roundoff,
           &r->dpoint};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, r->p->ny);
    r->work = r->method->create(a, r->method, r->p);
    if (r->method->stiffness_estimate && r->o->step == 0) {
        r->sample_work = r->method->create(a, r->method, r->p);
        r->sample_end = CT_NEWN(a, double, r->p->ny);
        r->dsample_end = CT_NEWN(a, double, r->p->ny);
    }
    if (r->method->violates_velocity_constraints) {
        r->unprojected_y = CT_NEWN(a, double, r->p->ny);
        r->unprojected_dy = CT_NEWN(a, double, r->p->ny);
    }
    if (r->p->singular && r->o->step == 0)
        r->crossing_work = ct_crossing.create(a, &ct_crossing, r->p);
    ct_event_location_init(&r->events, r->p, a);
}

static bool state_refused(struct ct_driver *r, enum ct_eval e)
{
    if (e == CT_EVAL_FATAL)
        return false; // diagnosed where it happened
    return ct_error(r->ctx, nowhere, CT_E_STATE_REFUSED,
                    "the equations of motion cannot be evaluated at t = %.9g", r->t);
}

static void restart_method(struct ct_driver *r)
{
    if (r->method->restart)
        r->method->restart(r->work);
    r->control.is_starting = true;
}

// Reinitialisation at the start and after an event: the derivative and the signs of root functions.
static bool reinitialize(struct ct_driver *r)
{
    restart_method(r);
    enum ct_eval e = ct_stepper_rhs(r->p, r->t, r->y, r->dy, r->stats);
    if (e == CT_EVAL_OK)
        e = ct_event_location_start(&r->events, r->t, r->control.h, r->y, r->dy);
    return e == CT_EVAL_OK || state_refused(r, e);
}

// Largest change of accelerations since the start, over the largest of them; INFINITY where there
// are none.
static double relative_change(const struct ct_driver *r)
{
    const double *a = r->dy + r->p->nq, *a1 = r->dy1 + r->p->nq;
    double size = 0, change = 0;
    for (int i = 0; i < r->p->nu; i++) {
        size = fmax(size, fabs(a[i]));
        change = fmax(change, fabs(a1[i] - a[i]));
    }
    return size > 0 ? change / size : INFINITY;
}

// The rate at which accelerations begin to change, for the first step; 0 if not found. They are
// evaluated along a parabola with the second derivative r->point, for increasing h, until they have
// changed enough. In a motion from rest their change grows with h^2.
static double estimate_rate(struct ct_driver *r, double h, double limit)
{
    // Default: evaluations before the first step against its length. Test: integrate.
    enum { MOST_TRIALS = 5 };
    // Default: changes that show a rate, beyond round-off and before the motion reverses. Test:
    // integrate.
    const double least = 0.02, most = 0.5, wanted = 0.05;
    const double most_increase = 100;
    const struct ct_problem *p = r->p;
    double change = relative_change(r);
    for (int look = 0; look < MOST_TRIALS && change < least && h < limit; look++) {
        const double by_change = change > 0 ? sqrt(wanted / change) : most_increase;
        h = fmin(h * fmin(by_change, most_increase), limit);
        for (int i = 0; i < p->ny; i++)
            r->y1[i] = r->y[i] + h * (r->dy[i] + h / 2 * r->point[i]);
        if (ct_stepper_rhs(p, r->t + h, r->y1, r->dy1, r->stats) != CT_EVAL_OK)
            return 0;
        for (int i = 0; i < p->ny; i++)
            r->point[i] = (r->dy1[i] - r->dy[i]) / h;
        change = relative_change(r);
    }
    return change >= least && change <= most ? sqrt(2 * change) / h : 0;
}

static double first_step(struct ct_driver *r, double limit)
{
    const struct ct_problem *p = r->p;
    const double d0 = ct_stepper_norm(p, &r->tolerance, r->y, r->y, r->y);
    const double d1 = ct_stepper_norm(p, &r->tolerance, r->y, r->y, r->dy);
    const double h = ct_step_control_euler_step(d0, d1, limit);
    for (int i = 0; i < p->ny; i++)
        r->y1[i] = r->y[i] + h * r->dy[i];
    if (ct_stepper_rhs(p, r->t + h, r->y1, r->dy1, r->stats) != CT_EVAL_OK)
        return h; // step control will find a smaller one
    for (int i = 0; i < p->ny; i++)
        r->point[i] = (r->dy1[i] - r->dy[i]) / h;
    const double d2 = ct_stepper_norm(p, &r->tolerance, r->y, r->y, r->point);
    const double first = ct_step_control_first(r->method, h, d1, d2, limit);
    const double rate = r->method->is_implicit ? 0 : estimate_rate(r, h, limit);
    return rate > 0
             ? fmin(ct_step_control_first_at_rate(r->method, rate, r->tolerance.rtol), limit)
             : first;
}

// --- one step --------------------------------------------------------------------------------

// Steps of fixed length end on samples, so without root functions and `over_step` there is no dense
// output.
static bool is_never_interpolated(const struct ct_driver *r)
{
    return r->o->step > 0 && r->p->nroot == 0 && !r->o->over_step;
}

// end (out) = y1 projected onto the constraints, dend (out) = dy1. The derivative at `end` differs from
// dy1 by df/dy times the displacement, which adds to the next step an error one order higher than
// that of this step. Implicit methods need no projection.
static enum ct_eval project_end(struct ct_driver *r, const struct ct_method *method, double t1)
{
    const struct ct_problem *p = r->p;
    r->end = r->y1;
    r->dend = r->dy1;
    if (!p->project || method->is_implicit)
        return CT_EVAL_OK;
    if (is_never_interpolated(r))
        return p->project(p->user, t1, r->end);
    r->end = r->moved;
    ct_stepper_copy(r->end, r->y1, p->ny);
    return p->project(p->user, t1, r->end);
}

// Ends a crossing at t1, within it: end, dend (out).
static enum ct_eval end_inside_crossing(struct ct_driver *r, struct ct_planned_step *s)
{
    const struct ct_problem *p = r->p;
    r->end = r->moved;
    r->dend = r->dmoved;
    s->method->dense(p, s->h, (s->t1 - r->t) / s->h, r->y, r->y1, s->work, r->end);
    s->leaves_remainder = s->is_event && p->singular->is_near(p->singular->user, s->t1, r->end);
    ct_crossing_slope(s->work, p->ny, (s->t1 - r->t) / s->h, r->dend);
    if (s->leaves_remainder || ct_driver_is_in_gap(r, s, s->t1))
        return CT_EVAL_OK;
    const enum ct_eval e = p->project ? p->project(p->user, s->t1, r->end) : CT_EVAL_OK;
    return e == CT_EVAL_OK ? ct_stepper_rhs(p, s->t1, r->end, r->dend, r->stats) : e;
}

// The tolerance of the run; for crossings tol (out), with a higher one for round-off. NULL: fixed
// steps.
static const struct ct_tolerance *tolerance_of(const struct ct_driver *r,
                                               const struct ct_planned_step *s,
                                               struct ct_tolerance *tol)
{
    double largest = 0;
    if (s->method != &ct_crossing)
        return r->o->step > 0 ? NULL : &r->tolerance;
    for (int i = 0; i < r->p->ny; i++)
        largest = fmax(largest, fabs(r->y[i]));
    const double sooner = ct_driver_has_remainder(r) ? r->remainder.first / r->remainder.h
                                                     : r->crossing_begin / r->singular_in;
    const double nearer = fmax(1, sooner),
                 noise = fmin(ct_crossing_roundoff * nearer * nearer,
                              fmax(ct_crossing_roundoff, most_roundoff_share * r->p->accuracy));
    *tol = (struct ct_tolerance){r->tolerance.rtol, fmax(r->tolerance.atol, noise * largest)};
    return tol;
}

static bool needs_projected_speeds(const struct ct_driver *r, const struct ct_planned_step *s)
{
    return s->method == &ct_crossing && r->method->violates_velocity_constraints
        && r->p->project;
}

// A crossing begins on the constraints. The speeds of some methods meet them only to the order of
// the method, so they are projected first. Where they are farther off than the accuracy allows, the
// step is refused.
static enum ct_eval project_speeds(struct ct_driver *r, const struct ct_planned_step *s)
{
    const double most
        = 10; // Definition: outputs are promised within ten tolerances, docs/cli.md
    const struct ct_problem *p = r->p;
    const size_t bytes = (size_t)p->ny * sizeof *r->y;
    if (!needs_projected_speeds(r, s))
        return CT_EVAL_OK;
    const double part = most * p->accuracy / r->tolerance.rtol;
    const struct ct_tolerance allowed = {part * r->tolerance.rtol, part * r->tolerance.atol};
    memcpy(r->unprojected_y, r->y, bytes);
    memcpy(r->unprojected_dy, r->dy, bytes);
    const enum ct_eval e = p->project(p->user, r->t, r->y);
    if (e != CT_EVAL_OK)
        return e;
    for (int i = 0; i < p->ny; i++)
        r->point[i] = r->y[i] - r->unprojected_y[i];
    if (!(ct_stepper_norm(p, &allowed, r->unprojected_y, r->y, r->point) <= 1))
        return CT_EVAL_RETRY;
    return p->rhs(p->user, r->t, r->y, r->dy);
}

// After a failed crossing: restores the state before the projection of speeds.
static void restore_speeds(struct ct_driver *r, const struct ct_planned_step *s)
{
    const size_t bytes = (size_t)r->p->ny * sizeof *r->y;
    if (!needs_projected_speeds(r, s))
        return;
    memcpy(r->y, r->unprojected_y, bytes);
    memcpy(r->dy, r->unprojected_dy, bytes);
}

// One attempt at a step from y to end, with projection. If the error estimate is the reason of a
// refusal s->error > 1.
static inline enum ct_eval attempt(struct ct_driver *r, struct ct_planned_step *s)
{
    struct ct_tolerance own;
    const struct ct_tolerance *tolerance = tolerance_of(r, s, &own);
    double error = 0;
    s->error = 0;
    s->is_interpolated = false;
    r->projection_failed = false;
    if (s->method == &ct_crossing)
        ct_crossing_begin(s->work, s->begin);
    enum ct_eval e = project_speeds(r, s);
    if (e != CT_EVAL_OK)
        return e;
    e = s->method->step(r->p, r->t, s->h, r->y, r->dy, tolerance, r->y1, r->dy1, &error,
                        s->work, r->stats);
    if (e != CT_EVAL_OK)
        return e;
    if (!ct_stepper_finite(r->y1, r->p->ny) || isnan(error))
        return CT_EVAL_RETRY;
    s->error = error;
    if (error > 1)
        return CT_EVAL_RETRY;
    const bool is_cut = r->t + s->h > s->t1 && s->method == &ct_crossing;
    e = is_cut ? end_inside_crossing(r, s) : project_end(r, s->method, s->t1);
    r->projection_failed = e == CT_EVAL_RETRY;
    return e;
}

// Prepares dense output, once for a step.
static enum ct_eval interpolate(struct ct_driver *r, struct ct_planned_step *s)
{
    if (s->is_interpolated || !s->method->prepare)
        return CT_EVAL_OK;
    s->is_interpolated = true;
    return s->method->prepare(r->p, r->t, s->h, r->y, r->y1, s->work, r->stats);
}

// Are sensitive outputs (8.11) accurate at the next sample? If not, steps end on samples from here
// on.
static enum ct_eval check_dense_output(struct ct_driver *r, struct ct_planned_step *s)
{
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    const double theta = (r->o->sample[r->sample] - r->t) / s->h;
    double error = 0;
    if (!s->method->dense_error || !r->p->sensitive_output_error || r->o->step > 0)
        return CT_EVAL_OK;
    ct_stepper_point(&span, theta, r->point);
    const enum ct_eval e
        = s->method->dense_error(r->p, r->t, s->h, theta, r->point, s->work, &error, r->stats);
    s->is_inaccurate_between = e == CT_EVAL_OK && error > 1;
    return s->is_inaccurate_between ? CT_EVAL_RETRY : e;
}

static enum ct_eval interpolate_for_samples(struct ct_driver *r, struct ct_planned_step *s)
{
    const bool has_sample = ct_driver_has_sample(r, s);
    if (!has_sample && !r->o->over_step)
        return CT_EVAL_OK;
    const enum ct_eval e = interpolate(r, s);
    if (e != CT_EVAL_OK)
        return e;
    s->damps_fast_mode = ct_driver_damps_fast_mode(r, s);
    return s->damps_fast_mode || !has_sample ? CT_EVAL_OK : check_dense_output(r, s);
}

// Repeats the step up to the event that dense output shows at t + h. Then h is corrected by
// Newton's method until the root function is zero to the resolution of time. If it comes to the end
// of the whole step, that step is used, so that it ends exactly on its stop.
static enum ct_eval step_to_event(struct ct_driver *r, struct ct_planned_step *s, double h)
{
    const struct ct_planned_step whole = *s;
    const double unresolved = ct_event_location_resolution(r->t, whole.h);
    double dt = INFINITY;
    for (int i = 0; i <= CT_EVENT_CORRECTIONS && fabs(dt) > unresolved && h > 0; i++) {
        const bool is_whole = whole.h - h <= unresolved;
        *s = whole;
        if (!is_whole) {
            s->h = h;
            s->t1 = r->t + h;
            s->reaches_stop = false;
        }
        enum ct_eval e = attempt(r, s);
        if (e == CT_EVAL_OK)
            e = ct_event_location_refine(&r->events, s->t1, r->end, &dt);
        if (e != CT_EVAL_OK || is_whole)
            return e;
        h += dt;
    }
    return CT_EVAL_OK;
}

// Ends a crossing on an event, at theta of the step. Here dense output is as accurate as the step,
// so it is not repeated. One Newton correction of the time makes the root function zero to
// round-off.
static enum ct_eval end_crossing_on_event(struct ct_driver *r, struct ct_planned_step *s,
                                          double theta)
{
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    double dt;
    ct_stepper_point(&span, theta, r->moved);
    s->t1 = r->t + theta * s->h;
    const enum ct_eval e = ct_event_location_refine(&r->events, s->t1, r->moved, &dt);
    if (e != CT_EVAL_OK)
        return e;
    s->t1 += fabs(dt) <= ct_event_location_resolution(r->t, s->h) ? dt : 0;
    s->reaches_stop = false;
    return end_inside_crossing(r, s);
}

// If a state event lies within the step, the step is made to end there.
static enum ct_eval end_on_event(struct ct_driver *r, struct ct_planned_step *s)
{
    double theta;
    if (r->p->nroot == 0)
        return CT_EVAL_OK;
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    enum ct_eval e = s->method->has_rough_dense ? CT_EVAL_OK : interpolate(r, s);
    if (e == CT_EVAL_OK)
        e = ct_event_location_search(&r->events, &span, r->end, &theta);
    if (e != CT_EVAL_OK || theta > 1)
        return e;
    s->leaves_zero = theta == 0;
    if (s->leaves_zero)
        return CT_EVAL_RETRY;
    s->is_event = true;
    if (s->method == &ct_crossing)
        return end_crossing_on_event(r, s, theta);
    const double rest = (1 - theta) * s->h;
    return rest <= ct_event_location_resolution(r->t, s->h) ? CT_EVAL_OK
                                                            : step_to_event(r, s, theta * s->h);
}

// Tells the problem that the step is accepted.
static enum ct_eval notify_accepted(struct ct_driver *r, const struct ct_planned_step *s)
{
    const struct ct_problem *p = r->p;
    const bool is_across = s->method == &ct_crossing;
    if (s->leaves_remainder) // the remainder is accepted later
        return CT_EVAL_OK;
    return p->accepted ? p->accepted(p->user, s->t1, r->end, r->dend, is_across) : CT_EVAL_OK;
}

// Signs of root functions after an event in the gap of a crossing, where f is r->dy.
static enum ct_eval find_root_signs(struct ct_driver *r)
{
    const struct ct_problem *p = r->p;
    const enum ct_eval e = p->resumed ? p->resumed(p->user, r->t, r->y, r->dy) : CT_EVAL_OK;
    return e == CT_EVAL_OK
             ? ct_event_location_start(&r->events, r->t, r->control.h, r->y, r->dy)
             : e;
}

// Signs of root functions at the start of the remainder of a crossing, with f interpolated from its
// stages.
static enum ct_eval reinitialize_remainder(struct ct_driver *r, const struct ct_planned_step *s)
{
    if (!ct_driver_has_remainder(r) || r->remainder.is_known)
        return CT_EVAL_OK;
    r->remainder.is_known = true;
    ct_crossing_slope(s->work, r->p->ny, 0, r->dy);
    return find_root_signs(r);
}

// What follows an attempt whose error is small enough; h is the step as it was attempted.
static enum ct_eval finish_step(struct ct_driver *r, struct ct_planned_step *s, double h)
{
    enum ct_eval e = reinitialize_remainder(r, s);
    if (e == CT_EVAL_OK)
        e = end_on_event(r, s);
    if (e == CT_EVAL_OK)
        e = interpolate_for_samples(r, s);
    if (e == CT_EVAL_OK && r->p->nroot)
        e = ct_event_location_accept(&r->events, s->t1, h, r->end, s->is_event);
    return e == CT_EVAL_OK ? notify_accepted(r, s) : e;
}

// A run ends with the message that the mechanism locks when the time left to that configuration is
// below this part of the duration. Derived: the message gives the time with six digits.
static const double nearest_lock = 1e-6;

static bool is_at_lock(const struct ct_driver *r)
{
    return r->is_locked && r->singular_in <= nearest_lock * (r->o->t1 - r->o->t0);
}

static bool report_lock(const struct ct_driver *r)
{
    return ct_error(
        r->ctx, nowhere, CT_E_LOCKED,
        "the mechanism locks at t = %.6g: its motions lead no further, whatever the "
        "step; end the run before, or change the motion or the lengths",
        r->t + r->singular_in);
}

static bool report_small_step(struct ct_driver *r, double h)
{
    if (r->is_locked)
        return report_lock(r);
    if (r->failed_crossings)
        return ct_error(
            r->ctx, nowhere, CT_E_STEP_SINGULAR,
            "at t = %.9g the mechanism is about to come (in %.3g s) to a singular "
            "configuration, "
            "where "
            "its constraints depend on each other, as links in one line do, and no smooth "
            "motion "
            "leads across: it locks there, or several motions go on; start farther from it, "
            "take a larger tolerance, or change a length slightly",
            r->t, r->singular_in);
    if (r->projection_failed)
        return ct_error(
            r->ctx, nowhere, CT_E_STEP_OPEN,
            "the constraints cannot be met beyond t = %.9g: motions contradict each other, or "
            "the "
            "mechanism is at the end of its reach; change the motions or the lengths, or end "
            "the run before",
            r->t);
    return ct_error(
        r->ctx, nowhere, CT_E_STEP_SMALL,
        "at t = %.9g steps have become too short (%.3g s) to go on: the motion or a "
        "force grows without bound there, or jumps where no event shows it; look "
        "at the last rows of the result",
        r->t, h);
}

// The remainder of a crossing has failed: ordinary steps go on from the event.
static bool abandon_remainder(struct ct_driver *r)
{
    const struct ct_problem *p = r->p;
    enum ct_eval e = ct_stepper_rhs(p, r->t, r->y, r->dy, r->stats);
    if (e == CT_EVAL_OK && p->accepted)
        e = p->accepted(p->user, r->t, r->y, r->dy, true);
    if (e == CT_EVAL_OK && !r->remainder.is_known)
        e = find_root_signs(r);
    r->remainder = (struct ct_crossing_remainder){.h = 0};
    ct_driver_predict_singularity(r, r->t);
    return e == CT_EVAL_OK || state_refused(r, e);
}

// Adapts the step size after a failed step.
static bool adapt_after_failed_step(struct ct_driver *r, const struct ct_planned_step *s,
                                    double h, double error)
{
    const bool had_remainder = ct_driver_has_remainder(r);
    if (s->method == &ct_crossing)
        ct_driver_adapt_after_failed_crossing(r, error);
    else
        ct_driver_adapt_after_refusal(r, h, error);
    return had_remainder == ct_driver_has_remainder(r) || abandon_remainder(r);
}

// --- events ----------------------------------------------------------------------------------

static bool handle_event(struct ct_driver *r, bool is_state, bool is_time)
{
    const struct ct_problem *p = r->p;
    r->stats->events++;
    r->stop = -INFINITY;
    if (is_state && ct_event_location_accumulates(&r->events, r->t, r->o->t1 - r->o->t0))
        return ct_error(r->ctx, nowhere, CT_E_EVENT_PILE,
                        "%d events in a row at t = %.9g without time going on",
                        CT_EVENT_ACCUMULATION, r->t);
    const double *dy = ct_driver_has_remainder(r) ? r->dy : NULL;
    const enum ct_eval e
        = p->event ? p->event(p->user, r->t, r->y, dy, r->events.crossed, is_time) : CT_EVAL_OK;
    if (e != CT_EVAL_OK)
        return state_refused(r, e);
    r->reach = INFINITY; // the next singular configuration may be another one
    r->failed_crossings = 0;
    r->is_locked = false;
    if (dy) {
        restart_method(r);
        return true;
    }
    ct_driver_predict_singularity(r, r->t);
    return reinitialize(r);
}

// One accepted step from y to end.
static bool find_step(struct ct_driver *r, double stop, bool is_time, struct ct_planned_step *s)
{
    for (;;) {
        ct_driver_plan_step(r, stop, is_time, s);
        const bool is_crossing = s->method == &ct_crossing;
        const double h = s->h;
        if (is_at_lock(r))
            return report_lock(r);
        if (ct_driver_is_too_small(r, s))
            return report_small_step(r, h);
        if (!is_crossing)
            s->h = s->t1 - r->t; // as rounded, so that steps add up to the time
        enum ct_eval e = attempt(r, s);
        const double error = s->error;
        if (e == CT_EVAL_OK)
            e = finish_step(r, s, h);
        if (e == CT_EVAL_FATAL)
            return false;
        if (s->leaves_zero) {
            restore_speeds(r, s);
            r->stats->rejected_steps++;
            if (!handle_event(r, true, false))
                return false;
            r->stop = stop = ct_driver_next_stop(r, &is_time);
            r->is_stop_time = is_time;
            continue;
        }
        if (s->is_inaccurate_between) {
            r->ends_on_samples = true;
            r->stats->rejected_steps++;
            r->stop = stop = ct_driver_next_stop(r, &is_time);
            r->is_stop_time = is_time;
            continue;
        }
        if (e == CT_EVAL_OK) {
            if (is_crossing)
                ct_driver_adapt_after_crossing(r, s);
            else if (r->o->step == 0)
                ct_step_control_accept(&r->control, r->method, h, error);
            ct_driver_predict_singularity(r, s->t1);
            return true;
        }
        restore_speeds(r, s);
        if (r->o->step > 0)
            return ct_error(
                r->ctx, nowhere, CT_E_STEP_REFUSED,
                "at t = %.9g a step of fixed size %.3g s is too long: take a shorter "
                "one, or leave 'step' out",
                r->t, h);
        if (!adapt_after_failed_step(r, s, h, error))
            return false;
    }
}

// --- the loop over steps ---------------------------------------------------------------------

static void scale_tolerance(struct ct_driver *r, double t1)
{
    const struct ct_integrate_options *o = r->o;
    if (ct_periodic_tolerance_step(&r->periodic, t1, r->y0, r->y, r->end, r->p->nq, r->p->nu))
        r->tolerance
            = ct_periodic_tolerance_find(&r->periodic, o->rtol, o->atol, o->least_rtol);
}

static void commit(struct ct_driver *r, const struct ct_planned_step *s)
{
    if (r->o->least_rtol > 0 && r->o->step == 0)
        scale_tolerance(r, s->t1);
    double *y = r->y, *dy = r->dy;
    r->y = r->end;
    r->dy = r->dend;
    *(r->end == r->y1 ? &r->y1 : &r->moved) = y;
    *(r->dend == r->dy1 ? &r->dy1 : &r->dmoved) = dy;
    r->t = s->t1;
    r->stats->steps++;
    ct_driver_note_step(r, s->h, s->error);
    // an implicit method cannot extrapolate from a crossing
    if (s->method != r->method && r->method->is_implicit)
        r->method->restart(r->work);
    else if (r->method->accept)
        r->method->accept(r->work);
}

// Is the remainder of a crossing to come?
static bool has_remainder_to_come(const struct ct_driver *r)
{
    return ct_driver_has_remainder(r) && r->t < r->o->t1;
}

static bool advance(struct ct_driver *r)
{
    struct ct_planned_step s;
    if (r->t >= r->stop || r->o->step > 0 || r->ends_on_samples)
        r->stop = ct_driver_next_stop(r, &r->is_stop_time);
    if (!find_step(r, r->stop, r->is_stop_time, &s))
        return false;
    const bool is_time = r->is_stop_time && s.reaches_stop;
    const bool is_event = s.is_event || is_time;
    const struct ct_step_view view = {r->t, s.t1, r, &s};
    if (r->o->over_step && !r->o->over_step(r->p->user, &view))
        return false;
    if (!ct_driver_give_samples_before(r, &s,
                                       s.t1 - ct_driver_event_margin(is_event, s.t1, s.h)))
        return false;
    commit(r, &s);
    if (is_event && !handle_event(r, s.is_event, is_time))
        return false;
    return has_remainder_to_come(r) || ct_driver_give_samples_here(r);
}

static void forecast_steps(struct ct_driver *r)
{
    if (!r->o->forecast || r->is_announced || !(r->progress.to_come > r->o->many_steps))
        return;
    r->is_announced = true;
    r->o->forecast(r->p->user, r->t, r->y, r->progress.step, r->progress.to_come);
}

static bool run_steps(struct ct_driver *r)
{
    const long most = r->o->max_steps ? r->o->max_steps : 100000000;
    while (r->t < r->o->t1) {
        if (r->stats->steps >= most)
            return ct_error(
                r->ctx, nowhere, CT_E_STEP_COUNT,
                "%ld steps were taken and t = %.9g is reached: more are not allowed", most,
                r->t);
        if (!advance(r))
            return false;
        if (r->stats->steps >= r->progress.next
            && ct_step_control_exceeds_limit(&r->progress, r->stats->steps, most, r->t,
                                             r->o->t1 - r->t))
            return ct_error(r->ctx, nowhere, CT_E_STEP_COUNT,
                            "at t = %.3g after %ld steps, of %.2g s now: up to t = %.9g they "
                            "would be more than the %ld that are allowed",
                            r->t, r->stats->steps, r->progress.step, r->o->t1, most);
        forecast_steps(r);
        if (r->o->at_step && !has_remainder_to_come(r)
            && !r->o->at_step(r->p->user, r->t, r->y))
            return true;
    }
    return true;
}

static bool start(struct ct_driver *r)
{
    if (r->o->t0 < r->o->t1) { // else there are no steps
        bool is_time;
        ct_driver_predict_singularity(r, r->t);
        const double limit
            = fmin(ct_driver_step_limit(r), ct_driver_next_stop(r, &is_time) - r->t);
        r->control.h = limit; // a time scale for the signs of root functions
        if (!reinitialize(r))
            return false;
        r->control.h = r->o->step > 0       ? r->o->step
                     : r->o->first_step > 0 ? r->o->first_step
                                            : first_step(r, limit);
    }
    return ct_driver_give_samples_here(r);
}

bool ct_integrate(struct ct_ctx *ctx, const struct ct_method *method,
                  const struct ct_problem *p, const struct ct_integrate_options *options,
                  double *y, struct ct_integrate_stats *stats)
{
    *stats = (struct ct_integrate_stats){.last_time = options->t0};
    if (!check_options(ctx, options))
        return false;
    if (method->is_implicit && !p->dae)
        return ct_error(ctx, nowhere, CT_E_INTEGRATE_OPTION,
                        "the method '%s' is implicit: it needs the residual of the equations",
                        method->name);
    const struct ct_tolerance tolerance = {options->rtol, options->atol};
    struct ct_driver r = {
        .ctx = ctx,
        .method = method,
        .p = p,
        .o = options,
        .stats = stats,
        .tolerance = tolerance,
        .t = options->t0,
        .periodic = ct_periodic_tolerance_start(options->t0, options->t1, &tolerance),
        .control = ct_step_control_start(),
        .progress = {.t = options->t0},
        .singular_in = INFINITY,
        .reach = INFINITY,
        .stop = -INFINITY,
    };
    r.problem = *p;
    r.p = &r.problem;
    allocate(&r);
    memcpy(r.y, y, (size_t)p->ny * sizeof *y);
    memcpy(r.y0, y, (size_t)p->ny * sizeof *y);
    const bool ok = start(&r) && run_steps(&r);
    memcpy(y, r.y, (size_t)p->ny * sizeof *y);
    stats->last_time = r.t;
    stats->next_step = r.control.h;
    stats->last_rtol = options->step > 0 ? 0 : r.tolerance.rtol;
    return ok;
}
