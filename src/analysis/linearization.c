// See linearization.h.
#include "analysis/linearization.h"
#include "analysis/sparse_linearization.h"
#include "numeric/dense.h"
#include "solve/constraint/partition_conditioning.h"
#include "solve/evaluator/switch_state.h"

#include "formulate/formulate.h"

#include <math.h>
#include <string.h>

// Derived: second derivatives of large beams lose six digits.
static const double symmetric = 1e-9; // relative to the largest entries: limit of asymmetry
// Limit: with a message.
enum { MOST_NEWTON = 30 };

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

struct ct_linear *ct_linear_create(struct ct_ctx *ctx, struct ct_arena *arena,
                                   struct ct_evaluator *m)
{
    struct ct_linear *l = CT_NEW(arena, struct ct_linear);
    const size_t n = m->nu + 1, r = m->nrow + 1;
    *l = (struct ct_linear){.m = m, .ctx = ctx, .arena = arena};
    l->nu = (int)m->nu;
    l->nrow = (int)m->nrow;
    l->y = CT_NEWN(arena, double, m->nq + n + 1);
    double **const vector[] = {&l->a, &l->a0, &l->force, &l->scale, &l->r};
    for (size_t i = 0; i < COUNT(vector); i++)
        *vector[i] = CT_NEWN(arena, double, n);
    l->lam = CT_NEWN(arena, double, r);
    return l;
}

// Allocates the dense matrices, once it is known that they are needed.
static void reserve(struct ct_linear *l)
{
    struct ct_arena *a = l->arena;
    const size_t n = (size_t)l->nu + 1, r = (size_t)l->nrow + 1, k = larger(n, r);
    if (l->work)
        return;
    double **const square[]
        = {&l->M, &l->C, &l->K, &l->Z, &l->X, &l->X2, &l->G, &l->Mr, &l->Cr, &l->Kr};
    for (size_t i = 0; i < COUNT(square); i++)
        *square[i] = CT_NEWN(a, double, n *n);
    double **const rows[] = {&l->J, &l->D, &l->D2};
    for (size_t i = 0; i < COUNT(rows); i++)
        *rows[i] = CT_NEWN(a, double, n *r);
    double **const largest[] = {&l->Jd, &l->A, &l->b};
    for (size_t i = 0; i < COUNT(largest); i++)
        *largest[i] = CT_NEWN(a, double, k *k);
    int **const indices[]
        = {&l->row, &l->dependent, &l->independent, &l->iwork, &l->pivot, &l->column};
    for (size_t i = 0; i < COUNT(indices); i++)
        *indices[i] = CT_NEWN(a, int, k);
    const int kk = (int)k;
    l->d = CT_NEWN(a, double, k);
    l->work = CT_NEWN(a, double, larger(ct_lstsq_work(kk, kk), ct_qr_pivot_work(kk, kk)) + k);
}

static bool is_finite(const double *v, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(v[i]))
            return false;
    return true;
}

// ---- the state -----------------------------------------------------------------------------

// d (nu, out): the vector of least norm with J d = -r; J is that of the evaluator.
static void shortest(struct ct_linear *l, double *d, const double *r)
{
    const size_t n = (size_t)l->nu, m = (size_t)l->nrow;
    if (l->nu > CT_MOST_DENSE && ct_point_shortest(l, d, r))
        return;
    reserve(l);
    memcpy(l->A, l->m->J, n * m * sizeof *l->A);
    memset(l->d, 0, larger(n, m) * sizeof *l->d);
    for (size_t i = 0; i < m; i++)
        l->d[i] = -r[i];
    ct_lstsq(l->d, l->A, l->nrow, l->nu, l->nrow, ct_rank_tolerance, l->iwork, l->work);
    memcpy(d, l->d, n * sizeof *d);
}

static void enter(struct ct_linear *l)
{
    struct ct_evaluator *m = l->m;
    ct_evaluator_set(m, l->t, l->y);
    ct_switches_start(m, l->t, l->y, NULL, NULL);
    ct_memory_update(m);
}

