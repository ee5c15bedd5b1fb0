// Chunked bump allocator; see arena.h.
#include "base/arena.h"

#include "base/guard.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct chunk {
    struct chunk *next;
    size_t size, used; // bytes of payload
    bool is_zero;      // what is not used yet
    _Alignas(16) unsigned char data[];
};

struct ending {
    struct ending *next;
    void (*end)(void *data);
    void *data;
};

struct ct_arena {
    struct chunk *head;
    struct ending *ending; // in a chunk
    struct ending *under;  // of the owner, for this arena; may be NULL
    size_t total;
};

static const size_t first_chunk = 4096, largest_chunk = 1 << 22;
// Smaller chunks come from memory that has been used, and most of it in one piece: zeros are written as it is given out.
static const size_t least_fresh = 1 << 18;

static struct chunk *chunk_create(size_t size)
{
    if (ct_guard_must_fail())
        return NULL;
    const bool is_zero = size >= least_fresh;
    struct chunk *c = is_zero ? calloc(1, sizeof *c + size) : malloc(sizeof *c + size);
    if (c)
        *c = (struct chunk){.size = size, .is_zero = is_zero};
    return c;
}

struct ct_arena *ct_arena_create(void)
{
    struct ct_arena *a = ct_guard_must_fail() ? NULL : calloc(1, sizeof *a);
    return a;
}

void ct_arena_destroy(struct ct_arena *a)
{
    if (!a)
        return;
    if (a->under)
        a->under->data = NULL;
    for (struct ending *e = a->ending; e; e = e->next)
        e->end(e->data);
    for (struct chunk *c = a->head, *next; c; c = next) {
        next = c->next;
        free(c);
    }
    free(a);
}

void ct_arena_at_end(struct ct_arena *a, void (*end)(void *data), void *data)
{
    struct ending *e = CT_NEW(a, struct ending);
    *e = (struct ending){a->ending, end, data};
    a->ending = e;
}

static void end_under(void *arena)
{
    ct_arena_destroy(arena);
}

struct ct_arena *ct_arena_create_under(struct ct_arena *owner)
{
    ct_arena_at_end(owner, end_under, NULL); // first: it may run out of memory
    struct ct_arena *a = ct_arena_create();
    if (!a)
        ct_guard_raise();
    a->under = owner->ending;
    a->under->data = a;
    return a;
}

void *ct_arena_alloc(struct ct_arena *a, size_t size)
{
    if (size > SIZE_MAX / 2)
        ct_guard_raise();
    size = (size + 15) & ~(size_t)15;
    struct chunk *c = a->head;
    if (!c || c->size - c->used < size) {
        size_t want = c ? 2 * c->size : first_chunk;
        if (want > largest_chunk)
            want = largest_chunk;
        if (want < size)
            want = size;
        c = chunk_create(want);
        if (!c)
            ct_guard_raise();
        c->next = a->head;
        a->head = c;
    }
    void *p = c->data + c->used;
    c->used += size;
    a->total += size;
    return c->is_zero ? p : memset(p, 0, size);
}

void *ct_arena_calloc(struct ct_arena *a, size_t n, size_t size)
{
    if (size && n > SIZE_MAX / 2 / size)
        ct_guard_raise();
    return ct_arena_alloc(a, n * size);
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

char *ct_arena_vprintf(struct ct_arena *a, const char *fmt, va_list ap)
{
    char most[256]; // formatted once where it is short
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

void *ct_arena_grow(struct ct_arena *a, void *array, size_t n, size_t *cap, size_t size)
{
    if (n < *cap)
        return array;
    size_t more = *cap ? 2 * *cap : 8;
    void *p = ct_arena_calloc(a, more, size);
    if (n)
        memcpy(p, array, n * size);
    *cap = more;
    return p;
}

size_t ct_arena_used(const struct ct_arena *a)
{
    return a->total;
}
