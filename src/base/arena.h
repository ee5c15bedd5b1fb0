// src/base holds what every stage needs and which itself needs only libc: arenas, errors by one
// non-local exit (guard.h), diagnostics (ctx.h), name maps, stable sorting and the shortest decimal
// text of a double. It knows nothing of models.
//
// This file: an arena allocator. All memory of an arena is freed at once.
//
//     arena:  [ chunk 4 KiB ] -> [ chunk 8 KiB ] -> [ chunk 16 KiB ] ...
//                                      ^ next free byte
//
// What always holds: memory is zeroed, aligned to 16 bytes, and does not move until the arena is
// released, except for arrays that grow. Allocation never returns NULL: when the system has no
// memory left it jumps to the guard of the public entry point (guard.h), which reports E001.
#ifndef CT_BASE_ARENA_H
#define CT_BASE_ARENA_H

#include <stdarg.h>
#include <stddef.h>

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

struct ct_arena;

/// A new arena; NULL if there is no memory. Later allocations that fail jump to the current guard.
struct ct_arena *ct_arena_create(void);
void ct_arena_destroy(struct ct_arena *a);

/// An arena that is destroyed together with its owner, unless destroyed before. An out-of-memory
/// jump therefore leaks nothing.
struct ct_arena *ct_arena_create_under(struct ct_arena *owner);

/// Empty the arena but keep its chunks for reuse. Cleanups run and child arenas are destroyed.
/// Repeating the same sequence of requests gives the same addresses without a system call. Cost:
/// number of chunks. Reused memory is zeroed when it is allocated again.
void ct_arena_clear(struct ct_arena *a);

/// Move all memory of `from` into `into` and destroy `from`. Cost: number of chunks of `from`.
void ct_arena_merge(struct ct_arena *into, struct ct_arena *from);

/// Register a cleanup end(data), called before the arena's memory is freed; the last one registered
/// is called first. For resources of libraries and of the system.
void ct_arena_on_destroy(struct ct_arena *a, void (*end)(void *data), void *data);

/// Allocate size bytes, zeroed, aligned to 16 bytes; large blocks to 64. Cost: O(size).
void *ct_arena_alloc(struct ct_arena *a, size_t size);
/// Allocate n elements of size bytes; an overflow of the product counts as out of memory.
void *ct_arena_calloc(struct ct_arena *a, size_t n, size_t size);
/// Allocate size bytes, zeroed, aligned to a cache line (64 bytes), for arrays that are read as
/// SIMD vectors.
void *ct_arena_alloc_cache_line(struct ct_arena *a, size_t size);
char *ct_arena_strdup(struct ct_arena *a, const char *s);
char *ct_arena_strndup(struct ct_arena *a, const char *s, size_t n);
char *ct_arena_printf(struct ct_arena *a, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));
char *ct_arena_vprintf(struct ct_arena *a, const char *fmt, va_list ap)
    __attribute__((format(printf, 2, 0)));

/// Bytes allocated so far, for reports.
size_t ct_arena_used(const struct ct_arena *a);

#define CT_NEW(a, T) ((T *)ct_arena_alloc((a), sizeof(T)))
#define CT_NEWN(a, T, n) ((T *)ct_arena_calloc((a), (size_t)(n), sizeof(T)))

/// An array of capacity `cap`, of which n elements are in use, gets capacity `more`, zeroed from n
/// on. It moves and must not be used at its old place, where a large one is freed; cap = 0: the
/// array is shared with others, which keep it.
void *ct_arena_resize(struct ct_arena *a, void *array, size_t n, size_t cap, size_t more,
                      size_t size);

/// Make room for one more element in a growable array. Returns the array, which moves as above if
/// it had to grow. n: elements in use; *cap: capacity. Use it through CT_PUSH.
void *ct_arena_grow(struct ct_arena *a, void *array, size_t n, size_t *cap, size_t size);

/// Append v to array (an lvalue pointer) with counters n and cap (lvalues, size_t).
#define CT_PUSH(a, array, n, cap, v)                                                           \
    ((void)((n) < (cap)                                                                        \
            || ((array) = ct_arena_grow((a), (array), (n), &(cap), sizeof *(array)))),         \
     (void)((array)[(n)++] = (v)))

#endif
