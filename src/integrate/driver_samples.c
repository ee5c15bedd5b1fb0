// See driver.h: samples.
#include "integrate/driver.h"

static const struct ct_mark nowhere = {0};

bool ct_driver_is_in_gap(const struct ct_driver *r, const struct ct_stride *s, double t)
{
    const double theta = (t - r->t) / s->h;
    double from, to;
    return s->is_striding ? ct_striding_is_gap(r->striding, theta, &from, &to)
                          : s->method == &ct_crossing && ct_crossing_is_gap(theta);
}

static bool give_sample(struct ct_driver *r, const double *y)
{
    const double t = r->o->sample[r->sample++];
    return r->o->at_sample(r->p->user, t, y);
}

static struct ct_bridge bridge(const struct ct_driver *r, const struct ct_stride *s,
                               double theta)
{
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    double from, to;
    if (!s->is_striding)
        return ct_crossing_bridge(s->work, r->t, s->h, theta);
    ct_striding_is_gap(r->striding, theta, &from, &to);
    return ct_crossing_bridge_over(r->crossing_work, &span, from, to, theta);
}

// A sample in the gap of a crossing is as good as the interpolant: projected it would be worse.
static bool give_singular_sample(struct ct_driver *r, const struct ct_stride *s,
                                 const double *y)
{
    const double t = r->o->sample[r->sample];
    if (!r->o->at_singular_sample)
        return give_sample(r, y);
    const struct ct_bridge b = bridge(r, s, (t - r->t) / s->h);
    r->sample++;
    return r->o->at_singular_sample(r->p->user, t, y, &b);
}

static bool give_projected_sample(struct ct_driver *r, double *y)
{
    const struct ct_problem *p = r->p;
    const double t = r->o->sample[r->sample];
    const enum ct_eval e = p->project ? p->project(p->user, t, y) : CT_EVAL_OK;
    if (e == CT_EVAL_RETRY)
        return ct_error(r->ctx, nowhere, CT_E_SAMPLE_REFUSED,
                        "the constraints cannot be met at t = %.9g", t);
    return e == CT_EVAL_OK && give_sample(r, y);
}

// y (ny, out) at t, inside of the step: from the interpolant, where that holds, else by a step from the start of this one.
static bool find_state(struct ct_driver *r, const struct ct_stride *s, double t, double *y)
{
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    double error;
    if (!s->is_damping) {
        ct_stepper_point(&span, (t - r->t) / s->h, y);
        return true;
    }
    const enum ct_eval e = s->method->step(r->p, r->t, t - r->t, r->y, r->dy, NULL, y,
                                           r->dbeside, &error, r->aside, r->stats);
    if (e == CT_EVAL_OK && ct_stepper_finite(y, r->p->ny))
        return true;
    return e != CT_EVAL_FATAL
        && ct_error(r->ctx, nowhere, CT_E_STATE_REFUSED,
                    "the equations of motion cannot be evaluated at t = %.9g", t);
}

bool ct_driver_give_samples_before(struct ct_driver *r, const struct ct_stride *s, double end)
{
    while (r->sample < r->o->nsample && r->o->sample[r->sample] <= s->t1) {
        const double t = r->o->sample[r->sample];
        const bool is_singular = !s->is_event && ct_driver_is_in_gap(r, s, t);
        if (t >= end && !is_singular)
            break;
        if (!find_state(r, s, t, r->point))
            return false;
        if (is_singular ? !give_singular_sample(r, s, r->point)
                        : !give_projected_sample(r, r->point))
            return false;
    }
    return true;
}

bool ct_driver_give_samples_here(struct ct_driver *r)
{
    while (r->sample < r->o->nsample && r->o->sample[r->sample] <= r->t)
        if (!give_sample(r, r->y))
            return false;
    return true;
}
