// Texts that are one quantity: a number with a unit.
#ifndef CT_EXPR_QUANTITY_H
#define CT_EXPR_QUANTITY_H

#include "base/ctx.h"

/// A whole text with its unit, and where it stands.
struct ct_quantity {
    const char *text, *unit;
    struct ct_mark mark;
    const char *wanted; // a unit of the dimension that is wanted; NULL: any
    /// Is the word a name that expressions know? Then the error is a missing operator, not a wrong
    /// unit.
    bool (*is_name)(const void *user, const char *word);
    const void *user;
};

/// Split a text into its number and its unit; whether the unit is known is not checked. False if
/// the text is no quantity; *unit is then the end of its number.
bool ct_quantity_split(const char *text, double *value, const char **unit);
/// value (in and out): the number, in SI units. Errors: E114, E118 to E120.
bool ct_quantity_read(struct ct_ctx *ctx, const struct ct_quantity *q, double *value);

#endif
