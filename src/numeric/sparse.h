// Sparse linear equations A x = b: a named wrapper of KLU.
//
// The pattern is analysed once. A matrix is refactored with the pivots of the one before, and then
// neither factoring nor solving allocates.
//
// Source: Davis and Palamadai Natarajan (2010), key davis2010; refinement, Skeel (1980), key
// skeel1980.
#ifndef CT_NUMERIC_SPARSE_H
#define CT_NUMERIC_SPARSE_H

#include "base/arena.h"

#include <stdbool.h>

struct ct_sparse;

/// For which pivots the rows and columns are put in order.
enum ct_sparse_order {
    CT_SPARSE_DIAGONAL, // they will be on the diagonal, or next to it
    CT_SPARSE_ANY,      // borders without a diagonal: wherever they may be
};

/// Analyse the pattern of nentry entries (row[k], column[k]) of an n x n matrix; entries at one
/// place are added. What the library allocates goes with the arena. NULL where the library is not
/// available or n is 0.
struct ct_sparse *ct_sparse_create(struct ct_arena *a, int n, const int *row, const int *column,
                                   size_t nentry, enum ct_sparse_order order);
/// The same with the rows and columns (n each) in this order, pivots next to the diagonal.
struct ct_sparse *ct_sparse_create_along(struct ct_arena *a, int n, const int *row,
                                         const int *column, size_t nentry, int *first_rows,
                                         int *first_columns);
/// Factor the matrix of these values, in the order of the pattern, with the pivots of the last one.
/// The first time pivots are searched. False if it is singular.
bool ct_sparse_factor(struct ct_sparse *s, const double *value);
/// The same with a new search for pivots, which allocates.
bool ct_sparse_factor_repivot(struct ct_sparse *s, const double *value);
/// x (n, out) = A^-1 b by the last factors, with one step of refinement if *is_refined (in: it is
/// wanted at once; out: it was made). Returns the largest backward error of a row, |b - A x| /
/// (|b| + most |A| most |x|).
double ct_sparse_solve(struct ct_sparse *s, double *x, const double *b, bool *is_refined);
/// The same by iterative refinement with residuals in extended precision (where long double has
/// it), until corrections no longer decrease. Recovers the digits lost to the condition of the
/// matrix. Allocates nothing.
void ct_sparse_solve_extended(struct ct_sparse *s, double *x, const double *b);
/// Ratio of the smallest to the largest pivot of the last factors.
double ct_sparse_pivot(const struct ct_sparse *s);
/// Multiplications and additions of factoring, and entries of the factors: what it costs.
double ct_sparse_operations(const struct ct_sparse *s);
double ct_sparse_fill(const struct ct_sparse *s);

#endif
