// Vertex elimination; see scarcity.h.
//
// Vertices are columns, nodes in ascending order, rows of f. Edges go from each argument to its
// node. Only nodes that depend on a seed have a vertex.
#include "expr/scarcity.h"

#include "expr/seed.h"

#include <string.h>

// Neighbours of a vertex on one side (predecessors or successors); some may have been eliminated
// since.
struct side {
    uint32_t *v;
    size_t n, cap;
};

struct ct_scarcity {
    struct ct_arena *a;
    uint32_t ncolumn, nnode, nf;
    uint32_t *id;            // of nodes  (nnode)
    struct side *from, *to;  // by vertex
    bool *is_gone;           // by vertex
    uint64_t *edge;          // open addressing; 0 is free, else the key of an edge, plus one
    size_t nedge, edge_size; // a power of two
};

// ---- edges -------------------------------------------------------------------------------------

static size_t slot_of(const struct ct_scarcity *s, uint64_t key)
{
    size_t slot = (size_t)((key * UINT64_C(0x9e3779b97f4a7c15)) >> 20) & (s->edge_size - 1);
    while (s->edge[slot] && s->edge[slot] != key)
        slot = (slot + 1) & (s->edge_size - 1);
    return slot;
}

static uint64_t key_of(uint32_t from, uint32_t to)
{
    return ((uint64_t)from << 32 | to) + 1;
}

static bool has_edge(const struct ct_scarcity *s, uint32_t from, uint32_t to)
{
    return s->edge[slot_of(s, key_of(from, to))] != 0;
}

static void enlarge(struct ct_scarcity *s)
{
    const uint64_t *old = s->edge;
    const size_t n = s->edge_size;
    s->edge_size = n ? 2 * n : 1024;
    s->edge = CT_NEWN(s->a, uint64_t, s->edge_size);
    for (size_t i = 0; i < n; i++)
        if (old[i])
            s->edge[slot_of(s, old[i])] = old[i];
}

static void add_edge(struct ct_scarcity *s, uint32_t from, uint32_t to)
{
    if (2 * (s->nedge + 1) > s->edge_size)
        enlarge(s);
    const uint64_t key = key_of(from, to);
    const size_t slot = slot_of(s, key);
    if (s->edge[slot])
        return;
    s->edge[slot] = key;
    s->nedge++;
    CT_PUSH(s->a, s->from[to].v, s->from[to].n, s->from[to].cap, from);
    if (from >= s->ncolumn)
        CT_PUSH(s->a, s->to[from].v, s->to[from].n, s->to[from].cap, to);
}

// ---- the graph ---------------------------------------------------------------------------------

static bool has_slopes(uint32_t op)
{
    return op != CT_OP_SIGN && op != CT_OP_LT && op != CT_OP_LE && op != CT_OP_GT
        && op != CT_OP_GE && op != CT_OP_EQ;
}

struct reading {
    const struct ct_exs *x;
    const struct ct_seed *seed; // sorted
    size_t nseed;
    uint32_t
        *vertex; // by id: vertex of a node that depends on a seed; 0 for others and for symbols
};

// Add the edges to node id from its arguments, or from the columns of its seeds. False if it
// depends on no seed.
static bool add_edges(struct ct_scarcity *s, const struct reading *r, uint32_t id, uint32_t to)
{
    if (r->x->node[id].op != CT_OP_SYM) {
        if (r->vertex[id])
            add_edge(s, r->vertex[id], to);
        return r->vertex[id] != 0;
    }
    size_t k = ct_seeds_find(r->seed, r->nseed, id);
    const bool any = k < r->nseed && r->seed[k].symbol.id == id;
    for (; k < r->nseed && r->seed[k].symbol.id == id; k++)
        add_edge(s, r->seed[k].direction % s->ncolumn, to);
    return any;
}

static void add_node(struct ct_scarcity *s, const struct reading *r, uint32_t id)
{
    const struct ct_exnode *n = &r->x->node[id];
    const uint32_t arg[3] = {n->a, n->b, n->c}, v = s->ncolumn + s->nnode;
    bool any = false;
    for (int i = n->op == CT_OP_IF; has_slopes(n->op) && i < ct_op_info[n->op].narg; i++)
        any |= add_edges(s, r, arg[i], v);
    if (!any)
        return;
    s->id[s->nnode++] = id;
    r->vertex[id] = v;
}

