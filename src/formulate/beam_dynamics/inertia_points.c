// Integrals over a beam as sums over points: Gauss points, or the rule of the beam; see
// beam_dynamics.h.
//
// With Om = al~ + w~ w~ a point needs
//
//     c = a + Om r + 2 w x r' + r''        force m c  (5.4), (5.5)
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/beam/section_rotation.h"
#include "formulate/mass_sums.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};
// Points of an element with constant sections. Derived: exact for products of two shapes of degree
// 5.
enum { FEW_POINTS = 6 };

// A point of mass m with the section there.
struct ct_point {
    int element;
    ct_ex m;
    struct ct_section section;
    ct_ex3 r, rate, bias;        // position from the base; bias: second derivative with u' = 0
    ct_ex along[CT_AXIS_DOF];    // d r_x/d dof
    struct ct_axial_field axial; // the same for forces, if only forces include foreshortening
    ct_ex place[4], turn[4], line[CT_LINE_DOF]; // shape functions at the point
    ct_ex linear_value;                         // axial displacement, of r
};

// ---- points -------------------------------------------------------------------------------------

static ct_ex with_twist(struct ct_build *b, const struct ct_point *p, const ct_ex *of)
{
    ct_ex sum = CT_EX_ZERO;
    for (int i = 0; i < CT_LINE_DOF; i++)
        sum = ct_ex_add(b->x, sum, ct_ex_mul(b->x, p->line[i], of[CT_AXIS_DOF + i]));
    return sum;
}

static ct_ex dot4(struct ct_build *b, const ct_ex shape[4], const ct_ex *of)
{
    ct_ex sum = CT_EX_ZERO;
    for (int i = 0; i < 4; i++)
        sum = ct_ex_add(b->x, sum, ct_ex_mul(b->x, shape[i], of[i]));
    return sum;
}

// (twist, -dw/dx, dv/dx) of the dofs' values, rates or accelerations.
static ct_ex3 turning(struct ct_build *b, const struct ct_point *p, const ct_ex *of)
{
    return (ct_ex3){{with_twist(b, p, of), ct_ex_neg(b->x, dot4(b, p->turn, of + 6)),
                     dot4(b, p->turn, of + 2)}};
}

static void place_point(struct ct_build *b, const struct ct_flexible *f, struct ct_point *p,
                        double at, const ct_ex j[3])
{
    struct ct_exs *x = b->x;
    const struct ct_element *e = &f->element[p->element];
    const ct_ex xi = ct_ex_const(x, at), h = e->span.length;
    struct ct_axial_field a;
    ct_axial_field(b, f, p->element, xi, f->kinematics, &a);
    for (int i = 0; i < CT_AXIS_DOF; i++)
        p->along[i] = a.slope[i];
    for (int i = 0; i < 4; i++) {
        p->place[i] = ct_shape_at(x, &f->shape.deflection[i], xi, h);
        p->turn[i] = ct_shape_at(x, &f->shape.rotation[i], xi, h);
    }
    for (int i = 0; i < CT_LINE_DOF; i++)
        p->line[i] = ct_shape_at(x, &f->line[i], xi, h);
    p->linear_value = a.value;
    const ct_ex rest = ct_ex_add(x, e->span.start, ct_ex_mul(x, xi, h));
    p->r = (ct_ex3){{ct_ex_add(x, rest, a.value), dot4(b, p->place, e->value + 2),
                     dot4(b, p->place, e->value + 6)}};
    p->rate
        = (ct_ex3){{a.rate, dot4(b, p->place, e->rate + 2), dot4(b, p->place, e->rate + 6)}};
    p->bias = (ct_ex3){{a.bias, CT_EX_ZERO, CT_EX_ZERO}};
    if (f->kinematics != f->axial)
        ct_axial_field(b, f, p->element, xi, f->axial, &p->axial);
    ct_section_motion(x, !ct_flexible_turns_inertia(b, f), j, turning(b, p, e->value),
                      turning(b, p, e->rate), &p->section);
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
        kinds |= ct_ex_kinds(b->x, ct_flexible_rotary(f, i).value);
    const int wanted = kinds & 1u << CT_SYM_LOCAL ? CT_ELEMENT_POINTS : FEW_POINTS;
    const enum ct_rule rule = ct_flexible_mass_rule(f->beam);
    const int n = ct_shape_points(b->x, &mass, s, rule, wanted, xi, m);
    for (int i = 0; i < 3; i++) {
        const struct ct_profile g = ct_flexible_rotary(f, i);
        ct_shape_points(b->x, &g, s, rule, wanted, xi, j[i]);
    }
    for (int i = 0; i < n; i++) {
        struct ct_point p = {.element = e, .m = m[i]};
        const ct_ex own[3] = {j[0][i], j[1][i], j[2][i]};
        place_point(b, f, &p, xi[i], own);
        CT_PUSH(b->arena, I->point, I->npoint, *cap, p);
    }
}

