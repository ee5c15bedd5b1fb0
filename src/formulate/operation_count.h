// Operation count as one number, to compare equivalent forms of the equations.
#ifndef CT_FORMULATE_OPERATION_COUNT_H
#define CT_FORMULATE_OPERATION_COUNT_H

#include "expr/listing.h"

/// Cost in multiplications.
double ct_counted_cost(const struct ct_tape_counts *c);

/// Time of one SIMD lane of four relative to a scalar operation. Derived: a quarter, plus loads.
#define CT_LANE_COST 0.3

/// One call of a dense solver, in operations of straight-line code.
/// Default: about the time of a call. Test: operation_counts
#define CT_DENSE_CALL_COST 300

/// Another formulation or order replaces the usual one if its cost is below this fraction. Counts
/// that differ by less than a tenth do not predict which program is faster. Default: the usual form
/// for readers against a shorter program. Test: operation_counts
#define CT_CLEARLY_CHEAPER 0.9

#endif