struct ct_scarcity *ct_scarcity_create(struct ct_exs *x, struct ct_arena *a, const ct_ex *f,
                                       size_t nf, const struct ct_seed *seed, size_t nseed,
                                       uint32_t ncolumn)
{
    const size_t n = ct_ex_walk(x, f, nf), nvertex = ncolumn + n + nf;
    struct ct_scarcity *s = CT_NEW(a, struct ct_scarcity);
    *s = (struct ct_scarcity){.a = a, .ncolumn = ncolumn, .nf = (uint32_t)nf};
    s->id = CT_NEWN(a, uint32_t, n + 1);
    s->from = CT_NEWN(a, struct side, nvertex + 1);
    s->to = CT_NEWN(a, struct side, nvertex + 1);
    s->is_gone = CT_NEWN(a, bool, nvertex + 1);
    const struct reading r
        = {x, ct_seeds_sorted(a, seed, nseed), nseed, CT_NEWN(a, uint32_t, x->nnode)};
    bool *is_below = CT_NEWN(a, bool, x->nnode);
    for (size_t k = 0; k < n; k++)
        is_below[x->stack[k]] = true;
    for (uint32_t id = 0; id < x->nnode; id++)
        if (is_below[id] && x->node[id].op != CT_OP_SYM)
            add_node(s, &r, id);
    for (size_t k = 0; k < nf; k++)
        add_edges(s, &r, f[k].id, ncolumn + s->nnode + (uint32_t)k);
    return s;
}

// ---- elimination -------------------------------------------------------------------------------

// Remove eliminated vertices from a list of neighbours.
static void sweep_out(const struct ct_scarcity *s, struct side *side)
{
    size_t n = 0;
    for (size_t i = 0; i < side->n; i++)
        if (!s->is_gone[side->v[i]])
            side->v[n++] = side->v[i];
    side->n = n;
}

// Does the elimination of v add at most this many edges?
static bool adds_little(const struct ct_scarcity *s, uint32_t v, long most)
{
    const struct side *from = &s->from[v], *to = &s->to[v];
    long left = most + (long)(from->n + to->n);
    for (size_t i = 0; i < to->n && left >= 0; i++)
        for (size_t k = 0; k < from->n && left >= 0; k++)
            left -= !has_edge(s, from->v[k], to->v[i]);
    return left >= 0;
}

static void eliminate(struct ct_scarcity *s, uint32_t v)
{
    const struct side from = s->from[v], to = s->to[v];
    s->is_gone[v] = true;
    for (size_t i = 0; i < to.n; i++)
        for (size_t k = 0; k < from.n; k++)
            add_edge(s, from.v[k], to.v[i]);
}

void ct_scarcity_thin(struct ct_scarcity *s, long most)
{
    for (uint32_t v = s->ncolumn + s->nnode; v-- > s->ncolumn;) {
        if (s->is_gone[v])
            continue;
        sweep_out(s, &s->from[v]);
        sweep_out(s, &s->to[v]);
        if (adds_little(s, v, most))
            eliminate(s, v);
    }
}

// ---- remaining vertices ------------------------------------------------------------------------

size_t ct_scarcity_nodes(const struct ct_scarcity *s, struct ct_arena *a, ct_ex **node)
{
    size_t n = 0;
    *node = CT_NEWN(a, ct_ex, s->nnode + 1);
    for (uint32_t k = 0; k < s->nnode; k++)
        if (!s->is_gone[s->ncolumn + k])
            (*node)[n++] = (ct_ex){s->id[k]};
    return n;
}

size_t ct_scarcity_entries(const struct ct_scarcity *s, struct ct_arena *a, int **row,
                           int **column)
{
    const uint32_t first = s->ncolumn, last = first + s->nnode, end = last + s->nf;
    int *number = CT_NEWN(a, int, end + 1),
        nleft = 0; // by vertex: its column; rows of f come first
    size_t n = 0, row_cap = 0, column_cap = 0;
    *row = *column = NULL;
    for (uint32_t v = 0; v < last; v++)
        number[v] = v < first ? (int)v : s->is_gone[v] ? 0 : (int)first + nleft++;
    for (uint32_t v = first; v < end; v++) {
        const int i = v < last ? (int)s->nf + number[v] - (int)first : (int)(v - last);
        for (size_t k = 0; k < s->from[v].n && !s->is_gone[v]; k++) {
            const uint32_t from = s->from[v].v[k];
            size_t at = n;
            if (s->is_gone[from])
                continue;
            CT_PUSH(a, *row, at, row_cap, i);
            CT_PUSH(a, *column, n, column_cap, number[from]);
        }
    }
    return n;
}
