// Dynamics of flexible bodies; see flexible.h.
//
// Integrals over a beam are sums over points: Gauss points, or what the beam's rules ask for. Everything is written in
// the beam's axes; the base's motion is turned into them once. With Om = al~ + w~ w~ a point needs
//
//     c = a + Om r + 2 w x r' + r''        force m c  (5.4), (5.5)
#include "formulate/flexible.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};
enum { FEW_POINTS = 4, MANY_POINTS = 8 }; // sections that are constant, that vary

// A point of mass m with the rotary inertia j of the section there.
struct point {
    int element;
    ct_ex m, j[3];
    ct_ex3 r, rate, bias;      // place from the base; bias: second derivative with u' = 0
    ct_ex along[CT_PLACE_DOF]; // d r_x/d dof
    ct_ex place[4], turn[4], linear[2]; // shapes there
    ct_ex3 spin;                        // rate of the section's rotation
};

struct ct_inertia {
    struct point *point;
    size_t npoint;
    ct_ex mass;
    ct_ex3 moment;
    ct_ex33 inertia; // about the base
};

// ---- points -----------------------------------------------------------------------------------------

static enum ct_rule mass_rule(const struct ct_beam *beam)
{
    return beam->is_lumped                        ? CT_RULE_ENDS
         : beam->integration == CT_BEAM_ONE_POINT ? CT_RULE_MIDDLE
                                                  : CT_RULE_FULL;
}

static enum ct_rule stiffness_rule(const struct ct_beam *beam)
{
    return beam->integration == CT_BEAM_FULL ? CT_RULE_FULL : CT_RULE_MIDDLE;
}

// Inertia per length about the axes; twist has some of its own where nothing else is given.
static struct ct_profile rotary(const struct ct_flexible *f, int axis)
{
    const struct ct_beam *beam = f->beam;
    struct ct_profile g = {beam->x, CT_EX_ZERO};
    if (beam->has_rotary)
        g.value = beam->rotary[axis];
    else if (axis == 0 && f->deformation & CT_BEAM_TORSION)
        g.value = beam->twist_inertia;
    return g;
}

static ct_ex with_linear(struct ct_build *b, const struct point *p, const ct_ex *of)
{
    return ct_ex_add(b->x, ct_ex_mul(b->x, p->linear[0], of[10]),
                     ct_ex_mul(b->x, p->linear[1], of[11]));
}

static ct_ex dot4(struct ct_build *b, const ct_ex shape[4], const ct_ex *of)
{
    ct_ex sum = CT_EX_ZERO;
    for (int i = 0; i < 4; i++)
        sum = ct_ex_add(b->x, sum, ct_ex_mul(b->x, shape[i], of[i]));
    return sum;
}

// (twist, -dw/dx, dv/dx) of the dofs' values, rates or accelerations.
static ct_ex3 turning(struct ct_build *b, const struct point *p, const ct_ex *of)
{
    return (ct_ex3){{with_linear(b, p, of), ct_ex_neg(b->x, dot4(b, p->turn, of + 6)),
                     dot4(b, p->turn, of + 2)}};
}

static void place_point(struct ct_build *b, const struct ct_flexible *f, struct point *p,
                        double at)
{
    struct ct_exs *x = b->x;
    const struct ct_element *e = &f->element[p->element];
    const ct_ex xi = ct_ex_const(x, at), h = e->span.length;
    struct ct_axial_field a;
    ct_axial_field(b, f, p->element, xi, &a);
    for (int i = 0; i < CT_PLACE_DOF; i++)
        p->along[i] = a.slope[i];
    for (int i = 0; i < 4; i++) {
        p->place[i] = ct_shape_at(x, &f->shape.place[i], xi, h);
        p->turn[i] = ct_shape_at(x, &f->shape.rotation[i], xi, h);
    }
    for (int i = 0; i < 2; i++)
        p->linear[i] = ct_shape_at(x, &f->linear[i], xi, h);
    const ct_ex rest = ct_ex_add(x, e->span.start, ct_ex_mul(x, xi, h));
    p->r = (ct_ex3){{ct_ex_add(x, rest, a.value), dot4(b, p->place, e->value + 2),
                     dot4(b, p->place, e->value + 6)}};
    p->rate
        = (ct_ex3){{a.rate, dot4(b, p->place, e->rate + 2), dot4(b, p->place, e->rate + 6)}};
    p->bias = (ct_ex3){{a.bias, CT_EX_ZERO, CT_EX_ZERO}};
    p->spin = turning(b, p, e->rate);
}

static void add_points(struct ct_build *b, const struct ct_flexible *f, int e, size_t *cap)
{
    struct ct_inertia *I = f->inertia;
    const struct ct_span *s = &f->element[e].span;
    const struct ct_profile mass = {f->beam->x, f->beam->mass_per_length};
    double xi[CT_MAX_GAUSS];
    ct_ex m[CT_MAX_GAUSS], j[3][CT_MAX_GAUSS];
    unsigned kinds = ct_ex_kinds(b->x, mass.value);
    for (int i = 0; i < 3; i++)
        kinds |= ct_ex_kinds(b->x, rotary(f, i).value);
    const int wanted = kinds & 1u << CT_SYM_LOCAL ? MANY_POINTS : FEW_POINTS;
    const enum ct_rule rule = mass_rule(f->beam);
    const int n = ct_shape_points(b->x, &mass, s, rule, wanted, xi, m);
    for (int i = 0; i < 3; i++) {
        const struct ct_profile g = rotary(f, i);
        ct_shape_points(b->x, &g, s, rule, wanted, xi, j[i]);
    }
    for (int i = 0; i < n; i++) {
        struct point p = {.element = e, .m = m[i], .j = {j[0][i], j[1][i], j[2][i]}};
        place_point(b, f, &p, xi[i]);
        CT_PUSH(b->arena, I->point, I->npoint, *cap, p);
    }
}

