// Dense kernels against their definitions: residuals, orthogonality, ranks.
#include "numeric/dense.h"
#include "numeric/envelope.h"
#include "numeric/inverse.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 12, LDA = 15, WORK = 200 }; // an lda above the rows shows a forgotten stride

// n terms of order 1, growing with the condition of matrices that are random: a hundred times over
static const double close_enough = 1e4 * DBL_EPSILON;

static uint64_t state = 20240229; // the seed; the same numbers in every run

static double uniform(void) // in [-1, 1)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(int64_t)(state >> 11) / 4503599627370496.0 - 1;
}

static void fill(double *A, int m, int n)
{
    for (int j = 0; j < n; j++)
        for (int i = 0; i < LDA; i++)
            A[i + LDA * j] = i < m ? uniform() : NAN; // below the rows nothing may be read
}

// A (m x n) of the given rank: a product of random m x rank and rank x n.
static void fill_rank(double *A, int m, int n, int rank)
{
    double L[LDA * MOST], R[LDA * MOST];
    fill(L, m, rank);
    fill(R, rank, n);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < LDA; i++) {
            A[i + LDA * j] = i < m ? 0 : NAN;
            for (int k = 0; k < rank && i < m; k++)
                A[i + LDA * j] += L[i + LDA * k] * R[k + LDA * j];
        }
}

// y = A x, A (m x n)
static void multiply(double *restrict y, const double *A, const double *restrict x, int m,
                     int n, int lda)
{
    memset(y, 0, (size_t)m * sizeof *y);
    for (int j = 0; j < n; j++) {
        const double *a = A + (size_t)lda * j;
        for (int i = 0; i < m; i++)
            y[i] += a[i] * x[j];
    }
}

// y = A' x
static void multiply_t(double *restrict y, const double *A, const double *restrict x, int m,
                       int n, int lda)
{
    for (int j = 0; j < n; j++) {
        const double *a = A + (size_t)lda * j;
        double sum = 0;
        for (int i = 0; i < m; i++)
            sum += a[i] * x[i];
        y[j] = sum;
    }
}

// A = B' B + I, symmetric and positive definite; the upper triangle is never read.
static void fill_definite(double *A, double *full, int n)
{
    double B[LDA * MOST];
    fill(B, n, n);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            double sum = i == j;
            for (int k = 0; k < n; k++)
                sum += B[k + LDA * i] * B[k + LDA * j];
            full[i + LDA * j] = sum;
            A[i + LDA * j] = i >= j ? sum : NAN;
        }
}

static void check_close(const char *what, double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance)) {
        printf("%s: got %.17g, wanted %.17g within %g\n", what, got, want, tolerance);
        fail();
    }
}

