// Sparse linear equations A x = b: a named wrapper of KLU.
//
// The pattern is analysed once. A matrix is refactored with the pivots of the previous one; neither
// that nor solving allocates.
//
// Sources: Davis and Palamadai Natarajan (2010), key davis2010; refinement, Skeel (1980), key
// skeel1980.
#ifndef CT_NUMERIC_SPARSE_H
#define CT_NUMERIC_SPARSE_H

#include "base/arena.h"

#include <stdbool.h>

struct ct_sparse;

/// Which pivots the fill-reducing order of rows and columns assumes.
enum ct_sparse_order {
    CT_SPARSE_DIAGONAL, // pivots on the diagonal or close to it (AMD)
    CT_SPARSE_ANY, // pivots anywhere, as in bordered matrices with zero diagonal blocks (COLAMD)
};

/// Analyse the pattern of nentry entries (row[k], column[k]) of an n x n matrix; duplicate entries
/// are summed. Memory of KLU is freed with the arena. NULL where KLU is not available or n is 0.
struct ct_sparse *ct_sparse_create(struct ct_arena *a, int n, const int *row, const int *column,
                                   size_t nentry, enum ct_sparse_order order);
/// As ct_sparse_create with the given order of rows and columns (n each), pivots close to the
/// diagonal.
struct ct_sparse *ct_sparse_create_along(struct ct_arena *a, int n, const int *row,
                                         const int *column, size_t nentry, int *first_rows,
                                         int *first_columns);
/// Factor the matrix with these values, in the order of the pattern, with the previous pivots. At
/// the first call pivots are searched for. False if the matrix is singular.
bool ct_sparse_factor(struct ct_sparse *s, const double *value);
/// The same with a new search for pivots, which allocates.
bool ct_sparse_factor_repivot(struct ct_sparse *s, const double *value);
/// x (n, out) = A^-1 b by the last factors. *is_refined: in, make one step of iterative refinement
/// in any case; out, one was made. Returns the largest componentwise backward error, |b - A x| /
/// (|b| + most |A| most |x|) over the rows.
double ct_sparse_solve(struct ct_sparse *s, double *x, const double *b, bool *is_refined);
/// As ct_sparse_solve, by iterative refinement with residuals in extended precision (where long
/// double has it) until corrections no longer decrease. Recovers the digits that are lost to the
/// condition of the matrix. Does not allocate.
void ct_sparse_solve_extended(struct ct_sparse *s, double *x, const double *b);
/// Ratio of the smallest to the largest pivot of the last factors.
double ct_sparse_pivot(const struct ct_sparse *s);
/// Cost of the last factorisation: multiplications and additions, and entries of the factors.
double ct_sparse_operations(const struct ct_sparse *s);
double ct_sparse_fill(const struct ct_sparse *s);

#endif
