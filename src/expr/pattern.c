// Sparsity pattern of a Jacobian by propagation of bit sets, 64 directions at a time.
//
//     bits(node) = OR of bits(arguments)          a superset: what cancels is not seen
//
// The same walk counts what a Jacobian by ct_ex_jacobian would take.
// Source: Griewank and Walther (2008), 7.1, key griewank2008.
#include "expr/ex.h"

#include <string.h>

enum { WIDTH = 64 }; // Definition: bits of a uint64_t

struct walk {
    const struct ct_exs *x;
    const uint32_t *id; // nodes, arguments first
    size_t n;
    uint64_t *bits; // by id: what nodes above it see
    uint64_t *own;  // by id: what follows from its arguments
    bool *is_inner; // by id: has seeds, but is no symbol
    double operations;
};

static int count_bits(uint64_t b)
{
    int n = 0;
    for (; b; b &= b - 1)
        n++;
    return n;
}

// Operations of one node's derivatives: f_a da + f_b db where both arguments depend on a direction.
static double operations_of(enum ct_op op, uint64_t a, uint64_t b)
{
    const double one = count_bits(a ^ b), both = count_bits(a & b);
    switch (op) {
    case CT_OP_NEG:
        return 0;
    case CT_OP_ADD:
    case CT_OP_SUB:
        return both;
    case CT_OP_DIV:
        return 2 * one + 3 * both;
    default:
        return one + 3 * both;
    }
}

static void seed_bits(struct walk *w, const struct ct_seed *seed, size_t nseed, uint32_t first)
{
    for (size_t k = 0; k < nseed; k++)
        if (seed[k].direction >= first && seed[k].direction - first < WIDTH)
            w->bits[seed[k].symbol.id] |= UINT64_C(1) << (seed[k].direction - first);
}

static void unite(struct walk *w)
{
    for (size_t k = 0; k < w->n; k++) {
        const struct ct_exnode *n = &w->x->node[w->id[k]];
        if (n->op == CT_OP_SYM || n->op == CT_OP_CONST) {
            w->own[w->id[k]] = w->bits[w->id[k]];
            continue;
        }
        const int narg = ct_op_info[n->op].narg;
        const bool is_if = n->op == CT_OP_IF; // its condition has no derivative
        const uint64_t a = w->bits[is_if ? n->b : n->a], b = is_if    ? w->bits[n->c]
                                                           : narg > 1 ? w->bits[n->b]
                                                                      : 0;
        w->own[w->id[k]] = a | b;
        if (!w->is_inner[w->id[k]])
            w->bits[w->id[k]] = a | b;
        w->operations += operations_of((enum ct_op)n->op, a, b);
    }
}

static void clear(struct walk *w, const struct ct_seed *seed, size_t nseed)
{
    for (size_t k = 0; k < w->n; k++)
        w->bits[w->id[k]] = 0;
    for (size_t k = 0; k < nseed; k++)
        w->bits[seed[k].symbol.id] = 0;
}

size_t ct_ex_pattern(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                     const ct_ex *f, size_t nf, const struct ct_seed *seed, size_t nseed,
                     uint32_t ndirection, struct ct_slope **out, double *operations)
{
    const size_t n = ct_ex_walk(x, f, nf), nblock = (ndirection + WIDTH - 1) / WIDTH;
    uint64_t *found = CT_NEWN(scratch, uint64_t, nf * nblock + 1);
    struct walk w = {.x = x,
                     .id = x->stack,
                     .n = n,
                     .bits = CT_NEWN(scratch, uint64_t, x->nnode),
                     .own = CT_NEWN(scratch, uint64_t, x->nnode),
                     .is_inner = CT_NEWN(scratch, bool, x->nnode)};
    for (size_t k = 0; k < nseed; k++)
        w.is_inner[seed[k].symbol.id] = x->node[seed[k].symbol.id].op != CT_OP_SYM;
    for (size_t i = 0; i < nblock; i++) {
        clear(&w, seed, nseed);
        seed_bits(&w, seed, nseed, (uint32_t)(WIDTH * i));
        unite(&w);
        for (size_t r = 0; r < nf; r++)
            found[nblock * r + i] = w.own[f[r].id];
    }
    size_t nout = 0, cap = 0;
    *out = NULL;
    for (size_t r = 0; r < nf; r++)
        for (uint32_t d = 0; d < ndirection; d++)
            if (found[nblock * r + d / WIDTH] >> d % WIDTH & 1) {
                const struct ct_slope s = {(uint32_t)r, d, CT_EX_ZERO};
                CT_PUSH(a, *out, nout, cap, s);
            }
    *operations = w.operations;
    return nout;
}
