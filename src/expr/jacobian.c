// Sparse symbolic Jacobians in forward mode. One walk computes for each node the list of its
// derivatives.
//
//     node  ->  [ (direction, derivative), ... ]      ascending directions, zeros left out
//
// The list of a node is the merge of its arguments' lists by the chain rule. A node thus costs as
// much as the number of its directions: about n^2 / 2 in all for a chain of n links. A sum whose
// longer list no other node reads takes that list and adds the shorter one, so that a sum of n
// terms costs what the terms have. Equal derivatives are one node of the store. The memory of
// lists that no later node reads is reused. Source: Griewank and Walther (2008), 7.1, key
// griewank2008.
#include "expr/seed.h"

#include <string.h>

struct tangent {
    uint32_t direction;
    ct_ex value;
};

// A node's list: `n` tangents in a block with room for `cap`.
struct list {
    struct tangent *at;
    uint32_t n, cap;
};

enum { NLEVEL = 32 }; // Definition: sizes of blocks, 2^0 to 2^31 tangents

struct walk {
    struct ct_exs *x;
    struct ct_arena *scratch;
    struct tangent *made; // the list that is being made
    size_t nmade, made_cap;
    uint32_t *place;   // by id: index in the walk, plus one
    struct list *list; // by index: derivatives that its users read (the seeds, if it has any)
    struct list *own;  // by index: derivatives that follow from its arguments; may be the same
    uint32_t *nuse;    // by index: readers of its list to come, entries of f included
    struct tangent *spare[NLEVEL]; // blocks by level, each begins with a pointer to the next
};

// ---- lists ------------------------------------------------------------------------------------

static int level_of(size_t n)
{
    int level = 0;
    while ((size_t)1 << level < n)
        level++;
    return level;
}

static struct list list_create(struct walk *w, size_t n)
{
    const int level = level_of(n);
    struct list l = {w->spare[level], 0, (uint32_t)1 << level};
    if (!n)
        return (struct list){0};
    if (l.at)
        memcpy(&w->spare[level], l.at, sizeof l.at);
    else
        l.at = CT_NEWN(w->scratch, struct tangent, l.cap);
    return l;
}

static void list_destroy(struct walk *w, struct list *l)
{
    const int level = level_of(l->cap);
    if (l->cap) {
        memcpy(l->at, &w->spare[level], sizeof l->at);
        w->spare[level] = l->at;
    }
    *l = (struct list){0};
}

static void push(struct walk *w, uint32_t direction, ct_ex value)
{
    const struct tangent t = {direction, value};
    if (!ct_ex_is_zero(value))
        CT_PUSH(w->scratch, w->made, w->nmade, w->made_cap, t);
}

// What was pushed, as a list.
static struct list take_made(struct walk *w)
{
    struct list l = list_create(w, w->nmade);
    l.n = (uint32_t)w->nmade;
    if (l.n)
        memcpy(l.at, w->made, l.n * sizeof *l.at);
    w->nmade = 0;
    return l;
}

// Index of the first tangent from that direction on.
static size_t find_direction(const struct list *l, uint32_t direction)
{
    size_t low = 0, high = l->n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (l->at[middle].direction < direction)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

// Insert what was pushed, whose directions the list lacks.
static void insert_made(struct walk *w, struct list *l)
{
    const size_t n = l->n + w->nmade;
    if (n > l->cap) {
        struct list larger = list_create(w, n);
        memcpy(larger.at, l->at, l->n * sizeof *l->at);
        larger.n = l->n;
        list_destroy(w, l);
        *l = larger;
    }
    while (w->nmade) { // from the last one on: what follows it moves to its final place
        const struct tangent t = w->made[--w->nmade];
        const size_t at = find_direction(l, t.direction);
        struct tangent *to = l->at + at + w->nmade;
        memmove(to + 1, l->at + at, (l->n - at) * sizeof *to);
        *to = t;
        l->n = (uint32_t)at;
    }
    l->n = (uint32_t)n;
}

static void remove_zeros(struct list *l)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < l->n; k++)
        if (!ct_ex_is_zero(l->at[k].value))
            l->at[n++] = l->at[k];
    l->n = n;
}

