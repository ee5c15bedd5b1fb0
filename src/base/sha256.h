// SHA-256 (FIPS 180-4), a cryptographic hash of a text.
#ifndef CT_BASE_SHA256_H
#define CT_BASE_SHA256_H

#include <stddef.h>

enum { CT_SHA256_SIZE = 32 }; // Definition: bytes of a digest

/// digest (out) of n bytes.
void ct_sha256(const unsigned char *b, size_t n, unsigned char digest[CT_SHA256_SIZE]);
/// As ct_sha256, written as 64 hexadecimal digits and a NUL.
void ct_sha256_text(const unsigned char *b, size_t n, char text[2 * CT_SHA256_SIZE + 1]);

#endif
