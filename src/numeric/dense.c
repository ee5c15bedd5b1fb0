// Wrappers of LAPACK; see dense.h.
//
// LAPACK is called with the smallest workspace that it accepts. This selects its unblocked code,
// which is the faster one for the sizes that occur here (some tens of rows), and makes the size of
// the workspace a formula in place of a query. Minimum-norm least squares is built from the parts
// of a complete orthogonal decomposition (Golub and Van Loan (2013), 5.5, key golub2013) in place
// of dgelsy, so that its rank is decided exactly as in ct_qr_pivot.
//
// Cholesky and LU of real matrices, and LU of small complex matrices, are plain loops. They are
// called at every stage of a step. For small matrices they cost less than a call of LAPACK, the
// result does not depend on the BLAS or its threads, and NaN entries are rejected, which not every
// dpotrf does.
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

// Fortran passes the length of each character argument after all other arguments.
extern void zgetrf_(const int *m, const int *n, double _Complex *a, const int *lda, int *ipiv,
                    int *info);
extern void zgetrs_(const char *trans, const int *n, const int *nrhs, const double _Complex *a,
                    const int *lda, const int *ipiv, double _Complex *b, const int *ldb,
                    int *info, size_t);
extern void dgeqp3_(const int *m, const int *n, double *a, const int *lda, int *jpvt,
                    double *tau, double *work, const int *lwork, int *info);
extern void dormqr_(const char *side, const char *trans, const int *m, const int *n,
                    const int *k, const double *a, const int *lda, const double *tau, double *c,
                    const int *ldc, double *work, const int *lwork, int *info, size_t, size_t);
extern void dtzrzf_(const int *m, const int *n, double *a, const int *lda, double *tau,
                    double *work, const int *lwork, int *info);
extern void dormrz_(const char *side, const char *trans, const int *m, const int *n,
                    const int *k, const int *l, const double *a, const int *lda,
                    const double *tau, double *c, const int *ldc, double *work,
                    const int *lwork, int *info, size_t, size_t);
extern void dtrtrs_(const char *uplo, const char *trans, const char *diag, const int *n,
                    const int *nrhs, const double *a, const int *lda, double *b, const int *ldb,
                    int *info, size_t, size_t, size_t);
extern void dsygst_(const int *itype, const char *uplo, const int *n, double *a, const int *lda,
                    const double *b, const int *ldb, int *info, size_t);
extern void dpbtrf_(const char *uplo, const int *n, const int *kd, double *ab, const int *ldab,
                    int *info, size_t);
extern void dpbtrs_(const char *uplo, const int *n, const int *kd, const int *nrhs,
                    const double *ab, const int *ldab, double *b, const int *ldb, int *info,
                    size_t);
extern void dsygv_(const int *itype, const char *jobz, const char *uplo, const int *n,
                   double *a, const int *lda, double *b, const int *ldb, double *w,
                   double *work, const int *lwork, int *info, size_t, size_t);
extern void dsyev_(const char *jobz, const char *uplo, const int *n, double *a, const int *lda,
                   double *w, double *work, const int *lwork, int *info, size_t, size_t);
extern void dgeevx_(const char *balanc, const char *jobvl, const char *jobvr, const char *sense,
                    const int *n, double *a, const int *lda, double *wr, double *wi, double *vl,
                    const int *ldvl, double *vr, const int *ldvr, int *ilo, int *ihi,
                    double *scale, double *abnrm, double *rconde, double *rcondv, double *work,
                    const int *lwork, int *iwork, int *info, size_t, size_t, size_t, size_t);

static int min_int(int a, int b)
{
    return a < b ? a : b;
}

static int max_int(int a, int b)
{
    return a > b ? a : b;
}

double ct_vector_largest(const double *v, size_t n)
{
    double max = 0;
    for (size_t i = 0; i < n; i++)
        max = fmax(max, fabs(v[i]));
    return max;
}

double ct_vector_dot(const double *x, const double *y, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += x[i] * y[i];
    return sum;
}

void ct_vector_add(double *restrict y, double c, const double *restrict x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        y[i] += c * x[i];
}

