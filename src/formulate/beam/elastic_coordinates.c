// Unknowns of a beam: nodal, modal, or coordinates of given shapes; see flexible_body.h.
#include "formulate/beam/legendre.h"
#include "formulate/beam/beam_field.h"
#include "formulate/beam/static_condensation.h"
#include "formulate/beam/massless_rotations.h"
#include "formulate/beam/modal_reduction.h"
#include "formulate/beam/degrees_of_freedom.h"

#include <math.h>

enum { NKIND = CT_NODE_FREEDOM };
static const char *const kind_name[NKIND] = {"u", "v", "w", "rx", "ry", "rz", "rm", "um"};

static enum ct_elastic_kind elastic_kind_of(int kind)
{
    return kind == CT_FREEDOM_U || kind == CT_FREEDOM_UM ? CT_ELASTIC_ALONG
         : kind < CT_FREEDOM_RX                          ? CT_ELASTIC_ACROSS
                                                         : CT_ELASTIC_TURN;
}

// freedom: its nodal freedom, or that of its static shape; -1: coordinate of a shape
static int new_unknown(struct ct_build *b, struct ct_flexible *f, const char *name,
                       enum ct_elastic_kind kind, int freedom)
{
    struct ct_equations *s = b->eqs;
    struct ct_q q = {.name = name, .quaternion = -1};
    struct ct_u u = {.name = ct_arena_printf(b->arena, "%s.u", name)};
    u.joint = u.body = -1;
    u.beam = f->body;
    u.kind = kind;
    u.is_rotation = kind == CT_ELASTIC_TURN;
    u.q = (int)s->nq;
    q.symbol = ct_ex_sym(b->x, CT_SYM_Q, name, (uint32_t)s->nq);
    u.symbol = q.rate = ct_ex_sym(b->x, CT_SYM_U, u.name, (uint32_t)s->nu);
    u.derivative
        = ct_ex_sym(b->x, CT_SYM_A, ct_arena_printf(b->arena, "%s.a", name), (uint32_t)s->nu);
    CT_PUSH(b->arena, s->q, s->nq, s->q_cap, q);
    CT_PUSH(b->arena, s->u, s->nu, s->u_cap, u);
    f->elastic[f->nelastic] = (struct ct_elastic){.name = name,
                                                  .q = u.q,
                                                  .u = (int)s->nu - 1,
                                                  .freedom = freedom,
                                                  .value = q.symbol,
                                                  .rate = u.symbol,
                                                  .acceleration = u.derivative};
    return f->nelastic++;
}

static void dof_values(struct ct_build *b, struct ct_flexible *f)
{
    for (int e = 0; e < f->beam->nelement; e++) {
        struct ct_element *self = &f->element[e];
        for (int j = 0; j < CT_DOF; j++) {
            int sign;
            const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
            if (!d)
                continue;
            self->value[j] = sign > 0 ? d->value : ct_ex_neg(b->x, d->value);
            self->rate[j] = sign > 0 ? d->rate : ct_ex_neg(b->x, d->rate);
            self->acceleration[j]
                = sign > 0 ? d->acceleration : ct_ex_neg(b->x, d->acceleration);
        }
    }
}

// Foreshortening of one element from the integrals E of slope products and of rotation gradients.
static void foreshorten_by_matrices(struct ct_build *b, struct ct_flexible *f, int e, ct_ex *c,
                                    ct_ex *rate, ct_ex *bias)
{
    struct ct_exs *x = b->x;
    struct ct_element *self = &f->element[e];
    for (int plane = 0; plane < 2; plane++) {
        const int first = plane ? 6 : 2;
        for (int j = 0; j < 4; j++) {
            ct_ex Ea = CT_EX_ZERO, Er = CT_EX_ZERO;
            for (int k = 0; k < 4; k++) {
                const ct_ex h = self->span.length;
                const ct_ex E
                    = ct_ex_add(x, ct_shape_at(x, &f->shortening[j][k], CT_EX_ONE, h),
                                ct_ex_mul(x, self->radius[plane],
                                          ct_shape_at(x, &f->curving[j][k], CT_EX_ONE, h)));
                Ea = ct_ex_add(x, Ea, ct_ex_mul(x, E, self->value[first + k]));
                Er = ct_ex_add(x, Er, ct_ex_mul(x, E, self->rate[first + k]));
            }
            self->g[first + j] = ct_ex_neg(x, Ea);
            *c = ct_ex_sub(x, *c,
                           ct_ex_scale(x, 0.5, ct_ex_mul(x, Ea, self->value[first + j])));
            *rate = ct_ex_sub(x, *rate, ct_ex_mul(x, Ea, self->rate[first + j]));
            *bias = ct_ex_sub(x, *bias, ct_ex_mul(x, Er, self->rate[first + j]));
        }
    }
}