// Acceleration of a point with the symbols u', less its bias. chain: by element, of the foreshortening at its start.
static ct_ex3 own_acceleration(struct ct_build *b, const struct ct_flexible *f,
                               const struct point *p, const ct_ex *chain)
{
    const ct_ex *acceleration = f->element[p->element].acceleration;
    ct_ex along = chain ? chain[p->element] : CT_EX_ZERO;
    for (int i = 0; i < CT_PLACE_DOF; i++)
        along = ct_ex_add(b->x, along, ct_ex_mul(b->x, p->along[i], acceleration[i]));
    return (ct_ex3){
        {along, dot4(b, p->place, acceleration + 2), dot4(b, p->place, acceleration + 6)}};
}

static ct_ex *chain_accelerations(struct ct_build *b, const struct ct_flexible *f)
{
    if (f->axial != CT_AXIAL_CHAIN)
        return NULL;
    ct_ex *c = CT_NEWN(b->arena, ct_ex, f->beam->nelement + 1);
    for (int e = 0; e < f->beam->nelement; e++) {
        c[e + 1] = c[e];
        for (int j = 2; j < CT_PLACE_DOF; j++)
            c[e + 1]
                = ct_ex_add(b->x, c[e + 1],
                            ct_ex_mul(b->x, f->element[e].g[j], f->element[e].acceleration[j]));
    }
    return c;
}

// ---- the base -----------------------------------------------------------------------------------------

// Ground components <-> axes of the beam.
static ct_ex3 into(struct ct_build *b, const struct ct_flexible *f, ct_ex3 v)
{
    return ct_node_unturn(b, f->base, v);
}

static ct_ex3 out_of(struct ct_build *b, const struct ct_flexible *f, ct_ex3 v)
{
    return ct_node_turn(b, f->base, v);
}

// How the base moves, in axes of the beam.
struct base {
    ct_ex3 a, w, al; // acceleration less gravity, angular velocity and acceleration
};

// Angular rates summed in the cluster's own axes, where the axes of its turns are fixed in it and it turns
// against ground; in a plane they stay along the normal.
static bool plain_rates(struct ct_build *b, const struct ct_place *p, enum ct_level level,
                        struct base *out)
{
    struct ct_exs *x = b->x;
    const struct ct_cluster *c = &b->cluster[p->frame];
    ct_ex3 w = zero3, al = zero3;
    if (b->is_planar) {
        out->w = ct_ex33_apply_t(x, &p->S, ct_cluster_velocity(b, p->frame));
        out->al = ct_ex33_apply_t(x, &p->S, ct_cluster_acceleration(b, p->frame, level));
        return true;
    }
    if (p->frame && c->parent)
        return false;
    for (int i = 0; i < c->nspin; i++) {
        const struct ct_spin *s = &b->spin[c->first_spin + i];
        ct_ex rate = s->bias;
        if (ct_ex3_is_zero(s->local))
            return false;
        for (int k = 0; level == CT_FULL && k < s->nterm; k++)
            if (s->term[k].speed >= 0)
                rate = ct_ex_add(
                    x, rate,
                    ct_ex_mul(x, s->term[k].coef, b->eqs->u[s->term[k].speed].derivative));
        w = ct_ex3_add(x, w, ct_ex3_scale(x, s->rate, s->local));
        al = ct_ex3_add(x, al, ct_ex3_scale(x, rate, s->local));
    }
    out->w = ct_ex33_apply_t(x, &p->S, w);
    out->al = ct_ex33_apply_t(x, &p->S, al);
    return true;
}

static struct base base_motion(struct ct_build *b, const struct ct_flexible *f,
                               enum ct_level level, ct_ex3 apparent)
{
    const struct ct_place *p = &b->place[f->base];
    struct base m = {.a = into(b, f, apparent)};
    if (!plain_rates(b, p, level, &m)) {
        m.w = into(b, f, ct_cluster_velocity(b, p->frame));
        m.al = into(b, f, ct_cluster_acceleration(b, p->frame, level));
    }
    return m;
}

// al~ + w~ w~
static ct_ex33 turning_matrix(struct ct_build *b, const struct base *m)
{
    struct ct_exs *x = b->x;
    ct_ex33 Om;
    ct_ex square[3];
    for (int i = 0; i < 3; i++)
        square[i] = ct_ex_mul(x, m->w.e[i], m->w.e[i]);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const ct_ex both = ct_ex_mul(x, m->w.e[i], m->w.e[j]);
        Om.e[4 * i] = ct_ex_neg(x, ct_ex_add(x, square[j], square[k]));
        Om.e[i + 3 * j] = ct_ex_sub(x, both, m->al.e[k]);
        Om.e[j + 3 * i] = ct_ex_add(x, both, m->al.e[k]);
    }
    return Om;
}