static double dot(const double *a, const double *b, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

static void cholesky_solves_definite_matrices(void **unused)
{
    (void)unused;
    for (int n = 0; n <= MOST; n++) {
        double A[LDA * MOST], full[LDA * MOST], want[2 * LDA], x[2 * LDA];
        fill_definite(A, full, n);
        for (int i = 0; i < 2 * LDA; i++)
            want[i] = uniform();
        for (int c = 0; c < 2; c++)
            multiply(x + LDA * c, full, want + LDA * c, n, n, LDA);
        assert_true(ct_cholesky(A, n, LDA));
        ct_cholesky_solve(x, A, n, LDA, 2, LDA);
        for (int c = 0; c < 2; c++)
            for (int i = 0; i < n; i++)
                check_close("x", x[i + LDA * c], want[i + LDA * c], close_enough);
    }
}

static void cholesky_refuses_indefinite_and_nonfinite(void **unused)
{
    (void)unused;
    double indefinite[] = {1, 2, NAN, 1};
    assert_false(ct_cholesky(indefinite, 2, 2));
    double nonfinite[] = {1, 0, 0, NAN};
    assert_false(ct_cholesky(nonfinite, 2, 2));
}

// Each row starts anywhere: the factor equals that of the full matrix, entry by entry.
static void cholesky_stays_in_the_envelope(void **unused)
{
    (void)unused;
    struct ct_arena *a = ct_arena_create();
    for (int n = 0; n <= MOST; n++) {
        double A[LDA * MOST], full[LDA * MOST];
        int first[MOST + 1];
        fill_definite(A, full, n);
        for (int i = 0; i < n; i++)
            first[i] = (int)(fabs(uniform()) * (i + 1)) % (i + 1);
        struct ct_envelope e = ct_envelope_create(a, first, n);
        for (int j = 0; j < n; j++)
            for (int i = j; i < n; i++)
                if (j < first[i])
                    A[i + LDA * j] = 0;
                else
                    *ct_envelope_at(&e, i, j) = A[i + LDA * j] += i == j ? n * n : 0;
        assert_true(ct_cholesky(A, n, LDA));
        assert_int_equal(ct_envelope_cholesky(&e), n);
        for (int j = 0; j < n; j++)
            for (int i = j; i < n; i++)
                assert_true((j < first[i] ? 0 : *ct_envelope_at(&e, i, j)) == A[i + LDA * j]);
    }
    const double pivot[] = {4, 9, -1, 1};
    struct ct_envelope e = ct_envelope_create(a, (const int[]){0, 1, 2, 3}, 4);
    for (int i = 0; i < 4; i++)
        *ct_envelope_at(&e, i, i) = pivot[i];
    assert_int_equal(ct_envelope_cholesky(&e), 2);
    assert_true(*ct_envelope_at(&e, 1, 1) == 3 && *ct_envelope_at(&e, 2, 2) == -1);
    ct_arena_destroy(a);
}

static void lu_solves_both_ways(void **unused)
{
    (void)unused;
    for (int n = 1; n <= MOST; n++) {
        double A[LDA * MOST], LU[LDA * MOST], want[MOST], x[MOST];
        int pivot[MOST];
        fill(A, n, n);
        A[0] = 0; // needs an exchange of rows
        for (int j = 0; j < n; j++)
            A[n - 1 - j + LDA * j] += 3; // well conditioned
        memcpy(LU, A, sizeof A);
        assert_true(ct_lu(LU, pivot, n, LDA));
        for (int transpose = 0; transpose < 2; transpose++) {
            for (int i = 0; i < n; i++)
                want[i] = uniform();
            (transpose ? multiply_t : multiply)(x, A, want, n, n, LDA);
            ct_lu_solve(x, LU, pivot, n, LDA, 1, n, transpose);
            for (int i = 0; i < n; i++)
                check_close("x", x[i], want[i], close_enough);
        }
    }
    double singular[] = {1, 2, 2, 4};
    int pivot[2];
    assert_false(ct_lu(singular, pivot, 2, 2));
}

static void complex_lu_solves(void **unused)
{
    (void)unused;
    for (int n = 1; n <= MOST; n++) {
        double _Complex A[LDA * MOST], LU[LDA * MOST], want[MOST], x[MOST] = {0};
        int pivot[MOST];
        for (int i = 0; i < LDA * MOST; i++)
            A[i] = uniform() + uniform() * I;
        for (int j = 0; j < n; j++)
            A[n - 1 - j + LDA * j] += 3 + 2 * I; // well conditioned
        memcpy(LU, A, sizeof A);
        for (int j = 0; j < n; j++) {
            want[j] = uniform() + uniform() * I;
            for (int i = 0; i < n; i++)
                x[i] += A[i + LDA * j] * want[j];
        }
        assert_true(ct_lu_complex(LU, pivot, n, LDA));
        ct_lu_complex_solve(x, LU, pivot, n, LDA, 1, n);
        for (int i = 0; i < n; i++)
            check_close("|x - want|", cabs(x[i] - want[i]), 0, close_enough);
    }
    double _Complex singular[] = {1, I, I, -1};
    int pivot[2];
    assert_false(ct_lu_complex(singular, pivot, 2, 2));
}

// A (LDA x n, imaginary parts behind, too) as inverses take it.
static void widen(double *X, const double *A, int n)
{
    const int rows = ct_inverse_rows(n);
    memset(X, 0, (size_t)(rows * n) * sizeof *X);
    for (int j = 0; j < n; j++)
        memcpy(X + rows * j, A + LDA * j, (size_t)n * sizeof *A);
}

static void inverses_solve(void **unused)
{
    (void)unused;
    enum { N = CT_MOST_INVERTED };
    _Static_assert((int)N <= (int)MOST, "fill gives no more");
    for (int n = 1; n <= N; n++) {
        double A[LDA * MOST], X[N * N], want[MOST], b[MOST], x[N];
        int pivot[MOST];
        fill(A, n, n);
        A[0] = 0; // needs an exchange of rows
        for (int j = 0; j < n; j++)
            A[n - 1 - j + LDA * j] += 3; // well conditioned
        widen(X, A, n);
        assert_true(ct_inverse(X, pivot, n));
        for (int i = 0; i < n; i++)
            want[i] = uniform();
        multiply(b, A, want, n, n, LDA);
        ct_inverse_apply(x, X, b, n);
        for (int i = 0; i < ct_inverse_rows(n); i++)
            check_close("x", x[i], i < n ? want[i] : 0, close_enough);
    }
    double singular[8] = {1, 2, 0, 0, 2, 4}, no_number[4] = {NAN};
    int pivot[2];
    assert_false(ct_inverse(singular, pivot, 2));
    assert_false(ct_inverse(no_number, pivot, 1));
}

static void complex_inverses_solve(void **unused)
{
    (void)unused;
    enum { N = CT_MOST_INVERTED };
    _Static_assert((int)N <= (int)MOST, "fill gives no more");
    for (int n = 1; n <= N; n++) {
        const int rows = ct_inverse_rows(n);
        double A[LDA * MOST], B[LDA * MOST], X[2 * N * N], b[2 * MOST] = {0}, x[2 * N];
        double _Complex want[MOST];
        int pivot[MOST];
        fill(A, n, n);
        fill(B, n, n);
        for (int j = 0; j < n; j++)
            A[n - 1 - j + LDA * j] += 3; // well conditioned
        for (int j = 0; j < n; j++) {
            want[j] = uniform() + uniform() * I;
            for (int i = 0; i < n; i++) {
                const double _Complex part = (A[i + LDA * j] + B[i + LDA * j] * I) * want[j];
                b[i] += creal(part);
                b[i + n] += cimag(part);
            }
        }
        widen(X, A, n);
        widen(X + rows * n, B, n);
        assert_true(ct_inverse_complex(X, pivot, n));
        ct_inverse_apply_complex(x, X, b, n);
        for (int i = 0; i < n; i++) {
            check_close("real part", x[i], creal(want[i]), close_enough);
            check_close("imaginary part", x[i + rows], cimag(want[i]), close_enough);
        }
    }
    double singular[16] = {1, 0, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, 1, 0}; // [1 i; i -1]
    int pivot[2];
    assert_false(ct_inverse_complex(singular, pivot, 2));
}

// For any number of columns, and of rows by fours; each sum has its terms in their order, whatever
// the processor adds at once.
static void products_are_sums_in_order(void **unused)
{
    (void)unused;
    enum { ROWS = 28, COLUMNS = 13 };
    double A[ROWS * COLUMNS], b[COLUMNS], x[ROWS + 1];
    for (int i = 0; i < ROWS * COLUMNS; i++)
        A[i] = uniform();
    for (int i = 0; i < COLUMNS; i++)
        b[i] = uniform();
    for (int rows = 4; rows <= ROWS; rows += 4)
        for (int n = 0; n <= COLUMNS; n++) {
            x[rows] = 1;
            ct_matrix_vector(x, A, b, rows, n);
            for (int i = 0; i < rows; i++) {
                double sum = 0;
                for (int j = 0; j < n; j++)
                    sum += A[i + rows * j] * b[j];
                assert_true(x[i] == sum);
            }
            assert_true(x[rows] == 1);
        }
}

static void pivoted_qr_finds_rank_and_columns(void **unused)
{
    (void)unused;
    for (int m = 1; m <= MOST; m++)
        for (int n = 1; n <= MOST; n++)
            for (int rank = 0; rank <= (m < n ? m : n); rank++) {
                double A[LDA * MOST], Q[LDA * MOST], tau[MOST], work[WORK];
                int column[MOST], seen = 0;
                assert_true(ct_qr_pivot_work(m, n) <= WORK);
                fill_rank(A, m, n, rank);
                memcpy(Q, A, sizeof A);
                assert_int_equal(ct_qr_pivot(Q, column, tau, m, n, LDA, 1e-10, work), rank);
                for (int j = 0; j < n; j++)
                    seen |= 1 << column[j];
                assert_int_equal(seen, (1 << n) - 1);
                // Q is orthogonal: columns of A P and of R have equal inner products
                for (int j = 0; j < n; j++) {
                    const double *r = Q + LDA * j;
                    check_close("|R_j|", dot(r, r, j + 1 < m ? j + 1 : m),
                                dot(A + LDA * column[j], A + LDA * column[j], m),
                                close_enough * MOST);
                }
            }
}

// A' (b - A x) = 0 makes it least squares; x in the range of A' makes it the shortest.
static void check_least_squares(int m, int n, int rank)
{
    double A[LDA * MOST], F[LDA * MOST], T[LDA * MOST], b[MOST], x[MOST], r[MOST], work[WORK];
    int iwork[MOST];
    fill_rank(A, m, n, rank);
    memcpy(F, A, sizeof A);
    for (int i = 0; i < MOST; i++)
        x[i] = b[i] = i < m ? uniform() : NAN;
    assert_true(ct_lstsq_work(m, n) <= WORK);
    assert_int_equal(ct_lstsq(x, F, m, n, LDA, 1e-10, iwork, work), rank);

    double Ax[MOST], normal[MOST];
    multiply(Ax, A, x, m, n, LDA);
    for (int i = 0; i < m; i++)
        r[i] = b[i] - Ax[i];
    multiply_t(normal, A, r, m, n, LDA);
    double norm = 1;
    for (int j = 0; j < n; j++)
        norm += fabs(x[j]);
    for (int j = 0; j < n; j++)
        check_close("A' r", normal[j], 0, close_enough * norm);

    // A' z = x has a solution z: its residual vanishes
    for (int j = 0; j < n; j++)
        for (int i = 0; i < m; i++)
            T[j + LDA * i] = A[i + LDA * j];
    double z[MOST], back[MOST];
    memcpy(z, x, (size_t)n * sizeof *z);
    ct_lstsq(z, T, n, m, LDA, 1e-10, iwork, work);
    multiply_t(back, A, z, m, n, LDA);
    for (int j = 0; j < n; j++)
        check_close("x in range of A'", back[j], x[j], close_enough * norm);
}

static void least_squares_is_shortest_for_every_shape_and_rank(void **unused)
{
    (void)unused;
    for (int m = 1; m <= MOST; m++)
        for (int n = 1; n <= MOST; n++)
            for (int rank = 0; rank <= (m < n ? m : n); rank++)
                check_least_squares(m, n, rank);
}

static void empty_least_squares_gives_zero(void **unused)
{
    (void)unused;
    double b[] = {7, 7, 7}, work[WORK];
    int iwork[3];
    assert_int_equal(ct_lstsq(b, NULL, 0, 3, 0, 1e-10, iwork, work), 0);
    for (int i = 0; i < 3; i++)
        assert_true(b[i] == 0);
}

static void eigenvalues_of_a_chain_are_known(void **unused)
{
    (void)unused;
    enum { N = 9 };
    double A[N * N] = {0}, w[N], work[WORK];
    for (int i = 0; i < N; i++) {
        A[i + N * i] = 2;
        if (i + 1 < N)
            A[i + 1 + N * i] = -1;
    }
    assert_true(ct_symmetric_eigenvalues_work(N) <= WORK);
    assert_true(ct_symmetric_eigenvalues(w, A, N, N, work));
    const double pi = acos(-1);
    for (int i = 0; i < N; i++)
        check_close("eigenvalue", w[i], 2 - 2 * cos((i + 1) * pi / (N + 1)), close_enough);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cholesky_solves_definite_matrices),
        cmocka_unit_test(cholesky_refuses_indefinite_and_nonfinite),
        cmocka_unit_test(cholesky_stays_in_the_envelope),
        cmocka_unit_test(lu_solves_both_ways),
        cmocka_unit_test(complex_lu_solves),
        cmocka_unit_test(inverses_solve),
        cmocka_unit_test(complex_inverses_solve),
        cmocka_unit_test(products_are_sums_in_order),
        cmocka_unit_test(pivoted_qr_finds_rank_and_columns),
        cmocka_unit_test(least_squares_is_shortest_for_every_shape_and_rank),
        cmocka_unit_test(empty_least_squares_gives_zero),
        cmocka_unit_test(eigenvalues_of_a_chain_are_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
