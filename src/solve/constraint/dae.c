// See dae.h.
#include "solve/constraint/dae.h"

#include "integrate/implicit/newton_sparse.h"
#include "integrate/stepper.h"
#include "solve/evaluator/switch_state.h"

#include <math.h>
#include <string.h>

static int rows(void *user, long *version)
{
    const struct ct_partition *s = user;
    *version = s->switches;
    return s->rank;
}

static void retract(void *user, const double *q, const double *d, double *q1)
{
    const struct ct_partition *s = user;
    memcpy(q1, q, s->m->nq * sizeof *q);
    ct_evaluator_retract(s->m, q1, d);
}

static void chart_rate(void *user, const double *d, const double *w, double *rate)
{
    const struct ct_partition *s = user;
    ct_evaluator_chart_rate(s->m, d, w, rate);
}

// Steps end at events. A step that ends at an event uses values before it, since a piecewise
// constant table is discontinuous there, and so is the slope of a piecewise linear one.
static double time_before_event(const struct ct_partition *s, double t)
{
    return s->pending ? ct_time_just_before(t, *s->pending) : t;
}

static enum ct_eval start(void *user, double t, const double *y, double *a, double *lam)
{
    struct ct_partition *s = user;
    ct_evaluator_set(s->m, time_before_event(s, t), y);
    if (!ct_evaluator_solved(s->m, s->a)) {
        ct_evaluator_dynamics(s->m);
        const enum ct_eval e = ct_partition_accelerate(s);
        if (e != CT_EVAL_OK)
            return e;
    }
    ct_evaluator_copy(a, s->a, s->m->nu);
    ct_partition_retained_multipliers(s, lam);
    return CT_EVAL_OK;
}

// Copy n values. Three, the number for a planar loop, are copied by separate code: a call for
// general length takes longer than the copy.
static inline void copy_few(double *out, const volatile double *v, size_t n)
{
    if (n != 3) {
        ct_evaluator_copy(out, v, n);
        return;
    }
    const double first = v[0], second = v[1], third = v[2];
    out[0] = first;
    out[1] = second;
    out[2] = third;
}

static inline void set_input(const struct ct_partition *s, double t, const double *q,
                             const double *u, const double *a, const double *lam)
{
    const struct ct_evaluator *m = s->m;
    double *input = m->input;
    input[0] = time_before_event(s, t);
    copy_few(input + m->at_q, q, m->nq);
    copy_few(input + m->at_u, u, m->nu);
    copy_few(input + m->at_a, a, m->nu);
    if ((size_t)s->rank < m->nrow)
        memset(input + m->at_lam, 0, m->nrow * sizeof *lam);
    for (int i = 0; i < s->rank; i++)
        input[m->at_lam + (size_t)s->row[i]] = lam[i];
}

static enum ct_eval residual(void *user, double t, const double *q, const double *u,
                             const double *a, const double *lam, double *r, double *phi,
                             double *v)
{
    struct ct_partition *s = user;
    const double *out = s->m->residual.out;
    const size_t nu = s->m->nu, nrow = s->m->nrow;
    set_input(s, t, q, u, a, lam);
    ct_program_run(&s->m->residual, s->m->input);
    if (!ct_stepper_finite(out, (int)s->m->residual.nout))
        return CT_EVAL_RETRY;
    copy_few(r, out, nu);
    for (int i = 0; i < s->rank; i++) {
        phi[i] = out[nu + (size_t)s->row[i]] - (s->m->is_inexact ? s->m->open[s->row[i]] : 0);
        v[i] = out[nu + nrow + (size_t)s->row[i]];
    }
    return CT_EVAL_OK;
}

// A (n x nu, out) from its entries; place[row] is the row's index in A, or -1. Returns the end
// of the values.
static const double *scatter(double *A, int n, size_t nu, const struct ct_slope *s, size_t ns,
                             const double *value, const int *place)
{
    memset(A, 0, (size_t)n * nu * sizeof *A);
    for (size_t i = 0; i < ns; i++) {
        const int row = place[s[i].row];
        if (row >= 0)
            A[row + n * (int)s[i].direction] = value[i];
    }
    return value + ns;
}

static enum ct_eval evaluate_jacobian(void *user, double t, const double *q, const double *u,
                                      const double *a, const double *lam, const double **value)
{
    struct ct_partition *s = user;
    set_input(s, t, q, u, a, lam);
    ct_evaluator_tangent(s->m);
    *value = s->m->slopes;
    for (size_t i = 0; i < s->m->nslope; i++)
        if (!isfinite(s->m->slopes[i]))
            return CT_EVAL_RETRY;
    return CT_EVAL_OK;
}

