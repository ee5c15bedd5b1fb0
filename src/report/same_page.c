// See same_page.h. Mathematics is parsed by the grammar of expr/print.h as sums of products of
// powers. Each part gets a hash from those of its operands. Hashes of the operands of sums and
// products are added, so that their order does not matter. All else is text.
#include "report/same_page.h"

#include <stdlib.h>
#include <string.h>

struct meaning {
    size_t number; // of t1, t2, ...
    uint64_t value;
};

struct reader {
    struct ct_arena *arena;
    const char *name, *at; // at: position of the parser
    size_t name_length;
    struct meaning *meaning;
    size_t n, cap;
};

// The finaliser of SplitMix64 (Steele, Lea and Flood, 2014): all bits of a and b in all bits.
static uint64_t mix(uint64_t a, uint64_t b)
{
    uint64_t z = a * 0x9e3779b97f4a7c15u + b + 0x632be59bd9b4e019u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static bool is_word(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')
        || (unsigned char)c >= 0x80;
}

// ---- words ---------------------------------------------------------------------------------

// Length of a name t1, t2, ... at p; 0: there is none.
static size_t short_name(const char *p)
{
    const size_t n = *p == 't' ? strspn(p + 1, "0123456789") : 0;
    return n && !is_word(p[1 + n]) ? 1 + n : 0;
}

static uint64_t meaning_of(const struct reader *r, size_t number)
{
    for (size_t i = r->n; i-- > 0;)
        if (r->meaning[i].number == number)
            return r->meaning[i].value;
    return number;
}

// Hash of n characters of p, with a placeholder for the name and short names replaced by their
// definitions.
static uint64_t read_words(const struct reader *r, const char *p, size_t n)
{
    const char *end = p + n;
    uint64_t value = 1;
    for (bool starts = true; p < end; starts = !is_word(p[-1])) {
        const size_t length = starts ? short_name(p) : 0;
        if (starts && !strncmp(p, r->name, r->name_length) && !is_word(p[r->name_length])) {
            value = mix(value, 2);
            p += r->name_length;
        } else if (length) {
            value = mix(value, meaning_of(r, (size_t)strtoul(p + 1, NULL, 10)));
            p += length;
        } else {
            value = mix(value, (unsigned char)*p++);
        }
    }
    return value;
}

// ---- mathematics ---------------------------------------------------------------------------

static uint64_t read_sum(struct reader *r);

// A list in parentheses or brackets, whose order matters.
static uint64_t read_list(struct reader *r)
{
    uint64_t value = mix(3, (unsigned char)*r->at);
    do {
        r->at += 1 + (r->at[0] == ',' && r->at[1] == ' ');
        value = mix(value, read_sum(r));
    } while (*r->at == ',');
    r->at += *r->at == ')' || *r->at == ']';
    return value;
}

static uint64_t read_power(struct reader *r)
{
    const size_t n = strcspn(r->at, " *^/()[],+-");
    const char *number = r->at;
    size_t length = n;
    // 1e-05: the sign belongs to the number
    if (n > 1 && number[0] >= '0' && number[0] <= '9' && number[n - 1] == 'e')
        length += 1 + strcspn(number + n + 1, " *^/()[],+-");
    uint64_t value = read_words(r, r->at, length);
    r->at += length;
    if (*r->at == '(' || *r->at == '[')
        value = mix(value, read_list(r));
    if (*r->at == '^') {
        r->at++;
        if (*r->at == '-') {
            r->at++;
            value = mix(value, 4);
        }
        value = mix(value, read_power(r));
    }
    return value;
}

static uint64_t read_product(struct reader *r)
{
    uint64_t value = mix(5, read_power(r));
    while (*r->at == '*' || *r->at == '/') {
        const uint64_t kind = *r->at++ == '*' ? 5 : 6;
        value += mix(kind, read_power(r));
    }
    return mix(7, value);
}

static uint64_t read_sum(struct reader *r)
{
    uint64_t value = 0;
    bool is_minus = *r->at == '-';
    r->at += is_minus;
    for (;;) {
        value += mix(is_minus ? 8 : 9, read_product(r));
        if (strncmp(r->at, " + ", 3) != 0 && strncmp(r->at, " - ", 3) != 0)
            return mix(10, value);
        is_minus = r->at[1] == '-';
        r->at += 3;
    }
}

// Hash of mathematics, or of text if the parser does not reach the end.
static uint64_t read_text(struct reader *r, const char *text)
{
    if (!text)
        return 0;
    r->at = text;
    const uint64_t value = read_sum(r);
    return *r->at ? read_words(r, text, strlen(text)) : value;
}

// ---- blocks --------------------------------------------------------------------------------

static uint64_t read_equation(struct reader *r, const struct ct_page_equation *e)
{
    uint64_t value = read_text(r, e->left);
    value = mix(value, read_text(r, e->right));
    return mix(value, read_text(r, e->note));
}

// A definition t1 = ... is not hashed by itself.
static bool learn(struct reader *r, const struct ct_page_equation *e)
{
    const size_t n = short_name(e->left);
    if (!e->right || !n || e->left[n])
        return false;
    const struct meaning m = {(size_t)strtoul(e->left + 1, NULL, 10), read_text(r, e->right)};
    CT_PUSH(r->arena, r->meaning, r->n, r->cap, m);
    return true;
}

uint64_t ct_page_meaning(const struct ct_page *p, size_t from, const char *name)
{
    struct reader r = {.arena = p->arena, .name = name, .name_length = strlen(name)};
    uint64_t value = 0;
    for (size_t i = from; i < p->nblock; i++) {
        const struct ct_page_block *b = &p->block[i];
        value = mix(value, b->text ? read_words(&r, b->text, strlen(b->text)) : 0);
        for (size_t k = 0; k < b->ncell; k++)
            value = mix(value, read_text(&r, b->cell[k]));
        for (size_t k = 0; k < b->nequation; k++)
            if (!learn(&r, &b->equation[k]))
                value = mix(value, read_equation(&r, &b->equation[k]));
    }
    return value;
}
