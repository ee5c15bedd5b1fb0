// Recursive dynamics of open systems. This folder represents an open system as a tree of members
// and derives its accelerations in closed form: by composite bodies (mass matrix) or by articulated
// bodies, whichever needs fewer operations.
#ifndef CT_FORMULATE_RECURSIVE_OPEN_CHAIN_H
#define CT_FORMULATE_RECURSIVE_OPEN_CHAIN_H

#include "formulate/build.h"

/// Operation count of the accelerations: by articulated bodies if they would be chosen, else
/// by_matrix, the cost with the mass matrix. After ct_loads_derive.
double ct_open_cost(struct ct_build *b, double by_matrix);

/// Sets b->eqs->solution and b->eqs->formulation for a system without constraints. The solution
/// stays NULL if a call of a dense solver is cheaper. M and Q are derived only if a candidate needs
/// them. After ct_loads_derive.
///
/// which    CT_FORMULATION_AUTO or the requested one; if that does not apply another one is taken
void ct_open_solve(struct ct_build *b, enum ct_formulation which);

#endif
