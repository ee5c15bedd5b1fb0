// See switch_state.h.
#include "solve/evaluator/switch_state.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double side_of(enum ct_op op, double g)
{
    return ct_op_apply(op, g, 0, 0);
}

// g at the state moved by h along (1, dy).
static void evaluate(struct ct_evaluator *m, double t, const double *y, const double *dy,
                     double h, double *g)
{
    const size_t n = m->nq + m->nu;
    m->input[0] = t + h;
    for (size_t i = 0; i < n && dy; i++)
        m->input[m->at_q + i] = y[i] + h * dy[i];
    ct_program_run(&m->root, m->input);
    memcpy(g, m->root.out, m->e->nswitch * sizeof *g);
    m->input[0] = t;
    memcpy(m->input + m->at_q, y, n * sizeof *y);
}

// Switches may occur in the g of others; this number of levels is evaluated.
// Limit: as docs/format.md says
enum { MOST_LEVELS = 4 };

// g is zero if it is below this fraction of its change in a second.
// Derived: 4500 units of round-off.
static const double zero = 1e-12;

// A g that stays zero counts as zero up to this fraction of the largest state: round-off of a g
// that is zero by symmetry.
// Default: forces caused by round-off against small ones that are intended. Test: rest_at_zero.
static const double roundoff = 64 * DBL_EPSILON;

// How far to look ahead for the later side, [s].
static double ahead_of(double t)
{
    // Derived: somewhat more than the root of the unit round-off of t
    return 1e-7 * fmax(1, fabs(t));
}

static double largest(const double *v, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(v[i]));
    return most;
}

// The sum of all |dg_i/dy_k| at t, y, by differences. Times the size of the states and `roundoff`
// it bounds the effect of round-off of states on g_i. Cost: 1 + nq + nu evaluations of g.
static double sensitivity(struct ct_evaluator *m, size_t i, double t, const double *y)
{
    const double spacing = sqrt(DBL_EPSILON);
    double *z = m->input + m->at_q, sum = 0;
    m->input[0] = t;
    ct_program_run(&m->root, m->input);
    const double g = m->root.out[i];
    for (size_t k = 0; k < m->nq + m->nu; k++) {
        const double dy = spacing * fmax(1, fabs(y[k]));
        z[k] = y[k] + dy;
        ct_program_run(&m->root, m->input);
        sum += fabs(m->root.out[i] - g) / dy;
        z[k] = y[k];
    }
    return sum;
}

double ct_switches_size(const struct ct_evaluator *m, const double *y)
{
    return largest(y, m->nq + m->nu);
}

// Rates of states err by round-off of forces, which are of the size of the states or of the rates.
static bool is_rate_zero(const struct ct_evaluator *m, size_t i, const double *y,
                         const double *dy, double rate)
{
    return fabs(rate) <= m->at_rest[i] * fmax(ct_switches_size(m, y), ct_switches_size(m, dy));
}

// Are g_i at t, y and its rate zero to round-off? Records it in at_rest.
static bool find_rest(struct ct_evaluator *m, size_t i, double t, const double *y,
                      const double *dy, double g, double rate)
{
    m->at_rest[i] = fmax(roundoff * sensitivity(m, i, t, y), DBL_MIN);
    const bool rests
        = fabs(g) <= m->at_rest[i] * ct_switches_size(m, y) && is_rate_zero(m, i, y, dy, rate);
    if (!rests)
        m->at_rest[i] = 0;
    m->has_rest |= rests;
    return rests;
}

void ct_switches_start(struct ct_evaluator *m, double t, const double *y, const double *dy,
                       const signed char *crossed)
{
    const double ahead = ahead_of(t);
    double *side = m->input + m->at_switch;
    memset(m->at_rest, 0, m->e->nswitch * sizeof *m->at_rest);
    m->has_rest = false;
    for (size_t level = 0; level < MOST_LEVELS && level < m->e->nswitch; level++) {
        evaluate(m, t, y, dy, 0, m->g[0]);
        evaluate(m, t, y, dy, ahead, m->g[1]);
        for (size_t i = 0; i < m->e->nswitch; i++) {
            const enum ct_op op = m->e->switches[i].op;
            const double now = m->g[0][i], later = m->g[1][i], rate = (later - now) / ahead;
            const bool is_zero = fabs(now) <= zero * fmax(1, fabs(rate));
            side[i] = side_of(op, is_zero ? later : now);
            m->at_rest[i] = 0;
            if (crossed && crossed[i])
                side[i] = side_of(op, crossed[i]);
            else if (is_zero && dy && !m->e->switches[i].is_time
                     && find_rest(m, i, t, y, dy, now, rate))
                side[i] = side_of(op, 0);
        }
    }
}

