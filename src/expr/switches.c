// Roots along a symbol by interval arithmetic; see switches.h.
#include "expr/switches.h"
#include "base/sort.h"
#include "expr/quadrature.h"

#include <math.h>
#include <string.h>

// Width of an interval that is accepted as a root, relative to the whole interval. Derived: about
// ten operations of interval arithmetic leave 16 units of round-off, 16 * 2^-52 = 0x1p-48.
static const double least = 0x1p-48;
// Limit: of the search for one argument; a simple root takes about 100. Beyond it the function
// returns -1.
enum { MOST_INTERVALS = 20000 };

struct interval {
    double low, high;
};

static const struct interval any = {-INFINITY, INFINITY};

// ---- interval arithmetic -----------------------------------------------------------------------

static struct interval hull(struct interval a, struct interval b)
{
    return (struct interval){fmin(a.low, b.low), fmax(a.high, b.high)};
}

static bool has_zero(struct interval a)
{
    return !(a.low > 0 || a.high < 0);
}

// Range of an operator that is monotone in each argument: its values at the ends of the intervals.
static struct interval corners(enum ct_op op, struct interval a, struct interval b)
{
    const double v[] = {ct_op_apply(op, a.low, b.low, 0), ct_op_apply(op, a.low, b.high, 0),
                        ct_op_apply(op, a.high, b.low, 0), ct_op_apply(op, a.high, b.high, 0)};
    struct interval out = {v[0], v[0]};
    for (int i = 0; i < 4; i++) {
        if (isnan(v[i]))
            return any;
        out = hull(out, (struct interval){v[i], v[i]});
    }
    return out;
}

static struct interval size_of(struct interval a)
{
    if (!has_zero(a))
        return corners(CT_OP_ABS, a, a);
    return (struct interval){0, fmax(-a.low, a.high)};
}

static struct interval power(struct interval a, struct interval b)
{
    const bool is_whole = b.low == b.high && b.low == floor(b.low) && b.low > 0;
    if (is_whole && fmod(b.low, 2) == 0)
        a = size_of(a);
    return is_whole || a.low > 0 ? corners(CT_OP_POW, a, b) : any;
}

// Range of sin or cos by the Lipschitz constant 1.
static struct interval wave(enum ct_op op, struct interval a)
{
    const double half = (a.high - a.low) / 2, v = ct_op_apply(op, a.low + half, 0, 0);
    if (!isfinite(v) || !isfinite(half))
        return (struct interval){-1, 1};
    return (struct interval){fmax(v - half, -1), fmin(v + half, 1)};
}

static struct interval equals(struct interval a, struct interval b)
{
    if (a.low == a.high && b.low == b.high)
        return corners(CT_OP_EQ, a, b);
    return (struct interval){0, a.low <= b.high && b.low <= a.high};
}

static struct interval apply(enum ct_op op, struct interval a, struct interval b,
                             struct interval c)
{
    switch (op) {
    case CT_OP_ADD:
    case CT_OP_SUB:
    case CT_OP_MUL:
    case CT_OP_NEG:
    case CT_OP_SQRT:
    case CT_OP_ASIN:
    case CT_OP_ACOS:
    case CT_OP_ATAN:
    case CT_OP_SINH:
    case CT_OP_TANH:
    case CT_OP_EXP:
    case CT_OP_LOG:
    case CT_OP_SIGN:
    case CT_OP_MIN:
    case CT_OP_MAX:
    case CT_OP_LT:
    case CT_OP_LE:
    case CT_OP_GT:
    case CT_OP_GE:
        return corners(op, a, b);
    case CT_OP_EQ:
        return equals(a, b);
    case CT_OP_DIV:
        return has_zero(b) ? any : corners(op, a, b);
    case CT_OP_POW:
        return power(a, b);
    case CT_OP_ABS:
        return size_of(a);
    case CT_OP_COSH:
        a = size_of(a);
        return corners(op, a, a);
    case CT_OP_SIN:
    case CT_OP_COS:
        return wave(op, a);
    case CT_OP_IF:
        if (!has_zero(a))
            return b;
        return a.low == 0 && a.high == 0 ? c : hull(b, c);
    default:
        return any; // tan, atan2, tables
    }
}

// ---- roots of one argument ---------------------------------------------------------------------

struct search {
    const struct ct_exs *x;
    ct_ex s;
    const uint32_t *node; // below the argument, children first
    size_t n;
    const double *value;
    struct interval *at; // range of each node of the store
    double least;
    int left; // intervals that may still be tested
    double *place;
    int nplace, most;
};

