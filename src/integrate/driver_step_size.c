// See driver.h: how long the next step is to be.
#include "integrate/driver.h"

#include <assert.h>
#include <math.h>

// The safety factor for a shorter crossing after one that failed for its error. Derived: SAFE of
// DOPRI5 (Hairer and Wanner).
static const double safety = 0.9;

// A failed crossing is repeated with its start nearer to the singular configuration by this factor
// at least. Default: the number of trials against digits lost near by. Test: crossing.
static const double nearer = 0.5;
// After so many failures the configuration counts as nearly singular only.
// Default: crossings given up against trials in vain. Test: crossing.
static const int most_crossings = 6;
// A crossing may begin before its planned start: its time before the configuration is at most the
// planned one times this factor. After a failure only 2 % are allowed. Default: a short
// step to the planned start against longer crossings. Test: crossing.
static const double start_margin = 1.3, repeated_start_margin = 1.02;
// Predicted times that differ by more than this factor belong to two configurations.
// Default: predictions err, and configurations follow each other. Test: crossing.
static const double other_configuration = 2;

double ct_driver_step_limit(const struct ct_driver *r)
{
    const double run = r->o->t1 - r->o->t0;
    const double limit = r->p->nroot ? ct_event_location_longest_step(run) : run;
    return r->p->longest_step ? ct_smaller(limit, r->p->longest_step(r->p->user)) : limit;
}

double ct_driver_event_margin(bool is_event, double t, double h)
{
    return is_event ? ct_event_location_resolution(t, h) : 0;
}

double ct_driver_next_stop(const struct ct_driver *r, bool *is_time)
{
    double stop = r->o->t1;
    *is_time = false;
    if (r->p->next_time_event) {
        const double event = r->p->next_time_event(r->p->user, r->t);
        assert(!(event <= r->t));
        if (event <= stop) {
            stop = event;
            *is_time = true;
        }
    }
    const bool is_on_sample
        = (r->o->step > 0 || r->ends_on_samples) && r->sample < r->o->nsample;
    if (is_on_sample
        && r->o->sample[r->sample] < stop - ct_driver_event_margin(*is_time, stop, 0)) {
        stop = r->o->sample[r->sample];
        *is_time = false;
    }
    return stop;
}

// The length of the next step where steps are fixed: the interval up to the stop is divided into
// the fewest equal steps that are not longer than the length asked for.
static double fit_fixed(struct ct_driver *r, double stop)
{
    // A stop that is a whole number of steps away but for round-off must not cost one step more.
    // Derived: n steps leave a round-off of sqrt(n) eps t in t = n h, that is n^1.5 eps steps; 1e-6
    // is enough for some 3e6 steps.
    const double roundoff = 1e-6, rest = stop - r->t;
    struct ct_fixed_steps *e = &r->even;
    if (e->stop == stop && e->next == r->t && e->left > 1) {
        e->left--;
    } else {
        e->left = ct_larger(ceil(rest / r->o->step - roundoff), 1);
        e->stop = stop;
    }
    const double h = rest / e->left;
    e->next = r->t + h;
    return h;
}

// Plans a step across a singular configuration, centred on it. It may go beyond the end of the run,
// but not beyond a time event, where f changes.
static void plan_crossing(const struct ct_driver *r, double stop, bool is_time,
                          struct ct_planned_step *s)
{
    const double rest = stop - r->t, whole = 2 * r->singular_in;
    s->method = &ct_crossing;
    s->work = r->crossing_work;
    s->h = is_time ? fmin(whole, rest) : whole;
    s->reaches_stop = s->h >= rest;
    s->t1 = s->reaches_stop ? stop : r->t + s->h;
}

// Plans the remainder of a crossing after an event in its gap. Its stages are centred on the event.
static void plan_remainder(const struct ct_driver *r, double stop, bool is_time,
                           struct ct_planned_step *s)
{
    const double rest = stop - r->t;
    s->method = &ct_crossing;
    s->work = r->crossing_work;
    s->begin = 0.5;
    s->h = is_time ? fmin(r->remainder.h, rest) : r->remainder.h;
    s->reaches_stop = s->h >= rest;
    s->t1 = s->reaches_stop ? stop : r->t + s->h;
}

// Is a singular configuration ahead that is to be crossed?
static bool has_crossing(const struct ct_driver *r)
{
    return r->singular_in < INFINITY && r->failed_crossings < most_crossings && !r->is_locked;
}

