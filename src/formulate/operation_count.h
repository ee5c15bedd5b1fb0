// Operations of expressions in one number, so that ways to write the same equations can be
// compared.
#ifndef CT_FORMULATE_OPERATION_COUNT_H
#define CT_FORMULATE_OPERATION_COUNT_H

#include "expr/listing.h"

/// Operations in multiplications: a division counts 4, a function 8.
double ct_counted_cost(const struct ct_tape_counts *c);

#endif
