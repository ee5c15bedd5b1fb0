// Large blocks of zeroed memory from the system, whose pages come many at a time.
//
// A page that is touched before it is there interrupts the program, which takes longer than to fill it. So the pages
// ahead of what is in use are asked for in one call, and blocks of some megabytes have large pages where the system
// has such. Some blocks that are given back are kept for the next who asks, in this thread or another: their pages are
// there, and to fill them with zeros takes a tenth of the time that the system takes for new ones.
#ifndef CT_BASE_PAGES_H
#define CT_BASE_PAGES_H

#include <stdbool.h>
#include <stddef.h>

/// A block of size bytes, aligned to 16 bytes at least; NULL without memory. *ready: up to where its pages are there.
/// *is_zero: it is zeroed; else it has been used, and holds anything.
void *ct_pages_create(size_t size, size_t *ready, bool *is_zero);
/// size: as it was asked for. ready: as it is now.
void ct_pages_destroy(void *block, size_t size, size_t ready);

/// Makes the pages from `ready` to `used`, and some beyond, ready, `size` at most; returns up to where they are. What
/// is not ready can be used too, more slowly.
size_t ct_pages_extend(void *block, size_t size, size_t ready, size_t used);

#endif