// Acceleration of a point with the symbols u', minus its bias. chain: by element, that of the
// foreshortening at its start.
static ct_ex3 own_acceleration(struct ct_build *b, const struct ct_flexible *f,
                               const struct ct_point *p, const ct_ex *chain)
{
    const ct_ex *acceleration = f->element[p->element].acceleration;
    ct_ex along = chain ? chain[p->element] : CT_EX_ZERO;
    for (int i = 0; i < CT_AXIS_DOF; i++)
        along = ct_ex_add(b->x, along, ct_ex_mul(b->x, p->along[i], acceleration[i]));
    return (ct_ex3){
        {along, dot4(b, p->place, acceleration + 2), dot4(b, p->place, acceleration + 6)}};
}

// ---- the method --------------------------------------------------------------------------------

static void derive(struct ct_build *b, struct ct_flexible *f)
{
    struct ct_exs *x = b->x;
    struct ct_inertia *I = f->inertia;
    size_t cap = 0;
    for (int e = 0; e < f->beam->nelement; e++)
        add_points(b, f, e, &cap);
    for (size_t i = 0; i < I->npoint; i++) {
        const struct ct_point *p = &I->point[i];
        I->moment = ct_ex3_add(x, I->moment, ct_ex3_scale(x, p->m, p->r));
        ct_inertia_add_point(b, &I->inertia, p->m, p->r);
        for (int k = 0; k < 9; k++)
            I->inertia.e[k] = ct_ex_add(x, I->inertia.e[k], p->section.J.e[k]);
    }
}

// Adds the rows of force F and torque T at a point; T is conjugate to twist, -dw/dx and dv/dx.
static void push_point(struct ct_build *b, const struct ct_point *p, const ct_ex *along,
                       ct_ex3 F, ct_ex3 T, ct_ex sum[CT_DOF])
{
    struct ct_exs *x = b->x;
    for (int j = 0; j < CT_AXIS_DOF; j++) {
        ct_ex v = ct_ex_mul(x, along[j], F.e[0]);
        if (j >= 2 && j < 6) {
            v = ct_ex_add(x, v, ct_ex_mul(x, p->place[j - 2], F.e[1]));
            v = ct_ex_add(x, v, ct_ex_mul(x, p->turn[j - 2], T.e[2]));
        } else if (j >= 6 && j < CT_BENT_DOF) {
            v = ct_ex_add(x, v, ct_ex_mul(x, p->place[j - 6], F.e[2]));
            v = ct_ex_sub(x, v, ct_ex_mul(x, p->turn[j - 6], T.e[1]));
        }
        sum[j] = ct_ex_add(x, sum[j], v);
    }
    for (int j = 0; j < CT_LINE_DOF; j++)
        sum[CT_AXIS_DOF + j]
            = ct_ex_add(x, sum[CT_AXIS_DOF + j], ct_ex_mul(x, p->line[j], T.e[0]));
}

