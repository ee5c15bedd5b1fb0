// The choice of a pair of spanning trees: topology proposes pairs, the stage derives their
// equations and counts the operations, topology compares.
//
//     tree_selection.c        which pair of trees
//     tree_rules.c   what edges may and must be in them
//     tree_cost.c    what their equations cost
#ifndef CT_FORMULATE_TOPOLOGY_TREE_SELECTION_H
#define CT_FORMULATE_TOPOLOGY_TREE_SELECTION_H

#include "formulate/build.h"
#include "formulate/formulate.h"
#include "graph/exchange.h"

/// Trial equations of pairs of trees, made by the stage.
struct ct_pair_trials {
    void *stage;
    /// Before the first: stays_open if there is a pair without constraint rows, so that none with
    /// rows is wanted.
    void (*begin)(void *stage, bool stays_open);
    /// Operations of the equations of a pair, in multiplications; INFINITY where they fail or are
    /// not wanted. The first pair is that of least weight.
    ct_tree_cost cost;
};

/// b->T and b->R. Errors: CT_E_TREE.
bool ct_tree_selection_run(struct ct_build *b, const struct ct_formulate_options *o,
                           const struct ct_pair_trials *trials, struct ct_tree_report *report);

/// By edge.
struct ct_pair_rules {
    int *weight_t, *weight_r, *rank; // weight -1: before all others that are not forced
    bool *forced_t, *forced_r, *banned_t, *banned_r, *tied;
};

/// Arms are branches, force drivers chords (R1, R2); shared coordinates tie a joint (R3). Ties go
/// to joints nearer to ground.
struct ct_pair_rules ct_pair_rules_make(struct ct_build *b,
                                        const struct ct_formulate_options *o);

/// In multiplications: the entries of M, Q, J and gam, and a sparse factorization.
double ct_equations_cost(struct ct_arena *scratch, const struct ct_equations *e);

#endif
