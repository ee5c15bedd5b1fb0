// Rank monitor: finds and records the singular configuration on a crossing, for the report and for
// dense output. See singular.h.
#include "solve/singular/rank_monitor_internal.h"

#include "numeric/dense.h"
#include "solve/evaluator/switch_state.h"

#include <math.h>
#include <string.h>

// A search evaluates the pivot at PARTS points of the step; the interval around the smallest is
// reduced NREDUCTION times to an eighth. The result is accurate to `resolved` of the step.
// Limit: of the time of a search. Derived: resolved to 1e-4 of the step, where rank is measured
enum { PARTS = 16, NREDUCTION = 3 };
static const double interval_reduction = 1.0 / 8, resolved = 1.0 / (PARTS * 8 * 8 * 8);

// Distance, as a fraction of the step, on either side of a singular configuration at which the
// dependent rows are found. Derived: a quarter of the spacing of points
static const double test_distance = 1.0 / (4 * PARTS);

// row: is the row part of the dependence x (rank), a vector of null(J') from
// ct_partition_dependence at `test_distance` or nearer? Entries of such rows are of order 1,
// those of others of order test_distance^2 = 2e-4. With ten times the limit a row of a
// parallelogram is omitted (tests/cli/singular.sh).
static void mark_rows(const struct ct_rank_monitor *w, bool *row)
{
    // Derived: between test_distance^2 and 1.
    const double involved = 1e-3; // of the largest entry
    const int n = w->s->rank;
    double most = 0;
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(w->x[i]));
    for (int i = 0; i < n; i++)
        row[w->s->row[i]] = fabs(w->x[i]) > involved * most;
}

struct passage {
    const struct ct_stepper_span *span;
    double begin, pending; // `begin`: of the span, as a fraction of the crossing
    const struct ct_rank_test
        *to; // without a span: from the last state to this one, with constant acceleration
};

static double time_on(const struct passage *p, double part)
{
    return p->span->t + (part - p->begin) / (1 - p->begin) * p->span->h;
}

static double pivot_to(struct ct_rank_monitor *w, const struct ct_rank_test *to, double part)
{
    const size_t nq = w->m->nq, nu = w->m->nu;
    const double dt = to->t - w->t, *u = w->last + nq, *v = to->y + nq;
    memcpy(w->y, w->last, (nq + nu) * sizeof *w->y);
    for (size_t i = 0; i < nu; i++)
        w->d[i] = part * dt * (u[i] + part / 2 * (v[i] - u[i]));
    ct_evaluator_retract(w->m, w->y, w->d);
    return ct_rank_monitor_pivot(w, ct_time_just_before(w->t + part * dt, to->pending), w->y);
}

static double pivot_on(struct ct_rank_monitor *w, const struct passage *p, double part)
{
    if (!p->span)
        return pivot_to(w, p->to, part);
    ct_stepper_point(p->span, (part - p->begin) / (1 - p->begin), w->y);
    return ct_rank_monitor_pivot(w, ct_time_just_before(time_on(p, part), p->pending), w->y);
}

// Refine theta, which is within d of the minimum of the pivot. The pivot falls and rises about
// linearly, so its values on both sides give the zero.
static double narrow_interval(struct ct_rank_monitor *w, const struct passage *p, double theta,
                              double d)
{
    for (int i = 0; i < NREDUCTION; i++) {
        const double before = pivot_on(w, p, theta - d), behind = pivot_on(w, p, theta + d);
        theta += d * (before - behind) / (before + behind);
        d *= interval_reduction;
    }
    return theta;
}

// The fraction of the step, near its middle, at which the pivot is below `zero`; else NaN.
static double find_zero_in_middle(struct ct_rank_monitor *w, const struct passage *p,
                                  double zero)
{
    const double theta = narrow_interval(w, p, 0.5, 1.0 / PARTS);
    return pivot_on(w, p, theta) < zero ? theta : NAN;
}