bool ct_linear_close(struct ct_linear *l)
{
    struct ct_evaluator *m = l->m;
    double before = INFINITY;
    enter(l);
    if (!l->nrow || !l->nu)
        return true;
    for (int i = 0; i < MOST_NEWTON; i++) {
        ct_evaluator_constraint(m);
        const double left = ct_vector_max_norm(m->phi, m->nrow);
        // Definition: the tolerance of assembly.
        if (!isfinite(left) || (left >= before / 2 && before > 1e-9))
            return false;
        if (left == 0 || left >= before / 2) // round-off
            break;
        before = left;
        shortest(l, l->r, m->phi);
        ct_evaluator_retract(m, l->y, l->r);
        enter(l);
    }
    // Definition: the tolerance of assembly.
    if (!(ct_vector_max_norm(m->phi, m->nrow) < 1e-9)) // [m, rad] the loops do not close
        return false;
    if (ct_vector_max_norm(m->v, m->nrow) == 0)
        return true;
    shortest(l, l->r, m->v);
    for (int k = 0; k < l->nu; k++)
        l->y[m->nq + (size_t)k] += l->r[k];
    enter(l);
    return true;
}

struct ct_kept_state ct_kept_state_create(const struct ct_linear *l)
{
    const struct ct_evaluator *m = l->m;
    return (struct ct_kept_state){.y = CT_NEWN(l->arena, double, m->nq + m->nu + 1),
                                  .lam = CT_NEWN(l->arena, double, m->nrow + 1),
                                  .memory = CT_NEWN(l->arena, double, m->e->nmemory + 1)};
}

void ct_linear_keep(const struct ct_linear *l, struct ct_kept_state *out)
{
    const struct ct_evaluator *m = l->m;
    memcpy(out->y, l->y, (m->nq + m->nu + 1) * sizeof *l->y);
    memcpy(out->lam, l->lam, m->nrow * sizeof *l->lam);
    memcpy(out->memory, m->input + m->at_memory, m->e->nmemory * sizeof *out->memory);
}

void ct_linear_go_back(struct ct_linear *l, const struct ct_kept_state *to)
{
    const struct ct_evaluator *m = l->m;
    memcpy(l->y, to->y, (m->nq + m->nu + 1) * sizeof *l->y);
    memcpy(l->lam, to->lam, m->nrow * sizeof *l->lam);
    memcpy(m->input + m->at_memory, to->memory, m->e->nmemory * sizeof *to->memory);
}

void ct_linear_retract(struct ct_linear *l, const double *dq)
{
    const struct ct_equations *e = l->m->e;
    ct_evaluator_retract(l->m, l->y, dq);
    for (size_t k = e->nmotion; k < e->nu; k++)
        l->y[e->nq + k] += dq[k];
}

// ---- matrices -------------------------------------------------------------------------------

static const double *scatter(double *A, size_t n, size_t nu, const struct ct_slope *s,
                             size_t ns, const double *value)
{
    memset(A, 0, n * nu * sizeof *A);
    for (size_t i = 0; i < ns; i++)
        A[s[i].row + n * s[i].direction] = value[i];
    return value + ns;
}

static void put_in(const struct ct_linear *l, const double *u, const double *a,
                   const double *lam)
{
    const struct ct_evaluator *m = l->m;
    memcpy(m->input + m->at_u, u, m->nu * sizeof *u);
    memcpy(m->input + m->at_a, a, m->nu * sizeof *a);
    memcpy(m->input + m->at_lam, lam, m->nrow * sizeof *lam);
}

// D = d(J u)/dq at the speeds u. J u is linear in u.
static void speed_slopes(struct ct_linear *l, double *D, const double *u)
{
    const struct ct_residual *f = l->m->e->residual;
    put_in(l, u, l->a, l->lam);
    ct_evaluator_tangent(l->m);
    scatter(D, (size_t)l->nrow, (size_t)l->nu, f->dv, f->ndv,
            l->m->slopes + f->ndq + f->ndu + f->nda + f->ndk);
}

