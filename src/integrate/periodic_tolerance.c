// See periodic_tolerance.h.
#include "integrate/periodic_tolerance.h"

#include <math.h>

// Up to this number of periods the tolerance of steps is that of the run. Default: evaluations
// against accuracy over long runs. Test: periodic_tolerance
static const double unscaled_periods = 20;

// The smallest factor on the tolerance. Derived: that of a hundred times as many periods, as it
// falls with their square. With less, round-off would exceed the tolerance.
static const double least_factor = 1e-4;

struct ct_periodic_tolerance ct_periodic_tolerance_start(double t0, double t1,
                                                         const struct ct_tolerance *tolerance)
{
    const double least_size
        = tolerance->rtol > 0 ? tolerance->atol / tolerance->rtol : INFINITY;
    return (struct ct_periodic_tolerance){
        .t0 = t0, .t1 = t1, .least_size = least_size, .factor = 1};
}

// The number of periods so far. Derived: in a period a coordinate moves by twice its range, and a
// speed changes by four times its largest value. Before the first reversal there is no period.
static double periods_so_far(const struct ct_periodic_tolerance *r)
{
    const double span_q = fmax(sqrt(r->range_q), r->least_size),
                 span_u = fmax(sqrt(r->range_u), r->least_size);
    if (!(r->path_q > span_q && r->path_u > span_u))
        return 0;
    return fmin((r->path_q / span_q - 1) / 2, (r->path_u / span_u - 1) / 4);
}

bool ct_periodic_tolerance_add(struct ct_periodic_tolerance *r, double t, double dq, double q,
                               double du, double u)
{
    r->path_q += sqrt(dq);
    r->path_u += sqrt(du);
    r->range_q = q > r->range_q ? q : r->range_q;
    r->range_u = u > r->range_u ? u : r->range_u;
    const double before = r->factor;
    const double periods = periods_so_far(r) * (r->t1 - r->t0) / (t - r->t0);
    const double ratio = fmin(1, unscaled_periods / periods);
    r->factor = fmax(ratio * ratio, least_factor);
    return r->factor != before;
}

bool ct_periodic_tolerance_step(struct ct_periodic_tolerance *r, double t, const double *y0,
                                const double *y, const double *y1, int nq, int nu)
{
    double dq = 0, q = 0, du = 0, u = 0;
    for (int i = 0; i < nq; i++) {
        const double step = y1[i] - y[i], away = y1[i] - y0[i];
        dq += step * step;
        q += away * away;
    }
    for (int i = nq; i < nq + nu; i++) {
        const double step = y1[i] - y[i];
        du += step * step;
        u += y1[i] * y1[i];
    }
    return ct_periodic_tolerance_add(r, t, dq, q, du, u);
}

struct ct_tolerance ct_periodic_tolerance_find(const struct ct_periodic_tolerance *r,
                                               double rtol, double atol, double least)
{
    const double factor = fmin(fmax(r->factor, least / rtol), 1);
    return (struct ct_tolerance){factor * rtol, factor * atol};
}
