// Small tables, column by column, written whole: CSV, or as FILE.json an object of columns.
#ifndef CT_REPORT_COLUMNS_H
#define CT_REPORT_COLUMNS_H

#include "base/ctx.h"

enum ct_column_kind { CT_COLUMN_NUMBER, CT_COLUMN_TEXT, CT_COLUMN_INTEGER };

struct ct_columns {
    struct ct_arena *arena;
    struct ct_column {
        const char *name;
        enum ct_column_kind kind;
        double *number; // NUMBER, INTEGER
        const char **text;
        size_t n, cap;
    } * column;
    size_t ncolumn, cap;
};

/// A table with its first column, number 0.
void ct_columns_init(struct ct_columns *t, struct ct_arena *a, const char *name,
                     enum ct_column_kind kind);
/// One more column; returns its number.
size_t ct_columns_add(struct ct_columns *t, const char *name, enum ct_column_kind kind);
/// Append to a column. Not finite: an empty field, null in JSON.
void ct_columns_number(struct ct_columns *t, size_t column, double value);
void ct_columns_text(struct ct_columns *t, size_t column, const char *text);
/// path NULL or "-": CSV on standard output. All columns have the same length. Errors: E002.
bool ct_columns_write(struct ct_ctx *ctx, const struct ct_columns *t, const char *path);

/// Does a path end like this?
bool ct_has_suffix(const char *path, const char *suffix);

#endif
