// See csv.h.
#include "report/csv.h"

#include "report/number.h"

#include <assert.h>
#include <string.h>

bool ct_csv_open(struct ct_ctx *ctx, struct ct_csv *w, const char *path,
                 const char *const *column, size_t ncolumn)
{
    *w = (struct ct_csv){.ncolumn = ncolumn};
    if (!ct_outfile_open(ctx, &w->file, path))
        return false;
    for (size_t i = 0; i < ncolumn; i++)
        ct_csv_text(w, column[i]);
    return ct_csv_end_row(ctx, w);
}

bool ct_csv_row(struct ct_ctx *ctx, struct ct_csv *w, const double *value)
{
    for (size_t i = 0; i < w->ncolumn; i++)
        ct_csv_number(w, value[i]);
    return ct_csv_end_row(ctx, w);
}

static void separate(struct ct_csv *w)
{
    assert(w->nfield < w->ncolumn);
    if (w->nfield++)
        fputc(',', w->file.stream);
}

void ct_csv_number(struct ct_csv *w, double value)
{
    char text[CT_NUMBER_SIZE];
    separate(w);
    fputs(ct_number_format(text, value), w->file.stream);
}

void ct_csv_text(struct ct_csv *w, const char *text)
{
    FILE *out = w->file.stream;
    separate(w);
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (const char *s = text; *s; s++) {
        if (*s == '"')
            fputc('"', out);
        fputc(*s, out);
    }
    fputc('"', out);
}

bool ct_csv_end_row(struct ct_ctx *ctx, struct ct_csv *w)
{
    assert(w->nfield == w->ncolumn);
    w->nfield = 0;
    fputc('\n', w->file.stream);
    return !ferror(w->file.stream) || ct_outfile_flush(ctx, &w->file);
}

bool ct_csv_close(struct ct_ctx *ctx, struct ct_csv *w)
{
    return ct_outfile_close(ctx, &w->file);
}

void ct_csv_abandon(struct ct_csv *w)
{
    ct_outfile_abandon(&w->file);
}