static enum ct_eval tangent(void *user, double t, const double *q, const double *u,
                            const double *a, const double *lam, double *M, double *C, double *K,
                            double *J, double *D)
{
    struct ct_partition *s = user;
    const struct ct_equations *e = s->m->e;
    const struct ct_residual *f = e->residual;
    const double *value;
    const enum ct_eval result = evaluate_jacobian(user, t, q, u, a, lam, &value);
    if (result != CT_EVAL_OK)
        return result;
    int *place = s->iwork;
    for (size_t i = 0; i < e->nrow; i++)
        place[i] = -1;
    for (int i = 0; i < s->rank; i++)
        place[s->row[i]] = i;
    value = ct_evaluator_scatter(s->m, K, C, M);
    value = scatter(D, s->rank, e->nu, f->dv, f->ndv, value, place);
    memset(J, 0, (size_t)s->rank * e->nu * sizeof *J);
    for (size_t i = 0; i < e->nJ; i++)
        if (place[e->J[i].row] >= 0)
            J[place[e->J[i].row] + s->rank * e->J[i].column] = value[i];
    return CT_EVAL_OK;
}

static const int *active_rows(void *user)
{
    const struct ct_partition *s = user;
    return s->row;
}

static int list_slopes(int *row, int *column, const struct ct_slope *s, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        row[i] = (int)s[i].row;
        column[i] = (int)s[i].direction;
    }
    return (int)n;
}

static const struct ct_jacobian_pattern *find_jacobian_pattern(struct ct_arena *a,
                                                               const struct ct_equations *e)
{
    const struct ct_residual *f = e->residual;
    const size_t n = f->ndq + f->ndu + f->nda + f->ndk + f->ndv + e->nJ;
    struct ct_jacobian_pattern *s = CT_NEW(a, struct ct_jacobian_pattern);
    int *row = CT_NEWN(a, int, n + 1), *column = CT_NEWN(a, int, n + 1), i = 0;
    i += s->nK = list_slopes(row + i, column + i, f->dq, f->ndq);
    i += s->nC = list_slopes(row + i, column + i, f->du, f->ndu);
    i += s->nM = list_slopes(row + i, column + i, f->da, f->nda);
    i += s->nR = list_slopes(row + i, column + i, f->dk, f->ndk);
    i += s->nD = list_slopes(row + i, column + i, f->dv, f->ndv);
    s->nJ = (int)e->nJ;
    s->nauxiliary = (int)f->nauxiliary;
    for (size_t k = 0; k < e->nJ; k++, i++) {
        row[i] = e->J[k].row;
        column[i] = e->J[k].column;
    }
    s->row = row;
    s->column = column;
    return s;
}

struct ct_dae *ct_dae_create(struct ct_arena *a, struct ct_partition *s)
{
    const struct ct_equations *e = s->m->e;
    struct ct_dae *dae = CT_NEW(a, struct ct_dae);
    int *q_of = CT_NEWN(a, int, e->nu + 1);
    bool is_plain = e->nq == e->nu;
    for (size_t k = 0; k < e->nu; k++) {
        q_of[k] = ct_speed_is_state(e, k) ? CT_MOVES_NOTHING : e->u[k].q;
        is_plain = is_plain && q_of[k] == (int)k;
    }
    *dae = (struct ct_dae){.user = s,
                           .nq = (int)e->nq,
                           .nu = (int)e->nu,
                           .most_rows = (int)e->nrow,
                           .q_of = q_of,
                           .nstate = (int)e->nstate,
                           .scale = s->scale,
                           .is_plain = is_plain,
                           .quadratures_are_constant = ct_ex_is_zero(e->power),
                           .rows = rows,
                           .retract = retract,
                           .chart_rate = chart_rate,
                           .start = start,
                           .residual = residual,
                           .tangent = tangent,
                           .jacobian_pattern = find_jacobian_pattern(a, e),
                           .evaluate_jacobian = evaluate_jacobian,
                           .active_rows = active_rows};
    dae->plan[1] = ct_newton_pattern_create(a, dae, true);
    dae->plan[0] = dae->most_rows ? ct_newton_pattern_create(a, dae, false) : dae->plan[1];
    return dae;
}
