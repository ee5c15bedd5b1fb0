// Accelerations, minimum-norm multipliers and speeds after an impulse, by dense matrices; see
// partition.h.
#include "solve/constraint/partition_internal.h"

#include "numeric/damped.h"
#include "numeric/dense.h"
#include "numeric/roundoff.h"

#include <math.h>
#include <string.h>

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

struct ct_partition *ct_partition_create(struct ct_arena *arena, struct ct_ctx *ctx,
                                         struct ct_evaluator *m)
{
    const size_t n = m->nu, r = m->nrow, k = larger(n, r) + 1;
    const size_t kk = m->e->has_dynamics || r ? k : 1; // otherwise nothing is solved
    struct ct_partition *s = CT_NEW(arena, struct ct_partition);
    s->arena = arena;
    s->m = m;
    s->ctx = ctx;
    s->nearness = s->scale = 1;
    s->row = CT_NEWN(arena, int, r + 1);
    s->dependent = CT_NEWN(arena, int, k);
    s->independent = CT_NEWN(arena, int, n + 1);
    s->is_unique = CT_NEWN(arena, bool, r + 1);
    s->unit = CT_NEWN(arena, double, r + 1);
    s->a = CT_NEWN(arena, double, n + 1);
    s->lam = CT_NEWN(arena, double, r + 1);
    s->M = CT_NEWN(arena, double, (m->e->has_dynamics ? n * n : 0) + 1);
    s->Jd = CT_NEWN(arena, double, r *r + 1);
    s->B = CT_NEWN(arena, double, r *kk + 1);
    s->S = CT_NEWN(arena, double, kk *kk);
    s->MB = CT_NEWN(arena, double, kk *kk);
    s->A = CT_NEWN(arena, double, r *kk + 1);
    s->q = CT_NEWN(arena, double, m->nq + 1);
    s->before = CT_NEWN(arena, double, m->nq + m->nu + 1);
    s->c = CT_NEWN(arena, double, k);
    s->r = CT_NEWN(arena, double, k);
    s->b = CT_NEWN(arena, double, k);
    s->d = CT_NEWN(arena, double, k);
    s->pivot = CT_NEWN(arena, int, k);
    s->iwork = CT_NEWN(arena, int, k);
    s->column = CT_NEWN(arena, int, k);
    const int size = (int)kk;
    const size_t for_qr = larger(ct_lstsq_work(size, size), ct_qr_pivot_work(size, size));
    s->work
        = CT_NEWN(arena, double, larger(for_qr, ct_symmetric_eigenvalues_work(size)) + 3 * k);
    return s;
}

// The largest entry of redundant rows in dependent columns: such a row could replace a retained
// one.
static double largest_redundant(const struct ct_partition *s)
{
    double most = 0;
    for (size_t i = (size_t)s->rank; i < s->m->nrow; i++)
        for (int j = 0; j < s->rank; j++)
            most = fmax(most, fabs(*ct_partition_J(s, s->row[i], s->dependent[j])));
    return most;
}

bool ct_partition_factor(struct ct_partition *s)
{
    const int r = s->rank, f = (int)s->m->nu - r;
    s->factorizations++;
    for (int j = 0; j < r; j++)
        for (int i = 0; i < r; i++)
            s->Jd[i + r * j] = *ct_partition_J(s, s->row[i], s->dependent[j]);
    if (!ct_lu(s->Jd, s->pivot, r, r))
        return false;
    for (int j = 0; j < f; j++)
        for (int i = 0; i < r; i++)
            s->B[i + r * j] = -*ct_partition_J(s, s->row[i], s->independent[j]);
    if (f)
        ct_lu_solve(s->B, s->Jd, s->pivot, r, r, f, r, false);
    s->kappa = 0;
    for (int i = 0; i < r * f; i++)
        s->kappa = fmax(s->kappa, fabs(s->B[i]));
    double least = INFINITY, most = 0;
    for (int i = 0; i < r; i++) {
        least = fmin(least, fabs(s->Jd[i + r * i]));
        most = fmax(most, fabs(s->Jd[i + r * i]));
    }
    s->sigma = most > 0 ? least / fmax(most, largest_redundant(s)) : 0;
    s->largest = most;
    return isfinite(s->kappa);
}

bool ct_partition_factor_only(struct ct_partition *s)
{
    const double sigma = s->sigma, kappa = s->kappa;
    const bool is_factored = ct_partition_factor(s);
    s->sigma = sigma;
    s->kappa = kappa;
    return is_factored;
}

