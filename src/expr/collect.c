// Entry points of simplification: expand, identities, regroup; see collect.h.
#include "expr/collect.h"

#include "expr/collector.h"

#include <string.h>

static struct ct_arena *scratch_of(const struct ct_exs *x,
                                   const struct ct_collect_options *options)
{
    return options && options->scratch ? options->scratch : x->arena;
}

static struct ct_collector *start(struct ct_exs *x, const struct ct_collect_options *options,
                                  bool early)
{
    struct ct_arena *arena = scratch_of(x, options);
    struct ct_collector *c = CT_NEW(arena, struct ct_collector);
    ct_collector_init(c, x, arena, options && options->limit ? options->limit : 2000, early);
    for (size_t k = 0; options && k < options->nquaternion; k++)
        ct_collector_add_quaternion(c, options->quaternion[k]);
    return c;
}

// Tree sizes of the nodes below e, in the order of the walk.
struct sizes {
    double *at;
    size_t cap;
};

static double tree_size(struct sizes *s, struct ct_exs *x, struct ct_arena *arena, ct_ex e)
{
    const size_t n = ct_ex_walk(x, &e, 1);
    if (s->cap < n) {
        s->cap = 2 * n;
        s->at = CT_NEWN(arena, double, s->cap);
    }
    for (size_t k = 0; k < n; k++) {
        const struct ct_exnode *node = &x->node[x->stack[k]];
        const uint32_t arg[3] = {node->a, node->b, node->c};
        x->memo[x->stack[k]].id = (uint32_t)k;
        s->at[k] = 1;
        for (int i = 0; i < ct_op_info[node->op].narg; i++)
            s->at[k] += s->at[x->memo[arg[i]].id];
    }
    return s->at[n - 1];
}

double ct_ex_tree_size(struct ct_exs *x, struct ct_arena *scratch, ct_ex e)
{
    return tree_size(&(struct sizes){NULL, 0}, x, scratch, e);
}

static ct_ex finish(struct ct_collector *c, struct ct_poly p)
{
    return ct_regroup(c, ct_identity_apply(c, p));
}

// ---- the smallest form --------------------------------------------------------------------------

// Expanding may make an expression longer: (a + b)^5 stays as it is. The operator is then kept, and
// only its operands are simplified.
struct descent {
    struct ct_collector *c;
    struct sizes sizes;
    struct ct_pairs done; // by node: its simplified form
    size_t left;          // attempts left: one can take milliseconds
};

static ct_ex collect_node(struct descent *d, ct_ex e);

static ct_ex collect_operands(struct descent *d, ct_ex e)
{
    const struct ct_exnode n = *ct_ex_node(d->c->x, e);
    switch (n.op) {
    case CT_OP_NEG:
        return ct_ex_neg(d->c->x, collect_node(d, (ct_ex){n.a}));
    case CT_OP_ADD:
    case CT_OP_SUB:
    case CT_OP_MUL:
    case CT_OP_DIV: {
        const ct_ex a = collect_node(d, (ct_ex){n.a});
        return ct_ex_fun2(d->c->x, (enum ct_op)n.op, a, collect_node(d, (ct_ex){n.b}));
    }
    default:
        return e;
    }
}

static ct_ex collect_node(struct descent *d, ct_ex e)
{
    struct ct_exs *x = d->c->x;
    const int done = ct_pairs_get(&d->done, (int)e.id, 0);
    if (done >= 0 || !d->left)
        return done >= 0 ? (ct_ex){(uint32_t)done} : e;
    d->left--;
    ct_ex r = finish(d->c, ct_expanded(d->c, e.id));
    const double size = tree_size(&d->sizes, x, d->c->arena, e);
    if (tree_size(&d->sizes, x, d->c->arena, r) > size)
        r = collect_operands(d, e);
    if (tree_size(&d->sizes, x, d->c->arena, r) > size)
        r = e;
    ct_pairs_put(d->c->arena, &d->done, (int)e.id, 0, (int)r.id);
    return r;
}

struct attempt {
    ct_ex e;
    bool bundled, has_angles;
};

