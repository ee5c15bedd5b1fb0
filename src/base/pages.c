// See pages.h. The calls exist on Linux; elsewhere calloc is used.
#define _DEFAULT_SOURCE // MAP_ANONYMOUS; NOLINT(bugprone-reserved-identifier): the C library names it
#include "base/pages.h"

#include <stdint.h>
#include <stdlib.h>

// The address sanitizer checks only memory of the C library.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#include <sys/mman.h>

// Definition: sizes of pages and of large pages. Limit: how much is populated at once.
static const size_t page = 1 << 12, large_page = 1 << 21, ahead = 1 << 16;

static size_t round_up(size_t n, size_t to)
{
    return (n + to - 1) / to * to;
}

// Large pages must be aligned to their size: the surplus at either end is returned to the system.
static void *map_aligned(size_t size, size_t alignment)
{
    const size_t more = size + alignment - page;
    char *p = mmap(NULL, more, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED)
        return NULL;
    const size_t before = round_up((uintptr_t)p, alignment) - (uintptr_t)p,
                 behind = more - before - size;
    if (before)
        munmap(p, before);
    if (behind)
        munmap(p + before + size, behind);
    return p + before;
}

void *ct_pages_create(size_t size)
{
    const size_t whole = round_up(size, page);
    void *p = map_aligned(whole, whole < large_page ? page : large_page);
#ifdef MADV_HUGEPAGE
    if (p && whole >= large_page)
        madvise(p, whole, MADV_HUGEPAGE); // if refused, pages are small
#endif
    return p;
}

void ct_pages_destroy(void *block, size_t size)
{
    munmap(block, round_up(size, page));
}

size_t ct_pages_extend(void *block, size_t size, size_t ready, size_t used)
{
#ifdef MADV_POPULATE_WRITE
    const size_t from = ready / page * page, to = round_up(used, ahead),
                 whole = round_up(size, page), end = to < whole ? to : whole;
    if (madvise((char *)block + from, end - from, MADV_POPULATE_WRITE) == 0)
        return end < size ? end : size;
#endif
    (void)block;
    (void)ready;
    (void)used;
    return size; // pages are populated when touched
}

#else

void *ct_pages_create(size_t size)
{
    return calloc(1, size);
}

void ct_pages_destroy(void *block, size_t size)
{
    (void)size;
    free(block);
}

size_t ct_pages_extend(void *block, size_t size, size_t ready, size_t used)
{
    (void)block;
    (void)ready;
    (void)used;
    return size;
}

#endif
