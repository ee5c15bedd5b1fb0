// Chunked bump allocator; see arena.h.
#include "base/arena.h"

#include "base/guard.h"
#include "base/pages.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { alignment = 16 }; // Definition: of all allocations

struct chunk {
    struct chunk *next;
    size_t size, used;  // bytes of payload
    size_t zeroed_from; // offset in the payload from which bytes are unused and still zero
    size_t ready;       // of pages: offset up to which they are populated
    bool is_pages;      // from pages.h; else from malloc
    bool is_array;      // one array that grows; of pages
    _Alignas(16) unsigned char data[];
};

struct cleanup {
    struct cleanup *next;
    void (*end)(void *data);
    void *data;
};

struct ct_arena {
    struct chunk *head;
    struct chunk *spare;     // cleared chunks, in the order of their allocation
    struct cleanup *cleanup; // in a chunk
    struct cleanup *under;   // cleanup in the owner that destroys this arena; may be NULL
    size_t total;
};

// Limit: smallest and largest chunk, header included: from one page to two large pages, doubling.
// Bounds the number of chunks and the unused memory.
static const size_t first_chunk = 1 << 12, largest_chunk = 1 << 22;
// Limit: chunks of at least this size are mapped pages, which the system zeroes; smaller ones come
// from malloc and are zeroed when memory is allocated.
static const size_t least_page_chunk = 1 << 18;

static size_t round_up(size_t n, size_t to)
{
    return (n + to - 1) & ~(to - 1);
}

// size: with its header.
static struct chunk *chunk_create(size_t size)
{
    ct_guard_poll();
    if (ct_guard_must_fail())
        return NULL;
    const bool is_pages = size >= least_page_chunk;
    struct chunk *c = is_pages ? ct_pages_create(size) : malloc(size);
    // most pages of a large block may never be touched, so a block of its own is not populated
    const size_t ready = !c || !is_pages      ? 0
                       : size > largest_chunk ? size
                                              : ct_pages_extend(c, size, 0, sizeof *c);
    if (c)
        *c = (struct chunk){.size = size - sizeof *c,
                            .zeroed_from = is_pages ? 0 : size - sizeof *c,
                            .ready = ready,
                            .is_pages = is_pages};
    return c;
}

static void chunk_destroy(struct chunk *c)
{
    if (c->is_pages)
        ct_pages_destroy(c, sizeof *c + c->size);
    else
        free(c);
}

static void *chunk_take(struct chunk *c, size_t size)
{
    void *p = c->data + c->used;
    if (c->used < c->zeroed_from)
        memset(p, 0, c->zeroed_from - c->used < size ? c->zeroed_from - c->used : size);
    c->used += size;
    if (c->is_pages && sizeof *c + c->used > c->ready)
        c->ready = ct_pages_extend(c, sizeof *c + c->size, c->ready, sizeof *c + c->used);
    return p;
}

static void chunks_destroy(struct chunk *c)
{
    for (struct chunk *next; c; c = next) {
        next = c->next;
        chunk_destroy(c);
    }
}

struct ct_arena *ct_arena_create(void)
{
    struct ct_arena *a = ct_guard_must_fail() ? NULL : calloc(1, sizeof *a);
    return a;
}

static void run_cleanups(const struct ct_arena *a)
{
    for (struct cleanup *e = a->cleanup; e; e = e->next)
        e->end(e->data);
}

void ct_arena_destroy(struct ct_arena *a)
{
    if (!a)
        return;
    if (a->under)
        a->under->data = NULL;
    run_cleanups(a);
    chunks_destroy(a->head);
    chunks_destroy(a->spare);
    free(a);
}

void ct_arena_clear(struct ct_arena *a)
{
    run_cleanups(a);
    a->cleanup = NULL;
    a->total = 0;
    struct chunk *spare = a->spare;
    for (struct chunk *c = a->head, *next; c; c = next) {
        next = c->next;
        if (c->zeroed_from < c->used)
            c->zeroed_from = c->used;
        c->used = 0;
        c->next = spare;
        spare = c;
    }
    a->head = NULL;
    a->spare = spare;
}

