// See crossing.h. The 2 m stages lie on the two intervals on both sides of the gap. They are zeros
// of a Chebyshev polynomial and the ends of the step, mapped to these intervals:
//
//     c = (1 -+ sqrt(s)) / 2,   s_j = g^2 + (1 - g^2) (1 + cos(2 pi j / (2 m - 1))) / 2,   j = 0 ... m - 1
// with g the gap as part of the step. In s these nodes nearly minimise the node polynomial, and s =
// x^2 maps the two intervals to one.
//
// f is not stiff, so stages are found by fixed-point iteration in Gauss-Seidel order, y_j = y + h
// sum_i A_ji f(y_i) with the newest values. Starting values are extrapolated from stage to stage.
// The error estimate is the change without two of the inner stages, which is larger than the error.
//
// Source: collocation as in Hairer, Norsett and Wanner (1993), II.7, key hairer1993; the nodes are
// those of least Chebyshev norm on two symmetric intervals.
#include "integrate/crossing.h"

#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Definition: stages, those before the gap, points of Gauss-Legendre quadrature.
enum { STAGES = CT_CROSSING_STAGES, SIDE = STAGES / 2, QUADRATURE = 8 };
// Derived: without these sweeps a crossing takes more sweeps over all stages; three linkages took
// up to 36 per cent more evaluations in a run.
enum { LEFT_SWEEPS = 2 };

// Part of the step, about its middle, in which f is not evaluated.
// Default: with a narrower gap f has less digits, with a wider one the polynomial. Test: crossing.
static const double gap = 0.3;

// The iteration ends when stages change by less than this part of the tolerance, and of the
// mismatch limit below, so that it spoils neither. Derived: kappa of Hairer and Wanner (1996),
// IV.8, key hairer1996.
static const double kappa = 0.1;
// The size of changes that may be round-off, in tolerances; mostly of dependent coordinates.
// Default: with less, iterations next to round-off fail. Test: singular_switching.
static const double roundoff = 10;
const double ct_crossing_mismatch_limit = 1e-9;
// Default: with less, crossings fail for round-off. Test: singular_approach.
const double ct_crossing_roundoff = 5e-13;
// With a residual of the constraints in the middle above the mismatch limit and so many tolerances,
// no shorter crossing is tried. Default: trials in vain against crossings given up too early. Test:
// crossing.
static const double most_residual = 100;

struct work {
    double c[STAGES], norm[STAGES]; // norms of find_norms, of all stages
    double A[STAGES][STAGES];       // integrals of the Lagrange polynomials from 0 to c_j
    double left[SIDE][STAGES];      // the same for the polynomial through the left side alone
    double first[STAGES][STAGES];   // the same through all stages before j
    double from[STAGES][STAGES];    // A for a step that begins within the crossing
    // weights of the error: without two inner stages, less the last row of A
    double e[STAGES];
    double rest[STAGES];              // the same for `from`
    double t[STAGES], weight[STAGES]; // for ct_crossing_interpolation
    double *k, *stage;                // (ny x STAGES) each
    double *point, *end;              // (ny) each
    bool has_weights;                 // computed at the first crossing
    double begin;                     // start of the step, as part of the whole crossing
};

// --- weights ---------------------------------------------------------------------------------

// p (STAGES, out): for each j the product of (x - c_i) over the stages of `set` but j, from those
// before j and those behind it.
static void products(double *p, const double *c, const bool *set, double x)
{
    double before = 1, behind = 1;
    for (int j = 0; j < STAGES; j++) {
        p[j] = before;
        before *= set[j] ? x - c[j] : 1;
    }
    for (int j = STAGES - 1; j >= 0; j--) {
        p[j] *= behind;
        behind *= set[j] ? x - c[j] : 1;
    }
}

// norm (STAGES, out): at each c_j of `set` the product over the others.
static void find_norms(double *norm, const double *c, const bool *set)
{
    for (int j = 0; j < STAGES; j++) {
        norm[j] = 1;
        for (int i = 0; i < STAGES; i++)
            norm[j] *= set[i] && i != j ? c[j] - c[i] : 1;
    }
}