// The same from Legendre coefficients of the slopes.
static void foreshorten_by_slopes(struct ct_build *b, struct ct_flexible *f, int e, ct_ex *c,
                                  ct_ex *rate, ct_ex *bias)
{
    struct ct_exs *x = b->x;
    struct ct_element *self = &f->element[e];
    const ct_ex h = self->span.length;
    const struct ct_foreshortening_products by
        = ct_foreshortening_total_forces(x, h, ct_ex_const(x, -1));
    struct ct_legendre_bending value[2], speed[2];
    for (int plane = 0; plane < 2; plane++) {
        const int first = plane ? 6 : 2;
        struct ct_legendre_bending force = {0};
        value[plane] = ct_legendre_bending_of(x, f->beam->theory, h, self->value + first);
        speed[plane] = ct_legendre_bending_of(x, f->beam->theory, h, self->rate + first);
        ct_foreshortening_products_add_forces(x, &value[plane], &by, &force);
        ct_legendre_bending_add_forces(x, f->beam->theory, h, &force, self->g + first);
    }
    const struct ct_foreshortening_products drawn
        = ct_foreshortening_products_of(x, value),
        first = ct_foreshortening_products_rate(x, value, speed),
        second = ct_foreshortening_products_rate(x, speed, speed);
    *c = ct_ex_sub(x, *c, ct_foreshortening_total(x, h, &drawn));
    *rate = ct_ex_sub(x, *rate, ct_foreshortening_total(x, h, &first));
    *bias = ct_ex_sub(x, *bias, ct_foreshortening_total(x, h, &second));
}

// Foreshortening c and its derivatives along the beam, by running sums.
static void run_chain(struct ct_build *b, struct ct_flexible *f)
{
    for (int e = 0; e < f->beam->nelement; e++) {
        struct ct_element *self = &f->element[e];
        ct_ex c = self->c, rate = self->c_rate, bias = self->c_bias;
        if (f->beam->higher_order)
            foreshorten_by_matrices(b, f, e, &c, &rate, &bias);
        else
            foreshorten_by_slopes(b, f, e, &c, &rate, &bias);
        if (e + 1 < f->beam->nelement) {
            self[1].c = c;
            self[1].c_rate = rate;
            self[1].c_bias = bias;
        }
    }
}

static void list_part(struct ct_freedom *d, int k, ct_ex coef)
{
    if (!ct_ex_is_zero(coef))
        d->part[d->npart++] = (struct ct_part){k, coef};
}

// Adds the term coef * coordinate k to a freedom.
static void add_part(struct ct_build *b, struct ct_flexible *f, struct ct_freedom *d, int k,
                     ct_ex coef)
{
    struct ct_exs *x = b->x;
    const struct ct_elastic *e = &f->elastic[k];
    list_part(d, k, coef);
    d->value = ct_ex_add(x, d->value, ct_ex_mul(x, coef, e->value));
    d->rate = ct_ex_add(x, d->rate, ct_ex_mul(x, coef, e->rate));
    d->acceleration = ct_ex_add(x, d->acceleration, ct_ex_mul(x, coef, e->acceleration));
}

