// Some entries of the inverse of a sparse matrix, for what it takes to factor it.
//
//     Z = (L U)^-1:   U Z = L^-1,   Z L = U^-1
//
// asks, from the last row and column on, for entries of Z at the places of (L + U)' alone, each a sum over those found before.
// Source: Takahashi, Fagan and Chen (1973), key takahashi1973; which entries are enough, Erisman and Tinney (1975), key erisman1975.
#ifndef CT_NUMERIC_SELECTED_INVERSE_H
#define CT_NUMERIC_SELECTED_INVERSE_H

#include "base/arena.h"

/// Factors in compressed columns, rows sorted: L (of ones on the diagonal, which come first), U (its diagonal last).
struct ct_lu_factors {
    int n;
    int *L_start, *L_row, *U_start, *U_row;
    double *L, *U;
};

struct ct_selected_inverse;

/// What is to be done for factors of this pattern; t must stay.
struct ct_selected_inverse *ct_selected_inverse_create(struct ct_arena *a,
                                                       const struct ct_lu_factors *t);
/// Where Z(i, j) is among what ct_selected_inverse_compute gives; an entry of L + U at (j, i) must be there.
int ct_selected_inverse_index(const struct ct_selected_inverse *s, int i, int j);
/// Entries of Z for the numbers that t has now. Allocates nothing.
const double *ct_selected_inverse_compute(struct ct_selected_inverse *s);

#endif
