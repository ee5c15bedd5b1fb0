// See articulated_beam.h.
#include "formulate/recursive/articulated_beam.h"

#include <string.h>

enum { FREEDOMS = CT_NODE_FREEDOM };

// ---- arithmetic ---------------------------------------------------------------------------------

static ct_ex force_of(const struct ct_articulated_body *k, int i)
{
    return i < 3 ? k->n.e[i] : k->f.e[i - 3];
}

static ct_ex product(struct ct_exs *x, const ct_ex *v, const ct_ex *w)
{
    ct_ex sum = CT_EX_ZERO;
    for (int r = 0; r < CT_SPATIAL_SIZE; r++)
        sum = ct_ex_add(x, sum, ct_ex_mul(x, v[r], w[r]));
    return sum;
}

static bool is_zero(const ct_ex *v)
{
    for (int r = 0; r < CT_SPATIAL_SIZE; r++)
        if (!ct_ex_is_zero(v[r]))
            return false;
    return true;
}

static ct_ex entry_of(const struct ct_articulated_beam *e, int k, int l)
{
    return ct_symmetric_get(&e->M, (size_t)k, (size_t)l);
}

static void add_entry(struct ct_exs *x, struct ct_articulated_beam *e, int k, int l, ct_ex v)
{
    ct_symmetric_add(x, &e->M, (size_t)k, (size_t)l, v);
}

static int place_of(const struct ct_articulated_beam *e, int speed)
{
    return speed < 0 ? e->n - speed : e->number[speed];
}

static void add_to(struct ct_exs *x, ct_ex *sum, ct_ex v)
{
    *sum = ct_ex_add(x, *sum, v);
}

// Are condensed rotations kept as auxiliary unknowns? Yes in a CHAIN, where elements depend on
// them, and where one rotates a section that carries members.
static bool keeps_condensed_rotations(const struct ct_articulated *w, size_t i)
{
    const struct ct_flexible *f = &w->b->flexible[i];
    if (ct_flexible_is_augmented(f))
        return true;
    for (size_t k = 1; k < w->s->n; k++) {
        const struct ct_member *m = &w->s->member[k];
        for (int j = 0; j < m->nfree && m->beam == (int)i + 1; j++)
            if (m->screw[j].speed < -f->beam->nelement + 1)
                return true;
    }
    return false;
}

void ct_articulated_beam_start(struct ct_articulated *w, size_t i)
{
    struct ct_build *b = w->b;
    struct ct_articulated_beam *e = &w->elastic[i];
    const struct ct_flexible *f = e->f = &b->flexible[i];
    e->n = f->nelastic;
    e->is_augmented = ct_flexible_is_augmented(f);
    e->ncondensed = keeps_condensed_rotations(w, i) ? ct_condensation_count(f) : 0;
    e->nall
        = e->n + (e->is_augmented || e->ncondensed ? f->beam->nelement : 0) + 2 * e->ncondensed;
    const size_t n = (size_t)e->nall;
    e->number = CT_NEWN(w->work, int, b->eqs->nu + 1);
    for (size_t k = 0; k < b->eqs->nu; k++)
        e->number[k] = -1;
    for (int k = 0; k < e->n; k++)
        e->number[f->elastic[k].u] = k;
    e->M = ct_symmetric_create(w->work, n);
    e->row = CT_NEWN(w->work, ct_ex, n + 1);
    e->a = CT_NEWN(w->work, ct_ex, n + 1);
    e->G = CT_NEWN(w->work, struct ct_spatial_vector, n + 1);
    e->order = CT_NEWN(w->work, int, n + 1);
    e->is_done = CT_NEWN(w->work, bool, n + 1);
}

// Index of condensed rotation k among the unknowns; index of its multiplier.
static int condensed_index(const struct ct_articulated_beam *e, int k)
{
    return e->n + e->f->beam->nelement + k;
}

static int multiplier(const struct ct_articulated_beam *e, int k)
{
    return condensed_index(e, k) + e->ncondensed;
}

// Is the unknown at this index the foreshortening at the start of an element?
static bool is_start(const struct ct_articulated_beam *e, int place)
{
    return e->is_augmented && place >= e->n && place < condensed_index(e, 0);
}

