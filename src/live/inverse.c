// Inverse dynamics: efforts that give prescribed accelerations. See live.h.
//
//     M u' = Q + J' lam + S tau,    P S tau = P (M u' - Q),    P = 1 - J^+ J
//
// S has a column for each speed along which an effort acts. The projector P eliminates the
// multipliers; the remaining equations are solved for tau by least squares, with least norm if
// the solution is not unique.
#include "live/live.h"

#include "numeric/dense.h"
#include "solve/constraint/partition_conditioning.h"

#include <float.h>
#include <math.h>
#include <string.h>

// A constraint is satisfied by accelerations if its residual is below this, relatively. Derived: the
// square root of eps, as accelerations may come from a plan or another program and have half the
// digits.
static const double allowed_residual = 1.5e-8;

struct inverse {
    struct ct_ctx *ctx;
    struct ct_data *d;
    const double *a;
    double *effort;
    int *speed; // speeds along which efforts act (n)
    int n;
    double *A, *x, *work;
    int *iwork;
};

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

// v (nu) <- P v.
static void project(struct inverse *s, double *v)
{
    const struct ct_evaluator *m = ct_run_evaluator(s->d->sim.run);
    const size_t n = s->d->nu, r = m->nrow;
    memset(s->x, 0, larger(n, r) * sizeof *s->x);
    for (size_t i = 0; i < r; i++)
        s->x[i] = ct_vector_dot(s->d->J + i * n, v, n);
    memcpy(s->A, m->J, n * r * sizeof *s->A);
    ct_lstsq(s->x, s->A, (int)r, (int)n, (int)r, ct_rank_tolerance, s->iwork, s->work);
    for (size_t i = 0; i < n; i++)
        v[i] -= s->x[i];
}

static void list_speeds(struct inverse *s)
{
    const struct ct_equations *e = &s->d->sim.system->equations;
    const struct ct_model *model = &s->d->sim.system->model;
    for (int pass = 0; pass < 2 && !s->n; pass++)
        for (size_t k = 0; k < e->nmotion; k++)
            if (e->u[k].joint >= 0
                && (pass || ct_instance_value(&model->joint[e->u[k].joint], "effort")->given))
                s->speed[s->n++] = (int)k;
}

static bool reserve(struct inverse *s)
{
    struct ct_arena *a = s->d->sim.own.scratch;
    const size_t n = s->d->nu, r = s->d->nrow, k = larger(n, r) + 1;
    s->A = CT_NEWN(a, double, k *k);
    s->x = CT_NEWN(a, double, k);
    s->work = CT_NEWN(a, double, ct_lstsq_work((int)k, (int)k) + k);
    s->iwork = CT_NEWN(a, int, k);
    s->speed = CT_NEWN(a, int, k);
    return true;
}

// Do the constraints allow these accelerations?
static bool are_allowed(const struct inverse *s)
{
    const struct ct_data *d = s->d;
    const struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    for (size_t i = 0; i < d->nrow; i++) {
        double sum = m->gam[i], size = fabs(sum);
        for (size_t k = 0; k < d->nu; k++) {
            sum += d->J[i * d->nu + k] * s->a[k];
            size += fabs(d->J[i * d->nu + k] * s->a[k]);
        }
        if (!(fabs(sum) <= allowed_residual * fmax(size, 1)))
            return ct_error(
                s->ctx, (struct ct_mark){0}, CT_E_INVERSE,
                "the constraint '%s' does not allow these accelerations: it would be "
                "left at %.3g",
                m->e->row[i].name, sum);
    }
    return true;
}

static bool find_in_loops(struct inverse *s, double *b)
{
    struct ct_data *d = s->d;
    const size_t n = d->nu;
    struct ct_arena *a = d->sim.own.scratch;
    if (!are_allowed(s))
        return false;
    list_speeds(s);
    double *PS = CT_NEWN(a, double, n *(size_t)s->n + 1), *kept,
           *tau = CT_NEWN(a, double, n + 1);
    double size = ct_vector_largest(b, n), left = 0;
    for (int k = 0; k < s->n; k++) {
        PS[n * (size_t)k + (size_t)s->speed[k]] = 1;
        project(s, PS + n * (size_t)k);
    }
    project(s, b);
    kept = CT_NEWN(a, double, n *(size_t)s->n + 1);
    memcpy(kept, PS, n * (size_t)s->n * sizeof *kept);
    memcpy(tau, b, n * sizeof *tau);
    const int rank
        = s->n ? ct_lstsq(tau, PS, (int)n, s->n, (int)n, ct_rank_tolerance, s->iwork, s->work)
               : 0;
    for (size_t i = 0; i < n; i++) {
        double sum = -b[i];
        for (int k = 0; k < s->n; k++)
            sum += kept[i + n * (size_t)k] * tau[k];
        left = fmax(left, fabs(sum));
    }
    memset(s->effort, 0, n * sizeof *s->effort);
    for (int k = 0; k < s->n; k++)
        s->effort[s->speed[k]] = tau[k];
    if (left > allowed_residual * size)
        return ct_error(s->ctx, (struct ct_mark){0}, CT_E_INVERSE,
                        "efforts of %d joint coordinates do not give these accelerations: a "
                        "generalised force of %.3g is left of %.3g",
                        s->n, left, size);
    if (rank < s->n)
        ct_warning(s->ctx, (struct ct_mark){0}, 0,
                   "%d efforts have rank %d: they are not unique, and the smallest are given",
                   s->n, rank);
    return true;
}

static bool find(void *task)
{
    struct inverse *s = task;
    struct ct_data *d = s->d;
    const size_t n = d->nu;
    size_t rows, columns;
    const double *M = ct_data_get(s->ctx, d, CT_Q_M, &rows, &columns);
    if (!M || !reserve(s))
        return false;
    const double *Q = ct_run_evaluator(d->sim.run)->Q;
    double *b = CT_NEWN(d->sim.own.scratch, double, n + 1);
    for (size_t i = 0; i < n; i++)
        b[i] = ct_vector_dot(M + i * n, s->a, n) - Q[i];
    if (d->nrow)
        return find_in_loops(s, b);
    memcpy(s->effort, b, n * sizeof *b);
    return true;
}

bool ct_data_inverse(struct ct_ctx *ctx, struct ct_data *data, const double *acceleration,
                     double *effort)
{
    struct inverse s = {.ctx = ctx, .d = data, .a = acceleration, .effort = effort};
    if (!ctx || !data || !acceleration || !effort)
        return false;
    const bool ok = ct_enter(ctx, find, &s);
    ct_arena_clear(data->sim.own.scratch);
    return ok;
}