static void inertia_rows(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_base *m, enum ct_level level, ct_ex *by_freedom)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const ct_ex33 Om = ct_base_acceleration_matrix(b, m);
    const ct_ex *chain = level == CT_FULL ? ct_chain_accelerations(b, f) : NULL;
    ct_ex beyond = CT_EX_ZERO; // axial force of the elements beyond
    for (size_t i = I->npoint; i > 0;) {
        const int e = I->point[i - 1].element;
        ct_ex sum[CT_DOF] = {{0}}, axial = CT_EX_ZERO;
        for (; i > 0 && I->point[i - 1].element == e; i--) {
            const struct ct_point *p = &I->point[i - 1];
            ct_ex3 c = ct_ex3_add(x, m->a, ct_ex33_apply(x, &Om, p->r));
            c = ct_ex3_add(x, c, ct_twice_cross(b, m->w, p->rate));
            c = ct_ex3_add(x, c, p->bias);
            const ct_ex3 second = turning(b, p, f->element[e].acceleration);
            if (level == CT_FULL)
                c = ct_ex3_add(x, c, own_acceleration(b, f, p, chain));
            const ct_ex3 on_angles = ct_section_on_angles(x, &p->section, m->w, m->al,
                                                          level == CT_FULL ? &second : NULL);
            const ct_ex3 F = ct_ex3_scale(x, p->m, c);
            axial = ct_ex_add(x, axial, F.e[0]);
            push_point(b, p, p->along, F, on_angles, sum);
        }
        for (int j = 2; j < CT_BENT_DOF && f->kinematics == CT_AXIAL_CHAIN; j++)
            sum[j] = ct_ex_add(x, sum[j], ct_ex_mul(x, f->element[e].g[j], beyond));
        beyond = ct_ex_add(x, beyond, axial);
        for (int j = 0; j < CT_DOF; j++)
            ct_dof_push(b, f, e, j, sum[j], by_freedom);
    }
}

// Rows of foreshortening if the kinematics neglects it: quadratic velocity forces of the
// foreshortened beam minus those of the linear one, which inertia_rows contains.
static void foreshortening_rows(struct ct_build *b, const struct ct_flexible *f,
                                const struct ct_base *m, ct_ex *by_freedom)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const struct ct_base turning_only = {.w = m->w};
    const ct_ex33 ww = ct_base_acceleration_matrix(b, &turning_only);
    ct_ex beyond = CT_EX_ZERO;
    for (size_t i = I->npoint; i > 0;) {
        const int e = I->point[i - 1].element;
        ct_ex sum[CT_DOF] = {{0}}, axial = CT_EX_ZERO;
        for (; i > 0 && I->point[i - 1].element == e; i--) {
            const struct ct_point *p = &I->point[i - 1];
            const ct_ex rest = ct_ex_sub(x, p->r.e[0], p->linear_value);
            ct_ex3 r = p->r, rate = p->rate;
            r.e[0] = ct_ex_add(x, rest, p->axial.value);
            rate.e[0] = p->axial.rate;
            ct_ex3 c = ct_ex3_add(x, ct_ex33_apply(x, &ww, r), ct_twice_cross(b, m->w, rate));
            c.e[0] = ct_ex_add(x, c.e[0], p->axial.bias);
            const ct_ex3 linear
                = ct_ex3_add(x, ct_ex33_apply(x, &ww, p->r), ct_twice_cross(b, m->w, p->rate));
            const ct_ex3 F = ct_ex3_scale(x, p->m, c);
            axial = ct_ex_add(x, axial, F.e[0]);
            push_point(b, p, p->axial.slope, F, zero3, sum);
            push_point(b, p, p->along, ct_ex3_neg(x, ct_ex3_scale(x, p->m, linear)), zero3,
                       sum);
        }
        for (int j = 2; j < CT_BENT_DOF; j++)
            sum[j] = ct_ex_add(x, sum[j], ct_ex_mul(x, f->element[e].g[j], beyond));
        beyond = ct_ex_add(x, beyond, axial);
        for (int j = 0; j < CT_DOF; j++)
            ct_dof_push(b, f, e, j, sum[j], by_freedom);
    }
}

static void rows(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                 enum ct_level level, ct_ex *by_freedom)
{
    inertia_rows(b, f, m, level, by_freedom);
    if (f->kinematics != f->axial)
        foreshortening_rows(b, f, m, by_freedom);
}

static void relative_momentum(struct ct_build *b, const struct ct_flexible *f,
                              struct ct_relative *out)
{
    struct ct_exs *x = b->x;
    for (size_t i = 0; i < f->inertia->npoint; i++) {
        const struct ct_point *p = &f->inertia->point[i];
        const ct_ex3 momentum = ct_ex3_scale(x, p->m, p->rate);
        const ct_ex3 turns = ct_ex33_apply(x, &p->section.J, p->section.relative_velocity);
        out->momentum = ct_ex3_add(x, out->momentum, momentum);
        out->angular_momentum = ct_ex3_add(
            x, out->angular_momentum, ct_ex3_add(x, ct_ex3_cross(x, p->r, momentum), turns));
        out->twice_kinetic = ct_ex_add(x, out->twice_kinetic, ct_ex3_dot(x, p->rate, momentum));
        out->twice_kinetic = ct_ex_add(x, out->twice_kinetic,
                                       ct_ex3_dot(x, p->section.relative_velocity, turns));
    }
}

