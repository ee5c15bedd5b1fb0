// CSV tables as in RFC 4180: rows of fields, quoted where they contain a comma, a quote or a line
// break.
#ifndef CT_IO_SHEET_H
#define CT_IO_SHEET_H

#include "base/ctx.h"

struct ct_sheet {
    const char *file;
    size_t nrow, ncolumn; // the header counts as a row; every row has ncolumn fields
    char **field;         // field[row * ncolumn + column]
    struct ct_mark *mark; // of each
};

/// Splits text (changed in place, with a NUL behind its n bytes) into fields. Skips a byte
/// order mark, and empty lines at the end. All in arena a. Errors: E135 with a mark in the
/// file.
bool ct_sheet_parse(struct ct_ctx *ctx, struct ct_arena *a, const char *file, char *text,
                    size_t n, struct ct_sheet *csv);

#endif
