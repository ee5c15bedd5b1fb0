// Texts that are one quantity: a number with a unit.
#ifndef CT_EXPR_QUANTITY_H
#define CT_EXPR_QUANTITY_H

#include "expr/parse.h"

/// The number and the unit, which may turn out to be none; false if the text is something else. *unit is then where its
/// number ends.
bool ct_quantity_split(const char *text, double *value, const char **unit);
/// In SI units, of the dimension that is wanted. Errors: those of ct_parse.
bool ct_quantity_read(struct ct_ctx *ctx, const struct ct_scope *scope, struct ct_text text,
                      double value, const char *unit, ct_ex *e);

#endif