static int freedom_place(const struct ct_articulated_beam *e, int freedom)
{
    const struct ct_freedom *d = &e->f->freedom[freedom];
    const int k = ct_condensation_number(e->f, freedom);
    return k >= 0 ? condensed_index(e, k) : d->npart ? d->part[0].k : -1;
}

// Index and sign of dof j of element i; -1: fixed.
static int dof_place(const struct ct_articulated_beam *e, int i, int j, int *sign)
{
    const struct ct_freedom *d = ct_dof_freedom(e->f, i, j, sign);
    return d ? freedom_place(e, (int)(d - e->f->freedom)) : -1;
}

// Adds the mass matrix of the elements in terms of their dofs and c.
static void add_elements(struct ct_articulated *w, struct ct_articulated_body *k,
                         struct ct_articulated_beam *e, const ct_ex33 *A,
                         struct ct_elastic_columns *c)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    struct ct_element_sums *s = e->f->inertia->method->sums(b, e->f);
    for (int i = 0; i < e->f->beam->nelement; i++) {
        ct_element_close(x, &s[i]);
        const int carried = e->n + i;
        for (int j = 0; j < CT_DOF; j++) {
            int sign;
            const int at = dof_place(e, i, j, &sign);
            if (at < 0)
                continue;
            const ct_ex one = ct_ex_const(x, sign);
            c->m_rf[at] = ct_ex3_add(x, c->m_rf[at], ct_ex3_scale(x, one, s[i].m_rf[j]));
            c->m_thetaf[at]
                = ct_ex3_add(x, c->m_thetaf[at], ct_ex3_scale(x, one, s[i].m_thetaf[j]));
            for (int l = 0; l < CT_DOF; l++) {
                int other;
                const int to = dof_place(e, i, l, &other);
                if (to >= 0 && to <= at) // the transposed pair is visited separately
                    add_entry(x, e, at, to, ct_ex_scale(x, sign * other, s[i].M[j][l]));
            }
            if (i > 0)
                add_entry(x, e, carried, at, ct_ex_scale(x, sign, s[i].m_rf[j].e[0]));
        }
        if (i == 0)
            continue; // the first element has no predecessor
        const ct_ex3 along = {{s[i].m, CT_EX_ZERO, CT_EX_ZERO}};
        const ct_ex3 about = {{CT_EX_ZERO, s[i].moment.e[2], ct_ex_neg(x, s[i].moment.e[1])}};
        const ct_ex3 f = ct_ex33_apply(x, A, along), n = ct_ex33_apply(x, A, about);
        add_entry(x, e, carried, carried, s[i].m);
        for (int r = 0; r < CT_SPATIAL_SIZE; r++)
            add_to(x, &k->C[carried].e[r], r < 3 ? n.e[r] : f.e[r - 3]);
    }
}

// Adds inertia, stiffness, damping and velocity-dependent forces of the beam at its base, in axes
// of the member.
static void add_beam(struct ct_articulated *w, int i, struct ct_articulated_beam *e,
                     const ct_ex33 *A)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    const struct ct_flexible *f = e->f;
    const struct ct_inertia *I = f->inertia;
    struct ct_articulated_body *k = &w->body[i];
    struct ct_symmetric M = ct_symmetric_create(w->work, b->eqs->nu); // by speed
    struct ct_elastic_columns c = {CT_NEWN(b->ctx->scratch, ct_ex3, e->nall + 1),
                                   CT_NEWN(b->ctx->scratch, ct_ex3, e->nall + 1)};
    const struct ct_base motion = {.w = ct_ex33_apply_t(x, A, w->s->member[i].w)};
    ct_ex3 F, T, lessF, lessT;
    const struct ct_base effective = ct_flexible_effective_base(b, f, &motion, &lessF, &lessT);
    I->method->wrench(b, f, &effective, CT_BIAS, &F, &T);
    F = ct_ex3_sub(x, F, lessF);
    T = ct_ex3_sub(x, T, lessT);
    ct_flexible_rows(b, f, &effective, CT_BIAS, w->row);
    if (e->is_augmented) {
        add_elements(w, k, e, A, &c);
    } else
        ct_flexible_columns(b, f, &c, &M);
    k->n = ct_ex3_add(x, k->n, ct_ex33_apply(x, A, T));
    k->f = ct_ex3_add(x, k->f, ct_ex33_apply(x, A, F));
    for (int j = 0; j < e->nall; j++) {
        const ct_ex3 m_thetaf = ct_ex33_apply(x, A, c.m_thetaf[j]),
                     m_rf = ct_ex33_apply(x, A, c.m_rf[j]);
        for (int r = 0; r < CT_SPATIAL_SIZE; r++)
            k->C[j].e[r] = ct_ex_add(x, k->C[j].e[r], r < 3 ? m_thetaf.e[r] : m_rf.e[r - 3]);
    }
    for (int j = 0; j < e->n; j++) {
        const struct ct_symmetric_row *row = &M.row[f->elastic[j].u];
        e->row[j] = ct_ex_add(x, e->row[j], w->row[f->elastic[j].u]);
        for (size_t l = 0; l < row->n; l++) {
            const int to = e->number[row->place[l].column];
            if (to <= j)
                add_entry(x, e, j, to, M.value[row->place[l].value]);
        }
    }
}

