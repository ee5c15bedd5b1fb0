// See crossing_stage_gap.h.
#include "integrate/crossing_stage_gap.h"
#include "integrate/crossing.h"

#include <math.h>
#include <string.h>

// No stage is nearer than this part of the reach, where a pivot of J is 0.04 of its largest: f then errs by 2e-13, round-off
// over the square of that.
static const double nearest_stage = 0.15;
// A step may be so much longer than wanted to be one that strides, and is planned for so much more than the least length:
// where the position is, is known better nearer by.
static const double longer = 1.1, margin = 1.1;

struct ct_stage_gap {
    const struct ct_problem *p;
    const struct ct_method *method;
    struct ct_problem over; // p with its stages put onto the constraints
    double *point;          // (ny)
};

static enum ct_eval rhs(void *user, double t, const double *y, double *dy)
{
    const struct ct_stage_gap *s = user;
    memcpy(s->point, y, (size_t)s->p->ny * sizeof *y);
    const enum ct_eval e = s->p->project(s->p->user, t, s->point);
    return e == CT_EVAL_OK ? s->p->rhs(s->p->user, t, s->point, dy) : e;
}

static double output_error(void *user, double t, const double *y, const double *e,
                           const struct ct_tolerance *tolerance, double states)
{
    const struct ct_stage_gap *s = user;
    return s->p->output_error(s->p->user, t, y, e, tolerance, states);
}

struct ct_stage_gap *ct_stage_gap_create(struct ct_arena *a, const struct ct_method *method,
                                         const struct ct_problem *p)
{
    if (!(method->stage_gap[1] > 0) || !p->project || !p->set_crossing || !p->mismatch
        || p->nroot)
        return NULL;
    struct ct_stage_gap *s = CT_NEW(a, struct ct_stage_gap);
    *s = (struct ct_stage_gap){.p = p, .method = method, .over = *p};
    s->over.user = s;
    s->over.rhs = rhs;
    s->over.output_error = p->output_error ? output_error : NULL;
    s->point = CT_NEWN(a, double, p->ny);
    return s;
}

static double centre(const struct ct_stage_gap *s)
{
    return (s->method->stage_gap[0] + s->method->stage_gap[1]) / 2;
}

double ct_stage_gap_length(const struct ct_stage_gap *s, double in)
{
    return in / centre(s);
}

double ct_stage_gap_approach(const struct ct_stage_gap *s, double in, double reach,
                             double wanted)
{
    const double half = (s->method->stage_gap[1] - s->method->stage_gap[0]) / 2;
    const double nearest = nearest_stage * reach * centre(s) / half,
                 farthest = centre(s) * wanted;
    if (!(margin * nearest <= farthest))
        return INFINITY;
    if (in >= nearest && in <= longer * farthest)
        return 0;
    const double step = fmin(wanted, in - margin * nearest);
    return in - step > farthest ? fmin(wanted, in - farthest) : step > 0 ? step : INFINITY;
}

enum ct_eval ct_stage_gap_step(struct ct_stage_gap *s, double t, double h, const double *y,
                               const double *dy, const struct ct_tolerance *tolerance,
                               double *y1, double *dy1, double *err, void *work,
                               struct ct_integrate_stats *stats)
{
    const struct ct_method *m = s->method;
    s->p->set_crossing(s->p->user, true);
    enum ct_eval e = m->step(&s->over, t, h, y, dy, tolerance, y1, dy1, err, work, stats);
    const bool is_accurate = e == CT_EVAL_OK && *err <= 1;
    if (is_accurate)
        e = m->prepare(&s->over, t, h, y, y1, work, stats);
    s->p->set_crossing(s->p->user, false);
    if (!is_accurate || e != CT_EVAL_OK)
        return e;
    m->dense(s->p, h, centre(s), y, y1, work, s->point);
    if (ct_crossing_misses_singularity(s->p, t + centre(s) * h, s->point))
        *err = INFINITY;
    return CT_EVAL_OK;
}

bool ct_stage_gap_contains(const struct ct_stage_gap *s, double theta, double *from, double *to)
{
    *from = s->method->stage_gap[0];
    *to = s->method->stage_gap[1];
    return theta > *from && theta < *to;
}
