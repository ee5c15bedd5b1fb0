// The unit of an output, derived from the signals in it.
#ifndef CT_DRAW_DIMENSION_H
#define CT_DRAW_DIMENSION_H

#include "formulate/equations.h"

/// Unit of an output: "m", "rad/s", "" for a number without unit; NULL if it is unknown, as for
/// a product with a parameter.
const char *ct_result_unit(const struct ct_equations *e, size_t result);

#endif
