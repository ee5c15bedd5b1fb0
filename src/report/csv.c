// See csv.h.
#include "report/csv.h"

#include "report/deflate.h"
#include "report/number.h"

#include <assert.h>
#include <string.h>

// Limit: of a buffer
enum { WAITING = 1 << 15 }; // bytes of rows that are written at once

bool ct_csv_open(struct ct_ctx *ctx, struct ct_csv *w, const char *path, enum ct_suffix suffix,
                 const char *const *column, size_t ncolumn)
{
    *w = (struct ct_csv){.ncolumn = ncolumn, .arena = ctx->model};
    if (!ct_outfile_open(ctx, &w->file, path))
        return false;
    if (suffix == CT_SUFFIX_CSV_GZ)
        w->gzip = ct_gzip_create(w->arena, w->file.stream);
    for (size_t i = 0; i < ncolumn; i++)
        ct_csv_text(w, column[i]);
    return ct_csv_end_row(ctx, w);
}

static void put(struct ct_csv *w, char c)
{
    CT_PUSH(w->arena, w->text, w->n, w->cap, c);
}

static void separate(struct ct_csv *w)
{
    assert(w->nfield < w->ncolumn);
    if (w->nfield++)
        put(w, ',');
}

void ct_csv_number(struct ct_csv *w, double value)
{
    char text[CT_NUMBER_SIZE];
    separate(w);
    for (const char *s = ct_number_format(text, value); *s; s++)
        put(w, *s);
}

void ct_csv_text(struct ct_csv *w, const char *text)
{
    const bool is_quoted = strpbrk(text, ",\"\r\n");
    separate(w);
    if (is_quoted)
        put(w, '"');
    for (const char *s = text; *s; s++) {
        if (*s == '"')
            put(w, '"');
        put(w, *s);
    }
    if (is_quoted)
        put(w, '"');
}

// Writes whole rows; the stream buffers none of them.
static void write_rows(struct ct_csv *w)
{
    if (w->gzip)
        ct_gzip_write(w->gzip, w->text, w->n);
    else
        fwrite(w->text, 1, w->n, w->file.stream);
    w->n = 0;
}

bool ct_csv_end_row(struct ct_ctx *ctx, struct ct_csv *w)
{
    assert(w->nfield == w->ncolumn);
    w->nfield = 0;
    put(w, '\n');
    return w->n < WAITING || ct_csv_flush(ctx, w);
}

bool ct_csv_flush(struct ct_ctx *ctx, struct ct_csv *w)
{
    write_rows(w);
    return ct_outfile_flush(ctx, &w->file);
}

bool ct_csv_close(struct ct_ctx *ctx, struct ct_csv *w)
{
    write_rows(w);
    ct_gzip_finish(w->gzip);
    return ct_outfile_close(ctx, &w->file);
}

void ct_csv_abandon(struct ct_csv *w)
{
    if (w->file.stream) {
        while (w->nfield && w->n && w->text[w->n - 1] != '\n') // memory ran out within a row
            w->n--;
        write_rows(w);
        ct_gzip_finish(w->gzip);
    }
    ct_outfile_abandon(&w->file);
}
