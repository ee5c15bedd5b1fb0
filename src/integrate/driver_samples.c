// Samples by dense output; see driver.h.
#include "integrate/driver.h"

static const struct ct_mark nowhere = {0};

bool ct_driver_is_in_gap(const struct ct_driver *r, const struct ct_planned_step *s, double t)
{
    const double theta = (t - r->t) / s->h;
    return s->method == &ct_crossing && ct_crossing_is_gap(s->work, theta);
}

static bool give_sample(struct ct_driver *r, const double *y)
{
    const double t = r->o->sample[r->sample++];
    return r->o->at_sample(r->p->user, t, y);
}

// A sample in the gap of a crossing comes from the interpolant. Projection would make it less
// accurate, as the constraints are dependent there.
static bool give_singular_sample(struct ct_driver *r, const struct ct_planned_step *s,
                                 const double *y)
{
    const double t = r->o->sample[r->sample];
    if (!r->o->at_singular_sample)
        return give_sample(r, y);
    const struct ct_gap_interpolation b
        = ct_crossing_interpolation(s->work, r->t, s->h, (t - r->t) / s->h);
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
                        "the constraints cannot be met at t = %.9g, between two steps that do "
                        "meet them: the steps are too long for the mechanism; take a smaller "
                        "tolerance",
                        t);
    return e == CT_EVAL_OK && give_sample(r, y);
}

// Is there a mode that the step damps instead of resolving it? Not every step shows it, so the
// largest rate is remembered.
static bool is_unresolved(struct ct_driver *r, const struct ct_planned_step *s)
{
    // Part of the largest rate that is kept from step to step.
    // Default: comparisons of interpolants against a fast mode that is missed. Test: integrate.
    const double kept = 0.95;
    if (!r->sample_work || s->work != r->work)
        return false;
    const double seen = r->method->stiffness_estimate(r->p, s->h, r->y, r->y1, s->work) / s->h;
    r->fastest = ct_larger(seen, kept * r->fastest);
    return r->fastest * s->h > r->method->resolved_limit;
}

bool ct_driver_has_sample(const struct ct_driver *r, const struct ct_planned_step *s)
{
    return r->sample < r->o->nsample && r->o->sample[r->sample] < s->t1;
}

// Is the error of the interpolant at the next sample too large; without a sample, in the middle of
// the step? It is the difference to a separate step from the start of this one. After each check
// that passes, twice as many checks are skipped. After one that fails, the next MOST_SKIPPED steps
// are treated as inaccurate.
static bool is_interpolant_inaccurate(struct ct_driver *r, const struct ct_planned_step *s)
{
    // Default: evaluations against inaccurate interpolants that are not found. Test: integrate.
    enum { MOST_SKIPPED = 31 };
    // Default: evaluations against the error of samples. Test: integrate.
    const double much = 0.01;
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    const double h = ct_driver_has_sample(r, s) ? r->o->sample[r->sample] - r->t : s->h / 2;
    double unused;
    if (r->checks_to_skip > 0) {
        r->checks_to_skip--;
        return r->was_inaccurate;
    }
    r->was_inaccurate = true;
    if (s->method->step(r->p, r->t, h, r->y, r->dy, NULL, r->sample_end, r->dsample_end,
                        &unused, r->sample_work, r->stats)
        == CT_EVAL_OK) {
        ct_stepper_point(&span, h / s->h, r->point);
        for (int i = 0; i < r->p->ny; i++)
            r->point[i] -= r->sample_end[i];
        r->was_inaccurate
            = !(ct_stepper_norm(r->p, &r->tolerance, r->y, r->y1, r->point) <= much);
    }
    r->skipped_checks = r->was_inaccurate                ? 0
                      : r->skipped_checks < MOST_SKIPPED ? 2 * r->skipped_checks + 1
                                                         : r->skipped_checks;
    r->checks_to_skip = r->was_inaccurate ? MOST_SKIPPED : r->skipped_checks;
    return r->was_inaccurate;
}

bool ct_driver_damps_fast_mode(struct ct_driver *r, const struct ct_planned_step *s)
{
    return is_unresolved(r, s) && is_interpolant_inaccurate(r, s);
}

// y (ny, out) = the state at a time t inside the step: from the interpolant where it is accurate,
// else by a separate step from the start of this one.
static bool find_state(struct ct_driver *r, const struct ct_planned_step *s, double t,
                       double *y)
{
    const struct ct_stepper_span span = {s->method, r->p, r->t, s->h, r->y, r->y1, s->work};
    double error;
    if (!s->damps_fast_mode) {
        ct_stepper_point(&span, (t - r->t) / s->h, y);
        return true;
    }
    const enum ct_eval e = s->method->step(r->p, r->t, t - r->t, r->y, r->dy, NULL, y,
                                           r->dsample_end, &error, r->sample_work, r->stats);
    if (e == CT_EVAL_OK && ct_stepper_finite(y, r->p->ny))
        return true;
    return e != CT_EVAL_FATAL
        && ct_error(r->ctx, nowhere, CT_E_STATE_REFUSED,
                    "the equations of motion cannot be evaluated at t = %.9g", t);
}

bool ct_step_state(const struct ct_step_view *step, double t, double *y,
                   struct ct_gap_interpolation *gap)
{
    struct ct_driver *r = step->driver;
    const struct ct_planned_step *s = step->step;
    *gap = (struct ct_gap_interpolation){0};
    if (ct_driver_is_in_gap(r, s, t))
        *gap = ct_crossing_interpolation(s->work, r->t, s->h, (t - r->t) / s->h);
    if (t > r->t && t < s->t1)
        return find_state(r, s, t, y);
    ct_stepper_copy(y, t > r->t ? r->end : r->y, r->p->ny);
    return true;
}

bool ct_driver_give_samples_before(struct ct_driver *r, const struct ct_planned_step *s,
                                   double end)
{
    while (r->sample < r->o->nsample && r->o->sample[r->sample] <= s->t1) {
        const double t = r->o->sample[r->sample];
        const bool is_singular = ct_driver_is_in_gap(r, s, t);
        if (t >= end && (s->is_event || !is_singular))
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
