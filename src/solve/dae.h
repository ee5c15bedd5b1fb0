// A machine and its embedding as the constrained second-order problem that implicit methods solve.
#ifndef CT_SOLVE_DAE_H
#define CT_SOLVE_DAE_H

#include "integrate/problem.h"
#include "solve/embed.h"

/// The rows are those the embedding keeps; the others, dependent on them, have no multiplier. The equations must have a
/// residual. Tables live in a.
struct ct_dae *ct_dae_create(struct ct_arena *a, struct ct_embed *s);

#endif
