// See beam_augmented.h.
//
// The equations are derived a second time from a copy of the build with the same expressions. In
// the copy the condensed rotations and the foreshortening at the starts of elements are additional
// elastic coordinates. A section moves by these and by the dofs of its own element.
#include "formulate/closed_form/beam_augmented.h"

#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/kinematics/constraint_row.h"
#include "formulate/dynamics/small_motion.h"
#include "formulate/dynamics/dynamics.h"

#include <limits.h>
#include <string.h>

static const ct_ex3 along = {{{1}, {0}, {0}}};

static long pairs(long n)
{
    return n * (n + 1) / 2;
}

// Does M_c have fewer entries than M between the coordinates of f? With condensed rotations each
// entry of M is a sum over all elements.
static bool is_sparser(const struct ct_flexible *f)
{
    long n = 0;
    for (int e = 0; e < f->beam->nelement; e++) {
        int sign, own = e > 0;
        for (int j = 0; j < CT_DOF; j++)
            own += ct_dof_freedom(f, e, j, &sign) != NULL;
        n += pairs(own);
    }
    return n < pairs(f->nelastic) * (f->condensation ? f->beam->nelement : 1);
}

static bool is_augmented(const struct ct_flexible *f)
{
    return ct_flexible_is_augmented(f) && is_sparser(f);
}

static void *copy(struct ct_arena *a, const void *from, size_t n, size_t size)
{
    void *to = ct_arena_calloc(a, n + 1, size);
    if (n)
        memcpy(to, from, n * size);
    return to;
}

// ---- further coordinates ------------------------------------------------------------------------

// Makes the condensed rotations coordinates, numbered from k.
static void make_coordinates(struct ct_build *w, struct ct_flexible *f, int k)
{
    const int n = CT_NODE_FREEDOM * (f->beam->nelement + 1);
    f->freedom = copy(w->arena, f->freedom, (size_t)n, sizeof *f->freedom);
    for (int i = 0; i < n; i++) {
        const int number = ct_condensation_number(f, i);
        if (number < 0)
            continue;
        f->freedom[i].npart = 1;
        f->freedom[i].part = CT_NEW(w->arena, struct ct_part);
        *f->freedom[i].part = (struct ct_part){k + number, CT_EX_ONE};
    }
}

// Appends the condensed rotations and element starts of f to its elastic coordinates. Their speeds
// are numbered from nu.
static void add_coordinates(struct ct_build *w, struct ct_flexible *f)
{
    const int n = f->nelastic, ncondensed = ct_condensation_count(f);
    struct ct_elastic *all
        = CT_NEWN(w->arena, struct ct_elastic, n + ncondensed + f->beam->nelement);
    memcpy(all, f->elastic, (size_t)n * sizeof *all);
    make_coordinates(w, f, n);
    f->nstart = f->beam->nelement - 1;
    f->nelastic += ncondensed + f->nstart;
    for (int k = n; k < f->nelastic; k++)
        all[k] = (struct ct_elastic){.u = (int)w->eqs->nu++, .freedom = -1};
    f->elastic = all;
    f->former_condensation = f->condensation;
    f->condensation = NULL; // condensed rotations are coordinates now
}

// Sets the motion of a section by the dofs of its own element and by the start of that element.
static void move_by_element(struct ct_build *w, const struct ct_flexible *f,
                            struct ct_edge_kinematics *e)
{
    e->translation = CT_NEWN(w->arena, ct_ex3, f->nelastic + 1);
    e->rotation = CT_NEWN(w->arena, ct_ex3, f->nelastic + 1);
    ct_station_own_partials(w, f, e->station, e->translation, e->rotation);
    if (e->station->element > 0)
        e->translation[ct_flexible_start(f, e->station->element)] = along;
}