static ct_ex3 twice_cross(struct ct_build *b, ct_ex3 w, ct_ex3 v)
{
    return ct_ex3_scale(b->x, ct_ex_const(b->x, 2), ct_ex3_cross(b->x, w, v));
}

static ct_ex3 times(struct ct_build *b, const ct_ex j[3], ct_ex3 v)
{
    for (int i = 0; i < 3; i++)
        v.e[i] = ct_ex_mul(b->x, j[i], v.e[i]);
    return v;
}

// ---- lumping ---------------------------------------------------------------------------------------------

static void derive_inertia(struct ct_build *b, struct ct_flexible *f)
{
    struct ct_exs *x = b->x;
    struct ct_inertia *I = f->inertia = CT_NEW(b->arena, struct ct_inertia);
    size_t cap = 0;
    I->mass = b->model->body[f->body].mass;
    for (int e = 0; e < f->beam->nelement; e++)
        add_points(b, f, e, &cap);
    for (size_t i = 0; i < I->npoint; i++) {
        const struct point *p = &I->point[i];
        I->moment = ct_ex3_add(x, I->moment, ct_ex3_scale(x, p->m, p->r));
        ct_inertia_add_point(b, &I->inertia, p->m, p->r);
        for (int k = 0; k < 3; k++)
            I->inertia.e[4 * k] = ct_ex_add(x, I->inertia.e[4 * k], p->j[k]);
    }
}

void ct_flexible_lump(struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++) {
        struct ct_flexible *f = &b->flexible[i];
        const struct ct_place *p = &b->place[f->base];
        derive_inertia(b, f);
        const struct ct_inertia *I = f->inertia;
        const ct_ex33 t = ct_ex33_transpose(&p->S), half = ct_ex33_mul(b->x, &I->inertia, &t);
        const ct_ex33 turned = ct_ex33_mul(b->x, &p->S, &half);
        ct_masses_add(b, p->anchor, p->frame, I->mass, ct_ex33_apply(b->x, &p->S, I->moment),
                      &turned);
    }
}

// ---- rows ------------------------------------------------------------------------------------------------

// Generalised force on a dof, handed to the elastic coordinates it stands for.
static void push_dof(struct ct_build *b, const struct ct_flexible *f, int e, int j, ct_ex value,
                     ct_ex *row)
{
    int sign;
    const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
    for (int p = 0; d && p < d->npart; p++) {
        const ct_ex v = ct_ex_mul(b->x, d->part[p].coef, value);
        ct_ex *r = &row[f->elastic[d->part[p].k].u];
        *r = sign > 0 ? ct_ex_add(b->x, *r, v) : ct_ex_sub(b->x, *r, v);
    }
}

// Rows of the force F and the moment T at a point: dr . F + dth . T.
static void push_point(struct ct_build *b, const struct ct_flexible *f, const struct point *p,
                       ct_ex3 F, ct_ex3 T, ct_ex sum[CT_DOF])
{
    struct ct_exs *x = b->x;
    (void)f;
    for (int j = 0; j < CT_PLACE_DOF; j++) {
        ct_ex v = ct_ex_mul(x, p->along[j], F.e[0]);
        if (j >= 2 && j < 6) {
            v = ct_ex_add(x, v, ct_ex_mul(x, p->place[j - 2], F.e[1]));
            v = ct_ex_add(x, v, ct_ex_mul(x, p->turn[j - 2], T.e[2]));
        } else if (j >= 6) {
            v = ct_ex_add(x, v, ct_ex_mul(x, p->place[j - 6], F.e[2]));
            v = ct_ex_sub(x, v, ct_ex_mul(x, p->turn[j - 6], T.e[1]));
        }
        sum[j] = ct_ex_add(x, sum[j], v);
    }
    for (int j = 0; j < 2; j++)
        sum[CT_PLACE_DOF + j]
            = ct_ex_add(x, sum[CT_PLACE_DOF + j], ct_ex_mul(x, p->linear[j], T.e[0]));
}

static void inertia_rows(struct ct_build *b, const struct ct_flexible *f, const struct base *m,
                         enum ct_level level, ct_ex *row)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const ct_ex33 Om = turning_matrix(b, m);
    const ct_ex *chain = level == CT_FULL ? chain_accelerations(b, f) : NULL;
    ct_ex beyond = CT_EX_ZERO; // axial force of the elements beyond
    for (size_t i = I->npoint; i > 0;) {
        const int e = I->point[i - 1].element;
        ct_ex sum[CT_DOF] = {{0}}, axial = CT_EX_ZERO;
        for (; i > 0 && I->point[i - 1].element == e; i--) {
            const struct point *p = &I->point[i - 1];
            ct_ex3 c = ct_ex3_add(x, m->a, ct_ex33_apply(x, &Om, p->r));
            c = ct_ex3_add(x, c, twice_cross(b, m->w, p->rate));
            c = ct_ex3_add(x, c, p->bias);
            ct_ex3 al = m->al;
            if (level == CT_FULL) {
                c = ct_ex3_add(x, c, own_acceleration(b, f, p, chain));
                al = ct_ex3_add(x, al, turning(b, p, f->element[e].acceleration));
            }
            const ct_ex3 F = ct_ex3_scale(x, p->m, c);
            axial = ct_ex_add(x, axial, F.e[0]);
            push_point(b, f, p, F, times(b, p->j, al), sum);
        }
        for (int j = 2; j < CT_PLACE_DOF && f->axial == CT_AXIAL_CHAIN; j++)
            sum[j] = ct_ex_add(x, sum[j], ct_ex_mul(x, f->element[e].g[j], beyond));
        beyond = ct_ex_add(x, beyond, axial);
        for (int j = 0; j < CT_DOF; j++)
            push_dof(b, f, e, j, sum[j], row);
    }
}

