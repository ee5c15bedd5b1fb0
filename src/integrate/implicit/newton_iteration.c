// Matrices and linear systems of the simplified Newton iteration; see newton_iteration.h.
#include "integrate/implicit/newton_iteration.h"
#include "integrate/stepper.h"
#include "numeric/dense.h"
#include "numeric/inverse.h"

#include <float.h>
#include <math.h>
#include <string.h>

// The iteration ends when its error is below kappa = min(0.03, sqrt(tolerance)) times the
// tolerance. Definition: FNEWT of RADAU5, Hairer and Wanner (1996), IV.8.
static const double kappa_most = 0.03;
// Without a tolerance the iteration goes down to round-off, since errors that it leaves add up over
// steps of fixed length. Derived: with the factor kappa_roundoff of 1e-4 this is 1e-16, half of the
// unit round-off.
static const struct ct_tolerance roundoff_tolerance = {1e-12, 1e-12};
static const double kappa_roundoff = 1e-4; // Derived: see above
// It is accepted at this size, 1e-10 of the states, where it stalls or reaches the limit of
// corrections. Chosen: steps refused for round-off against the error of the iteration.
static const double largest_stalled = 100;
// A factor on kappa in the index-3 form, which tests positions alone. Errors of speeds are those of
// positions over the step. Default: corrections against the error of speeds. Test: dae
static const double kappa_index3 = 0.1;
// The largest number of corrections; RADAU5 has 7.
// Default: corrections against refused steps. Test: stiffness_detection_bushing
enum { MOST = 10 };
// The same without a tolerance. Limit: then the message that the fixed step is too long.
enum { MOST_TO_ROUNDOFF = 30 };

// For full matrices of m rows, n equations.
static void allocate_matrices(struct ct_arena *a, struct ct_newton_iteration *it, int m, int n,
                              bool is_complex)
{
    const int nu = it->nu;
    double **const square[] = {&it->M, &it->C, &it->K};
    for (size_t i = 0; i < COUNT(square); i++)
        *square[i] = CT_NEWN(a, double, nu *nu + 1);
    it->J = CT_NEWN(a, double, m *nu + 1);
    it->D = CT_NEWN(a, double, m *nu + 1);
    double **const large[] = {&it->S, &it->X, &it->W};
    for (size_t i = 0; i < COUNT(large); i++)
        *large[i] = CT_NEWN(a, double, n *n + 1);
    it->G = CT_NEWN(a, double, n *(n + 3) + 1);
    it->x = CT_NEWN(a, double, 2 * (n + 3));
    it->pivot = CT_NEWN(a, int, n + 1);
    if (is_complex) {
        it->Gi = CT_NEWN(a, double, 2 * CT_MOST_INVERTED * CT_MOST_INVERTED);
        it->Gc = CT_NEWN(a, double _Complex, n *n + 1);
        it->bc = CT_NEWN(a, double _Complex, n + 1);
        it->pivotc = CT_NEWN(a, int, n + 1);
        it->H = CT_NEWN(a, double, n *n + 1);
        it->pivot_slow = CT_NEWN(a, int, n + 1);
    }
}

struct ct_newton_iteration *ct_newton_iteration_create(struct ct_arena *a,
                                                       const struct ct_problem *p,
                                                       bool is_stabilised, bool is_complex)
{
    struct ct_newton_iteration *it = CT_NEW(a, struct ct_newton_iteration);
    const struct ct_dae *dae = p->dae;
    const int nu = dae->nu, m = dae->most_rows, n = nu + (is_stabilised ? 2 : 1) * m;
    it->dae = dae;
    it->groups = p->groups;
    it->is_stabilised = is_stabilised;
    it->nu = nu;
    it->per_speed = nu ? 1.0 / nu : 0;
    it->version = -1;
    it->tail = 1;
    it->sparse = ct_newton_create(a, dae, dae->plan[is_stabilised], is_complex);
    if (!it->sparse)
        allocate_matrices(a, it, m, n, is_complex);
    it->b = CT_NEWN(a, double, 2 * n + 1);
    it->inverse_weight = CT_NEWN(a, double, 2 * nu + 1);
    it->error_state = CT_NEWN(a, double, p->ny);
    it->fast = CT_NEWN(a, double, 2 * nu + 1);
    it->roundoff = CT_NEWN(a, double, 2 * nu + 1);
    it->probe = (struct ct_roundoff_probe){
        .q = CT_NEWN(a, double, dae->nq + 1),
        .d = CT_NEWN(a, double, nu + 1),
        .r = CT_NEWN(a, double, nu + 1),
        .rows = CT_NEWN(a, double, 2 * m + 1),
        .phi = CT_NEWN(a, double, 2 * m + 1),
        .a = CT_NEWN(a, double, nu + 1),
        .lam = CT_NEWN(a, double, m + 1),
        .zero = CT_NEWN(a, double, m + 1),
    };
    if (is_complex) {
        it->w = CT_NEWN(a, double, nu + 1);
        it->is_slow = CT_NEWN(a, bool, nu + 1);
        it->mass = CT_NEWN(a, double, nu + 1);
    }
    return it;
}

