// Steps, their size, events and samples: ct_integrate.
//
//     fit -> attempt (step, project) -> search for an event -> [attempt again up to it]
//         -> samples on the way -> commit -> event -> sample on it
//
// A step that the method, the projection or a root function refuses, or whose error is too large,
// is tried again shorter; until `commit` nothing has changed. Step control is that of control.h.
#include "integrate/control.h"
#include "integrate/crossing.h"
#include "integrate/repeat.h"
#include "integrate/striding.h"
#include "integrate/watch.h"

#include <assert.h>
#include <math.h>
#include <string.h>

// What a crossing that failed shrinks its reach by aims at this part of what its error would allow.
static const double safety = 0.9;

// A step across a singular position that fails is tried again from nearer, after so many times not any more: then
// the position is not singular but only nearly so.
static const double nearer = 0.5;
static const int most_crossings = 6;
// This much further away than where it should begin, a crossing may begin at once; after one that failed only where
// a step to there has ended.
static const double early = 1.3, on_time = 1.02;
// The end of a run is reached by a crossing, too, when it is this part of its reach before the position.
static const double beside = 0.5;
// Beside a singular position f has fewer digits: crossings may err by this part of the largest state.
static const double crossing_rounding = 5e-13;

static const struct ct_mark nowhere = {0};

struct run {
    struct ct_ctx *ctx;
    const struct ct_method *method;
    const struct ct_problem *p;
    const struct ct_integrate_options *o;
    struct ct_integrate_stats *stats;
    struct ct_tolerance tolerance;
    struct ct_repeat repeat;
    double *y0; // where the run began
    struct ct_watch watch;
    double t;    // time of y and dy
    double stop; // where steps must end next, a time event or not; before t: to be found
    bool is_stop_time;
    struct ct_control control;
    struct ct_pace pace;
    bool is_told;        // that it takes long
    double *y, *dy;      // (ny) each, as all that follow
    double *y1, *dy1;    // end of the step as the method gives it
    double *end, *dend;  // the same, projected
    double *point;       // a state to spare
    void *work;          // the method's own
    void *crossing_work; // of ct_crossing; NULL: there are no singular positions to cross
    double singular_in;  // time to the next one, from t
    double reach;        // crossing it is to begin this long before
    struct ct_striding *striding; // NULL: no crossings by steps of the method itself
    bool has_failed_stride;       // across the next position
    int failed_crossings;         // of it
    bool is_open;                 // the last step met everything but the constraints
    size_t sample;                // the next one to give
};

// A step as planned: to t1, which is t + h but for rounding, or the end of the run before that.
struct stride {
    const struct ct_method *method;
    void *work; // the method's
    double h, t1;
    bool is_landing;      // t1 is the stop it was planned for
    bool is_event;        // a state event ends it
    bool is_interpolated; // the method is ready to interpolate it
    bool is_striding;     // across a singular position
    double error;
};

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

static void allocate(struct run *r)
{
    struct ct_arena *a = r->ctx->model;
    double **const vectors[]
        = {&r->y0, &r->y, &r->dy, &r->y1, &r->dy1, &r->end, &r->dend, &r->point};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, r->p->ny);
    r->work = r->method->create(a, r->method, r->p);
    if (r->p->singular_in && r->o->step == 0)
        r->crossing_work = ct_crossing.create(a, &ct_crossing, r->p);
    if (r->crossing_work)
        r->striding = ct_striding_create(a, r->method, r->p);
    ct_watch_init(&r->watch, r->p, a);
}

static bool state_refused(struct run *r, enum ct_eval e)
{
    if (e == CT_EVAL_FATAL)
        return false; // diagnosed where it happened
    return ct_error(r->ctx, nowhere, CT_E_STATE_REFUSED,
                    "the equations of motion cannot be evaluated at t = %.9g", r->t);
}

