// See take.h.
#include "integrate/take.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Definition: Chebyshev interpolation of this degree.
enum { DEGREE = 8, NODES = DEGREE + 1 };
// Nodes that are evaluated first, those of degree 4.
// Default: evaluations against what is missed between nodes. Test: take.
enum { COARSE = 5 };
// Halvings of a step. Derived: as many as lead from 1 to the unit round-off.
enum { LEVELS = DBL_MANT_DIG };
// Intervals in a step. A kink takes one for each halving; a noisy function would take any number.
// Default: evaluations against the accuracy at several kinks in a step. Test: take.
enum { MOST_INTERVALS = 400 };
// Points cos(pi i/32) at which zeros and extrema of an interpolant are first looked for.
// Derived: four points between neighbouring extrema of the Chebyshev polynomial T8.
enum { GRID = 32 };

// The error of interpolants, as part of the tolerance of outputs.
// Default: evaluations against accuracy. Test: take.
static const double share = 0.1;

// Round-off of an interpolant, as part of the largest value.
// Derived: coefficients and values are sums of nine terms each, 18 eps; functions may err as much.
static const double roundoff = 64 * DBL_EPSILON;

// The order in which nodes are evaluated: those of degree 4 first.
static const int order[NODES] = {0, 2, 4, 6, 8, 1, 3, 5, 7};

// cos(pi k / 8)
static const double cosine[DEGREE + 1]
    = {1, 0.92387953251128675613,  0.70710678118654752440,  0.38268343236508977173,
       0, -0.38268343236508977173, -0.70710678118654752440, -0.92387953251128675613,
       -1};

struct state {
    double largest;  // |f| so far
    double value;    // the extreme; the integral; the time
    bool is_started; // there is an extreme
    bool is_below;   // f was negative last
    bool is_over;    // the time is found
};

struct ct_take_scan {
    const enum ct_take_kind *kind;
    size_t n;
    double rtol, atol;
    double length; // of the steps so far
    double h;      // of the step
    struct state *state;
    struct interval {
        double a, b;
        bool *is_open; // (n) functions whose result does not include it yet
    } interval[LEVELS];
    int depth;             // intervals that wait, the last one is next; 0: the step is done
    int asked;             // nodes given of it
    int nlooked;           // intervals of the step
    double *f;             // (NODES x n)
    double grid[GRID + 1]; // from -1 to 1, denser at the ends
};

struct ct_take_scan *ct_take_scan_create(struct ct_arena *a, const enum ct_take_kind *kind,
                                         size_t n)
{
    struct ct_take_scan *s = CT_NEW(a, struct ct_take_scan);
    *s = (struct ct_take_scan){.kind = kind, .n = n};
    s->state = CT_NEWN(a, struct state, n + 1);
    s->f = CT_NEWN(a, double, NODES *n + 1);
    for (int i = 0; i <= GRID; i++)
        s->grid[i] = -cos(acos(-1) * i / GRID);
    for (int i = 0; i < LEVELS; i++)
        s->interval[i].is_open = CT_NEWN(a, bool, n + 1);
    return s;
}

void ct_take_scan_begin(struct ct_take_scan *s, double rtol, double atol)
{
    s->rtol = share * rtol;
    s->atol = share * atol;
    s->length = 0;
    s->depth = 0;
    memset(s->state, 0, s->n * sizeof *s->state);
}

void ct_take_scan_step(struct ct_take_scan *s, double t0, double t1)
{
    bool any = false;
    s->length += t1 - t0;
    s->h = t1 - t0;
    s->interval[0].a = t0;
    s->interval[0].b = t1;
    for (size_t k = 0; k < s->n; k++)
        any |= s->interval[0].is_open[k] = s->kind[k] != CT_TAKE_FINAL && !s->state[k].is_over;
    s->depth = any;
    s->asked = 0;
    s->nlooked = 0;
}

// Node i of an interval, from -1 to 1.
static double node(int i)
{
    return -cosine[i];
}

static double time_at(const struct interval *v, double x)
{
    return x <= -1 ? v->a : x >= 1 ? v->b : v->a + (v->b - v->a) * ((1 + x) / 2);
}

bool ct_take_scan_wants(const struct ct_take_scan *s, double *t)
{
    if (!s->depth)
        return false;
    *t = time_at(&s->interval[s->depth - 1], node(order[s->asked]));
    return true;
}

// ---- interpolants -------------------------------------------------------------------------------

// c (NODES, out): coefficients of the Chebyshev polynomials that have the values f (NODES) in the
// nodes.
static void expand(double *c, const double *f)
{
    for (int k = 0; k < NODES; k++) {
        double sum = 0;
        for (int i = 0; i < NODES; i++) {
            const int turn = k * (DEGREE - i) % (2 * DEGREE); // in pi / 8
            const double part = (i == 0 || i == DEGREE ? 0.5 : 1) * f[i];
            sum += part * cosine[turn > DEGREE ? 2 * DEGREE - turn : turn];
        }
        c[k] = sum * (k == 0 || k == DEGREE ? 1. : 2.) / DEGREE;
    }
}