// s is filled member by member: a copy of the whole would wait for stores of its members.
void ct_driver_plan_step(struct ct_driver *r, double stop, bool is_time,
                         struct ct_planned_step *s)
{
    const double rest = stop - r->t;
    double wanted = ct_smaller(r->control.h, ct_driver_step_limit(r));
    const double reach = is_time ? ct_smaller(r->reach, rest - r->singular_in) : r->reach;
    s->method = r->method;
    s->work = r->work;
    s->reaches_stop = s->is_event = s->is_interpolated = false;
    s->is_inaccurate_between = s->damps_fast_mode = s->leaves_remainder = s->leaves_zero
        = false;
    s->error = s->begin = 0;
    if (ct_driver_has_remainder(r)) {
        plan_remainder(r, stop, is_time, s);
        return;
    }
    // the run may end shortly before the singular configuration; one that starts within its reach
    // must come to it
    if (has_crossing(r) && reach > 0
        && (isinf(r->crossing_begin) || r->singular_in - reach < rest)) {
        if (r->singular_in
            <= (r->failed_crossings ? repeated_start_margin : start_margin) * reach) {
            plan_crossing(r, stop, is_time, s);
            return;
        }
        wanted = ct_step_control_fit(r->singular_in - reach, wanted);
    }
    if (r->p->input_limited_step && r->o->step == 0)
        wanted = r->p->input_limited_step(r->p->user, r->t, ct_smaller(wanted, rest));
    s->h = r->o->step > 0 ? fit_fixed(r, stop) : ct_step_control_fit(rest, wanted);
    s->reaches_stop = s->h >= rest;
    s->t1 = s->reaches_stop ? stop : r->t + s->h;
}

bool ct_driver_is_too_small(const struct ct_driver *r, const struct ct_planned_step *s)
{
    return !s->reaches_stop
        && ct_step_control_is_below_roundoff(s->h, r->t, r->o->t1 - r->o->t0);
}

void ct_driver_adapt_after_refusal(struct ct_driver *r, double h, double error)
{
    r->stats->rejected_steps++;
    r->stats->inaccurate_steps += error > 1;
    ct_step_control_refuse(&r->control, r->method, h, error);
    if (ct_driver_is_roundoff(r, h, error))
        r->control.h = r->refusal.longest;
}

void ct_driver_predict_singularity(struct ct_driver *r, double t)
{
    if (!r->crossing_work)
        return;
    double reach;
    const double before = r->singular_in;
    r->singular_in = r->p->singular->time_to_next(r->p->singular->user, &reach);
    // there is none, or another one, or failed attempts were made with a wrong prediction of its
    // time
    if (!(r->singular_in < INFINITY) || r->singular_in > other_configuration * before
        || (r->failed_crossings
            && other_configuration * r->singular_in < r->predicted_at - t)) {
        r->reach = INFINITY;
        r->failed_crossings = 0;
    }
    if (!(r->singular_in < INFINITY))
        return;
    r->crossing_begin = reach > r->singular_in ? reach : 0;
    r->reach = fmin(fmin(r->reach, reach), r->singular_in);
}

// Plans the length of the remainder. A crossing that began too near to the singular configuration
// has a remainder as long as the usual approach.
static void plan_next_remainder(struct ct_driver *r, const struct ct_planned_step *s)
{
    const double whole
        = isfinite(r->crossing_begin) ? fmax(s->h / 2, r->crossing_begin) : s->h / 2;
    r->remainder.first = s->begin > 0 ? r->remainder.first : whole;
    r->remainder.h = s->leaves_remainder ? r->remainder.first : 0;
    r->remainder.is_known = false;
    r->remainder.is_announced &= s->leaves_remainder;
}

void ct_driver_adapt_after_crossing(struct ct_driver *r, const struct ct_planned_step *s)
{
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    const struct ct_singularities *x = r->p->singular;
    if (!r->remainder.is_announced)
        r->remainder.is_announced = x->passed(x->user, &span, s->begin, s->t1);
    plan_next_remainder(r, s);
    r->singular_in = r->reach = INFINITY;
    r->failed_crossings = 0;
    r->control.was_refused = false;
}

// Shortens the remainder of a crossing after a failure, and gives it up after too many.
static void shrink_remainder(struct ct_driver *r)
{
    enum { MOST = 12 }; // Default: as most_crossings. Test: crossing.
    r->failed_crossings++;
    r->remainder.h = r->failed_crossings < MOST ? nearer * r->remainder.h : 0;
}

void ct_driver_adapt_after_failed_crossing(struct ct_driver *r, double error)
{
    const double power = -1.0 / (ct_crossing.error_order + 1);
    r->stats->rejected_steps++;
    r->stats->inaccurate_steps += error > 1;
    if (ct_driver_has_remainder(r)) {
        shrink_remainder(r);
        return;
    }
    r->predicted_at = r->t + r->singular_in;
    r->reach = r->singular_in * (error > 1 ? fmax(nearer, safety * pow(error, power)) : nearer);
    r->failed_crossings = isinf(error) ? most_crossings : r->failed_crossings + 1;
    r->is_locked
        = r->p->singular->ends_motion(r->p->singular->user, r->t, r->y, r->singular_in);
}