static struct interval enclose(struct search *w, struct interval over)
{
    const struct ct_exs *x = w->x;
    for (size_t i = 0; i < w->n; i++) {
        const uint32_t id = w->node[i];
        const struct ct_exnode *n = &x->node[id];
        double v;
        if (id == w->s.id)
            w->at[id] = over;
        else if (ct_ex_is_const(x, (ct_ex){id}, &v))
            w->at[id] = (struct interval){v, v};
        else if (n->op == CT_OP_SYM)
            w->at[id] = (struct interval){w->value[n->a], w->value[n->a]};
        else {
            const int narg = ct_op_info[n->op].narg;
            const struct interval none = {0, 0}, a = w->at[n->a],
                                  b = narg > 1 ? w->at[n->b] : none,
                                  c = narg > 2 ? w->at[n->c] : none;
            w->at[id] = apply((enum ct_op)n->op, a, b, c);
        }
    }
    return w->at[w->node[w->n - 1]];
}

static bool put(struct search *w, double place)
{
    if (w->nplace == w->most)
        return false;
    w->place[w->nplace++] = place;
    return true;
}

// Bisection, lower half first, so that roots come in ascending order. Depth: at most 48.
static bool find_roots(struct search *w, double low, double high)
{
    if (w->left-- == 0)
        return false;
    const struct interval v = enclose(w, (struct interval){low, high});
    const double middle = low + (high - low) / 2;
    if (!has_zero(v) || (v.low == 0 && v.high == 0))
        return true; // identically 0 on the interval: no switching point
    if (high - low <= w->least) {
        const bool again = w->nplace && fabs(middle - w->place[w->nplace - 1]) <= 4 * w->least;
        if (again)
            w->place[w->nplace - 1] = middle;
        return again || put(w, middle);
    }
    return find_roots(w, low, middle) && find_roots(w, middle, high);
}

// ---- all arguments -----------------------------------------------------------------------------

// The function whose sign change is a switching point of the node; zero if there is none.
static ct_ex argument(struct ct_exs *x, uint32_t id)
{
    const struct ct_exnode n = x->node[id];
    switch ((enum ct_op)n.op) {
    case CT_OP_ABS:
    case CT_OP_SIGN:
        return (ct_ex){n.a};
    case CT_OP_MIN:
    case CT_OP_MAX:
    case CT_OP_LT:
    case CT_OP_LE:
    case CT_OP_GT:
    case CT_OP_GE:
        return ct_ex_sub(x, (ct_ex){n.a}, (ct_ex){n.b});
    default:
        return CT_EX_ZERO;
    }
}

static bool find_places(struct search *w, struct ct_exs *x, struct ct_arena *scratch, ct_ex g,
                        double from, double to, double *value)
{
    const uint32_t at = x->node[w->s.id].a;
    value[at] = from;
    const double start
        = ct_ex_value(x, g, value); // this also records the parameters that were read
    if (ct_ex_degree(x, g, w->s) == 1) {
        value[at] = to;
        const double end = ct_ex_value(x, g, value),
                     root = from - start * (to - from) / (end - start);
        return !(root > from && root < to) || put(w, root);
    }
    const size_t n = ct_ex_walk(x, &g, 1);
    uint32_t *node = CT_NEWN(scratch, uint32_t, n);
    memcpy(node, x->stack, n * sizeof *node);
    w->node = node;
    w->n = n;
    w->at = CT_NEWN(scratch, struct interval, x->nnode);
    w->left = MOST_INTERVALS;
    return find_roots(w, from, to);
}

static int ascending(const void *context, const void *a, const void *b)
{
    (void)context;
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

int ct_ex_switches(struct ct_exs *x, struct ct_arena *scratch, ct_ex f, ct_ex s, double from,
                   double to, double *value, double *place, int most)
{
    struct search w = {.x = x,
                       .s = s,
                       .value = value,
                       .least = least * (to - from),
                       .place = place,
                       .most = most};
    const size_t n = ct_ex_walk(x, &f, 1);
    uint32_t *node = CT_NEWN(scratch, uint32_t, n + 1);
    memcpy(node, x->stack, n * sizeof *node);
    for (size_t i = 0; i < n; i++) {
        const ct_ex g = argument(x, node[i]);
        if (ct_ex_kinds(x, g) & 1u << CT_SYM_LOCAL
            && !find_places(&w, x, scratch, g, from, to, value))
            return -1;
    }
    ct_sort(scratch, place, (size_t)w.nplace, sizeof *place, ascending, NULL);
    int kept = 0;
    const double close = CT_SAME_PLACE * (to - from);
    for (int i = 0; i < w.nplace; i++)
        if (place[i] - from > close && to - place[i] > close
            && (!kept || place[i] - place[kept - 1] > close))
            place[kept++] = place[i];
    return kept;
}
