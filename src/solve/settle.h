// Static shape of beams that start in equilibrium.
#ifndef CT_SOLVE_SETTLE_H
#define CT_SOLVE_SETTLE_H

#include "solve/assemble.h"

/// Does a beam of the model ask for it?
bool ct_settle_wanted(const struct ct_model *model);

/// The elastic coordinates of the beams that start in equilibrium: Q = 0 in their rows at t = 0, everything at rest, all
/// other coordinates as in the start. e: equations for held drivers (formulate.h: `held`), on trees through joints.
/// Fills start->elastic. Newton's method with the exact derivative.
/// Errors: CT_E_SETTLE in closed loops, or when no equilibrium is found.
bool ct_settle(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
               const struct ct_equations *e, struct ct_start *start);

#endif