void ct_arena_on_destroy(struct ct_arena *a, void (*end)(void *data), void *data)
{
    struct cleanup *e = CT_NEW(a, struct cleanup);
    *e = (struct cleanup){a->cleanup, end, data};
    a->cleanup = e;
}

static void destroy_under(void *arena)
{
    ct_arena_destroy(arena);
}

struct ct_arena *ct_arena_create_under(struct ct_arena *owner)
{
    ct_arena_on_destroy(owner, destroy_under, NULL); // first: it may run out of memory
    struct ct_arena *a = ct_arena_create();
    if (!a)
        ct_guard_raise();
    a->under = owner->cleanup;
    a->under->data = a;
    return a;
}

void ct_arena_merge(struct ct_arena *into, struct ct_arena *from)
{
    if (from->under)
        from->under->data = NULL;
    into->total += from->total;
    struct chunk **last = &from->head; // behind the newest chunk of `into`, which has free room
    while (*last)
        last = &(*last)->next;
    struct chunk **second = into->head ? &into->head->next : &into->head;
    *last = *second;
    *second = from->head;
    chunks_destroy(from->spare);
    struct cleanup **first = &from->cleanup;
    while (*first)
        first = &(*first)->next;
    *first = into->cleanup;
    into->cleanup = from->cleanup;
    free(from);
}

// Padding before an allocation of this size. Large arrays start on a cache line, so that SIMD loads
// of four doubles do not cross lines.
static size_t padding(const struct chunk *c, size_t size)
{
    // Definition: bytes of a cache line. Limit: of waste by padding, a quarter
    const size_t line = 64, least = 256;
    return size < least ? 0 : -((uintptr_t)c->data + c->used) & (line - 1);
}

static bool has_room(const struct chunk *c, size_t size)
{
    return c && !c->is_array && c->size - c->used >= size + padding(c, size);
}

// Make a chunk with room for this size the current one: a spare chunk, else a new one of twice the
// size of the last.
static struct chunk *next_chunk(struct ct_arena *a, size_t size)
{
    const size_t most_padding = 64; // Definition: a cache line
    struct chunk *c = a->head;
    size_t want = c ? 2 * (sizeof *c + c->size) : first_chunk;
    if (want > largest_chunk)
        want = largest_chunk;
    if (want < size + most_padding + sizeof *c)
        want = size + most_padding + sizeof *c;
    struct chunk **spare = &a->spare;
    while (*spare && !has_room(*spare, size))
        spare = &(*spare)->next;
    c = *spare;
    if (c)
        *spare = c->next;
    else
        c = chunk_create(want);
    if (!c)
        ct_guard_raise();
    c->next = a->head;
    a->head = c;
    return c;
}

void *ct_arena_alloc(struct ct_arena *a, size_t size)
{
    if (size > SIZE_MAX / 2)
        ct_guard_raise();
    size = round_up(size, alignment);
    struct chunk *c = a->head;
    if (!has_room(c, size))
        c = next_chunk(a, size);
    a->total += size;
    c->used += padding(c, size);
    return chunk_take(c, size);
}

void *ct_arena_calloc(struct ct_arena *a, size_t n, size_t size)
{
    if (size && n > SIZE_MAX / 2 / size)
        ct_guard_raise();
    return ct_arena_alloc(a, n * size);
}

void *ct_arena_alloc_cache_line(struct ct_arena *a, size_t size)
{
    enum { LINE = 64 }; // Definition: bytes of a cache line
    char *p = ct_arena_calloc(a, size + LINE, 1);
    return p + (LINE - (uintptr_t)p % LINE) % LINE;
}

char *ct_arena_strndup(struct ct_arena *a, const char *s, size_t n)
{
    char *p = ct_arena_alloc(a, n + 1);
    memcpy(p, s, n);
    return p;
}

char *ct_arena_strdup(struct ct_arena *a, const char *s)
{
    return ct_arena_strndup(a, s, strlen(s));
}

// Fast path of printf for formats that only contain %s: copies into `to` (NULL: measure only).
// Returns the length, -1 if there is another conversion.
static long join(char *to, const char *fmt, va_list ap)
{
    long n = 0;
    for (; *fmt; fmt++) {
        const char *s = fmt;
        size_t length = 1;
        if (*fmt == '%') {
            if (*++fmt != 's')
                return -1;
            s = va_arg(ap, const char *);
            length = strlen(s);
        }
        if (to)
            memcpy(to + n, s, length);
        n += (long)length;
    }
    return n;
}

