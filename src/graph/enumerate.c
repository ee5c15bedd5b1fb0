// Counting and enumeration of spanning trees.
//
// Counting: by the matrix-tree theorem (Kirchhoff 1847, key kirchhoff1847) the number of trees is
// det(A A'). It is evaluated like a resistor network: nodes are eliminated one by one by the
// star-mesh transformation; the pivots are the total conductances at the eliminated nodes. This is
// Gaussian elimination in which the diagonal is recomputed from the off-diagonal entries, so
// nothing is ever subtracted.
//
// Enumeration: each edge in turn is taken and then left out. A choice is followed only if it can
// still be completed to a tree, so there are no dead ends.
#include "graph/graph.h"

#include "graph/disjoint_sets.h"

#include <math.h>

/// Unite the ends of forced edges. False if they close a circuit or one is also banned.
static bool join_forced(const struct ct_graph *g, const bool *forced, const bool *banned,
                        struct ct_disjoint_sets *p)
{
    for (int e = 0; forced && e < g->nedge; e++)
        if (forced[e] && ((banned && banned[e]) || !ct_disjoint_sets_union(p, g->edge[e])))
            return false;
    return true;
}

/// W (n x n, out, symmetric): number of free edges between each two components, numbered by
/// place[].
static void fill_conductances(double *W, const struct ct_graph *g, const bool *banned,
                              struct ct_disjoint_sets *p, const int *place, int n)
{
    for (int e = 0; e < g->nedge; e++) {
        const int i = place[ct_disjoint_sets_find(p, g->edge[e].tail)];
        const int j = place[ct_disjoint_sets_find(p, g->edge[e].head)];
        if (i == j || (banned && banned[e])) // forced edges lie within one component
            continue;
        W[i + n * j] += 1;
        W[j + n * i] += 1;
    }
}

/// Product of the pivots of the star-mesh elimination of nodes n - 1, ..., 1 of the
/// conductances W (n x n, destroyed).
static double eliminate_nodes(double *W, int n)
{
    double ntree = 1;
    for (int k = n - 1; k > 0; k--) {
        double d = 0; // total conductance at node k
        for (int j = 0; j < k; j++)
            d += W[j + n * k];
        if (d == 0)
            return 0; // not connected
        ntree *= d;
        for (int j = 0; j < k; j++)
            for (int i = 0; i < k; i++)
                W[i + n * j] += i == j ? 0 : W[i + n * k] * W[j + n * k] / d;
    }
    return round(ntree);
}

double ct_tree_count(struct ct_arena *scratch, const struct ct_graph *g, const bool *forced,
                     const bool *banned)
{
    struct ct_disjoint_sets p;
    ct_disjoint_sets_init(scratch, g->nnode, &p);
    if (!join_forced(g, forced, banned, &p))
        return 0;

    int *place = CT_NEWN(scratch, int, g->nnode);
    const int n = p.npiece;
    for (int v = 0, i = 0; v < g->nnode; v++)
        if (ct_disjoint_sets_find(&p, v) == v)
            place[v] = i++;
    double *W = CT_NEWN(scratch, double, (size_t)n *(size_t)n);
    fill_conductances(W, g, banned, &p, place, n);
    return eliminate_nodes(W, n);
}

struct enumeration {
    const struct ct_graph *g;
    bool *is_branch;                // forced edges and those taken so far
    bool *is_free;                  // neither forced nor banned
    int nmissing;                   // number of branches still missing
    struct ct_disjoint_sets pieces; // workspace
    bool (*visit)(void *data, const bool *is_branch);
    void *data;
};

/// Would e close a circuit with the branches taken?
static bool closes_circuit(struct enumeration *s, int e)
{
    ct_disjoint_sets_reset(&s->pieces);
    for (int i = 0; i < s->g->nedge; i++)
        if (s->is_branch[i])
            ct_disjoint_sets_union(&s->pieces, s->g->edge[i]);
    return !ct_disjoint_sets_union(&s->pieces, s->g->edge[e]);
}

/// Do the branches taken and the free edges from `first` on connect all nodes?
static bool can_span(struct enumeration *s, int first)
{
    ct_disjoint_sets_reset(&s->pieces);
    for (int i = 0; i < s->g->nedge; i++)
        if (s->is_branch[i] || (i >= first && s->is_free[i]))
            ct_disjoint_sets_union(&s->pieces, s->g->edge[i]);
    return s->pieces.npiece == 1;
}

/// All trees that contain the branches taken, choosing among the free edges from e on. Here the
/// branches are free of circuits and can_span(e) holds, so at least one tree follows.
static bool choose_from(struct enumeration *s, int e)
{
    if (s->nmissing == 0)
        return s->visit(s->data, s->is_branch);
    while (!s->is_free[e])
        e++;
    if (!closes_circuit(s, e)) {
        s->is_branch[e] = true;
        s->nmissing--;
        const bool go_on = choose_from(s, e + 1);
        s->is_branch[e] = false;
        s->nmissing++;
        if (!go_on)
            return false;
    }
    return !can_span(s, e + 1) || choose_from(s, e + 1);
}

bool ct_tree_enumerate(struct ct_arena *scratch, const struct ct_graph *g, const bool *forced,
                       const bool *banned, bool (*visit)(void *data, const bool *is_branch),
                       void *data)
{
    struct enumeration s = {.g = g, .visit = visit, .data = data};
    ct_disjoint_sets_init(scratch, g->nnode, &s.pieces);
    if (!join_forced(g, forced, banned, &s.pieces))
        return true;

    s.nmissing = s.pieces.npiece - 1;
    s.is_branch = CT_NEWN(scratch, bool, g->nedge);
    s.is_free = CT_NEWN(scratch, bool, g->nedge);
    for (int e = 0; e < g->nedge; e++) {
        s.is_branch[e] = forced && forced[e];
        s.is_free[e] = !s.is_branch[e] && !(banned && banned[e]);
    }
    return !can_span(&s, 0) || choose_from(&s, 0);
}
