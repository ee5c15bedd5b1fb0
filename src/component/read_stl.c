// See read_stl.h.
//
//     text     solid NAME { facet normal x y z  outer loop { vertex x y z } three times
//              endloop endfacet } endsolid NAME
//     binary   80 bytes, number n of triangles (4), n times: normal (12), corners (36),
//              attribute (2); little-endian
//
// A file is binary if its length is the one that its number of triangles asks for: some binary
// files begin with "solid", too.
#include "component/read_stl.h"

#include "expr/unit.h"
#include "io/text.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

// Definition: of binary STL: bytes before the triangles, bytes of a triangle, numbers of its
// corners.
enum { HEAD = 84, RECORD = 50, CORNERS = 9 };
static const size_t max_bytes = (size_t)64 << 20; // Limit: with a message

// ---- binary -----------------------------------------------------------------------------------

static uint32_t read_u32(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static float read_f32(const unsigned char *p)
{
    const uint32_t bits = read_u32(p);
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

static bool is_binary(const char *text, size_t n)
{
    return n >= HEAD
        && n - HEAD == (size_t)RECORD * read_u32((const unsigned char *)text + HEAD - 4);
}

static bool read_binary(struct ct_ctx *ctx, struct ct_arena *a, const char *path,
                        struct ct_mark used, const char *text, const float **triangle,
                        size_t *n)
{
    const unsigned char *p = (const unsigned char *)text + HEAD;
    *n = read_u32(p - 4);
    float *out = CT_NEWN(a, float, CORNERS **n + 1);
    for (size_t i = 0; i < *n; i++)
        for (size_t k = 0; k < CORNERS; k++) {
            const float v = read_f32(p + RECORD * i + 12 + 4 * k);
            if (!isfinite(v))
                return ct_error(ctx, used, CT_E_STL_DATA,
                                "the STL file '%s': a corner of triangle %zu is not finite",
                                path, i + 1);
            out[CORNERS * i + k] = v;
        }
    *triangle = out;
    return true;
}

// ---- text -------------------------------------------------------------------------------------

struct scan {
    struct ct_ctx *ctx;
    const char *path, *at, *line_start;
    int line;
};

static void skip_blanks(struct scan *s)
{
    for (; isspace((unsigned char)*s->at); s->at++)
        if (*s->at == '\n') {
            s->line++;
            s->line_start = s->at + 1;
        }
}

static bool wrong(struct scan *s, const char *wanted)
{
    const size_t n = strcspn(s->at, " \t\r\n");
    const struct ct_mark mark = {s->path, s->line, (int)(s->at - s->line_start)};
    if (!n)
        return ct_error(s->ctx, mark, CT_E_STL_DATA, "the STL file ends where '%s' is wanted",
                        wanted);
    return ct_error(s->ctx, mark, CT_E_STL_DATA, "found '%.*s' where %s is wanted",
                    n > 40 ? 40 : (int)n, s->at, wanted);
}

static bool is_word(struct scan *s, const char *word)
{
    skip_blanks(s);
    const size_t n = strcspn(s->at, " \t\r\n");
    return n == strlen(word) && strncasecmp(s->at, word, n) == 0;
}

static bool take_word(struct scan *s, const char *word)
{
    if (!is_word(s, word))
        return wrong(s, word);
    s->at += strlen(word);
    return true;
}

static bool take_number(struct scan *s, float *out)
{
    skip_blanks(s);
    const char *start = s->at;
    const bool is_negative = *s->at == '-';
    s->at += is_negative || *s->at == '+';
    double v;
    const size_t n = ct_number_parse(s->at, &v);
    *out = (float)(is_negative ? -v : v);
    if (n && isfinite(*out) && (!s->at[n] || isspace((unsigned char)s->at[n]))) {
        s->at += n;
        return true;
    }
    s->at = start;
    return wrong(s, "a number");
}

static bool take_numbers(struct scan *s, float out[3])
{
    return take_number(s, &out[0]) && take_number(s, &out[1]) && take_number(s, &out[2]);
}

// Skip three words: some programs write the normals of degenerate triangles as nan.
static void skip_normal(struct scan *s)
{
    for (int i = 0; i < 3 && !is_word(s, "outer"); i++)
        s->at += strcspn(s->at, " \t\r\n");
}

static bool take_facet(struct scan *s, float corner[CORNERS])
{
    if (!take_word(s, "facet") || !take_word(s, "normal"))
        return false;
    skip_normal(s);
    if (!take_word(s, "outer") || !take_word(s, "loop"))
        return false;
    for (int k = 0; k < 3; k++)
        if (!take_word(s, "vertex") || !take_numbers(s, corner + 3 * k))
            return false;
    return take_word(s, "endloop") && take_word(s, "endfacet");
}

static void skip_line(struct scan *s)
{
    s->at += strcspn(s->at, "\n");
}

static bool read_text(struct ct_ctx *ctx, struct ct_arena *a, const char *path,
                      const char *text, const float **triangle, size_t *n)
{
    struct scan s = {ctx, path, text, text, 0};
    struct corners {
        float v[CORNERS];
    } *all = NULL, one;
    size_t count = 0, cap = 0;
    for (skip_blanks(&s); *s.at; skip_blanks(&s)) {
        if (!take_word(&s, "solid"))
            return false;
        skip_line(&s); // name of the solid
        while (!is_word(&s, "endsolid")) {
            if (!take_facet(&s, one.v))
                return false;
            CT_PUSH(a, all, count, cap, one);
        }
        skip_line(&s);
    }
    *triangle = all ? all->v : NULL;
    *n = count;
    return true;
}

// ---- text or binary ----------------------------------------------------------------------------

static bool is_text(const char *text, size_t n)
{
    const size_t blank = strspn(text, " \t\r\n");
    return strlen(text) == n && strncasecmp(text + blank, "solid", 5) == 0;
}

static bool read_either(struct ct_ctx *ctx, struct ct_arena *a, const char *path,
                        struct ct_mark used, const char *text, size_t size,
                        const float **triangle, size_t *n)
{
    if (is_binary(text, size))
        return read_binary(ctx, a, path, used, text, triangle, n);
    if (is_text(text, size)) {
        if (read_text(ctx, a, path, text, triangle, n))
            return true;
        ct_note(ctx, used, "the file is used here");
        return false;
    }
    if (size < HEAD)
        return ct_error(ctx, used, CT_E_STL_DATA,
                        "'%s' is no STL file: it neither begins with 'solid' nor has the %d "
                        "bytes that a binary one begins with",
                        path, HEAD);
    const uint32_t told = read_u32((const unsigned char *)text + HEAD - 4);
    return ct_error(ctx, used, CT_E_STL_DATA,
                    "'%s' is no STL file: it does not begin with 'solid', and as a binary one "
                    "of %lu triangles it would have %llu bytes, not %zu",
                    path, (unsigned long)told, (unsigned long long)told * RECORD + HEAD, size);
}

bool ct_stl_read(struct ct_ctx *ctx, struct ct_arena *a, const char *path, struct ct_mark used,
                 const float **triangle, size_t *n)
{
    char *text;
    size_t size;
    switch (ct_text_read(ctx->scratch, path, max_bytes, &text, &size)) {
    case CT_TEXT_UNREADABLE:
        return ct_error(ctx, used, CT_E_STL, "cannot read the STL file '%s': %s", path,
                        strerror(errno));
    case CT_TEXT_TOO_BIG:
        return ct_error(ctx, used, CT_E_STL, "the STL file '%s' is larger than %zu MiB", path,
                        max_bytes >> 20);
    case CT_TEXT_ENDLESS:
        return ct_error(ctx, used, CT_E_STL, "the STL file '%s' is no regular file", path);
    case CT_TEXT_OK:
        break;
    }
    if (!read_either(ctx, a, path, used, text, size, triangle, n))
        return false;
    return *n > 0
        || ct_error(ctx, used, CT_E_STL_DATA, "the STL file '%s' has no triangle", path);
}