// The derivative, and on which side the roots are, at a state that was not stepped to.
static bool take_bearings(struct run *r)
{
    if (r->method->restart)
        r->method->restart(r->work);
    r->control.is_starting = true;
    enum ct_eval e = ct_stepper_rhs(r->p, r->t, r->y, r->dy, r->stats);
    if (e == CT_EVAL_OK)
        e = ct_watch_start(&r->watch, r->t, r->control.h, r->y, r->dy);
    return e == CT_EVAL_OK || state_refused(r, e);
}

// Largest step allowed.
static double step_limit(const struct run *r)
{
    const double run = r->o->t1 - r->o->t0;
    const double limit = r->p->nroot ? ct_watch_longest_step(run) : run;
    return r->p->longest_step ? ct_smaller(limit, r->p->longest_step(r->p->user)) : limit;
}

static double first_step(struct run *r, double limit)
{
    const struct ct_problem *p = r->p;
    const double d0 = ct_stepper_norm(p, &r->tolerance, r->y, r->y, r->y);
    const double d1 = ct_stepper_norm(p, &r->tolerance, r->y, r->y, r->dy);
    const double h = ct_control_glance(d0, d1, limit);
    for (int i = 0; i < p->ny; i++)
        r->y1[i] = r->y[i] + h * r->dy[i];
    if (ct_stepper_rhs(p, r->t + h, r->y1, r->dy1, r->stats) != CT_EVAL_OK)
        return h; // step control will find a smaller one
    for (int i = 0; i < p->ny; i++)
        r->point[i] = (r->dy1[i] - r->dy[i]) / h;
    const double d2 = ct_stepper_norm(p, &r->tolerance, r->y, r->y, r->point);
    return ct_control_first(r->method, h, d1, d2, limit);
}

// --- how far ---------------------------------------------------------------------------------

// Samples this close before an event count as on it: times of samples are rounded, too.
static double event_margin(bool is_event, double t, double h)
{
    return is_event ? ct_watch_resolution(t, h) : 0;
}

// Where steps must end next; *is_time tells that a time event is there.
static double next_stop(const struct run *r, bool *is_time)
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
    const bool is_on_sample = r->o->step > 0 && r->sample < r->o->nsample;
    if (is_on_sample && r->o->sample[r->sample] < stop - event_margin(*is_time, stop, 0)) {
        stop = r->o->sample[r->sample];
        *is_time = false;
    }
    return stop;
}

// The fewest even steps up to the stop that are not longer than the one asked for.
static double fit_fixed(double rest, double step)
{
    // a stop that is a whole number of steps away but for its rounding must not cost one more
    const double rounding = 1e-9;
    return rest / fmax(1, ceil(rest / step - rounding));
}

// The step across a singular position, centred on it. Beyond the end of the run f is the same function, beyond a
// time event it is not.
static void plan_crossing(const struct run *r, double stop, bool is_time, struct stride *s)
{
    const double rest = stop - r->t, whole = 2 * r->singular_in;
    s->method = &ct_crossing;
    s->work = r->crossing_work;
    s->h = is_time ? fmin(whole, rest) : whole;
    s->is_landing = s->h >= rest;
    s->t1 = s->is_landing ? stop : r->t + s->h;
}

// Is a singular position ahead that is to be crossed?
static bool has_crossing(const struct run *r)
{
    return r->singular_in < INFINITY && r->failed_crossings < most_crossings;
}

// The length of the step that strides across the next singular position from here, or 0; *wanted becomes that of a step to
// where it may begin. False if it is to be crossed otherwise.
static bool plan_striding(const struct run *r, double rest, double *wanted, double *length)
{
    *length = 0;
    if (!r->striding || r->has_failed_stride || !has_crossing(r) || !(r->reach < INFINITY))
        return false;
    const double step = ct_striding_approach(r->striding, r->singular_in, r->reach, *wanted);
    if (!(ct_striding_length(r->striding, r->singular_in) < rest) || isinf(step))
        return false;
    if (step == 0)
        *length = ct_striding_length(r->striding, r->singular_in);
    else
        *wanted = step;
    return true;
}