// A state z of the model takes the place of a position: the coefficient of z' moves from M to
// C, and that of z from C to K (nu x nu).
static void states_as_coordinates(const struct ct_equations *e, double *K, double *C, double *M)
{
    for (size_t k = e->nmotion; k < e->nu; k++)
        ct_state_take_as_place(K + e->nu * k, C + e->nu * k, M + e->nu * k, e->nu);
}

// M, C, K, J, D at the state, with its accelerations and multipliers.
static bool slopes(struct ct_linear *l)
{
    const struct ct_evaluator *m = l->m;
    const struct ct_residual *f = m->e->residual;
    const double *u = l->y + m->nq;
    const size_t nu = m->nu, nrow = m->nrow;
    // derivatives of J a replace those of J u; only the latter contain the terms of drivers
    if (nrow) {
        speed_slopes(l, l->D2, l->a);
        memset(l->b, 0, nu * sizeof *l->b);
        speed_slopes(l, l->D, l->b);
        for (size_t i = 0; i < nu * nrow; i++)
            l->D2[i] -= l->D[i];
    }
    put_in(l, u, l->a, l->lam);
    ct_evaluator_tangent(l->m);
    if (!is_finite(m->slopes, m->nslope))
        return ct_error(l->ctx, (struct ct_mark){.file = m->model->file}, CT_E_SINGULAR,
                        "the equations have no finite derivatives at this configuration");
    const double *value = ct_evaluator_scatter(m, l->K, l->C, l->M);
    states_as_coordinates(m->e, l->K, l->C, l->M);
    value = scatter(l->D, nrow, nu, f->dv, f->ndv, value);
    memset(l->J, 0, nrow * nu * sizeof *l->J);
    for (size_t i = 0; i < m->e->nJ; i++)
        l->J[(size_t)m->e->J[i].row + nrow * (size_t)m->e->J[i].column] = value[i];
    return true;
}

// ---- independent speeds ---------------------------------------------------------------------

static void choose(struct ct_linear *l, const double *J)
{
    const int n = l->nu, m = l->nrow;
    ct_evaluator_measure_rows(l->m);
    l->rank
        = ct_evaluator_order_rows(l->m, J, l->m->rank_tolerance, l->row, l->A, l->d, l->work);
    const int r = l->rank;
    for (int i = 0; i < r; i++)
        for (int j = 0; j < n; j++)
            l->A[i + r * j] = J[l->row[i] + m * j];
    if (r)
        ct_qr_pivot(l->A, l->column, l->d, r, n, r, 0, l->work);
    int *taken = l->iwork;
    memset(taken, 0, (size_t)n * sizeof *taken);
    for (int i = 0; i < r; i++) {
        l->dependent[i] = l->column[i];
        taken[l->column[i]] = 1;
    }
    l->nfree = 0;
    for (int j = 0; j < n; j++) // in the order of the speeds
        if (!taken[j])
            l->independent[l->nfree++] = j;
}

// Rows of W (nu x nfree, out) at the dependent speeds: -J_d^-1 R, with R (nrow x nfree).
static void solve_dependent(struct ct_linear *l, double *W, const double *R)
{
    const int n = l->nu, m = l->nrow, r = l->rank, f = l->nfree;
    for (int j = 0; j < f; j++) {
        for (int i = 0; i < r; i++)
            l->d[i] = -R[l->row[i] + m * j];
        if (r)
            ct_lu_solve(l->d, l->Jd, l->pivot, r, r, 1, r, false);
        for (int i = 0; i < r; i++)
            W[l->dependent[i] + n * j] = l->d[i];
    }
}

static bool factor_dependent(struct ct_linear *l, const double *J)
{
    const int m = l->nrow, r = l->rank;
    for (int j = 0; j < r; j++)
        for (int i = 0; i < r; i++)
            l->Jd[i + r * j] = J[l->row[i] + m * l->dependent[j]];
    return !r || ct_lu(l->Jd, l->pivot, r, r);
}

