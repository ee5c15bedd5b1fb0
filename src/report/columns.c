// See columns.h.
#include "report/columns.h"

#include "report/archive.h"
#include "report/csv.h"
#include "report/json.h"

#include <assert.h>
#include <math.h>
#include <string.h>

void ct_columns_init(struct ct_columns *t, struct ct_arena *a, const char *name,
                     enum ct_column_kind kind)
{
    *t = (struct ct_columns){.arena = a};
    ct_columns_add(t, name, kind);
}

size_t ct_columns_add(struct ct_columns *t, const char *name, enum ct_column_kind kind)
{
    const struct ct_column c = {.name = name, .kind = kind};
    CT_PUSH(t->arena, t->column, t->ncolumn, t->cap, c);
    return t->ncolumn - 1;
}

void ct_columns_number(struct ct_columns *t, size_t column, double value)
{
    struct ct_column *c = &t->column[column];
    CT_PUSH(t->arena, c->number, c->n, c->cap, value);
}

void ct_columns_text(struct ct_columns *t, size_t column, const char *text)
{
    struct ct_column *c = &t->column[column];
    CT_PUSH(t->arena, c->text, c->n, c->cap, text);
}

static bool write_csv(struct ct_ctx *ctx, const struct ct_columns *t, const char *path,
                      enum ct_suffix suffix)
{
    struct ct_csv w;
    const char **name = CT_NEWN(t->arena, const char *, t->ncolumn);
    for (size_t i = 0; i < t->ncolumn; i++)
        name[i] = t->column[i].name;
    if (!ct_csv_open(ctx, &w, path, suffix, name, t->ncolumn))
        return false;
    for (size_t r = 0; r < t->column[0].n; r++) {
        for (size_t i = 0; i < t->ncolumn; i++) {
            const struct ct_column *c = &t->column[i];
            assert(c->n == t->column[0].n);
            if (c->kind == CT_COLUMN_TEXT)
                ct_csv_text(&w, c->text[r] ? c->text[r] : "");
            else if (isfinite(c->number[r]))
                ct_csv_number(&w, c->number[r]);
            else
                ct_csv_text(&w, "");
        }
        if (!ct_csv_end_row(ctx, &w)) {
            ct_csv_abandon(&w);
            return false;
        }
    }
    return ct_csv_close(ctx, &w);
}

static void write_json(const struct ct_columns *t, FILE *out)
{
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    for (size_t i = 0; i < t->ncolumn; i++) {
        const struct ct_column *c = &t->column[i];
        if (c->kind == CT_COLUMN_NUMBER) {
            ct_json_numbers(&j, c->name, c->number, c->n);
            continue;
        }
        ct_json_array(&j, c->name);
        for (size_t r = 0; r < c->n; r++)
            if (c->kind == CT_COLUMN_TEXT)
                ct_json_text(&j, NULL, c->text[r]);
            else
                ct_json_integer(&j, NULL, (long long)c->number[r]);
        ct_json_end(&j);
    }
    ct_json_end(&j);
}

// The arrays, and the names of all columns in order, as .mat changes names.
static void fill_archive(struct ct_archive *z, const struct ct_columns *t)
{
    const char **name = CT_NEWN(z->arena, const char *, t->ncolumn + 1);
    for (size_t i = 0; i < t->ncolumn; i++) {
        const struct ct_column *c = &t->column[i];
        name[i] = c->name;
        if (c->kind == CT_COLUMN_TEXT)
            ct_archive_names(z, c->name, c->text, c->n);
        else
            ct_archive_vector(z, c->name, c->number, c->n);
    }
    ct_archive_names(z, "columns", name, t->ncolumn);
}

bool ct_columns_put(struct ct_ctx *ctx, const struct ct_columns *t, enum ct_suffix suffix,
                    struct ct_outfile *file)
{
    if (suffix == CT_SUFFIX_JSON) {
        write_json(t, file->stream);
        return true;
    }
    struct ct_archive z;
    ct_archive_init(&z, ctx->model, suffix, file);
    fill_archive(&z, t);
    return ct_archive_finish(ctx, &z);
}

bool ct_columns_write(struct ct_ctx *ctx, const struct ct_columns *t, const char *path)
{
    enum ct_suffix suffix;
    struct ct_outfile file;
    if (!ct_suffix_read(ctx, path, CT_SUFFIX_TABLE, &suffix))
        return false;
    if (path && strcmp(path, "-") == 0)
        path = NULL;
    if (suffix == CT_SUFFIX_CSV || suffix == CT_SUFFIX_CSV_GZ)
        return write_csv(ctx, t, path, suffix);
    if (!ct_outfile_open(ctx, &file, path))
        return false;
    if (ct_columns_put(ctx, t, suffix, &file))
        return ct_outfile_close(ctx, &file);
    ct_outfile_discard(&file);
    return false;
}
