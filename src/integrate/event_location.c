// See event_location.h. Location is a bracketed secant iteration for all roots at once that always
// keeps the leftmost crossing, after Hiebert and Shampine (1980), key hiebert1980.
#include "integrate/event_location.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Probes: times within a step, as parts of it, at which g is evaluated.
// Default: what is missed against evaluations; two_waves_in_a_step_are_seen. Test: events.
static const double probes[] = {0.25, 0.5, 0.75, 1};

// Two sign changes between probes are suspected where the parabola through three of them has a
// minimum below this part of its second difference, its assumed error. Default: what is missed
// against evaluations; a_parabola_tells_of_dips. Test: events.
const double ct_event_location_margin = 0.1;
// The minimum is located with three points, whose distance shrinks by this factor each time.
// Default: crossings_close_together_are_both_seen fails with 0.9. Test: events.
static const double dip_shrink = 0.125;

// Times are resolved to this part of max(|t|, h), and values of g to this part of their size in
// the step: some thousand units of round-off, so that secants still see a change of g.
// Default: accuracy of events against their round-off. Test: events.
static const double resolution = 1e-12;

// Spacing of the forward differences for slopes of g, as part of a step. Derived: the square root
// of the unit round-off, where round-off and curvature err alike.
static const double difference_step = 0x1p-26;

// The least number of steps of a run with events. Without it steps, and with them probes, could
// grow without limit in a simple motion such as free fall. Default: what is missed against steps.
// Test: events.
static const double event_steps = 50;

double ct_event_location_resolution(double t, double h)
{
    return resolution * fmax(fabs(t), h);
}

double ct_event_location_longest_step(double run)
{
    return run / event_steps;
}

bool ct_event_location_accumulates(struct ct_event_location *w, double t, double run)
{
    w->accumulated
        = t - w->last_event <= ct_event_location_resolution(t, run) ? w->accumulated + 1 : 0;
    w->last_event = t;
    return w->accumulated >= CT_EVENT_ACCUMULATION;
}

static int sign(double x)
{
    return (x > 0) - (x < 0);
}

static enum ct_eval evaluate(const struct ct_event_location *w, double t, const double *y,
                             double *g)
{
    const enum ct_eval e = w->p->root(w->p->user, t, y, g);
    return e == CT_EVAL_OK && !ct_stepper_finite(g, w->p->nroot) ? CT_EVAL_RETRY : e;
}

static enum ct_eval evaluate_inside(const struct ct_event_location *w,
                                    const struct ct_stepper_span *s, double theta, double *g)
{
    ct_stepper_point(s, theta, w->point);
    return evaluate(w, s->t + theta * s->h, w->point, g);
}

void ct_event_location_init(struct ct_event_location *w, const struct ct_problem *p,
                            struct ct_arena *a)
{
    const int n = p->nroot;
    double *g = CT_NEWN(a, double, (7 + COUNT(probes)) * (size_t)n);
    *w = (struct ct_event_location){
        .p = p,
        .side = CT_NEWN(a, signed char, n),
        .crossed = CT_NEWN(a, signed char, n),
        .g0 = g,
        .g = g + n,
        .low = g + 2 * n,
        .high = g + 3 * n,
        .recently_fired = g + 4 * n,
        .slope = g + 5 * n,
        .probed = g + 6 * n,
        .point = CT_NEWN(a, double, p->ny),
        .last_event = -INFINITY,
    };
}

// Signs of root functions that are zero: those to which they move.
static enum ct_eval find_sides(struct ct_event_location *w, double t, double h, const double *y,
                               const double *dy)
{
    const double later = difference_step * h;
    for (int i = 0; i < w->p->ny; i++)
        w->point[i] = y[i] + later * dy[i];
    const enum ct_eval e = evaluate(w, t + later, w->point, w->g);
    for (int i = 0; i < w->p->nroot && e == CT_EVAL_OK; i++) {
        if (w->side[i] == 0)
            w->side[i] = (signed char)sign(w->g[i] - w->g0[i]);
        if (w->side[i] == 0) // without a slope it keeps its direction
            w->side[i] = w->crossed[i];
    }
    return e == CT_EVAL_RETRY ? CT_EVAL_OK : e; // the first step will find the side
}

