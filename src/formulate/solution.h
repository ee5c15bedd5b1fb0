// Accelerations of an open system in closed form: M u' = Q solved on the expressions.
#ifndef CT_FORMULATE_SOLUTION_H
#define CT_FORMULATE_SOLUTION_H

#include "formulate/build.h"

/// Fill b->eqs->solution, where there are no constraints and so few speeds that the unrolled solution is cheaper than
/// a call of a solver; else it stays NULL.
void ct_solution_derive(struct ct_build *b);

#endif
