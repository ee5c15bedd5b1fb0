// Accelerations of an open system in closed form, by composite bodies (mass matrix) or articulated
// bodies, whichever needs fewer operations.
#ifndef CT_FORMULATE_RECURSIVE_OPEN_CHAIN_H
#define CT_FORMULATE_RECURSIVE_OPEN_CHAIN_H

#include "formulate/build.h"

/// That of the accelerations by articulated bodies where they would be taken, else by_matrix, what
/// the mass matrix costs. After ct_loads_derive.
double ct_open_cost(struct ct_build *b, double by_matrix);

/// Fill b->eqs->solution and b->eqs->formulation for a system without constraints. The solution
/// stays NULL where a call of a solver for dense matrices is cheaper. M and Q of the equations stay
/// open where no formulation that is in question needs them. After ct_loads_derive.
///
/// which    CT_FORMULATION_AUTO, or the one to take; another one where it does not apply
void ct_open_solve(struct ct_build *b, enum ct_formulation which);

#endif