// The fraction of the step at which the smallest pivot is least, if it is below `zero` there;
// else NaN.
static double find_smallest_pivot(struct ct_rank_monitor *w, const struct passage *p,
                                  double zero)
{
    double least = INFINITY, at = 0;
    for (int i = 0; i <= PARTS; i++) {
        const double part = (double)i / PARTS, pivot = pivot_on(w, p, part);
        if (pivot < least) {
            least = pivot;
            at = part;
        }
    }
    at = narrow_interval(w, p, at, 1.0 / PARTS);
    return pivot_on(w, p, at) < zero ? at : NAN;
}

// Find the dependent rows and the loss of rank: at a distance d from the singular configuration
// det J_d ~ d^loss.
static void find_dependence(struct ct_rank_monitor *w, const struct passage *p, double theta,
                            struct ct_singular_configuration *at)
{
    double far, near;
    const int n = w->s->rank;
    memset(at->row, 0, w->m->nrow * sizeof *at->row);
    at->rank_loss = 0;
    pivot_on(w, p, theta - test_distance);
    if (!ct_partition_dependence(w->s, w->x, &far))
        return;
    pivot_on(w, p, theta - test_distance / 2);
    if (!ct_partition_dependence(w->s, w->x, &near))
        return;
    at->rank_loss = (int)fmin(n, fmax(1, round((near - far) / log(0.5))));
    mark_rows(w, at->row);
}

// The fraction of the step at which J loses rank: usually in the middle, as predicted. NaN if there
// is none.
static double find_singular_configuration(struct ct_rank_monitor *w, const struct passage *p)
{
    // the pivot falls linearly from the beginning of the crossing: its zero is resolved to this
    const double zero = resolved * pivot_on(w, p, 0), theta = find_zero_in_middle(w, p, zero);
    return isnan(theta) ? find_smallest_pivot(w, p, zero) : theta;
}

bool ct_rank_monitor_record(struct ct_rank_monitor *w, const struct ct_stepper_span *span,
                            double begin, double t1)
{
    const struct passage p = {.span = span, .begin = begin, .pending = *w->pending};
    const double theta = find_singular_configuration(w, &p);
    w->pole = time_on(&p, theta);
    if (!(w->pole <= t1))
        return false;
    if (w->npassed++ >= CT_MOST_SINGULAR)
        return true;
    struct ct_singular_configuration *at = &w->passed[w->npassed - 1];
    at->t = fmax(w->pole, 0); // a run that starts at one begins before it
    find_dependence(w, &p, theta, at);
    return true;
}

bool ct_rank_monitor_is_crossed(struct ct_rank_monitor *w, const struct ct_rank_test *to,
                                double before, double behind)
{
    const struct passage p = {.to = to};
    const double part = find_smallest_pivot(w, &p, CT_SINGULAR_PIVOT * fmin(before, behind));
    return part > 0 && part < 1;
}

// Does the motion with the speeds at y reach a singular configuration within s seconds? The
// evaluator has a state near it afterwards.
static bool is_singular_within(struct ct_rank_monitor *w, double t, const double *y, double s)
{
    const struct ct_rank_test to = {.t = t + s, .pending = INFINITY, .y = y};
    w->t = t;
    memcpy(w->last, y, (w->m->nq + w->m->nu) * sizeof *y);
    return ct_rank_monitor_is_crossed(w, &to, pivot_to(w, &to, 0), pivot_to(w, &to, 1));
}

bool ct_rank_monitor_is_near_singular(struct ct_rank_monitor *w, double t, const double *y,
                                      double step, bool *row)
{
    // Derived: a hundredth; round-off grows by 1e4 there
    const double near_singular_ratio = 1e-2; // of the largest pivot
    double log_det;
    memset(row, 0, w->m->nrow * sizeof *row);
    if (w->s->rank < w->rank) // y is singular
        return true;
    if (!ct_partition_has_pivot(w->s))
        return false;
    if (!(ct_rank_monitor_pivot(w, t, y) < near_singular_ratio * w->largest_pivot)
        && !(step > 0 && is_singular_within(w, t, y, step)))
        return false;
    if (ct_partition_dependence(w->s, w->x, &log_det))
        mark_rows(w, row);
    return true;
}
