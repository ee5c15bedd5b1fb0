// Damped least squares with sparse rows:  |A x - b|^2 + damping^2 |x|^2  least.
//
// Solved as the sparse symmetric system
//
//     [ damping I      A      ] [ y ]   [ b ]
//     [    A'     -damping I  ] [ x ] = [ 0 ]        damping y = b - A x
//
// by LU with pivoting and refinement in extended precision. Its condition is |A| / damping; that of
// the normal equations is the square. Singular values of A far below the damping have no part in x,
// as in the solution of least norm; those that are round-off, eps, multiply what b has along them by eps / damping^2.
//
// Source: the augmented system and its scaling, Bjorck (1996), section 2.7, key bjorck1996.
#ifndef CT_NUMERIC_DAMPED_H
#define CT_NUMERIC_DAMPED_H

#include "base/arena.h"

/// Rows of a sparse matrix, appended one by one: the entries of row i are start[i] to start[i + 1].
struct ct_sparse_rows {
    struct ct_arena *arena;
    size_t n, *start, start_cap;
    int *column;
    double *value;
    size_t column_cap, value_cap;
};
void ct_sparse_rows_clear(struct ct_sparse_rows *A);
/// Append weight times the row of n entries value[k] at column[k]; column NULL: at k.
void ct_sparse_rows_add(struct ct_sparse_rows *A, const int *column, const double *value,
                        size_t n, double weight);
/// y (n) = the first n rows of A times x.
void ct_sparse_rows_times(double *y, const struct ct_sparse_rows *A, size_t n, const double *x);
/// Largest |A x| of columns x of the unit matrix (ncolumn) in the first n rows. work (ncolumn)
double ct_sparse_rows_largest_column(const struct ct_sparse_rows *A, size_t n, size_t ncolumn,
                                     double *work);

struct ct_damped;
struct ct_damped *ct_damped_create(struct ct_arena *a);
/// Factor for the first n rows of A, which must stay until the last solution; damping > 0. The analysis of a pattern is kept
/// for the next factors of the same. Returns about how many multiplications it took.
double ct_damped_factor(struct ct_damped *s, const struct ct_sparse_rows *A, size_t n,
                        size_t ncolumn, double damping);
/// x (ncolumn, out) for b (n), which it may overlap. NaN where A is not finite.
void ct_damped_solve(struct ct_damped *s, double *x, const double *b);

#endif
