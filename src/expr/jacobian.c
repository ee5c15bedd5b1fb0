// Sparse symbolic Jacobians in forward mode. One walk computes for each node the list of its
// derivatives.
//
//     node  ->  [ (direction, derivative), ... ]      ascending directions, zeros left out
//
// The list of a node is the merge of its arguments' lists by the chain rule. A node thus costs as
// much as the number of its directions: about n^2 / 2 in all for a chain of n links. Equal
// derivatives are one node of the store. The memory of lists that no later node reads, such as
// those of partial sums, is reused. Source: Griewank and Walther (2008), 7.1, key griewank2008.
#include "expr/seed.h"

#include <string.h>

struct tangent {
    uint32_t direction;
    ct_ex value;
};

// A node's list: `n` tangents from `first` on.
struct list {
    size_t first, n;
};

struct walk {
    struct ct_exs *x;
    struct ct_arena *scratch;
    struct tangent *tangent;
    size_t ntangent, cap;
    uint32_t *place;   // by id: index in the walk, plus one
    struct list *list; // by index: derivatives that its users read (the seeds, if it has any)
    struct list *own;  // by index: derivatives that follow from its arguments
    uint32_t *nuse;    // by index: readers of its list, entries of f included
    size_t full;       // number of tangents beyond which unread lists are removed
};

static void push(struct walk *w, uint32_t direction, ct_ex value)
{
    const struct tangent t = {direction, value};
    if (!ct_ex_is_zero(value))
        CT_PUSH(w->scratch, w->tangent, w->ntangent, w->cap, t);
}

static struct list list_of(const struct walk *w, uint32_t id)
{
    return w->list[w->place[id] - 1];
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
        l[i] = list_of(w, arg[i]);
        if (l[i].n)
            partial[i] = ct_ex_partial(w->x, id, i);
    }
    for (;;) {
        uint32_t least = UINT32_MAX;
        for (int i = 0; i < narg; i++)
            if (l[i].n && w->tangent[l[i].first].direction < least)
                least = w->tangent[l[i].first].direction;
        if (least == UINT32_MAX)
            return;
        ct_ex d[3] = {{0}};
        for (int i = 0; i < narg; i++)
            if (l[i].n && w->tangent[l[i].first].direction == least) {
                d[i] = w->tangent[l[i].first++].value;
                l[i].n--;
            }
        push(w, least, combine(w->x, id, partial, d, narg));
    }
}

// Both lists of place k.
static void list_node(struct walk *w, size_t k, uint32_t id, const struct ct_seed *seed,
                      size_t nseed)
{
    const size_t first = w->ntangent;
    if (w->x->node[id].op != CT_OP_SYM)
        chain(w, id);
    const size_t then = w->ntangent;
    w->own[k] = w->list[k] = (struct list){first, then - first};
    if (!seed_node(w, id, seed, nseed))
        return;
    w->list[k] = (struct list){then, w->ntangent - then};
    if (w->x->node[id].op == CT_OP_SYM)
        w->own[k] = w->list[k];
}

static void move(struct walk *w, struct list *l, size_t *to)
{
    memmove(w->tangent + *to, w->tangent + l->first, l->n * sizeof *w->tangent);
    l->first = *to;
    *to += l->n;
}

// Remove unread lists. Lists are stored in the order of the walk, so those in use only move
// forward.
static void remove_unread(struct walk *w, size_t nplace)
{
    size_t to = 0;
    for (size_t k = 0; k < nplace; k++) {
        struct list *own = &w->own[k], *seen = &w->list[k];
        const bool is_one = own->first == seen->first && own->n == seen->n;
        if (!w->nuse[k])
            own->n = seen->n = 0;
        move(w, own, &to);
        if (is_one)
            *seen = *own;
        else
            move(w, seen, &to);
    }
    w->ntangent = to;
    w->full = w->full > 2 * to ? w->full : 2 * to;
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
    for (int i = 0; i < ct_op_info[e->op].narg; i++)
        w->nuse[w->place[arg[i]] - 1]--;
}

size_t ct_ex_jacobian(struct ct_exs *x, struct ct_arena *scratch, struct ct_arena *a,
                      const ct_ex *f, size_t nf, const struct ct_seed *seeds, size_t nseed,
                      struct ct_slope **out)
{
    const size_t least_full = 1 << 16; // Limit: of memory
    struct walk w = {.x = x, .scratch = scratch, .full = least_full};
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
        if (w.ntangent >= w.full)
            remove_unread(&w, k);
        list_node(&w, k, id[k], seed, nseed);
        read_arguments(&w, id[k]);
    }
    size_t nout = 0, cap = 0;
    *out = NULL;
    for (size_t r = 0; r < nf; r++) {
        const struct list l = w.own[w.place[f[r].id] - 1];
        for (size_t k = l.first; k < l.first + l.n; k++) {
            const struct ct_slope s = {(uint32_t)r, w.tangent[k].direction, w.tangent[k].value};
            CT_PUSH(a, *out, nout, cap, s);
        }
    }
    return nout;
}
