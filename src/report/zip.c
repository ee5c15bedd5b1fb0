// ZIP archives of compressed files; see archive.h. Numbers are little-endian, whatever the machine.
// Source: PKWARE APPNOTE 6.3.
#include "report/archive.h"
#include "report/deflate.h"

#include <string.h>

// Fields common to local and central headers: version needed ... lengths of name and extra
// field. The date is 1 January 1980, 0:00, so that equal contents give equal files.
static void put_entry(struct ct_archive_bytes *out, const struct ct_archive_entry *e)
{
    ct_archive_put(out, 20, 2);         // version needed: 2.0
    ct_archive_put(out, 1 << 11, 2);    // the name is UTF-8
    ct_archive_put(out, 8, 2);          // deflate
    ct_archive_put(out, 0, 2);          // time
    ct_archive_put(out, 1 << 5 | 1, 2); // date
    ct_archive_put(out, e->crc, 4);
    ct_archive_put(out, e->packed, 4);
    ct_archive_put(out, e->size, 4);
    ct_archive_put(out, strlen(e->name), 2);
    ct_archive_put(out, 0, 2);
}

// Sizes and offsets have 32 bits, the last of them reserved; names have 16.
static bool has_room(const struct ct_archive *z, const char *name, size_t size, size_t packed)
{
    return strlen(name) < UINT16_MAX && size < UINT32_MAX && packed < UINT32_MAX
        && z->offset + packed < UINT32_MAX / 2;
}

void ct_archive_add_file(struct ct_archive *z, const char *name,
                         const struct ct_archive_bytes *content)
{
    size_t packed;
    unsigned char *b = ct_deflate(z->arena, content->b, content->n, &packed);
    const struct ct_archive_bytes body = {.b = b, .n = packed};
    const struct ct_archive_entry e = {.name = ct_arena_strdup(z->arena, name),
                                       .crc = ct_deflate_crc(content->b, content->n),
                                       .size = (uint32_t)content->n,
                                       .packed = (uint32_t)packed,
                                       .offset = (uint32_t)z->offset};
    struct ct_archive_bytes header = {.arena = z->arena};
    if (!has_room(z, e.name, content->n, packed)) {
        z->is_too_long = true;
        return;
    }
    ct_archive_put(&header, 0x04034b50, 4);
    put_entry(&header, &e);
    ct_archive_put_text(&header, e.name);
    ct_archive_write(z, &header);
    ct_archive_write(z, &body);
    CT_PUSH(z->arena, z->entry, z->nentry, z->cap, e);
}

void ct_archive_finish_files(struct ct_archive *z)
{
    struct ct_archive_bytes b = {.arena = z->arena};
    z->is_too_long |= z->nentry >= UINT16_MAX;
    for (size_t i = 0; i < z->nentry; i++) {
        ct_archive_put(&b, 0x02014b50, 4);
        ct_archive_put(&b, 20, 2); // made by version 2.0
        put_entry(&b, &z->entry[i]);
        ct_archive_put(&b, 0, 2); // comment
        ct_archive_put(&b, 0, 2); // disk
        ct_archive_put(&b, 0, 2); // internal attributes
        ct_archive_put(&b, 0, 4); // external attributes
        ct_archive_put(&b, z->entry[i].offset, 4);
        ct_archive_put_text(&b, z->entry[i].name);
    }
    const size_t directory = b.n;
    ct_archive_put(&b, 0x06054b50, 4);
    ct_archive_put(&b, 0, 2);
    ct_archive_put(&b, 0, 2);
    ct_archive_put(&b, z->nentry, 2);
    ct_archive_put(&b, z->nentry, 2);
    ct_archive_put(&b, directory, 4);
    ct_archive_put(&b, z->offset, 4);
    ct_archive_put(&b, 0, 2);
    ct_archive_write(z, &b);
}
