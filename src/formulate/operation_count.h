// Operations of expressions in one number, so that ways to write the same equations can be
// compared.
#ifndef CT_FORMULATE_OPERATION_COUNT_H
#define CT_FORMULATE_OPERATION_COUNT_H

#include "expr/listing.h"

/// Operations in multiplications.
double ct_counted_cost(const struct ct_tape_counts *c);

/// Time of an operation on one of four lanes against one alone. Derived: a quarter, and something
/// for the loads.
#define CT_LANE_COST 0.3

/// Part of a cost from which another formulation or order is taken instead of the usual one: counts
/// do not tell programs apart that differ by less than a tenth.
/// Default: the usual form for readers against a shorter program. Test: solvers.
#define CT_CLEARLY_CHEAPER 0.9

#endif