// s (out): member by member, because steps are short against the time that a copy of it waits for its parts.
static void plan(const struct run *r, double stop, bool is_time, struct stride *s)
{
    const double rest = stop - r->t;
    double wanted = ct_smaller(r->control.h, step_limit(r)), length;
    const double reach = is_time ? ct_smaller(r->reach, rest - r->singular_in) : r->reach;
    const bool is_strideable = plan_striding(r, rest, &wanted, &length);
    s->method = r->method;
    s->work = r->work;
    s->is_striding = length > 0;
    s->is_landing = s->is_event = s->is_interpolated = false;
    s->error = 0;
    if (s->is_striding) {
        s->h = length;
        s->t1 = r->t + length;
        return;
    }
    // the run may end before the position, but beside it
    if (!is_strideable && has_crossing(r) && reach > 0
        && r->singular_in - beside * reach < rest) {
        if (r->singular_in <= (r->failed_crossings ? on_time : early) * reach) {
            plan_crossing(r, stop, is_time, s);
            return;
        }
        wanted = ct_control_fit(r->singular_in - reach, wanted);
    }
    s->h = r->o->step > 0 ? fit_fixed(rest, r->o->step) : ct_control_fit(rest, wanted);
    s->is_landing = s->h >= rest;
    s->t1 = s->is_landing ? stop : r->t + s->h;
}

static bool is_too_small(const struct run *r, const struct stride *s)
{
    return !s->is_landing && ct_control_is_lost(s->h, r->t, r->o->t1 - r->o->t0);
}

static void adapt_after_refusal(struct run *r, double h, double error)
{
    r->stats->rejected_steps++;
    r->stats->inaccurate_steps += error > 1;
    ct_control_refuse(&r->control, r->method, h, error);
}

// Time to the next singular position, and where to begin to cross it.
static void look_ahead(struct run *r)
{
    if (!r->crossing_work)
        return;
    double reach;
    const double before = r->singular_in;
    r->singular_in = r->p->singular_in(r->p->user, &reach);
    if (!(r->singular_in < INFINITY) || r->singular_in > 2 * before) { // none, or another one
        r->reach = INFINITY;
        r->failed_crossings = 0;
        r->has_failed_stride = false;
    }
    if (r->singular_in < INFINITY)
        r->reach = fmin(r->reach, reach);
}

static void adapt_after_crossing(struct run *r, const struct stride *s)
{
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    if (r->p->crossed)
        r->p->crossed(r->p->user, &span, s->t1);
    r->singular_in = r->reach = INFINITY;
    r->failed_crossings = 0;
    r->has_failed_stride = false;
    r->control.was_refused = false;
}

static void adapt_after_failed_crossing(struct run *r, const struct stride *s, double error)
{
    const double power = -1.0 / (ct_crossing.error_order + 1);
    r->stats->rejected_steps++;
    r->stats->inaccurate_steps += error > 1;
    if (s->is_striding) {
        r->has_failed_stride = true;
        return;
    }
    r->reach = r->singular_in * (error > 1 ? fmax(nearer, safety * pow(error, power)) : nearer);
    r->failed_crossings = isinf(error) ? most_crossings : r->failed_crossings + 1;
}

// --- one step --------------------------------------------------------------------------------

static bool differs(const double *a, const double *b, int n)
{
    for (int i = 0; i < n; i++)
        if (a[i] != b[i])
            return true;
    return false;
}

// Has the projection moved y1 so far that its derivative must be found again? That of the step errs by h df/dy times
// the way, so less than `unnoticed` of the tolerance is lost in the error of the step.
static bool has_moved(struct run *r)
{
    const double unnoticed = 0.01;
    const struct ct_problem *p = r->p;
    if (r->o->step > 0)
        return differs(r->end, r->y1, p->ny);
    for (int i = 0; i < p->ny; i++)
        r->point[i] = r->end[i] - r->y1[i];
    return !(ct_stepper_norm(p, &r->tolerance, r->y, r->y1, r->point) <= unnoticed);
}

