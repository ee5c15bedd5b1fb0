// Pages under construction; see page.h.
#include "report/page.h"

#include <stdint.h>
#include <stdlib.h>
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

// ---- comparing ----------------------------------------------------------------------------------

// A name t1, t2, ... stands for what it is defined to be: a number made of that.
struct meaning {
    size_t number;
    uint64_t value;
};

struct said {
    struct ct_arena *arena;
    const char *name;
    size_t name_length;
    char *at;
    size_t n, cap;
    struct meaning *meaning;
    size_t nmeaning, meaning_cap;
};

static void say(struct said *s, char c)
{
    CT_PUSH(s->arena, s->at, s->n, s->cap, c);
}

static uint64_t meaning_of(const struct said *s, size_t number)
{
    for (size_t i = s->nmeaning; i-- > 0;)
        if (s->meaning[i].number == number)
            return s->meaning[i].value;
    return number;
}

static bool is_word(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')
        || (unsigned char)c >= 0x80;
}

// Length of a name t1, t2, ... at p, which follows `before`; 0: it is none.
static size_t short_name(const char *p, char before)
{
    const size_t n
        = *p == 't' && !is_word(before) && before != '.' ? strspn(p + 1, "0123456789") : 0;
    return n && !is_word(p[1 + n]) ? 1 + n : 0;
}

static void say_text(struct said *s, const char *text)
{
    for (const char *p = text; p && *p;) {
        const char before = p == text ? ' ' : p[-1];
        const size_t n = short_name(p, before);
        if (!is_word(before) && !strncmp(p, s->name, s->name_length)
            && !is_word(p[s->name_length])) {
            say(s, '\1');
            p += s->name_length;
        } else if (n) {
            uint64_t value = meaning_of(s, (size_t)strtoul(p + 1, NULL, 10));
            for (say(s, '\2'); value; value /= 64)
                say(s, (char)('0' + value % 64));
            p += n;
        } else {
            say(s, *p++);
        }
    }
    say(s, '\3');
}

// t1 = ...: what it means, by FNV-1a (Fowler, Noll and Vo), 64 bits.
static void learn(struct said *s, const struct ct_page_equation *e)
{
    const size_t start = s->n;
    struct meaning m = {(size_t)strtoul(e->left + 1, NULL, 10), 14695981039346656037u};
    say_text(s, e->right);
    for (size_t i = start; i < s->n; i++)
        m.value = (m.value ^ (unsigned char)s->at[i]) * 1099511628211u;
    s->n = start;
    CT_PUSH(s->arena, s->meaning, s->nmeaning, s->meaning_cap, m);
}

const char *ct_page_said(const struct ct_page *p, size_t from, const char *name)
{
    struct said s = {.arena = p->arena, .name = name, .name_length = strlen(name)};
    for (size_t i = from; i < p->nblock; i++) {
        const struct ct_page_block *b = &p->block[i];
        say_text(&s, b->text);
        for (size_t k = 0; k < b->ncell; k++)
            say_text(&s, b->cell[k]);
        for (size_t k = 0; k < b->nequation; k++) {
            const struct ct_page_equation *e = &b->equation[k];
            if (e->right && short_name(e->left, ' ') == strlen(e->left)) {
                learn(&s, e);
                continue;
            }
            say_text(&s, e->left);
            say_text(&s, e->right);
            say_text(&s, e->note);
        }
    }
    say(&s, '\0');
    return s.at;
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
