// Pages under construction; see page.h.
#include "report/page.h"

#include <string.h>

static struct ct_page_block *add_block(struct ct_page *p, enum ct_page_kind kind)
{
    const struct ct_page_block b = {.kind = kind};
    CT_PUSH(p->arena, p->block, p->nblock, p->block_cap, b);
    return &p->block[p->nblock - 1];
}

void ct_page_title(struct ct_page *p, const char *text)
{
    add_block(p, CT_PAGE_TITLE)->text = text;
}

void ct_page_heading(struct ct_page *p, const char *text)
{
    add_block(p, CT_PAGE_HEADING)->text = text;
}

void ct_page_folded_heading(struct ct_page *p, const char *text)
{
    struct ct_page_block *b = add_block(p, CT_PAGE_HEADING);
    b->text = text;
    b->is_folded = true;
}

void ct_page_sentence(struct ct_page *p, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    add_block(p, CT_PAGE_SENTENCE)->text = ct_arena_vprintf(p->arena, fmt, ap);
    va_end(ap);
}

void ct_page_table(struct ct_page *p, const char *align)
{
    add_block(p, CT_PAGE_TABLE)->align = align;
}

void ct_page_cell(struct ct_page *p, const char *text)
{
    struct ct_page_block *b = &p->block[p->nblock - 1];
    CT_PUSH(p->arena, b->cell, b->ncell, b->cell_cap, text);
}

void ct_page_row(struct ct_page *p, const char *const *cell, size_t n)
{
    for (size_t i = 0; i < n; i++)
        ct_page_cell(p, cell[i]);
}

void ct_page_matrix(struct ct_page *p, size_t ncolumn)
{
    add_block(p, CT_PAGE_MATRIX)->ncolumn = ncolumn;
}

bool ct_page_matrix_end(struct ct_page *p)
{
    const struct ct_page_block *b = &p->block[p->nblock - 1];
    const bool fits = p->look == CT_LOOK_TEXT ? ct_page_text_fits(b) : ct_page_latex_fits(b);
    p->nblock -= !fits;
    return fits;
}

void ct_page_equations(struct ct_page *p)
{
    add_block(p, CT_PAGE_EQUATIONS);
}

struct ct_page_equation *ct_page_equation(struct ct_page *p, const char *label,
                                          const char *left, const char *right, const char *note)
{
    struct ct_page_block *b = &p->block[p->nblock - 1];
    const struct ct_page_equation e
        = {.label = label, .left = left, .right = right, .note = note, .about = p->about};
    CT_PUSH(p->arena, b->equation, b->nequation, b->equation_cap, e);
    return &b->equation[b->nequation - 1];
}

// ---- summaries -----------------------------------------------------------------------------

// Layout: entries shown at each end of a list: two points of a chain in a plane, one in space
// with its rotation.
enum { FEW = 4 };

static bool is_list(size_t n)
{
    return n > 2 * FEW + 1;
}

enum ct_shown ct_page_shown(const struct ct_page *p, size_t i, size_t n)
{
    return !p->is_summary || !is_list(n) || i < FEW || i + FEW >= n ? CT_SHOWN
         : i == FEW                                                 ? CT_SHOWN_AS_MORE
                                                                    : CT_LEFT_OUT;
}

static void shorten_table(struct ct_page *p, struct ct_page_block *b)
{
    const size_t n = strlen(b->align), nrow = b->ncell / n - 1; // without the header
    if (!is_list(nrow))
        return;
    const char **row = b->cell + n * (1 + FEW); // the first that is omitted
    for (size_t k = 0; k < n; k++)
        row[k] = k == 0 ? "..."
               : k == 1 ? ct_arena_printf(p->arena, "%zu more", nrow - 2 * FEW)
                        : "";
    memmove(row + n, b->cell + b->ncell - n * FEW, n * FEW * sizeof *row);
    b->ncell = n * (2 + 2 * FEW);
}

// Is the side longer than a screen?
static const char *shorten_side(struct ct_page *p, const char *side)
{
    const size_t n = side ? strlen(side) : 0;
    if (n <= CT_MOST_LINES * CT_PAGE_WIDTH)
        return side;
    return p->look == CT_LOOK_TEXT
             ? ct_arena_printf(p->arena, "... (%zu characters)", n)
             : ct_arena_printf(p->arena, "\\ldots \\text{ (%zu characters)}", n);
}

static void shorten_equations(struct ct_page *p, struct ct_page_block *b)
{
    for (size_t i = 0; i < b->nequation; i++) {
        b->equation[i].left = shorten_side(p, b->equation[i].left);
        b->equation[i].right = shorten_side(p, b->equation[i].right);
    }
}

void ct_page_shorten(struct ct_page *p)
{
    struct ct_page_block *all = p->block;
    const size_t n = p->nblock;
    p->block = NULL;
    p->nblock = p->block_cap = 0;
    for (size_t i = 0; i < n; i++) {
        struct ct_page_block first = all[i], last = all[i];
        const bool is_split = first.kind == CT_PAGE_EQUATIONS && is_list(first.nequation);
        if (first.kind == CT_PAGE_TABLE)
            shorten_table(p, &first);
        shorten_equations(p, &first);
        first.nequation = is_split ? FEW : first.nequation;
        first.is_folded = false;
        CT_PUSH(p->arena, p->block, p->nblock, p->block_cap, first);
        if (!is_split)
            continue;
        ct_page_sentence(p, "... %zu more", last.nequation - 2 * FEW);
        last.equation += last.nequation - FEW;
        last.nequation = FEW;
        CT_PUSH(p->arena, p->block, p->nblock, p->block_cap, last);
    }
}

size_t ct_text_width(const char *s)
{
    size_t n = 0;
    for (; *s; s++)
        n += ((unsigned char)*s & 0xC0) != 0x80;
    return n;
}

static bool is_sign(const char *s)
{
    return s[0] == ' ' && (s[1] == '+' || s[1] == '-') && s[2] == ' ';
}

// Length of the group of braces at the beginning of s, with any contents. 0: it does not end.
static size_t group_length(const char *s)
{
    int depth = 0;
    for (size_t i = 0; s[i]; i++) {
        if (s[i] == '\\' && s[i + 1])
            i++;
        else
            depth += (s[i] == '{') - (s[i] == '}');
        if (depth == 0)
            return i + 1;
    }
    return 0;
}

size_t ct_page_first_term(const char *s)
{
    int depth = 0;
    for (size_t i = 0; s[i]; i++) {
        if (s[i] == '{' && group_length(s + i))
            i += group_length(s + i) - 1;
        else if (strchr("([{", s[i]))
            depth++;
        else if (strchr(")]}", s[i]))
            depth--;
        else if (s[i] == '\\') // cases are not broken
            depth += !strncmp(s + i, "\\begin{", 7) - !strncmp(s + i, "\\end{", 5);
        else if (i > 0 && depth <= 0 && is_sign(s + i))
            return i;
    }
    return strlen(s);
}
