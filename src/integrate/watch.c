// See watch.h. Location is a bracketed secant iteration for all roots at once that always keeps
// the leftmost crossing, after Hiebert and Shampine (1980), key hiebert1980.
#include "integrate/watch.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Places within a step, besides its end. Root functions cost about as much as a derivative,
// so these three add half of the cost of a step of six stages.
static const double probes[] = {0.25, 0.5, 0.75, 1};

// Time is resolved to this part of max(|t|, h). Some thousand roundings, so that secants still
// see a change of g, and far below what a tolerance of 1e-12 does to a state.
static const double resolution = 1e-12;

// How much later, in parts of a usual step, a root is looked at that has just fired: g changes
// by 1e-7 of what it does in a step, some 1e8 roundings, and is still a straight line.
static const double glance = 1e-7;

// Spacing of the difference that gives the slope at the event, in parts of the time since the
// step began: the slope is off by about as much, so each correction by it gains three digits.
// Near the start it is this many resolutions, for the same number of digits.
static const double slope_spacing = 1e-3, slope_resolutions = 1e3, slope_most = 0.1;

// With events a run has at least this many steps, so that probes are never too far apart when
// the motion between events is so simple (free fall) that steps could grow without limit.
static const double event_steps = 50;

// State events in a row, each within this part of max(|t|, run) after the one before, pile up:
// a bouncing ball comes here after its height has fallen by 1e-18.
static const double pile_time = 1e-9;

double ct_watch_resolution(double t, double h)
{
    return resolution * fmax(fabs(t), h);
}

double ct_watch_longest_step(double run)
{
    return run / event_steps;
}

bool ct_watch_piles_up(struct ct_watch *w, double t, double run)
{
    w->piled = t - w->last_event <= pile_time * fmax(fabs(t), run) ? w->piled + 1 : 0;
    w->last_event = t;
    return w->piled >= CT_WATCH_PILE;
}

static int sign(double x)
{
    return (x > 0) - (x < 0);
}

static enum ct_eval evaluate(const struct ct_watch *w, double t, const double *y, double *g)
{
    const enum ct_eval e = w->p->root(w->p->user, t, y, g);
    return e == CT_EVAL_OK && !ct_stepper_finite(g, w->p->nroot) ? CT_EVAL_RETRY : e;
}

static enum ct_eval evaluate_inside(const struct ct_watch *w, const struct ct_stepper_span *s,
                                    double theta, double *g)
{
    ct_stepper_point(s, theta, w->point);
    return evaluate(w, s->t + theta * s->h, w->point, g);
}

void ct_watch_init(struct ct_watch *w, const struct ct_problem *p, struct ct_arena *a)
{
    const int n = p->nroot;
    double *g = CT_NEWN(a, double, 6 * (size_t)n);
    *w = (struct ct_watch){
        .p = p,
        .side = CT_NEWN(a, signed char, n),
        .crossed = CT_NEWN(a, signed char, n),
        .g0 = g,
        .g = g + n,
        .low = g + 2 * n,
        .high = g + 3 * n,
        .near = g + 4 * n,
        .slope = g + 5 * n,
        .point = CT_NEWN(a, double, p->ny),
        .last_event = -INFINITY,
    };
}

enum ct_eval ct_watch_start(struct ct_watch *w, double t, double h, const double *y,
                            const double *dy)
{
    const int n = w->p->nroot;
    bool has_doubt = false;
    enum ct_eval e = n ? evaluate(w, t, y, w->g0) : CT_EVAL_OK;
    if (e != CT_EVAL_OK)
        return e;
    for (int i = 0; i < n; i++) {
        w->side[i] = (signed char)sign(w->g0[i]);
        // where it fired the value is noise, unless the event has moved the state away
        if (fabs(w->g0[i]) <= w->near[i])
            w->side[i] = 0;
        else
            w->near[i] = 0;
        w->crossed[i] = 0;
        has_doubt |= w->side[i] == 0;
    }
    if (!has_doubt)
        return CT_EVAL_OK;
    const double later = glance * h;
    for (int i = 0; i < w->p->ny; i++)
        w->point[i] = y[i] + later * dy[i];
    e = evaluate(w, t + later, w->point, w->g);
    for (int i = 0; i < n && e == CT_EVAL_OK; i++)
        if (w->side[i] == 0)
            w->side[i] = (signed char)sign(w->g[i] - w->g0[i]);
    return e == CT_EVAL_RETRY ? CT_EVAL_OK : e; // the first step will find the side
}

// Reaching zero is crossing it; a root at rest on zero does not fire. One that has just fired may
// still be on the wrong side: until it has got away it must go further than it was then.
static bool has_crossed(const struct ct_watch *w, int i, const double *g)
{
    const double x = w->side[i] * g[i];
    return w->side[i] && (w->near[i] > 0 ? x < -w->near[i] : x <= 0);
}

// A probe without an event: roots that rested take sides, those that have fired got away.
static void settle(struct ct_watch *w, const double *g)
{
    for (int i = 0; i < w->p->nroot; i++) {
        if (w->side[i] == 0)
            w->side[i] = (signed char)sign(g[i]);
        if (w->side[i] * g[i] > w->near[i])
            w->near[i] = 0;
    }
}

static bool any_crossed(const struct ct_watch *w, const double *g)
{
    for (int i = 0; i < w->p->nroot; i++)
        if (has_crossed(w, i, g))
            return true;
    return false;
}