static struct attempt attempt(struct ct_exs *x, ct_ex e,
                              const struct ct_collect_options *options, bool early)
{
    struct ct_collector *c = start(x, options, early);
    struct descent d = {.c = c, .left = 100};
    ct_expand(c, e);
    return (struct attempt){collect_node(&d, e), c->bundled, c->nangle > 0};
}

// Simplify with identities early and late (expand.c); the smaller result is taken.
static struct attempt attempt_both(struct ct_exs *x, ct_ex e,
                                   const struct ct_collect_options *options)
{
    struct ct_arena *arena = scratch_of(x, options);
    const struct attempt late = attempt(x, e, options, false);
    if (!late.has_angles)
        return late;
    const struct attempt early = attempt(x, e, options, true);
    return ct_ex_tree_size(x, arena, early.e) < ct_ex_tree_size(x, arena, late.e) ? early
                                                                                  : late;
}

// ---- linear forms -----------------------------------------------------------------------------

static bool contains(struct ct_exs *x, ct_ex e, const ct_ex *s, size_t n)
{
    const size_t below = ct_ex_walk(x, &e, 1);
    for (size_t k = 0; k < below; k++)
        for (size_t i = 0; i < n; i++)
            if (x->stack[k] == s[i].id)
                return true;
    return false;
}

// e = sum of coefficient[k] s[k] + rest by derivatives. False if e is not linear in s; nothing is
// then set.
static bool linear_by_derivatives(struct ct_exs *x, ct_ex e, const ct_ex *s, size_t n,
                                  ct_ex *coefficient, ct_ex *rest,
                                  const struct ct_collect_options *options)
{
    struct ct_arena *arena = scratch_of(x, options);
    ct_ex *found = CT_NEWN(arena, ct_ex, n), *zero = CT_NEWN(arena, ct_ex, n);
    for (size_t k = 0; k < n; k++) {
        found[k] = attempt_both(x, ct_ex_diff(x, e, s[k]), options).e;
        if (contains(x, found[k], s, n))
            return false;
    }
    if (n)
        memcpy(coefficient, found, n * sizeof *found);
    *rest = attempt_both(x, ct_ex_subst(x, e, s, zero, n), options)
                .e; // zero: all elements are node 0
    return true;
}

// ---- the entry for all --------------------------------------------------------------------------

// Symbols of one kind below e.
static size_t list_symbols(struct ct_exs *x, struct ct_arena *arena, ct_ex e,
                           enum ct_sym_kind kind, ct_ex **list)
{
    const size_t n = ct_ex_walk(x, &e, 1);
    size_t found = 0;
    *list = CT_NEWN(arena, ct_ex, x->nsym);
    for (size_t k = 0; k < n; k++) {
        const struct ct_sym *s = ct_ex_symbol(x, (ct_ex){x->stack[k]});
        if (s && s->kind == kind)
            (*list)[found++] = (ct_ex){x->stack[k]};
    }
    return found;
}

// Linear form in the accelerations of an equation too long to be expanded; e itself if it is not
// linear.
static ct_ex collect_equation(struct ct_exs *x, struct ct_arena *arena, ct_ex e,
                              const struct ct_collect_options *options)
{
    ct_ex *s, sum;
    const size_t n = list_symbols(x, arena, e, CT_SYM_A, &s);
    ct_ex *coefficient = CT_NEWN(arena, ct_ex, n);
    if (!n || !linear_by_derivatives(x, e, s, n, coefficient, &sum, options))
        return e;
    for (size_t k = 0; k < n; k++)
        sum = ct_ex_add(x, sum, ct_ex_mul(x, coefficient[k], s[k]));
    return sum;
}

ct_ex ct_ex_collect(struct ct_exs *x, ct_ex e, const struct ct_collect_options *options)
{
    struct ct_arena *arena = scratch_of(x, options);
    const struct attempt a = attempt_both(x, e, options);
    if (!a.bundled)
        return a.e;
    const ct_ex equation = collect_equation(x, arena, e, options);
    return ct_ex_tree_size(x, arena, equation) < ct_ex_tree_size(x, arena, e) ? equation : a.e;
}
