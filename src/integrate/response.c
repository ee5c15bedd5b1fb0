// See response.h.
#include "integrate/response.h"

#include <string.h>

struct ct_response *ct_response_create(struct ct_arena *a, int nu, int most_rows,
                                       bool is_complex)
{
    enum { MOST = CT_MOST_INVERTED };
    struct ct_response *s = CT_NEW(a, struct ct_response);
    const int in = nu + 2 * most_rows < MOST ? nu + 2 * most_rows : MOST;
    const int size = ct_response_padded(2 * nu + most_rows) * in;
    s->nu = nu;
    double **const square[] = {&s->MQ, &s->CQ, &s->MD, &s->KD, &s->Q, &s->PD};
    for (size_t i = 0; i < COUNT(square); i++)
        *square[i] = CT_NEWN(a, double, nu *nu);
    double **const wide[] = {&s->MP, &s->CP, &s->P, &s->J};
    for (size_t i = 0; i < COUNT(wide); i++)
        *wide[i] = CT_NEWN(a, double, nu *most_rows + 1);
    s->real = CT_NEWN(a, double, size);
    if (is_complex) {
        s->re = CT_NEWN(a, double, size);
        s->im = CT_NEWN(a, double, size);
    }
    s->A = CT_NEWN(a, double, 2 * MOST * MOST);
    s->E = CT_NEWN(a, double, 2 * nu * most_rows + 1);
    s->square = CT_NEWN(a, double, MOST *MOST);
    s->pivot = CT_NEWN(a, int, MOST);
    return s;
}

// ---- of derivatives -------------------------------------------------------------------------------

// A (n x k, out) = B C, B (n x l), C (l x k).
static inline void multiply(double *restrict A, const double *restrict B,
                            const double *restrict C, int n, int l, int k)
{
    for (int j = 0; j < k; j++)
        for (int i = 0; i < n; i++) {
            double sum = 0;
            for (int p = 0; p < l; p++)
                sum += B[i + n * p] * C[p + l * j];
            A[i + n * j] = sum;
        }
}

// P = J' (J J')^-1.
static bool find_inverse_of_rows(struct ct_response *s, const double *J)
{
    const int nu = s->nu, m = s->m, rows = ct_inverse_rows(m);
    double *A = s->square;
    memset(A, 0, (size_t)(rows * m) * sizeof *A);
    for (int k = 0; k < nu; k++)
        for (int j = 0; j < m; j++)
            for (int i = 0; i < m; i++)
                A[i + rows * j] += J[i + m * k] * J[j + m * k];
    if (!ct_inverse(A, s->pivot, m))
        return false;
    for (int i = 0; i < m; i++)
        for (int k = 0; k < nu; k++) {
            double sum = 0;
            for (int j = 0; j < m; j++)
                sum += J[j + m * k] * A[j + rows * i];
            s->P[k + nu * i] = sum;
        }
    return true;
}

void ct_response_set_rows(struct ct_response *s, int m)
{
    s->m = m;
    s->in = s->nu + 2 * m;
    s->out = 2 * s->nu + m;
    s->rows = ct_response_padded(s->out);
}

void ct_response_assemble(struct ct_response *s, const double *M, const double *C,
                          const double *K, const double *J, const double *D)
{
    const int nu = s->nu, m = s->m;
    s->is_regular = find_inverse_of_rows(s, J);
    memcpy(s->J, J, (size_t)(nu * m) * sizeof *J);
    multiply(s->PD, s->P, D, nu, m, nu);
    multiply(s->Q, s->P, J, nu, m, nu);
    for (int k = 0; k < nu * nu; k++)
        s->Q[k] = (k % (nu + 1) == 0 ? 1 : 0) - s->Q[k];
    multiply(s->MQ, M, s->Q, nu, nu, nu);
    multiply(s->CQ, C, s->Q, nu, nu, nu);
    multiply(s->MD, M, s->PD, nu, nu, nu);
    multiply(s->KD, C, s->PD, nu, nu, nu);
    for (int k = 0; k < nu * nu; k++) {
        s->MD[k] = -s->MD[k];
        s->KD[k] = K[k] - s->KD[k];
    }
    multiply(s->MP, M, s->P, nu, nu, m);
    multiply(s->CP, C, s->P, nu, nu, m);
}

// ---- of c and e -----------------------------------------------------------------------------------

// The rows of (8.2b) that do not depend on c and e, n = nu + m, columns `rows` apart.
static void fill_border(const struct ct_response *s, double *A, int rows)
{
    const int nu = s->nu, m = s->m;
    for (int k = 0; k < nu; k++)
        for (int i = 0; i < m; i++) {
            A[nu + i + rows * k] = s->J[i + m * k];
            A[k + rows * (nu + i)] = -s->J[i + m * k];
        }
}

// Column j (n) of the solution of (8.2b): of r, phi and v in turn.
static inline void solve_column(double *restrict x, const struct ct_response *s, int j,
                                double y, const int nu, const int n)
{
    const int rows = ct_inverse_rows(n);
    const double *X = s->A + rows * j, *push = s->E + nu * (j - n);
    const double scale = j < nu ? -y : -1;
    for (int k = 0; k < n && j < n; k++)
        x[k] = scale * X[k];
    for (int k = 0; k < n && j >= n; k++) {
        double sum = 0;
        for (int l = 0; l < nu; l++)
            sum += s->A[k + rows * l] * push[l];
        x[k] = sum;
    }
}

