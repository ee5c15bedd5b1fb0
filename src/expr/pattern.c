// Sparsity pattern of a Jacobian by propagation of bit sets.
//
//     bits(node) = OR of bits(arguments)          a superset: cancellation is not detected
//
// A set is a list of its nonzero words of 64 directions. A node that adds no direction to those of
// one argument shares the list of that argument. Time and memory are thus proportional to the
// entries of all lists, not to nodes times directions. The same walk counts the operations of
// ct_ex_jacobian. Source: Griewank and Walther (2008), 7.1, key griewank2008.
#include "expr/ex.h"

#include <stdlib.h>
#include <string.h>

enum { WIDTH = 64 }; // Definition: bits of a uint64_t

struct word {
    uint64_t bits;
    uint32_t block; // directions WIDTH block ... WIDTH block + WIDTH - 1
};

// The words first ... first + n - 1 of the walk, blocks in ascending order.
struct set {
    uint32_t first, n;
};

struct walk {
    const struct ct_exs *x;
    struct ct_arena *scratch;
    struct word *word;
    size_t nword, word_cap;
    struct set *seen; // by id: directions that its users see (the seeds, if it has any)
    struct set *own;  // by id: directions that follow from its arguments
    bool *is_inner;   // by id: has seeds, but is not a symbol
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

// Add a direction to the last set, which starts at `first`.
static void add_direction(struct walk *w, size_t first, uint32_t direction)
{
    const struct word one = {UINT64_C(1) << direction % WIDTH, direction / WIDTH};
    size_t i = w->nword;
    while (i > first && w->word[i - 1].block > one.block)
        i--;
    if (i > first && w->word[i - 1].block == one.block) {
        w->word[i - 1].bits |= one.bits;
        return;
    }
    CT_PUSH(w->scratch, w->word, w->nword, w->word_cap, one);
    memmove(w->word + i + 1, w->word + i, (w->nword - 1 - i) * sizeof *w->word);
    w->word[i] = one;
}

static int by_symbol(const void *p, const void *q)
{
    const struct ct_seed *a = *(const struct ct_seed *const *)p,
                         *b = *(const struct ct_seed *const *)q;
    return (a->symbol.id > b->symbol.id) - (a->symbol.id < b->symbol.id);
}

static void seed_sets(struct walk *w, const struct ct_seed *seed, size_t nseed,
                      uint32_t ndirection)
{
    const struct ct_seed **sorted = CT_NEWN(w->scratch, const struct ct_seed *, nseed + 1);
    for (size_t k = 0; k < nseed; k++)
        sorted[k] = &seed[k];
    qsort(sorted, nseed, sizeof *sorted, by_symbol);
    for (size_t k = 0; k < nseed;) {
        const uint32_t id = sorted[k]->symbol.id;
        const size_t first = w->nword;
        for (; k < nseed && sorted[k]->symbol.id == id; k++)
            if (sorted[k]->direction < ndirection)
                add_direction(w, first, sorted[k]->direction);
        w->seen[id] = (struct set){(uint32_t)first, (uint32_t)(w->nword - first)};
        w->is_inner[id] = w->x->node[id].op != CT_OP_SYM;
    }
}

static bool is_within(const struct walk *w, const struct set *a, const struct set *b)
{
    size_t j = 0;
    for (size_t i = 0; i < a->n; i++) {
        const struct word *p = &w->word[a->first + i];
        while (j < b->n && w->word[b->first + j].block < p->block)
            j++;
        if (j == b->n || w->word[b->first + j].block > p->block
            || (p->bits & ~w->word[b->first + j].bits))
            return false;
    }
    return true;
}

// Union of a and b: one of them if it contains the other, else a new set.
static struct set unite(struct walk *w, const struct set *a, const struct set *b)
{
    if (is_within(w, b, a))
        return *a;
    if (is_within(w, a, b))
        return *b;
    const size_t first = w->nword;
    for (size_t i = 0, j = 0; i < a->n || j < b->n;) {
        const struct word none = {0, UINT32_MAX}, p = i < a->n ? w->word[a->first + i] : none,
                          q = j < b->n ? w->word[b->first + j] : none;
        const struct word both
            = {(p.block <= q.block ? p.bits : 0) | (q.block <= p.block ? q.bits : 0),
               p.block < q.block ? p.block : q.block};
        i += p.block <= q.block;
        j += q.block <= p.block;
        CT_PUSH(w->scratch, w->word, w->nword, w->word_cap, both);
    }
    return (struct set){(uint32_t)first, (uint32_t)(w->nword - first)};
}

static void count_operations(struct walk *w, enum ct_op op, const struct set *a,
                             const struct set *b)
{
    for (size_t i = 0, j = 0; i < a->n || j < b->n;) {
        const uint32_t p = i < a->n ? w->word[a->first + i].block : UINT32_MAX,
                       q = j < b->n ? w->word[b->first + j].block : UINT32_MAX;
        w->operations += operations_of(op, p <= q ? w->word[a->first + i].bits : 0,
                                       q <= p ? w->word[b->first + j].bits : 0);
        i += p <= q;
        j += q <= p;
    }
}

static void visit(struct walk *w, uint32_t id)
{
    const struct ct_exnode *n = &w->x->node[id];
    static const struct set none;
    if (n->op == CT_OP_SYM || n->op == CT_OP_CONST) {
        w->own[id] = w->seen[id];
        return;
    }
    const int narg = ct_op_info[n->op].narg;
    const bool is_if = n->op == CT_OP_IF; // its condition has no derivative
    const struct set *a = &w->seen[is_if ? n->b : n->a], *b = is_if    ? &w->seen[n->c]
                                                            : narg > 1 ? &w->seen[n->b]
                                                                       : &none;
    w->own[id] = unite(w, a, b);
    count_operations(w, (enum ct_op)n->op, a, b);
    if (!w->is_inner[id])
        w->seen[id] = w->own[id];
}

size_t ct_ex_pattern(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                     const ct_ex *f, size_t nf, const struct ct_seed *seed, size_t nseed,
                     uint32_t ndirection, struct ct_slope **out, double *operations)
{
    const size_t n = ct_ex_walk(x, f, nf);
    struct walk w = {.x = x,
                     .scratch = scratch,
                     .seen = CT_NEWN(scratch, struct set, x->nnode),
                     .own = CT_NEWN(scratch, struct set, x->nnode),
                     .is_inner = CT_NEWN(scratch, bool, x->nnode)};
    seed_sets(&w, seed, nseed, ndirection);
    for (size_t k = 0; k < n; k++)
        visit(&w, x->stack[k]);
    size_t nout = 0, cap = 0;
    *out = NULL;
    for (size_t r = 0; r < nf; r++) {
        const struct set *s = &w.own[f[r].id];
        for (size_t i = s->first; i < s->first + s->n; i++)
            for (uint32_t d = 0; d < WIDTH; d++)
                if (w.word[i].bits >> d & 1) {
                    const struct ct_slope slope
                        = {(uint32_t)r, WIDTH * w.word[i].block + d, CT_EX_ZERO};
                    CT_PUSH(a, *out, nout, cap, slope);
                }
    }
    *operations = w.operations;
    return nout;
}