// Freedom i as a sum of shapes; a condensed rotation gets its value from its neighbours.
static void combine_shapes(struct ct_build *b, struct ct_flexible *f, const struct ct_shapes *s,
                           int i)
{
    struct ct_freedom *d = &f->freedom[s->freedom[i]];
    d->part = CT_NEWN(b->arena, struct ct_part, s->nshape);
    const bool is_condensed = f->condensation && i >= s->nstatic;
    for (int k = 0; k < s->nshape; k++) {
        const ct_ex coef = ct_ex_const(b->x, s->shape[(size_t)i + (size_t)s->n * (size_t)k]);
        if (is_condensed)
            list_part(d, k, coef);
        else
            add_part(b, f, d, k, coef);
    }
}

static void unknowns_of_shapes(struct ct_build *b, struct ct_flexible *f,
                               const struct ct_shapes *s)
{
    for (int k = 0; k < s->nshape; k++) {
        const int i = k < s->nstatic ? s->freedom[k] : 0;
        new_unknown(b, f,
                    k < s->nstatic
                        ? ct_arena_printf(b->arena, "%s.%d.%s", f->name, i / NKIND,
                                          kind_name[i % NKIND])
                        : ct_arena_printf(b->arena, "%s.mode%d", f->name, k - s->nstatic + 1),
                    k < s->nstatic ? elastic_kind_of(i % NKIND) : CT_ELASTIC_MODE,
                    k < s->nstatic ? i : -1);
    }
    for (int i = 0; i < s->n; i++)
        combine_shapes(b, f, s, i);
    if (f->condensation)
        ct_condensation_values(b, f);
}

static void nodal_unknowns(struct ct_build *b, struct ct_flexible *f)
{
    const int nnode = f->beam->nelement + 1;
    for (int node = 0; node < nnode; node++)
        for (int kind = 0; kind < NKIND; kind++) {
            if (ct_freedom_is_fixed(f, node, kind))
                continue;
            const int k = new_unknown(
                b, f, ct_arena_printf(b->arena, "%s.%d.%s", f->name, node, kind_name[kind]),
                elastic_kind_of(kind), NKIND * node + kind);
            struct ct_freedom *d = &f->freedom[NKIND * node + kind];
            d->part = CT_NEW(b->arena, struct ct_part);
            add_part(b, f, d, k, CT_EX_ONE);
        }
}

// Column k of the freedoms' parts by coordinate, rotations times the element's length.
static void shape_column(struct ct_build *b, const struct ct_flexible *f, int k, double *v)
{
    for (int i = 0; i < NKIND * (f->beam->nelement + 1); i++) {
        const int kind = i % NKIND, e = i < NKIND ? 0 : i / NKIND - 1;
        const bool turns = kind == CT_FREEDOM_RY || kind == CT_FREEDOM_RZ;
        const struct ct_freedom *d = &f->freedom[i];
        v[i] = 0;
        for (int p = 0; p < d->npart; p++)
            if (d->part[p].k == k)
                v[i] = ct_ex_value(b->x, d->part[p].coef, b->value)
                     * (turns ? ct_ex_value(b->x, f->element[e].span.length, b->value) : 1);
    }
}

static double dot(const double *a, const double *c, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * c[i];
    return sum;
}

// Checks that no shape depends linearly on previous ones at the nodes, by Gram-Schmidt; marks: by
// coordinate.
static bool check_shapes(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_mark *marks)
{
    // Least norm of the independent part relative to the shape. Derived: the square root of the
    // unit round-off, the accuracy of that norm.
    const double least = 1e-8;
    const size_t n = (size_t)NKIND * ((size_t)f->beam->nelement + 1);
    double *Q = CT_NEWN(b->ctx->scratch, double, n *(size_t)f->nelastic + 1);
    for (int k = 0; k < f->nelastic; k++) {
        double *v = Q + n * (size_t)k;
        shape_column(b, f, k, v);
        const double size = sqrt(dot(v, v, n));
        for (int pass = 0; pass < 2; pass++)
            for (int l = 0; l < k; l++) {
                const double along = dot(v, Q + n * (size_t)l, n);
                for (size_t i = 0; i < n; i++)
                    v[i] -= along * Q[i + n * (size_t)l];
            }
        const double left = sqrt(dot(v, v, n));
        if (!(left > least * size))
            return ct_error(b->ctx, marks[k], CT_E_CONFLICT,
                            "shape '%s' is zero, or a sum of those before it, at the nodes of "
                            "%d element%s: leave it out, or take more elements",
                            f->elastic[k].name, f->beam->nelement,
                            f->beam->nelement == 1 ? "" : "s");
        for (size_t i = 0; i < n; i++)
            v[i] /= left;
    }
    return true;
}

