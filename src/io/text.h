// Whole text files into memory.
#ifndef CT_IO_TEXT_H
#define CT_IO_TEXT_H

#include "base/ctx.h"

enum ct_text_result { CT_TEXT_OK, CT_TEXT_UNREADABLE, CT_TEXT_TOO_BIG, CT_TEXT_ENDLESS };

/// Read a file of at most `most` bytes into arena a; *text gets a NUL after its *n bytes.
/// UNREADABLE leaves the reason in errno. Reports nothing: the caller knows what the file is for.
enum ct_text_result ct_text_read(struct ct_arena *a, const char *path, size_t most, char **text,
                                 size_t *n);

/// The same where a FIFO, a device and the like, which may never end, are ENDLESS.
enum ct_text_result ct_text_read_regular(struct ct_arena *a, const char *path, size_t most,
                                         char **text, size_t *n);

#endif