enum ct_eval ct_event_location_start(struct ct_event_location *w, double t, double h,
                                     const double *y, const double *dy)
{
    const int n = w->p->nroot;
    enum ct_eval e = n ? evaluate(w, t, y, w->g0) : CT_EVAL_OK;
    if (e != CT_EVAL_OK || n == 0)
        return e;
    bool any_unknown = false;
    for (int i = 0; i < n; i++) {
        w->side[i] = (signed char)sign(w->g0[i]);
        // the value of a root that fired is round-off, unless the event has changed the state
        if (fabs(w->g0[i]) <= w->recently_fired[i])
            w->side[i] = 0;
        else
            w->recently_fired[i] = 0;
        any_unknown |= w->side[i] == 0;
    }
    if (w->p->sides)
        w->p->sides(w->p->user, w->side);
    else if (any_unknown)
        e = find_sides(w, t, h, y, dy);
    memset(w->crossed, 0, (size_t)n);
    return e;
}

static bool any_stays_zero(const struct ct_event_location *w)
{
    for (int i = 0; i < w->p->nroot; i++)
        if (w->side[i] == 0)
            return true;
    return false;
}

// Root functions that stayed zero and are not zero at y fire, with their sign there.
static enum ct_eval find_leaving_zero(struct ct_event_location *w, double t, const double *y,
                                      bool *any)
{
    const enum ct_eval e = evaluate(w, t, y, w->g);
    for (int i = 0; i < w->p->nroot && e == CT_EVAL_OK; i++) {
        if (w->side[i] != 0 || w->g[i] == 0)
            continue;
        w->crossed[i] = (signed char)sign(w->g[i]);
        w->recently_fired[i] = DBL_MIN; // zero itself is no crossing back
        *any = true;
    }
    return e;
}

// Does a root function that stayed zero change in a step to y_end? The end is tested first, as it
// is more accurate than dense output.
static enum ct_eval search_leaving_zero(struct ct_event_location *w,
                                        const struct ct_stepper_span *s, const double *y_end,
                                        bool *any)
{
    *any = false;
    enum ct_eval e = find_leaving_zero(w, s->t + s->h, y_end, any);
    for (int j = 0; probes[j] < 1 && e == CT_EVAL_OK && !*any; j++) {
        ct_stepper_point(s, probes[j], w->point);
        e = find_leaving_zero(w, s->t + probes[j] * s->h, w->point, any);
    }
    return e;
}

// Has root function i changed sign? Zero counts as a change, unless it stays zero. After an event
// its value is round-off of either sign; until it has left that range only larger values count.
static bool has_crossed(const struct ct_event_location *w, int i, const double *g)
{
    const double x = w->side[i] * g[i];
    return w->side[i] && (w->recently_fired[i] > 0 ? x < -w->recently_fired[i] : x <= 0);
}

// At a probe without an event: root functions that have left the range of round-off after they
// fired.
static void clear_recently_fired(struct ct_event_location *w, const double *g)
{
    for (int i = 0; i < w->p->nroot; i++)
        if (w->side[i] * g[i] > w->recently_fired[i])
            w->recently_fired[i] = 0;
}

static bool any_crossed(const struct ct_event_location *w, const double *g)
{
    for (int i = 0; i < w->p->nroot; i++)
        if (has_crossed(w, i, g))
            return true;
    return false;
}

