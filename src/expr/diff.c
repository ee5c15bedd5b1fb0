// Walks over the graph: derivatives, substitution, copies between stores.
//
// Derivatives are in forward mode (by one symbol or one direction) and in reverse mode (gradient).
// Each walk lists the nodes below its roots in topological order and computes one result per node.
// Stacks are explicit, because expressions may be deep.
#include "expr/ex.h"

#include <assert.h>
#include <string.h>

static void reserve_walk(struct ct_exs *x)
{
    if (x->walk_cap >= x->nnode)
        return;
    struct ct_arena *a = x->arena;
    const size_t old = x->walk_cap, cap = x->node_cap ? x->node_cap : x->nnode;
    x->stamp = ct_arena_resize(a, x->stamp, old, old, cap, sizeof *x->stamp);
    x->memo = ct_arena_resize(a, x->memo, 0, old, cap, sizeof *x->memo);
    x->stack = ct_arena_resize(a, x->stack, 0, old, cap, 2 * sizeof *x->stack);
    x->walk_cap = cap;
}

static const unsigned all_nodes = ~0u; // constants have no kinds

static bool is_walked(const struct ct_exs *x, uint32_t id, unsigned kinds)
{
    return kinds == all_nodes || x->kinds[id] & kinds;
}

// A node without symbols of these kinds has none below it either.
size_t ct_ex_walk_kinds(struct ct_exs *x, const ct_ex *root, size_t n, unsigned kinds)
{
    reserve_walk(x);
    x->generation++;
    uint32_t *list = x->stack,
             *pending = x->stack + x->walk_cap; // the stack of pending nodes follows the list
    size_t nlist = 0;
    for (size_t r = 0; r < n; r++) {
        size_t npending = 0;
        if (x->stamp[root[r].id] == x->generation || !is_walked(x, root[r].id, kinds))
            continue;
        pending[npending++] = root[r].id;
        while (npending) {
            const uint32_t id = pending[npending - 1];
            const struct ct_exnode *e = &x->node[id];
            const uint32_t arg[3] = {e->a, e->b, e->c};
            bool ready = true;
            for (int i = 0; ready && i < ct_op_info[e->op].narg; i++)
                if (x->stamp[arg[i]] != x->generation && is_walked(x, arg[i], kinds)) {
                    pending[npending++] = arg[i]; // a path: never longer than the walk
                    ready = false;
                }
            if (ready) {
                x->stamp[id] = x->generation;
                list[nlist++] = id;
                npending--;
            }
        }
    }
    return nlist;
}

size_t ct_ex_walk(struct ct_exs *x, const ct_ex *root, size_t n)
{
    return ct_ex_walk_kinds(x, root, n, all_nodes);
}

static unsigned kinds_of(const struct ct_exs *x, const ct_ex *s, size_t n)
{
    unsigned kinds = 0;
    for (size_t i = 0; i < n; i++)
        kinds |= ct_ex_kinds(x, s[i]);
    return kinds;
}

