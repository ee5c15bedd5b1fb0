// Search for the pair of spanning trees, one per graph, of least cost; formulation 2.3.
//
//     least weight pair  -->  few pairs?  --yes-->  try them all
//      (Kruskal twice)            '-------no------>  steepest descent by exchanges
//
// The two graphs share nodes and edges; they differ in weights and in the edges that are forced or
// banned. The caller defines the cost as a function of the two trees.
//
// What always holds: every pair tried contains all forced edges and no banned one, agrees on every
// tied edge, and weighs at most the least weight plus the excess. The same input gives the same
// pair.
#ifndef CT_GRAPH_EXCHANGE_H
#define CT_GRAPH_EXCHANGE_H

#include "graph/graph.h"

/// Constraints on one of the two trees; arrays have one entry per edge.
struct ct_tree_rules {
    const int *weight;  // negative: never a branch
    const int *rank;    // order among equal weights for the least weight pair; may be NULL
    const bool *forced; // always a branch (R1); may be NULL
    const bool *banned; // never a branch (R2); may be NULL
};

struct ct_search_options {
    struct ct_tree_rules trans, rot;
    const bool *tied; // per edge: in both trees or in neither (R3); may be NULL
    double limit;     // all pairs are tried if there are at most this many
    int budget;       // evaluations of the descent
    int excess;       // weight allowed above the least
};

/// A pair of trees by their branches, one entry per edge.
struct ct_tree_pair {
    bool *trans, *rot;
};

struct ct_search_stats {
    double npair;                   // pairs by forced and banned edges alone
    int nevaluated;                 // calls of the cost function
    bool exhaustive;                // all pairs were tried
    bool out_of_budget;             // the descent stopped because its budget was used up
    int weight_least, weight;       // total weight: least possible, of the pair found
    double cost_least_weight, cost; // cost of the least weight pair, of the pair found
};

/// Cost of a pair; INFINITY (or NaN) if the pair is inadmissible. The trees live in the arena.
typedef double (*ct_tree_cost)(void *data, const struct ct_tree *T, const struct ct_tree *R);

/**
 * Find the cheapest pair of spanning trees among those that the search evaluates.
 *
 * Among equal costs the smaller total weight wins, then the pair found first. A descent step
 * tries all neighbours, lightest first, and goes to the best one. A neighbour exchanges a chord
 * for a branch of its circuit in one tree; if a tied edge moves, it moves in both trees at
 * once.
 *
 * a       in    holds the result and the trees tried
 * g       in    both graphs' nodes and edges
 * best    out   branches of the pair found; unchanged if the function returns false
 * stats   out   set in any case
 *
 * False if no pair satisfies the rules (then nevaluated is 0), or if no pair tried has a finite
 * cost.
 * Cost    at most max(limit, budget) evaluations and O(e^2) besides each
 * Source  formulation 2.3; the least weight pair is exact (graphic matroid, 2.1), tied edges
 *         are decided by branch and bound
 */
bool ct_tree_search(struct ct_arena *a, const struct ct_graph *g,
                    const struct ct_search_options *options, ct_tree_cost cost, void *data,
                    struct ct_tree_pair *best, struct ct_search_stats *stats);

#endif
