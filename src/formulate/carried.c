// See carried.h.
//
// The equations are taken down once more, from a copy of the build on the same expressions in which the starts of elements
// are further elastic coordinates: sections slide by these and their own element's dofs.
#include "formulate/carried.h"

#include "formulate/elastic.h"
#include "formulate/row.h"
#include "formulate/small.h"

#include <string.h>

static const ct_ex3 along = {{{1}, {0}, {0}}};

static long pairs(long n)
{
    return n * (n + 1) / 2;
}

// Does M_c have fewer entries than M between the coordinates of f?
static bool is_sparser(const struct ct_flexible *f)
{
    long n = 0;
    for (int e = 0; e < f->beam->nelement; e++) {
        int sign, own = e > 0;
        for (int j = 0; j < CT_DOF; j++)
            own += ct_dof_freedom(f, e, j, &sign) != NULL;
        n += pairs(own);
    }
    return n < pairs(f->nelastic);
}

static bool is_carried(const struct ct_flexible *f)
{
    return ct_flexible_is_carried(f) && !f->follow && is_sparser(f);
}

static void *copy(struct ct_arena *a, const void *from, size_t n, size_t size)
{
    void *to = ct_arena_calloc(a, n + 1, size);
    if (n)
        memcpy(to, from, n * size);
    return to;
}

// ---- further coordinates ------------------------------------------------------------------------------------

// Elastic coordinates of f with its starts behind them, whose speeds are numbered from nu on.
static void add_starts(struct ct_build *w, struct ct_flexible *f)
{
    f->nstart = f->beam->nelement - 1;
    struct ct_elastic *all = CT_NEWN(w->arena, struct ct_elastic, f->nelastic + f->nstart);
    memcpy(all, f->elastic, (size_t)f->nelastic * sizeof *all);
    for (int i = 0; i < f->nstart; i++)
        all[f->nelastic + i] = (struct ct_elastic){.u = (int)w->eqs->nu++, .freedom = -1};
    f->elastic = all;
    f->nelastic += f->nstart;
}

// A section slides by what its own element does, and by its start.
static void slide_by_element(struct ct_build *w, struct ct_edge_info *e)
{
    struct ct_flexible *f = &w->flexible[e->flexible - w->flexible];
    ct_ex3 *turn = CT_NEWN(w->arena, ct_ex3, f->nelastic + 1);
    e->slide = CT_NEWN(w->arena, ct_ex3, f->nelastic + 1);
    ct_station_own_partials(w, f, e->station, e->slide, turn);
    if (e->station->element > 0)
        e->slide[ct_flexible_start(f, e->station->element)] = along;
}

// Is there a beam whose starts are further coordinates? Then w is such a copy of b.
static bool carry(const struct ct_build *b, struct ct_build *w)
{
    struct ct_arena *a = b->arena;
    bool any = false;
    *w = *b;
    for (size_t i = 0; i < b->nflexible; i++)
        any = any || is_carried(&b->flexible[i]);
    if (!any)
        return false;
    w->eqs = copy(a, b->eqs, 1, sizeof *b->eqs);
    w->eqs->M = NULL;
    w->eqs->nM = w->eqs->M_cap = 0;
    w->flexible = copy(a, b->flexible, b->nflexible, sizeof *b->flexible);
    w->edge = copy(a, b->edge, b->nedge, sizeof *b->edge);
    w->anchor = copy(a, b->anchor, b->nanchor, sizeof *b->anchor);
    w->coefficient = NULL;
    for (size_t i = 0; i < w->nflexible; i++)
        if (is_carried(&w->flexible[i]))
            add_starts(w, &w->flexible[i]);
    for (size_t i = 0; i < w->nedge; i++) {
        struct ct_edge_info *e = &w->edge[i];
        if (!e->flexible)
            continue;
        e->flexible = &w->flexible[e->flexible - b->flexible];
        if (e->flexible->nstart)
            slide_by_element(w, e);
    }
    ct_translation_slide_sections(w);
    return true;
}

