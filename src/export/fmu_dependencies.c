// Dependencies of derivatives and outputs of a model, and their directional derivatives. See
// fmu.h.
//
// Speeds that M or J couple form a component. The derivatives of its speeds and the multipliers
// of its rows depend on everything in the component's entries of M, Q, J and gam. If u' is
// known in closed form, its expression gives the dependencies.
#include "export/fmu.h"

#include <string.h>

struct finder {
    struct ct_fmu *f;
    const struct ct_equations *e;
    size_t n;       // size of `in`
    int *component; // component of each speed, then of each row
    bool **of;      // by component: dependencies; NULL: not found yet
};

static void mark(const struct finder *s, struct ct_exs *x, const ct_ex *root, size_t n,
                 bool *on)
{
    const struct ct_evaluator *m = ct_run_evaluator(s->f->w->sim->run);
    const size_t nnode = ct_ex_walk(x, root, n);
    for (size_t k = 0; k < nnode; k++) {
        const struct ct_sym *symbol = ct_ex_symbol(x, (ct_ex){x->stack[k]});
        size_t slot;
        if (symbol && ct_evaluator_slot(m, symbol, &slot) && slot < s->n)
            on[slot] = true;
    }
}

// ---- components ----------------------------------------------------------------------------

static int root_of(int *parent, int i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

static void find_components(struct finder *s)
{
    const struct ct_equations *e = s->e;
    struct ct_arena *a = s->f->w->ctx->model;
    const int nu = (int)e->nu, n = nu + (int)e->nrow;
    s->component = CT_NEWN(a, int, (size_t)n + 1);
    s->of = CT_NEWN(a, bool *, (size_t)n + 1);
    for (int i = 0; i < n; i++)
        s->component[i] = i;
    for (size_t k = 0; k < e->nM; k++)
        s->component[root_of(s->component, e->M[k].row)]
            = root_of(s->component, e->M[k].column);
    for (size_t k = 0; k < e->nJ; k++)
        s->component[root_of(s->component, nu + e->J[k].row)]
            = root_of(s->component, e->J[k].column);
    for (int i = 0; i < n; i++)
        s->component[i] = root_of(s->component, i);
}

// Dependencies of component c.
static const bool *component_on(struct finder *s, int c)
{
    const struct ct_equations *e = s->e;
    struct ct_arena *a = s->f->w->ctx->model;
    ct_ex *list
        = CT_NEWN(s->f->w->sim->own.scratch, ct_ex, e->nM + e->nJ + e->nu + e->nrow + 1);
    size_t n = 0;
    if (s->of[c])
        return s->of[c];
    for (size_t k = 0; k < e->nM; k++)
        if (s->component[e->M[k].row] == c)
            list[n++] = e->M[k].value;
    for (size_t k = 0; k < e->nJ; k++)
        if (s->component[e->J[k].column] == c)
            list[n++] = e->J[k].value;
    for (size_t i = 0; i < e->nu; i++)
        if (s->component[i] == c)
            list[n++] = e->Q[i];
    for (size_t i = 0; i < e->nrow; i++)
        if (s->component[e->nu + i] == c)
            list[n++] = e->row[i].gam;
    s->of[c] = CT_NEWN(a, bool, s->n + 1);
    mark(s, e->x, list, n, s->of[c]);
    return s->of[c];
}

static void add(bool *on, const bool *more, size_t n)
{
    for (size_t i = 0; i < n; i++)
        on[i] |= more[i];
}

static void add_acceleration(struct finder *s, size_t i, bool *on)
{
    if (s->e->solution)
        mark(s, s->e->x, &s->e->solution[i], 1, on);
    else
        add(on, component_on(s, s->component[i]), s->n);
}

// Dependencies of an expression, including those of u' and multipliers in it.
static bool *depends_on(struct finder *s, ct_ex e)
{
    const struct ct_export *x = &s->f->w->x;
    bool *on = CT_NEWN(s->f->w->ctx->model, bool, s->n + 1);
    bool *direct = CT_NEWN(s->f->w->sim->own.scratch, bool, s->n + 1);
    mark(s, s->e->x, &e, 1, direct);
    memcpy(on, direct, s->n * sizeof *on);
    for (size_t i = 0; i < s->e->nu; i++)
        if (direct[x->at_a + i])
            add_acceleration(s, i, on);
    for (size_t i = 0; i < s->e->nrow; i++)
        if (direct[x->at_lam + i])
            add(on, component_on(s, s->component[s->e->nu + i]), s->n);
    return on;
}

static bool *derivative_on(struct finder *s, size_t k)
{
    const struct ct_equations *e = s->e;
    if (k < e->nq)
        return depends_on(s, e->q[k].rate);
    if (k == e->nq + e->nu)
        return depends_on(s, e->power);
    bool *on = CT_NEWN(s->f->w->ctx->model, bool, s->n + 1);
    add_acceleration(s, k - e->nq, on);
    return on;
}

// Dependencies of a parameter on those that can be set.
static bool *parameter_on(struct finder *s, size_t index)
{
    const struct ct_model *m = &s->f->w->sim->system->model;
    bool *on = CT_NEWN(s->f->w->ctx->model, bool, s->n + 1);
    mark(s, m->x, &m->parameter[index - 1].definition, 1, on);
    for (size_t i = index; i-- > 1;) // definitions use only parameters before them
        if (on[i] && !ct_ex_is_const(m->x, m->parameter[i - 1].definition, NULL)) {
            on[i] = false;
            mark(s, m->x, &m->parameter[i - 1].definition, 1, on);
        }
    return on;
}

// Completes quaternions: a quantity that depends on one number of a quaternion depends on all
// four.
static void complete_quaternions(const struct finder *s, bool *on)
{
    bool *q = on + s->f->w->x.at_q;
    for (size_t i = 0; i < s->e->nq; i++)
        if (s->e->q[i].quaternion == 0) {
            const bool any = q[i] || q[i + 1] || q[i + 2] || q[i + 3];
            q[i] = q[i + 1] = q[i + 2] = q[i + 3] = any;
        }
}

void ct_fmu_find_dependencies(struct ct_fmu *f)
{
    struct finder s = {.f = f, .e = f->w->x.e, .n = f->w->x.ninput};
    find_components(&s);
    for (size_t i = 0; i < f->nvariable; i++) {
        struct ct_fmu_variable *v = &f->variable[i];
        bool *on = NULL;
        if (v->role == CT_FMU_DERIVATIVE)
            on = derivative_on(&s, v->reference - f->first_derivative);
        else if (v->role == CT_FMU_OUTPUT)
            on = depends_on(&s, s.e->result[v->reference - f->first_output].value);
        else if (v->role == CT_FMU_ROOT)
            on = depends_on(&s, s.e->switches[v->reference - f->first_root].g);
        else if (v->role == CT_FMU_DERIVED)
            on = parameter_on(&s, v->reference);
        if (on)
            complete_quaternions(&s, on);
        if (v->is_output) { // depends on itself
            on = CT_NEWN(f->w->ctx->model, bool, s.n + 1);
            on[v->reference] = true;
        }
        v->on = on;
    }
}

// ---- directions ----------------------------------------------------------------------------

// Seeds for states, inputs, u' and multipliers. The number of a seed is its index in `in`.
static size_t list_seeds(struct ct_fmu *f, struct ct_seed *seed)
{
    struct ct_exs *x = f->w->x.e->x;
    const struct ct_model *model = &f->w->sim->system->model;
    const struct ct_evaluator *m = ct_run_evaluator(f->w->sim->run);
    const uint32_t nnode = (uint32_t)x->nnode;
    size_t n = 0;
    for (uint32_t id = 0; id < nnode; id++) {
        const struct ct_sym *s = ct_ex_symbol(x, (ct_ex){id});
        size_t slot;
        if (!s || !ct_evaluator_slot(m, s, &slot))
            continue;
        const bool is_input = s->kind == CT_SYM_PARAM && model->parameter[s->index].is_input;
        if (is_input || s->kind == CT_SYM_Q || s->kind == CT_SYM_U || s->kind == CT_SYM_A
            || s->kind == CT_SYM_LAM || s->kind == CT_SYM_WORK)
            seed[n++] = (struct ct_seed){(ct_ex){id}, 0,
                                         ct_ex_sym(x, CT_SYM_SEED, "seed", (uint32_t)slot)};
    }
    return n;
}

// Directional derivatives of n expressions; zero for constants.
static const struct ct_listing *list_along(struct ct_fmu *f, const ct_ex *e, size_t n,
                                           const struct ct_seed *seed, size_t nseed)
{
    struct ct_arena *a = f->w->ctx->model;
    struct ct_exs *x = f->w->x.e->x;
    struct ct_slope *slope;
    ct_ex *d = CT_NEWN(a, ct_ex, n + 1);
    const size_t nslope
        = ct_ex_jacobian(x, f->w->sim->own.scratch, a, e, n, seed, nseed, &slope);
    for (size_t k = 0; k < nslope; k++)
        d[slope[k].row] = slope[k].value;
    return ct_evaluator_list(a, ct_run_evaluator(f->w->sim->run), x, d, n);
}

// r = M u' - Q - J' lam (nu), c = J u' + gam (nrow), q' (nq)
static void put_residual(const struct ct_equations *e, ct_ex *out)
{
    struct ct_exs *x = e->x;
    ct_ex *c = out + e->nu, *rate = c + e->nrow;
    for (size_t i = 0; i < e->nu; i++)
        out[i] = ct_ex_neg(x, e->Q[i]);
    for (size_t i = 0; i < e->nrow; i++)
        c[i] = e->row[i].gam;
    for (size_t i = 0; i < e->nq; i++)
        rate[i] = e->q[i].rate;
    for (size_t k = 0; k < e->nM; k++) {
        const int i = e->M[k].row, j = e->M[k].column;
        out[i] = ct_ex_add_product(x, out[i], e->M[k].value, e->u[j].derivative);
        if (i != j)
            out[j] = ct_ex_add_product(x, out[j], e->M[k].value, e->u[i].derivative);
    }
    for (size_t k = 0; k < e->nJ; k++) {
        const int i = e->J[k].row, j = e->J[k].column;
        out[j] = ct_ex_sub_product(x, out[j], e->J[k].value, e->row[i].lam);
        c[i] = ct_ex_add_product(x, c[i], e->J[k].value, e->u[j].derivative);
    }
}

// q', u'
static void put_solution(const struct ct_equations *e, ct_ex *out)
{
    for (size_t i = 0; i < e->nq; i++)
        out[i] = e->q[i].rate;
    for (size_t i = 0; i < e->nu; i++)
        out[e->nq + i] = e->solution[i];
}

void ct_fmu_list_directions(struct ct_fmu *f)
{
    const struct ct_equations *e = f->w->x.e;
    struct ct_arena *scratch = f->w->sim->own.scratch;
    const size_t nresidual = e->nu + e->nrow + e->nq, nout = e->nresult + e->nswitch + 1;
    ct_ex *residual = CT_NEWN(scratch, ct_ex, nresidual + 1),
          *out = CT_NEWN(scratch, ct_ex, nout);
    f->source.is_direct = e->solution && e->nrow == 0;
    if (f->source.is_direct)
        put_solution(e, residual);
    else
        put_residual(e, residual);
    for (size_t i = 0; i < e->nresult; i++)
        out[i] = e->result[i].value;
    for (size_t i = 0; i < e->nswitch; i++)
        out[e->nresult + i] = e->switches[i].g;
    out[nout - 1] = e->power;
    struct ct_seed *seed = CT_NEWN(scratch, struct ct_seed, e->x->nsym + 1);
    size_t nseed = list_seeds(f, seed);
    f->source.along_outputs = list_along(f, out, nout, seed, nseed);
    size_t nheld = 0; // u' and multipliers are inputs of the residual
    for (size_t i = 0; i < nseed; i++) {
        const enum ct_sym_kind kind = ct_ex_symbol(e->x, seed[i].symbol)->kind;
        if (kind != CT_SYM_A && kind != CT_SYM_LAM)
            seed[nheld++] = seed[i];
    }
    f->source.along = list_along(f, residual, nresidual, seed, nheld);
}