// Z (nu x nfree), a basis of the null space of J with unit rows at the independent speeds.
static bool null_space(struct ct_linear *l, const double *J)
{
    const int n = l->nu, m = l->nrow, f = l->nfree;
    if (!factor_dependent(l, J))
        return false;
    memset(l->Z, 0, (size_t)n * (size_t)f * sizeof *l->Z);
    for (int j = 0; j < f; j++) {
        l->Z[l->independent[j] + n * j] = 1;
        for (int i = 0; i < m; i++)
            l->b[i + m * j] = J[i + m * l->independent[j]];
    }
    solve_dependent(l, l->Z, l->b);
    return true;
}

void ct_linear_expand(const struct ct_linear *l, double *dq, const double *y)
{
    ct_matrix_multiply(dq, l->Z, y, l->nu, l->nfree, 1);
}

void ct_linear_project(const struct ct_linear *l, double *v, const double *f)
{
    ct_matrix_multiply_transposed(v, l->Z, f, l->nfree, l->nu, 1);
}

// G = (E Z) at the independent speeds. It comes from rotation vectors: in axes that turn with
// the angular velocity w, a rotation vector th has the rate dw + th x w.
static void turning_chart(struct ct_linear *l)
{
    const double *w = l->y + l->m->nq;
    const int n = l->nu, f = l->nfree;
    double *EZ = l->b;
    memset(EZ, 0, (size_t)n * (size_t)f * sizeof *EZ);
    for (int k = 0; k < n; k++) {
        if (l->m->e->u[k].q >= 0 || ct_speed_is_state(l->m->e, (size_t)k))
            continue;
        for (int j = 0; j < f; j++) {
            const double *th = l->Z + k + (size_t)n * (size_t)j;
            double *out = EZ + k + (size_t)n * (size_t)j;
            out[0] = th[1] * w[k + 2] - th[2] * w[k + 1];
            out[1] = th[2] * w[k] - th[0] * w[k + 2];
            out[2] = th[0] * w[k + 1] - th[1] * w[k];
        }
        k += 2;
    }
    for (int j = 0; j < f; j++)
        for (int i = 0; i < f; i++)
            l->G[i + f * j] = EZ[l->independent[i] + n * j];
}

// out (nfree x nfree) += Z' A W for A (nu x nu), W (nu x nfree)
static void add_reduced(struct ct_linear *l, double *out, const double *A, const double *W)
{
    const int n = l->nu, f = l->nfree;
    ct_matrix_multiply(l->b, A, W, n, n, f);
    for (int j = 0; j < f; j++)
        for (int i = 0; i < f; i++) {
            double sum = 0;
            for (int k = 0; k < n; k++)
                sum += l->Z[k + n * i] * l->b[k + n * j];
            out[i + f * j] += sum;
        }
}

static void reduce(struct ct_linear *l)
{
    const int n = l->nu, f = l->nfree, m = l->nrow;
    const size_t nf = (size_t)n * (size_t)f, ff = (size_t)f * (size_t)f;
    memset(l->X, 0, nf * sizeof *l->X);
    memset(l->X2, 0, nf * sizeof *l->X2);
    if (m) {
        ct_matrix_multiply(l->b, l->D, l->Z, m, n, f);
        solve_dependent(l, l->X, l->b);
        ct_matrix_multiply(l->b, l->D2, l->Z, m, n, f);
        solve_dependent(l, l->X2, l->b);
    }
    turning_chart(l);
    if (!m) { // Z = 1: all speeds are independent, in their order
        memcpy(l->Mr, l->M, ff * sizeof *l->Mr);
        memcpy(l->Cr, l->C, ff * sizeof *l->Cr);
        memcpy(l->Kr, l->K, ff * sizeof *l->Kr);
        l->is_moving = ct_vector_max_norm(l->G, ff) > 0;
        return;
    }
    double *const all[] = {l->Mr, l->Cr, l->Kr};
    for (size_t i = 0; i < COUNT(all); i++)
        memset(all[i], 0, ff * sizeof *all[i]);
    add_reduced(l, l->Mr, l->M, l->Z);
    add_reduced(l, l->Cr, l->C, l->Z);
    add_reduced(l, l->Cr, l->M, l->X);
    add_reduced(l, l->Kr, l->K, l->Z);
    add_reduced(l, l->Kr, l->C, l->X);
    ct_matrix_multiply(l->A, l->X, l->G, n, f, f); // da = Z w' + X w + (X2 + X G) y
    for (size_t i = 0; i < nf; i++)
        l->X2[i] += l->A[i];
    add_reduced(l, l->Kr, l->M, l->X2);
    l->is_moving = ct_vector_max_norm(l->X, nf) > 0 || ct_vector_max_norm(l->X2, nf) > 0
                || ct_vector_max_norm(l->G, ff) > 0;
}