void ct_matrix_multiply(double *restrict C, const double *restrict A, const double *restrict B,
                        int n, int m, int k)
{
    for (int j = 0; j < k; j++) {
        double *c = C + (size_t)n * (size_t)j;
        for (int i = 0; i < n; i++)
            c[i] = 0;
        for (int p = 0; p < m; p++) {
            const double *a = A + (size_t)n * (size_t)p, b = B[p + (size_t)m * (size_t)j];
            for (int i = 0; i < n && b != 0; i++)
                c[i] += a[i] * b;
        }
    }
}

void ct_matrix_multiply_transposed(double *restrict C, const double *restrict A,
                                   const double *restrict B, int n, int m, int k)
{
    for (int j = 0; j < k; j++)
        for (int i = 0; i < n; i++) {
            const double *a = A + (size_t)m * (size_t)i, *b = B + (size_t)m * (size_t)j;
            double sum = 0;
            for (int p = 0; p < m; p++)
                sum += a[p] * b[p];
            C[i + (size_t)n * (size_t)j] = sum;
        }
}

// Right-looking: column k is finished, then its contribution is subtracted from the later columns.
bool ct_cholesky(double *A, int n, int lda)
{
    for (int k = 0; k < n; k++) {
        double *col = A + (size_t)lda * k;
        if (!(col[k] > 0) || isinf(col[k])) // negated comparison: rejects NaN too
            return false;
        col[k] = sqrt(col[k]);
        for (int i = k + 1; i < n; i++)
            col[i] /= col[k];
        for (int j = k + 1; j < n; j++) {
            double *a = A + (size_t)lda * j;
            for (int i = j; i < n && col[j] != 0; i++)
                a[i] -= col[i] * col[j];
        }
    }
    return true;
}

void ct_cholesky_solve(double *x, const double *L, int n, int lda, int nrhs, int ldx)
{
    for (int c = 0; c < nrhs; c++, x += ldx) {
        for (int j = 0; j < n; j++) { // L z = b
            const double *l = L + (size_t)lda * j;
            x[j] /= l[j];
            for (int i = j + 1; i < n; i++)
                x[i] -= l[i] * x[j];
        }
        for (int j = n; j-- > 0;) { // L' x = z
            const double *l = L + (size_t)lda * j;
            for (int i = j + 1; i < n; i++)
                x[j] -= l[i] * x[i];
            x[j] /= l[j];
        }
    }
}

void ct_cholesky_solve_transposed(double *x, const double *L, int n, int lda)
{
    int info;
    const int one = 1, ldx = max_int(1, n);
    lda = max_int(1, lda);
    dtrtrs_("L", "T", "N", &n, &one, L, &lda, x, &ldx, &info, 1, 1, 1);
}

void ct_cholesky_congruence(double *H, const double *L, int n, int lda)
{
    int info;
    const int itype = 1, ldh = max_int(1, n);
    lda = max_int(1, lda);
    dsygst_(&itype, "L", &n, H, &ldh, L, &lda, &info, 1);
}

bool ct_band_cholesky(double *A, int n, int band)
{
    int info;
    const int lda = band + 1;
    dpbtrf_("L", &n, &band, A, &lda, &info, 1);
    return info == 0;
}

void ct_band_cholesky_solve(double *x, const double *L, int n, int band)
{
    int info;
    const int lda = band + 1, one = 1, ldx = max_int(1, n);
    dpbtrs_("L", &n, &band, &one, L, &lda, x, &ldx, &info, 1);
}

static int largest_below(const double *col, int k, int n)
{
    int p = k;
    for (int i = k + 1; i < n; i++)
        if (fabs(col[i]) > fabs(col[p]))
            p = i;
    return p;
}

static void swap_rows(double *A, int lda, int ncol, int i, int j)
{
    for (int c = 0; c < ncol && i != j; c++, A += lda) {
        const double a = A[i];
        A[i] = A[j];
        A[j] = a;
    }
}

