// Pages as LaTeX; see page.h.
#include "report/page.h"

#include "expr/print.h"

#include <ctype.h>
#include <string.h>

// ---- words ------------------------------------------------------------------------------------

static void put_words(FILE *out, const char *s)
{
    for (; *s; s++) {
        if (strchr("_#$%&{}", *s))
            fprintf(out, "\\%c", *s);
        else if (*s == '^' || *s == '~')
            fprintf(out, "\\%c{}", *s);
        else if (*s == '|')
            fputs("\\textbar{}", out);
        else if (*s == '<' || *s == '>')
            fputs(*s == '<' ? "\\textless{}" : "\\textgreater{}", out);
        else if (*s == '\\')
            fputs("\\textbackslash{}", out);
        else
            fputc(*s, out);
    }
}

// ---- equations --------------------------------------------------------------------------------

// Widths of a line, and of what a further one is indented by.
enum { LINE = CT_LATEX_LINE, AFTER_BREAK = 8 };

// Length of a piece up to the next place where a line may end: before a sign, or a factor, at any depth of
// parentheses but not within braces or cases.
static size_t piece_of(const char *s, bool at_factors)
{
    int braces = 0;
    for (size_t i = 0; s[i]; i++) {
        braces += (s[i] == '{') - (s[i] == '}');
        braces += !strncmp(s + i, "\\begin", 6) - !strncmp(s + i, "\\end", 4);
        if (i == 0 || braces > 0)
            continue;
        if (!strncmp(s + i, " + ", 3) || !strncmp(s + i, " - ", 3)
            || (at_factors && !strncmp(s + i, " \\, ", 4)))
            return i;
    }
    return strlen(s);
}

// A delimiter cannot be open at the end of a line: invisible ones close and open the `depth` that are. A sign
// after the empty group is that of a sum.
static void end_line(FILE *out, int depth, const char *indent)
{
    for (int i = 0; i < depth; i++)
        fputs(" \\right.", out);
    fprintf(out, " \\\\\n    %s", indent);
    for (int i = 0; i < depth; i++)
        fputs(i + 1 < depth ? "\\left. " : "\\left. {}", out);
}

static int depth_after(int depth, const char *s, size_t n)
{
    for (size_t i = 0; i < n; i++)
        depth += !strncmp(s + i, "\\left", 5) - !strncmp(s + i, "\\right", 6);
    return depth;
}

// A term wider than a line, broken within: between products where a sum in it does not fit either.
static size_t put_wide_term(FILE *out, const char *s, size_t length, size_t column,
                            const char *indent)
{
    const char *end = s + length;
    int depth = 0;
    while (s < end) {
        size_t n = piece_of(s, false);
        if (ct_latex_width(s, n) > LINE - AFTER_BREAK)
            n = piece_of(s, true);
        n = n < (size_t)(end - s) ? n : (size_t)(end - s);
        const size_t width = ct_latex_width(s, n);
        if (column + width > LINE && column > AFTER_BREAK) {
            end_line(out, depth, indent);
            column = AFTER_BREAK;
            if (!strncmp(s, " \\, ", 4)) { // the product is said
                fputs(depth ? " \\cdot" : "{} \\cdot", out);
                s += 3;
                n -= 3;
            }
        }
        fprintf(out, "%.*s", (int)n, s);
        depth = depth_after(depth, s, n);
        column += width;
        s += n;
    }
    return column;
}

// Terms of a sum, on further lines where they do not fit.
static void put_sum(FILE *out, const char *s, size_t column, const char *indent)
{
    while (*s) {
        const size_t n = ct_page_first_term(s), width = ct_latex_width(s, n);
        if (column + width > LINE && column > 20) {
            end_line(out, 0, indent);
            column = AFTER_BREAK;
        }
        if (column + width > LINE) {
            column = put_wide_term(out, s, n, column, indent);
        } else {
            fprintf(out, "%.*s", (int)n, s);
            column += width;
        }
        s += n;
    }
}

