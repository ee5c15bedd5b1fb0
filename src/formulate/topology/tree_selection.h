// The choice of trees from inside: what its files and the stage share.
//
//     tree_selection.c        which pair of trees
//     tree_rules.c   what edges may and must be in them
//     tree_cost.c    what their equations cost
#ifndef CT_FORMULATE_TOPOLOGY_TREE_SELECTION_H
#define CT_FORMULATE_TOPOLOGY_TREE_SELECTION_H

#include "formulate/build.h"
#include "formulate/formulate.h"

/// (*b)->T and (*b)->R; *b is another one, is_derived, where its equations were made on the way. Errors: CT_E_TREE.
bool ct_tree_selection_run(struct ct_build **b, const struct ct_formulate_options *o,
                           struct ct_tree_report *report);

/// By edge.
struct ct_pair_rules {
    int *weight_t, *weight_r, *rank; // weight -1: before all others that are not forced
    bool *forced_t, *forced_r, *banned_t, *banned_r, *tied;
};

/// Arms are branches, force drivers chords (R1, R2); shared coordinates tie a joint (R3). Ties go to
/// joints nearer to ground.
struct ct_pair_rules ct_pair_rules_make(struct ct_build *b,
                                        const struct ct_formulate_options *o);

/// In multiplications: the entries of M, Q, J and gam, and a sparse factorization.
double ct_equations_cost(struct ct_arena *scratch, const struct ct_equations *e);

/// Graph, nodes and edges of the model; trees are still open.
struct ct_build *ct_build_create(struct ct_ctx *ctx, struct ct_arena *a,
                                 const struct ct_model *m, const struct ct_formulate_options *o,
                                 const bool *is_linear);
/// A copy of a build without beams whose trees are open, to derive trial equations: what these write is its own, the rest
/// stays that of `from`. Names of expressions are left behind.
struct ct_build *ct_build_clone(struct ct_ctx *ctx, struct ct_arena *a,
                                const struct ct_build *from);
/// What comes before M and Q: Phi, J, gam and, unless only positions and speeds are wanted, the loads.
bool ct_build_derive(struct ct_build *b, bool with_dynamics);

#endif