// The size of a state, or of its group.
static inline double size_of(const struct ct_groups *g, int i, const double *y)
{
    return g && g->of[i] >= 0 ? g->size[g->of[i]] : fabs(y[i]);
}

// Weights of positions and speeds in the norm. The weight of a speed is at most 1/least_speed.
static void weigh(struct ct_newton_iteration *it, double rtol, double atol, double least_speed,
                  const double *y)
{
    const struct ct_dae *dae = it->dae;
    ct_stepper_group(it->groups, dae->nq + dae->nu, y, y);
    for (int k = 0; k < it->nu; k++) {
        const int i = dae->q_of[k];
        const double size = size_of(it->groups, dae->nq + k, y);
        const bool is_state = i == CT_MOVES_NOTHING; // counts as a speed alone
        it->inverse_weight[k]
            = is_state ? 0 : 1 / (rtol * (i < 0 ? 1 : size_of(it->groups, i, y)) + atol);
        it->inverse_weight[it->nu + k]
            = 1 / ct_larger(rtol * size + atol, is_state ? 0 : least_speed);
    }
}

// The same where speed k is the derivative of coordinate k and there are no groups. nu is that of
// the iteration.
static inline void weigh_plain(struct ct_newton_iteration *it, double rtol, double atol,
                               double least_speed, const double *y, const int nu)
{
    const double *u = y + nu;
    for (int k = 0; k < nu; k++) {
        it->inverse_weight[k] = 1 / (rtol * fabs(y[k]) + atol);
        it->inverse_weight[nu + k] = 1 / ct_larger(rtol * fabs(u[k]) + atol, least_speed);
    }
}

static inline double largest_of(const double *x, const int n)
{
    double largest = 0;
    for (int i = 0; i < n; i++)
        largest = ct_larger(largest, fabs(x[i]));
    return largest;
}

static inline double largest_of_some(const double *x, int n)
{
    return n == 1 ? fabs(x[0]) : n == 3 ? largest_of(x, 3) : largest_of(x, n);
}

static double largest_place(const struct ct_newton_iteration *it, const double *y)
{
    const struct ct_dae *dae = it->dae;
    double largest = 0;
    if (dae->is_plain)
        return largest_of_some(y, it->nu);
    for (int k = 0; k < it->nu; k++) {
        const int i = dae->q_of[k];
        if (i != CT_MOVES_NOTHING)
            largest = ct_larger(largest, i < 0 ? 1 : fabs(y[i]));
    }
    return largest;
}