// A copy of b with the additional coordinates; NULL: no beam has any.
static struct ct_build *clone_augmented(const struct ct_build *b)
{
    struct ct_arena *a = b->arena;
    bool any = false;
    for (size_t i = 0; i < b->nflexible; i++)
        any = any || is_augmented(&b->flexible[i]);
    if (!any)
        return NULL;
    struct ct_build *w = copy(a, b, 1, sizeof *b);
    w->eqs = copy(a, b->eqs, 1, sizeof *b->eqs);
    w->eqs->M = NULL;
    w->eqs->nM = w->eqs->M_cap = 0;
    w->flexible = copy(a, b->flexible, b->nflexible, sizeof *b->flexible);
    struct ct_kinematics *k = copy(a, b->kinematics, 1, sizeof *k);
    k->edge = copy(a, k->edge, b->topology->nedge, sizeof *k->edge);
    k->anchor = copy(a, k->anchor, k->nanchor, sizeof *k->anchor);
    k->rotation_axis = copy(a, k->rotation_axis, k->nrotation_axis, sizeof *k->rotation_axis);
    w->kinematics = k;
    w->cache.anchor = copy(a, b->cache.anchor, k->nanchor, sizeof *b->cache.anchor);
    w->cache.coefficient = NULL;
    for (size_t i = 0; i < w->nflexible; i++)
        if (is_augmented(&w->flexible[i]))
            add_coordinates(w, &w->flexible[i]);
    for (size_t i = 0; i < w->topology->nedge; i++) {
        const struct ct_flexible *f = ct_flexible_of_edge(w, &w->topology->edge[i]);
        if (f && f->nstart)
            move_by_element(w, f, &k->edge[i]);
    }
    ct_translation_slide_sections(w, k);
    ct_rotation_turn_sections(w, k);
    return w;
}

// ---- entries ------------------------------------------------------------------------------------

// Derives J_c: columns of beam coordinates from the new motion of the sections, other columns as in
// J.
static void take_rows(const struct ct_build *b, struct ct_build *w, struct ct_beam_augmented *c)
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

static void push_link(const struct ct_build *b, struct ct_beam_augmented *c, int row,
                      int column, ct_ex v)
{
    CT_PUSH(b->arena, c->L, c->nL, c->L_cap, ((struct ct_entry){row, column, v}));
}

static void push_sum(const struct ct_build *b, struct ct_beam_augmented *c, int row, int column,
                     ct_ex v)
{
    CT_PUSH(b->arena, c->sum, c->nsum, c->sum_cap, ((struct ct_entry){row, column, v}));
    push_link(b, c, row, column, ct_ex_neg(b->x, v));
}

// Index of the unknown for a nodal freedom of a beam with all coordinates.
static int unknown_of(const struct ct_flexible *f, const struct ct_freedom *d)
{
    return f->elastic[d->part[0].k].u;
}

// Lists the equation for c at the start of element i, from c and the dofs of the previous element.
static void list_start(const struct ct_build *b, const struct ct_flexible *f, int i,
                       struct ct_beam_augmented *c)
{
    const struct ct_element *before = &f->element[i - 1];
    const int row = f->elastic[ct_flexible_start(f, i)].u;
    push_link(b, c, row, row, CT_EX_ONE);
    if (i > 1)
        push_sum(b, c, row, f->elastic[ct_flexible_start(f, i - 1)].u, CT_EX_ONE);
    for (int j = 2; j < CT_BENT_DOF; j++) {
        int sign;
        const struct ct_freedom *d = ct_dof_freedom(f, i - 1, j, &sign);
        if (d && d->npart && !ct_ex_is_zero(before->g[j]))
            push_sum(b, c, row, unknown_of(f, d), ct_ex_scale(b->x, sign, before->g[j]));
    }
}

// Lists the equilibrium equation of condensed rotation k.
static void list_equilibrium(const struct ct_build *b, const struct ct_flexible *f,
                             const struct ct_flexible *with, int k, struct ct_beam_augmented *c)
{
    int n;
    const struct ct_condensation_term *equilibrium = ct_condensation_equilibrium(f, k, &n);
    const int row = with->elastic[f->nelastic + k].u;
    push_link(b, c, row, row, CT_EX_ONE);
    for (int i = 0; i < n; i++)
        push_link(b, c, row, unknown_of(with, &with->freedom[equilibrium[i].freedom]),
                  ct_ex_const(b->x, equilibrium[i].by));
}

