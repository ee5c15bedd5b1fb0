// Hash map from pairs of indices to an index, in an arena.
//
// What always holds: a pair is found in constant time. No result depends on the order of the table.
#ifndef CT_BASE_PAIRS_H
#define CT_BASE_PAIRS_H

#include "base/arena.h"

struct ct_pairs {
    struct ct_pairs_slot {
        int a, b;
        int index; // plus one; 0: free
    } * slot;
    size_t n, size; // size is a power of two, at least twice n
};

/// The index of the pair (a, b), or -1.
int ct_pairs_get(const struct ct_pairs *s, int a, int b);
/// Add a pair that is not in the map yet.
void ct_pairs_put(struct ct_arena *arena, struct ct_pairs *s, int a, int b, int index);

#endif
