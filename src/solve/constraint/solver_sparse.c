// Sparse solver: equations of systems with loops by sparse LU factors; see solver.h.
//
//     [ M  J' ] [  u'  ]   [  Q   ]
//     [ J  0  ] [ -lam ] = [ -gam ]         J_d d = -Phi,  J_d d = -v
#include "numeric/sparse.h"
#include "solve/constraint/partition_conditioning.h"

#include <math.h>
#include <string.h>

struct sparse_solver {
    struct ct_solver base;
    struct ct_sparse *whole, *Jd;
    double *value, *Jd_value; // in the order of the patterns
    size_t *Jd_from, nJd;     // which entries of J
    int *row_of;              // (nrow) index among the retained rows, or -1
    double *b, *x, *dq, *du;
    double pivot; // smallest over largest pivot of J_d where the order was chosen
};

static struct sparse_solver *sparse_solver_of(struct ct_solver *f)
{
    return (struct sparse_solver *)f; // its first member
}

// Times of the sparse solver, in operations of straight-line code: of a multiplication or
// addition in the factors, of an entry of the factors in factoring and solving, and of an entry
// of the matrix in assembly and in the residual.
// Derived: fitted to measured times of planar and spatial loops, one and many, in joint and in
// body coordinates, with and without beams; all agree within a tenth.
static const double per_operation = 0.7, per_factor = 18, per_value = 36;

// ---- values -------------------------------------------------------------------------------------

// Entries of [M J'; J 0] in the order of the equations' entries; M is stored as one triangle.
// Returns their number. row, column (out) may be NULL.
static size_t fill_whole(const struct sparse_solver *f, const struct ct_evaluator *m, int *row,
                         int *column, double *value)
{
    const struct ct_equations *e = m->e;
    const double *J = m->Q + m->nu;
    size_t n = 0;
    for (int side = 0; side < 2; side++) {
        for (size_t i = 0; i < e->nM; i++) {
            if (side && e->M[i].row == e->M[i].column)
                continue;
            if (row) {
                row[n] = side ? e->M[i].column : e->M[i].row;
                column[n] = side ? e->M[i].row : e->M[i].column;
            }
            value[n++] = m->motion.out[i];
        }
        for (size_t i = 0; i < e->nJ; i++) {
            const int kept = f->row_of[e->J[i].row];
            if (kept < 0)
                continue;
            if (row) {
                row[n] = side ? e->J[i].column : (int)e->nu + kept;
                column[n] = side ? (int)e->nu + kept : e->J[i].column;
            }
            value[n++] = J[i];
        }
    }
    return n;
}

static bool factor_Jd(struct sparse_solver *f, const double *J)
{
    for (size_t i = 0; i < f->nJd; i++)
        f->Jd_value[i] = J[f->Jd_from[i]];
    return ct_sparse_factor(f->Jd, f->Jd_value);
}

// Relative to the smallest pivot when the order of pivots was chosen: pivots are not compared
// with the entries of their rows, as these differ widely in size.
static double strength(struct sparse_solver *f)
{
    return f->base.weakest = ct_sparse_pivot(f->Jd) / f->pivot;
}

// ---- evaluation ---------------------------------------------------------------------------------

// Solve with the present order of pivots; if the result is inaccurate, with a new one. Returns
// the backward error.
static double solve_whole(struct sparse_solver *f, bool *is_refined)
{
    for (int is_again = 0; is_again < 2; is_again++) {
        const bool ok = is_again ? ct_sparse_factor_repivot(f->whole, f->value)
                                 : ct_sparse_factor(f->whole, f->value);
        const double error = ok ? ct_sparse_solve(f->whole, f->x, f->b, is_refined) : INFINITY;
        // Backward error above which a new order of pivots is found.
        // Chosen: digits of accelerations against the time of a search.
        const double degraded_error = 1e-12;
        if (error < degraded_error || is_again)
            return error;
    }
    return INFINITY;
}

