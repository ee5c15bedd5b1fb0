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

// Length of the group of braces that starts s: what it holds may be any text. 0: it does not end.
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
        else if (s[i] == '\\') // cases hold together
            depth += !strncmp(s + i, "\\begin{", 7) - !strncmp(s + i, "\\end{", 5);
        else if (i > 0 && depth <= 0 && is_sign(s + i))
            return i;
    }
    return strlen(s);
}
