// See pages.h. Linux has the calls; elsewhere the C library's zeroed memory does.
#define _DEFAULT_SOURCE // MAP_ANONYMOUS; NOLINT(bugprone-reserved-identifier): the C library names it
#include "base/pages.h"

#include <stdint.h>
#include <stdlib.h>

// The address sanitizer watches what the C library gives.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#include <sys/mman.h>

// Pages of the processor; a size for its large ones; how much is asked for at once.
static const size_t page = 1 << 12, large_page = 1 << 21, ahead = 1 << 16;

static size_t round_up(size_t n, size_t to)
{
    return (n + to - 1) / to * to;
}

// Large pages must lie at multiples of their size: what is too much at either end goes back.
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

static void *map(size_t size)
{
    const size_t whole = round_up(size, page);
    void *p = map_aligned(whole, whole < large_page ? page : large_page);
#ifdef MADV_HUGEPAGE
    if (p && whole >= large_page)
        madvise(p, whole, MADV_HUGEPAGE); // refused, pages are small
#endif
    return p;
}

// Blocks given back, by their size: 32 KiB, 64 KiB ... 4 MiB, 11 MiB at most. A place is emptied and filled in one step, so
// threads need not wait for each other.
enum { LEAST_KEPT = 15, NSIZE = 8, NEACH = 4 };
static void *kept[NSIZE][NEACH];

// What a kept block says of itself.
struct note {
    size_t ready;
};

// The places for blocks of a size, and how many there are: 0 where such are not kept.
static int places(size_t size, void ***place)
{
    const size_t most_of_several = (size_t)1 << 19;
    for (int k = 0; k < NSIZE; k++)
        if (size == (size_t)1 << (LEAST_KEPT + k)) {
            *place = kept[k];
            return size <= most_of_several ? NEACH : 1;
        }
    return 0;
}

void *ct_pages_create(size_t size, size_t *ready, bool *is_zero)
{
    void **place = NULL;
    const int n = places(size, &place);
    for (int i = 0; i < n; i++) {
        void *p = __atomic_exchange_n(&place[i], NULL, __ATOMIC_ACQUIRE);
        if (p) {
            const struct note *note = p;
            *ready = note->ready;
            *is_zero = false;
            return p;
        }
    }
    *ready = 0;
    *is_zero = true;
    return map(size);
}

void ct_pages_destroy(void *block, size_t size, size_t ready)
{
    void **place = NULL;
    const int n = places(size, &place);
    *(struct note *)block = (struct note){ready};
    for (int i = 0; i < n; i++) {
        void *none = NULL;
        if (__atomic_compare_exchange_n(&place[i], &none, block, false, __ATOMIC_RELEASE,
                                        __ATOMIC_RELAXED))
            return;
    }
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
    return size; // page by page, as they are touched
}

#else

void *ct_pages_create(size_t size, size_t *ready, bool *is_zero)
{
    *ready = size;
    *is_zero = true;
    return calloc(1, size);
}

void ct_pages_destroy(void *block, size_t size, size_t ready)
{
    (void)size;
    (void)ready;
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