// ---- forces and multipliers ----------------------------------------------------------------

// r (nu, out) = M a - Q - J' lam
static void residual(struct ct_linear *l, double *r, const double *a, const double *lam)
{
    put_in(l, l->y + l->m->nq, a, lam);
    ct_program_run(&l->m->residual, l->m->input);
    memcpy(r, l->m->residual.out, (size_t)l->nu * sizeof *r);
}

// Multipliers of least norm with r (nu) = J' lam, and the sums of force magnitudes of each row.
static void multipliers(struct ct_linear *l, const double *r)
{
    const int n = l->nu, m = l->nrow;
    memset(l->lam, 0, (size_t)m * sizeof *l->lam);
    if (n && m) {
        for (int i = 0; i < m; i++)
            for (int j = 0; j < n; j++)
                l->A[j + n * i] = l->m->J[i + m * j];
        memset(l->d, 0, larger((size_t)n, (size_t)m) * sizeof *l->d);
        memcpy(l->d, r, (size_t)n * sizeof *r);
        ct_lstsq_of_rank(l->d, l->A, n, m, n, ct_rank_tolerance, l->rank, l->iwork, l->work);
        memcpy(l->lam, l->d, (size_t)m * sizeof *l->lam);
    }
    for (int j = 0; j < n; j++) {
        l->scale[j] = fabs(r[j]);
        for (int i = 0; i < m; i++)
            l->scale[j] += fabs(l->m->J[i + m * j] * l->lam[i]);
    }
}

// The first part of ct_linear_rest and ct_linear_move: J, Z and the accelerations that the
// drivers prescribe.
static bool begin(struct ct_linear *l)
{
    struct ct_evaluator *m = l->m;
    reserve(l);
    enter(l);
    ct_evaluator_dynamics(m);
    ct_evaluator_constraint(m);
    if (!is_finite(m->J, m->nrow * m->nu) || !is_finite(m->motion.out, m->motion.nout))
        return ct_error(l->ctx, (struct ct_mark){.file = m->model->file}, CT_E_SINGULAR,
                        "the equations have no finite values at this configuration");
    choose(l, m->J);
    if (!null_space(l, m->J))
        return ct_error(l->ctx, (struct ct_mark){.file = m->model->file}, CT_E_SINGULAR,
                        "the constraints are singular at this configuration");
    memset(l->a0, 0, (size_t)l->nu * sizeof *l->a0);
    if (l->nrow && l->nu)
        shortest(l, l->a0, m->gam);
    return true;
}

static bool finish(struct ct_linear *l)
{
    residual(l, l->r, l->a,
             l->lam); // lam is zero: r is the force that multipliers must balance
    multipliers(l, l->r);
    ct_linear_project(l, l->force, l->r);
    l->acceleration = ct_vector_max_norm(l->a, (size_t)l->nu);
    if (!slopes(l))
        return false;
    reduce(l);
    return true;
}

