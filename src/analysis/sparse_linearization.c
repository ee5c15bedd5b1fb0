// See sparse_linearization.h.
#include "analysis/sparse_linearization.h"
#include "formulate/build.h"
#include "formulate/residual/residual.h"

#include <math.h>
#include <string.h>

struct ct_point *ct_point_create(struct ct_linear *l)
{
    struct ct_point *p = CT_NEW(l->arena, struct ct_point);
    const struct ct_equations *e = l->m->e;
    size_t nplace;
    p->l = l;
    p->r = CT_NEWN(l->arena, double, e->nu + 1);
    p->nseed = ct_residual_seeds(e->build, l->arena, &p->seed, &nplace);
    p->value = CT_NEWN(l->arena, double, e->x->nsym + 1);
    p->phi = l->m->constraint.out;
    p->v = p->phi + e->nrow;
    p->J = p->v + e->nrow;
    return p;
}

struct ct_point *ct_point_here(struct ct_linear *l)
{
    if (!l->point)
        l->point = ct_point_create(l);
    return l->point;
}

// Picks the entries with respect to one level (position, speed or acceleration) from all
// entries, with columns counted from 0.
static size_t pick(struct ct_arena *a, const struct ct_number *all, size_t n, size_t level,
                   size_t nu, struct ct_number **out)
{
    size_t nout = 0;
    for (size_t i = 0; i < n; i++)
        nout += all[i].direction / nu == level;
    *out = CT_NEWN(a, struct ct_number, nout + 1);
    nout = 0;
    for (size_t i = 0; i < n; i++)
        if (all[i].direction / nu == level) {
            (*out)[nout] = all[i];
            (*out)[nout++].direction %= (uint32_t)nu;
        }
    return nout;
}

static bool is_finite(const struct ct_point *p, const struct ct_number *all, size_t n)
{
    const struct ct_evaluator *m = p->l->m;
    for (size_t i = 0; i < n; i++)
        if (!isfinite(all[i].value))
            return false;
    for (size_t i = 0; i < m->nu; i++)
        if (!isfinite(p->r[i]))
            return false;
    for (size_t i = 0; i < m->constraint.nout; i++)
        if (!isfinite(m->constraint.out[i]))
            return false;
    return true;
}

bool ct_point_evaluate(struct ct_point *p)
{
    struct ct_linear *l = p->l;
    struct ct_evaluator *m = l->m;
    const struct ct_equations *e = m->e;
    struct ct_number *all;
    if (p->a)
        ct_arena_destroy(p->a);
    p->a = ct_arena_create_under(l->arena);
    struct ct_arena *scratch = ct_arena_create_under(l->arena);
    ct_evaluator_set(m, l->t, l->y);
    memcpy(m->input + m->at_a, l->a, m->nu * sizeof *l->a);
    memcpy(m->input + m->at_lam, l->lam, m->nrow * sizeof *l->lam);
    ct_program_run(&m->constraint, m->input);
    ct_evaluator_values(m, e->x, p->value);
    const size_t n = ct_ex_jacobian_at(e->x, scratch, scratch, e->residual->r, m->nu, p->seed,
                                       p->nseed, p->value, p->r, &all);
    if (m->nu) {
        p->nK = pick(p->a, all, n, 0, m->nu, &p->K);
        p->nC = pick(p->a, all, n, 1, m->nu, &p->C);
        p->nM = pick(p->a, all, n, 2, m->nu, &p->M);
    }
    const bool ok = is_finite(p, all, n);
    ct_arena_destroy(scratch);
    return ok;
}

void ct_point_apply(double *y, const struct ct_number *A, size_t n, const double *x, size_t nu)
{
    memset(y, 0, nu * sizeof *y);
    for (size_t i = 0; i < n; i++)
        y[A[i].row] += A[i].value * x[A[i].direction];
}

double ct_point_largest(const struct ct_number *A, size_t n)
{
    double max = 0;
    for (size_t i = 0; i < n; i++)
        max = fmax(max, fabs(A[i].value));
    return max;
}

// ---- factors --------------------------------------------------------------------------------

struct entries {
    struct ct_arena *a;
    int *row, *column;
    double *value;
    size_t n;
};

static struct entries reserve(struct ct_arena *a, size_t n)
{
    return (struct entries){.a = a,
                            .row = CT_NEWN(a, int, n + 1),
                            .column = CT_NEWN(a, int, n + 1),
                            .value = CT_NEWN(a, double, n + 1)};
}

static void add(struct entries *s, size_t row, size_t column, double value)
{
    s->row[s->n] = (int)row;
    s->column[s->n] = (int)column;
    s->value[s->n++] = value;
}

static void add_rows(struct entries *s, const struct ct_evaluator *m)
{
    const double *J = m->constraint.out + 2 * m->nrow;
    for (size_t i = 0; i < m->e->nJ; i++) {
        const size_t row = m->nu + (size_t)m->e->J[i].row, column = (size_t)m->e->J[i].column;
        add(s, row, column, J[i]);
        add(s, column, row, J[i]);
    }
}

static struct ct_sparse *factor(struct entries *s, size_t n, size_t nrow)
{
    const enum ct_sparse_order order = nrow ? CT_SPARSE_ANY : CT_SPARSE_DIAGONAL;
    struct ct_sparse *matrix = ct_sparse_create(s->a, (int)n, s->row, s->column, s->n, order);
    return matrix && ct_sparse_factor(matrix, s->value) ? matrix : NULL;
}

struct ct_sparse *ct_point_factor(struct ct_point *p, double stiffness, double mass)
{
    const struct ct_evaluator *m = p->l->m;
    const size_t n = m->nu + m->nrow;
    struct entries s = reserve(p->a, p->nK + p->nM + 2 * m->e->nJ + n);
    for (size_t i = 0; i < p->nK && stiffness != 0; i++)
        add(&s, p->K[i].row, p->K[i].direction, stiffness * p->K[i].value);
    for (size_t i = 0; i < p->nM && mass != 0; i++)
        add(&s, p->M[i].row, p->M[i].direction, mass * p->M[i].value);
    add_rows(&s, m);
    // a zero entry on the diagonal, so that every pivot has a place
    for (size_t i = 0; i < n; i++)
        add(&s, i, i, 0);
    return factor(&s, n, m->nrow);
}

bool ct_point_shortest(struct ct_linear *l, double *d, const double *r)
{
    const struct ct_evaluator *m = l->m;
    const size_t n = m->nu + m->nrow;
    struct ct_arena *a = ct_arena_create_under(l->arena);
    struct entries s = reserve(a, m->nu + 2 * m->e->nJ + m->nrow);
    for (size_t i = 0; i < m->nu; i++)
        add(&s, i, i, 1);
    add_rows(&s, m);
    for (size_t i = 0; i < m->nrow; i++)
        add(&s, m->nu + i, m->nu + i, 0);
    struct ct_sparse *matrix = factor(&s, n, m->nrow);
    if (matrix) {
        double *b = CT_NEWN(a, double, n), *x = CT_NEWN(a, double, n);
        bool refined = true;
        for (size_t i = 0; i < m->nrow; i++)
            b[m->nu + i] = -r[i];
        ct_sparse_solve(matrix, x, b, &refined);
        memcpy(d, x, m->nu * sizeof *d);
    }
    ct_arena_destroy(a);
    return matrix != NULL;
}
