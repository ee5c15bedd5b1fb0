// Selected entries of the inverse of a sparse matrix, at about the cost of its factorisation.
//
//     Z = (L U)^-1:   U Z = L^-1,   Z L = U^-1
//
// These equations give the entries of Z on the pattern of (L + U)' by a recursion that starts at
// the last row and column. Sources: the recursion, Takahashi, Fagan and Chen (1973), key
// takahashi1973; proof that this pattern is closed under it, Erisman and Tinney (1975), key
// erisman1975.
#ifndef CT_NUMERIC_SELECTED_INVERSE_H
#define CT_NUMERIC_SELECTED_INVERSE_H

#include "base/arena.h"

/// LU factors in compressed columns, rows sorted: L with its unit diagonal first in each column, U
/// with its diagonal last.
struct ct_lu_factors {
    int n;
    int *L_start, *L_row, *U_start, *U_row;
    double *L, *U;
};

struct ct_selected_inverse;

/// Symbolic analysis for factors of this pattern; t must outlive it.
struct ct_selected_inverse *ct_selected_inverse_create(struct ct_arena *a,
                                                       const struct ct_lu_factors *t);
/// Index of Z(i, j) in the result of ct_selected_inverse_compute; L + U must have the entry (j, i).
int ct_selected_inverse_index(const struct ct_selected_inverse *s, int i, int j);
/// Compute the entries of Z for the present values of t. Does not allocate.
const double *ct_selected_inverse_compute(struct ct_selected_inverse *s);

#endif