static void put_equation(FILE *out, const struct ct_page_equation *e, bool labelled)
{
    const size_t left = ct_latex_width(e->left, strlen(e->left));
    const size_t right = e->right ? ct_latex_width(e->right, strlen(e->right)) : 0;
    const size_t label = e->label ? ct_text_width(e->label) : 0;
    fputs("    ", out);
    if (labelled) {
        if (e->label) {
            fputs("\\text{", out);
            put_words(out, e->label);
            fputs(":} ", out);
        }
        fputs("&\\quad ", out);
        put_sum(out, e->left, label, "&\\qquad ");
        if (e->right && label + left + right > LINE)
            fputs(" \\\\\n    &\\qquad = ", out);
        else if (e->right)
            fputs(" = ", out);
        if (e->right)
            put_sum(out, e->right, label + left + right > LINE ? 8 : label + left,
                    "&\\qquad\\quad ");
    } else {
        fprintf(out, "%s &= ", e->left);
        put_sum(out, e->right ? e->right : "", left + 3, "&\\quad ");
    }
    if (e->note) {
        fputs(" && \\text{", out);
        put_words(out, e->note);
        fputs("}", out);
    }
}

static void put_equations(FILE *out, const struct ct_page_block *b)
{
    bool labelled = false;
    if (!b->nequation)
        return;
    for (size_t i = 0; i < b->nequation; i++)
        labelled |= b->equation[i].label || !b->equation[i].right
                 || ct_latex_width(b->equation[i].left, strlen(b->equation[i].left)) > LINE / 2;
    fputs("\\begin{align*}\n", out);
    for (size_t i = 0; i < b->nequation; i++) {
        put_equation(out, &b->equation[i], labelled);
        fputs(i + 1 < b->nequation ? " \\\\\n" : "\n", out);
    }
    fputs("\\end{align*}\n", out);
}

// ---- tables -----------------------------------------------------------------------------------

static void put_table(FILE *out, const struct ct_page_block *b)
{
    const size_t n = strlen(b->align);
    bool is_wide = false;
    for (size_t i = n - 1; i < b->ncell; i += n)
        is_wide |= ct_text_width(b->cell[i]) > 45;
    fputs("\\begin{longtable}{", out);
    for (size_t k = 0; k < n; k++)
        if (k + 1 == n && is_wide)
            fputs("p{0.45\\linewidth}", out);
        else
            fputc(tolower((unsigned char)b->align[k]), out);
    fputs("}\n", out);
    for (size_t i = 0; i < b->ncell; i++) {
        const char *s = b->cell[i];
        // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): a table has columns
        const bool is_math = isupper((unsigned char)b->align[i % n]) && i >= n;
        fputs(i % n ? " & " : "    ", out);
        if (is_math && *s)
            fprintf(out, "$%s$", s);
        else
            put_words(out, s);
        if ((i + 1) % n == 0)
            fputs(i + 1 == n ? " \\\\ \\hline\n" : " \\\\\n", out);
    }
    fputs("\\end{longtable}\n", out);
}

void ct_page_print_latex(FILE *out, const struct ct_page *p)
{
    fputs("% needs \\usepackage{amsmath,longtable}\n", out);
    for (size_t i = 0; i < p->nblock; i++) {
        const struct ct_page_block *b = &p->block[i];
        switch (b->kind) {
        case CT_PAGE_TITLE:
        case CT_PAGE_HEADING:
            fputs(b->kind == CT_PAGE_TITLE ? "\n\\section*{" : "\n\\subsection*{", out);
            put_words(out, b->text);
            fputs("}\n", out);
            break;
        case CT_PAGE_SENTENCE:
            put_words(out, b->text);
            fputs("\n\n", out);
            break;
        case CT_PAGE_TABLE:
            put_table(out, b);
            break;
        case CT_PAGE_EQUATIONS:
            put_equations(out, b);
            break;
        }
    }
}