int ct_switches_find_contradicted(struct ct_evaluator *m, double t, const double *y,
                                  const double *dy)
{
    const double *side = m->input + m->at_switch;
    // near: fraction of the change of g in the time `ahead`. Derived: events are located to a
    // thousandth of it
    const double ahead = ahead_of(t), near = 1e-3;
    evaluate(m, t, y, dy, 0, m->g[0]);
    evaluate(m, t, y, dy, ahead, m->g[1]);
    for (size_t i = 0; i < m->e->nswitch; i++) {
        const double now = m->g[0][i], later = m->g[1][i], rate = (later - now) / ahead;
        const bool rests = m->at_rest[i] > 0 && is_rate_zero(m, i, y, dy, rate);
        if (!m->e->switches[i].is_time && !rests && fabs(now) < near * fabs(later - now)
            && side_of(m->e->switches[i].op, later) != side[i])
            return (int)i;
    }
    return -1;
}

int ct_switches_side(const struct ct_evaluator *m, size_t i, double value)
{
    const enum ct_op op = m->e->switches[i].op;
    const bool is_up = op == CT_OP_GT || op == CT_OP_GE;
    return m->at_rest[i] > 0 ? 0 : is_up == (value != 0) ? 1 : -1;
}

void ct_switches_follow(struct ct_evaluator *m, size_t i)
{
    const struct ct_switch *all = m->e->switches;
    for (size_t k = 0; k < m->e->nswitch; k++)
        if (ct_ex_same(all[k].g, all[i].g)) {
            m->input[m->at_switch + k] = side_of(all[k].op, m->g[1][i]);
            m->at_rest[k] = 0;
        }
}

// ---- time events --------------------------------------------------------------------------------

struct times {
    struct ct_arena *a;
    double *t;
    size_t n, cap;
};

void ct_switches_of_time(struct ct_evaluator *m, double t)
{
    m->input[0] = t;
    for (size_t level = 0; level < MOST_LEVELS; level++) {
        ct_program_run(&m->root, m->input);
        for (size_t k = 0; k < m->e->nswitch; k++)
            if (m->e->switches[k].is_time)
                m->input[m->at_switch + k] = side_of(m->e->switches[k].op, m->root.out[k]);
    }
}

// Value of switch i at time t, with the switches inside its g evaluated for that time.
static bool outcome(struct ct_evaluator *m, size_t i, double t, double *g)
{
    ct_switches_of_time(m, t);
    *g = m->root.out[i];
    return side_of(m->e->switches[i].op, *g) != 0;
}

// The first double in (a, b] whose outcome differs from that at a; one step earlier if g vanishes
// there.
static double bisect(struct ct_evaluator *m, size_t i, double a, double b)
{
    double g;
    const bool before = outcome(m, i, a, &g);
    for (;;) {
        const double middle = a + (b - a) / 2;
        if (!(middle > a && middle < b))
            break;
        if (outcome(m, i, middle, &g) == before)
            a = middle;
        else
            b = middle;
    }
    outcome(m, i, a, &g);
    return g == 0 ? a : b;
}

static void find_changes(struct ct_evaluator *m, size_t i, double t0, double t1,
                         struct times *list)
{
    // Limit: of the time of a search; shorter changes are missed
    enum { PIECES = 4096 };
    double g, a = t0;
    bool side = outcome(m, i, a, &g);
    for (int k = 1; k <= PIECES; k++) {
        const double b = k == PIECES ? t1 : t0 + (t1 - t0) * k / PIECES;
        const bool next = outcome(m, i, b, &g);
        if (next != side) {
            const double t = bisect(m, i, a, b);
            if (t > t0)
                CT_PUSH(list->a, list->t, list->n, list->cap, t);
        }
        side = next;
        a = b;
    }
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bool ct_table_has_kinks(const struct ct_table *table, int order)
{
    // Derived: methods of this order are affected by a jump of the third derivative
    const int highest_order = 5;
    return !table->m || order > highest_order;
}

size_t ct_time_events(struct ct_arena *a, struct ct_evaluator *m, int order, double t0,
                      double t1, double **time)
{
    struct times list = {.a = a};
    const struct ct_exs *x = m->e->x;
    for (size_t i = 0; i < m->e->nswitch; i++)
        if (m->e->switches[i].is_time)
            find_changes(m, i, t0, t1, &list);
    for (size_t k = 0; k < x->ntable; k++)
        for (size_t i = 0; i < x->table[k].n; i++) {
            const double at = x->table[k].x[i];
            const bool is_kink = ct_table_has_kinks(&x->table[k], order) && at <= t1;
            const bool is_end = i + 1 == x->table[k].n && at < t1;
            if (at > t0 && (is_kink || is_end))
                CT_PUSH(a, list.t, list.n, list.cap, at);
        }
    if (list.n)
        qsort(list.t, list.n, sizeof *list.t, ascending);
    size_t kept = 0;
    for (size_t i = 0; i < list.n; i++)
        if (kept == 0 || list.t[i] > list.t[kept - 1])
            list.t[kept++] = list.t[i];
    m->input[0] = t0;
    *time = list.t;
    return kept;
}

double ct_time_just_before(double t, double pending)
{
    return t < pending ? t : nextafter(pending, -INFINITY);
}
