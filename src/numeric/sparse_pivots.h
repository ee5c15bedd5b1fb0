// Independent rows and columns of a sparse rectangular matrix, by Gaussian elimination.
//
// A pivot is at least half the largest entry left in its row, so that entries at most treble in a step and no solution
// for pivot columns is much larger than the others. Among these it is one of least fill, Markowitz's (r - 1)(c - 1), of
// a few of the shortest rows. A row is dependent when what is left of it is below `least`.
//
// Source: Markowitz (1957), key markowitz1957; a few rows, Zlatev (1980), key zlatev1980.
#ifndef CT_NUMERIC_SPARSE_PIVOTS_H
#define CT_NUMERIC_SPARSE_PIVOTS_H

#include "base/arena.h"

#include <stdbool.h>

/// An m x n matrix of nentry entries value[k] at (row[k], column[k]), each place once.
struct ct_sparse_entries {
    size_t m, n, nentry;
    const int *row, *column;
    const double *value;
};

/// row (m, out), column (n, out): those of the pivots first, in their order, then the others, ascending. Returns the
/// number of pivots. is_clear (out): no row's rest was near `least` when it was judged, by a factor of a hundred either
/// way. Cost: of sparse elimination; memory goes with the scratch arena.
size_t ct_sparse_pivots_find(struct ct_arena *scratch, const struct ct_sparse_entries *A,
                             double least, int *row, int *column, bool *is_clear);

#endif
