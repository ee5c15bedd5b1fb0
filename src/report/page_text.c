// Pages as plain text; see page.h.
#include "report/page.h"

#include <ctype.h>
#include <string.h>

// ---- lines ---------------------------------------------------------------------------------

static void put_indent(FILE *out, size_t n)
{
    fprintf(out, "%*s", (int)n, "");
}

// Text, broken at blanks.
static void put_words(FILE *out, const char *s, size_t indent)
{
    size_t column = 0;
    while (*s) {
        size_t n = strcspn(s, " ");
        size_t width = 0;
        for (size_t i = 0; i < n; i++)
            width += ((unsigned char)s[i] & 0xC0) != 0x80;
        if (column == 0 || column + 1 + width > CT_PAGE_WIDTH) {
            if (column)
                fputs("\n", out);
            put_indent(out, indent);
            column = indent;
        } else {
            fputs(" ", out);
            column++;
        }
        fprintf(out, "%.*s", (int)n, s);
        column += width;
        s += n;
        s += strspn(s, " ");
    }
    fputs("\n", out);
}

// Position at which to break s after at most `room` characters: at the last sign of a sum or
// comma of a list with the fewest open brackets, otherwise before a factor; 0 if there is none.
static size_t break_position(const char *s, size_t room)
{
    size_t best = 0;
    int depth = 0, best_level = 0, best_rank = 9;
    for (size_t i = 0; i <= room && s[i]; i++) {
        if (s[i] == '(' || s[i] == '[')
            depth++;
        if (s[i] == ')' || s[i] == ']')
            depth--;
        int rank = 9, level = 2 * depth;
        if (i > 4 && s[i] == ' ' && (s[i + 1] == '+' || s[i + 1] == '-') && s[i + 2] == ' ')
            rank = 0;
        else if (i > 4 && s[i] == ' ' && s[i - 1] == ',')
            rank = 0, level--; // a list is broken before the sums in it
        else if (i > 4 && s[i] == '*' && depth == 0)
            rank = 1;
        if (rank == 9)
            continue;
        // a deeper sign is used only if all signs at the shallower level are in the first third
        const bool better = best == 0 || rank < best_rank
                         || (rank == best_rank && (level <= best_level || 3 * best < room));
        if (better) {
            best = i;
            best_level = level;
            best_rank = rank;
        }
    }
    return best;
}

// s from `column` on, continued on further lines at `indent`.
static void put_wrapped(FILE *out, const char *s, size_t column, size_t indent)
{
    size_t width = ct_text_width(s);
    while (column + width > CT_PAGE_WIDTH) {
        const size_t room = CT_PAGE_WIDTH > column ? CT_PAGE_WIDTH - column : 0;
        const size_t at = break_position(s, room);
        if (!at)
            break;
        const bool keep = s[at] == '*'; // the sign of a factor goes to the next line
        fprintf(out, "%.*s\n", (int)at, s);
        put_indent(out, indent);
        for (const char *end = s + at + !keep; s < end; s++)
            width -= ((unsigned char)*s & 0xC0) != 0x80;
        column = indent;
    }
    fputs(s, out);
}

// ---- blocks --------------------------------------------------------------------------------

static void put_note(FILE *out, const char *note)
{
    if (note)
        fprintf(out, "   (%s)", note);
    fputs("\n", out);
}

// A note below an equation that fills the line.
static void put_line_of_note(FILE *out, const char *note, size_t indent)
{
    fputs("\n", out);
    put_indent(out, indent);
    fprintf(out, "(%s)\n", note);
}

static void put_equation(FILE *out, const struct ct_page_equation *e, size_t label_width,
                         size_t left_width)
{
    // Layout: columns
    const size_t indent = 2;
    const size_t left = ct_text_width(e->left),
                 right = e->right ? 3 + ct_text_width(e->right) : 0;
    const size_t note = e->note ? 5 + ct_text_width(e->note) : 0;
    size_t column = indent;
    put_indent(out, indent);
    if (e->label) {
        fprintf(out, "%s:", e->label);
        column += ct_text_width(e->label) + 1;
        if (indent + label_width + 2 + left + right <= CT_PAGE_WIDTH) {
            put_indent(out, indent + label_width + 2 - column);
            column = indent + label_width + 2;
        } else {
            fputs("\n", out);
            put_indent(out, column = indent + 2);
        }
    }
    const size_t pad = e->right && !e->label && left_width > left ? left_width - left : 0;
    if (column + pad + left + right <= CT_PAGE_WIDTH) {
        fputs(e->left, out);
        put_indent(out, pad);
        if (e->right)
            fprintf(out, " = %s", e->right);
        const bool fits = column + pad + left + right + note <= CT_PAGE_WIDTH;
        if (!fits)
            put_line_of_note(out, e->note, column + pad + left + 3);
        else
            put_note(out, e->note);
        return;
    }
    // a short or aligned left side keeps the right side on its line
    const bool is_short = left < 14 || (!e->label && left <= left_width);
    put_wrapped(out, e->left, column, column + 4);
    size_t start = column + 4;
    if (e->right && is_short) {
        put_indent(out, pad);
        fputs(" = ", out);
        start = column + pad + left + 3;
        put_wrapped(out, e->right, start, *e->right == '[' ? start + 1 : start - 2);
    } else if (e->right) {
        fputs("\n", out);
        put_indent(out, column + 2);
        fputs("= ", out);
        put_wrapped(out, e->right, start, start);
    }
    if (e->note)
        put_line_of_note(out, e->note, start);
    else
        fputs("\n", out);
}