bool ct_newton_iteration_begin(struct ct_newton_iteration *it,
                               const struct ct_tolerance *tolerance, double h, const double *y)
{
    const struct ct_dae *dae = it->dae;
    const struct ct_tolerance *tol = tolerance ? tolerance : &roundoff_tolerance;
    const double roundoff = DBL_EPSILON * largest_place(it, y);
    it->least = ct_position_roundoff * roundoff;
    const double least_speed = tolerance ? it->least / h : 0;
    it->y = y;
    const bool is_plain = dae->is_plain && !it->groups;
    if (is_plain && it->nu == 1)
        weigh_plain(it, tol->rtol, tol->atol, least_speed, y, 1);
    else if (is_plain && it->nu == 3)
        weigh_plain(it, tol->rtol, tol->atol, least_speed, y, 3);
    else if (is_plain)
        weigh_plain(it, tol->rtol, tol->atol, least_speed, y, it->nu);
    else
        weigh(it, tol->rtol, tol->atol, least_speed, y);
    if (it->kappa_for != tol->rtol + tol->atol) {
        it->kappa_for = tol->rtol + tol->atol;
        it->kappa = tolerance ? ct_smaller(kappa_most, sqrt(it->kappa_for)) : kappa_roundoff;
        it->kappa *= it->is_stabilised ? 1 : kappa_index3;
    }
    it->runs_to_roundoff = !tolerance;
    it->roundoff_size = tolerance ? kappa_most : largest_stalled;
    it->most = tolerance ? MOST : MOST_TO_ROUNDOFF;
    it->is_new = false;
    if (dae->most_rows == 0 && it->version >= 0) // there are none that could change
        return false;
    const long before = it->version;
    it->m = dae->rows(dae->user, &it->version);
    it->n = it->nu + (it->is_stabilised ? 2 : 1) * it->m;
    it->rows = it->n <= CT_MOST_INVERTED ? ct_inverse_rows(it->n) : it->n;
    it->roundoff_position = roundoff / 2;
    it->roundoff_speed = DBL_EPSILON / 2 * largest_of_some(y + dae->nq, it->nu - dae->nstate);
    if (it->version == before)
        return false;
    it->has_tangent = false;
    if (it->sparse)
        ct_newton_retain_rows(it->sparse, dae->active_rows(dae->user), it->m);
    return true;
}

// ---- matrices -----------------------------------------------------------------------------------

// B (n x n): adds -A J' in the columns of eta from row `first` on, A (rows x nu).
static void fill_eta(const struct ct_newton_iteration *it, double *B, const double *A, int rows,
                     int first)
{
    const int nu = it->nu, m = it->m, n = it->n;
    for (int j = 0; j < m; j++) {
        double *column = B + n * (nu + j) + first;
        for (int k = 0; k < nu; k++) {
            const double push = it->J[j + m * k];
            for (int i = 0; i < rows && push != 0; i++)
                column[i] -= A[i + rows * k] * push;
        }
    }
}

// B (n x n): copies A (rows x nu) into the first columns from row `first` on.
static void fill_columns(const struct ct_newton_iteration *it, double *B, const double *A,
                         int rows, int first)
{
    for (int k = 0; k < it->nu; k++)
        memcpy(B + it->n * k + first, A + rows * k, (size_t)rows * sizeof *A);
}

void ct_newton_iteration_add_rotation(const struct ct_newton_iteration *it, double *x, double c,
                                      const double *d)
{
    c /= 2;
    for (int k = 0; k < it->nu; k++) {
        if (it->dae->q_of[k] != CT_MOVES_ROTATION)
            continue;
        const double *w = it->w + k, *th = d + k;
        x[k] += c * (th[1] * w[2] - th[2] * w[1]);
        x[k + 1] += c * (th[2] * w[0] - th[0] * w[2]);
        x[k + 2] += c * (th[0] * w[1] - th[1] * w[0]);
        k += 2;
    }
}

// B (n x n): subtracts A N from row `first` on, A (rows x nu); N' = -N.
static void fill_rotation(const struct ct_newton_iteration *it, double *B, const double *A,
                          int rows, int first)
{
    const int n = it->n;
    for (int k = 0; k < it->nu; k++) {
        if (it->dae->q_of[k] != CT_MOVES_ROTATION)
            continue;
        const double *w = it->w + k, *a = A + rows * k, *b = a + rows, *c = b + rows;
        double *x = B + n * k + first, *y = x + n, *z = y + n;
        for (int i = 0; i < rows; i++) {
            x[i] += (b[i] * w[2] - c[i] * w[1]) / 2;
            y[i] += (c[i] * w[0] - a[i] * w[2]) / 2;
            z[i] += (a[i] * w[1] - b[i] * w[0]) / 2;
        }
        k += 2;
    }
}

