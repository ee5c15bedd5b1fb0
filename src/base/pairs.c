// Open addressing with linear probing; see pairs.h.
#include "base/pairs.h"

#include <stdint.h>

// Definition: each half is spread by a multiplication with 2^64 / golden ratio; Knuth (1998), 6.4.
static size_t hash(int a, int b)
{
    // Definition: 2^64 / golden ratio
    const uint64_t spread = UINT64_C(0x9e3779b97f4a7c15);
    const uint64_t h = ((uint64_t)(uint32_t)a * spread ^ (uint64_t)(uint32_t)b) * spread;
    return (size_t)(h >> 32);
}

// The slot of this pair, or the free slot where it would be stored.
static struct ct_pairs_slot *find(const struct ct_pairs *s, int a, int b)
{
    size_t i = hash(a, b) & (s->size - 1);
    while (s->slot[i].index && (s->slot[i].a != a || s->slot[i].b != b))
        i = (i + 1) & (s->size - 1);
    return &s->slot[i];
}

int ct_pairs_get(const struct ct_pairs *s, int a, int b)
{
    return s->size ? find(s, a, b)->index - 1 : -1;
}

static void grow(struct ct_arena *arena, struct ct_pairs *s)
{
    const struct ct_pairs old = *s;
    s->size = old.size ? 2 * old.size : 16;
    s->slot = CT_NEWN(arena, struct ct_pairs_slot, s->size);
    for (size_t i = 0; i < old.size; i++)
        if (old.slot[i].index)
            *find(s, old.slot[i].a, old.slot[i].b) = old.slot[i];
}

void ct_pairs_put(struct ct_arena *arena, struct ct_pairs *s, int a, int b, int index)
{
    if (2 * (s->n + 1) > s->size)
        grow(arena, s);
    *find(s, a, b) = (struct ct_pairs_slot){a, b, index + 1};
    s->n++;
}