// w (STAGES, out): integral of the Lagrange polynomials on the stages of `set`, which has these
// norms, from 0 to x; others get 0.
static void integrate_lagrange(double *w, const double *c, const bool *set, const double *norm,
                               double x)
{
    // Gauss-Legendre, exact for the degree 2 * 8 - 1 > STAGES - 1
    static const double node[QUADRATURE / 2] = {0.1834346424956498049, 0.5255324099163289858,
                                                0.7966664774136267396, 0.9602898564975362317};
    static const double weight[QUADRATURE / 2] = {0.3626837833783619830, 0.3137066458778872873,
                                                  0.2223810344533744705, 0.1012285362903762591};
    double above[STAGES], below[STAGES];
    memset(w, 0, STAGES * sizeof *w);
    for (int q = 0; q < QUADRATURE / 2; q++) {
        products(above, c, set, x / 2 * (1 + node[q]));
        products(below, c, set, x / 2 * (1 - node[q]));
        for (int j = 0; j < STAGES; j++)
            w[j] += weight[q] * (above[j] + below[j]);
    }
    for (int j = 0; j < STAGES; j++)
        w[j] = set[j] ? x / 2 * w[j] / norm[j] : 0;
}

static void set_stages(double *c)
{
    const double pi = acos(-1);
    for (int j = 0; j < SIDE; j++) {
        const double s
            = gap * gap + (1 - gap * gap) * (1 + cos(2 * pi * j / (2 * SIDE - 1))) / 2;
        c[j] = 0.5 - sqrt(s) / 2;
        c[STAGES - 1 - j] = 0.5 + sqrt(s) / 2;
    }
    c[0] = 0;
    c[STAGES - 1] = 1;
}

// All stages but two inner ones.
static void leave_out(bool *some)
{
    for (int j = 0; j < STAGES; j++)
        some[j] = j != 2 && j != STAGES - 3;
}

static void find_weights(struct work *w)
{
    set_stages(w->c);
    bool all[STAGES], left[STAGES], before[STAGES] = {0}, some[STAGES];
    double norm[STAGES];
    for (int j = 0; j < STAGES; j++) {
        all[j] = true;
        left[j] = j < SIDE;
    }
    find_norms(w->norm, w->c, all);
    find_norms(norm, w->c, left);
    for (int j = 0; j < SIDE; j++)
        integrate_lagrange(w->left[j], w->c, left, norm, w->c[j]);
    for (int j = 0; j < STAGES; j++)
        integrate_lagrange(w->A[j], w->c, all, w->norm, w->c[j]);
    for (int j = 0; j < STAGES; j++) {
        find_norms(norm, w->c, before);
        integrate_lagrange(w->first[j], w->c, before, norm, w->c[j]);
        before[j] = true;
    }
    leave_out(some);
    find_norms(norm, w->c, some);
    integrate_lagrange(w->e, w->c, some, norm, 1);
    for (int j = 0; j < STAGES; j++)
        w->e[j] -= w->A[STAGES - 1][j];
    w->has_weights = true;
}

static void *create(struct ct_arena *a, const struct ct_method *method,
                    const struct ct_problem *p)
{
    (void)method;
    struct work *w = CT_NEW(a, struct work);
    const size_t n = (size_t)p->ny;
    *w = (struct work){.k = CT_NEWN(a, double, n *STAGES),
                       .stage = CT_NEWN(a, double, n *STAGES),
                       .point = CT_NEWN(a, double, n),
                       .end = CT_NEWN(a, double, n)};
    return w;
}

// --- the step --------------------------------------------------------------------------------

struct task {
    const struct ct_problem *p;
    double t, h;
    const double *y;
    const struct ct_tolerance *tolerance;
    struct work *w;
    struct ct_integrate_stats *stats;
};

