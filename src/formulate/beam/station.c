// Sections of a beam: position, rotation and their derivatives by the elastic coordinates; see
// flexible_body.h.
#include "formulate/beam/static_condensation.h"

#include <math.h>
#include <string.h>

enum { NKIND = CT_NODE_FREEDOM };
static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

ct_ex ct_element_field(struct ct_build *b, const struct ct_element *e,
                       const struct ct_shape *shape, const ct_ex *of, int from, int n, ct_ex xi)
{
    ct_ex sum = CT_EX_ZERO;
    for (int j = 0; j < n; j++)
        if (!ct_ex_is_zero(of[from + j]))
            sum = ct_ex_add(b->x, sum,
                            ct_ex_mul(b->x, ct_shape_at(b->x, &shape[j], xi, e->span.length),
                                      of[from + j]));
    return sum;
}

static ct_ex stretch_field(struct ct_build *b, const struct ct_flexible *f,
                           const struct ct_element *e, const ct_ex *of, ct_ex xi)
{
    return ct_ex_add(b->x, ct_element_field(b, e, f->line, of, 0, 2, xi),
                     ct_element_field(b, e, &f->line[2], of, CT_MIDDLE_DOF, 1, xi));
}

// (M a)_j with its sign; M: matrix of the quadratic term of the axial displacement.
static ct_ex quadratic_slope(struct ct_build *b, const struct ct_flexible *f, int e, int plane,
                             int j, const ct_ex *of, enum ct_axial axial, ct_ex xi)
{
    const struct ct_element *self = &f->element[e];
    const bool local = axial == CT_AXIAL_LOCAL;
    const struct ct_shape *row = local ? f->bubble[j] : f->shortening[j];
    ct_ex v = ct_element_field(b, self, row, of, plane ? 6 : 2, 4, xi);
    if (!ct_ex_is_zero(self->radius[plane]))
        v = ct_ex_add(
            b->x, v,
            ct_ex_mul(b->x, self->radius[plane],
                      ct_element_field(b, self, f->curving[j], of, plane ? 6 : 2, 4, xi)));
    return local ? v : ct_ex_neg(b->x, v);
}

void ct_axial_field(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex xi,
                    enum ct_axial axial, struct ct_axial_field *a)
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[e];
    memset(a, 0, sizeof *a);
    a->value = stretch_field(b, f, self, self->value, xi);
    a->rate = stretch_field(b, f, self, self->rate, xi);
    if (axial == CT_AXIAL_CHAIN) {
        a->value = ct_ex_add(x, a->value, self->c);
        a->rate = ct_ex_add(x, a->rate, self->c_rate);
        a->bias = self->c_bias;
    }
    for (int i = 0; i < CT_LINE_DOF; i++)
        a->slope[ct_stretch_dof(i)] = ct_shape_at(x, &f->line[i], xi, self->span.length);
    for (int plane = 0; plane < 2 && axial != CT_AXIAL_LINEAR; plane++)
        for (int j = 0; j < 4; j++) {
            const int dof = (plane ? 6 : 2) + j;
            const ct_ex s = quadratic_slope(b, f, e, plane, j, self->value, axial, xi);
            const ct_ex r = quadratic_slope(b, f, e, plane, j, self->rate, axial, xi);
            a->slope[dof] = s;
            a->value = ct_ex_add(x, a->value,
                                 ct_ex_scale(x, 0.5, ct_ex_mul(x, s, self->value[dof])));
            a->rate = ct_ex_add(x, a->rate, ct_ex_mul(x, s, self->rate[dof]));
            a->bias = ct_ex_add(x, a->bias, ct_ex_mul(x, r, self->rate[dof]));
        }
}

static int element_at(const struct ct_build *b, const struct ct_flexible *f, double x)
{
    int e = 0;
    while (e + 1 < f->beam->nelement && x > ct_ex_value(b->x, f->beam->end[e], b->value))
        e++;
    return e;
}

void ct_flexible_station(struct ct_build *b, const struct ct_flexible *f, ct_ex place,
                         enum ct_axial axial, struct ct_station *s)
{
    struct ct_exs *x = b->x;
    const double at = ct_ex_value(x, place, b->value);
    const int e = s->element = element_at(b, f, at);
    const struct ct_element *self = &f->element[e];
    const ct_ex xi = ct_ex_div(x, ct_ex_sub(x, place, self->span.start), self->span.length);
    const double where = ct_ex_value(x, xi, b->value);
    s->xi = fabs(where) < CT_SAME_PLACE     ? CT_EX_ZERO
          : fabs(where - 1) < CT_SAME_PLACE ? CT_EX_ONE
                                            : xi;
    struct ct_axial_field a;
    s->axial = axial;
    ct_axial_field(b, f, e, s->xi, axial, &a);
    s->position.e[0] = ct_ex_add(x, place, a.value);
    s->position.e[1] = ct_element_field(b, self, f->shape.deflection, self->value, 2, 4, s->xi);
    s->position.e[2] = ct_element_field(b, self, f->shape.deflection, self->value, 6, 4, s->xi);
    s->angle[0]
        = ct_element_field(b, self, f->line, self->value, CT_AXIS_DOF, CT_LINE_DOF, s->xi);
    s->angle[1]
        = ct_ex_neg(x, ct_element_field(b, self, f->shape.rotation, self->value, 6, 4, s->xi));
    s->angle[2] = ct_element_field(b, self, f->shape.rotation, self->value, 2, 4, s->xi);
}