// Layout: left sides up to this width are padded to one width, so that equal signs are aligned.
enum { ALIGNED = 20 };

static void put_equations(FILE *out, const struct ct_page_block *b)
{
    size_t width = 0, left_width = 0;
    for (size_t i = 0; i < b->nequation; i++) {
        const size_t w = b->equation[i].label ? ct_text_width(b->equation[i].label) : 0;
        const size_t l = ct_text_width(b->equation[i].left);
        width = w > width ? w : width;
        left_width = l > left_width && l <= ALIGNED ? l : left_width;
    }
    for (size_t i = 0; i < b->nequation; i++)
        put_equation(out, &b->equation[i], width, left_width);
}

// Text from `column` on, broken at blanks.
static void put_cell_words(FILE *out, const char *s, size_t indent)
{
    size_t column = indent;
    while (*s) {
        const size_t n = strcspn(s, " ");
        if (column > indent && column + 1 + n > CT_PAGE_WIDTH) {
            fputs("\n", out);
            put_indent(out, indent);
            column = indent;
        } else if (column > indent) {
            fputs(" ", out);
            column++;
        }
        fprintf(out, "%.*s", (int)n, s);
        column += n;
        s += n;
        s += strspn(s, " ");
    }
}

static void put_row(FILE *out, const struct ct_page_block *b, size_t row, const size_t *width)
{
    const size_t n = strlen(b->align);
    size_t column = 0, pending = 2;
    for (size_t k = 0; k < n; k++) {
        const char *s = b->cell[row * n + k];
        const size_t w = ct_text_width(s), room = width[k] - w;
        const bool right = tolower((unsigned char)b->align[k]) == 'r';
        if (right)
            pending += room;
        if (*s) {
            put_indent(out, pending);
            column += pending;
            if (k + 1 == n && column + w > CT_PAGE_WIDTH && column < CT_PAGE_WIDTH - 20)
                put_cell_words(out, s, column);
            else
                fputs(s, out);
            column += w;
            pending = 0;
        }
        pending += 2 + (right ? 0 : *s ? room : width[k]);
    }
    fputs("\n", out);
}

// ---- matrices ------------------------------------------------------------------------------

static size_t column_width(const struct ct_page_block *b, size_t column)
{
    size_t width = 0;
    for (size_t i = column; i < b->ncell; i += b->ncolumn) {
        const size_t w = ct_text_width(b->cell[i]);
        width = w > width ? w : width;
    }
    return width;
}

bool ct_page_text_fits(const struct ct_page_block *b)
{
    size_t width = 0;
    for (size_t k = 0; k < b->ncolumn; k++)
        width += 2 + column_width(b, k);
    return width <= CT_PAGE_WIDTH;
}

// Names of rows to the left, entries to the right of their columns.
static void put_matrix(FILE *out, struct ct_arena *a, const struct ct_page_block *b)
{
    size_t *width = CT_NEWN(a, size_t, b->ncolumn), blank = 0;
    for (size_t k = 0; k < b->ncolumn; k++)
        width[k] = column_width(b, k);
    for (size_t i = 0; i < b->ncell; i++) {
        const size_t k = i % b->ncolumn, room = width[k] - ct_text_width(b->cell[i]);
        blank += k ? 2 + room : 2;
        if (*b->cell[i]) {
            put_indent(out, blank);
            fputs(b->cell[i], out);
            blank = 0;
        }
        blank += k ? 0 : room;
        if (k + 1 < b->ncolumn)
            continue;
        fputs("\n", out);
        blank = 0;
    }
}

// ---- tables --------------------------------------------------------------------------------

static void put_table(FILE *out, struct ct_arena *a, const struct ct_page_block *b)
{
    const size_t n = strlen(b->align);
    size_t *width = CT_NEWN(a, size_t, n);
    for (size_t i = 0; i < b->ncell; i++) {
        const size_t w = ct_text_width(b->cell[i]);
        width[i % n] = w > width[i % n] ? w : width[i % n];
    }
    for (size_t row = 0; row < b->ncell / n; row++)
        put_row(out, b, row, width);
}

void ct_page_print_text(FILE *out, const struct ct_page *p)
{
    for (size_t i = 0; i < p->nblock; i++) {
        const struct ct_page_block *b = &p->block[i];
        switch (b->kind) {
        case CT_PAGE_TITLE:
            fprintf(out, "%s%s\n", i ? "\n\n" : "", b->text);
            for (size_t k = ct_text_width(b->text); k > 0; k--)
                fputs("=", out);
            fputs("\n", out);
            break;
        case CT_PAGE_HEADING:
            fprintf(out, "\n%s\n", b->text);
            break;
        case CT_PAGE_SENTENCE:
            put_words(out, b->text, i && p->block[i - 1].kind == CT_PAGE_TITLE ? 0 : 2);
            break;
        case CT_PAGE_TABLE:
            put_table(out, p->arena, b);
            break;
        case CT_PAGE_EQUATIONS:
            put_equations(out, b);
            break;
        case CT_PAGE_MATRIX:
            put_matrix(out, p->arena, b);
            break;
        }
    }
}
