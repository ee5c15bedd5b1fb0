// See response.h.
#include "integrate/response.h"

#include "numeric/dense.h"
#include "numeric/four.h"

#include <math.h>
#include <string.h>

enum { MOST = CT_MOST_INVERTED };

struct ct_response *ct_response_create(struct ct_arena *a, int nu, int most_rows,
                                       bool is_complex)
{
    struct ct_response *s = CT_NEW(a, struct ct_response);
    const int in = nu + 2 * most_rows < MOST ? nu + 2 * most_rows : MOST;
    const int size = ct_response_padded(2 * nu + most_rows) * in;
    s->nu = nu;
    double **const square[] = {&s->T, &s->M, &s->C, &s->K, &s->MD, &s->PD};
    for (size_t i = 0; i < COUNT(square); i++)
        *square[i] = CT_NEWN(a, double, nu *nu);
    s->D = CT_NEWN(a, double, most_rows *nu + 1);
    s->real = CT_NEWN(a, double, size);
    s->G = CT_NEWN(a, double, nu *nu);
    s->F = CT_NEWN(a, double, nu *most_rows + 1);
    s->R = CT_NEWN(a, double, MOST *MOST);
    if (is_complex) {
        s->Gc = CT_NEWN(a, double _Complex, nu *nu);
        s->Fc = CT_NEWN(a, double _Complex, nu *most_rows + 1);
        s->Rc = CT_NEWN(a, double _Complex, MOST *MOST);
        s->straight = ct_arena_line(a, (size_t)(CT_FOUR * size) * sizeof(double));
        s->crossed = ct_arena_line(a, (size_t)(CT_FOUR * size) * sizeof(double));
    }
    return s;
}