// Adds the elastic coordinates that move this member.
static void add_screws(struct ct_articulated *w, int i, struct ct_articulated_beam *e)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    struct ct_articulated_body *k = &w->body[i];
    struct ct_spatial_vector *P
        = CT_NEWN(w->b->ctx->scratch, struct ct_spatial_vector, m->nfree + 1),
        *S = CT_NEWN(w->b->ctx->scratch, struct ct_spatial_vector, m->nfree + 1);
    for (int j = 0; j < m->nfree; j++) {
        const int own = place_of(e, m->screw[j].speed);
        ct_articulated_project(w, k, &m->screw[j], P[j].e);
        for (int r = 0; r < CT_SPATIAL_SIZE; r++) {
            S[j].e[r] = ct_screw_direction(&m->screw[j], r);
            e->row[own] = ct_ex_add(x, e->row[own], ct_ex_mul(x, S[j].e[r], force_of(k, r)));
        }
        for (int l = 0; l < e->nall; l++) {
            const ct_ex v = product(x, S[j].e, k->C[l].e);
            add_entry(x, e, own, l, l == own ? ct_ex_scale(x, 2, v) : v);
        }
        for (int l = 0; l <= j; l++)
            add_entry(x, e, own, place_of(e, m->screw[l].speed), product(x, S[l].e, P[j].e));
    }
    for (int j = 0; j < m->nfree; j++) {
        ct_ex *C = k->C[place_of(e, m->screw[j].speed)].e;
        for (int r = 0; r < CT_SPATIAL_SIZE; r++)
            C[r] = ct_ex_add(x, C[r], P[j].e[r]);
    }
}

// Reduced inertia of the body after one elimination, I - G C', and its forces.
static void reduce_body(struct ct_exs *x, struct ct_articulated_body *k,
                        const struct ct_spatial_vector *G, const struct ct_spatial_vector *C,
                        ct_ex rest)
{
    for (int r = 0; r < CT_SPATIAL_SIZE; r++) {
        for (int c = 0; c <= r; c++)
            ct_articulated_set(
                k, r, c,
                ct_ex_sub(x, ct_articulated_entry(k, r, c), ct_ex_mul(x, G->e[r], C->e[c])));
        *ct_articulated_force(k, r)
            = ct_ex_add(x, *ct_articulated_force(k, r), ct_ex_mul(x, C->e[r], rest));
    }
}