char *ct_arena_vprintf(struct ct_arena *a, const char *fmt, va_list ap)
{
    va_list measured;
    va_copy(measured, ap);
    const long length = join(NULL, fmt, measured);
    va_end(measured);
    if (length >= 0) {
        char *joined = ct_arena_alloc(a, (size_t)length + 1);
        join(joined, fmt, ap);
        return joined;
    }
    char most[256]; // short texts are formatted once, into this buffer
    va_list again;
    va_copy(again, ap);
    const int n = vsnprintf(most, sizeof most, fmt, ap);
    char *p = ct_arena_alloc(a, (size_t)(n < 0 ? 0 : n) + 1);
    if (n >= 0 && (size_t)n < sizeof most)
        memcpy(p, most, (size_t)n);
    else if (n >= 0)
        vsnprintf(p, (size_t)n + 1, fmt, again);
    va_end(again);
    return p;
}

char *ct_arena_printf(struct ct_arena *a, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    char *p = ct_arena_vprintf(a, fmt, ap);
    va_end(ap);
    return p;
}

// ---- arrays that grow ---------------------------------------------------------------------------

// An array with a block of its own, behind the current chunk, which keeps its free room.
static void *array_create(struct ct_arena *a, size_t size)
{
    struct chunk **spare = &a->spare;
    while (*spare && !((*spare)->is_array && (*spare)->size >= size))
        spare = &(*spare)->next;
    struct chunk *c = *spare;
    if (c)
        *spare = c->next;
    else
        c = chunk_create(sizeof *c + size);
    if (!c)
        ct_guard_raise();
    c->is_array = true;
    struct chunk **second = a->head ? &a->head->next : &a->head;
    c->next = *second;
    *second = c;
    a->total += size;
    return chunk_take(c, size);
}

// Free the block of the array of this size, if it has one.
static void array_destroy(struct ct_arena *a, const void *array, size_t size)
{
    for (struct chunk **at = &a->head; *at; at = &(*at)->next)
        if ((*at)->is_array && (*at)->data == array && (*at)->used == size) {
            struct chunk *c = *at;
            *at = c->next;
            a->total -= size;
            chunk_destroy(c);
            return;
        }
}

// Tests must notice uses of an array that has moved: with assertions it is overwritten.
static void overwrite(struct ct_arena *a, void *array, size_t size)
{
#ifndef NDEBUG
    for (const struct chunk *c = a->head; c; c = c->next)
        if ((unsigned char *)array >= c->data && (unsigned char *)array < c->data + c->used)
            memset(array, 0xa5, size);
#endif
    (void)a;
    (void)array;
    (void)size;
}

void *ct_arena_resize(struct ct_arena *a, void *array, size_t n, size_t cap, size_t more,
                      size_t size)
{
    if (more > SIZE_MAX / 2 / size)
        ct_guard_raise();
    const size_t old = round_up(cap * size, alignment), want = round_up(more * size, alignment);
    void *p = want < least_page_chunk ? ct_arena_alloc(a, want) : array_create(a, want);
    if (n)
        memcpy(p, array, n * size);
    overwrite(a, array, cap * size);
    if (old >= least_page_chunk)
        array_destroy(a, array, old);
    return p;
}

// Capacities double; arrays of half a megabyte or more grow eightfold, as pages of a large block
// are populated when they are touched.
static size_t next_cap(size_t n, size_t size)
{
    const size_t least = 8; // Limit: of memory
    return 2 * n < least ? least : n < largest_chunk / 8 / size ? 2 * n : 8 * n;
}

void *ct_arena_grow(struct ct_arena *a, void *array, size_t n, size_t *cap, size_t size)
{
    if (n < *cap)
        return array;
    const size_t more = next_cap(n, size);
    array = ct_arena_resize(a, array, n, *cap, more, size);
    *cap = more;
    return array;
}

size_t ct_arena_used(const struct ct_arena *a)
{
    return a->total;
}
