// Sparse forward-mode automatic differentiation at a point (dual numbers). One walk computes for
// each node its value and the list of its nonzero derivatives.
//
//     node  ->  value,  [ (direction, derivative), ... ]      ascending directions, zeros left out
//
// The same walk as in jacobian.c, with numbers. Derivatives that vanish at the point are not
// propagated. A list is freed after its last reader, so the memory is that of the live nodes.
// Source: Griewank and Walther (2008), 3.1 and 7.1, key griewank2008.
#include "expr/seed.h"

#include <math.h>
#include <string.h>

struct tangent {
    uint32_t direction;
    double value;
};

struct list {
    struct tangent *at;
    uint32_t n;
    uint8_t size; // capacity 2^size
};

enum { NSIZE = 32 }; // Definition: bits of a length, one list for each power of two

struct walk {
    struct ct_exs *x;
    struct ct_arena *scratch;
    const double *value;    // by symbol
    double *v;              // by index in the walk
    struct list *list;      // by index in the walk
    uint32_t *place;        // by id: index in the walk
    uint32_t *readers;      // by index in the walk: remaining readers (nodes and roots)
    void *free[NSIZE];      // free lists by size, chained through their first bytes
    struct tangent *merged; // list of the current node
    size_t nmerged, cap;
};

// ---- lists -------------------------------------------------------------------------------------

static void keep_merged(struct walk *w, struct list *l)
{
    l->n = (uint32_t)w->nmerged;
    if (!l->n)
        return;
    while ((1u << l->size) < l->n)
        l->size++;
    l->at = w->free[l->size];
    if (l->at)
        memcpy(&w->free[l->size], l->at, sizeof w->free[l->size]);
    else
        l->at = CT_NEWN(w->scratch, struct tangent, (size_t)1 << l->size);
    memcpy(l->at, w->merged, l->n * sizeof *l->at);
}

static void read_once(struct walk *w, uint32_t place)
{
    struct list *l = &w->list[place];
    if (--w->readers[place] || !l->n)
        return;
    memcpy(l->at, &w->free[l->size], sizeof w->free[l->size]);
    w->free[l->size] = l->at;
    l->n = 0;
}

static void push(struct walk *w, uint32_t direction, double value)
{
    const struct tangent t = {direction, value};
    if (value != 0)
        CT_PUSH(w->scratch, w->merged, w->nmerged, w->cap, t);
}

// ---- nodes -------------------------------------------------------------------------------------

static void seed_symbol(struct walk *w, uint32_t id, const struct ct_seed *seed, size_t nseed)
{
    for (size_t k = ct_seeds_find(seed, nseed, id); k < nseed && seed[k].symbol.id == id; k++)
        push(w, seed[k].direction, ct_ex_value(w->x, seed[k].value, w->value));
}

double ct_op_partial(enum ct_op op, int i, double a, double b, double v)
{
    switch (op) {
    case CT_OP_ADD:
        return 1;
    case CT_OP_SUB:
        return i ? -1 : 1;
    case CT_OP_NEG:
        return -1;
    case CT_OP_MUL:
        return i ? a : b;
    case CT_OP_DIV:
        return i ? -v / b : 1 / b;
    case CT_OP_POW:
        return i ? v * log(a) : b * pow(a, b - 1);
    case CT_OP_SQRT:
        return 0.5 / v;
    case CT_OP_SIN:
        return cos(a);
    case CT_OP_COS:
        return -sin(a);
    case CT_OP_TAN:
        return 1 + v * v;
    case CT_OP_ASIN:
        return 1 / sqrt(1 - a * a);
    case CT_OP_ACOS:
        return -1 / sqrt(1 - a * a);
    case CT_OP_ATAN:
        return 1 / (1 + a * a);
    case CT_OP_ATAN2:
        return (i ? -a : b) / (a * a + b * b);
    case CT_OP_SINH:
        return cosh(a);
    case CT_OP_COSH:
        return sinh(a);
    case CT_OP_TANH:
        return 1 - v * v;
    case CT_OP_EXP:
        return v;
    case CT_OP_LOG:
        return 1 / a;
    case CT_OP_ABS:
        return ct_op_apply(CT_OP_SIGN, a, 0, 0);
    case CT_OP_MIN: // the second argument if both are equal
        return (a < b) != i;
    case CT_OP_MAX:
        return (a > b) != i;
    case CT_OP_IF:
        return i > 0 && (a != 0) == (i == 1);
    case CT_OP_TABLE:
    case CT_OP_CONST:
    case CT_OP_SYM:
    case CT_OP_SIGN:
    case CT_OP_LT:
    case CT_OP_LE:
    case CT_OP_GT:
    case CT_OP_GE:
    case CT_OP_EQ:
    case CT_OP_COUNT:
        break;
    }
    return 0;
}

