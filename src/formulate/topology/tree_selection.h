// The choice of a pair of spanning trees: this folder proposes pairs, the stage derives their
// equations and counts operations, this folder compares the counts.
//
//     tree_selection.c        search for the cheapest pair
//     tree_rules.c   edges that may and that must be branches
//     tree_cost.c    operation count of the equations
#ifndef CT_FORMULATE_TOPOLOGY_TREE_SELECTION_H
#define CT_FORMULATE_TOPOLOGY_TREE_SELECTION_H

#include "formulate/build.h"
#include "formulate/formulate.h"
#include "graph/exchange.h"

/// Callbacks of the stage that derive trial equations.
struct ct_pair_trials {
    void *stage;
    /// Called before the first trial. stays_open: a pair without constraint rows exists, so that
    /// pairs with rows are rejected.
    void (*begin)(void *stage, bool stays_open);
    /// Operation count of a pair, in multiplications; INFINITY if it fails or is rejected. The
    /// first pair is the one of least weight.
    ct_tree_cost cost;
};

/// Chooses b->T and b->R. Errors: CT_E_TREE.
bool ct_tree_selection_run(struct ct_build *b, const struct ct_formulate_options *o,
                           const struct ct_pair_trials *trials, struct ct_tree_report *report);

/// Rules for the branches, by edge.
struct ct_pair_rules {
    int *weight_t, *weight_r, *rank; // weight -1: before all other edges that are not forced
    bool *forced_t, *forced_r, *banned_t, *banned_r, *tied;
};

/// Makes the rules. Arms are branches and forces are chords (R1, R2). A joint with coordinates in
/// both graphs is tied: both trees contain it or neither (R3). Among equal weights joints nearer to
/// ground come first.
struct ct_pair_rules ct_pair_rules_make(struct ct_build *b,
                                        const struct ct_formulate_options *o);

/// Operation count in multiplications: the entries of M, Q, J and gam, and a sparse factorization.
double ct_equations_cost(struct ct_arena *scratch, const struct ct_equations *e);

#endif