static double value_at(const double *c, double x)
{
    double b1 = 0, b2 = 0;
    for (int k = DEGREE; k > 0; k--) { // Clenshaw
        const double b = c[k] + 2 * x * b1 - b2;
        b2 = b1;
        b1 = b;
    }
    return c[0] + x * b1 - b2;
}

// Integral from -1 to 1.
static double integral(const double *c)
{
    double sum = 0;
    for (int k = 0; k < NODES; k += 2)
        sum += 2 * c[k] / (1 - k * k);
    return sum;
}

// Estimated error of the interpolant: coefficients of smooth functions decrease, so those left out
// are smaller than the last two.
static double error_of(const double *c)
{
    return fabs(c[DEGREE - 1]) + fabs(c[DEGREE]);
}

// The largest value of sign * p, by golden section search about the largest value on the grid, if
// it may reach `record`.
static double largest(const struct ct_take_scan *s, const double *c, double sign, double record)
{
    const double golden = 0.61803398874989484820; // Definition: (sqrt(5) - 1)/2
    const double narrow = 0x1p-26; // Derived: an extreme is flat to round-off within its root
    double value[GRID + 1];
    int best = 0;
    for (int i = 0; i <= GRID; i++) {
        value[i] = sign * value_at(c, s->grid[i]);
        best = value[i] > value[best] ? i : best;
    }
    const int before = best ? best - 1 : 0, behind = best < GRID ? best + 1 : GRID;
    double most = value[best];
    if (2 * most - fmin(value[before], value[behind]) < record)
        return most;
    double a = s->grid[before], b = s->grid[behind];
    while (b - a > narrow) {
        const double left = b - golden * (b - a), right = a + golden * (b - a);
        const double at_left = sign * value_at(c, left), at_right = sign * value_at(c, right);
        most = fmax(most, fmax(at_left, at_right));
        if (at_left > at_right)
            b = right;
        else
            a = left;
    }
    return most;
}

// The zero of p between a, where it is negative, and b, where it is not, by bisection.
static double zero_between(const double *c, double a, double b)
{
    for (;;) {
        const double middle = (a + b) / 2;
        if (!(middle > a && middle < b))
            return b;
        *(value_at(c, middle) < 0 ? &a : &b) = middle;
    }
}

// ---- what is taken ------------------------------------------------------------------------------

static void take_extreme(const struct ct_take_scan *s, struct state *q, const double *c,
                         double sign)
{
    const double record = q->is_started ? sign * q->value : -INFINITY;
    q->value = sign * fmax(record, largest(s, c, sign, record));
    q->is_started = true;
}

static void take_zero(const struct ct_take_scan *s, struct state *q, const struct interval *v,
                      const double *c)
{
    const double unseen = roundoff * q->largest;
    for (int i = 0; i <= GRID; i++) {
        const double p = value_at(c, s->grid[i]);
        if (q->is_below && p >= 0) {
            q->value = time_at(v, i ? zero_between(c, s->grid[i - 1], s->grid[i]) : -1);
            q->is_over = true;
            return;
        }
        if (p < -unseen || p >= 0) // at a start on zero the sign of round-off does not count
            q->is_below = p < 0;
    }
}

// Adds the interval to the result of function k, from its interpolant c (NODES).
static void take(struct ct_take_scan *s, size_t k, const struct interval *v, const double *c)
{
    struct state *q = &s->state[k];
    const double half = (v->b - v->a) / 2;
    switch (s->kind[k]) {
    case CT_TAKE_MAX:
        take_extreme(s, q, c, 1);
        break;
    case CT_TAKE_MIN:
        take_extreme(s, q, c, -1);
        break;
    case CT_TAKE_MEAN:
    case CT_TAKE_RMS:
        q->value += half * integral(c);
        break;
    case CT_TAKE_TIME:
        take_zero(s, q, v, c);
        break;
    default:
        break;
    }
}

// Least and largest of the nodes 0, `step`, 2 step ...
static void bounds(const double *f, int step, double *least, double *most)
{
    *least = *most = f[0];
    for (int i = step; i < NODES; i += step) {
        *least = fmin(*least, f[i]);
        *most = fmax(*most, f[i]);
    }
}

// Can the interval not change the result of function k? A function that is resolved leaves the
// range of its values at the nodes by no more than the length of that range.
static bool is_idle(const struct ct_take_scan *s, size_t k, const double *f, int step)
{
    const struct state *q = &s->state[k];
    double least, most;
    if (q->is_over)
        return true;
    bounds(f, step, &least, &most);
    const double spread = most - least;
    switch (s->kind[k]) {
    case CT_TAKE_MAX:
        return q->is_started && most + spread < q->value;
    case CT_TAKE_MIN:
        return q->is_started && least - spread > q->value;
    case CT_TAKE_TIME:
        return q->is_below ? most + spread < 0 : least - spread > 0;
    default:
        return false;
    }
}

