// What can be reached from where, and how far it is.
#ifndef CT_GRAPH_REACH_H
#define CT_GRAPH_REACH_H

#include "graph/graph.h"

/// Edges at each node: those of v are at[first[v]] .. at[first[v + 1] - 1], ascending.
struct ct_ends {
    int *first, *at;
};

/// Of the edges with is_in only. Cost O(v + e).
struct ct_ends ct_ends_list(struct ct_arena *a, const struct ct_graph *g, const bool *is_in);

/// Edges over which known nodes spread, in the order of sweeps over all edges from the first to the last until nothing
/// changes: an edge with one known end makes the other end known.
///
/// g         in      connected or not
/// usable    in      per edge
/// is_known  in/out  per node
/// order     out     room for g->nnode edges; each end that becomes known stands for one
///
/// Returns the number of edges. Cost O(v + e log e), where the sweeps may take O(v e).
int ct_graph_spread(struct ct_arena *a, const struct ct_graph *g, const bool *usable,
                    bool *is_known, int *order);

/// Shortest distance of each node (out) from ground over usable edges, whose length is at least 0; `unreached` where no way
/// leads. Cost O(v + e) for equal lengths.
void ct_graph_distances(struct ct_arena *a, const struct ct_graph *g, const bool *usable,
                        const int *length, int unreached, int *distance);

#endif
