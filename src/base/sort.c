// Bottom-up merge sort; see sort.h.
#include "base/sort.h"

#include <string.h>

// to[0 ... n) = from[0 ... middle) and from[middle ... n) merged.
static void merge(char *to, const char *from, size_t middle, size_t n, size_t size,
                  ct_order_fn order, const void *context)
{
    size_t i = 0, j = middle;
    for (size_t k = 0; k < n; k++, to += size) {
        const int left
            = j >= n || (i < middle && order(context, from + i * size, from + j * size) <= 0);
        memcpy(to, from + (left ? i++ : j++) * size, size);
    }
}

void ct_sort(struct ct_arena *scratch, void *array, size_t n, size_t size, ct_order_fn order,
             const void *context)
{
    if (n < 2)
        return;
    char *from = array, *to = ct_arena_calloc(scratch, n, size);
    for (size_t width = 1; width < n; width *= 2) {
        for (size_t k = 0; k < n; k += 2 * width) {
            const size_t left = n - k < width ? n - k : width;
            const size_t both = n - k < 2 * width ? n - k : 2 * width;
            merge(to + k * size, from + k * size, left, both, size, order, context);
        }
        char *swap = from;
        from = to;
        to = swap;
    }
    if (from != (char *)array)
        memcpy(array, from, n * size);
}