ct_ex ct_ex_partial(struct ct_exs *x, uint32_t id, int i)
{
    const struct ct_exnode n = x->node[id];
    const ct_ex e = {id}, a = {n.a}, b = {n.b};
    const ct_ex one = CT_EX_ONE;
    switch ((enum ct_op)n.op) {
    case CT_OP_ADD:
        return one;
    case CT_OP_SUB:
        return i ? ct_ex_neg(x, one) : one;
    case CT_OP_NEG:
        return ct_ex_neg(x, one);
    case CT_OP_MUL:
        return i ? a : b;
    case CT_OP_DIV: // a/b: 1/b, -(a/b)/b
        return i ? ct_ex_neg(x, ct_ex_div(x, e, b)) : ct_ex_div(x, one, b);
    case CT_OP_POW: // b a^(b-1), a^b log a
        return i ? ct_ex_mul(x, e, ct_ex_fun(x, CT_OP_LOG, a))
                 : ct_ex_mul(x, b, ct_ex_pow(x, a, ct_ex_sub(x, b, one)));
    case CT_OP_SQRT:
        return ct_ex_div(x, ct_ex_const(x, 0.5), e);
    case CT_OP_SIN:
        return ct_ex_fun(x, CT_OP_COS, a);
    case CT_OP_COS:
        return ct_ex_neg(x, ct_ex_fun(x, CT_OP_SIN, a));
    case CT_OP_TAN:
        return ct_ex_add(x, one, ct_ex_mul(x, e, e));
    case CT_OP_ASIN:
        return ct_ex_div(x, one,
                         ct_ex_fun(x, CT_OP_SQRT, ct_ex_sub(x, one, ct_ex_mul(x, a, a))));
    case CT_OP_ACOS:
        return ct_ex_neg(
            x,
            ct_ex_div(x, one, ct_ex_fun(x, CT_OP_SQRT, ct_ex_sub(x, one, ct_ex_mul(x, a, a)))));
    case CT_OP_ATAN:
        return ct_ex_div(x, one, ct_ex_add(x, one, ct_ex_mul(x, a, a)));
    case CT_OP_ATAN2: { // atan2(a, b): b/(a^2 + b^2), -a/(a^2 + b^2)
        const ct_ex s = ct_ex_add(x, ct_ex_mul(x, a, a), ct_ex_mul(x, b, b));
        return i ? ct_ex_neg(x, ct_ex_div(x, a, s)) : ct_ex_div(x, b, s);
    }
    case CT_OP_SINH:
        return ct_ex_fun(x, CT_OP_COSH, a);
    case CT_OP_COSH:
        return ct_ex_fun(x, CT_OP_SINH, a);
    case CT_OP_TANH:
        return ct_ex_sub(x, one, ct_ex_mul(x, e, e));
    case CT_OP_EXP:
        return e;
    case CT_OP_LOG:
        return ct_ex_div(x, one, a);
    case CT_OP_ABS:
        return ct_ex_fun(x, CT_OP_SIGN, a);
    case CT_OP_MIN: // derivative of the smaller argument; of the second if both are equal
        return i ? ct_ex_if(x, ct_ex_fun2(x, CT_OP_LT, a, b), CT_EX_ZERO, one)
                 : ct_ex_if(x, ct_ex_fun2(x, CT_OP_LT, a, b), one, CT_EX_ZERO);
    case CT_OP_MAX:
        return i ? ct_ex_if(x, ct_ex_fun2(x, CT_OP_GT, a, b), CT_EX_ZERO, one)
                 : ct_ex_if(x, ct_ex_fun2(x, CT_OP_GT, a, b), one, CT_EX_ZERO);
    case CT_OP_IF: // branch by branch; the condition has no derivative
        if (i == 0)
            return CT_EX_ZERO;
        return i == 1 ? ct_ex_if(x, a, one, CT_EX_ZERO) : ct_ex_if(x, a, CT_EX_ZERO, one);
    case CT_OP_TABLE:
        return ct_ex_table(x, n.b, n.c + 1, a);
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
    return CT_EX_ZERO;
}

// One chain-rule step; `d` holds the derivatives of smaller ids.
static ct_ex chain(struct ct_exs *x, uint32_t id, const ct_ex *d)
{
    const struct ct_exnode n = x->node[id];
    const uint32_t arg[3] = {n.a, n.b, n.c};
    const ct_ex a = {n.a}, b = {n.b};
    if (n.op == CT_OP_IF) // one `if` for all branches, however deep the derivative
        return ct_ex_if(x, a, d[n.b], d[n.c]);
    if (n.op == CT_OP_DIV) { // (a' - (a/b) b') / b
        const ct_ex da = d[n.a], db = d[n.b];
        return ct_ex_div(x, ct_ex_sub(x, da, ct_ex_mul(x, (ct_ex){id}, db)), b);
    }
    ct_ex sum = CT_EX_ZERO;
    for (int i = 0; i < ct_op_info[n.op].narg; i++) {
        const ct_ex da = d[arg[i]];
        if (!ct_ex_is_zero(da))
            sum = ct_ex_add(x, sum, ct_ex_mul(x, ct_ex_partial(x, id, i), da));
    }
    return sum;
}

// Over the n nodes of the last walk, which went below e by the kinds of s.
static ct_ex sweep(struct ct_exs *x, size_t n, ct_ex e, const ct_ex *s, const ct_ex *ds,
                   size_t ns)
{
    const unsigned kinds = kinds_of(x, s, ns);
    const uint32_t *list = x->stack;
    ct_ex *d = x->memo; // by id; no further walk starts below
    for (size_t k = 0; k < n; k++) {
        const struct ct_exnode node = x->node[list[k]];
        const uint32_t arg[3] = {node.a, node.b, node.c};
        for (int i = 0; i < ct_op_info[node.op].narg; i++)
            if (!is_walked(x, arg[i], kinds))
                d[arg[i]] = CT_EX_ZERO;
        if (node.op == CT_OP_SYM) {
            d[list[k]] = CT_EX_ZERO;
            for (size_t i = 0; i < ns; i++)
                if (s[i].id == list[k])
                    d[list[k]] = ds[i];
        } else {
            d[list[k]] = chain(x, list[k], d);
        }
    }
    return n ? d[e.id] : CT_EX_ZERO;
}

ct_ex ct_ex_diff_along(struct ct_exs *x, ct_ex e, const ct_ex *s, const ct_ex *ds, size_t ns)
{
    return sweep(x, ct_ex_walk_kinds(x, &e, 1, kinds_of(x, s, ns)), e, s, ds, ns);
}

ct_ex ct_ex_diff_walked(struct ct_exs *x, size_t n, ct_ex a, ct_ex s)
{
    const ct_ex one = CT_EX_ONE;
    return sweep(x, n, a, &s, &one, 1);
}

ct_ex ct_ex_diff(struct ct_exs *x, ct_ex a, ct_ex s)
{
    const ct_ex one = CT_EX_ONE;
    return ct_ex_diff_along(x, a, &s, &one, 1);
}

// Contribution of a node to the adjoint of its i-th argument: its own adjoint `bar` times the
// partial derivative.
static ct_ex pass_down(struct ct_exs *x, uint32_t id, int i, ct_ex bar)
{
    const struct ct_exnode n = x->node[id];
    if (n.op != CT_OP_IF)
        return ct_ex_mul(x, bar, ct_ex_partial(x, id, i));
    return i == 0
             ? CT_EX_ZERO
             : ct_ex_if(x, (ct_ex){n.a}, i == 1 ? bar : CT_EX_ZERO, i == 2 ? bar : CT_EX_ZERO);
}

// Reverse mode: users before operands. Source: Griewank and Walther (2008), 3.2, key griewank2008.
void ct_ex_gradient(struct ct_exs *x, struct ct_arena *scratch, ct_ex a, const ct_ex *s,
                    size_t n, ct_ex *out)
{
    const size_t nnode = ct_ex_walk(x, &a, 1);
    uint32_t *list = CT_NEWN(scratch, uint32_t,
                             nnode + 1); // a copy: building derivatives may start another walk
    memcpy(list, x->stack, nnode * sizeof *list);
    bool *counts = CT_NEWN(scratch, bool, x->nnode); // by id: depends on a symbol
    ct_ex *bar = CT_NEWN(scratch, ct_ex, x->nnode);  // by id
    for (size_t i = 0; i < n; i++)
        counts[s[i].id] = true;
    for (size_t k = 0; k < nnode; k++) {
        const struct ct_exnode *node = &x->node[list[k]];
        const uint32_t arg[3] = {node->a, node->b, node->c};
        for (int i = 0; node->op != CT_OP_SYM && i < ct_op_info[node->op].narg; i++)
            counts[list[k]] |= counts[arg[i]];
    }
    bar[a.id] = CT_EX_ONE;
    for (size_t k = nnode; k-- > 0;) {
        const uint32_t id = list[k];
        const struct ct_exnode node = x->node[id];
        const uint32_t arg[3] = {node.a, node.b, node.c};
        if (!counts[id] || node.op == CT_OP_SYM || ct_ex_is_zero(bar[id]))
            continue;
        for (int i = 0; i < ct_op_info[node.op].narg; i++)
            if (counts[arg[i]])
                bar[arg[i]] = ct_ex_add(x, bar[arg[i]], pass_down(x, id, i, bar[id]));
    }
    for (size_t i = 0; i < n; i++)
        out[i] = bar[s[i].id];
}

// Through the public constructors, so that the local rules apply.
ct_ex ct_ex_rebuild(struct ct_exs *x, struct ct_exnode n, const ct_ex *image)
{
    const enum ct_op op = (enum ct_op)n.op;
    if (op == CT_OP_IF)
        return ct_ex_if(x, image[n.a], image[n.b], image[n.c]);
    if (op == CT_OP_TABLE)
        return ct_ex_table(x, n.b, n.c, image[n.a]);
    return ct_op_info[op].narg == 1 ? ct_ex_fun(x, op, image[n.a])
                                    : ct_ex_fun2(x, op, image[n.a], image[n.b]);
}

// What has none of the kinds stays as it is.
static void subst(struct ct_exs *x, ct_ex *a, size_t na, const ct_ex *from, const ct_ex *to,
                  size_t ns, unsigned kinds)
{
    const size_t n = ct_ex_walk_kinds(x, a, na, kinds);
    const uint32_t *list = x->stack;
    ct_ex *image = x->memo; // by id; no further walk starts below
    for (size_t k = 0; k < n; k++) {
        const struct ct_exnode node = x->node[list[k]];
        const uint32_t arg[3] = {node.a, node.b, node.c};
        for (int i = 0; i < ct_op_info[node.op].narg; i++)
            if (!is_walked(x, arg[i], kinds))
                image[arg[i]] = (ct_ex){arg[i]};
        image[list[k]] = (ct_ex){list[k]};
        if (node.op == CT_OP_SYM) {
            for (size_t i = 0; i < ns; i++)
                if (from[i].id == list[k])
                    image[list[k]] = to[i];
        } else if (ct_op_info[node.op].narg) {
            image[list[k]] = ct_ex_rebuild(x, node, image);
        }
    }
    for (size_t k = 0; k < na; k++)
        if (is_walked(x, a[k].id, kinds))
            a[k] = image[a[k].id];
}

ct_ex ct_ex_subst(struct ct_exs *x, ct_ex e, const ct_ex *from, const ct_ex *to, size_t ns)
{
    subst(x, &e, 1, from, to, ns, all_nodes);
    return e;
}

void ct_ex_subst_list(struct ct_exs *x, ct_ex *a, size_t na, const ct_ex *from, const ct_ex *to,
                      size_t ns)
{
    subst(x, a, na, from, to, ns, all_nodes);
}

ct_ex ct_ex_subst_within(struct ct_exs *x, ct_ex e, const ct_ex *from, const ct_ex *to,
                         size_t ns)
{
    subst(x, &e, 1, from, to, ns, kinds_of(x, from, ns));
    return e;
}
