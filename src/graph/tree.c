// Spanning trees: of least weight (Kruskal 1956, key kruskal1956), and from given branches.
//
// nnode - 1 branches that reach every node are a spanning tree. A breadth-first walk from ground
// gives parents, signs and depths, so `order` lists nodes by increasing depth.
#include "graph/graph.h"

#include "graph/disjoint_sets.h"
#include "graph/reach.h"

#include <assert.h>
#include <stdlib.h>

// Sort key of an edge; the index makes the order total, hence the tree unique.
struct key {
    int weight, rank, e;
};

static int compare_keys(const void *a, const void *b)
{
    const struct key *x = a, *y = b;
    if (x->weight != y->weight)
        return x->weight < y->weight ? -1 : 1;
    if (x->rank != y->rank)
        return x->rank < y->rank ? -1 : 1;
    return (x->e > y->e) - (x->e < y->e);
}

/// Write the edges that may be branches to key[] (room nedge), best first. Returns their number.
static int sort_edges(const struct ct_graph *g, const int *weight, const int *rank,
                      struct key *key)
{
    int n = 0;
    for (int e = 0; e < g->nedge; e++)
        if (weight[e] >= 0)
            key[n++] = (struct key){weight[e], rank ? rank[e] : 0, e};
    qsort(key, (size_t)n, sizeof *key, compare_keys);
    return n;
}

/// component[v]: 0 for the component of ground, then 1, 2, ... by smallest node.
static void number_pieces(struct ct_disjoint_sets *p, int *component)
{
    int n = 0;
    for (int v = 0; v < p->nnode; v++) {
        const int first
            = ct_disjoint_sets_find(p, v); // <= v, so already numbered unless it is v
        component[v] = first == v ? n++ : component[first];
    }
}

bool ct_tree_kruskal(struct ct_arena *a, const struct ct_graph *g, const int *weight,
                     const int *rank, struct ct_tree *t, int *component)
{
    struct key *key = CT_NEWN(a, struct key, g->nedge);
    const int n = sort_edges(g, weight, rank, key);
    bool *is_branch = CT_NEWN(a, bool, g->nedge);
    struct ct_disjoint_sets p;
    ct_disjoint_sets_init(a, g->nnode, &p);
    for (int i = 0; i < n; i++)
        is_branch[key[i].e] = ct_disjoint_sets_union(&p, g->edge[key[i].e]);

    if (component)
        number_pieces(&p, component);
    return ct_tree_from_branches(a, g, is_branch, t);
}

/// Attach node v to its parent by branch e.
static void attach(const struct ct_graph *g, struct ct_tree *t, int v, int parent, int e)
{
    t->parent[v] = parent;
    t->parent_edge[v] = e;
    t->sign[v] = g->edge[e].head == v ? +1 : -1;
    t->depth[v] = t->depth[parent] + 1;
}

/// Breadth-first walk from ground along the branches; t->order is the queue. Returns the number of
/// nodes reached.
static int walk_from_ground(const struct ct_graph *g, struct ct_ends s, struct ct_tree *t)
{
    for (int v = 0; v < g->nnode; v++)
        t->parent[v] = t->parent_edge[v] = -1;
    int n = 1; // order[0] = 0 is ground
    for (int i = 0; i < n; i++) {
        const int v = t->order[i];
        for (int k = s.first[v]; k < s.first[v + 1]; k++) {
            const int e = s.at[k], w = g->edge[e].tail + g->edge[e].head - v;
            if (w != 0 && t->parent_edge[w] < 0) {
                attach(g, t, w, v, e);
                t->order[n++] = w;
            }
        }
    }
    return n;
}

static void list_edges(const struct ct_graph *g, struct ct_tree *t, const bool *is_branch)
{
    for (int e = 0, b = 0, c = 0; e < g->nedge; e++) {
        t->is_branch[e] = is_branch[e];
        if (is_branch[e])
            t->branch[b++] = e;
        else
            t->chord[c++] = e;
    }
}

bool ct_tree_from_branches(struct ct_arena *a, const struct ct_graph *g, const bool *is_branch,
                           struct ct_tree *t)
{
    const int v = g->nnode, e = g->nedge;
    int nbranch = 0;
    for (int i = 0; i < e; i++)
        nbranch += is_branch[i];
    if (nbranch != v - 1)
        return false;

    struct ct_tree new = {
        .nnode = v,
        .nedge = e,
        .nbranch = nbranch,
        .nchord = e - nbranch,
        .is_branch = CT_NEWN(a, bool, e),
        .parent_edge = CT_NEWN(a, int, v),
        .parent = CT_NEWN(a, int, v),
        .sign = CT_NEWN(a, int, v),
        .depth = CT_NEWN(a, int, v),
        .order = CT_NEWN(a, int, v),
        .branch = CT_NEWN(a, int, nbranch),
        .chord = CT_NEWN(a, int, e - nbranch),
    };
    if (walk_from_ground(g, ct_ends_list(a, g, is_branch), &new) < v)
        return false; // v - 1 branches that miss a node contain a circuit
    list_edges(g, &new, is_branch);
    *t = new;
    assert(!ct_tree_check(g, t));
    return true;
}

/// Check that each node but the root has a branch to its parent.
static const char *check_parents(const struct ct_graph *g, const struct ct_tree *t)
{
    if (t->parent[0] != -1 || t->parent_edge[0] != -1 || t->depth[0] != 0)
        return "node 0 is not the root";
    for (int v = 1; v < t->nnode; v++) {
        const int e = t->parent_edge[v], p = t->parent[v];
        if (e < 0 || e >= t->nedge || p < 0 || p >= t->nnode)
            return "a node has no parent";
        if (!t->is_branch[e])
            return "a parent edge is no branch";
        const struct ct_edge up
            = t->sign[v] == 1 ? (struct ct_edge){p, v} : (struct ct_edge){v, p};
        if ((t->sign[v] != 1 && t->sign[v] != -1) || g->edge[e].tail != up.tail
            || g->edge[e].head != up.head)
            return "a parent edge does not join the node and its parent in the sense of its "
                   "sign";
        if (t->depth[v] != t->depth[p] + 1)
            return "a depth is not the parent's plus one";
    }
    return NULL;
}

/// Check the order: each node once, and depths that never decrease. The depths already exclude
/// circuits.
static const char *check_order(const struct ct_tree *t)
{
    for (int i = 0; i < t->nnode; i++) {
        if (t->order[i] < 0 || t->order[i] >= t->nnode)
            return "the order names no node";
        if (i > 0 && t->depth[t->order[i - 1]] > t->depth[t->order[i]])
            return "a node comes before its parent";
        for (int j = 0; j < i; j++)
            if (t->order[j] == t->order[i])
                return "the order names a node twice";
    }
    return NULL;
}

static const char *check_lists(const struct ct_tree *t)
{
    int b = 0, c = 0;
    for (int e = 0; e < t->nedge; e++) {
        if (t->is_branch[e] ? b >= t->nbranch || t->branch[b++] != e
                            : c >= t->nchord || t->chord[c++] != e)
            return "the lists of branches and chords disagree with is_branch";
    }
    return b == t->nbranch && c == t->nchord ? NULL : "a list of edges is too long";
}

const char *ct_tree_check(const struct ct_graph *g, const struct ct_tree *t)
{
    if (t->nnode != g->nnode || t->nedge != g->nedge || t->nbranch != t->nnode - 1
        || t->nchord != t->nedge - t->nbranch)
        return "the counts are not those of a spanning tree";
    const char *wrong = check_lists(t);
    if (!wrong)
        wrong = check_parents(g, t);
    return wrong ? wrong : check_order(t);
}