bool ct_linear_rest(struct ct_linear *l)
{
    if (!begin(l))
        return false;
    memcpy(l->a, l->a0, (size_t)l->nu * sizeof *l->a);
    memset(l->lam, 0, (size_t)l->nrow * sizeof *l->lam);
    return finish(l);
}

// w (nfree, out): Mr w = -v. Directions without mass stay at rest.
static void accelerate(struct ct_linear *l, double *w, const double *v)
{
    const int f = l->nfree;
    double *M = l->Mr, *scale = l->d, *value = l->r;
    memset(M, 0, (size_t)f * (size_t)f * sizeof *M);
    memset(l->M, 0, (size_t)l->nu * (size_t)l->nu * sizeof *l->M);
    ct_evaluator_fill_mass(l->m, l->M, (size_t)l->nu);
    add_reduced(l, M, l->M, l->Z);
    for (int i = 0; i < f; i++)
        scale[i] = M[i + f * i] > 0 ? 1 / sqrt(M[i + f * i]) : 1;
    for (int j = 0; j < f; j++)
        for (int i = 0; i < f; i++)
            M[i + f * j] *= scale[i] * scale[j];
    ct_symmetric_eigen(value, M, f, f, l->work);
    memset(w, 0, (size_t)f * sizeof *w);
    for (int k = 0; k < f; k++) {
        double along = 0;
        for (int i = 0; i < f; i++)
            along -= M[i + f * k] * scale[i] * v[i];
        for (int i = 0; i < f && value[k] > ct_roundoff(f) * value[f - 1]; i++)
            w[i] += scale[i] * M[i + f * k] * along / value[k];
    }
}

bool ct_linear_move(struct ct_linear *l)
{
    if (!begin(l))
        return false;
    const size_t n = (size_t)l->nu;
    memset(l->lam, 0, (size_t)l->nrow * sizeof *l->lam);
    memcpy(l->a, l->a0, n * sizeof *l->a);
    if (l->nfree) {
        double *w = l->A, *v = w + l->nfree;
        residual(l, l->r, l->a, l->lam);
        ct_linear_project(l, v, l->r);
        accelerate(l, w, v);
        ct_linear_expand(l, l->a, w);
        for (size_t i = 0; i < n; i++)
            l->a[i] += l->a0[i];
    }
    return finish(l);
}

bool ct_linear_is_symmetric(struct ct_arena *a, const double *A, int n)
{
    double *size = CT_NEWN(a, double, n + 1), most = 0;
    for (int j = 0; j < n; j++) {
        size[j] = sqrt(ct_vector_largest(A + (size_t)n * (size_t)j, (size_t)n));
        most = fmax(most, size[j] * size[j]);
    }
    for (int j = 0; j < n; j++)
        for (int i = 0; i < j; i++)
            if (fabs(A[i + n * j] - A[j + n * i])
                > symmetric * size[i] * size[j] + ct_roundoff(n) * most)
                return false;
    return true;
}

int ct_linear_largest_entry(const double *v, const double *w, int n)
{
    int most = 0;
    double size = 0;
    for (int i = 0; i < n; i++) {
        const double here = w ? hypot(v[i], w[i]) : fabs(v[i]);
        if (here > size * (1 + sqrt(DBL_EPSILON))) {
            size = here;
            most = i;
        }
    }
    return most;
}

const char *ct_linear_coordinate(const struct ct_equations *e, struct ct_arena *a, int k)
{
    if (e->u[k].q >= 0)
        return e->q[e->u[k].q].name;
    if (ct_speed_is_state(e, (size_t)k))
        return e->u[k].name;
    const char *dot = strrchr(e->u[k].name, '.');
    const size_t n = dot ? (size_t)(dot - e->u[k].name) : strlen(e->u[k].name);
    int start = k; // first of the three angular velocities
    while (start > 0 && e->u[start - 1].q < 0)
        start--;
    return ct_arena_printf(a, "%.*s.turn%d", (int)n, e->u[k].name, (k - start) % 3 + 1);
}