// Eliminates the elastic acceleration e_j''.
static void eliminate_coordinate(struct ct_articulated *w, struct ct_articulated_body *k,
                                 struct ct_articulated_beam *e, int j)
{
    struct ct_exs *x = w->b->x;
    const int speed = e->f->elastic[j].u;
    const ct_ex D = w->pivot[speed] = entry_of(e, j, j), g = ct_ex_div(x, CT_EX_ONE, D);
    const ct_ex rest = e->row[j];
    e->is_done[j] = true;
    e->order[e->nstep++] = j;
    e->row[j] = ct_ex_mul(x, rest, g);
    for (int r = 0; r < CT_SPATIAL_SIZE; r++)
        e->G[j].e[r] = ct_ex_mul(x, k->C[j].e[r], g);
    const struct ct_symmetric_row *row = &e->M.row[j];
    for (size_t at = row->n; at-- > 0;) {
        const size_t l = row->place[at].column, value = row->place[at].value;
        if (e->is_done[l] || ct_ex_is_zero(e->M.value[value]))
            continue;
        const ct_ex a = ct_ex_mul(x, e->M.value[value], g);
        for (size_t i = 0; i <= at; i++)
            if (!e->is_done[row->place[i].column])
                ct_symmetric_subtract(x, &e->M, l, row->place[i].column,
                                      ct_ex_mul(x, a, e->M.value[row->place[i].value]));
        for (int r = 0; r < CT_SPATIAL_SIZE; r++)
            k->C[l].e[r] = ct_ex_sub(x, k->C[l].e[r], ct_ex_mul(x, a, k->C[j].e[r]));
        e->row[l] = ct_ex_sub(x, e->row[l], ct_ex_mul(x, a, rest));
        e->M.value[value] = a;
    }
    reduce_body(x, k, &e->G[j], &k->C[j], e->row[j]);
}

// Columns (n, out), ascending, of two rows that are left to be eliminated.
static const size_t *columns_of(const struct ct_articulated *w,
                                const struct ct_articulated_beam *e, const int rows[2],
                                size_t *n)
{
    const struct ct_symmetric_row *p = &e->M.row[rows[0]], *q = &e->M.row[rows[1]];
    size_t *column = CT_NEWN(w->work, size_t, p->n + q->n + 1);
    *n = 0;
    for (size_t i = 0, j = 0; i < p->n || j < q->n;) {
        const size_t a = i < p->n ? p->place[i].column : SIZE_MAX,
                     b = j < q->n ? q->place[j].column : SIZE_MAX, c = a < b ? a : b;
        i += a == c;
        j += b == c;
        if (!e->is_done[c]
            && !(ct_ex_is_zero(ct_symmetric_get(&e->M, (size_t)rows[0], c))
                 && ct_ex_is_zero(ct_symmetric_get(&e->M, (size_t)rows[1], c))))
            column[(*n)++] = c;
    }
    return column;
}

// Eliminates a condensed rotation together with its multiplier, block [h p; p q]. It is regular: h
// >= 0 is an inertia and q <= 0 belongs to multipliers, so that h q <= 0 < p^2.
static void eliminate_condensed_rotation(struct ct_articulated *w,
                                         struct ct_articulated_body *k,
                                         struct ct_articulated_beam *e, int number)
{
    struct ct_exs *x = w->b->x;
    const int at[2] = {condensed_index(e, number), multiplier(e, number)};
    const ct_ex h = entry_of(e, at[0], at[0]), p = entry_of(e, at[0], at[1]),
                q = entry_of(e, at[1], at[1]),
                g
                = ct_ex_div(x, CT_EX_ONE, ct_ex_sub(x, ct_ex_mul(x, h, q), ct_ex_mul(x, p, p)));
    const ct_ex minus = ct_ex_neg(x, ct_ex_mul(x, p, g));
    const ct_ex inverse[2][2] = {{ct_ex_mul(x, q, g), minus}, {minus, ct_ex_mul(x, h, g)}};
    const ct_ex rest[2] = {e->row[at[0]], e->row[at[1]]};
    for (int i = 0; i < 2; i++) {
        e->is_done[at[i]] = true;
        e->order[e->nstep++] = at[i];
        e->row[at[i]] = ct_ex_add(x, ct_ex_mul(x, inverse[i][0], rest[0]),
                                  ct_ex_mul(x, inverse[i][1], rest[1]));
        for (int r = 0; r < CT_SPATIAL_SIZE; r++)
            e->G[at[i]].e[r] = ct_ex_add(x, ct_ex_mul(x, inverse[i][0], k->C[at[0]].e[r]),
                                         ct_ex_mul(x, inverse[i][1], k->C[at[1]].e[r]));
    }
    // both are found together in the back substitution
    *ct_symmetric_at(&e->M, (size_t)at[0], (size_t)at[1]) = CT_EX_ZERO;
    size_t n;
    const size_t *other = columns_of(w, e, at, &n);
    for (size_t at_l = n; at_l-- > 0;) {
        const int l = (int)other[at_l];
        const ct_ex to[2] = {entry_of(e, at[0], l), entry_of(e, at[1], l)};
        ct_ex a[2];
        for (int i = 0; i < 2; i++)
            a[i] = ct_ex_add(x, ct_ex_mul(x, inverse[i][0], to[0]),
                             ct_ex_mul(x, inverse[i][1], to[1]));
        for (int i = 0; i < 2; i++) {
            for (size_t j = 0; j <= at_l; j++)
                ct_symmetric_subtract(x, &e->M, other[at_l], other[j],
                                      ct_ex_mul(x, a[i], entry_of(e, at[i], (int)other[j])));
            for (int r = 0; r < CT_SPATIAL_SIZE; r++)
                k->C[l].e[r] = ct_ex_sub(x, k->C[l].e[r], ct_ex_mul(x, a[i], k->C[at[i]].e[r]));
            e->row[l] = ct_ex_sub(x, e->row[l], ct_ex_mul(x, a[i], rest[i]));
        }
        for (int i = 0; i < 2; i++)
            *ct_symmetric_at(&e->M, (size_t)at[i], other[at_l]) = a[i];
    }
    for (int i = 0; i < 2; i++)
        reduce_body(x, k, &e->G[at[i]], &k->C[at[i]], e->row[at[i]]);
}

