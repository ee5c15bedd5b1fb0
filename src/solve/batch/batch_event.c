// Events of one lane, by the functions of a run alone: see batch_internal.h. A step in which a
// root function changes sign is repeated up to the estimated root, and then corrected, as in
// integrate/driver.c, while the other lanes continue.
#include "solve/batch/batch_internal.h"
#include "solve/run/run_internal.h"

#include "integrate/stepper.h"

#include <math.h>

// The cubic Hermite interpolant of the step is less accurate than the method's own, which would
// be evaluated for all lanes; one of them is used.
enum { MOST_TRIES = CT_EVENT_CORRECTIONS + 1 };

// ---- root functions -----------------------------------------------------------------------------

// Evaluated for all lanes; one of them is used.
static enum ct_eval root(void *user, double t, const double *y, double *g)
{
    const struct ct_lane_user *of = user;
    struct ct_batch *s = of->s;
    const int l = of->lane;
    s->input[0][l] = ct_time_just_before(t, s->lane[l].events.pending);
    ct_lane_put(s->input + s->m->at_q, l, y, (size_t)s->nq + (size_t)s->nu);
    s->input[s->m->at_work][l] = y[s->ny - 1];
    ct_lane_run(&s->root, s->input);
    for (int i = 0; i < s->nroot; i++)
        g[i] = s->root.out[s->root_of[i]][l];
    return CT_EVAL_OK;
}

static void sides(void *user, signed char *side)
{
    const struct ct_lane_user *of = user;
    const struct ct_batch *s = of->s;
    for (int i = 0; i < s->nroot; i++) {
        const size_t k = (size_t)s->root_of[i];
        side[i]
            = (signed char)ct_switches_side(s->m, k, s->input[s->m->at_switch + k][of->lane]);
    }
}

// Slopes at both ends of a step.
struct slopes {
    const double *dy, *dend;
};

static void cubic(const struct ct_problem *p, double h, double theta, const double *y,
                  const double *y1, void *work, double *out)
{
    const struct slopes *d = work;
    ct_stepper_hermite(out, theta, h, y, d->dy, y1, d->dend, p->ny);
}

// Copies the state of event location of this lane to the arrays for all lanes.
static void share(struct ct_batch *s, int l)
{
    const struct ct_event_location *w = &s->lane[l].events.location;
    s->unsettled &= ~(1u << l);
    for (int i = 0; i < s->nroot; i++) {
        s->side[i][l] = w->side[i];
        s->g0[i][l] = s->g[i][l] = w->g0[i];
        if (w->side[i] == 0 || w->recently_fired[i] > 0)
            s->unsettled |= 1u << l;
    }
}

// ---- the start ----------------------------------------------------------------------------------

void ct_lane_make_events(struct ct_batch *s)
{
    struct ct_arena *a = s->arena;
    s->nroot = s->run->nroot;
    s->root_of = s->run->root_of;
    s->side = CT_NEWN(a, vec, s->nroot + 1);
    s->g0 = CT_NEWN(a, vec, s->nroot + 1);
    s->g = CT_NEWN(a, vec, s->nroot + 1);
    s->g_before = CT_NEWN(a, vec, s->nroot + 1);
    for (int l = 0; l < W; l++) {
        struct ct_lane_events *v = &s->lane[l].events;
        s->before[l] = v->pending = INFINITY;
        v->user = (struct ct_lane_user){s, l};
        v->problem = (struct ct_problem){
            .user = &v->user, .ny = s->ny, .nroot = s->nroot, .root = root, .sides = sides};
        v->dy = CT_NEWN(a, double, s->ny);
        v->dend = CT_NEWN(a, double, s->ny);
        ct_event_location_init(&v->location, &v->problem, a);
    }
}

static void lend(struct ct_batch *s, struct ct_lane_events *v)
{
    s->run->o = &v->options;
    s->run->event = v->time;
    s->run->nevent = v->ntime;
    s->run->pending = v->pending;
}

