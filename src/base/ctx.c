// Diagnostics; see ctx.h.
#include "base/ctx.h"

#include <stdlib.h>
#include <string.h>

static void record(struct ct_ctx *ctx, enum ct_severity severity, enum ct_code code,
                   struct ct_mark mark, const char *fmt, va_list ap)
    __attribute__((format(printf, 5, 0)));

static void record(struct ct_ctx *ctx, enum ct_severity severity, enum ct_code code,
                   struct ct_mark mark, const char *fmt, va_list ap)
{
    const struct ct_diagnostic d
        = {severity, code, mark, ct_arena_vprintf(ctx->model, fmt, ap)};
    CT_PUSH(ctx->model, ctx->diagnostic, ctx->ndiagnostic, ctx->diagnostic_cap, d);
    ctx->nerror += severity == CT_SEVERITY_ERROR;
}

bool ct_error(struct ct_ctx *ctx, struct ct_mark mark, enum ct_code code, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    record(ctx, CT_SEVERITY_ERROR, code, mark, fmt, ap);
    va_end(ap);
    return false;
}

void ct_warning(struct ct_ctx *ctx, struct ct_mark mark, enum ct_code code, const char *fmt,
                ...)
{
    va_list ap;
    va_start(ap, fmt);
    record(ctx, CT_SEVERITY_WARNING, code, mark, fmt, ap);
    va_end(ap);
}

void ct_note(struct ct_ctx *ctx, struct ct_mark mark, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    record(ctx, CT_SEVERITY_NOTE, 0, mark, fmt, ap);
    va_end(ap);
}

// Text that may be the file's own, in one line and without what would steer a terminal.
static void print_plain(const char *text, FILE *out)
{
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        fputc((c < ' ' && c != '\t') || c == 127 ? '?' : c, out);
    }
}

// The line of a file with a caret under the column; silent when the file cannot be read again.
static void print_source_line(struct ct_mark m, FILE *out)
{
    FILE *f = fopen(m.file, "r");
    if (!f)
        return;
    char line[256];
    for (int i = 0; fgets(line, sizeof line, f);) {
        const size_t n = strlen(line);
        const bool whole = n && line[n - 1] == '\n';
        if (i == m.line) {
            line[strcspn(line, "\r\n")] = 0;
            if ((size_t)m.column <= strlen(line)) {
                fprintf(out, "%5d | ", m.line + 1);
                print_plain(line, out);
                fputs("\n      | ", out);
                for (int c = 0; c < m.column; c++)
                    fputc(line[c] == '\t' ? '\t' : ' ', out);
                fputs("^\n", out);
            }
            break;
        }
        i += whole;
    }
    fclose(f);
}

void ct_ctx_print(const struct ct_ctx *ctx, FILE *out)
{
    static const char *const word[] = {"error", "warning", "note"};
    for (size_t i = 0; i < ctx->ndiagnostic; i++) {
        const struct ct_diagnostic *d = &ctx->diagnostic[i];
        if (d->mark.file)
            fprintf(out, "%s:%d:%d: ", d->mark.file, d->mark.line + 1, d->mark.column + 1);
        else
            fputs("cotree: ", out);
        fprintf(out, "%s: ", word[d->severity]);
        print_plain(d->text, out);
        if (d->code)
            fprintf(out, " [E%03d]", d->code);
        fputc('\n', out);
        // each line costs a pass over the file; nobody reads on after so many
        if (d->mark.file && i < 200)
            print_source_line(d->mark, out);
    }
    if (ctx->no_memory)
        fprintf(out, "cotree: error: out of memory [E%03d]\n", CT_E_MEMORY);
}

// Edit distance with adjacent swaps, given up beyond `limit`. Names are short: quadratic is fine.
static size_t edit_distance(const char *a, const char *b, size_t limit)
{
    enum { LONGEST = 63 };
    const size_t na = strlen(a), nb = strlen(b);
    if (na > LONGEST || nb > LONGEST || (na > nb ? na - nb : nb - na) > limit)
        return limit + 1;
    size_t row[3][LONGEST + 1];
    for (size_t j = 0; j <= nb; j++)
        row[0][j] = j;
    for (size_t i = 1; i <= na; i++) {
        size_t *now = row[i % 3];
        const size_t *up = row[(i + 2) % 3], *upup = row[(i + 1) % 3];
        now[0] = i;
        for (size_t j = 1; j <= nb; j++) {
            size_t d = up[j - 1] + (a[i - 1] != b[j - 1]);
            if (up[j] + 1 < d)
                d = up[j] + 1;
            if (now[j - 1] + 1 < d)
                d = now[j - 1] + 1;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]
                && upup[j - 2] + 1 < d)
                d = upup[j - 2] + 1;
            now[j] = d;
        }
    }
    return row[na % 3][nb];
}

const char *ct_nearest(const char *name, const char *const *names, size_t n)
{
    const char *best = NULL;
    size_t best_distance = strlen(name) / 3 + 2; // one slip in three letters
    for (size_t i = 0; i < n; i++) {
        const size_t d = edit_distance(name, names[i], best_distance);
        const size_t given = strlen(name), known = strlen(names[i]);
        // at least half of the letters agree: `r` is no misspelt `t`
        if (d < best_distance && 2 * d <= (given > known ? given : known)) {
            best_distance = d;
            best = names[i];
        }
    }
    return best;
}
