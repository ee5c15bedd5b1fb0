// The file format given by the suffix of a file name.
//
// What always holds: a file is written in the format of its suffix, or not at all.
#ifndef CT_REPORT_SUFFIX_H
#define CT_REPORT_SUFFIX_H

#include "base/ctx.h"

/// Bits, so that they can be combined; a name without suffix gets the lowest one of a list.
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

/// The suffix of a path, if it is one of `allowed`, in any case; for NULL and "-" the lowest
/// one.
/// Errors: E007 if it ends with something else.
bool ct_suffix_read(struct ct_ctx *ctx, const char *path, unsigned allowed,
                    enum ct_suffix *suffix);

#endif