// f at stage j, projected onto the constraints, since near the singular configuration their
// residual would be divided by a small pivot. The stage of the polynomial is not changed.
static enum ct_eval evaluate(const struct task *s, int j)
{
    struct work *w = s->w;
    const double t = s->t + w->c[j] * s->h;
    if (s->p->project) {
        const enum ct_eval e = s->p->project(s->p->user, t, w->point);
        if (e != CT_EVAL_OK)
            return e;
    }
    return ct_stepper_rhs(s->p, t, w->point, w->k + j * s->p->ny, s->stats);
}

// Updates stage j with weights a; *moved becomes the norm of its change, if that is larger.
static enum ct_eval update_stage(const struct task *s, int j, const double *a, double *change)
{
    struct work *w = s->w;
    const int n = s->p->ny;
    double *stage = w->stage + j * n;
    ct_stepper_combine(w->point, s->y, s->h, a, w->k, STAGES, n);
    if (!ct_stepper_finite(w->point, n))
        return CT_EVAL_RETRY;
    for (int i = 0; i < n; i++)
        stage[i] -= w->point[i];
    *change = fmax(*change, ct_stepper_norm(s->p, s->tolerance, s->y, w->point, stage));
    memcpy(stage, w->point, (size_t)n * sizeof *stage);
    return evaluate(s, j);
}

// Starting values: stages before the gap by extrapolation from stage to stage and some sweeps over
// these alone, which take less work than sweeps over all; then stages behind the gap by
// extrapolation.
static enum ct_eval find_starting_values(const struct task *s)
{
    struct work *w = s->w;
    double change = 0;
    enum ct_eval e = CT_EVAL_OK;
    for (int j = 1; j < SIDE && e == CT_EVAL_OK; j++)
        e = update_stage(s, j, w->first[j], &change);
    for (int i = 0; i < LEFT_SWEEPS; i++)
        for (int j = 1; j < SIDE && e == CT_EVAL_OK; j++)
            e = update_stage(s, j, w->left[j], &change);
    for (int j = SIDE; j < STAGES && e == CT_EVAL_OK; j++)
        e = update_stage(s, j, w->first[j], &change);
    return e;
}

// Fixed-point iteration for the stages from `first` on, with weights A. It also ends where a sweep
// does not halve the change: at round-off, or because the step is too long for convergence. The
// first two changes do not count, as they depend on the starting values.
static enum ct_eval iterate(const struct task *s, const double (*A)[STAGES], int first)
{
    const double fine = kappa * fmin(1, ct_crossing_mismatch_limit / s->tolerance->rtol);
    double before = INFINITY;
    for (int i = 0;; i++) {
        double change = 0;
        enum ct_eval e = CT_EVAL_OK;
        for (int j = first; j < STAGES && e == CT_EVAL_OK; j++)
            e = update_stage(s, j, A[j], &change);
        if (e != CT_EVAL_OK)
            return e;
        if (change <= fine)
            return CT_EVAL_OK;
        if (i > 1 && !(change <= before / 2))
            return change <= roundoff ? CT_EVAL_OK : CT_EVAL_RETRY;
        before = change;
    }
}

static double estimate(const struct task *s, const double *e, const double *y1)
{
    struct work *w = s->w;
    ct_stepper_combine(w->point, NULL, s->h, e, w->k, STAGES, s->p->ny);
    return ct_stepper_norm(s->p, s->tolerance, s->y, y1, w->point);
}

// a (STAGES, out): integrals of the Lagrange polynomials from 0 to c, a part of the whole.
static void integrate_to(const struct work *w, double c, double *a)
{
    bool all[STAGES];
    memset(all, true, sizeof all);
    integrate_lagrange(a, w->c, all, w->norm, c);
}

// out (ny) = the state at c, a part of the whole crossing h; y: the state at the start of the step.
static void point_at(const struct ct_problem *p, double h, double c, const double *y,
                     const struct work *w, double *out)
{
    double a[STAGES], before[STAGES];
    integrate_to(w, c, a);
    if (w->begin > 0) {
        integrate_to(w, w->begin, before);
        for (int j = 0; j < STAGES; j++)
            a[j] -= before[j];
    }
    ct_stepper_combine(out, y, h, a, w->k, STAGES, p->ny);
}