// Right-looking, with partial pivoting: pivot[k] is the row that column k exchanged with row k.
bool ct_lu(double *A, int *pivot, int n, int lda)
{
    bool ok = true;
    for (int k = 0; k < n; k++) {
        double *restrict col = A + (size_t)lda * k;
        const int p = largest_below(col, k, n);
        pivot[k] = p;
        swap_rows(A, lda, n, k, p);
        ok = ok && fabs(col[k]) > 0 && isfinite(col[k]); // negated comparison: rejects NaN too
        const double inverse = 1 / col[k];
        for (int i = k + 1; i < n; i++)
            col[i] *= inverse;
        for (int j = k + 1; j < n; j++) {
            double *restrict a = A + (size_t)lda * j;
            const double f = a[k];
            if (f == 0) // rows of independent loops
                continue;
            for (int i = k + 1; i < n; i++)
                a[i] -= f * col[i];
        }
    }
    return ok;
}

// Definition: systems of at most this many rows have code with all loops unrolled, which gives the
// same numbers; the cases of lu_solve.
enum { FEW = 4 };

static inline void substitute(double *x, const double *LU, const int *pivot, const int n,
                              int lda)
{
    for (int k = 0; k < n; k++) {
        const double f = x[pivot[k]];
        x[pivot[k]] = x[k];
        x[k] = f;
    }
    for (int k = 0; k < n; k++) { // L z = b
        const double *l = LU + (size_t)lda * k;
        for (int i = k + 1; i < n && (n <= FEW || x[k] != 0); i++)
            x[i] -= l[i] * x[k];
    }
    for (int k = n; k-- > 0;) { // U x = z
        const double *u = LU + (size_t)lda * k;
        x[k] /= u[k];
        for (int i = 0; i < k && (n <= FEW || x[k] != 0); i++)
            x[i] -= u[i] * x[k];
    }
}

static void lu_solve(double *x, const double *LU, const int *pivot, int n, int lda)
{
    switch (n) {
    case 1:
        x[0] /= LU[0];
        return;
    case 2:
        substitute(x, LU, pivot, 2, lda);
        return;
    case 3:
        substitute(x, LU, pivot, 3, lda);
        return;
    case FEW:
        substitute(x, LU, pivot, FEW, lda);
        return;
    default:
        substitute(x, LU, pivot, n, lda);
    }
}

static void lu_solve_transposed(double *x, const double *LU, const int *pivot, int n, int lda)
{
    for (int k = 0; k < n; k++) { // U' z = b
        const double *u = LU + (size_t)lda * k;
        for (int i = 0; i < k; i++)
            x[k] -= u[i] * x[i];
        x[k] /= u[k];
    }
    for (int k = n; k-- > 0;) { // L' x = z
        const double *l = LU + (size_t)lda * k;
        for (int i = k + 1; i < n; i++)
            x[k] -= l[i] * x[i];
    }
    for (int k = n; k-- > 0;) {
        const double f = x[pivot[k]];
        x[pivot[k]] = x[k];
        x[k] = f;
    }
}

void ct_lu_solve(double *x, const double *LU, const int *pivot, int n, int lda, int nrhs,
                 int ldx, bool transpose)
{
    for (int c = 0; c < nrhs; c++, x += ldx)
        (transpose ? lu_solve_transposed : lu_solve)(x, LU, pivot, n, lda);
}

// x - y z and x / y without the treatment of infinities that turns them into library calls.
static inline double _Complex less_product(double _Complex x, double _Complex y,
                                           double _Complex z)
{
    const double a = creal(y), b = cimag(y), c = creal(z), d = cimag(z);
    return CMPLX(creal(x) - (a * c - b * d), cimag(x) - (a * d + b * c));
}

static inline double _Complex quotient(double _Complex x, double _Complex y)
{
    const double a = creal(x), b = cimag(x), c = creal(y), d = cimag(y);
    const double inverse = 1 / (c * c + d * d);
    return CMPLX((a * c + b * d) * inverse, (b * c - a * d) * inverse);
}

static inline double size_of(double _Complex x)
{
    return fabs(creal(x)) + fabs(cimag(x));
}

static inline void exchange(double _Complex *x, double _Complex *y)
{
    const double _Complex z = *x;
    *x = *y;
    *y = z;
}