// end, dend (out) = y1, dy1 on the constraints, which implicit methods meet by themselves.
static enum ct_eval project_end(struct run *r, const struct ct_method *method, double t1)
{
    const struct ct_problem *p = r->p;
    ct_stepper_copy(r->end, r->y1, p->ny);
    ct_stepper_copy(r->dend, r->dy1, p->ny);
    if (!p->project || method->is_implicit)
        return CT_EVAL_OK;
    const enum ct_eval e = p->project(p->user, t1, r->end);
    if (e != CT_EVAL_OK || !has_moved(r))
        return e;
    return ct_stepper_finite(r->end, p->ny) ? ct_stepper_rhs(p, t1, r->end, r->dend, r->stats)
                                            : CT_EVAL_RETRY;
}

static bool is_in_gap(const struct run *r, const struct stride *s, double t)
{
    const double theta = (t - r->t) / s->h;
    double from, to;
    return s->is_striding ? ct_striding_is_gap(r->striding, theta, &from, &to)
                          : s->method == &ct_crossing && ct_crossing_is_gap(theta);
}

// end, dend (out) = the crossing at t1, within it.
static enum ct_eval cut(struct run *r, const struct stride *s)
{
    const struct ct_problem *p = r->p;
    s->method->dense(p, s->h, (s->t1 - r->t) / s->h, r->y, r->y1, s->work, r->end);
    ct_stepper_copy(r->dend, r->dy1, p->ny);
    if (is_in_gap(r, s, s->t1))
        return CT_EVAL_OK;
    const enum ct_eval e = p->project ? p->project(p->user, s->t1, r->end) : CT_EVAL_OK;
    return e == CT_EVAL_OK ? ct_stepper_rhs(p, s->t1, r->end, r->dend, r->stats) : e;
}

// tol (out): that of the run, of crossings with room for rounding. NULL: steps are fixed.
static const struct ct_tolerance *tolerance_of(const struct run *r, const struct stride *s,
                                               struct ct_tolerance *tol)
{
    double largest = 0;
    if (s->method != &ct_crossing)
        return r->o->step > 0 ? NULL : &r->tolerance;
    for (int i = 0; i < r->p->ny; i++)
        largest = fmax(largest, fabs(r->y[i]));
    *tol = (struct ct_tolerance){r->tolerance.rtol,
                                 fmax(r->tolerance.atol, crossing_rounding * largest)};
    return tol;
}

// From y to end by the method and the projection. Refused with s->error > 1 when that is the reason.
static enum ct_eval attempt(struct run *r, struct stride *s)
{
    struct ct_tolerance own;
    const struct ct_tolerance *tolerance = tolerance_of(r, s, &own);
    double error = 0;
    s->error = 0;
    s->is_interpolated = false;
    r->is_open = false;
    enum ct_eval e = s->is_striding
                       ? ct_striding_step(r->striding, r->t, s->h, r->y, r->dy, tolerance,
                                          r->y1, r->dy1, &error, s->work, r->stats)
                       : s->method->step(r->p, r->t, s->h, r->y, r->dy, tolerance, r->y1,
                                         r->dy1, &error, s->work, r->stats);
    if (e != CT_EVAL_OK)
        return e;
    s->is_interpolated = s->is_striding;
    if (!ct_stepper_finite(r->y1, r->p->ny) || isnan(error))
        return CT_EVAL_RETRY;
    s->error = error;
    if (error > 1)
        return CT_EVAL_RETRY;
    const bool is_cut = r->t + s->h > s->t1 && s->method == &ct_crossing;
    e = is_cut ? cut(r, s) : project_end(r, s->method, s->t1);
    r->is_open = e == CT_EVAL_RETRY;
    return e;
}

// Make the method ready to interpolate, once.
static enum ct_eval interpolate(struct run *r, struct stride *s)
{
    if (s->is_interpolated || !s->method->prepare)
        return CT_EVAL_OK;
    s->is_interpolated = true;
    return s->method->prepare(r->p, r->t, s->h, r->y, r->y1, s->work, r->stats);
}

