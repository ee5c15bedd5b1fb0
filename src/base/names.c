// Open addressing with linear probing; see names.h.
#include "base/names.h"

#include <stdint.h>
#include <string.h>

// FNV-1a, 32 bits
static size_t hash(const char *s)
{
    uint32_t h = 2166136261u;
    for (; *s; s++)
        h = (h ^ (unsigned char)*s) * 16777619u;
    return h;
}

// The slot of this name, or the free slot where it would be stored.
static struct ct_names_slot *find(const struct ct_names *s, const char *name)
{
    size_t i = hash(name) & (s->size - 1);
    while (s->slot[i].name && strcmp(s->slot[i].name, name) != 0)
        i = (i + 1) & (s->size - 1);
    return &s->slot[i];
}

int ct_names_get(const struct ct_names *s, const char *name)
{
    if (!s->size)
        return -1;
    const struct ct_names_slot *slot = find(s, name);
    return slot->name ? slot->index : -1;
}

static void grow(struct ct_arena *a, struct ct_names *s)
{
    const struct ct_names old = *s;
    s->size = old.size ? 2 * old.size : 16;
    s->slot = CT_NEWN(a, struct ct_names_slot, s->size);
    for (size_t i = 0; i < old.size; i++)
        if (old.slot[i].name)
            *find(s, old.slot[i].name) = old.slot[i];
}

void ct_names_put(struct ct_arena *a, struct ct_names *s, const char *name, int index)
{
    if (2 * (s->n + 1) > s->size)
        grow(a, s);
    struct ct_names_slot *slot = find(s, name);
    if (slot->name)
        return;
    *slot = (struct ct_names_slot){name, index};
    s->n++;
}
