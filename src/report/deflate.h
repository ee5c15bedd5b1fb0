// Compression and checksums by zlib. The only user of zlib.
#ifndef CT_REPORT_DEFLATE_H
#define CT_REPORT_DEFLATE_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/// CRC-32 (ISO 3309) of n bytes.
uint32_t ct_deflate_crc(const unsigned char *b, size_t n);
/// Compresses n bytes (RFC 1951) into arena a; *size (out): compressed size in bytes.
unsigned char *ct_deflate(struct ct_arena *a, const unsigned char *b, size_t n, size_t *size);

/// A stream in the format of gzip (RFC 1952), without a name or a time.
struct ct_gzip;
/// Creates a stream that writes to out and lives until the arena is destroyed.
struct ct_gzip *ct_gzip_create(struct ct_arena *a, FILE *out);
/// Writes text; errors are reported by the stream.
void ct_gzip_write(struct ct_gzip *g, const char *text, size_t n);
/// Completes the stream; afterwards nothing more can be written.
void ct_gzip_finish(struct ct_gzip *g);

#endif
