// Explicit inverses of small matrices, for many right-hand sides.
//
// Substitution with LU factors is a chain of dependent operations; a product with the inverse is
// not, and it uses SIMD vectors. Columns have leading dimension ct_inverse_rows(n), which is n
// rounded up to a multiple of four, and are padded by zeros.
#ifndef CT_NUMERIC_INVERSE_H
#define CT_NUMERIC_INVERSE_H

#include <complex.h>
#include <stdbool.h>
#include <stddef.h>

/// Largest matrix that is inverted: three vectors of four. Derived: measured at this size,
/// inversion and eight solutions take half the time of LU (tests/bench/kernels); larger matrices
/// are mostly sparse.
enum { CT_MOST_INVERTED = 12 };

static inline int ct_inverse_rows(int n)
{
    return (n + 3) / 4 * 4;
}

/// A (rows x n, in place) = A^-1 by Gauss-Jordan elimination with partial pivoting; false if
/// exactly singular or not finite. pivot (n): workspace. n <= CT_MOST_INVERTED. Error: n eps
/// cond(A), as of LU.
bool ct_inverse(double *A, int *pivot, int n);
/// x (rows, out) = A^-1 b, b (n).
void ct_inverse_apply(double *restrict x, const double *restrict inverse,
                      const double *restrict b, int n);

/// As ct_inverse for complex matrices: real parts (rows x n), then imaginary parts.
bool ct_inverse_complex(double *A, int *pivot, int n);
/// x (out: rows real parts, rows imaginary parts), b (n real parts, n imaginary parts).
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