// Where between low and high the first of the crossing roots should be zero, by secants.
// `bias` weighs the values at high against those at low (Illinois).
static double guess(const struct ct_watch *w, double low, double high, double bias)
{
    double part = 1;
    for (int i = 0; i < w->p->nroot; i++) {
        if (!has_crossed(w, i, w->high))
            continue;
        const double a = fabs(w->low[i]), b = bias * fabs(w->high[i]);
        // at the start of a step the root may still be on the wrong side by a rounding
        const bool is_secant = sign(w->low[i]) == w->side[i] && a + b > 0;
        part = fmin(part, is_secant ? a / (a + b) : 0.5);
    }
    return low + (high - low) * part;
}

static void swap(double **a, double **b)
{
    double *c = *a;
    *a = *b;
    *b = c;
}

// Narrow [low, high] around the first crossing, from values in w->low and w->high, until it is
// shorter than `width`. Ends: at the latest each third try halves the bracket.
static enum ct_eval locate(struct ct_watch *w, const struct ct_stepper_span *s, double low,
                           double high, double width, double *theta)
{
    double bias = 1;
    double before = high - low; // the bracket two tries ago, with `tries` counting since
    for (int tries = 0, last = 0; high - low > width;) {
        double x = guess(w, low, high, bias);
        if (++tries > 2) {
            if (high - low > 0.5 * before)
                x = 0.5 * (low + high);
            before = high - low;
            tries = 0;
        }
        // a guess at one end steps half a width inside: then the next bracket is the last
        x = fmin(fmax(x, low + 0.5 * width), high - 0.5 * width);
        const enum ct_eval e = evaluate_inside(w, s, x, w->g);
        if (e != CT_EVAL_OK)
            return e;
        const int now = any_crossed(w, w->g) ? 1 : -1;
        bias = now != last ? 1 : now > 0 ? 2 * bias : 0.5 * bias;
        last = now;
        if (now > 0) {
            high = x;
            swap(&w->high, &w->g);
        } else {
            low = x;
            swap(&w->low, &w->g);
        }
    }
    *theta = high;
    return CT_EVAL_OK;
}

// The roots that fire at theta, from w->high, and their slopes there.
static enum ct_eval mark(struct ct_watch *w, const struct ct_stepper_span *s, double theta)
{
    const double least = slope_resolutions * ct_watch_resolution(s->t, s->h) / s->h;
    const double size = fmin(slope_most, slope_spacing * theta + least);
    const double d = theta > 0.5 ? -size : size;
    const enum ct_eval e = evaluate_inside(w, s, theta + d, w->g);
    for (int i = 0; i < w->p->nroot && e == CT_EVAL_OK; i++) {
        w->crossed[i] = has_crossed(w, i, w->high) ? (signed char)-w->side[i] : 0;
        w->slope[i] = (w->g[i] - w->high[i]) / (d * s->h);
    }
    return e;
}

// g at the end of a step (out: w->high), carried on by the resolution: a root that is about to be
// zero fires at the end of this step and not at the start of the next, after a sample there.
static enum ct_eval evaluate_end(struct ct_watch *w, const struct ct_stepper_span *s,
                                 const double *y_end, double since)
{
    const double ahead = ct_watch_resolution(s->t, s->h) / (since * s->h);
    const enum ct_eval e = evaluate(w, s->t + s->h, y_end, w->high);
    for (int i = 0; i < w->p->nroot && e == CT_EVAL_OK; i++)
        w->high[i] += ahead * (w->high[i] - w->low[i]);
    return e;
}

enum ct_eval ct_watch_search(struct ct_watch *w, const struct ct_stepper_span *s,
                             const double *y_end, double *theta)
{
    const int n = w->p->nroot;
    *theta = 2;
    memset(w->crossed, 0, (size_t)n);
    memcpy(w->low, w->g0, (size_t)n * sizeof *w->g0);
    double before = 0;
    for (size_t j = 0; j < COUNT(probes); j++) {
        enum ct_eval e = probes[j] < 1 ? evaluate_inside(w, s, probes[j], w->high)
                                       : evaluate_end(w, s, y_end, 1 - before);
        if (e != CT_EVAL_OK)
            return e;
        if (any_crossed(w, w->high)) {
            const double width = fmin(0.5, ct_watch_resolution(s->t, s->h) / s->h);
            e = locate(w, s, before, probes[j], width, theta);
            return e == CT_EVAL_OK ? mark(w, s, *theta) : e;
        }
        settle(w, w->high);
        swap(&w->low, &w->high);
        before = probes[j];
    }
    return CT_EVAL_OK;
}

enum ct_eval ct_watch_refine(struct ct_watch *w, double t, const double *y, double *dt)
{
    *dt = 0;
    const enum ct_eval e = evaluate(w, t, y, w->g);
    for (int i = 0; i < w->p->nroot && e == CT_EVAL_OK; i++)
        if (w->crossed[i] && w->slope[i] != 0) {
            *dt = -w->g[i] / w->slope[i];
            break;
        }
    return e;
}

enum ct_eval ct_watch_accept(struct ct_watch *w, double t, double h, const double *y,
                             bool is_event)
{
    const int n = w->p->nroot;
    if (n == 0)
        return CT_EVAL_OK;
    if (!is_event) { // the last probe was at y, and it ended up in w->low
        swap(&w->g0, &w->low);
        return CT_EVAL_OK;
    }
    const enum ct_eval e = evaluate(w, t, y, w->g0);
    for (int i = 0; i < n && e == CT_EVAL_OK; i++) {
        if (!w->crossed[i] && has_crossed(w, i, w->g0)) {
            w->crossed[i] = (signed char)-w->side[i];
            w->slope[i] = 0;
        }
        // ten resolutions: the location and its refinement are each good to a few
        if (w->crossed[i])
            w->near[i] = fabs(w->g0[i]) + 10 * fabs(w->slope[i]) * ct_watch_resolution(t, h);
    }
    return e;
}