// ---- stiffness and damping ----------------------------------------------------------------------------------

// Constant matrices of an element for its four dofs of a plane.
struct plane_matrices {
    ct_ex K[4][4], M[4][4], E[4][4];
};

static ct_ex pair_integral(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex g,
                           const struct ct_shape *p, const struct ct_shape *q,
                           enum ct_rule rule)
{
    const struct ct_profile profile = {f->beam->x, g};
    const struct ct_shape both = ct_shape_mul(p, q);
    if (ct_ex_is_zero(g) || ct_shape_is_zero(&both))
        return CT_EX_ZERO;
    return ct_shape_integral(b->x, &profile, &both, &f->element[e].span, rule);
}

static struct plane_matrices plane_matrices(struct ct_build *b, const struct ct_flexible *f,
                                            int e, int plane)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = f->beam;
    const enum ct_rule rule = stiffness_rule(beam), mass = mass_rule(beam);
    const ct_ex second = plane ? beam->Iy : beam->Iz, EI = ct_ex_mul(x, beam->E, second);
    const ct_ex GA = beam->theory == CT_BEAM_TIMOSHENKO
                       ? ct_ex_mul(x, beam->shear_factor, ct_ex_mul(x, beam->G, beam->area))
                       : CT_EX_ZERO;
    const ct_ex radius = beam->higher_order ? ct_ex_div(x, second, beam->area) : CT_EX_ZERO;
    const ct_ex J = rotary(f, plane ? 1 : 2).value;
    struct plane_matrices s = {0};
    struct ct_shape bend[4], shear[4];
    for (int j = 0; j < 4; j++) {
        bend[j] = ct_shape_slope(&f->shape.rotation[j]);
        shear[j] = f->shape.slope[j];
        if (ct_shape_is_zero(&shear[j]))
            shear[j].power = f->shape.rotation[j].power;
        // both are of one power of the length, or one of them is zero
        for (int i = 0; i < CT_SHAPE_SIZE; i++)
            shear[j].c[i] -= f->shape.rotation[j].c[i];
    }
    for (int j = 0; j < 4; j++)
        for (int k = 0; k < 4; k++) {
            s.K[j][k] = ct_ex_add(x, pair_integral(b, f, e, EI, &bend[j], &bend[k], rule),
                                  pair_integral(b, f, e, GA, &shear[j], &shear[k], rule));
            s.M[j][k] = ct_ex_add(
                x,
                pair_integral(b, f, e, beam->mass_per_length, &f->shape.place[j],
                              &f->shape.place[k], mass),
                pair_integral(b, f, e, J, &f->shape.rotation[j], &f->shape.rotation[k], mass));
            s.E[j][k] = ct_ex_add(
                x,
                pair_integral(b, f, e, CT_EX_ONE, &f->shape.slope[j], &f->shape.slope[k], rule),
                pair_integral(b, f, e, radius, &bend[j], &bend[k], rule));
        }
    return s;
}

static ct_ex product(struct ct_build *b, const ct_ex row[4], const ct_ex *v)
{
    return dot4(b, row, v);
}

// What one element adds: rows of its dofs, strain energy, twice the power its damping takes.
struct element_force {
    ct_ex row[CT_DOF];
    ct_ex energy, drag;
};

static void bend_element(struct ct_build *b, const struct ct_flexible *f, int e, int plane,
                         const struct plane_matrices *s, struct element_force *out)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = f->beam;
    const int first = plane ? 6 : 2;
    const ct_ex *a = f->element[e].value + first, *r = f->element[e].rate + first;
    for (int j = 0; j < 4; j++) {
        const ct_ex elastic = product(b, s->K[j], a);
        ct_ex drag = ct_ex_mul(x, beam->damping_stiffness, product(b, s->K[j], r));
        drag = ct_ex_add(x, drag, ct_ex_mul(x, beam->damping_mass, product(b, s->M[j], r)));
        out->row[first + j] = ct_ex_add(x, out->row[first + j], ct_ex_add(x, elastic, drag));
        out->energy
            = ct_ex_add(x, out->energy, ct_ex_scale(x, 0.5, ct_ex_mul(x, a[j], elastic)));
        out->drag = ct_ex_add(x, out->drag, ct_ex_mul(x, r[j], drag));
    }
}

// Stretch of the element: the difference of the nodes' s, in LOCAL coordinates by what they and the slopes say.
struct stretch {
    ct_ex value, rate;
    ct_ex slope[CT_PLACE_DOF];
};

static struct stretch stretch_of(struct ct_build *b, const struct ct_flexible *f, int e,
                                 const struct plane_matrices plane[2])
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[e];
    struct stretch s = {.value = ct_ex_sub(x, self->value[1], self->value[0]),
                        .rate = ct_ex_sub(x, self->rate[1], self->rate[0])};
    s.slope[0] = ct_ex_const(x, -1);
    s.slope[1] = CT_EX_ONE;
    for (int k = 0; k < 2 && f->axial == CT_AXIAL_LOCAL; k++)
        for (int j = 0; j < 4; j++) {
            const int dof = (k ? 6 : 2) + j;
            const ct_ex Ea = product(b, plane[k].E[j], self->value + (k ? 6 : 2));
            s.slope[dof] = Ea;
            s.value = ct_ex_add(x, s.value,
                                ct_ex_scale(x, 0.5, ct_ex_mul(x, Ea, self->value[dof])));
            s.rate = ct_ex_add(x, s.rate, ct_ex_mul(x, Ea, self->rate[dof]));
        }
    return s;
}