static double solve_into(struct sparse_solver *f, struct ct_evaluator *m, bool is_refined)
{
    const size_t nu = m->nu;
    ct_evaluator_dynamics(m);
    fill_whole(f, m, NULL, NULL, f->value);
    memcpy(f->b, m->Q, nu * sizeof *f->b);
    for (size_t i = 0; i < m->nrow; i++)
        if (f->row_of[i] >= 0)
            f->b[nu + (size_t)f->row_of[i]] = -m->gam[i];
    return solve_whole(f, &is_refined);
}

static double solve(struct ct_solver *base, struct ct_evaluator *m, double *a)
{
    struct sparse_solver *f = sparse_solver_of(base);
    if (!(solve_into(f, m, false) < ct_largest_residual) || !factor_Jd(f, m->Q + m->nu))
        return 0;
    for (size_t i = 0; i < m->nu; i++)
        if (!isfinite(f->x[i]))
            return 0;
    memcpy(a, f->x, m->nu * sizeof *a);
    return strength(f);
}

static void check(struct ct_solver *base, struct ct_evaluator *m)
{
    struct sparse_solver *f = sparse_solver_of(base);
    base->remainder = base->refined_remainder = solve_into(f, m, true);
    base->kappa = NAN;
    for (size_t i = 0; i < base->rank; i++)
        f->x[m->nu + i] = -f->x[m->nu + i];
}

static void correct(struct sparse_solver *f, const struct ct_evaluator *m,
                    const double *residual, double *d)
{
    bool is_refined = false;
    for (size_t i = 0; i < m->nrow; i++)
        if (f->row_of[i] >= 0)
            f->b[f->row_of[i]] = -residual[i];
    ct_sparse_solve(f->Jd, f->x, f->b, &is_refined);
    for (size_t i = 0; i < f->base.rank; i++)
        d[f->base.dependent[i]] = f->x[i];
}

static double close(struct ct_solver *base, struct ct_evaluator *m)
{
    struct sparse_solver *f = sparse_solver_of(base);
    ct_evaluator_constraint(m);
    if (!factor_Jd(f, m->v + m->nrow))
        return 0;
    correct(f, m, m->phi, f->dq);
    correct(f, m, m->v, f->du);
    return strength(f);
}

// ---- creation -----------------------------------------------------------------------------------

// Cost of factoring and solving, in operations of straight-line code.
static double cost_of(const struct ct_sparse *s)
{
    return per_operation * ct_sparse_operations(s) + per_factor * ct_sparse_fill(s);
}

// Analysis in the elimination order of the symbolic solver for [M J'; J 0]; NULL if there is none.
static struct ct_sparse *analyse_along(struct sparse_solver *f, struct ct_evaluator *m,
                                       const struct ct_partition_sets *p, const int *row,
                                       const int *column, size_t nentry)
{
    struct ct_arena *a = f->base.arena;
    const struct ct_pivot_order *found = p->pivots;
    if (!found && !p->has_no_pivots)
        found = ct_pivot_order_find(a, m->e, p, m->motion.out, m->Q + m->nu, INFINITY);
    return found && found->row ? ct_sparse_create_along(a, (int)(m->nu + p->rank), row, column,
                                                        nentry, found->row, found->column)
                               : NULL;
}

// Analysis by the library's order or by that of the symbolic solver, whichever is cheaper;
// factored.
static struct ct_sparse *analyse_whole(struct sparse_solver *f, struct ct_evaluator *m,
                                       const struct ct_partition_sets *p)
{
    const struct ct_equations *e = m->e;
    const size_t most = 2 * (e->nM + e->nJ) + 1;
    int *row = CT_NEWN(f->base.arena, int, most), *column = CT_NEWN(f->base.arena, int, most);
    f->value = CT_NEWN(f->base.arena, double, most);
    const size_t n = fill_whole(f, m, row, column, f->value);
    struct ct_sparse *s = ct_sparse_create(f->base.arena, (int)(e->nu + f->base.rank), row,
                                           column, n, CT_SPARSE_DIAGONAL);
    struct ct_sparse *along = s ? analyse_along(f, m, p, row, column, n) : NULL;
    if (s && !ct_sparse_factor(s, f->value))
        s = NULL;
    if (along && !ct_sparse_factor(along, f->value))
        along = NULL;
    return s && along ? (cost_of(s) <= cost_of(along) ? s : along) : s ? s : along;
}

