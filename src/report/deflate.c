// See deflate.h. The standard level of zlib: the same bytes in, the same bytes out.
#include "report/deflate.h"

#include "base/guard.h"

#define ZLIB_CONST
#include <zlib.h>

#include <limits.h>

// Definition: of zlib. Limit: of a buffer
enum { WINDOW = 15, RAW = -WINDOW, WITH_GZIP_HEADER = WINDOW + 16, MEMORY = 8, ROOM = 1 << 14 };

struct ct_gzip {
    z_stream z;
    FILE *out;
    bool is_open;
};

static void end_stream(void *z)
{
    deflateEnd(z);
}

static void begin(struct ct_arena *a, z_stream *z, int window)
{
    if (deflateInit2(z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, window, MEMORY, Z_DEFAULT_STRATEGY)
        != Z_OK)
        ct_guard_raise();
    ct_arena_on_destroy(a, end_stream, z);
}

uint32_t ct_deflate_crc(const unsigned char *b, size_t n)
{
    uLong crc = crc32(0, NULL, 0);
    for (size_t part; n; b += part, n -= part) {
        part = n < UINT_MAX ? n : UINT_MAX;
        crc = crc32(crc, b, (uInt)part);
    }
    return (uint32_t)crc;
}

unsigned char *ct_deflate(struct ct_arena *a, const unsigned char *b, size_t n, size_t *size)
{
    z_stream *z = CT_NEW(a, z_stream);
    begin(a, z, RAW);
    const size_t room = deflateBound(z, n);
    unsigned char *to = CT_NEWN(a, unsigned char, room + 1);
    z->next_in = b;
    z->next_out = to;
    for (int state = Z_OK; state == Z_OK;) {
        const size_t left = n - (size_t)(z->next_in - b),
                     free = room - (size_t)(z->next_out - to);
        z->avail_in = left < UINT_MAX ? (uInt)left : UINT_MAX;
        z->avail_out = free < UINT_MAX ? (uInt)free : UINT_MAX;
        state = deflate(z, left <= UINT_MAX ? Z_FINISH : Z_NO_FLUSH);
    }
    *size = (size_t)(z->next_out - to);
    return to;
}

struct ct_gzip *ct_gzip_create(struct ct_arena *a, FILE *out)
{
    struct ct_gzip *g = CT_NEW(a, struct ct_gzip);
    g->out = out;
    begin(a, &g->z, WITH_GZIP_HEADER);
    g->is_open = true;
    return g;
}

static void pump(struct ct_gzip *g, int flush)
{
    unsigned char room[ROOM];
    do {
        g->z.next_out = room;
        g->z.avail_out = sizeof room;
        deflate(&g->z, flush);
        fwrite(room, 1, sizeof room - g->z.avail_out, g->out);
    } while (g->z.avail_out == 0);
}

void ct_gzip_write(struct ct_gzip *g, const char *text, size_t n)
{
    g->z.next_in = (const unsigned char *)text;
    g->z.avail_in = (uInt)n; // a piece of a file, below 4 GiB
    pump(g, Z_NO_FLUSH);
}

void ct_gzip_finish(struct ct_gzip *g)
{
    if (!g || !g->is_open)
        return;
    g->is_open = false;
    g->z.avail_in = 0;
    pump(g, Z_FINISH);
}
