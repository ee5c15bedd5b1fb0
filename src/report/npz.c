// See npz.h. All numbers in both formats are little-endian, whatever the machine.
#include "report/npz.h"

#include <string.h>

struct bytes {
    struct ct_arena *arena;
    unsigned char *b;
    size_t n, cap;
};

static void put(struct bytes *out, uint64_t v, int size)
{
    for (int i = 0; i < size; i++) {
        const unsigned char byte = (unsigned char)(v >> (8 * i));
        CT_PUSH(out->arena, out->b, out->n, out->cap, byte);
    }
}

static void put_text(struct bytes *out, const char *text)
{
    for (; *text; text++)
        put(out, (unsigned char)*text, 1);
}

static void put_number(struct bytes *out, double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    put(out, bits, 8);
}

// ---- .npy ---------------------------------------------------------------------------------------------

// Magic, version, length of the header, the header: a Python dictionary, padded to a multiple of 64.
static void put_header(struct bytes *out, const char *type, const char *shape)
{
    enum { BEFORE = 10, ALIGN = 64 };
    char *text = ct_arena_printf(
        out->arena, "{'descr': '%s', 'fortran_order': True, 'shape': (%s), }", type, shape);
    const size_t n = strlen(text), all = (BEFORE + n + 1 + ALIGN - 1) / ALIGN * ALIGN;
    put(out, 0x93, 1);
    put_text(out, "NUMPY");
    put(out, 1, 1);
    put(out, 0, 1);
    put(out, all - BEFORE, 2);
    put_text(out, text);
    for (size_t i = BEFORE + n + 1; i < all; i++)
        put(out, ' ', 1);
    put(out, '\n', 1);
}

// The next code point of well-formed UTF-8; what is not becomes U+FFFD.
static uint32_t next_point(const unsigned char **s)
{
    const unsigned char first = *(*s)++;
    const int more = first < 0x80  ? 0
                   : first >= 0xf0 ? 3
                   : first >= 0xe0 ? 2
                   : first >= 0xc0 ? 1
                                   : -1;
    if (more < 0)
        return 0xfffd;
    uint32_t v = more ? first & (0x3fu >> more) : first;
    for (int i = 0; i < more; i++) {
        if ((**s & 0xc0) != 0x80)
            return 0xfffd;
        v = v << 6 | (*(*s)++ & 0x3fu);
    }
    return v;
}

static size_t count_points(const char *text)
{
    const unsigned char *s = (const unsigned char *)text;
    size_t n = 0;
    while (*s) {
        next_point(&s);
        n++;
    }
    return n;
}

// ---- .zip ---------------------------------------------------------------------------------------------

// CRC-32 as in ISO 3309, bit by bit.
static uint32_t crc_of(const unsigned char *b, size_t n)
{
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < n; i++) {
        crc ^= b[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1 ? crc >> 1 ^ 0xedb88320 : crc >> 1;
    }
    return ~crc;
}

// What local and central headers share: version needed .. lengths of name and extra field. 1 January 1980, 0:00:
// the same content is the same file.
static void put_entry(struct bytes *out, const struct ct_npz_entry *e)
{
    put(out, 20, 2);         // version needed: 2.0
    put(out, 0, 2);          // flags
    put(out, 0, 2);          // stored
    put(out, 0, 2);          // time
    put(out, 1 << 5 | 1, 2); // date
    put(out, e->crc, 4);
    put(out, e->size, 4);
    put(out, e->size, 4);
    put(out, strlen(e->name), 2);
    put(out, 0, 2);
}

static void write_bytes(struct ct_npz *z, const struct bytes *b)
{
    fwrite(b->b, 1, b->n, z->file.stream); // errors show when the file is closed
    z->offset += (uint32_t)b->n;
}

static void add(struct ct_npz *z, const char *name, const struct bytes *content)
{
    const struct ct_npz_entry e = {.name = ct_arena_printf(z->arena, "%s.npy", name),
                                   .crc = crc_of(content->b, content->n),
                                   .size = (uint32_t)content->n,
                                   .offset = z->offset};
    struct bytes header = {.arena = z->arena};
    put(&header, 0x04034b50, 4);
    put_entry(&header, &e);
    put_text(&header, e.name);
    write_bytes(z, &header);
    write_bytes(z, content);
    CT_PUSH(z->arena, z->entry, z->nentry, z->cap, e);
}

bool ct_npz_open(struct ct_ctx *ctx, struct ct_npz *z, const char *path)
{
    *z = (struct ct_npz){.arena = ctx->model};
    return ct_outfile_open(ctx, &z->file, path);
}

static void add_numbers(struct ct_npz *z, const char *name, const char *shape, const double *v,
                        size_t n)
{
    struct bytes b = {.arena = z->arena};
    put_header(&b, "<f8", shape);
    for (size_t i = 0; i < n; i++)
        put_number(&b, v[i]);
    add(z, name, &b);
}

void ct_npz_matrix(struct ct_npz *z, const char *name, const double *A, size_t n, size_t m)
{
    add_numbers(z, name, ct_arena_printf(z->arena, "%zu, %zu", n, m), A, n * m);
}

void ct_npz_vector(struct ct_npz *z, const char *name, const double *v, size_t n)
{
    add_numbers(z, name, ct_arena_printf(z->arena, "%zu,", n), v, n);
}

void ct_npz_names(struct ct_npz *z, const char *name, const char *const *text, size_t n)
{
    struct bytes b = {.arena = z->arena};
    size_t longest = 1;
    for (size_t i = 0; i < n; i++)
        if (count_points(text[i]) > longest)
            longest = count_points(text[i]);
    put_header(&b, ct_arena_printf(z->arena, "<U%zu", longest),
               ct_arena_printf(z->arena, "%zu,", n));
    for (size_t i = 0; i < n; i++) {
        const unsigned char *s = (const unsigned char *)text[i];
        for (size_t k = 0; k < longest; k++)
            put(&b, *s ? next_point(&s) : 0, 4);
    }
    add(z, name, &b);
}

bool ct_npz_close(struct ct_ctx *ctx, struct ct_npz *z)
{
    struct bytes b = {.arena = z->arena};
    for (size_t i = 0; i < z->nentry; i++) {
        put(&b, 0x02014b50, 4);
        put(&b, 20, 2); // made by version 2.0
        put_entry(&b, &z->entry[i]);
        put(&b, 0, 2); // comment
        put(&b, 0, 2); // disk
        put(&b, 0, 2); // internal attributes
        put(&b, 0, 4); // external attributes
        put(&b, z->entry[i].offset, 4);
        put_text(&b, z->entry[i].name);
    }
    const size_t directory = b.n;
    put(&b, 0x06054b50, 4);
    put(&b, 0, 2);
    put(&b, 0, 2);
    put(&b, z->nentry, 2);
    put(&b, z->nentry, 2);
    put(&b, directory, 4);
    put(&b, z->offset, 4);
    put(&b, 0, 2);
    write_bytes(z, &b);
    return ct_outfile_close(ctx, &z->file);
}