void ct_response_set_rows(struct ct_response *s, int m)
{
    s->m = m;
    s->free = s->nu - m;
    s->in = s->nu + 2 * m;
    s->out = 2 * s->nu + m;
    s->rows = ct_response_padded(s->out);
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

// A (n x k, out) = B' C, B (l x n), C (l x k).
static inline void multiply_transposed(double *restrict A, const double *restrict B,
                                       const double *restrict C, int n, int l, int k)
{
    for (int j = 0; j < k; j++)
        for (int i = 0; i < n; i++) {
            double sum = 0;
            for (int p = 0; p < l; p++)
                sum += B[p + l * i] * C[p + l * j];
            A[i + n * j] = sum;
        }
}

// A (n) less 2 v v' A / v' v for columns of A (n x k), of which the part behind `first` counts.
static inline void reflect(double *A, const double *v, double scale, int first, int n, int k)
{
    for (int j = 0; j < k; j++, A += n) {
        double sum = 0;
        for (int i = first; i < n; i++)
            sum += v[i] * A[i];
        for (int i = first; i < n; i++)
            A[i] -= scale * sum * v[i];
    }
}

// T = [Z P] from J' = Q R by Householder's reflections: Z is the rest of Q, and P = Q_1 R'^-1.
static inline bool find_basis(struct ct_response *s, const double *J, const int nu, const int m)
{
    const int free = nu - m;
    double A[MOST * MOST], scale[MOST], R[MOST]; // J', below the diagonal its reflections
    for (int i = 0; i < m; i++)
        for (int k = 0; k < nu; k++)
            A[k + nu * i] = J[i + m * k];
    for (int i = 0; i < m; i++) {
        double *v = A + nu * i, square = 0;
        for (int k = i; k < nu; k++)
            square += v[k] * v[k];
        const double norm = copysign(sqrt(square), v[i]);
        if (!(square > 0) || !isfinite(square))
            return false;
        R[i] = -norm;
        scale[i] = 1 / (square + norm * v[i]);
        v[i] += norm;
        reflect(v + nu, v, scale[i], i, nu, m - i - 1);
    }
    memset(s->T, 0, (size_t)(nu * nu) * sizeof *s->T);
    for (int k = 0; k < nu; k++) // the columns of Q_2, then those of Q_1
        s->T[(k < free ? m + k : k - free) + nu * k] = 1;
    for (int i = m; i-- > 0;)
        reflect(s->T, A + nu * i, scale[i], i, nu, nu);
    double *P = s->T + nu * free; // P R' = Q_1, from the last column on
    for (int i = m; i-- > 0;)
        for (int k = 0; k < nu; k++) {
            double sum = P[k + nu * i];
            for (int j = i + 1; j < m; j++)
                sum -= P[k + nu * j] * A[i + nu * j];
            P[k + nu * i] = sum / R[i];
        }
    return true;
}

static inline void assemble(struct ct_response *s, const double *M, const double *C,
                            const double *K, const double *J, const double *D, const int nu,
                            const int m)
{
    double X[MOST * MOST];
    s->is_regular = find_basis(s, J, nu, m);
    if (!s->is_regular)
        return;
    const double *const from[] = {M, C, K};
    double *const to[] = {s->M, s->C, s->K};
    for (size_t i = 0; i < COUNT(from); i++) {
        multiply(X, from[i], s->T, nu, nu, nu);
        multiply_transposed(to[i], s->T, X, nu, nu, nu);
    }
    const int of_P = nu * (nu - m);
    multiply(s->D, D, s->T, m, nu, nu);
    multiply(s->MD, s->M + of_P, s->D, nu, m, nu);
    multiply(s->PD, s->T + of_P, s->D, nu, m, nu);
    multiply(X, s->C + of_P, s->D, nu, m, nu);
    for (int k = 0; k < nu * nu; k++)
        s->K[k] -= X[k];
}

// Planar loops of three coordinates have code of their own: its loops are known to be so long.
void ct_response_assemble(struct ct_response *s, const double *M, const double *C,
                          const double *K, const double *J, const double *D)
{
    if (s->nu == 3 && s->m == 2)
        assemble(s, M, C, K, J, D, 3, 2);
    else
        assemble(s, M, C, K, J, D, s->nu, s->m);
}

// ---- of c and e -----------------------------------------------------------------------------------

// T' B T (nu x nu) into G, T' F (nu x m) into F.
static inline void fill(const struct ct_response *s, double *G, double *F, double x, double y,
                        double z, const int nu, const int free)
{
    const int across = nu * free;
    for (int k = 0; k < across; k++)
        G[k] = s->M[k] + x * s->C[k] + (y * s->K[k] - z * s->MD[k]);
    for (int k = across; k < nu * nu; k++)
        G[k] = y * s->K[k] - z * s->MD[k];
    for (int k = across; k < nu * nu; k++)
        F[k - across] = z * s->M[k] + y * s->C[k];
}

// R (free x free, rows apart, out) = (Z' B Z)^-1.
static inline bool invert(double *R, const double *G, int free, int nu)
{
    int pivot[MOST];
    const int rows = ct_inverse_rows(free);
    if (free == 1) {
        R[0] = 1 / G[0];
        return isfinite(R[0]);
    }
    memset(R, 0, (size_t)(rows * free) * sizeof *R);
    for (int j = 0; j < free; j++)
        for (int k = 0; k < free; k++)
            R[k + rows * j] = G[k + nu * j];
    return ct_inverse(R, pivot, free);
}

struct coefficients {
    double c, e, y;
};

// Column j of the product: what r, phi, v give in turn.
static inline void find_column(const struct ct_response *s, int j, struct coefficients f,
                               const double *G, const double *F, const double *R, const int nu,
                               const int m)
{
    const int free = nu - m, n = nu + m, i = j < nu ? 0 : (j - nu) % m,
              rows = ct_inverse_rows(free);
    const double *T = s->T, *P = T + nu * (free + i), *push = F + nu * i;
    const double *g = G + nu * (free + i), *PDP = s->PD + nu * (free + i);
    double w[MOST], *d = s->real + s->rows * j, *u = d + nu, *lam = u + nu;
    for (int k = 0; k < free; k++) {
        w[k] = 0;
        for (int l = 0; l < free; l++)
            w[k] += R[k + rows * l] * (j < nu ? -f.y * T[j + nu * l] : j < n ? g[l] : push[l]);
    }
    for (int k = 0; k < nu; k++) {
        double moved = j >= nu && j < n ? -P[k] : 0;
        double gained = j < nu ? 0 : j < n ? PDP[k] : -P[k];
        for (int l = 0; l < free; l++) {
            moved += T[k + nu * l] * w[l];
            gained += (f.c * T[k + nu * l] - s->PD[k + nu * l]) * w[l];
        }
        d[k] = moved;
        u[k] = gained;
    }
    for (int k = 0; k < m; k++) {
        double sum = j < nu ? f.y * T[j + nu * (free + k)]
                   : j < n  ? -g[free + k]
                            : -push[free + k];
        for (int l = 0; l < free; l++)
            sum += G[free + k + nu * l] * w[l];
        lam[k] = f.e * sum;
    }
    for (int k = s->out; k < s->rows; k++)
        d[k] = 0;
}

static inline bool find(const struct ct_response *s, double c, double e, const int nu,
                        const int m)
{
    const struct coefficients f = {c, e, 1 / e};
    double *G = s->G, *F = s->F, *R = s->R;
    if (!s->is_regular)
        return false;
    fill(s, G, F, c / e, 1 / e, 1 / c, nu, nu - m);
    if (!invert(R, G, nu - m, nu))
        return false;
    for (int j = 0; j < nu; j++)
        find_column(s, j, f, G, F, R, nu, m);
    for (int j = nu; j < nu + 2 * m; j++)
        find_column(s, j, f, G, F, R, nu, m);
    return true;
}

bool ct_response_find(struct ct_response *s, double c, double e)
{
    return s->nu == 3 && s->m == 2 ? find(s, c, e, 3, 2) : find(s, c, e, s->nu, s->m);
}

// ---- the same of complex numbers --------------------------------------------------------------------

// x y without the care for infinite parts that makes it a call.
static inline double _Complex product(double _Complex x, double _Complex y)
{
    return CMPLX(creal(x) * creal(y) - cimag(x) * cimag(y),
                 creal(x) * cimag(y) + cimag(x) * creal(y));
}

static inline void fill_complex(const struct ct_response *s, double _Complex *G,
                                double _Complex *F, double _Complex y, double _Complex z,
                                const int nu, const int free)
{
    const int across = nu * free;
    for (int k = 0; k < across; k++)
        G[k] = s->M[k] + z * s->C[k] + (y * s->K[k] - z * s->MD[k]);
    for (int k = across; k < nu * nu; k++)
        G[k] = y * s->K[k] - z * s->MD[k];
    for (int k = across; k < nu * nu; k++)
        F[k - across] = z * s->M[k] + y * s->C[k];
}

static inline bool invert_complex(double _Complex *R, const double _Complex *G, int free,
                                  int nu)
{
    double A[2 * MOST * MOST];
    int pivot[MOST];
    const int rows = ct_inverse_rows(free), apart = rows * free;
    if (free == 1) {
        const double a = creal(G[0]), b = cimag(G[0]), square = a * a + b * b;
        R[0] = CMPLX(a / square, -b / square);
        return square > 0 && isfinite(square);
    }
    memset(A, 0, (size_t)(2 * apart) * sizeof *A);
    for (int j = 0; j < free; j++)
        for (int k = 0; k < free; k++) {
            A[k + rows * j] = creal(G[k + nu * j]);
            A[k + rows * j + apart] = cimag(G[k + nu * j]);
        }
    const bool ok = ct_inverse_complex(A, pivot, free);
    for (int k = 0; k < apart; k++)
        R[k] = CMPLX(A[k], A[k + apart]);
    return ok;
}

struct complex_coefficients {
    double _Complex c, e, y;
};

// Number k of a column into fours.
static inline void put(double *straight, double *crossed, const double *real, int k,
                       double _Complex x)
{
    double *a = straight + CT_FOUR * k, *b = crossed + CT_FOUR * k;
    a[0] = real[k];
    a[1] = a[2] = creal(x);
    a[3] = 0;
    b[0] = b[3] = 0;
    b[1] = -cimag(x);
    b[2] = cimag(x);
}

static inline void find_column_complex(const struct ct_response *s, int j,
                                       struct complex_coefficients f, const double _Complex *G,
                                       const double _Complex *F, const double _Complex *R,
                                       const int nu, const int m)
{
    const int free = nu - m, n = nu + m, i = j < nu ? 0 : (j - nu) % m,
              rows = ct_inverse_rows(free);
    const double *T = s->T, *P = T + nu * (free + i), *PDP = s->PD + nu * (free + i);
    const double _Complex *g = G + nu * (free + i), *push = F + nu * i;
    double _Complex w[MOST];
    const double *real = s->real + s->rows * j;
    double *re = s->straight + CT_FOUR * s->rows * j, *im = s->crossed + CT_FOUR * s->rows * j;
    for (int k = 0; k < free; k++) {
        w[k] = 0;
        for (int l = 0; l < free; l++)
            w[k] += product(R[k + rows * l], j < nu  ? -f.y * T[j + nu * l]
                                             : j < n ? g[l]
                                                     : push[l]);
    }
    for (int k = 0; k < nu; k++) {
        double _Complex moved = j >= nu && j < n ? -P[k] : 0;
        double _Complex gained = j < nu ? 0 : j < n ? PDP[k] : -P[k];
        for (int l = 0; l < free; l++) {
            moved += T[k + nu * l] * w[l];
            gained += product(f.c * T[k + nu * l] - s->PD[k + nu * l], w[l]);
        }
        put(re, im, real, k, moved);
        put(re, im, real, nu + k, gained);
    }
    for (int k = 0; k < m; k++) {
        double _Complex sum = j < nu ? f.y * T[j + nu * (free + k)]
                            : j < n  ? -g[free + k]
                                     : -push[free + k];
        for (int l = 0; l < free; l++)
            sum += product(G[free + k + nu * l], w[l]);
        put(re, im, real, 2 * nu + k, product(f.e, sum));
    }
    for (int k = s->out; k < s->rows; k++)
        put(re, im, real, k, 0);
}

static inline bool find_complex(const struct ct_response *s, double _Complex c, const int nu,
                                const int m)
{
    const double square = creal(c) * creal(c) + cimag(c) * cimag(c);
    const double _Complex z = conj(c) / square, y = product(z, z);
    const struct complex_coefficients f = {c, product(c, c), y};
    double _Complex *G = s->Gc, *F = s->Fc, *R = s->Rc;
    if (!s->is_regular)
        return false;
    fill_complex(s, G, F, y, z, nu, nu - m);
    if (!invert_complex(R, G, nu - m, nu))
        return false;
    for (int j = 0; j < nu; j++)
        find_column_complex(s, j, f, G, F, R, nu, m);
    for (int j = nu; j < nu + 2 * m; j++)
        find_column_complex(s, j, f, G, F, R, nu, m);
    return true;
}

bool ct_response_find_complex(struct ct_response *s, double _Complex c)
{
    return s->nu == 3 && s->m == 2 ? find_complex(s, c, 3, 2) : find_complex(s, c, s->nu, s->m);
}
