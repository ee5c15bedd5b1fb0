// See settle.h.
#include "solve/settle.h"
#include "formulate/flexible.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

static const double met = 1e-13;     // last correction against the largest coordinate
static const double rounding = 1e-9; // corrections that no longer fall are rounding below this
enum { MOST_STEPS = 50, MOST_HALVINGS = 30 };

struct settle {
    struct ct_machine *m;
    const int *q; // coordinates that settle
    ct_ex *e;     // rows, then their derivatives, column by column
    size_t n;
    double *y, *factor; // state; factors of the derivative
    int *pivot;
    struct ct_program program; // values of e
};

bool ct_settle_wanted(const struct ct_model *model)
{
    for (size_t i = 1; i < model->nbody; i++)
        if (model->body[i].beam && model->body[i].beam->starts_in_equilibrium)
            return true;
    return false;
}

// Rows of the coordinates that settle, all speeds zero.
static void derive(struct settle *s, struct ct_arena *a, const struct ct_equations *e,
                   const int *u)
{
    struct ct_exs *x = e->x;
    const size_t n = s->n;
    ct_ex *from = CT_NEWN(a, ct_ex, e->nu + 1), *zero = CT_NEWN(a, ct_ex, e->nu + 1);
    s->e = CT_NEWN(a, ct_ex, n + n * n + 1);
    for (size_t k = 0; k < e->nu; k++)
        from[k] = e->u[k].symbol;
    for (size_t i = 0; i < n; i++)
        s->e[i] = e->Q[u[i]];
    ct_ex_subst_list(x, s->e, n, from, zero, e->nu);
    struct ct_seed *seed = CT_NEWN(a, struct ct_seed, n + 1);
    for (size_t i = 0; i < n; i++)
        seed[i] = (struct ct_seed){e->q[s->q[i]].symbol, (uint32_t)i, CT_EX_ONE};
    struct ct_slope *slope;
    const size_t nslope = ct_ex_jacobian(x, a, a, s->e, n, seed, n, &slope);
    for (size_t i = 0; i < nslope; i++)
        s->e[n + slope[i].row + n * slope[i].direction] = slope[i].value;
}

// Rows and derivatives at s->y.
static void evaluate(struct settle *s)
{
    ct_machine_set(s->m, 0, s->y);
    ct_program_run(&s->program, s->m->input);
}

// Newton correction of the rows now, with the factors of an earlier derivative; its size.
static double correction(struct settle *s, double *d)
{
    double size = 0;
    memcpy(d, s->program.out, s->n * sizeof *d);
    ct_lu_solve(d, s->factor, s->pivot, (int)s->n, (int)s->n, 1, (int)s->n, false);
    for (size_t i = 0; i < s->n; i++)
        size = !(fabs(d[i]) <= size) ? fabs(d[i]) : size;
    return size;
}

static double largest(const struct settle *s)
{
    double size = 0;
    for (size_t i = 0; i < s->n; i++)
        size = fmax(size, fabs(s->y[s->q[i]]));
    return size;
}

// Newton steps, halved until the next correction with the same derivative is smaller: that test does not care how rows
// are scaled. Source: Deuflhard (2011), key deuflhard2011.
static bool iterate(struct settle *s, struct ct_arena *a)
{
    const size_t n = s->n;
    double *d = CT_NEWN(a, double, n), *next = CT_NEWN(a, double, n),
           *kept = CT_NEWN(a, double, s->m->nq);
    evaluate(s);
    for (int step = 0; step < MOST_STEPS; step++) {
        memcpy(s->factor, s->program.out + n, n * n * sizeof *s->factor);
        if (!ct_lu(s->factor, s->pivot, (int)n, (int)n))
            return false;
        const double size = correction(s, d);
        if (size <= met * largest(s) || size == 0)
            return true;
        memcpy(kept, s->y, s->m->nq * sizeof *kept);
        double factor = 1, left = INFINITY;
        for (int half = 0; half < MOST_HALVINGS && !(left < size); half++, factor /= 2) {
            for (size_t i = 0; i < n; i++)
                s->y[s->q[i]] = kept[s->q[i]] - factor * d[i];
            evaluate(s);
            left = correction(s, next);
        }
        if (!(left < size)) // only rounding is left, or there is nothing to find
            return size <= rounding * largest(s);
    }
    return false;
}

static bool open_beam(struct ct_ctx *ctx, const struct ct_equations *e,
                      const struct ct_body *body)
{
    return e->nrow == 0
        || ct_error(
               ctx, body->instance.mark, CT_E_SETTLE,
               "beam '%s' is to start in equilibrium, but the model has closed loops, whose "
               "reactions that takes; start undeformed, or use `cotree equilibrium`",
               body->instance.name);
}

bool ct_settle(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
               const struct ct_equations *e, struct ct_start *start)
{
    const struct ct_build *b = e->build;
    size_t n = 0, k = 0;
    int *q = CT_NEWN(a, int, e->nq + 1), *u = CT_NEWN(a, int, e->nu + 1);
    const struct ct_body *first = NULL;
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        start->nelastic += (size_t)f->nelastic;
        if (!f->beam->starts_in_equilibrium)
            continue;
        first = first ? first : &model->body[f->body];
        for (int j = 0; j < f->nelastic; j++) {
            q[n] = f->elastic[j].q;
            u[n++] = f->elastic[j].u;
        }
    }
    if (!first || !n)
        return true;
    if (!open_beam(ctx, e, first))
        return false;
    struct settle s = {.m = ct_machine_create(a, model, e), .q = q, .n = n};
    derive(&s, a, e, u);
    s.y = CT_NEWN(a, double, s.m->nq + s.m->nu + 1);
    s.factor = CT_NEWN(a, double, n *n + 1);
    s.pivot = CT_NEWN(a, int, n + 1);
    ct_start_apply(start, s.m, s.y);
    ct_machine_compile(a, s.m, e->x, s.e, n + n * n, &s.program);
    if (!iterate(&s, a))
        return ct_error(
            ctx, first->instance.mark, CT_E_SETTLE,
            "no equilibrium was found near the undeformed shape of beam '%s'; the loads "
            "at t = 0 may be too large for it",
            first->instance.name);
    start->elastic = CT_NEWN(a, double, start->nelastic + 1);
    for (size_t i = 0; i < b->nflexible; i++)
        for (int j = 0; j < b->flexible[i].nelastic; j++)
            start->elastic[k++] = s.y[b->flexible[i].elastic[j].q];
    return true;
}