// At a singular configuration one combination of the constraints becomes dependent on the others.
// This is the largest residual of that combination for which the configuration counts as singular.
// A mechanism that passes it with a residual m has a smallest pivot near sqrt(m), and accelerations
// with a round-off error of eps/m. Where that exceeds the accuracy, steps cannot follow the motion.
static double allowed_mismatch(const struct ct_problem *p)
{
    // Default: with less, round-off of the constraints counts as a mismatch. Test: singular.
    const double met = 1e-12;
    return fmin(ct_crossing_mismatch_limit, fmax(met, DBL_EPSILON / p->accuracy));
}

// The error of a step where the dependent constraint has the residual `mismatch`. An error of the
// polynomial in the middle causes a residual of its square. Where this may explain the residual a
// shorter step is tried; otherwise the mechanism is only nearly singular.
static double error_with_residual(const struct task *s, double mismatch, double error)
{
    // the error in the middle over the error of the step, for constraints of curvature 1/m or 1/rad
    // Default: with less, crossings are given up too early. Test: singular.
    const double error_in_gap = 30;
    const double most = ct_vector_largest(s->y, (size_t)s->p->ny),
                 own = error_in_gap * error * (s->tolerance->rtol * most + s->tolerance->atol);
    const double part = mismatch / allowed_mismatch(s->p);
    if (part <= 1)
        return error;
    return mismatch > own * own ? INFINITY : fmax(error, sqrt(part));
}

// w->from and w->rest: weights of the stages and of the error for a step from `begin` on.
static void begin_at(struct work *w, double begin)
{
    double before[STAGES], norm[STAGES];
    bool some[STAGES];
    integrate_to(w, begin, before);
    for (int j = 0; j < STAGES; j++)
        for (int i = 0; i < STAGES; i++)
            w->from[j][i] = w->A[j][i] - before[i];
    leave_out(some);
    find_norms(norm, w->c, some);
    integrate_lagrange(w->rest, w->c, some, norm, begin);
    for (int j = 0; j < STAGES; j++)
        w->rest[j] = w->e[j] - (w->rest[j] - before[j]);
}

// All stages from a state at `begin` of the whole crossing. The iteration starts with the constant
// derivative dy.
static enum ct_eval stages_from(const struct task *s, double begin, const double *dy)
{
    struct work *w = s->w;
    const int n = s->p->ny;
    begin_at(w, begin);
    for (int j = 0; j < STAGES; j++) {
        memcpy(w->k + j * n, dy, (size_t)n * sizeof *dy);
        memcpy(w->stage + j * n, s->y, (size_t)n * sizeof *dy);
    }
    return iterate(s, (const double(*)[STAGES])w->from, 0);
}

// All stages from the state at the start of the crossing.
static enum ct_eval stages_on(const struct task *s, const double *dy)
{
    struct work *w = s->w;
    const int n = s->p->ny;
    const size_t bytes = (size_t)n * sizeof *dy;
    memset(w->k, 0, STAGES * bytes);
    memcpy(w->k, dy, bytes);
    for (int j = 0; j < STAGES; j++)
        memcpy(w->stage + j * n, s->y, bytes);
    const enum ct_eval e = find_starting_values(s);
    return e == CT_EVAL_OK ? iterate(s, (const double(*)[STAGES])w->A, 1) : e;
}

// The error estimate of the step that ends at y1.
static double error_of(const struct task *s, const double *y1)
{
    struct work *w = s->w;
    const struct ct_problem *p = s->p;
    const double middle = s->t + s->h / 2;
    point_at(p, s->h, 0.5, s->y, w, w->end);
    double mismatch;
    const double left = p->singular->residual(p->singular->user, middle, w->end, &mismatch);
    if (left > ct_crossing_mismatch_limit + most_residual * s->tolerance->rtol)
        return INFINITY;
    return fmax(
        error_with_residual(s, mismatch, estimate(s, w->begin > 0 ? w->rest : w->e, y1)),
        left / ct_crossing_mismatch_limit);
}