const double *ct_partition_mass(struct ct_partition *s)
{
    ct_evaluator_fill_mass(s->m, s->M, s->m->nu);
    return s->M;
}

void ct_partition_reduce_mass(struct ct_partition *s, const double *M)
{
    const size_t n = s->m->nu;
    const int r = s->rank, f = (int)n - r;
    for (int j = 0; j < f; j++) { // MB = M [B; 1], n x f; with independent loops B is sparse
        double *MB = s->MB + n * (size_t)j;
        memcpy(MB, M + n * (size_t)s->independent[j], n * sizeof *MB);
        for (int k = 0; k < r; k++)
            if (s->B[k + r * j] != 0)
                ct_vector_add(MB, s->B[k + r * j], M + n * (size_t)s->dependent[k], n);
    }
    for (int i = 0; i < f; i++) {
        int nk = 0;
        for (int k = 0; k < r; k++)
            if (s->B[k + r * i] != 0)
                s->iwork[nk++] = k;
        for (int j = 0; j <= i; j++) {
            const double *MB = s->MB + n * (size_t)j;
            double sum = MB[s->independent[i]];
            for (int l = 0; l < nk; l++)
                sum += s->B[s->iwork[l] + r * i] * MB[s->dependent[s->iwork[l]]];
            s->S[i + f * j] = sum;
        }
    }
}

// b (free) = B' v for v (nu).
static void reduce_force(struct ct_partition *s, double *b, const double *v)
{
    const int r = s->rank, f = (int)s->m->nu - r;
    for (int i = 0; i < f; i++) {
        b[i] = v[s->independent[i]];
        for (int k = 0; k < r; k++)
            b[i] += s->B[k + r * i] * v[s->dependent[k]];
    }
}

// x (nu) = [B; 1] z + [c; 0].
static void expand(const struct ct_partition *s, double *x, const double *z, const double *c)
{
    const int r = s->rank, f = (int)s->m->nu - r;
    for (int i = 0; i < f; i++)
        x[s->independent[i]] = z[i];
    for (int k = 0; k < r; k++) {
        double sum = c[k];
        for (int i = 0; i < f; i++)
            sum += s->B[k + r * i] * z[i];
        x[s->dependent[k]] = sum;
    }
}

// x (nu) = [B; 1] (B' M B)^-1 B' r + [c; 0], with B, r and c as in the workspace.
static enum ct_eval reduce_and_expand(struct ct_partition *s, const double *M, double *x)
{
    const int f = (int)s->m->nu - s->rank;
    ct_partition_reduce_mass(s, M);
    reduce_force(s, s->b, s->r);
    if (f && !ct_cholesky(s->S, f, f))
        return CT_EVAL_RETRY;
    if (f)
        ct_cholesky_solve(s->b, s->S, f, f, 1, f);
    expand(s, x, s->b, s->c);
    return CT_EVAL_OK;
}

enum ct_eval ct_partition_accelerate(struct ct_partition *s)
{
    const int n = (int)s->m->nu, r = s->rank;
    const double *M = ct_partition_mass(s);
    if (r && !ct_partition_factor(s))
        return CT_EVAL_RETRY;
    for (int k = 0; k < r; k++)
        s->c[k] = -s->m->gam[s->row[k]];
    if (r)
        ct_lu_solve(s->c, s->Jd, s->pivot, r, r, 1, r, false);
    for (int i = 0; i < n; i++) { // Q - M c
        s->r[i] = s->m->Q[i];
        for (int k = 0; k < r; k++)
            s->r[i] -= M[i + n * s->dependent[k]] * s->c[k];
    }
    return reduce_and_expand(s, M, s->a);
}

double ct_partition_cancellation(const struct ct_partition *s)
{
    double size = ct_evaluator_inertia(s->m, (size_t)s->independent[0]);
    for (int k = 0; k < s->rank; k++)
        size += s->B[k] * s->B[k] * ct_evaluator_inertia(s->m, (size_t)s->dependent[k]);
    return s->S[0] * s->S[0] / size; // S is the Cholesky factor
}

void ct_partition_multipliers(struct ct_partition *s)
{
    const int n = (int)s->m->nu, m = (int)s->m->nrow, ld = n > m ? n : m;
    if (!m || ct_partition_solver_multipliers(s))
        return;
    ct_evaluator_dynamics(s->m);
    const double *M = ct_partition_mass(s);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < n; j++)
            s->A[j + n * i] = *ct_partition_J(s, i, j);
    memset(s->d, 0, (size_t)ld * sizeof *s->d);
    for (int i = 0; i < n; i++) {
        s->d[i] = -s->m->Q[i];
        for (int j = 0; j < n; j++)
            s->d[i] += M[i + n * j] * s->a[j];
    }
    ct_lstsq_of_rank(s->d, s->A, n, m, n, ct_rank_tolerance, s->rank, s->iwork, s->work);
    memcpy(s->lam, s->d, (size_t)m * sizeof *s->lam);
}

