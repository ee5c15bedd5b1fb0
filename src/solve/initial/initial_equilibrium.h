// Initial static equilibrium: the deformed shape of beams with `initial: equilibrium`.
#ifndef CT_SOLVE_INITIAL_INITIAL_EQUILIBRIUM_H
#define CT_SOLVE_INITIAL_INITIAL_EQUILIBRIUM_H

#include "solve/initial/assembly.h"

/// Does a beam of the model ask for it?
bool ct_initial_equilibrium_is_wanted(const struct ct_model *model);

/// For each joint: is its initial value given, so that its coordinates stay? Trees then go through
/// it where possible (formulate.h: `first`).
bool *ct_initial_equilibrium_fixed_joints(struct ct_arena *a, const struct ct_model *model);

/// The elastic coordinates of the beams that start in equilibrium: Q + J' lam = 0 in their rows at
/// t = 0, everything at rest. Other coordinates stay as in the start; in closed loops those that
/// are given, then others, as far as the loops leave them free, while the rest follows.
///
/// e       in      for held drivers (formulate.h: `held`), all joints measured, on trees through
/// joints with those given first moving  in      the same on the same trees, drivers not held: for
/// speeds; used in closed loops alone start   in/out  elastic; in closed loops q and u of all
/// coordinates, too, and elastic_rate where these move by bending alone
///
/// Newton's method with the exact derivative.
/// Errors: CT_E_SETTLE when no equilibrium is found.
bool ct_initial_equilibrium_solve(struct ct_ctx *ctx, struct ct_arena *a,
                                  const struct ct_model *model, const struct ct_equations *e,
                                  const struct ct_equations *moving,
                                  struct ct_initial_state *start);

#endif
