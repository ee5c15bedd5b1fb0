// The classical Runge-Kutta method of order 4.
//
// With a fixed step it is what textbooks show: four evaluations a step. Under error control a step
// is taken as two halves, and a fifteenth of their difference to the whole step is the error of
// the halves (Richardson); it is not added to the result, so that the order stays 4. The
// interpolant is the cubic Hermite polynomial, of each half where there are halves.
// Source: Kutta (1901); Hairer, Norsett and Wanner (1993), II.1 and II.4, key hairer1993.
#include "integrate/stepper.h"

enum { STAGES = 4 }; // Definition: of the method.

static const double C[STAGES] = {0, 1. / 2, 1. / 2, 1};
static const double B[STAGES] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};

struct work {
    struct ct_compensation carry;                // of fixed steps
    double *k;                                   // (ny x 4)
    double *point, *dy, *dy1, *middle, *dmiddle; // (ny) each
    bool has_half_steps;
};

static void *create(struct ct_arena *a, const struct ct_method *method,
                    const struct ct_problem *p)
{
    (void)method;
    const size_t n = (size_t)p->ny;
    struct work *w = CT_NEW(a, struct work);
    *w = (struct work){.carry = ct_compensation_create(a, p->ny),
                       .k = CT_NEWN(a, double, STAGES *n),
                       .point = CT_NEWN(a, double, n),
                       .dy = CT_NEWN(a, double, n),
                       .dy1 = CT_NEWN(a, double, n),
                       .middle = CT_NEWN(a, double, n),
                       .dmiddle = CT_NEWN(a, double, n)};
    return w;
}

// point (n, out) = y + c h k. The stage k has just been stored number by number. A vector load
// would wait for these stores, so few numbers are read one at a time (volatile).
static inline void stage_point(double *restrict point, const double *y, double h, double c,
                               const double *k, int n)
{
    enum { FEW = 16 }; // Limit: of time; both ways give the same numbers
    const volatile double *one = k;
    if (n > FEW)
        ct_stepper_combine(point, y, h, &c, k, 1, n);
    for (int i = 0; i < n && n <= FEW; i++)
        point[i] = y[i] + h * (c * one[i]);
}

// w->k by one step of length h from (t, y) with derivative dy.
static enum ct_eval stages(const struct ct_problem *p, double t, double h, const double *y,
                           const double *dy, const struct work *w,
                           struct ct_integrate_stats *stats)
{
    const int n = p->ny;
    ct_stepper_copy(w->k, dy, n);
    for (int s = 1; s < STAGES; s++) {
        double *k = w->k + s * n;
        stage_point(w->point, y, h, C[s], k - n, n);
        const enum ct_eval e = ct_stepper_rhs(p, t + C[s] * h, w->point, k, stats);
        if (e != CT_EVAL_OK)
            return e;
    }
    return CT_EVAL_OK;
}

// y1 (out): its end.
static enum ct_eval advance(const struct ct_problem *p, double t, double h, const double *y,
                            const double *dy, double *y1, const struct work *w,
                            struct ct_integrate_stats *stats)
{
    const enum ct_eval e = stages(p, t, h, y, dy, w, stats);
    if (e == CT_EVAL_OK)
        ct_stepper_combine(y1, y, h, B, w->k, STAGES, p->ny);
    return e;
}

// Two steps of h / 2 to y1; *err from the whole step.
static enum ct_eval advance_with_estimate(const struct ct_problem *p, double t, double h,
                                          const double *y, const struct ct_tolerance *tolerance,
                                          double *y1, double *err, const struct work *w,
                                          struct ct_integrate_stats *stats)
{
    double *whole = w->dy1; // free until the end of the step
    enum ct_eval e = advance(p, t, h, y, w->dy, whole, w, stats);
    if (e == CT_EVAL_OK)
        e = advance(p, t, h / 2, y, w->dy, w->middle, w, stats);
    if (e == CT_EVAL_OK)
        e = ct_stepper_rhs(p, t + h / 2, w->middle, w->dmiddle, stats);
    if (e == CT_EVAL_OK)
        e = advance(p, t + h / 2, h / 2, w->middle, w->dmiddle, y1, w, stats);
    if (e != CT_EVAL_OK)
        return e;
    for (int i = 0; i < p->ny; i++)
        w->point[i] = (y1[i] - whole[i]) / 15; // 2^4 - 1
    *err = ct_stepper_error(p, tolerance, t + h, y, y1, w->point);
    return CT_EVAL_OK;
}

static enum ct_eval step(const struct ct_problem *p, double t, double h, const double *y,
                         const double *dy, const struct ct_tolerance *tolerance, double *y1,
                         double *dy1, double *err, void *work, struct ct_integrate_stats *stats)
{
    struct work *w = work;
    ct_stepper_copy(w->dy, dy, p->ny);
    w->has_half_steps = tolerance != NULL;
    enum ct_eval e = tolerance ? advance_with_estimate(p, t, h, y, tolerance, y1, err, w, stats)
                               : stages(p, t, h, y, dy, w, stats);
    if (e == CT_EVAL_OK && !tolerance)
        ct_stepper_advance(y1, y, h, B, w->k, STAGES, &w->carry);
    if (e == CT_EVAL_OK)
        e = ct_stepper_rhs(p, t + h, y1, dy1, stats);
    if (e == CT_EVAL_OK)
        ct_stepper_copy(w->dy1, dy1, p->ny);
    return e;
}

static void dense(const struct ct_problem *p, double h, double theta, const double *y,
                  const double *y1, void *work, double *out)
{
    const struct work *w = work;
    if (!w->has_half_steps)
        ct_stepper_hermite(out, theta, h, y, w->dy, y1, w->dy1, p->ny);
    else if (theta < 0.5)
        ct_stepper_hermite(out, 2 * theta, h / 2, y, w->dy, w->middle, w->dmiddle, p->ny);
    else
        ct_stepper_hermite(out, 2 * theta - 1, h / 2, w->middle, w->dmiddle, y1, w->dy1, p->ny);
}

const struct ct_method ct_method_rk4 = {
    .name = "rk4",
    .summary = "classical Runge-Kutta of order 4, explicit, meant for fixed steps",
    .source = "hairer1993",
    .order = 4,
    .error_order = 4,
    .create = create,
    .restart = ct_compensation_restart,
    .accept = ct_compensation_accept,
    .step = step,
    .dense = dense,
};