// c of element i as a weighted sum of unknowns: indices and weights (CT_AXIS_DOF + 1 of each).
// Returns their number.
static int start_as_sum(struct ct_articulated *w, const struct ct_articulated_beam *e, int i,
                        int *place, ct_ex *weight)
{
    int n = 0, sign;
    if (i > 1) {
        place[n] = e->n + i - 1;
        weight[n++] = CT_EX_ONE;
    }
    for (int j = 2; j < CT_BENT_DOF; j++) {
        const int at = dof_place(e, i - 1, j, &sign);
        if (at < 0)
            continue;
        place[n] = at;
        weight[n++] = ct_ex_scale(w->b->x, sign, e->f->element[i - 1].g[j]);
    }
    return n;
}

// Substitutes c of element i by its sum, after everything beyond its start is eliminated.
static void substitute_start(struct ct_articulated *w, struct ct_articulated_body *k,
                             struct ct_articulated_beam *e, int i)
{
    struct ct_exs *x = w->b->x;
    const int p = e->n + i;
    int place[CT_AXIS_DOF + 1];
    ct_ex weight[CT_AXIS_DOF + 1];
    const int n = start_as_sum(w, e, i, place, weight);
    const ct_ex own = entry_of(e, p, p);
    const struct ct_symmetric_row *row = &e->M.row[p];
    e->is_done[p] = true;
    e->order[e->nstep++] = p;
    for (int t = 0; t < n; t++) {
        for (size_t l = 0; l < row->n; l++) {
            const int z = (int)row->place[l].column;
            const ct_ex v = ct_ex_mul(x, weight[t], e->M.value[row->place[l].value]);
            if (!e->is_done[z])
                add_entry(x, e, place[t], z, z == place[t] ? ct_ex_scale(x, 2, v) : v);
        }
        const ct_ex heavy = ct_ex_mul(x, weight[t], own);
        for (int u = 0; u <= t; u++)
            add_entry(x, e, place[t], place[u], ct_ex_mul(x, weight[u], heavy));
        for (int r = 0; r < CT_SPATIAL_SIZE; r++)
            add_to(x, &k->C[place[t]].e[r], ct_ex_mul(x, weight[t], k->C[p].e[r]));
        add_to(x, &e->row[place[t]], ct_ex_mul(x, weight[t], e->row[p]));
    }
}

static void eliminate_condensed_rotations(struct ct_articulated *w,
                                          struct ct_articulated_body *k,
                                          struct ct_articulated_beam *e, int node)
{
    for (int j = FREEDOMS; j-- > 0;) {
        const int number = ct_condensation_number(e->f, FREEDOMS * node + j);
        if (number >= 0)
            eliminate_condensed_rotation(w, k, e, number);
    }
}

