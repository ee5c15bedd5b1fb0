// See small.h.
#include "formulate/small.h"
#include "formulate/flexible.h"

#include <string.h>

struct small {
    struct ct_seed *seed; // the coordinates and speeds, each a direction of its own
    ct_ex *symbol, *zero;
    size_t n, seed_cap, symbol_cap;
    bool *is_small; // by speed
};

static void add(struct ct_build *b, struct small *s, ct_ex symbol)
{
    const struct ct_seed seed = {symbol, (uint32_t)s->n, CT_EX_ONE};
    size_t n = s->n;
    CT_PUSH(b->ctx->scratch, s->symbol, n, s->symbol_cap, symbol);
    CT_PUSH(b->ctx->scratch, s->seed, s->n, s->seed_cap, seed);
}

static void add_unknown(struct ct_build *b, struct small *s, int q, int u)
{
    add(b, s, b->eqs->q[q].symbol);
    add(b, s, b->eqs->u[u].symbol);
    s->is_small[u] = true;
}

static bool is_named(const struct ct_build *b, const char *name, struct ct_mark *at)
{
    const struct ct_value *v = &b->model->simulation.small;
    for (size_t i = 0; v->given && i < v->n; i++)
        if (!strcmp(v->name[i], name)) {
            *at = v->at[i];
            return true;
        }
    return false;
}

bool ct_small_joint(const struct ct_build *b, int j)
{
    struct ct_mark at;
    return is_named(b, b->model->joint[j].name, &at);
}

bool ct_small_beam(const struct ct_build *b, const char *name)
{
    struct ct_mark at;
    return is_named(b, name, &at);
}

static bool collect_joint(struct ct_build *b, struct small *s, int j, struct ct_mark at)
{
    if (b->edge_of_joint[j] < 0)
        return true; // a gear has no coordinate
    const struct ct_edge_info *e = &b->edge[b->edge_of_joint[j]];
    for (int k = 0; k < e->ncoordinate; k++) {
        const struct ct_coordinate *c = &b->coordinate[e->first_coordinate + k];
        if (c->driver >= 0 || (!c->in_translation && !c->in_rotation))
            continue;
        if (e->trial.quaternion >= 0 && k >= e->trial.quaternion)
            return ct_error(b->ctx, at, CT_E_TREE,
                            "small: the free rotation of joint '%s' has no small coordinates",
                            e->name);
        if (c->u < 0)
            return ct_error(b->ctx, at, CT_E_TREE,
                            "small: joint '%s' closes a loop; only a branch has coordinates "
                            "that can be small",
                            e->name);
        add_unknown(b, s, c->q, c->u);
    }
    return true;
}

static bool collect(struct ct_build *b, struct small *s)
{
    struct ct_mark at;
    bool ok = true;
    s->is_small = CT_NEWN(b->ctx->scratch, bool, b->eqs->nu + 1);
    for (size_t j = 0; j < b->model->njoint; j++)
        if (is_named(b, b->model->joint[j].name, &at))
            ok &= collect_joint(b, s, (int)j, at);
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        if (f->formulation == CT_BEAM_STRETCH_LINEAR || is_named(b, f->name, &at))
            for (int k = 0; k < f->nelastic; k++)
                add_unknown(b, s, f->elastic[k].q, f->elastic[k].u);
    }
    s->zero = CT_NEWN(b->ctx->scratch, ct_ex, s->n + 1);
    return ok;
}

// f (n) = f(0) + sum of df/dx(0) x, x the small symbols.
static void truncate(struct ct_build *b, const struct small *s, ct_ex *f, size_t n)
{
    struct ct_exs *x = b->x;
    struct ct_slope *slope;
    const size_t nslope
        = ct_ex_jacobian(x, b->ctx->scratch, b->ctx->scratch, f, n, s->seed, s->n, &slope);
    ct_ex *all = CT_NEWN(b->ctx->scratch, ct_ex, n + nslope + 1);
    for (size_t i = 0; i < n; i++)
        all[i] = f[i];
    for (size_t i = 0; i < nslope; i++)
        all[n + i] = slope[i].value;
    ct_ex_subst_list(x, all, n + nslope, s->symbol, s->zero, s->n);
    for (size_t i = 0; i < n; i++)
        f[i] = all[i];
    for (size_t i = 0; i < nslope; i++)
        f[slope[i].row] = ct_ex_add(x, f[slope[i].row],
                                    ct_ex_mul(x, all[n + i], s->symbol[slope[i].direction]));
}

static void truncate_masses(struct ct_build *b, const struct small *s)
{
    struct ct_equations *e = b->eqs;
    ct_ex *large = CT_NEWN(b->ctx->scratch, ct_ex, e->nM + 1);
    size_t nlarge = 0, kept = 0;
    for (size_t i = 0; i < e->nM; i++) {
        struct ct_entry *m = &e->M[i];
        if (s->is_small[m->row] && s->is_small[m->column])
            ct_ex_subst_list(b->x, &m->value, 1, s->symbol, s->zero, s->n);
        else
            large[nlarge++] = m->value;
    }
    truncate(b, s, large, nlarge);
    nlarge = 0;
    for (size_t i = 0; i < e->nM; i++) {
        struct ct_entry m = e->M[i];
        if (!s->is_small[m.row] || !s->is_small[m.column])
            m.value = large[nlarge++];
        if (!ct_ex_is_zero(m.value))
            e->M[kept++] = m;
    }
    e->nM = kept;
}

bool ct_small_is_wanted(const struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++)
        if (b->flexible[i].formulation == CT_BEAM_STRETCH_LINEAR)
            return true;
    return b->model->simulation.small.given && b->model->simulation.small.n > 0;
}

bool ct_small_derive(struct ct_build *b)
{
    struct small s = {0};
    if (!collect(b, &s))
        return false;
    if (!s.n)
        return true;
    b->eqs->is_truncated = true;
    truncate_masses(b, &s);
    truncate(b, &s, b->eqs->Q, b->eqs->nu);
    return true;
}
