// See operation_count.h.
#include "formulate/operation_count.h"

double ct_counted_cost(const struct ct_tape_counts *c)
{
    // Chosen: relative cost of functions and divisions.
    const double per_function = 8, per_division = 4;
    return (double)(c->multiplications + c->additions) + per_division * (double)c->divisions
         + per_function * (double)c->functions;
}