// `shapes`: every freedom is a sum of the shapes at its node.
static void given_unknowns(struct ct_build *b, struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    int count[CT_BEAM_NFIELD] = {0};
    struct ct_mark *marks = CT_NEWN(b->ctx->scratch, struct ct_mark, beam->nshape + 1);
    for (int i = 0; i < NKIND * (beam->nelement + 1); i++)
        f->freedom[i].part = CT_NEWN(b->arena, struct ct_part, beam->nshape);
    for (int s = 0; s < beam->nshape; s++) {
        const enum ct_beam_field kind = beam->shape[s].kind;
        const int number = ++count[kind];
        if (!(f->deformation & ct_freedom_family((int)kind)))
            continue;
        const int k = new_unknown(
            b, f, ct_arena_printf(b->arena, "%s.%s%d", f->name, kind_name[kind], number),
            elastic_kind_of((int)kind), -1);
        marks[k] = beam->shape[s].mark;
        for (int i = 0; i < NKIND * (beam->nelement + 1); i++)
            if (!ct_freedom_is_fixed(f, i / NKIND, i % NKIND))
                add_part(
                    b, f, &f->freedom[i], k,
                    ct_field_freedom(b, f, kind, beam->shape[s].value, i / NKIND, i % NKIND));
    }
    check_shapes(b, f, marks);
}

// Do the trees connect bodies at a section of f other than its base?
static bool carries_bodies(const struct ct_build *b, const struct ct_flexible *f)
{
    for (size_t i = 0; i < b->topology->nnode; i++) {
        const int from = b->T.parent[i];
        if (from >= 0 && from != f->base && b->topology->node[from].body == f->body
            && b->topology->edge[b->T.parent_edge[i]].kind == CT_EDGE_JOINT)
            return true;
    }
    return false;
}

void ct_flexible_unknowns(struct ct_build *b, struct ct_flexible *f)
{
    f->elastic = CT_NEWN(b->arena, struct ct_elastic, NKIND * (f->beam->nelement + 1));
    struct ct_shapes s;
    const int bare = ct_flexible_bare_joint(b, f);
    if (bare >= 0) {
        b->eqs->bare_beam = f->body;
        b->eqs->bare_joint = bare;
    }
    if (f->beam->nshape && f->deformation)
        given_unknowns(b, f);
    else if (f->beam->modes && f->deformation && !ct_flexible_keeps_all_modes(b, f)) {
        if (ct_flexible_reduce(b, f, &s))
            unknowns_of_shapes(b, f, &s);
    } else if (ct_flexible_condense(b, f, &s)) {
        unknowns_of_shapes(b, f, &s);
        ct_build_note_left_out(b, ct_arena_printf(b->arena, "rotations of %s's nodes", f->name),
                               "without inertia and moment they follow the other coordinates");
    } else
        nodal_unknowns(b, f);
    if (f->formulation == CT_BEAM_STRETCH_LINEAR && carries_bodies(b, f))
        ct_build_note_left_out(
            b,
            ct_arena_printf(b->arena, "second order of %s's deflection in bodies on it",
                            f->name),
            "these trees count them from its points; '--tree absolute' keeps it");
    dof_values(b, f);
    if (f->axial == CT_AXIAL_CHAIN)
        run_chain(b, f);
    ct_fields_start(b, f);
}