static void stretch_element(struct ct_build *b, const struct ct_flexible *f, int e,
                            const struct plane_matrices plane[2], struct element_force *out)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = f->beam;
    const struct ct_element *self = &f->element[e];
    const struct stretch s = stretch_of(b, f, e, plane);
    const struct ct_shape dx = ct_shape_slope(&f->linear[1]);
    const ct_ex k = pair_integral(b, f, e, ct_ex_mul(x, beam->E, beam->area), &dx, &dx,
                                  stiffness_rule(beam));
    const ct_ex elastic = ct_ex_mul(x, k, s.value);
    const ct_ex drag = ct_ex_mul(x, beam->damping_stiffness, ct_ex_mul(x, k, s.rate));
    const ct_ex N = ct_ex_add(x, elastic, drag);
    for (int j = 0; j < CT_PLACE_DOF; j++)
        out->row[j] = ct_ex_add(x, out->row[j], ct_ex_mul(x, N, s.slope[j]));
    out->energy
        = ct_ex_add(x, out->energy, ct_ex_scale(x, 0.5, ct_ex_mul(x, elastic, s.value)));
    out->drag = ct_ex_add(x, out->drag, ct_ex_mul(x, drag, s.rate));
    for (int j = 0; j < 2 && !ct_ex_is_zero(beam->damping_mass); j++)
        for (int i = 0; i < 2; i++) {
            const ct_ex m = pair_integral(b, f, e, beam->mass_per_length, &f->linear[j],
                                          &f->linear[i], mass_rule(beam));
            const ct_ex v = ct_ex_mul(x, beam->damping_mass, ct_ex_mul(x, m, self->rate[i]));
            out->row[j] = ct_ex_add(x, out->row[j], v);
            out->drag = ct_ex_add(x, out->drag, ct_ex_mul(x, v, self->rate[j]));
        }
}

static void twist_element(struct ct_build *b, const struct ct_flexible *f, int e,
                          struct element_force *out)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = f->beam;
    const ct_ex *value = f->element[e].value + CT_PLACE_DOF;
    const ct_ex *rate = f->element[e].rate + CT_PLACE_DOF;
    const ct_ex GJ = ct_ex_mul(x, beam->G, beam->J), J = rotary(f, 0).value;
    for (int j = 0; j < 2; j++) {
        const struct ct_shape dj = ct_shape_slope(&f->linear[j]);
        ct_ex elastic = CT_EX_ZERO, drag = CT_EX_ZERO;
        for (int k = 0; k < 2; k++) {
            const struct ct_shape dk = ct_shape_slope(&f->linear[k]);
            const ct_ex K = pair_integral(b, f, e, GJ, &dj, &dk, stiffness_rule(beam));
            const ct_ex M
                = pair_integral(b, f, e, J, &f->linear[j], &f->linear[k], mass_rule(beam));
            const ct_ex C = ct_ex_add(x, ct_ex_mul(x, beam->damping_stiffness, K),
                                      ct_ex_mul(x, beam->damping_mass, M));
            elastic = ct_ex_add(x, elastic, ct_ex_mul(x, K, value[k]));
            drag = ct_ex_add(x, drag, ct_ex_mul(x, C, rate[k]));
        }
        ct_ex *row = &out->row[CT_PLACE_DOF + j];
        *row = ct_ex_add(x, *row, ct_ex_add(x, elastic, drag));
        out->energy
            = ct_ex_add(x, out->energy, ct_ex_scale(x, 0.5, ct_ex_mul(x, elastic, value[j])));
        out->drag = ct_ex_add(x, out->drag, ct_ex_mul(x, drag, rate[j]));
    }
}

static struct element_force element_force(struct ct_build *b, const struct ct_flexible *f,
                                          int e)
{
    struct element_force out = {0};
    struct plane_matrices plane[2];
    for (int k = 0; k < 2; k++) {
        const bool bends = f->deformation & (k ? CT_BEAM_BENDING_Y : CT_BEAM_BENDING_Z);
        plane[k] = bends ? plane_matrices(b, f, e, k) : (struct plane_matrices){0};
        if (bends)
            bend_element(b, f, e, k, &plane[k], &out);
    }
    if (f->deformation & CT_BEAM_AXIAL)
        stretch_element(b, f, e, plane, &out);
    if (f->deformation & CT_BEAM_TORSION)
        twist_element(b, f, e, &out);
    return out;
}

static void stiffness_rows(struct ct_build *b, const struct ct_flexible *f, ct_ex *row)
{
    for (int e = 0; e < f->beam->nelement; e++) {
        const struct element_force s = element_force(b, f, e);
        for (int j = 0; j < CT_DOF; j++)
            push_dof(b, f, e, j, s.row[j], row);
    }
}

