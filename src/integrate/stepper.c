// See stepper.h.
#include "integrate/stepper.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum ct_eval ct_stepper_rhs(const struct ct_problem *p, double t, const double *y, double *dy,
                            struct ct_integrate_stats *stats)
{
    stats->evaluations++;
    const enum ct_eval e = p->rhs(p->user, t, y, dy);
    return e == CT_EVAL_OK && !ct_stepper_finite(dy, p->ny) ? CT_EVAL_RETRY : e;
}

// Linear combinations of stages by SIMD. Four entries are summed at a time, in up to four vectors
// side by side, whose sums stay in registers for any number of stages. The last vector may overlap
// the one before, so that some entries are computed twice. Fewer than four entries have scalar
// code.
//
// The newest stage has just been stored number by number. A vector load would wait for these
// stores, so it is read number by number (volatile). Definition: doubles in a register of 256 bits.
enum { LANES = 4 };

static inline void by_ones(double *restrict out, const double *y, double h, const double *a,
                           const double *k, int s, const int n)
{
    const volatile double *stage = k;
    double first = 0, second = 0, third = 0; // no array: that would be kept in memory
    for (int j = 0; j < s; j++, stage += n) {
        if (a[j] == 0) // tables have many zeros
            continue;
        first += a[j] * stage[0];
        if (n > 1)
            second += a[j] * stage[1];
        if (n > 2)
            third += a[j] * stage[2];
    }
    out[0] = (y ? y[0] : 0) + h * first;
    if (n > 1)
        out[1] = (y ? y[1] : 0) + h * second;
    if (n > 2)
        out[2] = (y ? y[2] : 0) + h * third;
}

static void combine_few(double *restrict out, const double *y, double h, const double *a,
                        const double *k, int s, int n)
{
    if (n == 1)
        by_ones(out, y, h, a, k, s, 1);
    else if (n == 2)
        by_ones(out, y, h, a, k, s, 2);
    else if (n == 3)
        by_ones(out, y, h, a, k, s, 3);
}

#if defined(__GNUC__)

typedef double four
    __attribute__((vector_size(LANES * sizeof(double)), aligned(sizeof(double)), may_alias));

enum { MOST_FOURS = 4 }; // Limit: of registers; more entries take more passes

// sum += a (k_0 ... k_3), of the newest stage
__attribute__((always_inline)) static inline void add_newest(four *sum, double a,
                                                             const volatile double *k)
{
    *sum += a * (four){k[0], k[1], k[2], k[3]};
}

// Entries from i on, in `fours` vectors. Inlined with a constant `fours`, so that sums are
// registers.
__attribute__((always_inline)) static inline void some_fours(double *out, const double *y,
                                                             double h, const double *a,
                                                             const double *k, int s, int n,
                                                             int i, const int fours)
{
    const int last = i + LANES * (fours - 1) < n - LANES ? i + LANES * (fours - 1) : n - LANES;
    const double *stage = k + i, *behind = k + last;
    four sum[MOST_FOURS] = {{0}};
    for (int j = 0; j + 1 < s; j++, stage += n, behind += n)
        if (a[j] != 0) {
            for (int v = 0; v + 1 < fours; v++)
                sum[v] += a[j] * *(const four *)(stage + LANES * v);
            sum[fours - 1] += a[j] * *(const four *)behind;
        }
    for (int v = 0; v + 1 < fours; v++)
        add_newest(&sum[v], a[s - 1], stage + LANES * v);
    add_newest(&sum[fours - 1], a[s - 1], behind);
    for (int v = 0; v < fours; v++) {
        const int at = v + 1 < fours ? i + LANES * v : last;
        *(four *)(out + at) = y ? *(const four *)(y + at) + h * sum[v] : h * sum[v];
    }
}

__attribute__((always_inline)) static inline void
by_fours(double *out, const double *y, double h, const double *a, const double *k, int s, int n)
{
    int i = 0;
    for (; n - i > (MOST_FOURS - 1) * LANES; i += MOST_FOURS * LANES)
        some_fours(out, y, h, a, k, s, n, i, MOST_FOURS);
    if (n - i > 2 * LANES)
        some_fours(out, y, h, a, k, s, n, i, 3);
    else if (n - i > LANES)
        some_fours(out, y, h, a, k, s, n, i, 2);
    else if (n - i > 0)
        some_fours(out, y, h, a, k, s, n, n - LANES, 1);
}

