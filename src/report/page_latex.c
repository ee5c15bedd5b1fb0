// Pages as LaTeX; see page.h.
//
// Lines are broken by estimated widths (ct_latex_width). Groups of equations are align*, which
// may continue on the next page; columns of tables that are too wide become paragraphs.
#include "report/page.h"

#include "expr/print.h"

#include <ctype.h>
#include <string.h>

// ---- words ---------------------------------------------------------------------------------

// may_break: a line may end after the dots and underscores of a name.
static void put_characters(FILE *out, const char *s, size_t n, bool may_break)
{
    for (size_t i = 0; i < n; i++) {
        const char c = s[i];
        if (strchr("_#$%&{}", c))
            fprintf(out, "\\%c", c);
        else if (c == '^' || c == '~')
            fprintf(out, "\\%c{}", c);
        else if (c == '|')
            fputs("\\textbar{}", out);
        else if (c == '<' || c == '>')
            fputs(c == '<' ? "\\textless{}" : "\\textgreater{}", out);
        else if (c == '\\')
            fputs("\\textbackslash{}", out);
        else
            fputc(c, out);
        if (c == '-' && i + 1 < n && s[i + 1] == '-') // no dash
            fputs("{}", out);
        if (may_break && (c == '.' || c == '_') && i + 1 < n && s[i + 1] != ' ')
            fputs("\\allowbreak{}", out);
    }
}

static void put_words(FILE *out, const char *s)
{
    put_characters(out, s, strlen(s), true);
}

// Plain words at 10 pt [pt].
static size_t words_width(const char *s)
{
    size_t width = 0;
    for (; *s; s++)
        width += ((unsigned char)*s & 0xC0) == 0x80 ? 0
               : strchr("il.,: ", *s)               ? 3
               : strchr("mwMW", *s)                 ? 9
               : isupper((unsigned char)*s)         ? 8
                                                    : 5;
    return width;
}

// ---- equations -----------------------------------------------------------------------------

// Layout: indents of first and continued lines (\quad each), and the margin for errors of the
// estimate.
enum { LINE = CT_LATEX_LINE, QUAD = 10, SLACK = 12, EQUALS = 14 };

// Before a factor, or a relation.
static bool is_within_product(const char *s)
{
    return !strncmp(s, " \\, ", 4) || !strncmp(s, " < ", 3) || !strncmp(s, " > ", 3)
        || !strncmp(s, " \\leq ", 6) || !strncmp(s, " \\geq ", 6);
}

// Length of a piece up to the next possible line break: before a sign or a factor, at any depth
// of parentheses but not within braces or cases.
static size_t piece_of(const char *s, bool at_factors)
{
    int braces = 0;
    for (size_t i = 0; s[i]; i++) {
        braces += (s[i] == '{') - (s[i] == '}');
        braces += !strncmp(s + i, "\\begin", 6) - !strncmp(s + i, "\\end", 4);
        if (i == 0 || braces > 0)
            continue;
        if (!strncmp(s + i, " + ", 3) || !strncmp(s + i, " - ", 3)
            || !strncmp(s + i, ",\\; ", 4) || (at_factors && is_within_product(s + i)))
            return i;
    }
    return strlen(s);
}

// A line that is being written.
struct line {
    FILE *out;
    size_t column, room;      // [pt], from the start of the first line
    size_t indent;            // of further lines [pt]
    const char *continuation; // text that starts them
    size_t *nline;            // of the environment
};

// Layout: largest number of lines of an environment, which TeX keeps in memory. It ends between
// equations; within an equation it may have more.
enum { MOST_LINES = 60, MOST_LINES_WITHIN = 200 };

// Ends a line of align*, and the environment where it is long enough.
static void put_line_end(FILE *out, size_t *nline, size_t most)
{
    if (++*nline < most) {
        fputs(" \\\\\n", out);
        return;
    }
    fputs("\n\\end{align*}\n\\begin{align*}\n", out);
    *nline = 0;
}

static bool is_over(const struct line *l, size_t width)
{
    return l->column + width + SLACK > l->room && l->column > l->indent;
}

