// src/graph works on linear graphs: nodes, oriented edges, spanning trees, cutsets and circuits. It
// builds, counts and enumerates spanning trees, searches for the cheapest pair of trees, and
// derives fundamental cutset, circuit and incidence matrices as sparse matrices of -1, 0 and +1. It
// prints graphs as text, Graphviz and JSON. It works on integers only and knows no mechanics and no
// expressions.
//
//     node 0 is ground (the datum); an edge goes from tail to head; incidence +1 at the head
//
// What always holds: the arrays of a tree have one entry per node (parent edge, parent node, depth)
// or one per edge (is_branch). `order` lists the nodes root first, so parents precede children.
// Ties are broken by edge index: the same graph gives the same tree.
#ifndef CT_GRAPH_GRAPH_H
#define CT_GRAPH_GRAPH_H

#include "base/ctx.h"

struct ct_edge {
    int tail, head;
};

struct ct_graph {
    int nnode, nedge;
    const struct ct_edge *edge;
};

/// A spanning tree rooted at node 0.
struct ct_tree {
    int nnode, nedge, nbranch, nchord;
    bool *is_branch;  // per edge
    int *parent_edge; // per node; -1 at the root
    int *parent;      // per node; -1 at the root
    int *sign;        // per node: +1 if its parent edge points away from the root, else -1
    int *depth;       // per node, in edges
    int *order;       // nnode nodes, parents before children
    int *branch;      // edge numbers, ascending
    int *chord;       // edge numbers, ascending
};

/// Sparse matrix of -1 and +1 in compressed columns; rows sorted.
struct ct_incidence {
    int nrow, ncol;
    int *start; // ncol + 1
    int *row;
    signed char *value;
};

/// Spanning tree of least weight by Kruskal's algorithm; edges of weight < 0 are never branches.
/// Among equal weights the smaller `rank` wins, then the smaller index. rank may be NULL. False if
/// no spanning tree exists; t is then unchanged. component (nnode, may be NULL): number of the
/// connected component of each node in the graph of allowed edges; 0 is that of ground, the others
/// follow by smallest node. Cost O(e log e). Source: Kruskal (1956), key kruskal1956.
bool ct_tree_kruskal(struct ct_arena *a, const struct ct_graph *g, const int *weight,
                     const int *rank, struct ct_tree *t, int *component);

/// The tree with the given branches. False if they are no spanning tree; t is then unchanged.
/// `order` is breadth first, edges by index. Cost O(v + e).
bool ct_tree_from_branches(struct ct_arena *a, const struct ct_graph *g, const bool *is_branch,
                           struct ct_tree *t);

/// For debugging: check that every node but the root has a parent, that branches agree with parent
/// edges, and that the order is right. NULL if so, else what is wrong. Cost O(v^2 + e).
const char *ct_tree_check(const struct ct_graph *g, const struct ct_tree *t);

/// Number of spanning trees whose branches include all `forced` edges and no `banned` one
/// (matrix-tree theorem, in double, rounded). Relative error below n^2 eps, so exact up to
/// about 1e15 / n^2 trees. Either array may be NULL. Cost O(n^3).
double ct_tree_count(struct ct_arena *scratch, const struct ct_graph *g, const bool *forced,
                     const bool *banned);

/// Call visit(data, is_branch) for every such tree, in lexicographic order of branches, until it
/// returns false. Returns false if a call did so; true if all trees were visited, also when there
/// is none. Cost O(e^2) per tree.
bool ct_tree_enumerate(struct ct_arena *scratch, const struct ct_graph *g, const bool *forced,
                       const bool *banned, bool (*visit)(void *data, const bool *is_branch),
                       void *data);

/// The fundamental circuit of chord e, oriented along it (formulation 3.2): its n branches and
/// their entries of B_t, so that across_e + sum_k sign[k] across_branch[k] = 0. branch[] and sign[]
/// (room nbranch) are in the order of a walk from the head of e back to its tail; sign is +1 where
/// the branch points along this walk. Returns n. Cost O(n).
int ct_tree_circuit(const struct ct_graph *g, const struct ct_tree *t, int e, int *branch,
                    signed char *sign);

/// Fundamental circuits B_f = [B_t 1] (nchord x nedge) and cutsets A_f = [1 A_cut] (nbranch x
/// nedge). Columns are edges by their number; rows in the order of t->chord and t->branch.
/// A_f B_f' = 0 exactly. (3.1)-(3.3). Cost O(e + sum of circuit lengths).
/// Source: Seshu and Reed (1961), key seshu1961.
void ct_circuits_derive(struct ct_arena *a, const struct ct_graph *g, const struct ct_tree *t,
                        struct ct_incidence *Bf);
void ct_cutsets_derive(struct ct_arena *a, const struct ct_graph *g, const struct ct_tree *t,
                       struct ct_incidence *Af);

/// Reduced incidence matrix (without ground), (nnode - 1) x nedge: row v - 1 is node v, +1 at the
/// head of an edge, -1 at its tail.
void ct_incidence_derive(struct ct_arena *a, const struct ct_graph *g, struct ct_incidence *A);

/// Allocate S without its entries. start (ncol + 1): start[j + 1] is the number of entries of
/// column j; the counts are summed to column starts. Returns the index of the next free entry of
/// each column.
int *ct_incidence_create(struct ct_arena *a, int nrow, int ncol, int *start,
                         struct ct_incidence *S);
/// The transpose: compressed columns of S' are compressed rows of S, in which equations can be read
/// one by one. Cost O(rows + columns + entries).
void ct_incidence_transpose(struct ct_arena *a, const struct ct_incidence *S,
                            struct ct_incidence *St);

#endif
