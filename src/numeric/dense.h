// src/numeric holds numerical kernels on arrays and sizes. It is the only user of LAPACK, KLU and
// ARPACK: dense factorisations, least squares and eigenvalues (this file), explicit inverses of
// small matrices (inverse.h), sparse LU (sparse.h; factors.h for many matrices of one pattern),
// damped sparse least squares (damped.h), independent rows of a sparse matrix (sparse_pivots.h),
// entries of a sparse inverse (selected_inverse.h), shift-invert Lanczos (arpack.h), SIMD vectors
// (simd2.h, simd4.h).
//
// This file: dense linear algebra on small matrices, mostly thin wrappers of LAPACK. Matrices are
// column-major with explicit leading dimension. Arguments are outputs first, then inputs, sizes,
// workspace. Nothing allocates; each function states the workspace it needs.
#ifndef CT_NUMERIC_DENSE_H
#define CT_NUMERIC_DENSE_H

#include <complex.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifndef CMPLX // of C11; some compilers lack it
#define CMPLX(re, im) ((double)(re) + I * (double)(im))
#endif

/// Largest |v_i| of n numbers, 0 for n = 0. NaN entries are ignored.
double ct_vector_largest(const double *v, size_t n);
/// Max norm of n numbers; NaN if an entry is NaN.
static inline double ct_vector_max_norm(const double *v, size_t n)
{
    // bit patterns of doubles without sign bit have the order of their values, with NaN last
    uint64_t most = 0;
    double size;
    for (size_t i = 0; i < n; i++) {
        uint64_t bits;
        memcpy(&bits, &v[i], sizeof bits);
        bits &= UINT64_MAX >> 1;
        most = bits > most ? bits : most;
    }
    memcpy(&size, &most, sizeof size);
    return size;
}

/// x . y of n numbers
double ct_vector_dot(const double *x, const double *y, size_t n);

/// y (n) += c x
void ct_vector_add(double *restrict y, double c, const double *restrict x, size_t n);

/// C (n x k) = A (n x m) B (m x k), stored without gaps.
void ct_matrix_multiply(double *restrict C, const double *restrict A, const double *restrict B,
                        int n, int m, int k);
/// C (n x k) = A' B, A (m x n), B (m x k).
void ct_matrix_multiply_transposed(double *restrict C, const double *restrict A,
                                   const double *restrict B, int n, int m, int k);

/// Cholesky A = L L' in place (lower, n x n); false if A is not positive definite.
bool ct_cholesky(double *A, int n, int lda);
/// x (n x nrhs, in: right-hand sides, out: solutions) with the factor of ct_cholesky.
void ct_cholesky_solve(double *x, const double *L, int n, int lda, int nrhs, int ldx);

/// H (n x n, symmetric: lower) = L^-1 H L^-T with that factor.
void ct_cholesky_congruence(double *H, const double *L, int n, int lda);
/// x = L^-T x.
void ct_cholesky_solve_transposed(double *x, const double *L, int n, int lda);

/// Cholesky of a banded matrix in place: A(i, j), j <= i <= j + band, at A[i - j + (band + 1) *
/// j]. False if it is not positive definite.
bool ct_band_cholesky(double *A, int n, int band);
/// x (n, in: right-hand side, out: solution) with that factor.
void ct_band_cholesky_solve(double *x, const double *L, int n, int band);

/// LU with partial pivoting in place; false if exactly singular. pivot (n).
bool ct_lu(double *A, int *pivot, int n, int lda);
void ct_lu_solve(double *x, const double *LU, const int *pivot, int n, int lda, int nrhs,
                 int ldx, bool transpose);

/// The same for complex matrices.
bool ct_lu_complex(double _Complex *A, int *pivot, int n, int lda);
void ct_lu_complex_solve(double _Complex *x, const double _Complex *LU, const int *pivot, int n,
                         int lda, int nrhs, int ldx);

/// QR with column pivoting, A P = Q R in place. column (n, out): original column of each new one;
/// tau (min(m, n), out). Returns the rank: diagonal entries of R above tol * |R_00|.
int ct_qr_pivot(double *A, int *column, double *tau, int m, int n, int lda, double tol,
                double *work);
size_t ct_qr_pivot_work(int m, int n);

/// Minimum-norm least-squares solution of A x = b by complete orthogonal decomposition:
/// A (m x n) is destroyed, b (max(m, n), in and out). Returns the rank with relative tolerance tol.
int ct_lstsq(double *b, double *A, int m, int n, int lda, double tol, int *iwork, double *work);
/// As ct_lstsq, where the rank is known to be at most `most`.
int ct_lstsq_of_rank(double *b, double *A, int m, int n, int lda, double tol, int most,
                     int *iwork, double *work);
size_t ct_lstsq_work(int m, int n);

/// Eigenvalues w (n, ascending) and vectors (in place of A, v' B v = 1) of A v = w B v, A
/// symmetric, B symmetric positive definite (lower; destroyed). False if B is not, or the
/// iteration fails.
bool ct_pencil_eigen(double *w, double *A, double *B, int n, int lda, double *work);
size_t ct_pencil_eigen_work(int n);

/// Eigenvalues w (n, ascending) of a symmetric matrix (lower; destroyed).
bool ct_symmetric_eigenvalues(double *w, double *A, int n, int lda, double *work);
size_t ct_symmetric_eigenvalues_work(int n);
/// Eigenvalues with orthonormal eigenvectors, which take the place of A. Workspace as above.
bool ct_symmetric_eigen(double *w, double *A, int n, int lda, double *work);

/// Eigenvalues re + i im (n) and right eigenvectors V (n x n, leading dimension n) of a square
/// matrix, balanced first; A is destroyed. Of a complex pair the column with im > 0 comes first:
/// real part, then imaginary part.
bool ct_eigen(double *re, double *im, double *V, double *A, int n, int lda, double *work);
size_t ct_eigen_work(int n);

#endif
