// Values of operators, tables and whole expressions: the reference for every evaluator.
#include "expr/ex.h"

#include <math.h>

double ct_op_apply(enum ct_op op, double a, double b, double c)
{
    switch (op) {
#define FN(function) function
#define NO_VALUE NAN
#define OP(op, narg, name, value)                                                              \
    case op:                                                                                   \
        return value;
#include "expr/ops.def"
#undef OP
#undef NO_VALUE
#undef FN
    case CT_OP_COUNT:
        break;
    }
    return NAN;
}

// Find interval i with x[i] <= at <= x[i + 1]. The search starts at the interval that equal spacing
// would give and widens by doubling: constant cost for equal spacing, that of bisection otherwise.
static size_t find_interval(const struct ct_table *t, double at)
{
    const size_t last = t->n - 1;
    const double guess = (at - t->x[0]) / (t->x[last] - t->x[0]) * (double)last;
    size_t low = !(guess > 0) ? 0 : guess < (double)last ? (size_t)guess : last - 1;
    size_t high = low + 1;
    for (size_t step = 1; low > 0 && t->x[low] > at; step *= 2) {
        high = low;
        low -= step < low ? step : low;
    }
    for (size_t step = 1; high < last && t->x[high] <= at; step *= 2) {
        low = high;
        high += step < last - high ? step : last - high;
    }
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (t->x[middle] <= at)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Value of a piecewise constant table at `at`.
static double held_value(const struct ct_table *t, double at)
{
    if (t->n == 1 || at >= t->x[t->n - 1])
        return t->y[t->n - 1];
    return t->y[at < t->x[0] ? 0 : find_interval(t, at)];
}

double ct_table_value(const struct ct_table *t, uint32_t order, double at)
{
    if (t->holds)
        return isnan(at) ? NAN : order ? 0 : held_value(t, at);
    if (!(at >= t->x[0] && at <= t->x[t->n - 1]))
        return NAN;
    const size_t i = find_interval(t, at);
    const double h = t->x[i + 1] - t->x[i], s = at - t->x[i];
    const double slope = (t->y[i + 1] - t->y[i]) / h;
    // y(s) = y_i + s (c1 + s (c2 + s c3))
    double c1 = slope, c2 = 0, c3 = 0;
    if (t->m) {
        c1 = t->m[i];
        c2 = (3 * slope - 2 * t->m[i] - t->m[i + 1]) / h;
        c3 = (t->m[i] + t->m[i + 1] - 2 * slope) / (h * h);
    }
    switch (order) {
    case 0:
        return t->y[i] + s * (c1 + s * (c2 + s * c3));
    case 1:
        return c1 + s * (2 * c2 + s * 3 * c3);
    case 2:
        return 2 * c2 + 6 * s * c3;
    case 3:
        return 6 * c3;
    default:
        return 0;
    }
}

// Value of a node from the values of its arguments, indexed by node.
static double value_from(const struct ct_exs *x, uint32_t id, const double *value,
                         const double *number)
{
    const struct ct_exnode *n = &x->node[id];
    const uint32_t arg[3] = {n->a, n->b, n->c};
    double v[3] = {0};
    if (ct_ex_is_const(x, (ct_ex){id}, v))
        return v[0];
    if (n->op == CT_OP_SYM)
        return value[n->a];
    for (int i = 0; i < ct_op_info[n->op].narg; i++)
        v[i] = number[arg[i]];
    return n->op == CT_OP_TABLE ? ct_table_value(&x->table[n->b], n->c, v[0])
                                : ct_op_apply((enum ct_op)n->op, v[0], v[1], v[2]);
}

void ct_ex_values(struct ct_exs *x, struct ct_arena *scratch, const ct_ex *a, size_t n,
                  const double *value, double *out)
{
    double *number = CT_NEWN(scratch, double, x->nnode + 1);
    const size_t nwalk = ct_ex_walk(x, a, n);
    for (size_t i = 0; i < nwalk; i++)
        number[x->stack[i]] = value_from(x, x->stack[i], value, number);
    for (size_t i = 0; i < n; i++)
        out[i] = number[a[i].id];
}

double ct_ex_value(const struct ct_exs *x, ct_ex a, const double *value)
{
    const struct ct_exnode *n = &x->node[a.id];
    double v[3] = {0};
    if (ct_ex_is_const(x, a, v))
        return v[0];
    if (n->op == CT_OP_SYM) {
        if (x->decided && n->a < x->ndecided)
            x->decided[n->a] = 1;
        return value[n->a];
    }
    const uint32_t arg[3] = {n->a, n->b, n->c};
    for (int i = 0; i < ct_op_info[n->op].narg; i++)
        v[i] = ct_ex_value(x, (ct_ex){arg[i]}, value);
    if (n->op == CT_OP_TABLE)
        return ct_table_value(&x->table[n->b], n->c, v[0]);
    return ct_op_apply((enum ct_op)n->op, v[0], v[1], v[2]);
}