static void assemble(struct ct_newton_iteration *it)
{
    const int nu = it->nu, m = it->m, n = it->n;
    it->is_assembled = true;
    const size_t bytes = (size_t)n * (size_t)n * sizeof(double);
    memset(it->S, 0, bytes);
    memset(it->X, 0, bytes);
    memset(it->W, 0, bytes);
    fill_columns(it, it->S, it->M, nu, 0);
    fill_columns(it, it->S, it->J, m, nu);
    fill_columns(it, it->X, it->C, nu, 0);
    fill_columns(it, it->W, it->K, nu, 0);
    for (int j = 0; j < m; j++) // -J' in the last columns
        for (int k = 0; k < nu; k++)
            it->S[k + n * (n - m + j)] = -it->J[j + m * k];
    if (!it->is_stabilised)
        return;
    fill_columns(it, it->S, it->J, m, nu + m);
    fill_columns(it, it->W, it->D, m, nu + m);
    fill_eta(it, it->S, it->M, nu, 0);
    fill_eta(it, it->X, it->C, nu, 0);
    fill_eta(it, it->S, it->J, m, nu + m);
    if (!it->w)
        return;
    fill_rotation(it, it->X, it->M, nu, 0);
    fill_rotation(it, it->W, it->C, nu, 0);
    fill_rotation(it, it->W, it->J, m, nu + m);
}

// The derivatives at a point, and from them the matrices S, X, W.
static enum ct_eval evaluate(struct ct_newton_iteration *it, double t, const double *q,
                             const double *u, const double *a, const double *lam)
{
    const enum ct_eval e = it->sparse
                             ? ct_newton_evaluate(it->sparse, t, q, u, a, lam, it->w ? u : NULL)
                             : it->dae->tangent(it->dae->user, t, q, u, a, lam, it->M, it->C,
                                                it->K, it->J, it->D);
    if (e != CT_EVAL_OK)
        return e;
    if (it->w)
        memcpy(it->w, u, (size_t)it->nu * sizeof *u);
    it->is_assembled = false;
    if (!it->sparse)
        assemble(it);
    return CT_EVAL_OK;
}

enum ct_eval ct_newton_iteration_refresh(struct ct_newton_iteration *it, double t,
                                         const double *q, const double *u, const double *a,
                                         const double *lam, struct ct_integrate_stats *stats)
{
    if (!ct_newton_iteration_is_old(it))
        return CT_EVAL_OK;
    const enum ct_eval e = evaluate(it, t, q, u, a, lam);
    it->has_tangent = e == CT_EVAL_OK;
    it->is_outdated = false;
    it->is_new = true; // also where there are none: trying again would not end
    it->t = t;
    if (e != CT_EVAL_OK)
        return e;
    stats->jacobians++;
    memcpy(it->probe.a, a, (size_t)it->nu * sizeof *a);
    memcpy(it->probe.lam, lam, (size_t)it->m * sizeof *lam);
    it->rate = it->c = it->e = it->slow = 0;
    return CT_EVAL_OK;
}

void ct_newton_iteration_fill(struct ct_newton_iteration *it, double *A, int lda, double c,
                              double e)
{
    const int n = it->n;
    const double x = c / e, y = 1 / e, z = 1 / c;
    if (!it->is_assembled)
        assemble(it);
    for (int j = 0; j < n; j++) {
        const double *S = it->S + j * n, *X = it->X + j * n, *W = it->W + j * n;
        double *column = A + j * lda;
        for (int k = 0; k < n; k++)
            column[k] = S[k] + x * X[k] + (k < it->nu ? y : z) * W[k];
        for (int k = n; k < lda; k++)
            column[k] = 0;
    }
}

// Small systems are solved with the inverse matrix, which is faster than two triangular solutions.
static bool has_inverse(const struct ct_newton_iteration *it)
{
    return it->n <= CT_MOST_INVERTED;
}