// ---- nodes ------------------------------------------------------------------------------------

static struct list *list_of(const struct walk *w, uint32_t id)
{
    return &w->list[w->place[id] - 1];
}

// Set the list of a node from its sorted seeds. False if it has none.
static bool seed_node(struct walk *w, uint32_t id, const struct ct_seed *seed, size_t nseed)
{
    size_t k = ct_seeds_find(seed, nseed, id);
    const bool any = k < nseed && seed[k].symbol.id == id;
    for (; k < nseed && seed[k].symbol.id == id; k++)
        push(w, seed[k].direction, seed[k].value);
    return any;
}

// The derivatives of a node's arguments in one direction -> the derivative of the node.
static ct_ex combine(struct ct_exs *x, uint32_t id, const ct_ex *partial, const ct_ex *d,
                     int narg)
{
    const struct ct_exnode n = x->node[id];
    if (n.op == CT_OP_IF) // one `if` for all branches, however deep the derivative
        return ct_ex_if(x, (ct_ex){n.a}, d[1], d[2]);
    if (n.op == CT_OP_DIV) // (a' - (a/b) b') / b
        return ct_ex_div(x, ct_ex_sub(x, d[0], ct_ex_mul(x, (ct_ex){id}, d[1])), (ct_ex){n.b});
    ct_ex sum = CT_EX_ZERO;
    for (int i = 0; i < narg; i++)
        if (!ct_ex_is_zero(d[i]))
            sum = ct_ex_add(x, sum, ct_ex_mul(x, partial[i], d[i]));
    return sum;
}

// Merge the lists of a node's arguments.
static void chain(struct walk *w, uint32_t id)
{
    const struct ct_exnode n = w->x->node[id];
    const uint32_t arg[3] = {n.a, n.b, n.c};
    const int narg = ct_op_info[n.op].narg;
    struct list l[3] = {{0}};
    ct_ex partial[3] = {{0}};
    for (int i = 0; i < narg; i++) {
        l[i] = *list_of(w, arg[i]);
        if (l[i].n)
            partial[i] = ct_ex_partial(w->x, id, i);
    }
    for (;;) {
        uint32_t least = UINT32_MAX;
        for (int i = 0; i < narg; i++)
            if (l[i].n && l[i].at->direction < least)
                least = l[i].at->direction;
        if (least == UINT32_MAX)
            return;
        ct_ex d[3] = {{0}};
        for (int i = 0; i < narg; i++)
            if (l[i].n && l[i].at->direction == least) {
                d[i] = l[i].at++->value;
                l[i].n--;
            }
        push(w, least, combine(w->x, id, partial, d, narg));
    }
}

// The list of a sum or difference (out) from the longer list of its arguments, of which no other
// node is a reader. False if it is none, or if there are other readers.
static bool sum_in_place(struct walk *w, uint32_t id, struct list *out)
{
    const struct ct_exnode n = w->x->node[id];
    if (n.op != CT_OP_ADD && n.op != CT_OP_SUB)
        return false;
    const bool is_second = n.op == CT_OP_ADD && list_of(w, n.b)->n > list_of(w, n.a)->n;
    const uint32_t taken = is_second ? n.b : n.a;
    const struct list added = *list_of(w, is_second ? n.a : n.b);
    struct list *l = list_of(w, taken), *own = &w->own[w->place[taken] - 1];
    if (w->nuse[w->place[taken] - 1] > 1 || added.n > l->n)
        return false;
    const ct_ex partial[3] = {CT_EX_ONE, added.n ? ct_ex_partial(w->x, id, 1) : CT_EX_ONE};
    bool has_zeros = false;
    for (uint32_t k = 0; k < added.n; k++) {
        const struct tangent t = added.at[k];
        const size_t at = find_direction(l, t.direction);
        const bool is_both = at < l->n && l->at[at].direction == t.direction;
        ct_ex d[3] = {{0}};
        d[!is_second] = t.value;
        d[is_second] = is_both ? l->at[at].value : CT_EX_ZERO;
        const ct_ex value = combine(w->x, id, partial, d, 2);
        if (is_both)
            l->at[at].value = value;
        else
            push(w, t.direction, value);
        has_zeros |= ct_ex_is_zero(value);
    }
    if (own->at == l->at)
        *own = (struct list){0};
    if (has_zeros)
        remove_zeros(l);
    insert_made(w, l);
    *out = *l;
    *l = (struct list){0};
    return true;
}

