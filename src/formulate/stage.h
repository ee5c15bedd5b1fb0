// Equations of a model on one pair of trees, in stages. formulate.c tells what follows;
// beam_error makes equations of its own.
//
//     ct_build_create         model -> b->topology and the list of coordinates
//     ct_build_choose_trees   b->T and b->R, trees of translation and rotation
//     ct_build_derive         b->kinematics, then Phi, J, gam (b->rows), then b->loads
#ifndef CT_FORMULATE_STAGE_H
#define CT_FORMULATE_STAGE_H

#include "formulate/build.h"
#include "formulate/formulate.h"

/// Graph, nodes and edges of the model; trees are still open.
struct ct_build *ct_build_create(struct ct_ctx *ctx, struct ct_arena *a,
                                 const struct ct_model *m, const struct ct_formulate_options *o,
                                 const bool *is_linear);
/// (*b)->T and (*b)->R; *b becomes another one, is_derived, where its equations were made on the
/// way. Errors: CT_E_TREE.
bool ct_build_choose_trees(struct ct_build **b, const struct ct_formulate_options *o,
                           struct ct_tree_report *report);
/// A copy of a build without beams whose trees are open, to derive trial equations: what these
/// write is its own, the rest stays that of `from`. Names of expressions are left behind.
struct ct_build *ct_build_clone(struct ct_ctx *ctx, struct ct_arena *a,
                                const struct ct_build *from);
/// What comes before M and Q: Phi, J, gam and, unless only positions and speeds are wanted, the
/// loads.
bool ct_build_derive(struct ct_build *b, bool with_dynamics);

#endif