static struct ct_sparse *analyse_Jd(struct sparse_solver *f, const struct ct_evaluator *m,
                                    const struct ct_partition_sets *p)
{
    const struct ct_equations *e = m->e;
    struct ct_arena *a = f->base.arena;
    int *row = CT_NEWN(a, int, e->nJ + 1), *column = CT_NEWN(a, int, e->nJ + 1);
    int *index = CT_NEWN(a, int, e->nu + 1); // 1 + index of a dependent column
    f->Jd_from = CT_NEWN(a, size_t, e->nJ + 1);
    f->Jd_value = CT_NEWN(a, double, e->nJ + 1);
    for (size_t i = 0; i < p->rank; i++)
        index[f->base.dependent[i]] = (int)i + 1;
    for (size_t i = 0; i < e->nJ; i++) {
        if (f->row_of[e->J[i].row] < 0 || !index[e->J[i].column])
            continue;
        row[f->nJd] = f->row_of[e->J[i].row];
        column[f->nJd] = index[e->J[i].column] - 1;
        f->Jd_from[f->nJd++] = i;
    }
    return ct_sparse_create(a, (int)p->rank, row, column, f->nJd, CT_SPARSE_DIAGONAL);
}

static struct ct_solver *create(struct ct_arena *a, struct ct_evaluator *m,
                                const struct ct_partition_sets *p, double most_nodes)
{
    (void)most_nodes;
    struct ct_arena *own = ct_arena_create_under(a);
    struct sparse_solver *f = CT_NEW(own, struct sparse_solver);
    const size_t n = m->nu + p->rank;
    f->base = (struct ct_solver){.kind = &ct_solver_sparse, .arena = own};
    ct_solver_set_partition(&f->base, p);
    f->row_of = CT_NEWN(own, int, m->nrow + 1);
    for (size_t i = 0; i < m->nrow; i++)
        f->row_of[i] = -1;
    for (size_t i = 0; i < p->rank; i++)
        f->row_of[f->base.row[i]] = (int)i;
    f->b = CT_NEWN(own, double, n + 1);
    f->x = CT_NEWN(own, double, n + 1);
    f->dq = CT_NEWN(own, double, m->nu + 1);
    f->du = CT_NEWN(own, double, m->nu + 1);
    f->whole = analyse_whole(f, m, p);
    f->Jd = analyse_Jd(f, m, p);
    if (!f->whole || !f->Jd || !factor_Jd(f, m->Q + m->nu)) {
        ct_arena_destroy(own);
        return NULL;
    }
    f->pivot = ct_sparse_pivot(f->Jd);
    struct ct_sparse *const all[] = {f->whole, f->Jd};
    f->base.operations = ct_solver_operations(&m->motion);
    f->base.cost = f->base.operations + per_value * (double)(m->e->nM + 2 * m->e->nJ);
    for (size_t i = 0; i < COUNT(all); i++) {
        f->base.operations += ct_sparse_operations(all[i]) + 2 * ct_sparse_fill(all[i]);
        f->base.cost += cost_of(all[i]);
    }
    f->base.a = f->x;
    f->base.lam = f->x + m->nu;
    f->base.phi = m->phi;
    f->base.v = m->v;
    f->base.volume = NAN;
    f->base.dq = f->dq;
    f->base.du = f->du;
    return &f->base;
}

const struct ct_solver_kind ct_solver_sparse
    = {.name = "sparse", .create = create, .solve = solve, .check = check, .close = close};