// The first zero of root functions between low and high, by secants.
// `bias` weighs the values at high against those at low (Illinois).
static double secant_zero(const struct ct_event_location *w, double low, double high,
                          double bias)
{
    double part = 1;
    for (int i = 0; i < w->p->nroot; i++) {
        if (!has_crossed(w, i, w->high))
            continue;
        const double a = fabs(w->low[i]), b = bias * fabs(w->high[i]);
        // at the start of a step its sign may be wrong by round-off
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

// Narrows the bracket [low, high] of the first sign change, from values in w->low and w->high,
// until it is shorter than `width`. It terminates, since at least every third iteration halves the
// bracket.
static enum ct_eval locate(struct ct_event_location *w, const struct ct_stepper_span *s,
                           double low, double high, double width, double *theta)
{
    double bias = 1;
    double before = high - low; // the bracket two tries ago, with `tries` counting since
    for (int tries = 0, last = 0; high - low > width;) {
        double x = secant_zero(w, low, high, bias);
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
static enum ct_eval mark_fired(struct ct_event_location *w, const struct ct_stepper_span *s,
                               double theta)
{
    const double d = theta > 0.5 ? -difference_step : difference_step;
    const enum ct_eval e = evaluate_inside(w, s, theta + d, w->g);
    for (int i = 0; i < w->p->nroot && e == CT_EVAL_OK; i++) {
        w->crossed[i] = has_crossed(w, i, w->high) ? (signed char)-w->side[i] : 0;
        w->slope[i] = (w->g[i] - w->high[i]) / (d * s->h);
    }
    return e;
}

// w->high (out) = g at the end of a step, extrapolated by the resolution of time. So a root that is
// zero there but for round-off fires at the end of this step, before a sample, and not in the next.
static enum ct_eval evaluate_end(struct ct_event_location *w, const struct ct_stepper_span *s,
                                 const double *y_end, double since)
{
    const double ahead = ct_event_location_resolution(s->t, s->h) / (since * s->h);
    const enum ct_eval e = evaluate(w, s->t + s->h, y_end, w->high);
    for (int i = 0; i < w->p->nroot && e == CT_EVAL_OK; i++)
        w->high[i] += ahead * (w->high[i] - w->low[i]);
    return e;
}

// ---- two sign changes between probes ------------------------------------------------------------

bool ct_event_location_may_dip(double a, double b, double c)
{
    const double bend = a - 2 * b + c, slope = (c - a) / 2;
    return bend > 0 && fabs(slope) <= (1 + ct_event_location_margin) * bend
        && 2 * bend * b - slope * slope <= 2 * ct_event_location_margin * bend * bend;
}

// *theta (in, out): a time near theta at which root function i has changed sign by more than
// `depth`, though not at three points `apart` from each other; 2 if there is none. g is left in
// w->high.
static enum ct_eval find_dip(struct ct_event_location *w, const struct ct_stepper_span *s,
                             int i, const double *f, double depth, double apart, double *theta)
{
    double x = *theta, at[3] = {f[0], f[1], f[2]};
    *theta = 2;
    while (apart > difference_step && ct_event_location_may_dip(at[0], at[1], at[2])) {
        const double bend = at[0] - 2 * at[1] + at[2];
        x -= apart * (at[2] - at[0]) / (2 * bend);
        apart *= dip_shrink;
        x = fmin(fmax(x, apart), 1 - apart);
        for (int j = 0; j < 3; j++) {
            const double place = x + (j - 1) * apart;
            const enum ct_eval e = evaluate_inside(w, s, place, w->high);
            if (e != CT_EVAL_OK)
                return e;
            at[j] = w->side[i] * w->high[i];
            if (at[j] < -depth) {
                *theta = place;
                return CT_EVAL_OK;
            }
        }
    }
    return CT_EVAL_OK;
}

// *theta (out): the first time before probe `end` at which a root function has changed sign between
// probes; else 2.
static enum ct_eval search_dips(struct ct_event_location *w, const struct ct_stepper_span *s,
                                int end, double before, double *theta)
{
    const int n = w->p->nroot;
    *theta = 2;
    for (int j = 2; j <= end; j++)
        for (int i = 0; i < n; i++) {
            double f[3], size = 0, x = probes[j - 2];
            for (int k = 0; k < 3; k++) {
                f[k] = w->side[i] * w->probed[n * (j - 2 + k) + i];
                size = fmax(size, fabs(f[k]));
            }
            if (w->recently_fired[i] > 0 || f[0] <= 0 || f[2] <= 0
                || !ct_event_location_may_dip(f[0], f[1], f[2]))
                continue;
            const enum ct_eval e = find_dip(w, s, i, f, resolution * size, probes[0], &x);
            if (e != CT_EVAL_OK)
                return e;
            if (x < before)
                *theta = fmin(*theta, x);
        }
    return CT_EVAL_OK;
}

// Locates the event in [low, high], with no sign change at low, in w->low, and one at high, in
// w->high.
static enum ct_eval locate_in(struct ct_event_location *w, const struct ct_stepper_span *s,
                              double low, double high, double *theta)
{
    const double width = fmin(0.5, ct_event_location_resolution(s->t, s->h) / s->h);
    const enum ct_eval e = locate(w, s, low, high, width, theta);
    return e == CT_EVAL_OK ? mark_fired(w, s, *theta) : e;
}

// *theta (out): the first event between probes before `before`, that probes up to `end` do not
// show; else 2.
static enum ct_eval locate_dip(struct ct_event_location *w, const struct ct_stepper_span *s,
                               int end, double before, double *theta)
{
    const size_t n = (size_t)w->p->nroot;
    double x;
    enum ct_eval e = search_dips(w, s, end, before, &x);
    *theta = 2;
    if (e != CT_EVAL_OK || x > 1)
        return e;
    int k = 0;
    while (probes[k] < x)
        k++;
    memcpy(w->low, w->probed + n * (size_t)k, n * sizeof *w->low);
    e = evaluate_inside(w, s, x, w->high);
    return e == CT_EVAL_OK ? locate_in(w, s, k ? probes[k - 1] : 0, x, theta) : e;
}

enum ct_eval ct_event_location_search(struct ct_event_location *w,
                                      const struct ct_stepper_span *s, const double *y_end,
                                      double *theta)
{
    const size_t n = (size_t)w->p->nroot;
    double before = 0;
    *theta = 2;
    memset(w->crossed, 0, n);
    if (any_stays_zero(w)) {
        bool leaves;
        const enum ct_eval e = search_leaving_zero(w, s, y_end, &leaves);
        if (leaves)
            *theta = 0;
        if (leaves || e != CT_EVAL_OK)
            return e;
    }
    memcpy(w->probed, w->g0, n * sizeof *w->g0);
    for (int j = 0; j < (int)COUNT(probes); j++) {
        double *seen = w->probed + n * (size_t)j;
        memcpy(w->low, seen, n * sizeof *w->low);
        enum ct_eval e = probes[j] < 1 ? evaluate_inside(w, s, probes[j], w->high)
                                       : evaluate_end(w, s, y_end, 1 - before);
        if (e != CT_EVAL_OK)
            return e;
        memcpy(seen + n, w->high, n * sizeof *w->high);
        if (any_crossed(w, w->high)) {
            e = locate_dip(w, s, j + 1, before, theta);
            if (e != CT_EVAL_OK || *theta <= 1)
                return e;
            memcpy(w->low, seen, n * sizeof *w->low);
            memcpy(w->high, seen + n, n * sizeof *w->high);
            return locate_in(w, s, before, probes[j], theta);
        }
        clear_recently_fired(w, w->high);
        before = probes[j];
    }
    const enum ct_eval e = locate_dip(w, s, COUNT(probes), 1, theta);
    if (e == CT_EVAL_OK && *theta > 1)
        memcpy(w->low, w->probed + n * COUNT(probes), n * sizeof *w->low);
    return e;
}

enum ct_eval ct_event_location_refine(struct ct_event_location *w, double t, const double *y,
                                      double *dt)
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

enum ct_eval ct_event_location_accept(struct ct_event_location *w, double t, double h,
                                      const double *y, bool is_event)
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
        // ten resolutions, as the location and its refinement are each good to a few
        // Default: infinitely_many_bounces_are_an_error fails with a hundred. Test: events.
        if (w->crossed[i])
            w->recently_fired[i] = fmax(
                DBL_MIN, // zero itself is no crossing back
                fabs(w->g0[i]) + 10 * fabs(w->slope[i]) * ct_event_location_resolution(t, h));
    }
    return e;
}
