// Samples packed as text, for the page of a report.
//
//     numbers -> multiples k of a step -> second differences -> bytes, plane by plane -> deflate -> base64
//
// Columns of samples are smooth, so that second differences are small: most of their bytes are
// zero. A step is 2^-24 of a column's range, below the resolution of a screen and of four
// digits.
//
// What always holds: the same numbers give the same bytes; unpacked numbers differ by half a
// step of their column at most; values that are not finite come back as NaN. web/packed.js
// reads them.
#ifndef CT_REPORT_PACKED_H
#define CT_REPORT_PACKED_H

#include "base/arena.h"
#include "report/json.h"

/// A table of nrow rows and ncolumn columns, row by row, as the member `key` of an open object:
///
///     {"count": nrow, "columns": ncolumn, "low": [...], "step": [...], "data": "base64"}
///
/// a: workspace. Returns the length of `data`.
size_t ct_pack_write(struct ct_json *j, struct ct_arena *a, const char *key,
                     const double *value, size_t nrow, size_t ncolumn);

/// The same with a step not smaller than resolution[c] in column c. NULL: 0.
size_t ct_pack_write_rounded(struct ct_json *j, struct ct_arena *a, const char *key,
                             const double *value, size_t nrow, size_t ncolumn,
                             const double *resolution);

/// Encodes n bytes in base64 (RFC 4648), in arena a.
char *ct_base64(struct ct_arena *a, const unsigned char *b, size_t n);

#endif
