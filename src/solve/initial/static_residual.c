// See static_residual.h.
#include "solve/initial/static_residual.h"
#include "formulate/residual/residual.h"
#include "numeric/dense.h"
#include "solve/constraint/partition_conditioning.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Newton's method ends at a correction of this fraction of the largest coordinate.
// Derived: 450 units of round-off.
static const double newton_tolerance = 1e-13;
// Limit: of the iteration and of one step; without convergence there is an error
enum { MOST_STEPS = 50, MOST_HALVINGS = 30 };

// ---- rows ---------------------------------------------------------------------------------------

bool ct_basis_extend(struct ct_basis *s, double *v)
{
    double before = 0, after = 0;
    for (size_t i = 0; i < s->n; i++)
        before += v[i] * v[i];
    for (size_t twice = 0; twice < 2; twice++)
        for (size_t k = 0; k < s->count; k++) {
            const double *w = s->v + s->n * k;
            double along = 0;
            for (size_t i = 0; i < s->n; i++)
                along += w[i] * v[i];
            for (size_t i = 0; i < s->n; i++)
                v[i] -= along * w[i];
        }
    for (size_t i = 0; i < s->n; i++)
        after += v[i] * v[i];
    if (!(after > ct_rank_tolerance * ct_rank_tolerance * before) || s->count == s->n)
        return false;
    double *out = s->v + s->n * s->count++;
    for (size_t i = 0; i < s->n; i++)
        out[i] = v[i] / sqrt(after);
    return true;
}

// Rows that are independent in the unknowns, by QR with column pivoting of the transpose.
static void choose_rows(struct ct_static_residual *s, struct ct_arena *a)
{
    const size_t m = s->e->nrow, n = s->n;
    double *A = CT_NEWN(a, double, m *n + 1), *tau = CT_NEWN(a, double, m + n);
    double *work = CT_NEWN(a, double, ct_qr_pivot_work((int)n, (int)m));
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < n; k++)
            A[k + n * i] = s->m->J[i + m * (size_t)s->u[k]] * s->m->speed_size[s->u[k]]
                         / s->m->row_size[i];
    ct_qr_pivot(A, s->row, tau, (int)n, (int)m, (int)n, 0, work);
    s->nlam = 0;
    while (s->nlam < (m < n ? m : n) && fabs(A[s->nlam + n * s->nlam]) > s->m->rank_tolerance)
        s->nlam++;
    for (size_t i = 0; i < m; i++)
        s->lam_index[i] = -1;
    for (size_t i = 0; i < s->nlam; i++)
        s->lam_index[s->row[i]] = (int)i;
}

void ct_static_residual_choose_rows(struct ct_static_residual *s, struct ct_arena *a)
{
    ct_evaluator_set(s->m, 0, s->y);
    ct_evaluator_constraint(s->m);
    ct_evaluator_measure_rows(s->m);
    choose_rows(s, a);
    for (size_t i = 0; i < s->e->nrow; i++)
        if (s->lam_index[i] < 0)
            s->lam[i] = 0;
}

// ---- equations ----------------------------------------------------------------------------------

void ct_static_residual_derive(struct ct_static_residual *s, struct ct_arena *a)
{
    const struct ct_equations *e = s->e;
    struct ct_exs *x = e->x;
    ct_ex *f = CT_NEWN(a, ct_ex, s->n + 1);
    ct_ex *from = CT_NEWN(a, ct_ex, e->nu + 1), *zero = CT_NEWN(a, ct_ex, e->nu + 1);
    for (size_t k = 0; k < e->nu; k++)
        from[k] = e->u[k].symbol;
    for (size_t i = 0; i < s->n; i++)
        f[i] = e->Q[s->u[i]];
    for (size_t i = 0; i < e->nJ; i++) {
        const int k = s->index[e->J[i].column];
        if (k >= 0)
            f[k] = ct_ex_add(x, f[k], ct_ex_mul(x, e->J[i].value, e->row[e->J[i].row].lam));
    }
    ct_ex_subst_list(x, f, s->n, from, zero, e->nu);
    s->nslope = ct_slopes_derive(e->build, a, f, s->n, &s->m->model->time, 1, &s->slope);
    const size_t nout = s->n + e->nrow + s->nslope;
    ct_ex *out = CT_NEWN(a, ct_ex, nout + 1);
    for (size_t i = 0; i < s->n; i++)
        out[i] = f[i];
    for (size_t i = 0; i < e->nrow; i++)
        out[s->n + i] = e->row[i].phi;
    for (size_t i = 0; i < s->nslope; i++)
        out[s->n + e->nrow + i] = s->slope[i].value;
    ct_evaluator_add_program(a, s->m, x, out, nout, &s->values);
}

