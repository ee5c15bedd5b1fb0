// Gauss-Jordan elimination and matrix-vector products with SIMD vectors; see inverse.h.
#include "numeric/inverse.h"

#include "numeric/simd4.h"
#include "numeric/simd2.h"

#include <math.h>

// y + i z -= (c + i d) (r + i s)
static inline void subtract_multiple_complex(double *y, double *z, double c, double d,
                                             const double *r, const double *s, int rows)
{
    for (int i = 0; i < rows; i += CT_SIMD2) {
        const ct_simd2 re = ct_simd2_load(r + i), im = ct_simd2_load(s + i);
        ct_simd2_store(y + i, ct_simd2_add(ct_simd2_add(ct_simd2_load(y + i), re, -c), im, d));
        ct_simd2_store(z + i, ct_simd2_add(ct_simd2_add(ct_simd2_load(z + i), im, -c), re, -d));
    }
}

static inline void exchange(double *x, double *y)
{
    const double z = *x;
    *x = *y;
    *y = z;
}

static inline void exchange_rows(double *A, int i, int j, int n, int rows)
{
    for (int c = 0; c < n && i != j; c++)
        exchange(A + i + rows * c, A + j + rows * c);
}

// Undo the pivoting: exchange the columns of A^-1 P to those of A^-1.
static inline void restore_columns(double *A, const int *pivot, int n, int rows)
{
    for (int k = n; k-- > 0;)
        for (int i = 0; i < rows && pivot[k] != k; i++)
            exchange(A + i + rows * k, A + i + rows * pivot[k]);
}

// column (rows, out) = column k of A, which is replaced by a unit column.
static inline void swap_unit_column(double *column, double *pivot_column, int k, int rows,
                                    double one)
{
    for (int i = 0; i < rows; i++) {
        column[i] = pivot_column[i];
        pivot_column[i] = 0;
    }
    pivot_column[k] = one;
}

// Instantiated for each number of rows, so that inner loops have a constant length.
static inline bool invert(double *restrict A, int *pivot, int n, const int rows)
{
    double column[CT_MOST_INVERTED];
    bool ok = true;
    for (int k = 0; k < n; k++) {
        double *pivot_column = A + rows * k;
        int p = k;
        for (int i = k + 1; i < n; i++)
            p = fabs(pivot_column[i]) > fabs(pivot_column[p]) ? i : p;
        pivot[k] = p;
        exchange_rows(A, k, p, n, rows);
        ok = ok && fabs(pivot_column[k]) > 0
          && isfinite(pivot_column[k]); // negated comparison: rejects NaN too
        const double inverse = 1 / pivot_column[k];
        swap_unit_column(column, pivot_column, k, rows, 1);
        for (int j = 0; j < n; j++) {
            double *a = A + rows * j;
            const double f = a[k] * inverse;
            for (int i = 0; i < rows; i++)
                a[i] -= f * column[i];
            a[k] = f;
        }
    }
    restore_columns(A, pivot, n, rows);
    return ok;
}

bool ct_inverse(double *A, int *pivot, int n)
{
    return n <= CT_SIMD4     ? invert(A, pivot, n, CT_SIMD4)
         : n <= 2 * CT_SIMD4 ? invert(A, pivot, n, 2 * CT_SIMD4)
                             : invert(A, pivot, n, CT_MOST_INVERTED);
}

// Blocks of eight rows, then one of four: two independent sums per column hide the latency.
CT_SIMD4_INLINE void matrix_vector(double *restrict x, const double *restrict A,
                                   const double *restrict b, int rows, int n)
{
    int i = 0;
    for (; i + 2 * CT_SIMD4 <= rows; i += 2 * CT_SIMD4) {
        const double *column = A + i;
        ct_simd4 first, second;
        ct_simd4_fill(&first, 0);
        ct_simd4_fill(&second, 0);
        for (int j = 0; j < n; j++, column += rows) {
            ct_simd4_add_times(&first, b[j], column);
            ct_simd4_add_times(&second, b[j], column + CT_SIMD4);
        }
        ct_simd4_put(x + i, &first);
        ct_simd4_put(x + i + CT_SIMD4, &second);
    }
    if (i < rows) {
        const double *column = A + i;
        ct_simd4 sum;
        ct_simd4_fill(&sum, 0);
        for (int j = 0; j < n; j++, column += rows)
            ct_simd4_add_times(&sum, b[j], column);
        ct_simd4_put(x + i, &sum);
    }
}

