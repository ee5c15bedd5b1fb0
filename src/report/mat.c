// FILE.mat, version 4, little-endian; see archive.h.
//
// Each array: type, rows, columns, 0, length of the name with its NUL (32 bits each), the name,
// the numbers by columns. Names of variables are letters, digits and underscores: other
// characters become underscores, and a repeated name gets a number.
#include "report/archive.h"

#include <stdio.h>
#include <string.h>

enum {
    NUMBERS = 0,
    TEXT = 1,
    // Definition: of MAT files of level 4
    LONGEST_NAME = 63
}; // type 0000 and 0001: doubles, shown as numbers or text

static bool is_taken(const struct ct_archive *z, const char *name)
{
    for (size_t i = 0; i < z->nentry; i++)
        if (strcmp(z->entry[i].name, name) == 0)
            return true;
    return false;
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static const char *variable_name(struct ct_archive *z, const char *name)
{
    char text[LONGEST_NAME + 1], base[LONGEST_NAME + 1];
    size_t n = 0;
    if (!is_letter(name[0]))
        base[n++] = 'x';
    for (; *name && n < LONGEST_NAME; name++)
        base[n++] = is_letter(*name) || is_digit(*name) ? *name : '_';
    while (n > 1 && base[n - 1] == '_') // of 'a(b)'
        n--;
    base[n] = 0;
    strcpy(text, base);
    for (int i = 2; is_taken(z, text); i++) {
        char end[16];
        const int length = snprintf(end, sizeof end, "_%d", i);
        snprintf(text, sizeof text, "%.*s%s", LONGEST_NAME - length, base, end);
    }
    const struct ct_archive_entry e = {.name = ct_arena_strdup(z->arena, text)};
    CT_PUSH(z->arena, z->entry, z->nentry, z->cap, e);
    return e.name;
}

static void add(struct ct_archive *z, int type, const char *name, size_t n, size_t m,
                const double *v)
{
    struct ct_archive_bytes b = {.arena = z->arena};
    if (n > INT32_MAX || m > INT32_MAX) {
        z->is_too_long = true;
        return;
    }
    name = variable_name(z, name);
    ct_archive_put(&b, (uint64_t)type, 4);
    ct_archive_put(&b, n, 4);
    ct_archive_put(&b, m, 4);
    ct_archive_put(&b, 0, 4); // no imaginary part
    ct_archive_put(&b, strlen(name) + 1, 4);
    ct_archive_put_text(&b, name);
    ct_archive_put(&b, 0, 1);
    ct_archive_put_numbers(&b, v, n * m);
    ct_archive_write(z, &b);
}

static void add_numbers(struct ct_archive *z, const char *name, struct ct_archive_shape s,
                        const double *v)
{
    add(z, NUMBERS, name, s.n, s.m, v);
}

static void add_names(struct ct_archive *z, const char *name, const char *const *text, size_t n)
{
    const size_t longest = ct_archive_longest(text, n);
    double *v = CT_NEWN(z->arena, double, n *longest + 1);
    for (size_t i = 0; i < n; i++) {
        const char *s = text[i] ? text[i] : "";
        for (size_t k = 0; k < longest; k++)
            v[i + n * k] = *s ? ct_archive_next_point(&s) : ' ';
    }
    add(z, TEXT, name, n, longest, v);
}

static void finish(struct ct_archive *z)
{
    (void)z; // the file ends with its last array
}

const struct ct_archive_format ct_archive_mat = {add_numbers, add_names, finish};