// Delimiters cannot span lines: invisible ones close and open the `depth` open ones. A sign
// after an empty group is a binary operator.
static void end_line(struct line *l, int depth)
{
    for (int i = 0; i < depth; i++)
        fputs(" \\right.", l->out);
    put_line_end(l->out, l->nline, MOST_LINES_WITHIN);
    fprintf(l->out, "    %s{}", l->continuation);
    for (int i = 0; i < depth; i++)
        fputs(" \\left.", l->out);
    fputs(depth ? " {}" : "", l->out);
    l->column = l->indent;
}

static int depth_after(int depth, const char *s, size_t n)
{
    for (size_t i = 0; i < n; i++)
        depth += !strncmp(s + i, "\\left", 5) - !strncmp(s + i, "\\right", 6);
    return depth;
}

// Breaks a term that is wider than a line: between products if a sum in it does not fit either.
static void put_wide_term(struct line *l, const char *s, size_t length)
{
    const char *end = s + length;
    int depth = 0;
    while (s < end) {
        size_t n = piece_of(s, false);
        if (l->indent + SLACK + ct_latex_width(s, n) > l->room)
            n = piece_of(s, true);
        if (!strncmp(s, " \\, ", 4)
            && is_over(l, ct_latex_width(s, n))) // within a product: its next factor
            n = piece_of(s, true);
        n = n < (size_t)(end - s) ? n : (size_t)(end - s);
        const size_t width = ct_latex_width(s, n);
        if (is_over(l, width)) {
            const bool is_list = !strncmp(s, ",\\; ", 4);
            if (is_list) { // the comma stays
                fputs(",", l->out);
                s += 4;
                n -= 4;
            }
            end_line(l, depth);
            if (!is_list && !strncmp(s, " \\, ", 4)) { // a product sign where a line begins
                fputs(" \\cdot", l->out);
                s += 3;
                n -= 3;
            }
        }
        fprintf(l->out, "%.*s", (int)n, s);
        depth = depth_after(depth, s, n);
        l->column += width;
        s += n;
    }
}

// Terms of a sum, continued on further lines.
static void put_sum(struct line *l, const char *s)
{
    while (*s) {
        const size_t n = ct_page_first_term(s), width = ct_latex_width(s, n);
        const bool is_wide = l->indent + width + SLACK > l->room;
        if (is_over(l, width) && !(is_wide && l->column < l->indent + 40))
            end_line(l, 0);
        if (is_wide) {
            put_wide_term(l, s, n);
        } else {
            fprintf(l->out, "%.*s", (int)n, s);
            l->column += width;
        }
        s += n;
    }
}

static void put_note(struct line *l, const char *note)
{
    const size_t room = l->room > l->indent + SLACK ? l->room - l->indent - SLACK : 0;
    if (!note)
        return;
    if (!is_over(l, words_width(note) + 2 * QUAD))
        fputs(" \\quad", l->out);
    else
        end_line(l, 0);
    fputs("\\text{(", l->out);
    for (size_t column = 0; *note;) { // lines of words
        const size_t n = strcspn(note, " ");
        char word[256];
        snprintf(word, sizeof word, "%.*s", (int)n, note);
        const size_t width = words_width(word) + 3;
        if (column && column + width > room) {
            fputs("}", l->out);
            end_line(l, 0);
            fputs("\\text{", l->out);
            column = 0;
        } else if (column) {
            fputc(' ', l->out);
        }
        put_characters(l->out, note, n, false);
        column += width;
        note += n;
        note += strspn(note, " ");
    }
    fputs(")}", l->out);
}

// Labels before the left sides; long labels have lines of their own.
static void put_labelled(FILE *out, const struct ct_page_equation *e, size_t label_width,
                         size_t *nline)
{
    const bool is_above = label_width > LINE / 4;
    struct line l = {.out = out,
                     .column = QUAD,
                     .room = LINE - (is_above ? 0 : label_width),
                     .indent = 2 * (size_t)QUAD,
                     .continuation = "&\\qquad ",
                     .nline = nline};
    const size_t left = ct_latex_width(e->left, strlen(e->left));
    const size_t right = e->right ? ct_latex_width(e->right, strlen(e->right)) : 0;
    if (e->label) {
        fputs(is_above ? "&\\text{" : "\\text{", out);
        put_characters(out, e->label, strlen(e->label), false);
        fputs(is_above ? ":} \\\\\n    " : ":} ", out);
    }
    fputs("&\\quad ", out);
    put_sum(&l, e->left);
    if (!e->right) {
        put_note(&l, e->note);
        return;
    }
    if (QUAD + left + EQUALS + right + SLACK > l.room) {
        fputs(" \\\\\n    &\\qquad ", out);
        l.column = l.indent;
    }
    fputs(" = ", out);
    l.column += EQUALS;
    l.continuation = "&\\qquad\\quad ";
    l.indent += QUAD;
    put_sum(&l, e->right);
    put_note(&l, e->note);
}

