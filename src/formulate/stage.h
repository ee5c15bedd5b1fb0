// Derives the equations of a model for one pair of trees, step by step. formulate.c does the steps
// that follow. beam_error calls these functions for auxiliary models.
//
//     ct_build_create         model -> b->topology and the list of coordinates
//     ct_build_choose_trees   b->T and b->R, trees of translation and rotation
//     ct_build_derive         b->kinematics, then Phi, J, gam (b->rows), then b->loads
#ifndef CT_FORMULATE_STAGE_H
#define CT_FORMULATE_STAGE_H

#include "formulate/build.h"
#include "formulate/formulate.h"

/// Graph, nodes and edges of the model; the trees are not chosen yet.
struct ct_build *ct_build_create(struct ct_ctx *ctx, struct ct_arena *a,
                                 const struct ct_model *m, const struct ct_formulate_options *o,
                                 const bool *is_linear);
/// Chooses (*b)->T and (*b)->R. If the search has already derived the equations of the chosen pair,
/// *b is replaced and is_derived is true. Errors: CT_E_TREE.
bool ct_build_choose_trees(struct ct_build **b, const struct ct_formulate_options *o,
                           struct ct_tree_report *report);
/// A copy of a build without beams and before the choice of trees, for trial equations. Data that
/// the trial writes is copied; the rest is shared with `from`. Names of expressions are not copied.
struct ct_build *ct_build_clone(struct ct_ctx *ctx, struct ct_arena *a,
                                const struct ct_build *from);
/// Derives kinematics, Phi, J and gam, and with_dynamics also the loads.
bool ct_build_derive(struct ct_build *b, bool with_dynamics);

#endif