static void matrix_vector_sse(double *x, const double *A, const double *b, int rows, int n)
{
    matrix_vector(x, A, b, rows, n);
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2"))) static void matrix_vector_avx2(double *x, const double *A,
                                                               const double *b, int rows, int n)
{
    matrix_vector(x, A, b, rows, n);
}

void ct_matrix_vector(double *restrict x, const double *restrict A, const double *restrict b,
                      int rows, int n)
{
    (__builtin_cpu_supports("avx2") ? matrix_vector_avx2 : matrix_vector_sse)(x, A, b, rows, n);
}
#else
void ct_matrix_vector(double *restrict x, const double *restrict A, const double *restrict b,
                      int rows, int n)
{
    matrix_vector_sse(x, A, b, rows, n);
}
#endif

void ct_inverse_apply(double *restrict x, const double *restrict inverse,
                      const double *restrict b, int n)
{
    ct_matrix_vector(x, inverse, b, ct_inverse_rows(n), n);
}

bool ct_inverse_complex(double *A, int *pivot, int n)
{
    const int rows = ct_inverse_rows(n);
    double *B = A + rows * n; // imaginary parts
    double real[CT_MOST_INVERTED], imaginary[CT_MOST_INVERTED];
    bool ok = true;
    for (int k = 0; k < n; k++) {
        double *re = A + rows * k, *im = B + rows * k;
        int p = k;
        for (int i = k + 1; i < n; i++)
            p = fabs(re[i]) + fabs(im[i]) > fabs(re[p]) + fabs(im[p]) ? i : p;
        pivot[k] = p;
        exchange_rows(A, k, p, n, rows);
        exchange_rows(B, k, p, n, rows);
        const double square = re[k] * re[k] + im[k] * im[k];
        ok = ok && square > 0 && isfinite(square);
        const double c = re[k] / square, d = -im[k] / square;
        swap_unit_column(real, re, k, rows, 1);
        swap_unit_column(imaginary, im, k, rows, 0);
        for (int j = 0; j < n; j++) {
            double *a = A + rows * j, *b = B + rows * j;
            const double f = a[k] * c - b[k] * d, g = a[k] * d + b[k] * c;
            subtract_multiple_complex(a, b, f, g, real, imaginary, rows);
            a[k] = f;
            b[k] = g;
        }
    }
    restore_columns(A, pivot, n, rows);
    restore_columns(B, pivot, n, rows);
    return ok;
}

void ct_matrix_vector_complex(double *restrict x, double *restrict y, const double *restrict re,
                              const double *restrict im, const double *restrict a,
                              const double *restrict b, int rows, int n)
{
    for (int i = 0; i < rows; i += CT_SIMD2) {
        const double *X = re + i, *Y = im + i;
        ct_simd2 real = {0}, imaginary = {0}, less = {0}, more = {0};
        for (int j = 0; j < n; j++, X += rows, Y += rows) {
            const ct_simd2 p = ct_simd2_load(X), q = ct_simd2_load(Y);
            real = ct_simd2_add(real, p, a[j]);
            imaginary = ct_simd2_add(imaginary, p, b[j]);
            less = ct_simd2_add(less, q, b[j]);
            more = ct_simd2_add(more, q, a[j]);
        }
        ct_simd2_store(x + i, ct_simd2_add(real, less, -1));
        ct_simd2_store(y + i, ct_simd2_add(imaginary, more, 1));
    }
}

void ct_inverse_apply_complex(double *restrict x, const double *restrict inverse,
                              const double *restrict b, int n)
{
    const int rows = ct_inverse_rows(n);
    ct_matrix_vector_complex(x, x + rows, inverse, inverse + rows * n, b, b + n, rows, n);
}