static void combine_narrow(double *out, const double *y, double h, const double *a,
                           const double *k, int s, int n)
{
    by_fours(out, y, h, a, k, s, n);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static void combine_wide(double *out, const double *y, double h,
                                                         const double *a, const double *k,
                                                         int s, int n)
{
    by_fours(out, y, h, a, k, s, n);
}

static void combine_fours(double *out, const double *y, double h, const double *a,
                          const double *k, int s, int n)
{
    (__builtin_cpu_supports("avx2") ? combine_wide : combine_narrow)(out, y, h, a, k, s, n);
}
#else
#define combine_fours combine_narrow
#endif

#else

static void combine_fours(double *out, const double *y, double h, const double *a,
                          const double *k, int s, int n)
{
    for (int i = 0; i < n; i++) {
        double sum = 0;
        for (int j = 0; j < s; j++)
            sum += a[j] * k[i + j * n];
        out[i] = (y ? y[i] : 0) + h * sum;
    }
}

#endif

void ct_stepper_combine(double *restrict out, const double *y, double h, const double *a,
                        const double *k, int s, int n)
{
    (n < LANES ? combine_few : combine_fours)(out, y, h, a, k, s, n);
}

struct ct_compensation ct_compensation_create(struct ct_arena *a, int n)
{
    return (struct ct_compensation){CT_NEWN(a, double, n), CT_NEWN(a, double, n), n};
}

void ct_compensation_restart(void *work)
{
    const struct ct_compensation *c = work;
    memset(c->now, 0, (size_t)c->n * sizeof *c->now);
}

void ct_compensation_accept(void *work)
{
    struct ct_compensation *c = work;
    double *now = c->now;
    c->now = c->next;
    c->next = now;
}

void ct_stepper_advance(double *restrict out, const double *y, double h, const double *a,
                        const double *k, int s, struct ct_compensation *c)
{
    ct_stepper_combine(out, NULL, h, a, k, s, c->n);
    for (int i = 0; i < c->n; i++) {
        const double way = out[i] + c->now[i];
        out[i] = y[i] + way;
        c->next[i] = way - (out[i] - y[i]);
    }
}

void ct_stepper_group(const struct ct_groups *g, int ny, const double *y, const double *y1)
{
    if (!g)
        return;
    memset(g->size, 0, (size_t)g->n * sizeof *g->size);
    for (int i = 0; i < ny; i++) {
        const int k = g->of[i];
        if (k >= 0)
            g->size[k] = fmax(g->size[k], fmax(fabs(y[i]), fabs(y1[i])));
    }
}

// The scale of the error of state i: its own size or the largest of its group.
static double size_of(const struct ct_groups *g, int i, const double *y, const double *y1)
{
    return g && g->of[i] >= 0 ? g->size[g->of[i]] : ct_larger(fabs(y[i]), fabs(y1[i]));
}

double ct_stepper_norm(const struct ct_problem *p, const struct ct_tolerance *tolerance,
                       const double *y, const double *y1, const double *e)
{
    double sum = 0;
    int n = 0;
    ct_stepper_group(p->groups, p->ny, y, y1);
    for (int i = 0; i < p->ny; i++) {
        if (p->error_controlled && !p->error_controlled[i])
            continue;
        const double weight = tolerance->rtol * size_of(p->groups, i, y, y1) + tolerance->atol;
        const double part = e[i] / weight;
        sum += part * part;
        n++;
    }
    return n ? sqrt(sum / n) : 0;
}

void ct_stepper_subtract_roundoff(const struct ct_problem *p, double h, double *e)
{
    // Derived: the weights of stages in errors have sums of squares of up to 16
    const double evaluations = 4;
    for (int i = 0; i < p->ny && p->roundoff && h <= p->roundoff_step; i++)
        e[i] = copysign(fmax(0, fabs(e[i]) - evaluations * h * p->roundoff[i]), e[i]);
}

double ct_stepper_error(const struct ct_problem *p, const struct ct_tolerance *tolerance,
                        double t1, const double *y, const double *y1, const double *e)
{
    return ct_stepper_larger_error(p, tolerance, t1, y1, e,
                                   ct_stepper_norm(p, tolerance, y, y1, e));
}

double ct_stepper_join(double e5, double e3)
{
    // Derived: 0.1 is that of DOP853
    return e5 == 0 ? 0 : e5 / hypot(1, 0.1 * (e3 / e5));
}

double ct_stepper_largest(const struct ct_problem *p, const struct ct_tolerance *tolerance,
                          int first, const double *y, const double *y1, const double *e)
{
    double worst = 0;
    for (int i = first; i < p->ny; i++) {
        const double weight = tolerance->rtol * fmax(fabs(y[i]), fabs(y1[i])) + tolerance->atol;
        if (!p->error_controlled || p->error_controlled[i])
            worst = fmax(worst, fabs(e[i]) / weight);
    }
    return worst;
}

void ct_stepper_hermite(double *restrict out, double theta, double h, const double *y,
                        const double *dy, const double *y1, const double *dy1, int n)
{
    const double rest = 1 - theta;
    for (int i = 0; i < n; i++) {
        const double rise = y1[i] - y[i], bend = h * dy[i] - rise;
        out[i] = y[i] + theta * (rise + rest * (bend + theta * (rise - h * dy1[i] - bend)));
    }
}

double ct_stepper_stiffness_estimate(const struct ct_problem *p, double h, const double *y1,
                                     const double *dy1, const double *point,
                                     const double *dpoint)
{
    // Derived: two points that are closer differ mostly by their round-off.
    const double roundoffs = 16 * DBL_EPSILON;
    double size = 0, way = 0, change = 0;
    for (int i = 0; i < (p->nu ? p->nq + p->nu : p->ny); i++) {
        const double d = y1[i] - point[i], f = dy1[i] - dpoint[i];
        size += y1[i] * y1[i];
        way += d * d;
        change += f * f;
    }
    return way > roundoffs * roundoffs * size ? h * sqrt(change / way) : 0;
}

void ct_stepper_point(const struct ct_stepper_span *s, double theta, double *out)
{
    s->method->dense(s->p, s->h, theta, s->y, s->y1, s->work, out);
}