static enum ct_eval step(const struct ct_problem *p, double t, double h, const double *y,
                         const double *dy, const struct ct_tolerance *tolerance, double *y1,
                         double *dy1, double *err, void *work, struct ct_integrate_stats *stats)
{
    struct work *w = work;
    const int n = p->ny;
    const double whole = h / (1 - w->begin);
    const struct task s = {p, t - w->begin * whole, whole, y, tolerance, w, stats};
    if (!w->has_weights)
        find_weights(w);
    p->singular->set_crossing(p->singular->user, true);
    const enum ct_eval e = w->begin > 0 ? stages_from(&s, w->begin, dy) : stages_on(&s, dy);
    p->singular->set_crossing(p->singular->user, false);
    if (e != CT_EVAL_OK)
        return e;
    memcpy(y1, w->stage + (STAGES - 1) * n, (size_t)n * sizeof *y1);
    memcpy(dy1, w->k + (STAGES - 1) * n, (size_t)n * sizeof *dy1);
    *err = error_of(&s, y1);
    return CT_EVAL_OK;
}

enum ct_eval ct_crossing_initial_step(const struct ct_problem *p, double t, double h,
                                      double theta, const double *y, const double *dy,
                                      const struct ct_tolerance *tolerance, double *before,
                                      double *err, void *work, struct ct_integrate_stats *stats)
{
    struct work *w = work;
    const struct task s = {p, t - theta * h, h, y, tolerance, w, stats};
    if (!w->has_weights)
        find_weights(w);
    p->singular->set_crossing(p->singular->user, true);
    const enum ct_eval e = stages_from(&s, theta, dy);
    p->singular->set_crossing(p->singular->user, false);
    if (e != CT_EVAL_OK)
        return e;
    memcpy(before, w->stage, (size_t)p->ny * sizeof *y);
    *err = estimate(&s, w->e, before);
    return CT_EVAL_OK;
}

void ct_crossing_begin(void *work, double begin)
{
    struct work *w = work;
    w->begin = begin;
}

// Converts a part of the step to a part of the whole crossing.
static double part_of_whole(const struct work *w, double theta)
{
    return w->begin + theta * (1 - w->begin);
}

static void dense(const struct ct_problem *p, double h, double theta, const double *y,
                  const double *y1, void *work, double *out)
{
    struct work *w = work;
    (void)y1;
    point_at(p, h / (1 - w->begin), part_of_whole(w, theta), y, w, out);
}

bool ct_crossing_is_gap(const void *work, double theta)
{
    return fabs(part_of_whole(work, theta) - 0.5) < gap / 2;
}

// w->weight: interpolation weights of the stages at c, a part of the whole crossing.
static void weigh(struct work *w, double c)
{
    bool all[STAGES];
    memset(all, true, sizeof all);
    products(w->weight, w->c, all, c);
    for (int j = 0; j < STAGES; j++)
        w->weight[j] /= w->norm[j];
}

void ct_crossing_slope(void *work, int n, double theta, double *dy)
{
    struct work *w = work;
    weigh(w, part_of_whole(w, theta));
    ct_stepper_combine(dy, NULL, 1, w->weight, w->k, STAGES, n);
}

struct ct_gap_interpolation ct_crossing_interpolation(void *work, double t, double h,
                                                      double theta)
{
    struct work *w = work;
    const double whole = h / (1 - w->begin);
    weigh(w, part_of_whole(w, theta));
    for (int j = 0; j < STAGES; j++)
        w->t[j] = t + (w->c[j] - w->begin) * whole;
    return (struct ct_gap_interpolation){STAGES, w->t, w->weight, w->stage};
}

const struct ct_method ct_crossing = {
    .name = "crossing",
    .summary = "across a singular configuration",
    .source = "hairer1993",
    .order = STAGES,
    .error_order = STAGES - 3,
    .create = create,
    .step = step,
    .dense = dense,
};
