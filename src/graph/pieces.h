// Which nodes hang together: disjoint sets with path halving.
//
//     up:  [ 0 0 1 3 3 ]     pieces {0 1 2} and {3 4}; up[v] == v stands for its piece
//
// What always holds: a piece is represented by its smallest node, so ground's piece is 0.
#ifndef CT_GRAPH_PIECES_H
#define CT_GRAPH_PIECES_H

#include "graph/graph.h"

struct ct_pieces {
    int nnode, npiece;
    int *up; // nnode
};

void ct_pieces_init(struct ct_arena *a, int nnode, struct ct_pieces *p);

/// Every node on its own again.
void ct_pieces_reset(struct ct_pieces *p);

/// The smallest node of v's piece. Cost O(log nnode), amortised.
int ct_pieces_find(struct ct_pieces *p, int v);

/// Join the pieces of both ends; false if they were one already (the edge would close a
/// circuit).
bool ct_pieces_join(struct ct_pieces *p, struct ct_edge edge);

#endif
