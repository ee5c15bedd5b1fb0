// Large blocks of zeroed memory from the system, whose pages come many at a time.
//
// Page faults are avoided: pages ahead of those in use are populated by one system call, and blocks
// of megabytes use large pages where the system offers them.
#ifndef CT_BASE_PAGES_H
#define CT_BASE_PAGES_H

#include <stddef.h>

/// A block of size bytes, zeroed, aligned to 16 bytes at least; NULL without memory.
void *ct_pages_create(size_t size);
/// size: as it was asked for.
void ct_pages_destroy(void *block, size_t size);

/// Populate the pages from byte `ready` to byte `used` and some beyond, at most to `size`. Returns
/// the end of the populated part. Memory behind it is valid too, at the cost of page faults.
size_t ct_pages_extend(void *block, size_t size, size_t ready, size_t used);

#endif
