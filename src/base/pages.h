// Large blocks of zeroed memory from the system, whose pages come many at a time.
//
// A page that is touched before it is there interrupts the program, which takes longer than to fill it. So the pages
// ahead of what is in use are asked for in one call, and blocks of some megabytes have large pages where the system
// has such.
#ifndef CT_BASE_PAGES_H
#define CT_BASE_PAGES_H

#include <stddef.h>

/// A block of size bytes, zeroed, aligned to 16 bytes at least; NULL without memory.
void *ct_pages_create(size_t size);
/// size: as it was asked for.
void ct_pages_destroy(void *block, size_t size);

/// Makes the pages from `ready` to `used`, and some beyond, ready, `size` at most; returns up to where they are. What
/// is not ready can be used too, more slowly.
size_t ct_pages_extend(void *block, size_t size, size_t ready, size_t used);

#endif