// Is the interpolant accurate enough? Errors of integrals count in proportion to the interval.
static bool is_resolved(const struct ct_take_scan *s, size_t k, const struct interval *v,
                        const double *f, const double *c)
{
    double least, most;
    const double size = s->state[k].largest, part = s->h > 0 ? (v->b - v->a) / s->h : 1;
    const double allowed = fmax(s->rtol, roundoff) * size + s->atol;
    const double error = error_of(c);
    switch (s->kind[k]) {
    case CT_TAKE_MEAN:
        return error * part <= allowed;
    case CT_TAKE_RMS:
        return error * part <= allowed * size;
    case CT_TAKE_TIME: // any error will do where the sign is certain
        bounds(f, 1, &least, &most);
        return error <= allowed || least - error > 0 || most + error < 0;
    default:
        return error <= allowed;
    }
}

// f (NODES, out): the values of function k to interpolate, squared for rms.
static const double *values_of(const struct ct_take_scan *s, size_t k, double *f)
{
    for (int i = 0; i < NODES; i++) {
        const double v = s->f[(size_t)i * s->n + k];
        f[i] = s->kind[k] == CT_TAKE_RMS ? v * v : v;
    }
    return f;
}

// After the first nodes: drops functions whose result cannot change. True if any are left.
static bool look_coarsely(struct ct_take_scan *s, struct interval *v)
{
    bool any = false;
    double f[NODES];
    for (size_t k = 0; k < s->n; k++) {
        if (v->is_open[k] && is_idle(s, k, values_of(s, k, f), 2))
            v->is_open[k] = false;
        any |= v->is_open[k];
    }
    return any;
}

// Halves the interval; the second half waits. False if it is as short as the round-off of time, or
// at the limit of intervals.
static bool halve(struct ct_take_scan *s, struct interval *v)
{
    const double middle = v->a + (v->b - v->a) / 2;
    const double resolution = 4 * DBL_EPSILON * fmax(fabs(v->a), fabs(v->b));
    if (s->depth == LEVELS || s->nlooked >= MOST_INTERVALS || v->b - v->a <= resolution)
        return false;
    struct interval *first = v + 1;
    first->a = v->a;
    first->b = v->a = middle;
    memcpy(first->is_open, v->is_open, s->n * sizeof *v->is_open);
    s->depth++;
    return true;
}

static void look(struct ct_take_scan *s, struct interval *v)
{
    double f[NODES], c[NODES];
    bool any = false;
    for (size_t k = 0; k < s->n; k++) {
        if (!v->is_open[k])
            continue;
        expand(c, values_of(s, k, f));
        v->is_open[k] = !is_idle(s, k, f, 1) && !is_resolved(s, k, v, f, c);
        if (!v->is_open[k] && !is_idle(s, k, f, 1))
            take(s, k, v, c);
        any |= v->is_open[k];
    }
    if (any && halve(s, v))
        return;
    for (size_t k = 0; k < s->n && any; k++)
        if (v->is_open[k]) {
            expand(c, values_of(s, k, f));
            take(s, k, v, c);
        }
    s->depth--;
}

void ct_take_scan_give(struct ct_take_scan *s, const double *f)
{
    struct interval *v = &s->interval[s->depth - 1];
    memcpy(s->f + (size_t)order[s->asked] * s->n, f, s->n * sizeof *f);
    for (size_t k = 0; k < s->n; k++)
        s->state[k].largest = fmax(s->state[k].largest, fabs(f[k]));
    s->asked++;
    if (s->asked == COARSE && !look_coarsely(s, v)) {
        s->nlooked++;
        s->depth--;
        s->asked = 0;
    } else if (s->asked == NODES) {
        s->nlooked++;
        look(s, v);
        s->asked = 0;
    }
}

void ct_take_scan_results(const struct ct_take_scan *s, double *out)
{
    for (size_t k = 0; k < s->n; k++) {
        const struct state *q = &s->state[k];
        if (s->kind[k] == CT_TAKE_TIME)
            out[k] = q->is_over ? q->value : (double)NAN;
        else if (s->kind[k] == CT_TAKE_FINAL || !(s->length > 0))
            out[k] = s->kind[k] == CT_TAKE_RMS ? fabs(out[k]) : out[k];
        else if (s->kind[k] == CT_TAKE_MEAN)
            out[k] = q->value / s->length;
        else if (s->kind[k] == CT_TAKE_RMS)
            out[k] = sqrt(fmax(0, q->value / s->length));
        else
            out[k] = q->value;
    }
}
