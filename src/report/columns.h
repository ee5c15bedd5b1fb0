// Tables, column by column, written whole: CSV, as FILE.json an object of columns, as FILE.npz
// or FILE.mat an array for each.
#ifndef CT_REPORT_COLUMNS_H
#define CT_REPORT_COLUMNS_H

#include "report/outfile.h"
#include "report/suffix.h"

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
/// Append to a column. Values that are not finite, and NULL: an empty field, null in JSON.
void ct_columns_number(struct ct_columns *t, size_t column, double value);
void ct_columns_text(struct ct_columns *t, size_t column, const char *text);
/// Writes the table to path; NULL or "-": CSV on standard output. All columns have the same
/// length.
/// Errors: E002, E006, E007.
bool ct_columns_write(struct ct_ctx *ctx, const struct ct_columns *t, const char *path);
/// Writes the table to an open file, which stays open; suffix: none of those of CSV. Errors:
/// E002.
bool ct_columns_put(struct ct_ctx *ctx, const struct ct_columns *t, enum ct_suffix suffix,
                    struct ct_outfile *file);

#endif