void ct_partition_retained_multipliers(struct ct_partition *s, double *lam)
{
    const int n = (int)s->m->nu, r = s->rank;
    for (int i = 0; i < r; i++) {
        const int d = s->dependent[i];
        lam[i] = -s->m->Q[d];
        for (int j = 0; j < n; j++)
            lam[i] += s->M[d + n * j] * s->a[j];
    }
    if (r)
        ct_lu_solve(lam, s->Jd, s->pivot, r, r, 1, r, true);
}

struct ct_null_space {
    struct ct_partition *s;
    struct ct_sparse_rows A; // J'
    struct ct_damped *factors;
};

struct ct_null_space *ct_null_space_create(struct ct_arena *a, struct ct_partition *s)
{
    const size_t nu = s->m->nu, nrow = s->m->nrow;
    struct ct_null_space *v = CT_NEW(a, struct ct_null_space);
    int *column = CT_NEWN(a, int, nrow + 1);
    double *value = CT_NEWN(a, double, nrow + 1);
    *v = (struct ct_null_space){.s = s, .A = {.arena = a}, .factors = ct_damped_create(a)};
    for (size_t k = 0; k < nu; k++) {
        size_t n = 0;
        for (size_t i = 0; i < nrow; i++)
            if (s->m->J[i + nrow * k] != 0) {
                column[n] = (int)i;
                value[n++] = s->m->J[i + nrow * k];
            }
        ct_sparse_rows_add(&v->A, column, value, n, 1);
    }
    // directions with singular values below the rank tolerance are excluded from solutions
    const double least = s->m->is_inexact ? ct_data_tolerance : ct_rank_tolerance;
    const double size = ct_sparse_rows_largest_column(&v->A, nu, nrow, value);
    ct_damped_factor(v->factors, &v->A, nu, nu, nrow, least * (size > 0 ? size : 1));
    return v;
}

void ct_null_space_vector(struct ct_null_space *v, int row, double *z)
{
    // z minus the least-squares solution x of J' x = J' z; the second pass removes the error of
    // the damping
    struct ct_partition *s = v->s;
    const size_t nu = s->m->nu, nrow = s->m->nrow;
    memset(z, 0, nrow * sizeof *z);
    z[row] = 1;
    for (int i = 0; i < 2; i++) {
        ct_sparse_rows_times(s->d, &v->A, nu, z);
        ct_damped_solve(v->factors, s->d, s->d);
        ct_vector_add(z, -1, s->d, nrow);
    }
}

void ct_partition_uniqueness(struct ct_partition *s, struct ct_null_space *v)
{
    // The entry is the squared length of the unit vector's projection on null(J'): 0 to
    // round-off where the multiplier is unique, else usually of order one.
    for (int k = 0; k < (int)s->m->nrow; k++) {
        ct_null_space_vector(v, k, s->r);
        s->is_unique[k] = fabs(s->r[k]) < CT_HALF_DIGITS;
    }
}

enum ct_eval ct_partition_impulse(struct ct_partition *s, const double *W, const double *w,
                                  double *u)
{
    // with u+ = [B; 1] z + [c; 0]: B' W B z = B' (w - W c)
    const int n = (int)s->m->nu, r = s->rank;
    ct_evaluator_constraint(s->m);
    if (r && !ct_partition_factor(s))
        return CT_EVAL_RETRY;
    for (int k = 0; k < r; k++) { // J_d c = -Phi_t = -(v - J u), u as the evaluator has it
        double driven = s->m->v[s->row[k]];
        for (int j = 0; j < n; j++)
            driven -= *ct_partition_J(s, s->row[k], j) * s->m->input[s->m->at_u + j];
        s->c[k] = -driven;
    }
    if (r)
        ct_lu_solve(s->c, s->Jd, s->pivot, r, r, 1, r, false);
    for (int i = 0; i < n; i++) {
        s->r[i] = w[i];
        for (int k = 0; k < r; k++)
            s->r[i] -= W[i + n * s->dependent[k]] * s->c[k];
    }
    return reduce_and_expand(s, W, u);
}