static void await(struct ct_batch *s, int l)
{
    struct ct_lane_events *v = &s->lane[l].events;
    v->pending = s->run->pending;
    s->before[l] = ct_time_just_before(INFINITY, v->pending);
}

static void find_times(struct ct_batch *s, struct ct_lane_events *v)
{
    ct_arena_destroy(v->arena);
    v->arena = ct_arena_create_under(s->arena);
    v->ntime
        = ct_time_events(v->arena, s->m, s->method->order, 0, v->options.duration, &v->time);
}

static bool has_time_events(const struct ct_batch *s)
{
    const struct ct_exs *x = s->e->x;
    bool has = (size_t)s->nroot < s->e->nswitch;
    for (size_t i = 0; i < x->ntable; i++)
        has |= ct_table_has_kinks(&x->table[i], s->method->order);
    return has;
}

bool ct_lane_begin_events(struct ct_batch *s, int l, const struct ct_run_options *o)
{
    struct ct_lane *lane = &s->lane[l];
    struct ct_lane_events *v = &lane->events;
    struct ct_run *r = s->run;
    v->options = *o;
    v->whole = 0;
    v->is_event = false;
    if (has_time_events(s))
        find_times(s, v);
    ct_input_sampling_sample(s->arena, s->m, o->duration, &v->input_sampling);
    lend(s, v);
    r->pending = ct_run_next_event(r, 0);
    await(s, l);
    lane->longest = s->nroot ? ct_event_location_longest_step(o->duration) : o->duration;
    for (int i = 0; i < s->nroot; i++)
        v->location.recently_fired[i] = 0;
    v->location.last_event = -INFINITY;
    v->location.accumulated = 0;
    if (!s->e->nswitch)
        return true;
    ct_switches_start(s->m, 0, r->y, r->dy, NULL);
    return ct_run_settle_switches(r, 0, r->y, NULL) == CT_EVAL_OK && !s->m->has_rest;
}

bool ct_lane_reinitialize(struct ct_batch *s, int l, double t, const double *y,
                          const double *dy)
{
    struct ct_lane *lane = &s->lane[l];
    if (!s->nroot)
        return true;
    if (ct_event_location_start(&lane->events.location, t, lane->control.h, y, dy)
        != CT_EVAL_OK)
        return false;
    share(s, l);
    return true;
}

double ct_lane_stop(const struct ct_lane *lane)
{
    return fmin(lane->t1, lane->events.pending);
}

// ---- the search ---------------------------------------------------------------------------------

// Accept the step that was tried.
static enum ct_lane_found accept_step(struct ct_batch *s, int l, double h, bool is_event)
{
    struct ct_lane_events *v = &s->lane[l].events;
    v->is_event = is_event;
    v->whole = 0;
    if (ct_event_location_accept(&v->location, s->lane[l].end, h, s->one_end, is_event)
        != CT_EVAL_OK)
        return CT_LANE_REFUSED;
    share(s, l);
    return CT_LANE_GOES_ON;
}

// Is there an event in a step that was tried as planned?
static enum ct_lane_found search_step(struct ct_batch *s, int l)
{
    struct ct_lane *lane = &s->lane[l];
    struct ct_lane_events *v = &lane->events;
    struct slopes slopes = {v->dy, v->dend};
    const struct ct_method by_cubic = {.name = "cubic", .dense = cubic};
    const struct ct_stepper_span span
        = {&by_cubic, &v->problem, s->t[l], s->h[l], s->one_y, s->one_end, &slopes};
    double theta;
    ct_lane_take(s->one_y, s->y, l, (size_t)s->ny);
    ct_lane_take(v->dy, s->dy, l, (size_t)s->ny);
    ct_lane_take(v->dend, s->dend, l, (size_t)s->ny);
    ct_lane_take(v->location.g0, s->g0, l, (size_t)s->nroot);
    if (ct_event_location_search(&v->location, &span, s->one_end, &theta) != CT_EVAL_OK)
        return CT_LANE_REFUSED;
    if (theta == 0) { // a root function has left zero
        ct_lane_give_up(s, l);
        return CT_LANE_REFUSED;
    }
    if (theta > 1 || (1 - theta) * span.h <= ct_event_location_resolution(span.t, span.h))
        return accept_step(s, l, lane->h, theta <= 1);
    v->whole = span.h;
    v->whole_end = lane->end;
    v->error = lane->error;
    v->h = theta * span.h;
    v->tries = 0;
    return CT_LANE_AGAIN;
}