ct_ex ct_flexible_strain(struct ct_build *b, const struct ct_flexible *f)
{
    ct_ex sum = CT_EX_ZERO;
    for (int e = 0; e < f->beam->nelement; e++)
        sum = ct_ex_add(b->x, sum, element_force(b, f, e).energy);
    return sum;
}

ct_ex ct_flexible_dissipation(struct ct_build *b)
{
    ct_ex sum = CT_EX_ZERO;
    for (size_t i = 0; i < b->nflexible; i++)
        for (int e = 0; e < b->flexible[i].beam->nelement; e++)
            sum = ct_ex_sub(b->x, sum, element_force(b, &b->flexible[i], e).drag);
    return sum;
}

// ---- sweep --------------------------------------------------------------------------------------------------

// Force and torque of the motion relative to the base: m (2 w x r' + r''), and of the sections' rotation.
static void relative_wrench(struct ct_build *b, const struct ct_flexible *f,
                            const struct base *m, enum ct_level level, ct_ex3 *force,
                            ct_ex3 *torque)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const ct_ex *chain = level == CT_FULL ? chain_accelerations(b, f) : NULL;
    ct_ex3 spin = zero3;
    *force = *torque = zero3;
    for (size_t i = 0; i < I->npoint; i++) {
        const struct point *p = &I->point[i];
        ct_ex3 d = ct_ex3_add(x, twice_cross(b, m->w, p->rate), p->bias);
        if (level == CT_FULL)
            d = ct_ex3_add(x, d, own_acceleration(b, f, p, chain));
        d = ct_ex3_scale(x, p->m, d);
        *force = ct_ex3_add(x, *force, d);
        *torque = ct_ex3_add(x, *torque, ct_ex3_cross(x, p->r, d));
        spin = ct_ex3_add(x, spin, times(b, p->j, p->spin));
        if (level == CT_FULL)
            *torque = ct_ex3_add(
                x, *torque, times(b, p->j, turning(b, p, f->element[p->element].acceleration)));
    }
    *torque = ct_ex3_add(x, *torque, ct_ex3_cross(x, m->w, spin));
}

void ct_flexible_sweep(struct ct_build *b, enum ct_level level, const ct_ex3 *apparent,
                       ct_ex3 *rest, ct_ex3 *torque, ct_ex *row)
{
    struct ct_exs *x = b->x;
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        const struct ct_place *p = &b->place[f->base];
        const struct base m = base_motion(b, f, level, apparent[p->anchor]);
        ct_ex3 F, T;
        relative_wrench(b, f, &m, level, &F, &T);
        rest[p->anchor] = ct_ex3_add(x, rest[p->anchor], out_of(b, f, F));
        torque[p->frame] = ct_ex3_add(x, torque[p->frame], out_of(b, f, T));
        inertia_rows(b, f, &m, level, row);
        stiffness_rows(b, f, row);
    }
}

void ct_flexible_wrench(struct ct_build *b, const struct ct_flexible *f, ct_ex3 *force,
                        ct_ex3 *torque)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const ct_ex3 a
        = ct_ex3_sub(x, ct_node_acceleration(b, f->base, CT_FULL), b->model->gravity);
    const struct base m = base_motion(b, f, CT_FULL, a);
    ct_ex3 F, T;
    relative_wrench(b, f, &m, CT_FULL, &F, &T);
    F = ct_ex3_add(x, F, ct_ex3_scale(x, I->mass, m.a));
    F = ct_ex3_add(x, F, ct_ex3_cross(x, m.al, I->moment));
    F = ct_ex3_add(x, F, ct_ex3_cross(x, m.w, ct_ex3_cross(x, m.w, I->moment)));
    T = ct_ex3_add(x, T, ct_ex3_cross(x, I->moment, m.a));
    T = ct_ex3_add(x, T, ct_ex33_apply(x, &I->inertia, m.al));
    T = ct_ex3_add(x, T, ct_ex3_cross(x, m.w, ct_ex33_apply(x, &I->inertia, m.w)));
    *force = out_of(b, f, F);
    *torque = out_of(b, f, T);
}

// ---- motion --------------------------------------------------------------------------------------------------

struct ct_flexible_state ct_flexible_moving(struct ct_build *b, const struct ct_flexible *f)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const struct base m = base_motion(b, f, CT_BIAS, zero3);
    const ct_ex3 v = into(b, f, ct_node_velocity(b, f->base));
    ct_ex3 momentum = ct_ex3_cross(x, m.w, I->moment), spin = zero3;
    ct_ex own = CT_EX_ZERO;
    for (size_t i = 0; i < I->npoint; i++) {
        const struct point *p = &I->point[i];
        const ct_ex3 moving = ct_ex3_scale(x, p->m, p->rate);
        const ct_ex3 turns = times(b, p->j, p->spin);
        momentum = ct_ex3_add(x, momentum, moving);
        spin = ct_ex3_add(x, spin, ct_ex3_add(x, ct_ex3_cross(x, p->r, moving), turns));
        own = ct_ex_add(x, own, ct_ex3_dot(x, p->rate, moving));
        own = ct_ex_add(x, own, ct_ex3_dot(x, p->spin, turns));
    }
    const ct_ex3 Iw = ct_ex33_apply(x, &I->inertia, m.w);
    ct_ex twice = ct_ex_add(x, own, ct_ex_mul(x, I->mass, ct_ex3_dot(x, v, v)));
    twice = ct_ex_add(x, twice, ct_ex_scale(x, 2, ct_ex3_dot(x, v, momentum)));
    twice = ct_ex_add(x, twice, ct_ex3_dot(x, m.w, Iw));
    twice = ct_ex_add(x, twice, ct_ex_scale(x, 2, ct_ex3_dot(x, m.w, spin)));
    momentum = ct_ex3_add(x, momentum, ct_ex3_scale(x, I->mass, v));
    spin = ct_ex3_add(x, spin, Iw);
    spin = ct_ex3_add(x, spin, ct_ex3_cross(x, I->moment, v));
    return (struct ct_flexible_state){.mass = I->mass,
                                      .moment = out_of(b, f, I->moment),
                                      .momentum = out_of(b, f, momentum),
                                      .spin = out_of(b, f, spin),
                                      .twice_kinetic = twice};
}

