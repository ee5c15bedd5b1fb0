// See initial_equilibrium.h.
#include "solve/initial/initial_equilibrium.h"
#include "formulate/beam/flexible_body.h"
#include "numeric/dense.h"
#include "solve/constraint/partition_conditioning.h"
#include "solve/initial/closure_continuation.h"

#include <math.h>
#include <string.h>

bool ct_initial_equilibrium_is_wanted(const struct ct_model *model)
{
    for (size_t i = 1; i < model->nbody; i++)
        if (model->body[i].beam && model->body[i].beam->starts_in_equilibrium)
            return true;
    return false;
}

bool *ct_initial_equilibrium_fixed_joints(struct ct_arena *a, const struct ct_model *model)
{
    bool *first = CT_NEWN(a, bool, model->njoint + 1);
    for (size_t i = 0; i < model->njoint; i++) {
        const struct ct_initial *initial = &model->joint[i].initial;
        first[i] = (initial->q.given || initial->rotate.given) && !initial->guess;
    }
    return first;
}

// ---- held coordinates ----------------------------------

// Is the value of the coordinate with speed k demanded?
static bool is_given(const struct ct_equations *e, const struct ct_initial_state *start,
                     size_t k)
{
    for (size_t i = 0; i < start->n; i++)
        if (e->coordinate[i].u == (int)k && start->is_given[i])
            return true;
    return false;
}

// Held coordinates, by speed: as many of joints and bodies as the loops leave independent,
// demanded ones first, and beams that are not to be in equilibrium. held (nu, out). The
// evaluator has the initial state.
static void find_held(struct ct_evaluator *m, struct ct_arena *a,
                      const struct ct_initial_state *start, const bool *in_equilibrium,
                      bool *held)
{
    const struct ct_equations *e = m->e;
    size_t n = 0;
    int *rigid = CT_NEWN(a, int, e->nu + 1);
    for (size_t k = 0; k < e->nu; k++) {
        held[k] = e->u[k].beam && !in_equilibrium[k];
        if (!e->u[k].beam)
            rigid[n++] = (int)k;
    }
    struct ct_basis s = {n, 0, CT_NEWN(a, double, n *n + 1)};
    double *v = CT_NEWN(a, double, n + 1);
    ct_evaluator_constraint(m);
    for (size_t i = 0; i < e->nrow; i++) {
        for (size_t k = 0; k < n; k++)
            v[k] = m->J[i + e->nrow * (size_t)rigid[k]];
        ct_basis_extend(&s, v);
    }
    for (int given = 1; given >= 0; given--)
        for (size_t k = 0; k < n; k++)
            if (is_given(e, start, (size_t)rigid[k]) == given) {
                memset(v, 0, n * sizeof *v);
                v[k] = 1;
                held[rigid[k]] = ct_basis_extend(&s, v);
            }
}

// ---- the start ----------------------------------------

// Change the speeds in y of joints and bodies that are not held so that v = 0, by the minimum
// norm; beams do not deform. False if that does not satisfy all rows.
static bool move_joints(struct ct_arena *a, struct ct_evaluator *m, const bool *held, double *y)
{
    const size_t nrow = m->nrow, nu = m->nu;
    double *A = CT_NEWN(a, double, nrow *nu + 1), *b = CT_NEWN(a, double, nrow + nu + 1);
    int *iwork = CT_NEWN(a, int, nu + 1), *free = CT_NEWN(a, int, nu + 1);
    double *work = CT_NEWN(a, double, ct_lstsq_work((int)nrow, (int)nu + 1));
    int n = 0;
    ct_evaluator_set(m, 0, y);
    ct_evaluator_constraint(m);
    const double asked = ct_vector_largest(m->v, nrow);
    for (size_t k = 0; k < nu; k++) {
        if (held[k] || m->e->u[k].beam)
            continue;
        memcpy(A + nrow * (size_t)n, m->J + nrow * k, nrow * sizeof *A);
        free[n++] = (int)k;
    }
    for (size_t i = 0; i < nrow; i++)
        b[i] = -m->v[i];
    if (n)
        ct_lstsq(b, A, (int)nrow, n, (int)nrow, ct_rank_tolerance, iwork, work);
    for (int k = 0; k < n; k++)
        y[m->nq + (size_t)free[k]] += b[k];
    ct_evaluator_set(m, 0, y);
    ct_evaluator_constraint(m);
    return ct_vector_largest(m->v, nrow) <= ct_rank_tolerance * asked;
}

// The same where beams must deform: all speeds are rates of the equilibrium s.
static bool move_all(struct ct_arena *a, struct ct_static_residual *s, struct ct_evaluator *m,
                     const bool *held, double *y)
{
    double *u = y + m->nq;
    for (size_t k = 0; k < m->nu; k++)
        u[k] = held[k] ? u[k] : 0;
    ct_evaluator_set(m, 0, y);
    ct_evaluator_constraint(m);
    return ct_static_residual_rates(s, a, m->v, u);
}