// The step was taken again: does it end on the event?
static enum ct_lane_found refine(struct ct_batch *s, int l)
{
    struct ct_lane *lane = &s->lane[l];
    struct ct_lane_events *v = &lane->events;
    const double unresolved = ct_event_location_resolution(s->t[l], v->whole);
    double dt;
    if (ct_event_location_refine(&v->location, lane->end, s->one_end, &dt) != CT_EVAL_OK)
        return CT_LANE_REFUSED;
    if (lane->end < v->whole_end && fabs(dt) > unresolved && v->h + dt > 0
        && ++v->tries < MOST_TRIES) {
        v->h += dt;
        return CT_LANE_AGAIN;
    }
    lane->error = v->error; // step control uses the error of the whole step
    return accept_step(s, l, lane->h, true);
}

enum ct_lane_found ct_lane_search(struct ct_batch *s, int l)
{
    ct_lane_take(s->one_end, s->end, l, (size_t)s->ny);
    return s->lane[l].events.whole > 0 ? refine(s, l) : search_step(s, l);
}

void ct_lane_plan_again(struct ct_batch *s, int l)
{
    struct ct_lane *lane = &s->lane[l];
    const struct ct_lane_events *v = &lane->events;
    const bool is_whole = v->whole - v->h <= ct_event_location_resolution(s->t[l], v->whole);
    s->h[l] = is_whole ? v->whole : v->h;
    lane->end = is_whole ? v->whole_end : s->t[l] + v->h;
}

// ---- the event ----------------------------------------------------------------------------------

// Handles the event as a single run does. False: the member must be run alone, which reports the
// error or treats switches at rest.
static bool handle(struct ct_batch *s, int l, bool is_time)
{
    struct ct_lane *lane = &s->lane[l];
    struct ct_lane_events *v = &lane->events;
    struct ct_evaluator *m = s->m;
    const double t = lane->end;
    const long switches = s->partition->switches;
    ct_lane_load_run_whole(s, l, t, s->y);
    lend(s, v);
    if (ct_run_event(s->run, t, s->one_y, NULL, v->location.crossed, is_time) != CT_EVAL_OK
        || ct_run_rhs(s->run, t, s->one_y, s->one_dy) != CT_EVAL_OK || m->has_rest)
        return false;
    await(s, l);
    ct_lane_put(s->y, l, s->one_y, (size_t)s->ny);
    ct_lane_put(s->dy, l, s->one_dy, (size_t)s->ny);
    ct_lane_put(s->input + m->at_switch, l, m->input + m->at_switch, s->e->nswitch);
    if (s->partition->switches != switches && !ct_lane_choose(s, l))
        return false;
    lane->control.is_starting = true;
    lane->pivot_last = INFINITY;
    ct_lane_limit_turn(s, l, t, s->one_y);
    return ct_lane_reinitialize(s, l, t, s->one_y, s->one_dy);
}

void ct_lane_pass(struct ct_batch *s, int l)
{
    struct ct_lane *lane = &s->lane[l];
    struct ct_lane_events *v = &lane->events;
    const bool is_time = lane->end >= v->pending, is_state = v->is_event;
    v->is_event = false;
    if (!is_time && !is_state)
        return;
    if ((is_state
         && ct_event_location_accumulates(&v->location, lane->end, v->options.duration))
        || !handle(s, l, is_time))
        ct_lane_give_up(s, l);
}
