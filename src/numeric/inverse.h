// Inverses of small matrices that many right-hand sides are to come for.
//
// A product with the inverse is sums that do not wait for each other, where the substitutions of factors wait from row to
// row: for up to a dozen rows it takes a fifth of the time. Columns stand `rows` apart, n rounded up to a multiple of four,
// with zeros below: ct_inverse_rows(n) x n numbers.
#ifndef CT_NUMERIC_INVERSE_H
#define CT_NUMERIC_INVERSE_H

#include <complex.h>
#include <stdbool.h>
#include <stddef.h>

enum { CT_MOST_INVERTED = 12 };

static inline int ct_inverse_rows(int n)
{
    return (n + 3) / 4 * 4;
}

/// A (rows x n, in place) = A^-1 by Gauss and Jordan with partial pivoting; false if exactly singular or not finite. pivot (n)
/// is overwritten. n <= CT_MOST_INVERTED, its errors those of factors: of the order of n eps cond(A).
bool ct_inverse(double *A, int *pivot, int n);
/// x (rows, out) = A^-1 b, b (n).
void ct_inverse_apply(double *restrict x, const double *restrict inverse,
                      const double *restrict b, int n);

/// The same of complex matrices, real parts (rows x n) before imaginary ones.
bool ct_inverse_complex(double *A, int *pivot, int n);
/// x (rows real, rows imaginary parts, out), b (n, n).
void ct_inverse_apply_complex(double *restrict x, const double *restrict inverse,
                              const double *restrict b, int n);

/// x (rows, out) = A b, A (rows x n), rows a multiple of four.
void ct_matrix_vector(double *restrict x, const double *restrict A, const double *restrict b,
                      int rows, int n);
/// x + i y = (re + i im) (a + i b), of the same shapes.
void ct_matrix_vector_complex(double *restrict x, double *restrict y, const double *restrict re,
                              const double *restrict im, const double *restrict a,
                              const double *restrict b, int rows, int n);

#endif
