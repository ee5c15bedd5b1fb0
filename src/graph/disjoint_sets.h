// Connected components of a graph by union-find: disjoint sets with path halving.
//
//     up:  [ 0 0 1 3 3 ]     sets {0 1 2} and {3 4}; up[v] == v: v represents its set
//
// What always holds: a set is represented by its smallest node, so node 0 represents that of
// ground.
#ifndef CT_GRAPH_DISJOINT_SETS_H
#define CT_GRAPH_DISJOINT_SETS_H

#include "graph/graph.h"

struct ct_disjoint_sets {
    int nnode, npiece;
    int *up; // nnode
};

void ct_disjoint_sets_init(struct ct_arena *a, int nnode, struct ct_disjoint_sets *p);

/// Make every node a set of its own.
void ct_disjoint_sets_reset(struct ct_disjoint_sets *p);

/// The smallest node of v's set. Cost O(log nnode), amortised.
int ct_disjoint_sets_find(struct ct_disjoint_sets *p, int v);

/// Unite the sets of both ends of an edge. False if they are the same set: the edge would close a
/// circuit.
bool ct_disjoint_sets_union(struct ct_disjoint_sets *p, struct ct_edge edge);

#endif
