// The equations of motion as the differential-algebraic problem that implicit methods solve:
//
//     r(t, q, u, u', lam) = 0,   Phi(t, q) = 0,   v(t, q, u) = 0
//
// It is made from an evaluator and its coordinate partitioning.
#ifndef CT_SOLVE_CONSTRAINT_DAE_H
#define CT_SOLVE_CONSTRAINT_DAE_H

#include "integrate/problem.h"
#include "solve/constraint/partition.h"

/// The constraints are the rows retained by the partitioning; redundant rows have no multiplier.
/// The equations must have a residual. Owned by a.
struct ct_dae *ct_dae_create(struct ct_arena *a, struct ct_partition *s);

#endif
