// See iteration.h. The rules of convergence are those of Hairer and Wanner (1996), IV.8, key hairer1996.
#include "integrate/iteration.h"
#include "integrate/stepper.h"
#include "numeric/dense.h"
#include "numeric/inverse.h"

#include <float.h>
#include <math.h>
#include <string.h>

// With a tolerance the iteration errs by a small part of it, smaller the tighter it is.
static const double kappa_most = 0.03;
// Without one, corrections are followed until less than half a rounding of states is left, 1e-16 of them, and accepted at
// 1e-10 where they stop to shrink or have been many. What is left in each step, and is the same in most, adds up over the steps.
static const struct ct_tolerance finest = {1e-12, 1e-12};
static const double kappa_finest = 1e-4, rounding_finest = 100;
// The first corrections come from a guess and may grow; not so much, though.
static const double hopeless = 100;
// Places that change by less than this many roundings of the largest of them cannot be found better, however much their
// speeds still change, which have the same over the step.
static const double place_rounding = 8;
// With a tolerance a speed need not be known better than what moves a place by so many roundings in the step: where forces
// are very stiff, shorter steps would only show more of it.
static const double moved_roundings = 4;
// Corrections that are to go on after convergence do until they are this much smaller.
static const double further = 1e-6;
// After convergence corrections that are not halved have come to rounding.
static const double halved = 0.5;
// Those before have come near enough when each was less than this part of the last, as it is with derivatives that are kept.
static const double shrinking = 0.1;
// So much of what is seen of roundings may come together in a correction: stages add up three times as much, and no two looks are
// alike. They are seen where places are so few of theirs away.
static const double together = 8, few = 16;
// In the index-3 form places alone are judged, and speeds follow them divided by the step.
static const double kappa_index3 = 0.01;
enum { MOST = 10, MOST_FINEST = 30 };