static enum ct_eval interpolate_for_samples(struct run *r, struct stride *s)
{
    const bool has_sample = r->sample < r->o->nsample && r->o->sample[r->sample] < s->t1;
    return has_sample ? interpolate(r, s) : CT_EVAL_OK;
}

// Step again, to the event that the interpolant shows at t + h; then correct h for the difference
// between the interpolant and the step until the root that fires is zero to the resolution.
// Corrected up to where the whole step ended, the step is the whole step, for the sake of its stop.
static enum ct_eval step_to_event(struct run *r, struct stride *s, double h)
{
    const struct stride whole = *s;
    const double unresolved = ct_watch_resolution(r->t, whole.h);
    double dt = INFINITY;
    for (int i = 0; i <= CT_WATCH_CORRECTIONS && fabs(dt) > unresolved && h > 0; i++) {
        const bool is_whole = whole.h - h <= unresolved;
        *s = whole;
        if (!is_whole) {
            s->h = h;
            s->t1 = r->t + h;
            s->is_landing = false;
        }
        enum ct_eval e = attempt(r, s);
        if (e == CT_EVAL_OK)
            e = ct_watch_refine(&r->watch, s->t1, r->end, &dt);
        if (e != CT_EVAL_OK || is_whole)
            return e;
        h += dt;
    }
    return CT_EVAL_OK;
}

// If a root fires within the step, the step is made to end there.
static enum ct_eval end_on_event(struct run *r, struct stride *s)
{
    double theta;
    if (r->p->nroot == 0)
        return CT_EVAL_OK;
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    enum ct_eval e = s->method->has_rough_dense ? CT_EVAL_OK : interpolate(r, s);
    if (e == CT_EVAL_OK)
        e = ct_watch_search(&r->watch, &span, r->end, &theta);
    if (e != CT_EVAL_OK || theta > 1)
        return e;
    s->is_event = true;
    if (s->method == &ct_crossing) {
        s->t1 = r->t + theta * s->h;
        s->is_landing = false;
        return cut(r, s);
    }
    const double rest = (1 - theta) * s->h;
    return rest <= ct_watch_resolution(r->t, s->h) ? CT_EVAL_OK
                                                   : step_to_event(r, s, theta * s->h);
}

// The caller's memories and choices move on to the end of the step.
static enum ct_eval tell_accepted(struct run *r, const struct stride *s)
{
    const struct ct_problem *p = r->p;
    return p->accepted ? p->accepted(p->user, s->t1, r->end, r->dend) : CT_EVAL_OK;
}

// What follows an attempt whose error is small enough; h is the step as it was attempted.
static enum ct_eval finish_step(struct run *r, struct stride *s, double h)
{
    enum ct_eval e = end_on_event(r, s);
    if (e == CT_EVAL_OK)
        e = ct_watch_accept(&r->watch, s->t1, h, r->end, s->is_event);
    if (e == CT_EVAL_OK)
        e = interpolate_for_samples(r, s);
    return e == CT_EVAL_OK ? tell_accepted(r, s) : e;
}

static bool step_too_small(struct run *r, double h)
{
    if (r->failed_crossings)
        return ct_error(
            r->ctx, nowhere, CT_E_STEP_SINGULAR,
            "at t = %.9g the motion comes to a singular position (in %.3g s) and no smooth "
            "motion across it is found: it locks there, or wants a larger tolerance, or a "
            "length that differs slightly",
            r->t, r->singular_in);
    if (r->is_open)
        return ct_error(
            r->ctx, nowhere, CT_E_STEP_OPEN,
            "the constraints cannot be met beyond t = %.9g: drivers contradict each "
            "other, or the mechanism locks",
            r->t);
    return ct_error(r->ctx, nowhere, CT_E_STEP_SMALL,
                    "at t = %.9g the step size became too small (%.3g) to go on", r->t, h);
}