// Adds the equilibrium equations of the condensed rotations, with their multipliers.
static void add_equilibrium(struct ct_exs *x, struct ct_articulated_beam *e)
{
    for (int k = 0; k < e->ncondensed; k++) {
        int n;
        const struct ct_condensation_term *equilibrium
            = ct_condensation_equilibrium(e->f, k, &n);
        const size_t row = (size_t)multiplier(e, k);
        *ct_symmetric_at(&e->M, row, (size_t)condensed_index(e, k)) = CT_EX_ONE;
        for (int i = 0; i < n; i++)
            *ct_symmetric_at(&e->M, row, (size_t)freedom_place(e, equilibrium[i].freedom))
                = ct_ex_const(x, equilibrium[i].by);
    }
}

// Does any force act on the condensed rotations? None does if they only rotate sections with
// revolute or spherical joints.
static bool loads_condensed_rotations(struct ct_articulated_beam *e,
                                      const struct ct_spatial_vector *C)
{
    for (int k = 0; k < e->ncondensed; k++) {
        const int at = condensed_index(e, k);
        if (e->is_augmented || !ct_ex_is_zero(e->row[at]) || !is_zero(C[at].e))
            return true;
        for (size_t i = 0; i < e->M.row[at].n; i++)
            if (!ct_ex_is_zero(e->M.value[e->M.row[at].place[i].value]))
                return true;
    }
    return false;
}

static void eliminate_beam(struct ct_articulated *w, int i, struct ct_articulated_beam *e)
{
    struct ct_exs *x = w->b->x;
    struct ct_articulated_body *k = &w->body[i];
    for (int j = 0; j < e->n; j++)
        e->row[j] = ct_ex_sub(x, w->effort[e->f->elastic[j].u], e->row[j]);
    for (int j = e->n; j < e->nall; j++)
        e->row[j] = ct_ex_neg(x, e->row[j]);
    if (e->is_augmented)
        e->is_done[e->n] = true; // c of the first element is zero
    e->has_condensed_rotations = loads_condensed_rotations(e, k->C);
    if (e->has_condensed_rotations)
        add_equilibrium(x, e);
    int next = e->n;
    for (int node = e->f->beam->nelement;
         node > 0 && (e->is_augmented || e->has_condensed_rotations); node--) {
        int first = next; // coordinates are numbered node by node
        for (int j = 0; j < FREEDOMS; j++) {
            const int at = freedom_place(e, FREEDOMS * node + j);
            if (at >= 0 && at < first)
                first = at;
        }
        if (e->has_condensed_rotations)
            eliminate_condensed_rotations(w, k, e, node);
        while (next > first)
            eliminate_coordinate(w, k, e, --next);
        if (node > 1 && e->is_augmented)
            substitute_start(w, k, e, node - 1);
    }
    if (e->has_condensed_rotations)
        eliminate_condensed_rotations(w, k, e, 0);
    while (next > 0)
        eliminate_coordinate(w, k, e, --next);
}

void ct_articulated_beam_sum(struct ct_articulated *w, int i)
{
    const int number = w->s->member[i].beam - 1;
    const struct ct_member_beam *at = &w->s->beam[number];
    struct ct_articulated_beam *e = &w->elastic[number];
    struct ct_articulated_body *k = &w->body[i];
    if (!k->C)
        k->C = CT_NEWN(w->work, struct ct_spatial_vector, e->nall + 1);
    if (i == at->base)
        add_beam(w, i, e, &at->A);
    add_screws(w, i, e);
    if (i == at->root)
        eliminate_beam(w, i, e);
}

static ct_ex sum_of_parts(struct ct_exs *x, const struct ct_articulated_beam *e,
                          const struct ct_freedom *d)
{
    ct_ex sum = CT_EX_ZERO;
    for (int p = 0; p < d->npart; p++)
        sum = ct_ex_add(x, sum, ct_ex_mul(x, d->part[p].coef, e->a[d->part[p].k]));
    return sum;
}

