// See sheet.h.
#include "io/sheet.h"

#include <string.h>

struct scan {
    struct ct_ctx *ctx;
    struct ct_arena *a;
    struct ct_sheet *csv;
    char *p, *end;
    int line;
    char *line_start;
    size_t nfield, field_cap, mark_cap, nmark;
};

static struct ct_mark here(const struct scan *s)
{
    return (struct ct_mark){s->csv->file, s->line, (int)(s->p - s->line_start), true};
}

static bool at_break(const struct scan *s)
{
    return s->p < s->end && (*s->p == '\n' || (*s->p == '\r' && s->p[1] == '\n'));
}

static void skip_break(struct scan *s)
{
    s->p += *s->p == '\r' ? 2 : 1;
    s->line++;
    s->line_start = s->p;
}

// Reads a quoted field. Its contents move to the front, over the doubled quotes; *last is the
// place for the NUL.
static bool scan_quoted(struct scan *s, char **last)
{
    const struct ct_mark open = here(s);
    char *to = ++s->p;
    for (; s->p < s->end; s->p++) {
        if (*s->p == '"') {
            if (s->p[1] != '"')
                break;
            s->p++;
        } else if (*s->p == '\n') {
            s->line++;
            s->line_start = s->p + 1;
        }
        *to++ = *s->p;
    }
    if (s->p >= s->end)
        return ct_error(s->ctx, open, CT_E_TABLE_DATA, "the quote is never closed");
    s->p++;
    *last = to;
    if (s->p < s->end && *s->p != ',' && !at_break(s))
        return ct_error(s->ctx, here(s), CT_E_TABLE_DATA, "a comma is wanted after the quote");
    return true;
}

static bool scan_field(struct scan *s, size_t row, bool *row_ends)
{
    const struct ct_mark mark = here(s);
    char *start = s->p, *last = start;
    if (s->p < s->end && *s->p == '"') {
        start++;
        if (!scan_quoted(s, &last))
            return false;
    } else {
        while (s->p < s->end && *s->p != ',' && !at_break(s))
            s->p++;
        last = s->p;
    }
    if (s->csv->ncolumn && s->nfield - row * s->csv->ncolumn >= s->csv->ncolumn)
        return ct_error(s->ctx, mark, CT_E_TABLE_DATA,
                        "the row has more fields than the header (%zu)", s->csv->ncolumn);
    CT_PUSH(s->a, s->csv->field, s->nfield, s->field_cap, start);
    CT_PUSH(s->a, s->csv->mark, s->nmark, s->mark_cap, mark);
    *row_ends = s->p >= s->end || *s->p != ',';
    if (!*row_ends)
        s->p++;
    else if (s->p < s->end)
        skip_break(s);
    *last = 0; // after the separator has been read, which may be at this place
    return true;
}

static void trim_end(struct scan *s)
{
    while (s->end > s->p && (s->end[-1] == '\n' || s->end[-1] == '\r'))
        s->end--;
    *s->end = 0;
}

bool ct_sheet_parse(struct ct_ctx *ctx, struct ct_arena *a, const char *file, char *text,
                    size_t n, struct ct_sheet *csv)
{
    *csv = (struct ct_sheet){.file = file};
    struct scan s = {.ctx = ctx, .a = a, .csv = csv, .p = text, .end = text + n};
    if (memchr(text, 0, n))
        return ct_error(ctx, (struct ct_mark){file, 0, 0, true}, CT_E_TABLE_DATA,
                        "the file is no text: it contains the character NUL");
    if (n >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0)
        s.p += 3;
    s.line_start = s.p;
    trim_end(&s);
    while (s.p < s.end) {
        const struct ct_mark mark = here(&s);
        bool row_ends = false;
        while (!row_ends)
            if (!scan_field(&s, csv->nrow, &row_ends))
                return false;
        if (!csv->ncolumn)
            csv->ncolumn = s.nfield;
        if (s.nfield != (csv->nrow + 1) * csv->ncolumn)
            return ct_error(ctx, mark, CT_E_TABLE_DATA,
                            "the row has %zu field%s, the header %zu",
                            s.nfield - csv->nrow * csv->ncolumn,
                            s.nfield - csv->nrow * csv->ncolumn == 1 ? "" : "s", csv->ncolumn);
        csv->nrow++;
    }
    return true;
}