// ---- mass matrix ------------------------------------------------------------------------------------------------

// Sums over the points of an element that its columns need.
struct element_mass {
    ct_ex M[CT_DOF][CT_DOF];
    ct_ex3 moved[CT_DOF],
        swept[CT_DOF]; // sum m dr, sum m r x dr (and of the sections' rotation)
    ct_ex m;
    ct_ex3 moment;
};

static ct_ex3 point_partial(const struct point *p, int j)
{
    ct_ex3 d = zero3;
    if (j < CT_PLACE_DOF)
        d.e[0] = p->along[j];
    if (j >= 2 && j < 6)
        d.e[1] = p->place[j - 2];
    else if (j >= 6 && j < CT_PLACE_DOF)
        d.e[2] = p->place[j - 6];
    return d;
}

static ct_ex3 point_turn(struct ct_build *b, const struct point *p, int j)
{
    ct_ex3 d = zero3;
    if (j >= CT_PLACE_DOF)
        d.e[0] = p->linear[j - CT_PLACE_DOF];
    else if (j >= 6)
        d.e[1] = ct_ex_neg(b->x, p->turn[j - 6]);
    else if (j >= 2)
        d.e[2] = p->turn[j - 2];
    return d;
}

static void add_point_mass(struct ct_build *b, const struct point *p, struct element_mass *s)
{
    struct ct_exs *x = b->x;
    s->m = ct_ex_add(x, s->m, p->m);
    s->moment = ct_ex3_add(x, s->moment, ct_ex3_scale(x, p->m, p->r));
    for (int j = 0; j < CT_DOF; j++) {
        const ct_ex3 dr = ct_ex3_scale(x, p->m, point_partial(p, j));
        const ct_ex3 dth = times(b, p->j, point_turn(b, p, j));
        s->moved[j] = ct_ex3_add(x, s->moved[j], dr);
        s->swept[j] = ct_ex3_add(x, s->swept[j], ct_ex3_add(x, ct_ex3_cross(x, p->r, dr), dth));
        for (int k = 0; k <= j; k++) {
            const ct_ex v = ct_ex_add(x, ct_ex3_dot(x, dr, point_partial(p, k)),
                                      ct_ex3_dot(x, dth, point_turn(b, p, k)));
            s->M[j][k] = s->M[k][j] = ct_ex_add(x, s->M[j][k], v);
        }
    }
}

static void push_pair(struct ct_build *b, const struct ct_flexible *f, int e, int j, int g,
                      int k, ct_ex value, ct_ex *M)
{
    int sj, sk;
    const struct ct_freedom *p = ct_dof_freedom(f, e, j, &sj),
                            *q = ct_dof_freedom(f, g, k, &sk);
    if (!p || !q || ct_ex_is_zero(value))
        return;
    for (int i = 0; i < p->npart; i++)
        for (int l = 0; l < q->npart; l++) {
            const int row = f->elastic[p->part[i].k].u, column = f->elastic[q->part[l].k].u;
            const ct_ex c = ct_ex_mul(b->x, p->part[i].coef, q->part[l].coef);
            ct_ex v = ct_ex_mul(b->x, c, value);
            if (row < column)
                continue; // the transposed pair is pushed, too
            v = sj == sk ? v : ct_ex_neg(b->x, v);
            ct_ex *m = &M[(size_t)row + b->eqs->nu * (size_t)column];
            *m = ct_ex_add(b->x, *m, v);
        }
}

// Columns of the base's motion: p . moved + s . swept for a velocity p and an angular velocity s of the base.
struct columns {
    ct_ex3 *moved, *swept; // by elastic coordinate, axes of the beam
};

static void push_column(struct ct_build *b, const struct ct_flexible *f, int e, int j,
                        ct_ex3 moved, ct_ex3 swept, struct columns *out)
{
    int sign;
    const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
    for (int i = 0; d && i < d->npart; i++) {
        const int k = d->part[i].k;
        const ct_ex c = sign > 0 ? d->part[i].coef : ct_ex_neg(b->x, d->part[i].coef);
        out->moved[k] = ct_ex3_add(b->x, out->moved[k], ct_ex3_scale(b->x, c, moved));
        out->swept[k] = ct_ex3_add(b->x, out->swept[k], ct_ex3_scale(b->x, c, swept));
    }
}

