// Adjacency lists, propagation over edges, and shortest paths from ground.
#ifndef CT_GRAPH_REACH_H
#define CT_GRAPH_REACH_H

#include "graph/graph.h"

/// Edges at each node: those of v are at[first[v]] .. at[first[v + 1] - 1], ascending.
struct ct_ends {
    int *first, *at;
};

/// Adjacency lists of the edges with is_in. Cost O(v + e).
struct ct_ends ct_ends_list(struct ct_arena *a, const struct ct_graph *g, const bool *is_in);

/// Propagate `known` over edges: an edge with one known end makes its other end known. Edges are
/// visited in sweeps from the first to the last until nothing changes.
///
/// g         in      connected or not
/// usable    in      per edge
/// is_known  in/out  per node
/// order     out     the edges used, one for each node that becomes known; room for g->nnode
///
/// Returns their number. Cost O(v + e log e): a heap replaces the sweeps, which would cost O(v e).
int ct_graph_spread(struct ct_arena *a, const struct ct_graph *g, const bool *usable,
                    bool *is_known, int *order);

/// Shortest distance of each node (out) from ground over usable edges of length >= 0; `unreached`
/// where there is no path. Cost O(v + e) for equal lengths.
void ct_graph_distances(struct ct_arena *a, const struct ct_graph *g, const bool *usable,
                        const int *length, int unreached, int *distance);

#endif
