// Step forecast of long runs: how many steps are to come, and which coordinate has the fastest
// motion. See run_internal.h.
#include "solve/run/run_internal.h"

// Limit: number of steps from which a forecast is printed. So many steps take some minutes for most
// systems; no shipped system needs as many.
const double ct_run_many_steps = 1e6;

// The coordinate with the largest part in the fastest motion at t, y, and the rate of that motion;
// NULL: it is not found.
static const char *find_fastest(struct ct_run *r, double t, const double *y, double *rate)
{
    const int nq = (int)r->m->nq, last = nq + (int)r->m->nu;
    if (!r->problem)
        return NULL;
    struct ct_integrate_stats none = {0};
    struct ct_stiffness *s
        = ct_stiffness_create(r->arena, r->problem, &none, r->o->rtol, nq, last);
    const int i = ct_stiffness_fastest(s, t, y);
    *rate = s->fast;
    // the evaluator is where steps left it
    ct_evaluator_set(r->m, ct_run_time_before_event(r, t), y);
    ct_evaluator_constraint(r->m);
    ct_partition_renew(r->s);
    if (i < 0)
        return NULL;
    const struct ct_u *u = &r->e->u[i - nq];
    return u->q >= 0 ? r->e->q[u->q].name : u->name;
}

// An output for which all vibrations must be resolved, (8.10); NULL: there is none.
static const char *find_demanding(const struct ct_run *r)
{
    for (size_t i = 0; i < r->e->nresult; i++)
        if (ct_output_error_needs_accelerations(r->e, i))
            return r->e->result[i].name;
    return NULL;
}

void ct_run_forecast(void *user, double t, const double *y, double step, double to_come)
{
    struct ct_run *r = user;
    struct ct_step_forecast f = {.t = t, .step = step, .to_come = to_come};
    if (r->is_announced || r->trial || !r->o->forecast)
        return;
    r->is_announced = true;
    f.fastest = find_fastest(r, t, y, &f.rate);
    f.demanding = find_demanding(r);
    r->o->forecast(r->o->user, &f);
}

void ct_run_explain_count(struct ct_run *r)
{
    const struct ct_mark nowhere = {0};
    double rate;
    const char *fastest = find_fastest(r, r->stats.last_time, r->y, &rate);
    const char *demanding = find_demanding(r);
    if (fastest)
        ct_note(r->ctx, nowhere,
                "the fastest motion that is possible, of %.2g 1/s, is one of '%s'", rate,
                fastest);
    if (demanding)
        ct_note(r->ctx, nowhere,
                "for the output '%s' every vibration is followed; without it those that move "
                "no output need not be",
                demanding);
    ct_note(r->ctx, nowhere,
            "steps follow vibrations that are excited: start beams with 'initial: "
            "equilibrium', leave out or damp what is stiff, or raise 'absolute' above them; "
            "what is not excited holds up explicit methods only");
}
