// Independent rows and columns of a sparse rectangular matrix, by Gaussian elimination.
//
// A pivot is at least half the largest remaining entry in its row. Entries then grow at most
// threefold in a step, and no solution for the pivot columns is much larger than the others. Among
// such entries in a few of the shortest rows, the pivot has the least Markowitz count (r - 1)(c -
// 1), which bounds the fill. A row is dependent when its remaining entries are all below `least`.
//
// Sources: Markowitz (1957), key markowitz1957; search in a few rows, Zlatev (1980), key
// zlatev1980.
#ifndef CT_NUMERIC_SPARSE_PIVOTS_H
#define CT_NUMERIC_SPARSE_PIVOTS_H

#include "base/arena.h"

#include <stdbool.h>

/// An m x n matrix of nentry entries value[k] at (row[k], column[k]), without duplicates.
struct ct_sparse_entries {
    size_t m, n, nentry;
    const int *row, *column;
    const double *value;
};

/// row (m, out), column (n, out): those of the pivots in the order of elimination, then the others,
/// ascending. Returns the number of pivots (the rank). is_clear (out): the rank is beyond doubt,
/// because no remaining row was within a factor of a hundred of `least` when it was judged. Cost:
/// sparse elimination; its memory is freed with the scratch arena.
size_t ct_sparse_pivots_find(struct ct_arena *scratch, const struct ct_sparse_entries *A,
                             double least, int *row, int *column, bool *is_clear);

#endif