// LU of few rows, as in ct_lu; pivots are counted from 1 as in LAPACK.
static bool lu_complex_few(double _Complex *A, int *pivot, int n, int lda)
{
    bool ok = true;
    for (int k = 0; k < n; k++) {
        double _Complex *col = A + (size_t)lda * k;
        int p = k;
        for (int i = k + 1; i < n; i++)
            p = size_of(col[i]) > size_of(col[p]) ? i : p;
        pivot[k] = p + 1;
        for (int j = 0; j < n && p != k; j++)
            exchange(A + (size_t)lda * j + k, A + (size_t)lda * j + p);
        ok = ok && size_of(col[k]) > 0 && isfinite(size_of(col[k]));
        for (int i = k + 1; i < n; i++)
            col[i] = quotient(col[i], col[k]);
        for (int j = k + 1; j < n; j++) {
            double _Complex *a = A + (size_t)lda * j;
            for (int i = k + 1; i < n; i++)
                a[i] = less_product(a[i], col[i], a[k]);
        }
    }
    return ok;
}

static inline void substitute_complex(double _Complex *x, const double _Complex *LU,
                                      const int *pivot, const int n, int lda)
{
    for (int k = 0; k < n; k++)
        exchange(x + k, x + pivot[k] - 1);
    for (int k = 0; k < n; k++) {
        const double _Complex *l = LU + (size_t)lda * k;
        for (int i = k + 1; i < n; i++)
            x[i] = less_product(x[i], l[i], x[k]);
    }
    for (int k = n; k-- > 0;) {
        const double _Complex *u = LU + (size_t)lda * k;
        x[k] = quotient(x[k], u[k]);
        for (int i = 0; i < k; i++)
            x[i] = less_product(x[i], u[i], x[k]);
    }
}

static void lu_complex_solve_few(double _Complex *x, const double _Complex *LU,
                                 const int *pivot, int n, int lda)
{
    switch (n) {
    case 1:
        x[0] = quotient(x[0], LU[0]);
        return;
    case 2:
        substitute_complex(x, LU, pivot, 2, lda);
        return;
    case 3:
        substitute_complex(x, LU, pivot, 3, lda);
        return;
    default:
        substitute_complex(x, LU, pivot, n, lda);
    }
}

bool ct_lu_complex(double _Complex *A, int *pivot, int n, int lda)
{
    int info;
    if (n <= FEW)
        return lu_complex_few(A, pivot, n, lda);
    lda = max_int(1, lda);
    zgetrf_(&n, &n, A, &lda, pivot, &info);
    return info == 0;
}

void ct_lu_complex_solve(double _Complex *x, const double _Complex *LU, const int *pivot, int n,
                         int lda, int nrhs, int ldx)
{
    int info;
    if (n <= FEW) {
        for (int c = 0; c < nrhs; c++, x += ldx)
            lu_complex_solve_few(x, LU, pivot, n, lda);
        return;
    }
    lda = max_int(1, lda);
    ldx = max_int(1, ldx);
    zgetrs_("N", &n, &nrhs, LU, &lda, pivot, x, &ldx, &info, 1);
}

// Number of diagonal entries of R above tol |R_00|; pivoting has sorted them in descending order.
static int count_rank(const double *R, int m, int n, int lda, double tol)
{
    int rank = 0;
    const int k = min_int(m, n);
    while (rank < k && fabs(R[rank + (size_t)lda * rank]) > tol * fabs(R[0]))
        rank++;
    return rank;
}

int ct_qr_pivot(double *A, int *column, double *tau, int m, int n, int lda, double tol,
                double *work)
{
    int info;
    const int lwork = (int)ct_qr_pivot_work(m, n);
    lda = max_int(1, lda);
    memset(column, 0, (size_t)n * sizeof *column); // 0: the column may be moved
    if (m == 0 || n == 0) {                        // LAPACK would not number the columns
        for (int j = 0; j < n; j++)
            column[j] = j;
        return 0;
    }
    dgeqp3_(&m, &n, A, &lda, column, tau, work, &lwork, &info);
    for (int j = 0; j < n; j++)
        column[j]--; // Fortran counts from 1
    return count_rank(A, m, n, lda, tol);
}

size_t ct_qr_pivot_work(int m, int n)
{
    (void)m;
    return 3 * (size_t)n + 1;
}