// One step that everybody accepts: from y to end.
static bool find_step(struct run *r, double stop, bool is_time, struct stride *s)
{
    for (;;) {
        plan(r, stop, is_time, s);
        const bool is_crossing = s->method == &ct_crossing || s->is_striding;
        const double h = s->h;
        if (is_too_small(r, s))
            return step_too_small(r, h);
        if (!is_crossing)
            s->h = s->t1 - r->t; // as rounded, so that steps add up to the time
        enum ct_eval e = attempt(r, s);
        const double error = s->error;
        if (e == CT_EVAL_OK)
            e = finish_step(r, s, h);
        if (e == CT_EVAL_FATAL)
            return false;
        if (e == CT_EVAL_OK) {
            if (is_crossing)
                adapt_after_crossing(r, s);
            else if (r->o->step == 0)
                ct_control_accept(&r->control, r->method, h, error);
            look_ahead(r);
            return true;
        }
        if (r->o->step > 0)
            return ct_error(r->ctx, nowhere, CT_E_STEP_REFUSED,
                            "at t = %.9g a step of fixed size %.3g is too large", r->t, h);
        if (is_crossing)
            adapt_after_failed_crossing(r, s, error);
        else
            adapt_after_refusal(r, h, error);
    }
}

// --- samples ---------------------------------------------------------------------------------

static bool give_sample(struct run *r, const double *y)
{
    const double t = r->o->sample[r->sample++];
    return r->o->at_sample(r->p->user, t, y);
}

static struct ct_bridge bridge(const struct run *r, const struct stride *s, double theta)
{
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    double from, to;
    if (!s->is_striding)
        return ct_crossing_bridge(s->work, r->t, s->h, theta);
    ct_striding_is_gap(r->striding, theta, &from, &to);
    return ct_crossing_bridge_over(r->crossing_work, &span, from, to, theta);
}

// A sample in the gap of a crossing is as good as the interpolant: projected it would be worse.
static bool give_singular_sample(struct run *r, const struct stride *s, const double *y)
{
    const double t = r->o->sample[r->sample];
    if (!r->o->at_singular_sample)
        return give_sample(r, y);
    const struct ct_bridge b = bridge(r, s, (t - r->t) / s->h);
    r->sample++;
    return r->o->at_singular_sample(r->p->user, t, y, &b);
}

static bool give_projected_sample(struct run *r, double *y)
{
    const struct ct_problem *p = r->p;
    const double t = r->o->sample[r->sample];
    const enum ct_eval e = p->project ? p->project(p->user, t, y) : CT_EVAL_OK;
    if (e == CT_EVAL_RETRY)
        return ct_error(r->ctx, nowhere, CT_E_SAMPLE_REFUSED,
                        "the constraints cannot be met at t = %.9g", t);
    return e == CT_EVAL_OK && give_sample(r, y);
}

// Samples before `end`, from the interpolant of the step; in the gap of a crossing also the one on its end.
static bool give_samples_before(struct run *r, const struct stride *s, double end)
{
    while (r->sample < r->o->nsample && r->o->sample[r->sample] <= s->t1) {
        const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
        const double t = r->o->sample[r->sample];
        const bool is_singular = !s->is_event && is_in_gap(r, s, t);
        if (t >= end && !is_singular)
            break;
        ct_stepper_point(&span, (t - r->t) / s->h, r->point);
        if (is_singular ? !give_singular_sample(r, s, r->point)
                        : !give_projected_sample(r, r->point))
            return false;
    }
    return true;
}

static bool give_samples_here(struct run *r)
{
    while (r->sample < r->o->nsample && r->o->sample[r->sample] <= r->t)
        if (!give_sample(r, r->y))
            return false;
    return true;
}

// --- the march -------------------------------------------------------------------------------

static void count_turns(struct run *r, double t1)
{
    const struct ct_integrate_options *o = r->o;
    if (ct_repeat_step(&r->repeat, t1, r->y0, r->y, r->end, r->p->nq, r->p->nu))
        r->tolerance = ct_repeat_tolerance(&r->repeat, o->rtol, o->atol, o->least_rtol);
}