// d, the change of speeds and lam from it.
static inline void spread_column(const struct ct_response *s, int j, const double *restrict x,
                                 double c, double e, const int nu, const int n)
{
    double *d = s->real + s->rows * j, *u = d + nu, *lam = u + nu;
    const double *P = s->P + nu * (j - n);
    for (int k = 0; k < nu; k++) {
        double sum = j < n ? 0 : -P[k];
        for (int l = 0; l < nu; l++)
            sum += (c * s->Q[k + nu * l] - s->PD[k + nu * l]) * x[l];
        d[k] = x[k];
        u[k] = sum;
    }
    for (int i = nu; i < n; i++)
        lam[i - nu] = e * x[i];
    for (int i = s->out; i < s->rows; i++)
        d[i] = 0;
}

bool ct_response_find(struct ct_response *s, double c, double e)
{
    const int nu = s->nu, m = s->m, n = nu + m, rows = ct_inverse_rows(n);
    const double x = c / e, y = 1 / e, z = 1 / c;
    double *A = s->A, column[CT_MOST_INVERTED];
    memset(A, 0, (size_t)(rows * n) * sizeof *A);
    for (int j = 0; j < nu; j++)
        for (int k = 0, i = nu * j; k < nu; k++, i++)
            A[k + rows * j] = s->MQ[i] + x * s->CQ[i] + y * s->KD[i] + z * s->MD[i];
    fill_border(s, A, rows);
    if (!s->is_regular || !ct_inverse(A, s->pivot, n))
        return false;
    for (int i = 0; i < nu * m; i++)
        s->E[i] = z * s->MP[i] + y * s->CP[i];
    for (int j = 0; j < s->in; j++) {
        solve_column(column, s, j, y, nu, n);
        spread_column(s, j, column, c, e, nu, n);
    }
    return true;
}

// ---- the same of complex numbers --------------------------------------------------------------------

// x y without the care for infinite parts that makes it a call.
static inline double _Complex product(double _Complex x, double _Complex y)
{
    return CMPLX(creal(x) * creal(y) - cimag(x) * cimag(y),
                 creal(x) * cimag(y) + cimag(x) * creal(y));
}

static inline void solve_column_complex(double _Complex *restrict x,
                                        const struct ct_response *s, int j, double _Complex y,
                                        const int nu, const int n)
{
    const int rows = ct_inverse_rows(n), apart = rows * n;
    const double *X = s->A + rows * j, *push = s->E + nu * (j - n);
    const double _Complex scale = j < nu ? -y : -1;
    for (int k = 0; k < n && j < n; k++)
        x[k] = product(scale, CMPLX(X[k], X[k + apart]));
    for (int k = 0; k < n && j >= n; k++) {
        const double *re = s->A + k, *im = re + apart;
        double real = 0, imaginary = 0;
        for (int l = 0; l < nu; l++, re += rows, im += rows) {
            const double a = push[l], b = push[l + nu * s->m];
            real += *re * a - *im * b;
            imaginary += *re * b + *im * a;
        }
        x[k] = CMPLX(real, imaginary);
    }
}

static inline void spread_column_complex(const struct ct_response *s, int j,
                                         const double _Complex *restrict x, double _Complex c,
                                         double _Complex e, const int nu, const int n)
{
    double *re = s->re + s->rows * j, *im = s->im + s->rows * j;
    const double *P = s->P + nu * (j - n);
    for (int k = 0; k < nu; k++) {
        double real = j < n ? 0 : -P[k], imaginary = 0;
        for (int l = 0; l < nu; l++) {
            const double a = creal(c) * s->Q[k + nu * l] - s->PD[k + nu * l],
                         b = cimag(c) * s->Q[k + nu * l];
            real += a * creal(x[l]) - b * cimag(x[l]);
            imaginary += a * cimag(x[l]) + b * creal(x[l]);
        }
        re[k] = creal(x[k]);
        im[k] = cimag(x[k]);
        re[nu + k] = real;
        im[nu + k] = imaginary;
    }
    for (int i = nu; i < n; i++) {
        const double _Complex lam = product(e, x[i]);
        re[nu + i] = creal(lam);
        im[nu + i] = cimag(lam);
    }
    for (int i = s->out; i < s->rows; i++)
        re[i] = im[i] = 0;
}

bool ct_response_find_complex(struct ct_response *s, double _Complex c)
{
    const int nu = s->nu, m = s->m, n = nu + m, rows = ct_inverse_rows(n), apart = rows * n;
    const double _Complex z = 1 / c, y = product(z, z), e = product(c, c);
    double *A = s->A;
    double _Complex column[CT_MOST_INVERTED];
    memset(A, 0, (size_t)(2 * apart) * sizeof *A);
    for (int j = 0; j < nu; j++)
        for (int k = 0, i = nu * j; k < nu; k++, i++) {
            const double by_z = s->CQ[i] + s->MD[i];
            A[k + rows * j] = s->MQ[i] + creal(z) * by_z + creal(y) * s->KD[i];
            A[k + rows * j + apart] = cimag(z) * by_z + cimag(y) * s->KD[i];
        }
    fill_border(s, A, rows);
    if (!s->is_regular || !ct_inverse_complex(A, s->pivot, n))
        return false;
    for (int i = 0; i < nu * m; i++) {
        s->E[i] = creal(z) * s->MP[i] + creal(y) * s->CP[i];
        s->E[i + nu * m] = cimag(z) * s->MP[i] + cimag(y) * s->CP[i];
    }
    for (int j = 0; j < s->in; j++) {
        solve_column_complex(column, s, j, y, nu, n);
        spread_column_complex(s, j, column, c, e, nu, n);
    }
    return true;
}
