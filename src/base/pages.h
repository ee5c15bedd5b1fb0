// Large blocks of zeroed memory from the system.
//
// Page faults are avoided: pages ahead of those in use are populated in one system call, and blocks
// of megabytes use large pages where the system offers them.
#ifndef CT_BASE_PAGES_H
#define CT_BASE_PAGES_H

#include <stddef.h>

/// A block of size bytes, zeroed, aligned to 16 bytes at least; NULL without memory.
void *ct_pages_create(size_t size);
/// size: as passed to ct_pages_create.
void ct_pages_destroy(void *block, size_t size);

/// Populate the pages from byte `ready` to byte `used` and some beyond, at most to `size`. Returns
/// the end of the populated part. Memory after it is valid too, but costs page faults.
size_t ct_pages_extend(void *block, size_t size, size_t ready, size_t used);

#endif