// b (n, in: first `rank` entries, out: all) = Z' [ T^-1 b ; 0 ] for the trapezoidal top
// [ R11 R12 ] = [ T 0 ] Z of A: the shortest vector that R11 and R12 map to b.
static void solve_trapezoid(double *b, double *A, int rank, int n, int lda, double *tau,
                            double *work, int lwork)
{
    int info;
    const int one = 1, rest = n - rank;
    if (rest > 0)
        dtzrzf_(&rank, &n, A, &lda, tau, work, &lwork, &info);
    dtrtrs_("U", "N", "N", &rank, &one, A, &lda, b, &n, &info, 1, 1, 1);
    memset(b + rank, 0, (size_t)rest * sizeof *b);
    if (rest > 0)
        dormrz_("L", "T", &n, &one, &rank, &rest, A, &lda, tau, b, &n, work, &lwork, &info, 1,
                1);
}

int ct_lstsq(double *b, double *A, int m, int n, int lda, double tol, int *iwork, double *work)
{
    return ct_lstsq_of_rank(b, A, m, n, lda, tol, min_int(m, n), iwork, work);
}

int ct_lstsq_of_rank(double *b, double *A, int m, int n, int lda, double tol, int most,
                     int *iwork, double *work)
{
    int info;
    const int k = min_int(m, n), one = 1, lwork = (int)ct_qr_pivot_work(m, n);
    double *tau = work, *x = tau + k, *rest = x + n;
    lda = max_int(1, lda);
    const int rank = min_int(ct_qr_pivot(A, iwork, tau, m, n, lda, tol, rest), most);
    if (rank == 0) {
        memset(b, 0, (size_t)n * sizeof *b);
        return 0;
    }
    dormqr_("L", "T", &m, &one, &k, A, &lda, tau, b, &m, rest, &lwork, &info, 1, 1);
    solve_trapezoid(b, A, rank, n, lda, tau, rest, lwork);
    for (int j = 0; j < n; j++)
        x[iwork[j]] = b[j];
    memcpy(b, x, (size_t)n * sizeof *b);
    return rank;
}

size_t ct_lstsq_work(int m, int n)
{
    return (size_t)min_int(m, n) + (size_t)n
         + ct_qr_pivot_work(m, n); // tau, x, workspace of LAPACK
}

bool ct_pencil_eigen(double *w, double *A, double *B, int n, int lda, double *work)
{
    int info;
    const int itype = 1, lwork = (int)ct_pencil_eigen_work(n);
    lda = max_int(1, lda);
    dsygv_(&itype, "V", "L", &n, A, &lda, B, &lda, w, work, &lwork, &info, 1, 1);
    return info == 0;
}

size_t ct_pencil_eigen_work(int n)
{
    return (size_t)max_int(1, 3 * n - 1);
}

bool ct_symmetric_eigenvalues(double *w, double *A, int n, int lda, double *work)
{
    int info;
    const int lwork = (int)ct_symmetric_eigenvalues_work(n);
    lda = max_int(1, lda);
    dsyev_("N", "L", &n, A, &lda, w, work, &lwork, &info, 1, 1);
    return info == 0;
}

size_t ct_symmetric_eigenvalues_work(int n)
{
    return (size_t)max_int(1, 3 * n - 1);
}

bool ct_symmetric_eigen(double *w, double *A, int n, int lda, double *work)
{
    int info;
    const int lwork = (int)ct_symmetric_eigenvalues_work(n);
    lda = max_int(1, lda);
    dsyev_("V", "L", &n, A, &lda, w, work, &lwork, &info, 1, 1);
    return info == 0;
}

bool ct_eigen(double *re, double *im, double *V, double *A, int n, int lda, double *work)
{
    int info, low, high;
    const int lwork = max_int(1, 4 * n), ldv = max_int(1, n), one = 1;
    double *scale = work, *condition = scale + n, *rest = condition + 2 * (size_t)n, norm;
    lda = max_int(1, lda);
    dgeevx_("B", "N", "V", "N", &n, A, &lda, re, im, NULL, &one, V, &ldv, &low, &high, scale,
            &norm, condition, condition + n, rest, &lwork, NULL, &info, 1, 1, 1, 1);
    return info == 0;
}

size_t ct_eigen_work(int n)
{
    return 7 * (size_t)n + 1; // scale, condition numbers (not requested), workspace of LAPACK
}
