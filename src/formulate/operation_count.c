// See operation_count.h.
#include "formulate/operation_count.h"

double ct_counted_cost(const struct ct_tape_counts *c)
{
    // Derived: sine and cosine take 51 instructions together (expr/sincos_kernel.def), for four
    // angles at a time: 51/2 CT_LANE_COST = 8. Others are rare.
    const double per_function = 8;
    // Default: relative cost of a division. Test: operation_counts
    const double per_division = 4;
    return (double)(c->multiplications + c->additions) + per_division * (double)c->divisions
         + per_function * (double)c->functions;
}
