// Connected components of nodes by union and find: disjoint sets with path halving.
//
//     up:  [ 0 0 1 3 3 ]     pieces {0 1 2} and {3 4}; up[v] == v stands for its piece
//
// What always holds: a piece is represented by its smallest node, so ground's piece is 0.
#ifndef CT_GRAPH_DISJOINT_SETS_H
#define CT_GRAPH_DISJOINT_SETS_H

#include "graph/graph.h"

struct ct_disjoint_sets {
    int nnode, npiece;
    int *up; // nnode
};

void ct_disjoint_sets_init(struct ct_arena *a, int nnode, struct ct_disjoint_sets *p);

/// Every node on its own again.
void ct_disjoint_sets_reset(struct ct_disjoint_sets *p);

/// The smallest node of v's piece. Cost O(log nnode), amortised.
int ct_disjoint_sets_find(struct ct_disjoint_sets *p, int v);

/// Join the pieces of both ends; false if they were one already (the edge would close a
/// circuit).
bool ct_disjoint_sets_union(struct ct_disjoint_sets *p, struct ct_edge edge);

#endif