static void put_aligned(FILE *out, const struct ct_page_equation *e, size_t left_width,
                        size_t *nline)
{
    struct line l = {.out = out,
                     .column = EQUALS,
                     .room = LINE - left_width,
                     .indent = QUAD,
                     .continuation = "&\\quad ",
                     .nline = nline};
    fprintf(out, "%s &= ", e->left);
    put_sum(&l, e->right ? e->right : "");
    put_note(&l, e->note);
}

static void put_equations(FILE *out, const struct ct_page_block *b)
{
    bool labelled = false;
    size_t label_width = 0, left_width = 0, nline = 0;
    if (!b->nequation)
        return;
    for (size_t i = 0; i < b->nequation; i++) {
        const struct ct_page_equation *e = &b->equation[i];
        const size_t left = ct_latex_width(e->left, strlen(e->left)),
                     label = e->label ? words_width(e->label) + 6 : 0;
        left_width = left > left_width ? left : left_width;
        label_width = label > label_width ? label : label_width;
        labelled |= e->label || !e->right || left > LINE / 3;
    }
    fputs("\\begin{align*}\n", out);
    for (size_t i = 0; i < b->nequation; i++) {
        fputs("    ", out);
        if (labelled)
            put_labelled(out, &b->equation[i], label_width, &nline);
        else
            put_aligned(out, &b->equation[i], left_width, &nline);
        if (i + 1 < b->nequation)
            put_line_end(out, &nline, MOST_LINES);
    }
    fputs("\n\\end{align*}\n", out);
}

// ---- tables --------------------------------------------------------------------------------

static bool is_math(const struct ct_page_block *b, size_t cell)
{
    const size_t n = strlen(b->align);
    return n && cell >= n && isupper((unsigned char)b->align[cell % n]);
}

// Layout: of a page
enum { SEPARATION = 12 }; // between columns [pt]

// The widest unbreakable part of a cell [pt]: a formula, or a word between blanks, dots and
// underscores.
static size_t unbroken_width(const struct ct_page_block *b, size_t cell, struct ct_arena *a)
{
    const char *s = b->cell[cell];
    size_t widest = 0;
    if (is_math(b, cell))
        return ct_latex_width(s, strlen(s));
    while (*s) {
        size_t n = strcspn(s, " ._");
        n += s[n] == '.' || s[n] == '_';
        const size_t w = words_width(ct_arena_strndup(a, s, n)) + 4;
        widest = w > widest ? w : widest;
        s += n;
        s += strspn(s, " ");
    }
    return widest;
}

// Widths of the columns if the table is wider than a line, else zeros. Each column has at least
// the width of its unbreakable parts; the remaining width is shared in proportion to what is
// missing. Returns whether even that is too wide.
static bool share_line(const struct ct_page_block *b, struct ct_arena *a, size_t *width)
{
    const size_t n = strlen(b->align), line = LINE - SLACK - SEPARATION * n;
    size_t *least = CT_NEWN(a, size_t, n + 1), sum = 0, sum_least = 0;
    for (size_t i = 0; i < b->ncell; i++) {
        const char *s = b->cell[i];
        const size_t w = is_math(b, i) ? ct_latex_width(s, strlen(s)) : words_width(s) + 4,
                     l = unbroken_width(b, i, a);
        width[i % n] = w > width[i % n] ? w : width[i % n];
        least[i % n] = l > least[i % n] ? l : least[i % n];
    }
    for (size_t k = 0; k < n; k++) {
        sum += width[k];
        sum_least += least[k];
    }
    for (size_t k = 0; k < n; k++)
        width[k]
            = sum <= line ? 0
            : sum_least >= line
                ? least[k] * 85 / 100
                : least[k] + (line - sum_least) * (width[k] - least[k]) / (sum - sum_least);
    return sum > line && sum_least > line;
}