// Both lists of place k.
static void list_node(struct walk *w, size_t k, uint32_t id, const struct ct_seed *seed,
                      size_t nseed)
{
    const bool is_symbol = w->x->node[id].op == CT_OP_SYM;
    if (!is_symbol && !sum_in_place(w, id, &w->own[k])) {
        chain(w, id);
        w->own[k] = take_made(w);
    }
    w->list[k] = w->own[k];
    if (!seed_node(w, id, seed, nseed))
        return;
    w->list[k] = take_made(w);
    if (is_symbol)
        w->own[k] = w->list[k];
}

static void count_uses(struct walk *w, const uint32_t *id, size_t n, const ct_ex *f, size_t nf)
{
    for (size_t k = 0; k < n; k++)
        w->place[id[k]] = (uint32_t)k + 1;
    for (size_t k = 0; k < n; k++) {
        const struct ct_exnode *e = &w->x->node[id[k]];
        const uint32_t arg[3] = {e->a, e->b, e->c};
        for (int i = 0; i < ct_op_info[e->op].narg; i++)
            w->nuse[w->place[arg[i]] - 1]++;
    }
    for (size_t r = 0; r < nf; r++)
        w->nuse[w->place[f[r].id] - 1]++;
}

static void read_arguments(struct walk *w, uint32_t id)
{
    const struct ct_exnode *e = &w->x->node[id];
    const uint32_t arg[3] = {e->a, e->b, e->c};
    for (int i = 0; i < ct_op_info[e->op].narg; i++) {
        const uint32_t k = w->place[arg[i]] - 1;
        if (--w->nuse[k])
            continue;
        if (w->own[k].at != w->list[k].at)
            list_destroy(w, &w->own[k]);
        list_destroy(w, &w->list[k]);
    }
}

size_t ct_ex_jacobian(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                      const ct_ex *f, size_t nf, const struct ct_seed *seeds, size_t nseed,
                      struct ct_slope **out)
{
    struct walk w = {.x = x, .scratch = scratch};
    const size_t n = ct_ex_walk(x, f, nf);
    uint32_t *id = CT_NEWN(scratch, uint32_t, n + 1), most = 0;
    memcpy(id, x->stack, n * sizeof *id); // a copy: building derivatives may start another walk
    for (size_t k = 0; k < n; k++)
        most = id[k] > most ? id[k] : most;
    w.place = CT_NEWN(scratch, uint32_t, (size_t)most + 1);
    w.list = CT_NEWN(scratch, struct list, n + 1);
    w.own = CT_NEWN(scratch, struct list, n + 1);
    w.nuse = CT_NEWN(scratch, uint32_t, n + 1);
    count_uses(&w, id, n, f, nf);
    const struct ct_seed *seed = ct_seeds_sorted(scratch, seeds, nseed);
    for (size_t k = 0; k < n; k++) {
        list_node(&w, k, id[k], seed, nseed);
        read_arguments(&w, id[k]);
    }
    size_t nout = 0, cap = 0;
    *out = NULL;
    for (size_t r = 0; r < nf; r++) {
        const struct list l = w.own[w.place[f[r].id] - 1];
        for (uint32_t k = 0; k < l.n; k++) {
            const struct ct_slope s = {(uint32_t)r, l.at[k].direction, l.at[k].value};
            CT_PUSH(a, *out, nout, cap, s);
        }
    }
    return nout;
}