static void list_positions(const struct ct_build *w, struct ct_beam_augmented *c)
{
    c->position_along = CT_NEWN(w->arena, int, c->n + 1);
    for (size_t i = 0; i < c->n; i++)
        c->position_along[i] = INT_MAX;
    for (size_t i = 0; i < w->nflexible; i++) {
        const struct ct_flexible *f = &w->flexible[i];
        const int nnode = f->beam->nelement + 1;
        for (int k = 0; k < CT_NODE_FREEDOM * nnode && f->nstart; k++)
            if (f->freedom[k].npart)
                c->position_along[unknown_of(f, &f->freedom[k])] = nnode - k / CT_NODE_FREEDOM;
        for (int e = 1; e <= f->nstart; e++)
            c->position_along[f->elastic[ct_flexible_start(f, e)].u] = nnode - e;
    }
}

struct ct_beam_augmented *ct_beam_augmented_derive(struct ct_build *b)
{
    struct ct_build *w = ct_small_motion_is_wanted(b) ? NULL : clone_augmented(b);
    if (!w)
        return NULL;
    struct ct_beam_augmented *c = CT_NEW(b->arena, struct ct_beam_augmented);
    *c = (struct ct_beam_augmented){.nu = b->eqs->nu, .n = w->eqs->nu, .build = w};
    ct_mass_matrix_derive(w);
    c->M = w->eqs->M;
    c->nM = w->eqs->nM;
    take_rows(b, w, c);
    list_positions(w, c);
    for (size_t i = 0; i < w->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i], *with = &w->flexible[i];
        for (int k = 0; with->nstart && k < ct_condensation_count(f); k++)
            list_equilibrium(b, f, with, k, c);
        for (int e = 1; e <= with->nstart; e++)
            list_start(b, with, e, c);
    }
    return c;
}

// ---- P ------------------------------------------------------------------------------------------

// Copies y to an array by nodal freedom, or back.
static void exchange(const struct ct_flexible *f, ct_ex *by_freedom, ct_ex *y, bool back)
{
    for (int i = 0; i < CT_NODE_FREEDOM * (f->beam->nelement + 1); i++)
        if (f->freedom[i].npart) {
            ct_ex *at = &y[unknown_of(f, &f->freedom[i])];
            *(back ? at : &by_freedom[i]) = *(back ? &by_freedom[i] : at);
        }
}

// Condensed rotations from the other freedoms, or (transposed) their forces distributed to those.
static void condense(struct ct_exs *x, struct ct_arena *scratch,
                     const struct ct_beam_augmented *c, ct_ex *y,
                     void (*by)(struct ct_exs *x, const struct ct_condensation *s,
                                ct_ex *by_freedom))
{
    const struct ct_build *w = c->build;
    for (size_t i = 0; i < w->nflexible; i++) {
        const struct ct_flexible *f = &w->flexible[i];
        if (!f->nstart || !f->former_condensation)
            continue;
        ct_ex *v = CT_NEWN(scratch, ct_ex, CT_NODE_FREEDOM * (f->beam->nelement + 1));
        exchange(f, v, y, false);
        by(x, f->former_condensation, v);
        exchange(f, v, y, true);
    }
}

void ct_beam_augmented_extend(struct ct_exs *x, struct ct_arena *scratch,
                              const struct ct_beam_augmented *c, ct_ex *y)
{
    for (size_t i = c->nu; i < c->n; i++)
        y[i] = CT_EX_ZERO;
    condense(x, scratch, c, y, ct_condensation_extend);
    for (size_t i = 0; i < c->nsum; i++) {
        const struct ct_entry *s = &c->sum[i];
        y[s->row] = ct_ex_add_product(x, y[s->row], s->value, y[s->column]);
    }
}

void ct_beam_augmented_project(struct ct_exs *x, struct ct_arena *scratch,
                               const struct ct_beam_augmented *c, ct_ex *f)
{
    for (size_t i = c->nsum; i-- > 0;) {
        const struct ct_entry *s = &c->sum[i];
        f[s->column] = ct_ex_add_product(x, f[s->column], s->value, f[s->row]);
    }
    condense(x, scratch, c, f, ct_condensation_forces);
}
