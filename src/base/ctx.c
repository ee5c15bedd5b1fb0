// Diagnostics; see ctx.h.
#include "base/ctx.h"
#include "base/entry.h"

#include <stdlib.h>
#include <string.h>

// Limit: number of diagnostics that are kept; the rest is only counted.
enum { MOST_KEPT = 100 };

static void record(struct ct_ctx *ctx, enum ct_severity severity, enum ct_code code,
                   struct ct_mark mark, const char *fmt, va_list ap)
    __attribute__((format(printf, 5, 0)));

static void record(struct ct_ctx *ctx, enum ct_severity severity, enum ct_code code,
                   struct ct_mark mark, const char *fmt, va_list ap)
{
    const bool is_error = severity == CT_SEVERITY_ERROR;
    if (ctx->ndiagnostic >= MOST_KEPT) {
        ctx->nunseen++;
        ctx->nerror += is_error;
        return;
    }
    const struct ct_finding d = {severity, code, mark, ct_arena_vprintf(ctx->model, fmt, ap)};
    CT_PUSH(ctx->model, ctx->diagnostic, ctx->ndiagnostic, ctx->diagnostic_cap, d);
    ctx->nerror += is_error;
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

// Print text that may come from the file, in one line and without control characters, which could
// steer a terminal.
static void print_plain(const char *text, FILE *out)
{
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        fputc((c < ' ' && c != '\t') || c == 127 ? '?' : c, out);
    }
}

// Layout: length of the excerpt of a long line, and its part before the column.
enum { EXCERPT = 250, EXCERPT_BEFORE = 60 };

static bool skip_lines(FILE *f, int n)
{
    for (int c = 0; n > 0 && c != EOF; n -= c == '\n')
        c = getc(f);
    return n == 0;
}

static bool is_end_of_line(int c)
{
    return c == EOF || c == '\n' || c == '\r';
}

// Print the line of a file with a caret under the column; nothing if the file cannot be read again.
static void print_source_line(struct ct_mark m, FILE *out)
{
    FILE *f = fopen(m.file, "r");
    if (!f)
        return;
    char line[EXCERPT + 1];
    const int start = m.column < EXCERPT - EXCERPT_BEFORE ? 0 : m.column - EXCERPT_BEFORE;
    int n = 0, c = 0;
    bool is_there = skip_lines(f, m.line);
    for (int i = 0; is_there && i < start; i++)
        is_there = !is_end_of_line(getc(f));
    while (is_there && n < EXCERPT && !is_end_of_line(c = getc(f)))
        line[n++] = (char)c;
    line[n] = 0;
    if (is_there && n > 0 && m.column - start <= n) {
        const char *const before = start > 0 ? "..." : "";
        const bool is_cut = n == EXCERPT && !is_end_of_line(getc(f));
        fprintf(out, "%5d | %s", m.line + 1, before);
        print_plain(line, out);
        fprintf(out, "%s\n      | %*s", is_cut ? "..." : "", (int)strlen(before), "");
        for (int i = 0; i < m.column - start; i++)
            fputc(line[i] == '\t' ? '\t' : ' ', out);
        fputs("^\n", out);
    }
    fclose(f);
}

static bool has_code(const struct ct_ctx *ctx, enum ct_code code)
{
    for (size_t i = 0; i < ctx->ndiagnostic; i++)
        if (ctx->diagnostic[i].code == code)
            return true;
    return false;
}

void ct_ctx_print(const struct ct_ctx *ctx, FILE *out)
{
    static const char *const word[] = {"error", "warning", "note"};
    for (size_t i = 0; i < ctx->ndiagnostic; i++) {
        const struct ct_finding *d = &ctx->diagnostic[i];
        if (d->mark.file) {
            print_plain(d->mark.file, out);
            fprintf(out, ":%d:%d: ", d->mark.line + 1, d->mark.column + 1);
        } else {
            fputs("cotree: ", out);
        }
        fprintf(out, "%s: ", word[d->severity]);
        print_plain(d->text, out);
        if (d->code)
            fprintf(out, " [E%03d]", d->code);
        fputc('\n', out);
        if (d->mark.file && !d->mark.is_table)
            print_source_line(d->mark, out);
    }
    if (ctx->nunseen)
        fprintf(out, "cotree: note: %zu more messages are not shown\n", ctx->nunseen);
    if (ctx->was_interrupted && !has_code(ctx, CT_E_INTERRUPTED))
        fprintf(out,
                "cotree: error: interrupted before there were results; the same command begins "
                "anew [E%03d]\n",
                CT_E_INTERRUPTED);
    if (ctx->no_memory)
        fprintf(out, "cotree: error: out of memory [E%03d]\n", CT_E_MEMORY);
}

// Edit distance with adjacent swaps (Damerau-Levenshtein); stops beyond `limit`. Quadratic, as
// names are short.
static size_t edit_distance(const char *a, const char *b, size_t limit)
{
    enum { LONGEST = 63 }; // Limit: of names that are compared
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
        // at least half of the letters must agree: `r` is not suggested for `t`
        if (d < best_distance && 2 * d <= (given > known ? given : known)) {
            best_distance = d;
            best = names[i];
        }
    }
    return best;
}