// Force and torque of the motion relative to the base: m (2 w x r' + r''), and of the rotation of
// the sections.
static void wrench(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                   enum ct_level level, ct_ex3 *force, ct_ex3 *torque)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const ct_ex *chain = level == CT_FULL ? ct_chain_accelerations(b, f) : NULL;
    ct_ex3 spin = zero3;
    *force = *torque = zero3;
    for (size_t i = 0; i < I->npoint; i++) {
        const struct ct_point *p = &I->point[i];
        ct_ex3 d = ct_ex3_add(x, ct_twice_cross(b, m->w, p->rate), p->bias);
        if (level == CT_FULL)
            d = ct_ex3_add(x, d, own_acceleration(b, f, p, chain));
        d = ct_ex3_scale(x, p->m, d);
        *force = ct_ex3_add(x, *force, d);
        *torque = ct_ex3_add(x, *torque, ct_ex3_cross(x, p->r, d));
        const ct_ex3 second = turning(b, p, f->element[p->element].acceleration);
        spin = ct_ex3_add(x, spin,
                          ct_ex33_apply(x, &p->section.J, p->section.relative_velocity));
        *torque = ct_ex3_add(
            x, *torque,
            ct_section_own(x, &p->section, m->w, level == CT_FULL ? &second : NULL));
    }
    *torque = ct_ex3_add(x, *torque, ct_ex3_cross(x, m->w, spin));
}

static ct_ex3 point_partial(const struct ct_point *p, int j)
{
    ct_ex3 d = zero3;
    if (j < CT_AXIS_DOF)
        d.e[0] = p->along[j];
    if (j >= 2 && j < 6)
        d.e[1] = p->place[j - 2];
    else if (j >= 6 && j < CT_BENT_DOF)
        d.e[2] = p->place[j - 6];
    return d;
}

static ct_ex3 point_turn(struct ct_build *b, const struct ct_point *p, int j)
{
    const struct ct_section *s = &p->section;
    if (j >= CT_AXIS_DOF)
        return ct_ex3_scale(b->x, p->line[j - CT_AXIS_DOF], s->rate_columns[0]);
    if (j >= 6 && j < CT_BENT_DOF)
        return ct_ex3_scale(b->x, ct_ex_neg(b->x, p->turn[j - 6]), s->rate_columns[1]);
    return j >= 2 && j < 6 ? ct_ex3_scale(b->x, p->turn[j - 2], s->rate_columns[2]) : zero3;
}

static void add_point_mass(struct ct_build *b, const struct ct_point *p,
                           struct ct_element_sums *s)
{
    struct ct_exs *x = b->x;
    s->m = ct_ex_add(x, s->m, p->m);
    s->moment = ct_ex3_add(x, s->moment, ct_ex3_scale(x, p->m, p->r));
    for (int j = 0; j < CT_DOF; j++) {
        const ct_ex3 dr = ct_ex3_scale(x, p->m, point_partial(p, j));
        const ct_ex3 dth = ct_ex33_apply(x, &p->section.J, point_turn(b, p, j));
        s->m_rf[j] = ct_ex3_add(x, s->m_rf[j], dr);
        s->m_thetaf[j]
            = ct_ex3_add(x, s->m_thetaf[j], ct_ex3_add(x, ct_ex3_cross(x, p->r, dr), dth));
        for (int k = 0; k <= j; k++) {
            const ct_ex v = ct_ex_add(x, ct_ex3_dot(x, dr, point_partial(p, k)),
                                      ct_ex3_dot(x, dth, point_turn(b, p, k)));
            s->M[j][k] = s->M[k][j] = ct_ex_add(x, s->M[j][k], v);
        }
    }
}

static struct ct_element_sums *sums_of(struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_inertia *I = f->inertia;
    struct ct_element_sums *s = CT_NEWN(b->arena, struct ct_element_sums, f->beam->nelement);
    for (size_t i = 0; i < I->npoint; i++)
        add_point_mass(b, &I->point[i], &s[I->point[i].element]);
    return s;
}

const struct ct_inertia_method ct_inertia_points = {.derive = derive,
                                                    .rows = rows,
                                                    .wrench = wrench,
                                                    .relative_momentum = relative_momentum,
                                                    .sums = sums_of};