// apart: condensed rotations come after the coordinates, not as sums of them.
static void add_partial(struct ct_build *b, const struct ct_flexible *f, int e, int j,
                        ct_ex3 value, ct_ex3 *by_coordinate, bool apart)
{
    int sign;
    const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
    const int condensed = d && apart ? ct_condensation_number(f, (int)(d - f->freedom)) : -1;
    if (condensed >= 0) {
        ct_ex3 *sum = &by_coordinate[f->nelastic + condensed];
        *sum = ct_ex3_add(b->x, *sum, ct_ex3_scale(b->x, ct_ex_const(b->x, sign), value));
        return;
    }
    for (int p = 0; d && p < d->npart; p++) {
        const ct_ex c = sign > 0 ? d->part[p].coef : ct_ex_neg(b->x, d->part[p].coef);
        ct_ex3 *sum = &by_coordinate[d->part[p].k];
        *sum = ct_ex3_add(b->x, *sum, ct_ex3_scale(b->x, c, value));
    }
}

// Derivatives by the dofs of the element of the station.
static void own_partials(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn, bool apart)
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[s->element];
    const ct_ex h = self->span.length;
    struct ct_axial_field a;
    ct_axial_field(b, f, s->element, s->xi, s->axial, &a);
    for (int j = 0; j < CT_DOF; j++) {
        ct_ex3 d = zero3, t = zero3;
        const int plane = j >= 6, i = plane ? j - 6 : j - 2;
        if (j < CT_AXIS_DOF)
            d.e[0] = a.slope[j];
        if (j >= 2 && j < CT_BENT_DOF) {
            const ct_ex r = ct_shape_at(x, &f->shape.rotation[i], s->xi, h);
            d.e[1 + plane] = ct_shape_at(x, &f->shape.deflection[i], s->xi, h);
            t.e[plane ? 1 : 2] = plane ? ct_ex_neg(x, r) : r;
        } else if (j >= CT_AXIS_DOF) {
            t.e[0] = ct_shape_at(x, &f->line[j - CT_AXIS_DOF], s->xi, h);
        }
        add_partial(b, f, s->element, j, d, slide, apart);
        add_partial(b, f, s->element, j, t, turn, apart);
    }
}

void ct_station_own_partials(struct ct_build *b, const struct ct_flexible *f,
                             const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn)
{
    own_partials(b, f, s, slide, turn, true);
}

// Are translations of sections cheaper by distributing forces of condensed rotations? That sum is
// new for each section, while sums by freedom continue from section to section.
static bool distributes_forces(const struct ct_build *b, const struct ct_flexible *f)
{
    size_t nsection = 0, nproduct = 0;
    for (size_t i = 0; i < b->topology->nedge; i++)
        nsection += ct_flexible_of_edge(b, &b->topology->edge[i]) == f;
    for (int e = 0; f->condensation && e < f->beam->nelement; e++)
        for (int j = 2; j < CT_BENT_DOF; j++) {
            int sign;
            const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
            if (d && ct_condensation_number(f, (int)(d - f->freedom)) >= 0
                && !ct_ex_is_zero(f->element[e].g[j]))
                nproduct += (size_t)d->npart;
        }
    return f->condensation
        && (nsection + 1) * ct_condensation_products(f->condensation) < nproduct;
}

// Axial derivatives by the dofs of the previous elements.
static void chain_partials(struct ct_build *b, const struct ct_flexible *f, int element,
                           ct_ex3 *slide)
{
    for (int e = 0; e < element; e++)
        for (int j = 2; j < CT_BENT_DOF; j++)
            add_partial(b, f, e, j, (ct_ex3){{f->element[e].g[j], CT_EX_ZERO, CT_EX_ZERO}},
                        slide, false);
}

// The same by forces on freedoms; those on condensed rotations are distributed from node to node.
static void distributed_partials(struct ct_build *b, const struct ct_flexible *f, int element,
                                 ct_ex3 *slide)
{
    const int n = NKIND * (f->beam->nelement + 1);
    ct_ex *force = CT_NEWN(b->ctx->scratch, ct_ex, n);
    for (int e = 0; e < element; e++)
        for (int j = 2; j < CT_BENT_DOF; j++)
            ct_dof_push(b, f, e, j, f->element[e].g[j], force);
    ct_condensation_forces(b->x, f->condensation, force);
    for (int i = 0; i < n; i++)
        for (int p = 0; p < f->freedom[i].npart && !ct_ex_is_zero(force[i]); p++) {
            ct_ex *sum = &slide[f->freedom[i].part[p].k].e[0];
            *sum = ct_ex_add_product(b->x, *sum, f->freedom[i].part[p].coef, force[i]);
        }
}

void ct_station_partials(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn)
{
    own_partials(b, f, s, slide, turn, false);
    if (s->axial == CT_AXIAL_CHAIN)
        (distributes_forces(b, f) ? distributed_partials : chain_partials)(b, f, s->element,
                                                                           slide);
}
