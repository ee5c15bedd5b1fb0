// What the suffix of a file asks for.
//
// What always holds: a file is written in the format that its name promises, or not at all.
#ifndef CT_REPORT_SUFFIX_H
#define CT_REPORT_SUFFIX_H

#include "base/ctx.h"

/// Bits, so that they can be listed; what a name without suffix gets is the lowest one of a list.
enum ct_suffix {
    CT_SUFFIX_CSV = 1,
    CT_SUFFIX_CSV_GZ = 2,
    CT_SUFFIX_JSON = 4,
    CT_SUFFIX_NPZ = 8,
    CT_SUFFIX_MAT = 16,
    CT_SUFFIX_SVG = 32,
    CT_SUFFIX_TABLE
    = CT_SUFFIX_CSV | CT_SUFFIX_CSV_GZ | CT_SUFFIX_JSON | CT_SUFFIX_NPZ | CT_SUFFIX_MAT
};

/// The one of `allowed` that a path ends with, in capitals or not; of NULL and "-" the lowest one.
/// Errors: E007 if it ends with something else.
bool ct_suffix_read(struct ct_ctx *ctx, const char *path, unsigned allowed,
                    enum ct_suffix *suffix);

#endif