// Finds e'' of all coordinates; A is the acceleration of the root without its motion by them.
static void find_accelerations(struct ct_articulated *w, const struct ct_articulated_body *root,
                               struct ct_articulated_beam *e, ct_ex *out)
{
    struct ct_exs *x = w->b->x;
    ct_ex A[CT_SPATIAL_SIZE];
    for (int r = 0; r < CT_SPATIAL_SIZE; r++)
        A[r] = r < 3 ? root->al.e[r] : root->a.e[r - 3];
    memset(e->is_done, 0, (size_t)e->nall * sizeof *e->is_done);
    for (int step = e->nstep; step-- > 0;) {
        const int j = e->order[step];
        if (!is_start(e, j)) {
            const struct ct_symmetric_row *row = &e->M.row[j];
            e->a[j] = ct_ex_sub(x, e->row[j], product(x, e->G[j].e, A));
            for (size_t i = 0; i < row->n; i++) {
                const size_t l = row->place[i].column;
                if (e->is_done[l])
                    e->a[j] = ct_ex_sub(x, e->a[j],
                                        ct_ex_mul(x, e->M.value[row->place[i].value], e->a[l]));
            }
            if (j < e->n)
                out[e->f->elastic[j].u] = e->a[j];
        } else {
            int place[CT_AXIS_DOF + 1];
            ct_ex weight[CT_AXIS_DOF + 1];
            const int n = start_as_sum(w, e, j - e->n, place, weight);
            for (int t = 0; t < n; t++)
                add_to(x, &e->a[j], ct_ex_mul(x, weight[t], e->a[place[t]]));
        }
        e->is_done[j] = true;
    }
    for (int i = 0;
         i < CT_NODE_FREEDOM * (e->f->beam->nelement + 1) && !e->has_condensed_rotations; i++)
        if (ct_condensation_number(e->f, i) >= 0 && e->ncondensed)
            e->a[freedom_place(e, i)] = sum_of_parts(x, e, &e->f->freedom[i]);
}

void ct_articulated_beam_transfer(struct ct_articulated *w, int i)
{
    const struct ct_articulated_beam *e = &w->elastic[w->s->member[i].beam - 1];
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    const ct_ex3 bias = ct_member_shift_bias(w->b, w->s, i);
    struct ct_articulated_body *p = &w->body[m->parent];
    if (!p->C)
        p->C = CT_NEWN(w->work, struct ct_spatial_vector, e->nall + 1);
    for (int j = 0; j < e->nall; j++) {
        const ct_ex *C = w->body[i].C[j].e;
        ct_ex3 n = {{C[0], C[1], C[2]}}, f = {{C[3], C[4], C[5]}};
        if (is_zero(C))
            continue;
        e->row[j] = ct_ex_add(x, e->row[j], ct_ex3_dot(x, n, m->al_relative));
        n = ct_member_out(w->b, m, n);
        f = ct_member_out(w->b, m, f);
        e->row[j] = ct_ex_add(x, e->row[j], ct_ex3_dot(x, f, bias));
        n = ct_ex3_add(x, n, ct_ex3_cross(x, m->r, f));
        for (int r = 0; r < CT_SPATIAL_SIZE; r++)
            p->C[j].e[r] = ct_ex_add(x, p->C[j].e[r], r < 3 ? n.e[r] : f.e[r - 3]);
    }
}

void ct_articulated_beam_accelerate(struct ct_articulated *w, int i, ct_ex *out)
{
    struct ct_exs *x = w->b->x;
    const struct ct_member *m = &w->s->member[i];
    struct ct_articulated_beam *e = &w->elastic[m->beam - 1];
    struct ct_articulated_body *k = &w->body[i];
    if (i == w->s->beam[m->beam - 1].root)
        find_accelerations(w, k, e, out);
    for (int j = 0; j < m->nfree; j++) {
        const ct_ex u = e->a[place_of(e, m->screw[j].speed)];
        k->al = ct_ex3_add(x, k->al, ct_ex3_scale(x, u, m->screw[j].rotation));
        k->a = ct_ex3_add(x, k->a, ct_ex3_scale(x, u, m->screw[j].translation));
    }
}
