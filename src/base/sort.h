// Stable sorting; the comparison has a context argument, which that of qsort lacks.
#ifndef CT_BASE_SORT_H
#define CT_BASE_SORT_H

#include "base/arena.h"

typedef int (*ct_order_fn)(const void *context, const void *a, const void *b);

/// Sort n elements of size bytes; equal elements keep their order. Cost O(n log n); scratch holds a
/// copy.
void ct_sort(struct ct_arena *scratch, void *array, size_t n, size_t size, ct_order_fn order,
             const void *context);

#endif