// Factors of the complex system, w = 1/c.
static bool factor_complex(struct ct_newton_iteration *it, double _Complex w)
{
    const int n = it->n, nu = it->nu;
    const double _Complex ww = w * w;
    double *re = it->Gi, *im = re + it->rows * n;
    it->z = w;
    if (it->sparse)
        return ct_newton_factor_complex(it->sparse, w);
    for (int j = 0; j < n; j++)
        for (int k = 0; k < (has_inverse(it) ? it->rows : n); k++) {
            const int i = k + j * n, at = k + j * it->rows;
            const double _Complex a
                = k < n ? it->S[i] + w * it->X[i] + (k < nu ? ww : w) * it->W[i] : 0;
            if (has_inverse(it)) {
                re[at] = creal(a);
                im[at] = cimag(a);
            } else {
                it->Gc[i] = a;
            }
        }
    return has_inverse(it) ? ct_inverse_complex(it->Gi, it->pivotc, n)
                           : ct_lu_complex(it->Gc, it->pivotc, n, n);
}

// Factors of the real system.
static bool factor_real(struct ct_newton_iteration *it, double c, double e)
{
    const int n = it->n;
    if (it->sparse)
        return ct_newton_factor(it->sparse, c, e);
    ct_newton_iteration_fill(it, it->G, it->rows, c, e);
    return has_inverse(it) ? ct_inverse(it->G, it->pivot, n) : ct_lu(it->G, it->pivot, n, n);
}

bool ct_newton_iteration_factor_anew(struct ct_newton_iteration *it, double c, double e,
                                     double _Complex s, struct ct_integrate_stats *stats)
{
    const int n = it->n;
    it->c = it->e = 0;
    it->has_roundoff = false;
    stats->factorizations++;
    if (!factor_real(it, c, e))
        return false;
    if (s != 0) {
        stats->factorizations++;
        if (!factor_complex(it, 1 / s))
            return false;
    }
    it->c = c;
    it->e = e;
    it->by_r = -1 / e;
    it->by_v = -1 / c;
    if (n == 1) {
        it->one = -it->G[0] / e;
        if (s != 0)
            it->onec = -CMPLX(it->Gi[0], it->Gi[it->rows]) / (s * s);
    }
    return true;
}

// The solution for it->b.
static const double *solve_real(struct ct_newton_iteration *it)
{
    const int n = it->n;
    if (it->sparse) {
        ct_newton_solve(it->sparse, it->b);
        return it->b;
    }
    if (has_inverse(it)) {
        ct_inverse_apply(it->x, it->G, it->b, n);
        return it->x;
    }
    ct_lu_solve(it->b, it->G, it->pivot, n, n, 1, n, false);
    return it->b;
}

void ct_newton_iteration_solve_system(struct ct_newton_iteration *it, double *d, double *eta,
                                      double *lam, const double *r, const double *phi,
                                      const double *v)
{
    const int nu = it->nu, m = it->m, n = it->n;
    double *b = it->b;
    const double y = it->by_r, z = it->by_v;
    for (int i = 0; i < nu; i++)
        b[i] = y * r[i];
    for (int i = 0; i < m; i++)
        b[nu + i] = -phi[i];
    for (int i = 0; i < m && it->is_stabilised; i++)
        b[nu + m + i] = z * v[i];
    const double *x = solve_real(it);
    ct_stepper_copy(d, x, nu);
    for (int i = 0; i < m; i++) {
        eta[i] = it->is_stabilised ? x[nu + i] : 0;
        lam[i] = it->e * x[n - m + i];
    }
}

// x y without the care for infinite parts that makes it a call.
static inline double _Complex product(double _Complex x, double _Complex y)
{
    return CMPLX(creal(x) * creal(y) - cimag(x) * cimag(y),
                 creal(x) * cimag(y) + cimag(x) * creal(y));
}

// The solution for it->b, real parts (n) before imaginary ones: those are returned, these stand
// *to_imaginary behind.
static const double *solve_complex(struct ct_newton_iteration *it, int *to_imaginary)
{
    const int n = it->n;
    double *b = it->b;
    if (it->sparse) {
        ct_newton_solve_complex(it->sparse, b, n);
        *to_imaginary = n;
        return b;
    }
    if (has_inverse(it)) {
        ct_inverse_apply_complex(it->x, it->Gi, b, n);
        *to_imaginary = it->rows;
        return it->x;
    }
    for (int i = 0; i < n; i++)
        it->bc[i] = CMPLX(b[i], b[i + n]);
    ct_lu_complex_solve(it->bc, it->Gc, it->pivotc, n, n, 1, n);
    for (int i = 0; i < n; i++) {
        b[i] = creal(it->bc[i]);
        b[i + n] = cimag(it->bc[i]);
    }
    *to_imaginary = n;
    return b;
}

