// What zlib does for us: compressed bytes, a stream of them, checksums. The only user of zlib.
#ifndef CT_REPORT_DEFLATE_H
#define CT_REPORT_DEFLATE_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/// CRC-32 (ISO 3309) of n bytes.
uint32_t ct_deflate_crc(const unsigned char *b, size_t n);
/// n bytes compressed (RFC 1951), in arena a; *size (out): how many they are now.
unsigned char *ct_deflate(struct ct_arena *a, const unsigned char *b, size_t n, size_t *size);

/// A stream in the format of gzip (RFC 1952), without a name or a time.
struct ct_gzip;
/// Onto out, until the arena goes.
struct ct_gzip *ct_gzip_create(struct ct_arena *a, FILE *out);
/// Errors show on the stream.
void ct_gzip_write(struct ct_gzip *g, const char *text, size_t n);
/// What was written can be read from now on; nothing more can be written.
void ct_gzip_finish(struct ct_gzip *g);

#endif
