// Callbacks of the integrators for singular configurations, implemented by the rank monitor.
// See singular.h.
#include "numeric/dense.h"
#include "solve/evaluator/switch_state.h"
#include "solve/singular/rank_monitor_internal.h"

#include <math.h>

static double time_to_next(void *user, double *reach)
{
    const struct ct_rank_monitor *w = user;
    *reach = w->reach;
    return w->time_to_singular;
}

static bool is_near(void *user, double t, const double *y)
{
    struct ct_rank_monitor *w = user;
    return ct_rank_monitor_is_roundoff_limited(w, ct_rank_monitor_time(w, t), y);
}

static void set_crossing(void *user, bool is_crossing)
{
    ct_rank_monitor_set_crossing(user, is_crossing);
}

// The residual x' Phi with x'J = 0 and max |x| = 1. With redundant rows the retained ones may
// become dependent before all rows do; then the residual is 0.
static double dependent_residual(struct ct_rank_monitor *w)
{
    const struct ct_evaluator *m = w->m;
    double log_det, sum = 0;
    if ((size_t)w->s->rank < m->nrow)
        return 0;
    if (!ct_partition_dependence(w->s, w->x, &log_det))
        return ct_vector_largest(m->phi, m->nrow);
    for (int i = 0; i < w->s->rank; i++)
        sum += w->x[i] * m->phi[w->s->row[i]];
    return fabs(sum) / ct_vector_largest(w->x, (size_t)w->s->rank);
}

static double residual(void *user, double t, const double *y, double *dependent)
{
    struct ct_rank_monitor *w = user;
    ct_evaluator_set(w->m, ct_rank_monitor_time(w, t), y);
    ct_evaluator_constraint(w->m);
    *dependent = dependent_residual(w) / w->s->scale;
    return ct_vector_largest(w->m->phi, w->m->nrow) / w->s->scale;
}

static bool passed(void *user, const struct ct_stepper_span *step, double begin, double t1)
{
    return ct_rank_monitor_record(user, step, begin, t1);
}

struct ct_singularities ct_singular_hooks(struct ct_rank_monitor *w)
{
    return (struct ct_singularities){.user = w,
                                     .time_to_next = time_to_next,
                                     .is_near = is_near,
                                     .set_crossing = set_crossing,
                                     .residual = residual,
                                     .passed = passed,
                                     .ends_motion = ct_singular_ends_motion};
}