void ct_static_residual_evaluate(struct ct_static_residual *s)
{
    ct_evaluator_set(s->m, 0, s->y);
    memcpy(s->m->input + s->m->at_lam, s->lam, s->e->nrow * sizeof *s->lam);
    ct_program_run(&s->values, s->m->input);
}

// Index of the derivative by time: after coordinates, speeds, accelerations and multipliers.
static size_t time_of(const struct ct_static_residual *s)
{
    return 3 * s->e->nu + s->e->nrow;
}

void ct_static_residual_fill(struct ct_static_residual *s)
{
    const size_t n = s->n, size = n + s->nlam, nu = s->e->nu;
    const double *value = s->values.out + n + s->e->nrow;
    memset(s->A, 0, size * size * sizeof *s->A);
    s->stiffness = 0;
    for (size_t i = 0; i < s->nslope; i++)
        if (s->slope[i].direction < nu && s->index[s->slope[i].direction] >= 0) {
            s->A[s->slope[i].row + size * (size_t)s->index[s->slope[i].direction]] = value[i];
            s->stiffness = fmax(s->stiffness, fabs(value[i]));
        }
    s->stiffness = s->stiffness > 0 ? s->stiffness : 1;
    for (size_t i = 0; i < s->nslope; i++) {
        const size_t first = 3 * nu; // after coordinates, speeds, accelerations
        if (s->slope[i].direction < first || s->slope[i].direction == time_of(s))
            continue;
        const int lam = s->lam_index[s->slope[i].direction - first];
        if (lam < 0)
            continue;
        const size_t k = n + (size_t)lam;
        s->A[s->slope[i].row + size * k] = s->A[k + size * s->slope[i].row]
            = s->stiffness * value[i];
    }
}

static bool factor(struct ct_static_residual *s)
{
    const int size = (int)(s->n + s->nlam);
    ct_static_residual_fill(s);
    return ct_lu(s->A, s->pivot, size, size);
}

// Newton correction d of coordinates and multipliers, with the factors of an earlier
// derivative. Returns the largest correction of a coordinate.
static double correction(struct ct_static_residual *s, double *d)
{
    const size_t all = s->n + s->nlam;
    double size = 0;
    memcpy(d, s->values.out, s->n * sizeof *d);
    for (size_t i = 0; i < s->nlam; i++)
        d[s->n + i] = s->stiffness * s->values.out[s->n + (size_t)s->row[i]];
    ct_lu_solve(d, s->A, s->pivot, (int)all, (int)all, 1, (int)all, false);
    for (size_t i = 0; i < s->n; i++)
        size = !(fabs(d[i]) <= size) ? fabs(d[i]) : size;
    return size;
}

static void move(struct ct_static_residual *s, const double *d, double factor)
{
    memset(s->step, 0, s->e->nu * sizeof *s->step);
    for (size_t i = 0; i < s->n; i++)
        s->step[s->u[i]] = -factor * d[i];
    ct_evaluator_retract(s->m, s->y, s->step);
    for (size_t i = 0; i < s->nlam; i++)
        s->lam[s->row[i]] -= factor * s->stiffness * d[s->n + i];
}

// The largest coordinate, at least the root of eps, so that corrections of eps m or rad count
// as zero.
static double largest(const struct ct_static_residual *s)
{
    double size = sqrt(DBL_EPSILON);
    for (size_t i = 0; i < s->n; i++)
        if (s->e->u[s->u[i]].q >= 0)
            size = fmax(size, fabs(s->y[s->e->u[s->u[i]].q]));
    return size;
}

// Save coordinates and multipliers in kept (nq + nrow, out).
static void save_state(const struct ct_static_residual *s, double *kept)
{
    memcpy(kept, s->y, s->m->nq * sizeof *kept);
    memcpy(kept + s->m->nq, s->lam, s->e->nrow * sizeof *kept);
}

static void restore_state(struct ct_static_residual *s, const double *kept)
{
    memcpy(s->y, kept, s->m->nq * sizeof *kept);
    memcpy(s->lam, kept + s->m->nq, s->e->nrow * sizeof *kept);
}