// Elements from the tip inwards: with a CHAIN what lies beyond moves along with an element's bending.
static void elastic_block(struct ct_build *b, const struct ct_flexible *f, struct columns *out,
                          ct_ex *M)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const bool chain = f->axial == CT_AXIAL_CHAIN;
    const int n = f->beam->nelement;
    struct element_mass *s = CT_NEWN(b->arena, struct element_mass, n);
    for (size_t i = 0; i < I->npoint; i++)
        add_point_mass(b, &I->point[i], &s[I->point[i].element]);
    ct_ex m = CT_EX_ZERO;
    ct_ex3 moment = zero3;
    for (int e = n; e-- > 0;) {
        const struct ct_element *self = &f->element[e];
        for (int j = 0; j < CT_DOF; j++) {
            const ct_ex g = chain && j < CT_PLACE_DOF ? self->g[j] : CT_EX_ZERO;
            const ct_ex3 along = {{ct_ex_mul(x, g, m), CT_EX_ZERO, CT_EX_ZERO}};
            const ct_ex3 about = {{CT_EX_ZERO, ct_ex_mul(x, g, moment.e[2]),
                                   ct_ex_neg(x, ct_ex_mul(x, g, moment.e[1]))}};
            const ct_ex3 moved = ct_ex3_add(x, s[e].moved[j], along);
            push_column(b, f, e, j, moved, ct_ex3_add(x, s[e].swept[j], about), out);
            for (int k = 0; k < CT_DOF; k++) {
                const ct_ex gk = chain && k < CT_PLACE_DOF ? self->g[k] : CT_EX_ZERO;
                const ct_ex v
                    = ct_ex_add(x, s[e].M[j][k], ct_ex_mul(x, ct_ex_mul(x, g, gk), m));
                push_pair(b, f, e, j, e, k, v, M);
            }
            for (int inner = 0; inner < e && chain; inner++)
                for (int k = 2; k < CT_PLACE_DOF; k++) {
                    const ct_ex v = ct_ex_mul(x, f->element[inner].g[k], moved.e[0]);
                    push_pair(b, f, e, j, inner, k, v, M);
                    push_pair(b, f, inner, k, e, j, v, M);
                }
        }
        m = ct_ex_add(x, m, s[e].m);
        moment = ct_ex3_add(x, moment, s[e].moment);
    }
}

// Rows of the elastic coordinates in the column of a speed that moves the base: coef (p . moved + s . swept).
static void base_column(struct ct_build *b, const struct ct_flexible *f,
                        const struct columns *c, ct_ex3 p, ct_ex3 s, const struct ct_term *term,
                        int nterm, ct_ex *M)
{
    for (int k = 0; k < f->nelastic; k++) {
        const ct_ex m = ct_ex_add(b->x, ct_ex3_dot(b->x, p, c->moved[k]),
                                  ct_ex3_dot(b->x, s, c->swept[k]));
        if (ct_ex_is_zero(m))
            continue;
        const struct ct_term own = {f->elastic[k].u, -1, CT_EX_ONE};
        ct_mass_spread(b, M, &own, 1, term, nterm, m);
    }
}

static bool has_unknown(const struct ct_term *p, int np)
{
    for (int i = 0; i < np; i++)
        if (p[i].speed >= 0)
            return true;
    return false;
}

static void base_columns(struct ct_build *b, const struct ct_flexible *f,
                         const struct columns *c, ct_ex *M)
{
    struct ct_exs *x = b->x;
    const struct ct_place *at = &b->place[f->base];
    for (size_t r = 0; r < b->nspin; r++) {
        const struct ct_spin *spin = &b->spin[r];
        ct_ex3 reach = zero3, s = zero3;
        if (!has_unknown(spin->term, spin->nterm))
            continue;
        for (int a = at->anchor; a > 0; a = b->anchor[a].parent)
            if (ct_cluster_is_outboard(b, spin->cluster, b->anchor[a].cluster))
                reach = ct_ex3_add(x, reach, ct_link_vector(b, a));
        const ct_ex3 p
            = ct_ex3_is_zero(reach)
                ? zero3
                : into(b, f, ct_ex3_cross(x, spin->axis, ct_build_in_plane(b, reach)));
        if (ct_cluster_is_outboard(b, spin->cluster, at->frame)) {
            if (spin->cluster == at->frame && !ct_ex3_is_zero(spin->local))
                s = ct_ex33_apply_t(x, &at->S, spin->local);
            else if (b->is_planar)
                s = ct_ex33_apply_t(x, &at->S, spin->axis);
            else
                s = into(b, f, spin->axis);
        }
        base_column(b, f, c, p, s, spin->term, spin->nterm, M);
    }
    for (int a = at->anchor; a > 0; a = b->anchor[a].parent)
        for (int k = 0; k < b->anchor[a].nslide; k++) {
            const struct ct_slide *slide = &b->anchor[a].slide[k];
            const struct ct_term term = {slide->speed, slide->driver, CT_EX_ONE};
            if (slide->speed < 0)
                continue;
            const ct_ex3 p = b->anchor[a].cluster == at->frame
                               ? ct_ex33_apply_t(x, &at->S, slide->p)
                               : into(b, f, ct_cluster_turn(b, b->anchor[a].cluster, slide->p));
            base_column(b, f, c, p, zero3, &term, 1, M);
        }
}

void ct_flexible_mass(struct ct_build *b, ct_ex *M)
{
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        struct columns c = {CT_NEWN(b->arena, ct_ex3, f->nelastic + 1),
                            CT_NEWN(b->arena, ct_ex3, f->nelastic + 1)};
        elastic_block(b, f, &c, M);
        base_columns(b, f, &c, M);
    }
}
