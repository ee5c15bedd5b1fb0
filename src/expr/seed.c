// See seed.h.
#include "expr/seed.h"

#include "base/sort.h"

#include <string.h>

static int by_symbol(const void *context, const void *a, const void *b)
{
    (void)context;
    const struct ct_seed *s = a, *t = b;
    return s->symbol.id != t->symbol.id
             ? (s->symbol.id > t->symbol.id) - (s->symbol.id < t->symbol.id)
             : (s->direction > t->direction) - (s->direction < t->direction);
}

const struct ct_seed *ct_seeds_sorted(struct ct_arena *a, const struct ct_seed *seed, size_t n)
{
    struct ct_seed *sorted = CT_NEWN(a, struct ct_seed, n + 1);
    if (n)
        memcpy(sorted, seed, n * sizeof *sorted);
    ct_sort(a, sorted, n, sizeof *sorted, by_symbol, NULL);
    return sorted;
}

size_t ct_seeds_find(const struct ct_seed *seed, size_t n, uint32_t id)
{
    size_t low = 0, high = n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (seed[middle].symbol.id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}
