// Reads whole text files into memory.
#ifndef CT_IO_TEXT_H
#define CT_IO_TEXT_H

#include "base/ctx.h"

enum ct_text_result { CT_TEXT_OK, CT_TEXT_UNREADABLE, CT_TEXT_TOO_BIG, CT_TEXT_ENDLESS };

/// Reads a file of at most `most` bytes into arena a; *text has a NUL after its *n bytes.
/// UNREADABLE leaves the reason in errno. No diagnostic: the caller knows the purpose of the
/// file.
enum ct_text_result ct_text_read(struct ct_arena *a, const char *path, size_t most, char **text,
                                 size_t *n);

/// The same for regular files only; FIFOs and devices, which may never end, give ENDLESS.
enum ct_text_result ct_text_read_regular(struct ct_arena *a, const char *path, size_t most,
                                         char **text, size_t *n);

#endif