// For full matrices of m rows, n equations.
static void make_room(struct ct_arena *a, struct ct_iteration *it, int m, int n,
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

struct ct_iteration *ct_iteration_create(struct ct_arena *a, const struct ct_problem *p,
                                         bool is_stabilised, bool is_complex)
{
    struct ct_iteration *it = CT_NEW(a, struct ct_iteration);
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
        make_room(a, it, m, n, is_complex);
    it->b = CT_NEWN(a, double, 2 * n + 1);
    it->share = CT_NEWN(a, double, ct_response_padded(2 * nu + m));
    if (is_stabilised && dae->abreast && nu + 2 <= CT_MOST_INVERTED)
        it->response = ct_response_create(a, nu, m, is_complex);
    it->off = CT_NEWN(a, double, p->ny);
    it->fast = CT_NEWN(a, double, 2 * nu + 1);
    it->noise = CT_NEWN(a, double, 2 * nu + 1);
    it->probe = (struct ct_probe){
        .q = CT_NEWN(a, double, dae->nq + 1),
        .d = CT_NEWN(a, double, nu + 1),
        .r = CT_NEWN(a, double, nu + 1),
        .rows = CT_NEWN(a, double, 2 * m + 1),
        .zero = CT_NEWN(a, double, nu + m + 1),
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

// What places and speeds are measured against; speeds need not be known better than least_speed.
static void weigh(struct ct_iteration *it, double rtol, double atol, double least_speed,
                  const double *y)
{
    const struct ct_dae *dae = it->dae;
    ct_stepper_group(it->groups, dae->nq + dae->nu, y, y);
    for (int k = 0; k < it->nu; k++) {
        const int i = dae->q_of[k];
        const double size = size_of(it->groups, dae->nq + k, y);
        it->share[k] = 1 / (rtol * (i < 0 ? 1 : size_of(it->groups, i, y)) + atol);
        it->share[it->nu + k] = 1 / ct_larger(rtol * size + atol, least_speed);
    }
}

// The same where coordinate k moves with speed k and each counts for itself; nu is that of the iteration.
static inline void weigh_plain(struct ct_iteration *it, double rtol, double atol,
                               double least_speed, const double *y, const int nu)
{
    const double *u = y + nu;
    for (int k = 0; k < nu; k++) {
        it->share[k] = 1 / (rtol * fabs(y[k]) + atol);
        it->share[nu + k] = 1 / ct_larger(rtol * fabs(u[k]) + atol, least_speed);
    }
}

static inline double largest_place(const struct ct_iteration *it, const double *y)
{
    const struct ct_dae *dae = it->dae;
    double largest = 0;
    if (dae->is_plain && it->nu == 1)
        return fabs(y[0]);
    for (int k = 0; k < it->nu; k++) {
        const int i = dae->is_plain ? k : dae->q_of[k];
        largest = ct_larger(largest, i < 0 ? 1 : fabs(y[i]));
    }
    return largest;
}

static double largest_of(const double *x, int n)
{
    double largest = 0;
    for (int i = 0; i < n; i++)
        largest = ct_larger(largest, fabs(x[i]));
    return largest;
}

bool ct_iteration_begin(struct ct_iteration *it, const struct ct_tolerance *tolerance, double h,
                        const double *y)
{
    const struct ct_dae *dae = it->dae;
    const struct ct_tolerance *tol = tolerance ? tolerance : &finest;
    const double rounding = DBL_EPSILON * largest_place(it, y);
    const double least_speed = tolerance ? moved_roundings * rounding / h : 0;
    it->least = place_rounding * rounding;
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
        it->kappa = tolerance ? ct_smaller(kappa_most, sqrt(it->kappa_for)) : kappa_finest;
        it->kappa *= it->is_stabilised ? 1 : kappa_index3;
    }
    it->is_finest = !tolerance;
    it->rounding = tolerance ? kappa_most : rounding_finest;
    it->most = tolerance ? MOST : MOST_FINEST;
    it->is_new = false;
    if (dae->most_rows == 0 && it->version >= 0) // there are none that could change
        return false;
    const long before = it->version;
    it->m = dae->rows(dae->user, &it->version);
    it->n = it->nu + (it->is_stabilised ? 2 : 1) * it->m;
    it->rows = it->n <= CT_MOST_INVERTED ? ct_inverse_rows(it->n) : it->n;
    it->is_few = it->response && it->m && it->n <= CT_MOST_INVERTED;
    if (it->is_few)
        ct_response_set_rows(it->response, it->m);
    it->unfelt_place = rounding / 2;
    it->unfelt_speed = DBL_EPSILON / 2 * largest_of(y + dae->nq, it->nu);
    if (it->version == before)
        return false;
    it->has_tangent = false;
    if (it->sparse)
        ct_newton_keep(it->sparse, dae->kept_rows(dae->user), it->m);
    return true;
}

// ---- matrices -------------------------------------------------------------------------------------

// -A J' into the columns of eta, A (rows x nu) at row `first` of B (n x n).
static void fill_eta(const struct ct_iteration *it, double *B, const double *A, int rows,
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

// A (rows x nu) at row `first` of B (n x n).
static void fill_place(const struct ct_iteration *it, double *B, const double *A, int rows,
                       int first)
{
    for (int k = 0; k < it->nu; k++)
        memcpy(B + it->n * k + first, A + rows * k, (size_t)rows * sizeof *A);
}

void ct_iteration_turn(const struct ct_iteration *it, double *x, double c, const double *d)
{
    c /= 2;
    for (int k = 0; k < it->nu; k++) {
        if (it->dae->q_of[k] >= 0)
            continue;
        const double *w = it->w + k, *th = d + k;
        x[k] += c * (th[1] * w[2] - th[2] * w[1]);
        x[k + 1] += c * (th[2] * w[0] - th[0] * w[2]);
        x[k + 2] += c * (th[0] * w[1] - th[1] * w[0]);
        k += 2;
    }
}

// Less A N, A (rows x nu), at row `first` of B (n x n); N' = -N.
static void fill_turn(const struct ct_iteration *it, double *B, const double *A, int rows,
                      int first)
{
    const int n = it->n;
    for (int k = 0; k < it->nu; k++) {
        if (it->dae->q_of[k] >= 0)
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

static void assemble(struct ct_iteration *it)
{
    const int nu = it->nu, m = it->m, n = it->n;
    it->is_assembled = true;
    const size_t bytes = (size_t)n * (size_t)n * sizeof(double);
    memset(it->S, 0, bytes);
    memset(it->X, 0, bytes);
    memset(it->W, 0, bytes);
    fill_place(it, it->S, it->M, nu, 0);
    fill_place(it, it->S, it->J, m, nu);
    fill_place(it, it->X, it->C, nu, 0);
    fill_place(it, it->W, it->K, nu, 0);
    for (int j = 0; j < m; j++) // -J' behind all others
        for (int k = 0; k < nu; k++)
            it->S[k + n * (n - m + j)] = -it->J[j + m * k];
    if (!it->is_stabilised)
        return;
    fill_place(it, it->S, it->J, m, nu + m);
    fill_place(it, it->W, it->D, m, nu + m);
    fill_eta(it, it->S, it->M, nu, 0);
    fill_eta(it, it->X, it->C, nu, 0);
    fill_eta(it, it->S, it->J, m, nu + m);
    if (!it->w)
        return;
    fill_turn(it, it->X, it->M, nu, 0);
    fill_turn(it, it->W, it->C, nu, 0);
    fill_turn(it, it->W, it->J, m, nu + m);
}

// The derivatives at a point, and what matrices are made of.
static enum ct_eval evaluate(struct ct_iteration *it, double t, const double *q,
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
    if (it->is_few)
        ct_response_assemble(it->response, it->M, it->C, it->K, it->J, it->D);
    else if (!it->sparse)
        assemble(it);
    return CT_EVAL_OK;
}

enum ct_eval ct_iteration_refresh(struct ct_iteration *it, double t, const double *q,
                                  const double *u, const double *a, const double *lam,
                                  struct ct_integrate_stats *stats)
{
    if (!ct_iteration_is_old(it))
        return CT_EVAL_OK;
    const enum ct_eval e = evaluate(it, t, q, u, a, lam);
    it->has_tangent = e == CT_EVAL_OK;
    it->is_worn = false;
    it->t = t;
    if (e != CT_EVAL_OK)
        return e;
    stats->jacobians++;
    it->is_new = true;
    it->rate = it->c = it->e = it->slow = 0;
    return CT_EVAL_OK;
}

void ct_iteration_fill(struct ct_iteration *it, double *A, int lda, double c, double e)
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

// A right-hand side of few equations is a product with the inverse: steps of a small mechanism are little else.
static bool has_inverse(const struct ct_iteration *it)
{
    return it->n <= CT_MOST_INVERTED;
}

// The complex system with one over its c, w.
static bool factor_complex(struct ct_iteration *it, double _Complex w)
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

// The real system.
static bool factor_real(struct ct_iteration *it, double c, double e)
{
    const int n = it->n;
    if (it->is_few)
        return ct_response_find(it->response, c, e);
    if (it->sparse)
        return ct_newton_factor(it->sparse, c, e);
    ct_iteration_fill(it, it->G, it->rows, c, e);
    return has_inverse(it) ? ct_inverse(it->G, it->pivot, n) : ct_lu(it->G, it->pivot, n, n);
}

bool ct_iteration_factor_anew(struct ct_iteration *it, double c, double e, double _Complex s,
                              struct ct_integrate_stats *stats)
{
    const int n = it->n;
    it->c = it->e = 0;
    it->has_noise = false;
    stats->factorizations++;
    if (!factor_real(it, c, e))
        return false;
    if (s != 0) {
        stats->factorizations++;
        if (!(it->is_few ? ct_response_find_complex(it->response, s)
                         : factor_complex(it, 1 / s)))
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
static const double *solve_real(struct ct_iteration *it)
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

void ct_iteration_solve_system(struct ct_iteration *it, double *d, double *eta, double *lam,
                               const double *r, const double *phi, const double *v)
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

// The solution for it->b, real parts (n) before imaginary ones: those are returned, these stand *to_imaginary behind.
static const double *solve_complex(struct ct_iteration *it, int *to_imaginary)
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

void ct_iteration_solve_complex(struct ct_iteration *it, double *d, double *eta, double *lam,
                                const double *r, const double *phi, const double *v)
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

// ---- products ---------------------------------------------------------------------------------------

void ct_iteration_push_sparse(const struct ct_iteration *it, double *out, const double *x,
                              double c, const double *eta)
{
    if (out != x)
        ct_stepper_copy(out, x, it->nu);
    ct_newton_add_push(it->sparse, out, c, eta);
}

void ct_iteration_weigh_mass(const struct ct_iteration *it, double *r, const double *x)
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

// ---- convergence ------------------------------------------------------------------------------------

const double *ct_iteration_states(struct ct_iteration *it, const double *y1, const double *d,
                                  const double *u)
{
    const int nq = it->dae->nq;
    double *e = it->off;
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

double ct_iteration_error(struct ct_iteration *it, const struct ct_problem *p,
                          const struct ct_tolerance *tolerance, double t1, const double *y1,
                          const double *d, const double *u, double states)
{
    return ct_stepper_worse(p, tolerance, t1, y1, ct_iteration_states(it, y1, d, u), states);
}

double ct_iteration_amplified(struct ct_iteration *it, const struct ct_problem *p,
                              const struct ct_tolerance *tolerance, double t1, const double *y1,
                              const double *d, const double *u)
{
    return p->amplified_error(p->user, t1, y1, ct_iteration_states(it, y1, d, u), tolerance);
}

void ct_iteration_start(struct ct_iteration *it)
{
    const double tail = ct_larger(it->tail, DBL_EPSILON);
    it->count = 0;
    it->is_further = false;
    it->rate = 0;
    // the last step's, trusted less and less; not where there is no tolerance that says how far off it may be
    it->tail = it->is_finest ? 1 : sqrt(tail * sqrt(tail));
}

void ct_iteration_go_on(struct ct_iteration *it)
{
    it->count = 1; // the last correction is known, its rate is not wanted
    it->is_further = true;
    it->kappa *= further;
    it->kappa_for = NAN; // in this step only
}

// Between 1 and 2 or -2 and -1 by chance, another for each k: a pattern would miss some motions.
static double toss(unsigned k)
{
    const double odd = 0x1p-24;
    k = (k + 1) * 2654435769u; // 2^32 over the golden ratio
    k = (k ^ k >> 15) * 2246822519u;
    k = (k ^ k >> 13) * 3266489917u;
    return (k & 1 ? 1 : -1) * (1 + odd * (k >> 8));
}

// Forces at q and speeds of the step's start into r (nu); no accelerations, no multipliers.
static bool find_forces(struct ct_iteration *it, const double *q, double *r)
{
    const struct ct_probe *p = &it->probe;
    const double *u = it->y + it->dae->nq;
    return it->dae->residual(it->dae->user, it->t, q, u, p->zero, p->zero, r, p->rows,
                             p->rows + it->m)
        == CT_EVAL_OK;
}

// b (nu) = the rounding of forces, and what that of places makes of them: by how much those a few roundings of places away, d, are not
// what K says.
static bool round_forces(struct ct_iteration *it, double *b)
{
    const int nu = it->nu;
    const struct ct_dae *dae = it->dae;
    const struct ct_probe *p = &it->probe;
    for (int k = 0; k < nu; k++) {
        const double place = dae->q_of[k] < 0 ? 1 : it->y[dae->q_of[k]];
        p->d[k] = toss((unsigned)k) * few * DBL_EPSILON * place;
    }
    ct_iteration_move(dae, it->y, p->d, p->q);
    if (!find_forces(it, it->y, b) || !find_forces(it, p->q, p->r))
        return false;
    for (int k = 0; k < nu; k++)
        b[k] -= p->r[k];
    if (it->sparse)
        ct_newton_add_stiffness(it->sparse, b, 1, p->d);
    for (int j = 0; j < nu && !it->sparse; j++)
        ct_vector_add(b, p->d[j], it->K + nu * j, (size_t)nu);
    return true;
}

const double *ct_iteration_noise(struct ct_iteration *it)
{
    const int nu = it->nu;
    double *b = it->b, *d = it->noise, *u = d + nu;
    if (it->has_noise)
        return d;
    it->has_noise = true;
    memset(d, 0, 2 * (size_t)nu * sizeof *d);
    memset(b, 0, (size_t)it->n * sizeof *b);
    if (!round_forces(it, b))
        return d;
    if (it->is_few) { // places and speeds, one behind the other
        ct_product(it->x, it->response->real, b, it->response->rows, it->response->in);
        ct_stepper_copy(d, it->x, 2 * nu);
        return d;
    }
    for (int k = 0; k < nu; k++)
        b[k] *= it->by_r;
    ct_stepper_copy(d, solve_real(it), nu);
    for (int k = 0; k < nu; k++)
        u[k] = it->c * d[k];
    return d;
}

static bool is_within(const double *d, int n, double most)
{
    for (int i = 0; i < n; i++)
        if (!(fabs(d[i]) <= most))
            return false;
    return true;
}

// Followed down to rounding, the second correction against the first says nothing yet, which is an error of the prediction
// and in places above all: of angles of several turns in loops the second is as large and the third a thousandth of it, of a tumbling body,
// with old derivatives, the second is a thousandth and the third, of speeds, a tenth of that.
static bool is_too_early(const struct ct_iteration *it)
{
    return it->is_finest && it->count == 2;
}

// A correction is `rate` times the one before. Two in turn are often uneven, so their mean says whether they converge. Followed
// down to rounding the slowest one says what is left, but for the first, which says nothing.
static void take_rate(struct ct_iteration *it, double rate)
{
    it->slowest = it->count > 3 ? ct_larger(rate, it->slowest) : rate;
    it->rate = it->count > 2 ? sqrt(rate * it->rate) : rate;
    const double counts = it->is_finest ? it->slowest : it->rate;
    it->tail = counts < 1 ? counts / (1 - counts) : INFINITY;
}

// Does a correction of this size, at this rate to the one before, show only rounding?
static bool is_rounding(const struct ct_iteration *it, double rate, double size)
{
    if (it->is_further && rate >= halved && size <= 1)
        return true;
    return rate >= 1 && !is_too_early(it) && size <= it->rounding;
}

// Nor does one that a rounding of the forces may be the reason of, where corrections shrink no more: stiff forces of places that
// are large beside their own motion, as of a beam of many elements, are known no better, and in shorter steps hardly so.
static bool is_noise(struct ct_iteration *it, double rate, double size, bool has_speeds)
{
    const bool has_stalled
        = rate >= 1 || (rate >= halved && it->count > 2 && it->rate < shrinking);
    if (!has_stalled || it->is_finest)
        return false;
    const double *noise = ct_iteration_noise(it);
    const double *u = has_speeds ? noise + it->nu : NULL;
    return size <= together * ct_iteration_norm(it, noise, u, it->nu, 1);
}

// Half a rounding of the largest place moves no place as large, and what is left of the constraints comes back in others,
// halved perhaps from one correction to the next: neither more of them nor shorter steps make it less.
static bool is_unfelt(const struct ct_iteration *it, double size, const double *d,
                      const double *u, int n)
{
    return it->m && u && !it->is_finest && !it->is_further && size <= it->rounding
        && is_within(d, n, it->unfelt_place) && is_within(u, n, it->unfelt_speed);
}

enum ct_verdict ct_iteration_judge(struct ct_iteration *it, double size, const double *d,
                                   const double *u, int k)
{
    if (!isfinite(size))
        return CT_DIVERGED;
    if (it->count++ > 0) {
        const double rate = size / it->size;
        const int n = k * it->nu;
        if (is_rounding(it, rate, size)
            || (rate >= 1 && !is_too_early(it) && is_within(d, n, it->least))
            || is_unfelt(it, size, d, u, n) || is_noise(it, rate, size, u != NULL))
            return CT_CONVERGED;
        take_rate(it, rate);
        if (rate >= hopeless || (it->rate >= 1 && it->count > 3))
            return CT_DIVERGED;
    }
    it->size = size;
    if (size <= it->kappa || (it->tail * size <= it->kappa && !is_too_early(it)))
        return CT_CONVERGED;
    if (it->count < it->most)
        return CT_GO_ON;
    return it->is_finest && size <= it->rounding ? CT_CONVERGED : CT_DIVERGED;
}

bool ct_iteration_can_renew(struct ct_iteration *it)
{
    it->tail = 1;
    it->has_tangent = false;
    return !it->is_new;
}