// ---- entries ------------------------------------------------------------------------------------------------

// J_c: columns of the beams' coordinates by what their sections do now, the others as they are.
static void take_rows(const struct ct_build *b, struct ct_build *w, struct ct_carried *c)
{
    const struct ct_equations *e = b->eqs;
    bool *is_new = CT_NEWN(b->ctx->scratch, bool, c->n + 1);
    size_t k = 0;
    for (size_t i = 0; i < w->nflexible; i++)
        for (int j = 0; w->flexible[i].nstart && j < w->flexible[i].nelastic; j++)
            is_new[w->flexible[i].elastic[j].u] = true;
    for (size_t row = 0; row < e->nrow; row++) {
        for (; k < e->nJ && e->J[k].row == (int)row; k++)
            if (!is_new[e->J[k].column])
                CT_PUSH(b->arena, c->J, c->nJ, c->J_cap, e->J[k]);
        const ct_ex *coef = ct_row_coefficients(w, (int)row);
        for (size_t u = 0; u < c->n; u++)
            if (is_new[u] && !ct_ex_is_zero(coef[u]))
                CT_PUSH(b->arena, c->J, c->nJ, c->J_cap,
                        ((struct ct_entry){(int)row, (int)u, coef[u]}));
    }
}

// c at the start of element i from that of the element before and its dofs.
static void list_sum(const struct ct_build *b, const struct ct_flexible *f, int i,
                     struct ct_carried *c)
{
    const struct ct_element *before = &f->element[i - 1];
    const int row = f->elastic[ct_flexible_start(f, i)].u;
    if (i > 1)
        CT_PUSH(b->arena, c->sum, c->nsum, c->sum_cap,
                ((struct ct_entry){row, f->elastic[ct_flexible_start(f, i - 1)].u, CT_EX_ONE}));
    for (int j = 2; j < CT_BENT_DOF; j++) {
        int sign;
        const struct ct_freedom *d = ct_dof_freedom(f, i - 1, j, &sign);
        if (!d || !d->npart || ct_ex_is_zero(before->g[j]))
            continue;
        const ct_ex g = ct_ex_scale(b->x, sign, before->g[j]);
        CT_PUSH(b->arena, c->sum, c->nsum, c->sum_cap,
                ((struct ct_entry){row, f->elastic[d->part[0].k].u, g}));
    }
}

struct ct_carried *ct_carried_derive(struct ct_build *b)
{
    struct ct_build w;
    if (ct_small_is_wanted(b) || !carry(b, &w))
        return NULL;
    struct ct_carried *c = CT_NEW(b->arena, struct ct_carried);
    c->nu = b->eqs->nu;
    c->n = w.eqs->nu;
    ct_mass_matrix_derive(&w);
    c->M = w.eqs->M;
    c->nM = w.eqs->nM;
    take_rows(b, &w, c);
    for (size_t i = 0; i < w.nflexible; i++)
        for (int e = 1; e <= w.flexible[i].nstart; e++)
            list_sum(b, &w.flexible[i], e, c);
    return c;
}

// ---- P ------------------------------------------------------------------------------------------------------

void ct_carried_extend(struct ct_exs *x, const struct ct_carried *c, ct_ex *y)
{
    for (size_t i = c->nu; i < c->n; i++)
        y[i] = CT_EX_ZERO;
    for (size_t i = 0; i < c->nsum; i++) {
        const struct ct_entry *s = &c->sum[i];
        y[s->row] = ct_ex_add_product(x, y[s->row], s->value, y[s->column]);
    }
}

void ct_carried_fold(struct ct_exs *x, const struct ct_carried *c, ct_ex *f)
{
    for (size_t i = c->nsum; i-- > 0;) {
        const struct ct_entry *s = &c->sum[i];
        f[s->column] = ct_ex_add_product(x, f[s->column], s->value, f[s->row]);
    }
}
