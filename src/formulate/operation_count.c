// See operation_count.h.
#include "formulate/operation_count.h"

double ct_counted_cost(const struct ct_tape_counts *c)
{
    // Chosen: relative cost of a function.
    const double per_function = 8;
    // Default: relative cost of a division. Test: operation_counts
    const double per_division = 4;
    return (double)(c->multiplications + c->additions) + per_division * (double)c->divisions
         + per_function * (double)c->functions;
}
