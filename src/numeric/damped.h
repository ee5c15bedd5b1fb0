// Damped (Tikhonov regularised) least squares with sparse rows: minimise |A x - b|^2 + damping^2
// |x|^2.
//
// Solved as the sparse symmetric augmented system
//
//     [ damping I      A      ] [ y ]   [ b ]
//     [    A'     -damping I  ] [ x ] = [ 0 ]        damping y = b - A x
//
// by LU with pivoting and iterative refinement in extended precision. Its condition number is |A| /
// damping, that of the normal equations the square of this. Singular values of A far below the
// damping do not contribute to x, as in the solution of minimum norm. A singular value of round-off
// size eps amplifies the component of b along it by eps / damping^2.
//
// Further rows W x = c, whose diagonal is 1 in place of the damping, add |W x - c|^2 to
// |A x - b|^2/damping + damping |x|^2: with little damping A x = b is met first, and W x = c as far
// as it leaves x free.
//
// Source: the augmented system and its scaling, Bjorck (1996), section 2.7, key bjorck1996.
#ifndef CT_NUMERIC_DAMPED_H
#define CT_NUMERIC_DAMPED_H

#include "base/arena.h"

/// A sparse matrix by rows, appended one by one: the entries of row i are start[i] to start[i + 1]
/// - 1.
struct ct_sparse_rows {
    struct ct_arena *arena;
    size_t n, *start, start_cap;
    int *column;
    double *value;
    size_t column_cap, value_cap;
};
void ct_sparse_rows_clear(struct ct_sparse_rows *A);
/// Append a row: weight times the n entries value[k] at column[k]; column NULL: at column k.
void ct_sparse_rows_add(struct ct_sparse_rows *A, const int *column, const double *value,
                        size_t n, double weight);
/// y (n) = the first n rows of A times x.
void ct_sparse_rows_times(double *y, const struct ct_sparse_rows *A, size_t n, const double *x);
/// Largest Euclidean norm of a column in the first n rows. work (ncolumn)
double ct_sparse_rows_largest_column(const struct ct_sparse_rows *A, size_t n, size_t ncolumn,
                                     double *work);

struct ct_damped;
struct ct_damped *ct_damped_create(struct ct_arena *a);
/// Factor for the first n rows, which must not change until the last solution; of these the first
/// nfirst are A, the others W; damping > 0. The symbolic analysis is kept for later matrices of the
/// same pattern. Returns the approximate number of multiplications.
void ct_damped_factor(struct ct_damped *s, const struct ct_sparse_rows *A, size_t nfirst,
                      size_t n, size_t ncolumn, double damping);
/// x (ncolumn, out) for b (n), which it may overlap. NaN where A is not finite.
void ct_damped_solve(struct ct_damped *s, double *x, const double *b);

#endif
