// Hash map from names to indices, in an arena.
//
// What always holds: a name is found in constant time. Names are not copied and must outlive the
// map. No result depends on the order of the table.
#ifndef CT_BASE_NAMES_H
#define CT_BASE_NAMES_H

#include "base/arena.h"

struct ct_names {
    struct ct_names_slot {
        const char *name; // NULL: free
        int index;
    } * slot;
    size_t n, size; // size is a power of two, at least twice n
};

/// The index of a name, or -1.
int ct_names_get(const struct ct_names *s, const char *name);
/// Add a name; if it exists already, its first index is kept.
void ct_names_put(struct ct_arena *a, struct ct_names *s, const char *name, int index);

#endif