void ct_newton_iteration_solve_complex(struct ct_newton_iteration *it, double *d, double *eta,
                                       double *lam, const double *r, const double *phi,
                                       const double *v)
{
    const int nu = it->nu, m = it->m, n = it->n;
    const double _Complex z = it->z, zz = product(z, z), ee = CMPLX(1, 0) / zz;
    const double a = -creal(z), b = -cimag(z), aa = -creal(zz), bb = -cimag(zz);
    double *re = it->b, *im = re + n;
    int to_imaginary;
    if (n == 1) {
        const double _Complex x = product(it->onec, CMPLX(r[0], r[1]));
        d[0] = creal(x);
        d[1] = cimag(x);
        return;
    }
    for (int i = 0; i < nu; i++) {
        re[i] = aa * r[i] - bb * r[i + nu];
        im[i] = aa * r[i + nu] + bb * r[i];
    }
    for (int i = 0; i < m; i++) {
        re[nu + i] = -phi[i];
        im[nu + i] = -phi[i + m];
        re[nu + m + i] = a * v[i] - b * v[i + m];
        im[nu + m + i] = a * v[i + m] + b * v[i];
    }
    const double *x = solve_complex(it, &to_imaginary), *y = x + to_imaginary;
    ct_stepper_copy(d, x, nu);
    ct_stepper_copy(d + nu, y, nu);
    for (int i = 0; i < m; i++) {
        const double _Complex l = product(ee, CMPLX(x[nu + m + i], y[nu + m + i]));
        eta[i] = x[nu + i];
        eta[i + m] = y[nu + i];
        lam[i] = creal(l);
        lam[i + m] = cimag(l);
    }
}

// ---- products -----------------------------------------------------------------------------------

void ct_newton_iteration_add_constraint_force_sparse(const struct ct_newton_iteration *it,
                                                     double *out, const double *x, double c,
                                                     const double *eta)
{
    if (out != x)
        ct_stepper_copy(out, x, it->nu);
    ct_newton_add_constraint_force(it->sparse, out, c, eta);
}

void ct_newton_iteration_multiply_mass(const struct ct_newton_iteration *it, double *r,
                                       const double *x)
{
    const int nu = it->nu;
    memset(r, 0, (size_t)nu * sizeof *r);
    if (it->sparse) {
        ct_newton_add_mass(it->sparse, r, 1, x);
        return;
    }
    for (int j = 0; j < nu; j++)
        for (int k = 0; k < nu; k++)
            r[k] += it->M[k + nu * j] * x[j];
}

// ---- errors -------------------------------------------------------------------------------------

const double *ct_newton_iteration_states(struct ct_newton_iteration *it, const double *y1,
                                         const double *d, const double *u)
{
    const int nq = it->dae->nq;
    double *e = it->error_state;
    if (it->dae->is_plain) {
        ct_stepper_copy(e, d, nq);
    } else {
        it->dae->retract(it->dae->user, y1, d, e);
        for (int i = 0; i < nq; i++)
            e[i] -= y1[i];
    }
    ct_stepper_copy(e + nq, u, it->nu);
    return e;
}

double ct_newton_iteration_error(struct ct_newton_iteration *it, const struct ct_problem *p,
                                 const struct ct_tolerance *tolerance, double t1,
                                 const double *y1, const double *d, const double *u,
                                 double states)
{
    return ct_stepper_larger_error(p, tolerance, t1, y1,
                                   ct_newton_iteration_states(it, y1, d, u), states);
}

double ct_newton_iteration_sensitive_error(struct ct_newton_iteration *it,
                                           const struct ct_problem *p,
                                           const struct ct_tolerance *tolerance, double t1,
                                           const double *y1, const double *d, const double *u,
                                           double states)
{
    return p->sensitive_output_error(p->user, t1, y1, ct_newton_iteration_states(it, y1, d, u),
                                     tolerance, states);
}