static double value_of(struct walk *w, const struct ct_exnode *n, const double a[3])
{
    double v;
    const ct_ex e = {(uint32_t)(n - w->x->node)};
    if (n->op == CT_OP_SYM)
        return w->value[n->a];
    if (ct_ex_is_const(w->x, e, &v))
        return v;
    if (n->op == CT_OP_TABLE)
        return ct_table_value(&w->x->table[n->b], n->c, a[0]);
    return ct_op_apply((enum ct_op)n->op, a[0], a[1], a[2]);
}

// Merge the lists of a node's arguments.
static void chain(struct walk *w, const struct ct_exnode *n, const uint32_t *arg, int narg,
                  const double a[3], double v)
{
    const struct tangent *at[3] = {0}, *end[3] = {0};
    double partial[3] = {0};
    int m = 0; // arguments that have derivatives
    for (int i = 0; i < narg; i++) {
        const struct list *l = &w->list[arg[i]];
        if (!l->n)
            continue;
        partial[m] = n->op == CT_OP_TABLE ? ct_table_value(&w->x->table[n->b], n->c + 1, a[0])
                                          : ct_op_partial((enum ct_op)n->op, i, a[0], a[1], v);
        at[m] = l->at;
        end[m] = l->at + l->n;
        m += partial[m] != 0;
    }
    for (;;) {
        uint32_t least = UINT32_MAX;
        double sum = 0;
        for (int i = 0; i < m; i++)
            if (at[i] < end[i] && at[i]->direction < least)
                least = at[i]->direction;
        if (least == UINT32_MAX)
            return;
        for (int i = 0; i < m; i++)
            if (at[i] < end[i] && at[i]->direction == least)
                sum += partial[i] * at[i]++->value;
        push(w, least, sum);
    }
}

static int list_arguments(const struct walk *w, const struct ct_exnode *n, uint32_t arg[3])
{
    const uint32_t id[3] = {n->a, n->b, n->c};
    const int narg = ct_op_info[n->op].narg;
    for (int i = 0; i < narg; i++)
        arg[i] = w->place[id[i]];
    return narg;
}

static void visit(struct walk *w, uint32_t id, uint32_t k, const struct ct_seed *seed,
                  size_t nseed)
{
    const struct ct_exnode *n = &w->x->node[id];
    uint32_t arg[3] = {0};
    double a[3] = {0};
    const int narg = list_arguments(w, n, arg);
    for (int i = 0; i < narg; i++)
        a[i] = w->v[arg[i]];
    w->v[k] = value_of(w, n, a);
    w->nmerged = 0;
    if (n->op == CT_OP_SYM)
        seed_symbol(w, id, seed, nseed);
    else
        chain(w, n, arg, narg, a, w->v[k]);
    keep_merged(w, &w->list[k]);
    for (int i = 0; i < narg; i++)
        read_once(w, arg[i]);
}

// ---- the walk ----------------------------------------------------------------------------------

static void count_readers(struct walk *w, const uint32_t *id, size_t n, const ct_ex *f,
                          size_t nf)
{
    for (size_t k = 0; k < n; k++) {
        uint32_t arg[3];
        const int narg = list_arguments(w, &w->x->node[id[k]], arg);
        for (int i = 0; i < narg; i++)
            w->readers[arg[i]]++;
    }
    for (size_t r = 0; r < nf; r++)
        w->readers[w->place[f[r].id]]++;
}

size_t ct_ex_jacobian_at(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                         const ct_ex *f, size_t nf, const struct ct_seed *seeds, size_t nseed,
                         const double *value, double *fvalue, struct ct_number **out)
{
    const size_t n = ct_ex_walk(x, f, nf);
    const uint32_t *id = x->stack; // no further walk starts below
    struct walk w = {.x = x, .scratch = scratch, .value = value};
    w.v = CT_NEWN(scratch, double, n + 1);
    w.list = CT_NEWN(scratch, struct list, n + 1);
    w.place = CT_NEWN(scratch, uint32_t, x->nnode + 1);
    w.readers = CT_NEWN(scratch, uint32_t, n + 1);
    for (size_t k = 0; k < n; k++)
        w.place[id[k]] = (uint32_t)k;
    count_readers(&w, id, n, f, nf);
    const struct ct_seed *seed = ct_seeds_sorted(scratch, seeds, nseed);
    size_t nout = 0, cap = 0, next = 0;
    *out = NULL;
    for (size_t k = 0; k < n; k++) {
        visit(&w, id[k], (uint32_t)k, seed, nseed);
        for (; next < nf && w.place[f[next].id] <= k; next++) { // a root whose node is finished
            const uint32_t place = w.place[f[next].id];
            const struct list *l = &w.list[place];
            fvalue[next] = w.v[place];
            for (size_t i = 0; i < l->n; i++) {
                const struct ct_number entry
                    = {(uint32_t)next, l->at[i].direction, l->at[i].value};
                CT_PUSH(a, *out, nout, cap, entry);
            }
            read_once(&w, place);
        }
    }
    return nout;
}