// Speeds of all coordinates at the equilibrium.
static void find_speeds(struct ct_arena *a, const struct ct_model *model,
                        struct ct_static_residual *s, const struct ct_equations *e,
                        const bool *held, struct ct_initial_state *start)
{
    struct ct_evaluator *m = ct_evaluator_create(a, model, e);
    const size_t ny = m->nq + m->nu + 1;
    double *y = CT_NEWN(a, double, ny), *first = CT_NEWN(a, double, ny);
    ct_initial_state_apply(start, m, y);
    memcpy(first, y, ny * sizeof *y);
    if (!move_joints(a, m, held, y) && e->nrow == s->e->nrow && e->nu == s->e->nu
        && move_all(a, s, m, held, first)) {
        memcpy(y, first, ny * sizeof *y);
        start->elastic_rate = CT_NEWN(a, double, start->nelastic + 1);
        size_t n = 0;
        for (size_t i = 0; i < e->build->nflexible; i++)
            for (int j = 0; j < e->build->flexible[i].nelastic; j++)
                start->elastic_rate[n++]
                    = y[m->nq + (size_t)e->build->flexible[i].elastic[j].u];
    }
    ct_evaluator_set(m, 0, y);
    ct_program_run(&m->result, m->input);
    for (size_t i = 0; i < start->n; i++)
        start->u[i] = m->result.out[2 * i + 1];
}

static void copy_result(const struct ct_static_residual *s, struct ct_arena *a,
                        struct ct_initial_state *start)
{
    const struct ct_build *b = s->e->build;
    size_t n = 0;
    start->elastic = CT_NEWN(a, double, start->nelastic + 1);
    for (size_t i = 0; i < b->nflexible; i++)
        for (int j = 0; j < b->flexible[i].nelastic; j++)
            start->elastic[n++] = s->y[b->flexible[i].elastic[j].q];
    if (!s->e->nrow)
        return;
    ct_evaluator_set(s->m, 0, s->y);
    ct_program_run(&s->m->result, s->m->input);
    for (size_t i = 0; i < start->n; i++)
        start->q[i] = s->m->result.out[2 * i];
}

// Elastic coordinates to be in equilibrium, by speed. Returns the first beam with such, or
// NULL.
static const struct ct_body *find_equilibrium_beams(const struct ct_model *model,
                                                    const struct ct_equations *e,
                                                    bool *in_equilibrium,
                                                    struct ct_initial_state *start)
{
    const struct ct_build *b = e->build;
    const struct ct_body *first = NULL;
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        start->nelastic += (size_t)f->nelastic;
        for (int j = 0; j < f->nelastic && f->beam->starts_in_equilibrium; j++) {
            first = first ? first : &model->body[f->body];
            in_equilibrium[f->elastic[j].u] = true;
        }
    }
    return first;
}

static bool report_open(struct ct_ctx *ctx, const struct ct_model *model,
                        struct ct_static_residual *s)
{
    size_t row = 0;
    ct_closure_continuation_set(s, 0);
    const double open = ct_closure_continuation_remaining(s, &row);
    const int joint = s->e->row[row].joint;
    struct ct_mark mark = {.file = model->file};
    if (joint >= 0)
        mark = model->joint[joint].mark;
    return ct_error(
        ctx, mark, CT_E_ASSEMBLY,
        "the mechanism cannot be assembled: bending its beams leaves '%s' open by %.3g; "
        "check lengths and places and give guesses in `initial`",
        s->e->row[row].name, open);
}

bool ct_initial_equilibrium_solve(struct ct_ctx *ctx, struct ct_arena *a,
                                  const struct ct_model *model, const struct ct_equations *e,
                                  const struct ct_equations *moving,
                                  struct ct_initial_state *start)
{
    bool *in_equilibrium = CT_NEWN(a, bool, e->nu + 1), *held = CT_NEWN(a, bool, e->nu + 1);
    const struct ct_body *first = find_equilibrium_beams(model, e, in_equilibrium, start);
    if (!first)
        return true;
    struct ct_static_residual s
        = ct_static_residual_create(a, ct_evaluator_create(a, model, e));
    ct_initial_state_apply(start, s.m, s.y);
    memset(s.y + s.m->nq, 0, e->nmotion * sizeof *s.y);
    ct_evaluator_set(s.m, 0, s.y);
    find_held(s.m, a, start, in_equilibrium, held);
    for (size_t k = 0; k < e->nu; k++) {
        s.index[k] = held[k] ? -1 : (int)s.n;
        if (!held[k])
            s.u[s.n++] = (int)k;
    }
    ct_static_residual_derive(&s, a);
    ct_closure_continuation_begin(&s);
    if (start->is_open && !ct_closure_continuation_run(&s, a, start))
        return report_open(ctx, model, &s);
    ct_closure_continuation_set(&s, 0);
    ct_static_residual_choose_rows(&s, a);
    if (!ct_static_residual_iterate(&s, a))
        return ct_error(
            ctx, first->instance.mark, CT_E_INITIAL_EQUILIBRIUM,
            "no equilibrium was found near the undeformed shape of beam '%s'; the loads "
            "at t = 0 may be too large for it",
            first->instance.name);
    copy_result(&s, a, start);
    if (e->nrow)
        find_speeds(a, model, &s, moving, held, start);
    return true;
}
