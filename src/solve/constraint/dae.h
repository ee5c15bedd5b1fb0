// A evaluator and its coordinate partitioning as the constrained second-order problem that implicit
// methods solve.
#ifndef CT_SOLVE_CONSTRAINT_DAE_H
#define CT_SOLVE_CONSTRAINT_DAE_H

#include "integrate/problem.h"
#include "solve/constraint/partition.h"

/// The rows are those the coordinate partitioning keeps; the others, dependent on them, have no
/// multiplier. The equations must have a residual. Tables live in a.
struct ct_dae *ct_dae_create(struct ct_arena *a, struct ct_partition *s);

#endif
