// See advance.h.
#include "solve/run/advance.h"

#include "solve/run/run_internal.h"

#include <float.h>
#include <string.h>

// A search for time events goes so many calls ahead, a quarter of a call for each of its pieces.
// Default: evaluations against pulses within a call that are missed. Test: live
static const double steps_ahead = 1024;

struct ct_advance {
    struct ct_run *r;
    struct ct_run_options o;
    struct ct_run_report report;
    struct ct_problem p;
    struct ct_ctx call;      // of one call
    struct ct_arena *events; // the list of time events
    bool has_time_events, is_assembled;
    double horizon; // up to which they are known
    double *side;   // sides of switches, saved during that search
    double h;
};

static bool has_time_events(const struct ct_equations *e)
{
    for (size_t i = 0; i < e->nswitch; i++)
        if (e->switches[i].is_time)
            return true;
    return e->x->ntable > 0;
}

struct ct_advance *ct_advance_create(struct ct_arena *a, struct ct_run *r,
                                     const struct ct_run_options *o)
{
    struct ct_advance *s = CT_NEW(a, struct ct_advance);
    bool *watched = CT_NEWN(a, bool, r->ny);
    *s = (struct ct_advance){.r = r, .o = *o};
    s->o.duration = 0;
    s->o.stiff_method = NULL;
    s->report = (struct ct_run_report){.method = o->method, .roundoff_limited = -1};
    s->call.model = ct_arena_create_under(a);
    s->call.scratch = ct_arena_create_under(a);
    s->events = ct_arena_create_under(a);
    s->has_time_events = has_time_events(r->e);
    s->side = CT_NEWN(a, double, r->e->nswitch + 1);
    for (size_t i = 0; i < r->ny; i++)
        watched[i] = i + 1 < r->ny || r->has_power;
    r->output_error = NULL; // no error control of outputs
    r->o = &s->o;
    r->method = o->method;
    r->report = &s->report;
    ct_run_monitor_start(r, 0, r->y);
    ct_run_pose(r, &s->p, watched);
    s->p.input_limited_step = NULL; // the owner's steps are short
    return s;
}

double *ct_advance_state(struct ct_advance *s)
{
    return s->r->y;
}

double ct_advance_next_step(const struct ct_advance *s)
{
    return s->h;
}

void ct_advance_set_next_step(struct ct_advance *s, double h)
{
    s->h = h;
}

// Finds the time events in (t, until]. Sides of switches do not change.
static void look_for_events(struct ct_advance *s, double t, double until)
{
    struct ct_run *r = s->r;
    double *side = r->m->input + r->m->at_switch;
    const size_t bytes = r->e->nswitch * sizeof *side;
    memcpy(s->side, side, bytes);
    ct_arena_clear(s->events);
    r->nevent = ct_time_events(s->events, r->m, s->o.method->order, t, until, &r->event);
    memcpy(side, s->side, bytes);
    s->horizon = until;
}

bool ct_advance_start(struct ct_advance *s, double t, const double *y, bool is_assembled)
{
    struct ct_run *r = s->r;
    if (y != r->y)
        memcpy(r->y, y, r->ny * sizeof *y);
    ct_rank_monitor_start(r->singular);
    r->singular->output_rtol = s->o.step == 0 ? s->o.output_rtol : 0;
    r->s->least_cancellation
        = s->o.step == 0 && s->o.output_rtol > 0 ? DBL_EPSILON / s->o.output_rtol : 0;
    r->s->smallest_cancellation = INFINITY;
    r->last_event = -INFINITY;
    r->has_jumped = false;
    r->t0 = t;
    r->nevent = 0;
    r->pending = INFINITY;
    s->horizon = t;
    s->h = 0;
    s->is_assembled = is_assembled;
    enum ct_eval e = ct_run_rhs(r, t, r->y, r->dy);
    ct_switches_start(r->m, t, r->y, e == CT_EVAL_OK ? r->dy : NULL, NULL);
    ct_run_store_angle_rate(r, t, r->y);
    return ct_run_settle_switches(r, t, r->y, NULL) != CT_EVAL_FATAL;
}

bool ct_advance_refresh(struct ct_advance *s, double t)
{
    struct ct_run *r = s->r;
    s->horizon = t;
    if (!r->e->nswitch || ct_run_rhs(r, t, r->y, r->dy) != CT_EVAL_OK)
        return true; // the step reports the error
    ct_switches_start(r->m, t, r->y, r->dy, NULL);
    return ct_run_settle_switches(r, t, r->y, NULL) != CT_EVAL_FATAL;
}

bool ct_advance_to(struct ct_advance *s, double t0, double t1, double *t, struct ct_ctx **said)
{
    struct ct_run *r = s->r;
    ct_arena_clear(s->call.model);
    ct_arena_clear(s->call.scratch);
    s->call.diagnostic = NULL;
    s->call.ndiagnostic = s->call.diagnostic_cap = s->call.nerror = 0;
    *said = &s->call;
    *t = t0;
    s->o.duration = s->p.duration = t1;
    if (s->has_time_events && t1 > s->horizon)
        look_for_events(s, t0, t0 + steps_ahead * (t1 - t0));
    r->pending = ct_run_next_event(r, t0);
    if (!ct_run_tables_reach(r, t0))
        return false;
    if (s->is_assembled) { // near a singular configuration steps begin before it
        if (!ct_run_start_steps(r))
            return false;
        s->is_assembled = false;
        t0 = r->t0;
    }
    const struct ct_integrate_options io = {.t0 = t0,
                                            .t1 = t1,
                                            .rtol = s->o.rtol,
                                            .atol = s->o.atol,
                                            .step = s->o.step,
                                            .first_step = s->o.step > 0 ? 0 : s->h};
    const bool ok = ct_integrate(&s->call, s->o.method, &s->p, &io, r->y, &r->stats);
    *t = r->stats.last_time;
    s->h = r->stats.steps > 0 ? r->stats.next_step : 0;
    ct_evaluator_set(r->m, *t, r->y);
    ct_memory_update(r->m);
    return ok;
}
