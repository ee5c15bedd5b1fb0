// FILE.npz; see archive.h. All numbers are little-endian, whatever the machine.
// Source: NumPy enhancement proposal 1 (format 1.0).
#include "report/archive.h"

#include <string.h>

// ---- .npy ----------------------------------------------------------------------------------

// Magic, version, length of the header, the header: a Python dictionary, padded to a multiple
// of 64.
static void put_header(struct ct_archive_bytes *out, const char *type, const char *shape)
{
    // Definition: of NPY files
    enum { BEFORE = 10, ALIGN = 64 };
    char *text = ct_arena_printf(
        out->arena, "{'descr': '%s', 'fortran_order': True, 'shape': (%s), }", type, shape);
    const size_t n = strlen(text), all = (BEFORE + n + 1 + ALIGN - 1) / ALIGN * ALIGN;
    ct_archive_put(out, 0x93, 1);
    ct_archive_put_text(out, "NUMPY");
    ct_archive_put(out, 1, 1);
    ct_archive_put(out, 0, 1);
    ct_archive_put(out, all - BEFORE, 2);
    ct_archive_put_text(out, text);
    for (size_t i = BEFORE + n + 1; i < all; i++)
        ct_archive_put(out, ' ', 1);
    ct_archive_put(out, '\n', 1);
}

static void add(struct ct_archive *z, const char *name, const struct ct_archive_bytes *content)
{
    ct_archive_add_file(z, ct_arena_printf(z->arena, "%s.npy", name), content);
}

static void add_numbers(struct ct_archive *z, const char *name, struct ct_archive_shape s,
                        const double *v)
{
    struct ct_archive_bytes b = {.arena = z->arena};
    put_header(&b, "<f8",
               s.is_vector ? ct_arena_printf(z->arena, "%zu,", s.n)
                           : ct_arena_printf(z->arena, "%zu, %zu", s.n, s.m));
    ct_archive_put_numbers(&b, v, s.n * s.m);
    add(z, name, &b);
}

static void add_names(struct ct_archive *z, const char *name, const char *const *text, size_t n)
{
    struct ct_archive_bytes b = {.arena = z->arena};
    const size_t longest = ct_archive_longest(text, n);
    put_header(&b, ct_arena_printf(z->arena, "<U%zu", longest),
               ct_arena_printf(z->arena, "%zu,", n));
    for (size_t i = 0; i < n; i++) {
        const char *s = text[i] ? text[i] : "";
        for (size_t k = 0; k < longest; k++)
            ct_archive_put(&b, *s ? ct_archive_next_point(&s) : 0, 4);
    }
    add(z, name, &b);
}

const struct ct_archive_format ct_archive_npz
    = {add_numbers, add_names, ct_archive_finish_files};
