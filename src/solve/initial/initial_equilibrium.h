// Initial static equilibrium: the deformed shape of beams with `initial: equilibrium`.
#ifndef CT_SOLVE_INITIAL_INITIAL_EQUILIBRIUM_H
#define CT_SOLVE_INITIAL_INITIAL_EQUILIBRIUM_H

#include "solve/initial/assembly.h"

/// Does a beam of the model have `initial: equilibrium`?
bool ct_initial_equilibrium_is_wanted(const struct ct_model *model);

/// For each joint: is its initial value demanded, so that its coordinates stay? Trees then go
/// through it where possible (formulate.h: `first`).
bool *ct_initial_equilibrium_fixed_joints(struct ct_arena *a, const struct ct_model *model);

/// Elastic coordinates of the beams that start in equilibrium: Q + J' lam = 0 in their rows at
/// t = 0 and zero speeds, by Newton's method with the exact derivative. Other coordinates are held
/// at their initial values. In closed loops as many are held as are independent, demanded ones
/// first; the loops determine the rest.
///
///     e       in      equations with drivers held (formulate.h: `held`) and all joints measured,
///                     on trees through joints, demanded joints first
///     moving  in      the same with moving drivers, for the speeds in closed loops
///     start   in/out  elastic; in closed loops also q and u of all coordinates, and elastic_rate
///                     where loops can move only with beams that deform
///
/// Errors: CT_E_INITIAL_EQUILIBRIUM when no equilibrium is found.
bool ct_initial_equilibrium_solve(struct ct_ctx *ctx, struct ct_arena *a,
                                  const struct ct_model *model, const struct ct_equations *e,
                                  const struct ct_equations *moving,
                                  struct ct_initial_state *start);

#endif
