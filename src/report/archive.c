// Functions shared by the formats of arrays; see archive.h.
#include "report/archive.h"

#include <string.h>

static const struct ct_mark nowhere = {0};

void ct_archive_put(struct ct_archive_bytes *out, uint64_t v, int size)
{
    for (int i = 0; i < size; i++) {
        const unsigned char byte = (unsigned char)(v >> (8 * i));
        CT_PUSH(out->arena, out->b, out->n, out->cap, byte);
    }
}

void ct_archive_put_text(struct ct_archive_bytes *out, const char *text)
{
    for (; *text; text++)
        ct_archive_put(out, (unsigned char)*text, 1);
}

void ct_archive_put_numbers(struct ct_archive_bytes *out, const double *v, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint64_t bits;
        memcpy(&bits, &v[i], sizeof bits);
        ct_archive_put(out, bits, 8);
    }
}

uint32_t ct_archive_next_point(const char **text)
{
    const unsigned char *s = (const unsigned char *)*text;
    const unsigned char first = *s++;
    const int more = first < 0x80  ? 0
                   : first >= 0xf0 ? 3
                   : first >= 0xe0 ? 2
                   : first >= 0xc0 ? 1
                                   : -1;
    uint32_t v = more == 0 ? first : more > 0 ? first & (0x3fu >> more) : 0xfffd;
    for (int i = 0; i < more; i++) {
        if ((*s & 0xc0) != 0x80) {
            v = 0xfffd;
            break;
        }
        v = v << 6 | (*s++ & 0x3fu);
    }
    *text = (const char *)s;
    return v;
}

size_t ct_archive_longest(const char *const *text, size_t n)
{
    size_t longest = 1;
    for (size_t i = 0; i < n; i++) {
        size_t count = 0;
        for (const char *s = text[i] ? text[i] : ""; *s; count++)
            ct_archive_next_point(&s);
        longest = count > longest ? count : longest;
    }
    return longest;
}

void ct_archive_write(struct ct_archive *z, const struct ct_archive_bytes *bytes)
{
    // errors are reported when the file is closed
    fwrite(bytes->b, 1, bytes->n, z->file->stream);
    z->offset += bytes->n;
}

void ct_archive_init(struct ct_archive *z, struct ct_arena *a, enum ct_suffix suffix,
                     struct ct_outfile *file)
{
    *z = (struct ct_archive){.arena = a,
                             .file = file,
                             .format
                             = suffix == CT_SUFFIX_MAT ? &ct_archive_mat : &ct_archive_npz};
}

void ct_archive_matrix(struct ct_archive *z, const char *name, const double *A, size_t n,
                       size_t m)
{
    z->format->numbers(z, name, (struct ct_archive_shape){n, m, false}, A);
}

void ct_archive_vector(struct ct_archive *z, const char *name, const double *v, size_t n)
{
    z->format->numbers(z, name, (struct ct_archive_shape){n, 1, true}, v);
}

void ct_archive_names(struct ct_archive *z, const char *name, const char *const *text, size_t n)
{
    z->format->names(z, name, text, n);
}

bool ct_archive_finish(struct ct_ctx *ctx, struct ct_archive *z)
{
    z->format->finish(z);
    return !z->is_too_long
        || ct_error(ctx, nowhere, CT_E_FILE,
                    "cannot write '%s': an array or the whole is too long for this format",
                    z->file->path);
}