static void put_table(FILE *out, const struct ct_page_block *b, struct ct_arena *a)
{
    const size_t n = strlen(b->align);
    size_t *width = CT_NEWN(a, size_t, n + 1);
    const bool is_small = share_line(b, a, width);
    fprintf(out, "{%s\\begin{longtable}{@{}", is_small ? "\\footnotesize" : "");
    for (size_t k = 0; k < n; k++)
        if (width[k])
            fprintf(out, "p{%zupt}", width[k]);
        else
            fputc(tolower((unsigned char)b->align[k]), out);
    fputs("@{}}\n", out);
    for (size_t i = 0; i < b->ncell; i++) {
        const char *s = b->cell[i];
        const size_t k = n ? i % n : 0;
        fputs(k ? " & " : "    ", out);
        fputs(width[k] ? "\\raggedright " : "", out);
        if (is_math(b, i) && *s)
            fprintf(out, "$%s$", s);
        else
            put_words(out, s);
        if (k + 1 == n)
            fputs(i + 1 == n ? " \\tabularnewline \\hline\n" : " \\tabularnewline\n", out);
    }
    fputs("\\end{longtable}}\n", out);
}

// ---- matrices ------------------------------------------------------------------------------

// Layout: of a page
enum { COLUMN_GAP = 6, MOST_ROWS = 45 };
// Layout: of a page
static const double script_size
    = 0.8; // of \scriptsize: letters of 7 pt are wider for their size

static double matrix_width(const struct ct_page_block *b)
{
    double sum = 0;
    for (size_t k = 0; k < b->ncolumn; k++) {
        size_t width = 0;
        for (size_t i = k; i < b->ncell; i += b->ncolumn) {
            const size_t w = ct_latex_width(b->cell[i], strlen(b->cell[i]));
            width = w > width ? w : width;
        }
        sum += (double)(width + COLUMN_GAP);
    }
    return sum;
}

bool ct_page_latex_fits(const struct ct_page_block *b)
{
    return matrix_width(b) * script_size + SLACK <= LINE && b->ncell <= MOST_ROWS * b->ncolumn;
}

static void put_matrix(FILE *out, const struct ct_page_block *b)
{
    const bool is_small = matrix_width(b) + SLACK > LINE;
    fprintf(out, "{%s\\setlength{\\arraycolsep}{%dpt}\n\\[\n    \\begin{array}{r|",
            is_small ? "\\scriptsize" : "", COLUMN_GAP / 2);
    for (size_t k = 1; k < b->ncolumn; k++)
        fputc('r', out);
    fputs("}\n", out);
    for (size_t i = 0; i < b->ncell; i++) {
        const size_t k = i % b->ncolumn;
        fprintf(out, "%s%s", k ? " & " : "    ",
                strcmp(b->cell[i], ".") ? b->cell[i] : "\\cdot");
        if (k + 1 == b->ncolumn)
            fputs(i + 1 == b->ncolumn ? " \\\\ \\hline\n" : " \\\\\n", out);
    }
    fputs("    \\end{array}\n\\]}\n", out);
}

// ---- pages ---------------------------------------------------------------------------------

void ct_page_print_latex(FILE *out, const struct ct_page *p)
{
    fputs("% needs \\usepackage{amsmath,longtable}\n"
          "\\begingroup\\allowdisplaybreaks\\sloppy\n",
          out);
    for (size_t i = 0; i < p->nblock; i++) {
        const struct ct_page_block *b = &p->block[i];
        switch (b->kind) {
        case CT_PAGE_TITLE:
        case CT_PAGE_HEADING:
            fputs(b->kind == CT_PAGE_TITLE ? "\n\\section*{" : "\n\\subsection*{", out);
            put_characters(out, b->text, strlen(b->text), false);
            fputs("}\n", out);
            break;
        case CT_PAGE_SENTENCE:
            put_words(out, b->text);
            fputs("\n\n", out);
            break;
        case CT_PAGE_TABLE:
            put_table(out, b, p->arena);
            break;
        case CT_PAGE_EQUATIONS:
            put_equations(out, b);
            break;
        case CT_PAGE_MATRIX:
            put_matrix(out, b);
            break;
        }
    }
    fputs("\\endgroup\n", out);
}
