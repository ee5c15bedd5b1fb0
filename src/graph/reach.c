// See reach.h.
#include "graph/reach.h"

struct ct_ends ct_ends_list(struct ct_arena *a, const struct ct_graph *g, const bool *is_in)
{
    struct ct_ends s = {CT_NEWN(a, int, g->nnode + 2), CT_NEWN(a, int, 2 * (size_t)g->nedge)};
    // counts are stored two indices ahead: after summation first[v + 1] is the start of the list of
    // v; filling advances it to the end, which is the start of the list of v + 1
    for (int e = 0; e < g->nedge; e++)
        if (is_in[e]) {
            s.first[g->edge[e].tail + 2]++;
            s.first[g->edge[e].head + 2]++;
        }
    for (int v = 0; v < g->nnode; v++)
        s.first[v + 2] += s.first[v + 1];
    for (int e = 0; e < g->nedge; e++)
        if (is_in[e]) {
            s.at[s.first[g->edge[e].tail + 1]++] = e;
            s.at[s.first[g->edge[e].head + 1]++] = e;
        }
    return s;
}

static int other_end(const struct ct_graph *g, int edge, int node)
{
    return g->edge[edge].tail + g->edge[edge].head - node;
}

// ---- sweeps ------------------------------------------------------------------------------------

// Edges still to be visited, each in a certain sweep: a binary heap ordered by the time of the
// visit.
struct visits {
    struct visit {
        int sweep, edge;
    } * heap;
    int n;
};

static bool is_before(struct visit a, struct visit b)
{
    return a.sweep != b.sweep ? a.sweep < b.sweep : a.edge < b.edge;
}

static void push(struct visits *h, struct visit v)
{
    int i = h->n++;
    for (; i > 0 && is_before(v, h->heap[(i - 1) / 2]); i = (i - 1) / 2)
        h->heap[i] = h->heap[(i - 1) / 2];
    h->heap[i] = v;
}

static struct visit pop(struct visits *h)
{
    const struct visit first = h->heap[0], last = h->heap[--h->n];
    int i = 0;
    for (int below; (below = 2 * i + 1) < h->n; i = below) {
        if (below + 1 < h->n && is_before(h->heap[below + 1], h->heap[below]))
            below++;
        if (!is_before(h->heap[below], last))
            break;
        h->heap[i] = h->heap[below];
    }
    h->heap[i] = last;
    return first;
}

int ct_graph_spread(struct ct_arena *a, const struct ct_graph *g, const bool *usable,
                    bool *is_known, int *order)
{
    const struct ct_ends s = ct_ends_list(a, g, usable);
    // an edge is in the heap at most once for each of its ends
    struct visits h = {.heap = CT_NEWN(a, struct visit, 2 * g->nedge + 1)};
    int n = 0;
    for (int e = 0; e < g->nedge; e++)
        if (usable[e] && is_known[g->edge[e].tail] != is_known[g->edge[e].head])
            push(&h, (struct visit){0, e});
    while (h.n) {
        const struct visit v = pop(&h);
        const struct ct_edge *e = &g->edge[v.edge];
        if (is_known[e->tail] && is_known[e->head])
            continue;
        const int node = is_known[e->tail] ? e->head : e->tail;
        is_known[node] = true;
        order[n++] = v.edge;
        for (int k = s.first[node]; k < s.first[node + 1]; k++)
            if (!is_known[other_end(g, s.at[k],
                                    node)]) // visited later in this sweep, or in the next one
                push(&h, (struct visit){v.sweep + (s.at[k] < v.edge), s.at[k]});
    }
    return n;
}

// ---- distances ---------------------------------------------------------------------------------

// Label correcting with a queue (ring buffer): nodes whose distance decreased wait there until
// their edges are relaxed again.
void ct_graph_distances(struct ct_arena *a, const struct ct_graph *g, const bool *usable,
                        const int *length, int unreached, int *distance)
{
    const struct ct_ends s = ct_ends_list(a, g, usable);
    int *ring = CT_NEWN(a, int, g->nnode + 1), first = 0, n = 1;
    bool *waits = CT_NEWN(a, bool, g->nnode + 1);
    for (int v = 1; v < g->nnode; v++)
        distance[v] = unreached;
    ring[0] = distance[0] = 0;
    while (n) {
        const int v = ring[first];
        first = (first + 1) % g->nnode;
        n--;
        waits[v] = false;
        for (int k = s.first[v]; k < s.first[v + 1]; k++) {
            const int to = other_end(g, s.at[k], v), there = distance[v] + length[s.at[k]];
            if (there >= distance[to])
                continue;
            distance[to] = there;
            if (!waits[to])
                ring[(first + n++) % g->nnode] = to;
            waits[to] = true;
        }
    }
}