static void commit(struct run *r, const struct stride *s)
{
    if (r->o->least_rtol > 0 && r->o->step == 0)
        count_turns(r, s->t1);
    double *y = r->y, *dy = r->dy;
    r->y = r->end;
    r->dy = r->dend;
    r->end = y;
    r->dend = dy;
    r->t = s->t1;
    r->stats->steps++;
    // a crossing tells an implicit method nothing about the steps to come
    if (s->method != r->method && r->method->is_implicit)
        r->method->restart(r->work);
    else if (r->method->accept)
        r->method->accept(r->work);
}

static bool handle_event(struct run *r, bool is_state, bool is_time)
{
    const struct ct_problem *p = r->p;
    r->stats->events++;
    r->stop = -INFINITY;
    if (is_state && ct_watch_piles_up(&r->watch, r->t, r->o->t1 - r->o->t0))
        return ct_error(r->ctx, nowhere, CT_E_EVENT_PILE,
                        "%d events in a row at t = %.9g without time going on", CT_WATCH_PILE,
                        r->t);
    const enum ct_eval e
        = p->event ? p->event(p->user, r->t, r->y, r->watch.crossed, is_time) : CT_EVAL_OK;
    return e == CT_EVAL_OK ? take_bearings(r) : state_refused(r, e);
}

static bool advance(struct run *r)
{
    struct stride s;
    if (r->t >= r->stop || r->o->step > 0)
        r->stop = next_stop(r, &r->is_stop_time);
    if (!find_step(r, r->stop, r->is_stop_time, &s))
        return false;
    const bool is_time = r->is_stop_time && s.is_landing;
    const bool is_event = s.is_event || is_time;
    if (!give_samples_before(r, &s, s.t1 - event_margin(is_event, s.t1, s.h)))
        return false;
    commit(r, &s);
    return (!is_event || handle_event(r, s.is_event, is_time)) && give_samples_here(r);
}

static void tell_foreseen(struct run *r)
{
    if (!r->o->foresee || r->is_told || !(r->pace.to_come > r->o->many_steps))
        return;
    r->is_told = true;
    r->o->foresee(r->p->user, r->t, r->y, r->pace.step, r->pace.to_come);
}

static bool march(struct run *r)
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
        if (ct_control_is_endless(&r->pace, r->stats->steps, most, r->t, r->o->t1 - r->t))
            return ct_error(r->ctx, nowhere, CT_E_STEP_COUNT,
                            "at t = %.3g after %ld steps, of %.2g s now: up to t = %.9g they "
                            "would be more than the %ld that are allowed",
                            r->t, r->stats->steps, r->pace.step, r->o->t1, most);
        tell_foreseen(r);
        if (r->o->at_step && !r->o->at_step(r->p->user, r->t, r->y))
            return true;
    }
    return true;
}

static bool start(struct run *r)
{
    if (r->o->t0 < r->o->t1) { // else there is nothing to step
        bool is_time;
        const double limit = fmin(step_limit(r), next_stop(r, &is_time) - r->t);
        r->control.h = limit; // a scale for the bearings
        if (!take_bearings(r))
            return false;
        r->control.h = r->o->step > 0       ? r->o->step
                     : r->o->first_step > 0 ? r->o->first_step
                                            : first_step(r, limit);
    }
    return give_samples_here(r);
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
    struct run r = {
        .ctx = ctx,
        .method = method,
        .p = p,
        .o = options,
        .stats = stats,
        .tolerance = {options->rtol, options->atol},
        .t = options->t0,
        .repeat = ct_repeat_start(options->t0, options->t1),
        .control = ct_control_start(),
        .pace = {.t = options->t0},
        .singular_in = INFINITY,
        .reach = INFINITY,
        .stop = -INFINITY,
    };
    allocate(&r);
    memcpy(r.y, y, (size_t)p->ny * sizeof *y);
    memcpy(r.y0, y, (size_t)p->ny * sizeof *y);
    const bool ok = start(&r) && march(&r);
    memcpy(y, r.y, (size_t)p->ny * sizeof *y);
    stats->last_time = r.t;
    return ok;
}
