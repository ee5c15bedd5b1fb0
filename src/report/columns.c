// See columns.h.
#include "report/columns.h"

#include "report/csv.h"
#include "report/json.h"

#include <assert.h>
#include <math.h>
#include <string.h>

bool ct_has_suffix(const char *path, const char *suffix)
{
    const size_t n = strlen(path), k = strlen(suffix);
    return n >= k && strcmp(path + n - k, suffix) == 0;
}

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

static bool write_csv(struct ct_ctx *ctx, const struct ct_columns *t, const char *path)
{
    struct ct_csv w;
    const char **name = CT_NEWN(t->arena, const char *, t->ncolumn);
    for (size_t i = 0; i < t->ncolumn; i++)
        name[i] = t->column[i].name;
    if (!ct_csv_open(ctx, &w, path && strcmp(path, "-") != 0 ? path : NULL, name, t->ncolumn))
        return false;
    for (size_t r = 0; r < t->column[0].n; r++) {
        for (size_t i = 0; i < t->ncolumn; i++) {
            const struct ct_column *c = &t->column[i];
            assert(c->n == t->column[0].n);
            if (c->kind == CT_COLUMN_TEXT)
                ct_csv_text(&w, c->text[r]);
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

static bool write_json(struct ct_ctx *ctx, const struct ct_columns *t, const char *path)
{
    struct ct_outfile file;
    struct ct_json j;
    if (!ct_outfile_open(ctx, &file, path))
        return false;
    ct_json_init(&j, file.stream);
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
    return ct_outfile_close(ctx, &file);
}

bool ct_columns_write(struct ct_ctx *ctx, const struct ct_columns *t, const char *path)
{
    return path && ct_has_suffix(path, ".json") ? write_json(ctx, t, path)
                                                : write_csv(ctx, t, path);
}