// Is a correction that is not followed by a smaller one round-off? Convergence is quadratic: a
// correction of the root of eps is followed by one of round-off.
static bool is_roundoff(const struct ct_static_residual *s, double size)
{
    return size <= sqrt(DBL_EPSILON) * largest(s);
}

// Newton steps, halved until the next correction with the same derivative is smaller. This
// natural monotonicity test does not depend on the scaling of rows. Source: Deuflhard (2011),
// key deuflhard2011.
static bool iterate_damped(struct ct_static_residual *s, double *kept, double *d, double *next)
{
    for (int step = 0; step < MOST_STEPS; step++) {
        if (!factor(s))
            return false;
        const double size = correction(s, d);
        if (size <= newton_tolerance * largest(s))
            return true;
        save_state(s, kept);
        double part = 1, left = INFINITY;
        for (int half = 0; half < MOST_HALVINGS && !(left < size); half++, part /= 2) {
            restore_state(s, kept);
            move(s, d, part);
            ct_static_residual_evaluate(s);
            left = correction(s, next);
        }
        if (!(left < size)) // converged to round-off, or failed
            return is_roundoff(s, size);
    }
    return false;
}

// Full steps, each smaller than the one before from the second on.
static bool iterate_full(struct ct_static_residual *s, double *d)
{
    double before = INFINITY;
    for (int step = 0; step < MOST_STEPS; step++) {
        if (!factor(s))
            return false;
        const double size = correction(s, d);
        if (size <= newton_tolerance * largest(s))
            return true;
        if (!(size < before))
            return is_roundoff(s, before);
        before = size;
        move(s, d, 1);
        ct_static_residual_evaluate(s);
    }
    return false;
}

// Damped steps can fail for a slender beam: a bending step stretches its axis strongly, so the
// correction with the old derivative is larger, while the new derivative removes the stretch in
// the next step. Full steps are tried then.
bool ct_static_residual_iterate(struct ct_static_residual *s, struct ct_arena *a)
{
    const size_t all = s->n + s->nlam, state = s->m->nq + s->e->nrow;
    double *d = CT_NEWN(a, double, all + 1), *next = CT_NEWN(a, double, all + 1),
           *kept = CT_NEWN(a, double, state + 1), *start = CT_NEWN(a, double, state + 1);
    save_state(s, start);
    ct_static_residual_evaluate(s);
    if (iterate_damped(s, kept, d, next))
        return true;
    restore_state(s, start);
    ct_static_residual_evaluate(s);
    return iterate_full(s, d);
}

struct ct_static_residual ct_static_residual_create(struct ct_arena *a, struct ct_evaluator *m)
{
    const size_t nu = m->nu, nrow = m->nrow, all = nu + nrow;
    return (struct ct_static_residual){.m = m,
                                       .e = m->e,
                                       .u = CT_NEWN(a, int, nu + 1),
                                       .index = CT_NEWN(a, int, nu + 1),
                                       .row = CT_NEWN(a, int, nrow + 1),
                                       .lam_index = CT_NEWN(a, int, nrow + 1),
                                       .y = CT_NEWN(a, double, m->nq + nu + 1),
                                       .lam = CT_NEWN(a, double, nrow + 1),
                                       .A = CT_NEWN(a, double, all *all + 1),
                                       .step = CT_NEWN(a, double, nu + 1),
                                       .pivot = CT_NEWN(a, int, all + 1),
                                       .offset = CT_NEWN(a, double, 4 * m->e->noffset + 1)};
}

bool ct_static_residual_rates(struct ct_static_residual *s, struct ct_arena *a, const double *v,
                              double *u)
{
    const size_t n = s->n, all = n + s->nlam, nu = s->e->nu;
    const double *value = s->values.out + n + s->e->nrow;
    double *b = CT_NEWN(a, double, all + 1);
    ct_static_residual_evaluate(s);
    for (size_t i = 0; i < s->nslope; i++) {
        const struct ct_slope *d = &s->slope[i];
        if (d->direction == time_of(s))
            b[d->row] += value[i];
        else if (d->direction < nu && s->index[d->direction] < 0)
            b[d->row] += value[i] * u[d->direction];
    }
    if (!factor(s))
        return false;
    for (size_t i = 0; i < s->nlam; i++)
        b[n + i] = s->stiffness * v[s->row[i]];
    ct_lu_solve(b, s->A, s->pivot, (int)all, (int)all, 1, (int)all, false);
    for (size_t i = 0; i < n; i++)
        u[s->u[i]] = -b[i];
    return true;
}
