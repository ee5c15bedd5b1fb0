// Integrals (5.5) over a beam whose mass per length is constant, by the Legendre coefficients
// (5.5b) of legendre.h. They are equal to those of inertia_points.c up to round-off. Rotary inertia
// of the sections stays along the axes of the beam.
#include "formulate/beam/legendre.h"
#include "formulate/beam_dynamics/beam_dynamics.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// Legendre coefficients of a motion relative to the base: of displacement and rotation.
struct ct_field {
    ct_ex3 place[CT_LEGENDRE_AXIAL], turn[CT_LEGENDRE_SLOPES];
    struct ct_legendre_bending bend[2];
};

struct ct_legendre_element {
    struct ct_field value, rate;     // value: position minus x
    ct_ex3 place[CT_LEGENDRE_AXIAL]; // from the base
    ct_ex bias[CT_LEGENDRE_AXIAL];   // along the axis, second derivative with u' = 0
};

// ---- weights ------------------------------------------------------------------------------------

// int mu B^2 dx of the polynomials B, divided by the mass of the element: c h^power
static const struct {
    double c;
    int power;
} weight[CT_LEGENDRE_AXIAL] = {{1, 0},          {1.0 / 3, 0},     {1.0 / 720, 2},
                               {1.0 / 2800, 2}, {1.0 / 78400, 2}, {1.0 / 215600, 2}};
// The same of a rotation.
static const double turn_weight[CT_LEGENDRE_SLOPES] = {1, 1.0 / 12, 1.0 / 20};

static ct_ex weighted(struct ct_exs *x, ct_ex m, ct_ex h, int k)
{
    const ct_ex w = ct_ex_scale(x, weight[k].c, m);
    return weight[k].power ? ct_ex_mul(x, w, ct_ex_mul(x, h, h)) : w;
}

// Mass, rotary inertia of an element.
static ct_ex mass_of(struct ct_build *b, const struct ct_flexible *f, int e)
{
    return ct_ex_mul(b->x, f->beam->mass_per_length, f->element[e].span.length);
}

static ct_ex rotary_of(struct ct_build *b, const struct ct_flexible *f, int e, int axis)
{
    return ct_ex_mul(b->x, ct_flexible_rotary(f, axis).value, f->element[e].span.length);
}

bool ct_inertia_has_legendre(struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    unsigned kinds = ct_ex_kinds(b->x, beam->mass_per_length);
    for (int i = 0; i < 3; i++)
        kinds |= ct_ex_kinds(b->x, ct_flexible_rotary(f, i).value);
    const bool is_drawn_further = beam->higher_order && f->axial == CT_AXIAL_CHAIN;
    return !(kinds & 1u << CT_SYM_LOCAL) && ct_flexible_mass_rule(beam) == CT_RULE_FULL
        && f->kinematics == f->axial && f->axial != CT_AXIAL_LINEAR && !is_drawn_further
        && !ct_flexible_turns_inertia(b, f) && !beam->has_quadratic_twist
        && !beam->has_quadratic_stretch;
}

// ---- fields -------------------------------------------------------------------------------------

static bool is_chain(const struct ct_flexible *f)
{
    return f->axial == CT_AXIAL_CHAIN;
}

// The field linear in the dofs, without foreshortening.
static struct ct_field field_of(struct ct_build *b, const struct ct_flexible *f, int e,
                                const ct_ex *dof)
{
    struct ct_exs *x = b->x;
    const ct_ex h = f->element[e].span.length;
    struct ct_field s = {0};
    for (int plane = 0; plane < 2; plane++) {
        s.bend[plane] = ct_legendre_bending_of(x, f->beam->theory, h, dof + (plane ? 6 : 2));
        for (int k = 0; k < CT_LEGENDRE_DEFLECTIONS; k++)
            s.place[k].e[1 + plane] = s.bend[plane].deflection[k];
    }
    s.place[0].e[0] = ct_ex_scale(x, 0.5, ct_ex_add(x, dof[0], dof[1]));
    s.place[1].e[0] = ct_ex_scale(x, 0.5, ct_ex_sub(x, dof[1], dof[0]));
    for (int k = 0; k < CT_LEGENDRE_SLOPES; k++) {
        s.turn[k].e[1] = ct_ex_neg(x, s.bend[1].rotation[k]);
        s.turn[k].e[2] = s.bend[0].rotation[k];
    }
    s.turn[0].e[0] = ct_ex_scale(x, 0.5, ct_ex_add(x, dof[CT_AXIS_DOF], dof[CT_AXIS_DOF + 1]));
    s.turn[1].e[0] = ct_ex_sub(x, dof[CT_AXIS_DOF + 1], dof[CT_AXIS_DOF]);
    return s;
}

static void add_foreshortening(struct ct_build *b, const struct ct_flexible *f, int e,
                               const struct ct_foreshortening_products *d, ct_ex3 *place)
{
    ct_ex u[CT_LEGENDRE_AXIAL];
    for (int k = 0; k < CT_LEGENDRE_AXIAL; k++)
        u[k] = place[k].e[0];
    ct_foreshortening_axial(b->x, f->element[e].span.length, d, is_chain(f), u);
    for (int k = 0; k < CT_LEGENDRE_AXIAL; k++)
        place[k].e[0] = u[k];
}

static void derive_element(struct ct_build *b, const struct ct_flexible *f, int e,
                           struct ct_legendre_element *s)
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[e];
    const ct_ex h = self->span.length;
    s->value = field_of(b, f, e, self->value);
    s->rate = field_of(b, f, e, self->rate);
    const struct ct_foreshortening_products value
        = ct_foreshortening_products_of(x, s->value.bend),
        rate = ct_foreshortening_products_rate(x, s->value.bend, s->rate.bend);
    struct ct_foreshortening_products bias
        = ct_foreshortening_products_rate(x, s->rate.bend, s->rate.bend);
    // second derivatives of s_i s_j and s_i^2/2 with s'' = 0
    bias.s01 = ct_ex_scale(x, 2, bias.s01);
    bias.s02 = ct_ex_scale(x, 2, bias.s02);
    bias.s12 = ct_ex_scale(x, 2, bias.s12);
    add_foreshortening(b, f, e, &value, s->value.place);
    add_foreshortening(b, f, e, &rate, s->rate.place);
    ct_foreshortening_axial(x, h, &bias, is_chain(f), s->bias);
    if (is_chain(f)) {
        s->value.place[0].e[0] = ct_ex_add(x, s->value.place[0].e[0], self->c);
        s->rate.place[0].e[0] = ct_ex_add(x, s->rate.place[0].e[0], self->c_rate);
        s->bias[0] = ct_ex_add(x, s->bias[0], self->c_bias);
    }
    for (int k = 0; k < CT_LEGENDRE_AXIAL; k++)
        s->place[k] = s->value.place[k];
    const ct_ex middle = ct_ex_add(x, self->span.start, ct_ex_scale(x, 0.5, h));
    s->place[0].e[0] = ct_ex_add(x, middle, s->place[0].e[0]);
    s->place[1].e[0] = ct_ex_add(x, ct_ex_scale(x, 0.5, h), s->place[1].e[0]);
}

// Second derivatives with the symbols u', minus the bias. chain: by element, those of the
// foreshortening at its start.
static struct ct_field acceleration_of(struct ct_build *b, const struct ct_flexible *f, int e,
                                       const ct_ex *chain)
{
    const struct ct_legendre_element *s = &f->inertia->series[e];
    struct ct_field a = field_of(b, f, e, f->element[e].acceleration);
    const struct ct_foreshortening_products by
        = ct_foreshortening_products_rate(b->x, s->value.bend, a.bend);
    add_foreshortening(b, f, e, &by, a.place);
    if (chain)
        a.place[0].e[0] = ct_ex_add(b->x, a.place[0].e[0], chain[e]);
    return a;
}

// Adds forces on the coefficients to the dofs of the element.
static void push_field(struct ct_build *b, const struct ct_flexible *f, int e,
                       const ct_ex3 place[CT_LEGENDRE_AXIAL],
                       const ct_ex3 turn[CT_LEGENDRE_SLOPES], ct_ex dof[CT_DOF])
{
    struct ct_exs *x = b->x;
    const ct_ex h = f->element[e].span.length;
    ct_ex along[CT_LEGENDRE_AXIAL];
    for (int k = 0; k < CT_LEGENDRE_AXIAL; k++)
        along[k] = place[k].e[0];
    const struct ct_foreshortening_products by
        = ct_foreshortening_axial_forces(x, h, along, is_chain(f));
    for (int plane = 0; plane < 2; plane++) {
        struct ct_legendre_bending force = {0};
        for (int k = 0; k < CT_LEGENDRE_DEFLECTIONS; k++)
            force.deflection[k] = place[k].e[1 + plane];
        for (int k = 0; k < CT_LEGENDRE_SLOPES; k++)
            force.rotation[k] = plane ? ct_ex_neg(x, turn[k].e[1]) : turn[k].e[2];
        ct_foreshortening_products_add_forces(x, &f->inertia->series[e].value.bend[plane], &by,
                                              &force);
        ct_legendre_bending_add_forces(x, f->beam->theory, h, &force, dof + (plane ? 6 : 2));
    }
    const ct_ex mean = ct_ex_scale(x, 0.5, along[0]), rise = ct_ex_scale(x, 0.5, along[1]);
    dof[0] = ct_ex_sub(x, mean, rise);
    dof[1] = ct_ex_add(x, mean, rise);
    const ct_ex twist = ct_ex_scale(x, 0.5, turn[0].e[0]);
    dof[CT_AXIS_DOF] = ct_ex_sub(x, twist, turn[1].e[0]);
    dof[CT_AXIS_DOF + 1] = ct_ex_add(x, twist, turn[1].e[0]);
}

// ---- sums over elements of one weight -----------------------------------------------------------

// A sum of products by coefficient. It is multiplied by the weights when the mass or the length of
// an element changes.
struct sums {
    struct ct_build *b;
    ct_ex m, h;
    int n;
    ct_ex *of[CT_LEGENDRE_AXIAL];
    ct_ex *total;
};

static struct sums start_sums(struct ct_build *b, int n)
{
    struct sums s = {.b = b, .n = n, .total = CT_NEWN(b->ctx->scratch, ct_ex, n)};
    for (int k = 0; k < CT_LEGENDRE_AXIAL; k++)
        s.of[k] = CT_NEWN(b->ctx->scratch, ct_ex, n);
    return s;
}

static void close_sums(struct sums *s)
{
    struct ct_exs *x = s->b->x;
    for (int i = 0; i < s->n; i++)
        for (int k = 0; k < CT_LEGENDRE_AXIAL; k++) {
            const ct_ex v = ct_ex_mul(x, weighted(x, s->m, s->h, k), s->of[k][i]);
            s->total[i] = ct_ex_add(x, s->total[i], v);
            s->of[k][i] = CT_EX_ZERO;
        }
}

static void next_element(struct sums *s, ct_ex m, ct_ex h)
{
    if (!ct_ex_same(m, s->m) || !ct_ex_same(h, s->h))
        close_sums(s);
    s->m = m;
    s->h = h;
}

static void add_to(struct sums *s, int k, int i, ct_ex v)
{
    s->of[k][i] = ct_ex_add(s->b->x, s->of[k][i], v);
}

// ---- the method --------------------------------------------------------------------------------

static void derive(struct ct_build *b, struct ct_flexible *f)
{
    enum { XX, YY, ZZ, XY, XZ, YZ, NSUM };
    static const int row[NSUM] = {0, 1, 2, 0, 0, 1}, column[NSUM] = {0, 1, 2, 1, 2, 2};
    struct ct_exs *x = b->x;
    struct ct_inertia *I = f->inertia;
    struct sums s = start_sums(b, NSUM), first = start_sums(b, 3);
    I->series = CT_NEWN(b->arena, struct ct_legendre_element, f->beam->nelement);
    for (int e = 0; e < f->beam->nelement; e++) {
        const ct_ex m = mass_of(b, f, e), h = f->element[e].span.length;
        derive_element(b, f, e, &I->series[e]);
        next_element(&s, m, h);
        next_element(&first, m, h);
        const ct_ex3 *r = I->series[e].place;
        for (int i = 0; i < 3; i++)
            add_to(&first, 0, i, r[0].e[i]);
        for (int k = 0; k < CT_LEGENDRE_AXIAL; k++)
            for (int i = 0; i < NSUM; i++)
                add_to(&s, k, i, ct_ex_mul(x, r[k].e[row[i]], r[k].e[column[i]]));
    }
    close_sums(&s);
    close_sums(&first);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        I->moment.e[i] = first.total[i];
        I->inertia.e[4 * i] = ct_ex_add(x, s.total[j], s.total[k]);
        for (int e = 0; e < f->beam->nelement; e++)
            I->inertia.e[4 * i] = ct_ex_add(x, I->inertia.e[4 * i], rotary_of(b, f, e, i));
    }
    for (int i = XY; i < NSUM; i++)
        I->inertia.e[row[i] + 3 * column[i]] = I->inertia.e[column[i] + 3 * row[i]]
            = ct_ex_neg(x, s.total[i]);
}

static ct_ex *chain_accelerations(struct ct_build *b, const struct ct_flexible *f)
{
    return is_chain(f) ? ct_chain_accelerations(b, f) : NULL;
}

static void rows(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                 enum ct_level level, ct_ex *by_freedom)
{
    struct ct_exs *x = b->x;
    const ct_ex33 Om = ct_base_acceleration_matrix(b, m);
    const ct_ex *chain = level == CT_FULL ? chain_accelerations(b, f) : NULL;
    ct_ex beyond = CT_EX_ZERO; // axial force of the elements beyond
    for (int e = f->beam->nelement; e-- > 0;) {
        const struct ct_legendre_element *s = &f->inertia->series[e];
        const ct_ex h = f->element[e].span.length, mass = mass_of(b, f, e);
        struct ct_field a = {0};
        ct_ex3 force[CT_LEGENDRE_AXIAL], turning[CT_LEGENDRE_SLOPES];
        ct_ex sum[CT_DOF] = {{0}};
        if (level == CT_FULL)
            a = acceleration_of(b, f, e, chain);
        for (int k = 0; k < CT_LEGENDRE_AXIAL; k++) {
            ct_ex3 c = ct_ex33_apply(x, &Om, s->place[k]);
            c = ct_ex3_add(x, k ? zero3 : m->a, c);
            c = ct_ex3_add(x, c, ct_twice_cross(b, m->w, s->rate.place[k]));
            c.e[0] = ct_ex_add(x, c.e[0], s->bias[k]);
            c = ct_ex3_add(x, c, a.place[k]);
            force[k] = ct_ex3_scale(x, weighted(x, mass, h, k), c);
        }
        for (int k = 0; k < CT_LEGENDRE_SLOPES; k++)
            for (int i = 0; i < 3; i++) {
                const ct_ex J = ct_ex_scale(x, turn_weight[k], rotary_of(b, f, e, i));
                const ct_ex al = k ? a.turn[k].e[i] : ct_ex_add(x, m->al.e[i], a.turn[k].e[i]);
                turning[k].e[i] = ct_ex_mul(x, J, al);
            }
        push_field(b, f, e, force, turning, sum);
        for (int j = 2; j < CT_BENT_DOF && is_chain(f); j++)
            sum[j] = ct_ex_add(x, sum[j], ct_ex_mul(x, f->element[e].g[j], beyond));
        beyond = ct_ex_add(x, beyond, force[0].e[0]);
        for (int j = 0; j < CT_DOF; j++)
            ct_dof_push(b, f, e, j, sum[j], by_freedom);
    }
}

static void relative_momentum(struct ct_build *b, const struct ct_flexible *f,
                              struct ct_relative *out)
{
    struct ct_exs *x = b->x;
    for (int e = 0; e < f->beam->nelement; e++) {
        const struct ct_legendre_element *s = &f->inertia->series[e];
        const ct_ex h = f->element[e].span.length, mass = mass_of(b, f, e);
        for (int k = 0; k < CT_LEGENDRE_AXIAL; k++) {
            const ct_ex3 momentum = ct_ex3_scale(x, weighted(x, mass, h, k), s->rate.place[k]);
            if (k == 0)
                out->momentum = ct_ex3_add(x, out->momentum, momentum);
            out->angular_momentum
                = ct_ex3_add(x, out->angular_momentum, ct_ex3_cross(x, s->place[k], momentum));
            out->twice_kinetic
                = ct_ex_add(x, out->twice_kinetic, ct_ex3_dot(x, s->rate.place[k], momentum));
        }
        for (int k = 0; k < CT_LEGENDRE_SLOPES; k++)
            for (int i = 0; i < 3; i++) {
                const ct_ex J = ct_ex_scale(x, turn_weight[k], rotary_of(b, f, e, i)),
                            w = s->rate.turn[k].e[i], spin = ct_ex_mul(x, J, w);
                if (k == 0)
                    out->angular_momentum.e[i] = ct_ex_add(x, out->angular_momentum.e[i], spin);
                out->twice_kinetic = ct_ex_add(x, out->twice_kinetic, ct_ex_mul(x, spin, w));
            }
    }
}

static void wrench(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                   enum ct_level level, ct_ex3 *force, ct_ex3 *torque)
{
    struct ct_exs *x = b->x;
    const ct_ex *chain = level == CT_FULL ? chain_accelerations(b, f) : NULL;
    struct sums F = start_sums(b, 3), T = start_sums(b, 3);
    ct_ex3 spin = zero3, own = zero3; // of the sections' rotation
    for (int e = 0; e < f->beam->nelement; e++) {
        const struct ct_legendre_element *s = &f->inertia->series[e];
        struct ct_field a = {0};
        if (level == CT_FULL)
            a = acceleration_of(b, f, e, chain);
        next_element(&F, mass_of(b, f, e), f->element[e].span.length);
        next_element(&T, mass_of(b, f, e), f->element[e].span.length);
        for (int k = 0; k < CT_LEGENDRE_AXIAL; k++) {
            ct_ex3 d = ct_twice_cross(b, m->w, s->rate.place[k]);
            d.e[0] = ct_ex_add(x, d.e[0], s->bias[k]);
            d = ct_ex3_add(x, d, a.place[k]);
            for (int i = 0; i < 3; i++) {
                const int j = (i + 1) % 3, l = (i + 2) % 3;
                if (k == 0)
                    add_to(&F, k, i, d.e[i]);
                add_to(&T, k, i, ct_ex_mul(x, s->place[k].e[j], d.e[l]));
                add_to(&T, k, i, ct_ex_neg(x, ct_ex_mul(x, s->place[k].e[l], d.e[j])));
            }
        }
        for (int i = 0; i < 3; i++) {
            const ct_ex J = rotary_of(b, f, e, i);
            spin.e[i] = ct_ex_add(x, spin.e[i], ct_ex_mul(x, J, s->rate.turn[0].e[i]));
            own.e[i] = ct_ex_add(x, own.e[i], ct_ex_mul(x, J, a.turn[0].e[i]));
        }
    }
    close_sums(&F);
    close_sums(&T);
    for (int i = 0; i < 3; i++) {
        force->e[i] = F.total[i];
        torque->e[i] = T.total[i];
    }
    *torque = ct_ex3_add(x, *torque, ct_ex3_add(x, own, ct_ex3_cross(x, m->w, spin)));
}

// ---- mass of an element -------------------------------------------------------------------------

// Adds forces v on one axial coefficient to the dofs.
static void push_along(struct ct_build *b, const struct ct_flexible *f, int e, int k, ct_ex3 v,
                       ct_ex dof[CT_DOF])
{
    ct_ex3 place[CT_LEGENDRE_AXIAL] = {zero3}, turn[CT_LEGENDRE_SLOPES] = {zero3};
    place[k] = v;
    push_field(b, f, e, place, turn, dof);
}

// sum m r x dr by dof, with the rotation of the sections.
static void sweep_element(struct ct_build *b, const struct ct_flexible *f, int e,
                          struct ct_element_sums *s)
{
    struct ct_exs *x = b->x;
    const struct ct_legendre_element *self = &f->inertia->series[e];
    const ct_ex h = f->element[e].span.length, mass = mass_of(b, f, e);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        ct_ex3 place[CT_LEGENDRE_AXIAL] = {zero3}, turn[CT_LEGENDRE_SLOPES] = {zero3};
        ct_ex dof[CT_DOF] = {{0}};
        for (int k = 0; k < CT_LEGENDRE_AXIAL; k++) {
            const ct_ex3 r = ct_ex3_scale(x, weighted(x, mass, h, k), self->place[k]);
            place[k].e[l] = r.e[j];
            place[k].e[j] = ct_ex_neg(x, r.e[l]);
        }
        turn[0].e[i] = rotary_of(b, f, e, i);
        push_field(b, f, e, place, turn, dof);
        for (int n = 0; n < CT_DOF; n++)
            s->m_thetaf[n].e[i] = dof[n];
    }
    const ct_ex3 unit[3] = {{{CT_EX_ONE}}, {{{0}, CT_EX_ONE}}, {{{0}, {0}, CT_EX_ONE}}};
    for (int i = 0; i < 3; i++) {
        ct_ex dof[CT_DOF] = {{0}};
        push_along(b, f, e, 0, ct_ex3_scale(x, mass, unit[i]), dof);
        for (int n = 0; n < CT_DOF; n++)
            s->m_rf[n].e[i] = dof[n];
    }
}

// Derivatives of a sum of D, by dof (bending alone).
static void products_by_dof(struct ct_build *b, const struct ct_flexible *f, int e,
                            const struct ct_foreshortening_products *by, ct_ex dof[CT_DOF])
{
    for (int plane = 0; plane < 2; plane++) {
        struct ct_legendre_bending force = {0};
        ct_foreshortening_products_add_forces(b->x, &f->inertia->series[e].value.bend[plane],
                                              by, &force);
        ct_legendre_bending_add_forces(b->x, f->beam->theory, f->element[e].span.length, &force,
                                       dof + (plane ? 6 : 2));
    }
}

// int mu u^2 dx of u = xi S(1) - S(xi) is a sum of four squares, weighted:
//
//     mass h^2 ((D_01/h + 5/28 D_12)^2/120 + D_12^2/31360
//                 + (D_02/h + D_11/3 + D_22/10)^2/840 + 3/308000 D_22^2)
static int bubble_squares(struct ct_exs *x, ct_ex h, ct_ex mass,
                          struct ct_foreshortening_products square[CT_LEGENDRE_AXIAL],
                          ct_ex weights[CT_LEGENDRE_AXIAL])
{
    static const double c[] = {1.0 / 120, 1.0 / 31360, 1.0 / 840, 3.0 / 308000};
    const ct_ex per = ct_ex_div(x, CT_EX_ONE, h), hh = ct_ex_mul(x, h, h);
    square[0]
        = (struct ct_foreshortening_products){.s01 = per, .s12 = ct_ex_const(x, 5.0 / 28)};
    square[1] = (struct ct_foreshortening_products){.s12 = CT_EX_ONE};
    square[2] = (struct ct_foreshortening_products){
        .s02 = per, .s11 = ct_ex_const(x, 1.0 / 3), .s22 = ct_ex_const(x, 1.0 / 10)};
    square[3] = (struct ct_foreshortening_products){.s22 = CT_EX_ONE};
    for (size_t i = 0; i < COUNT(c); i++)
        weights[i] = ct_ex_mul(x, ct_ex_scale(x, c[i], mass), hh);
    return COUNT(c);
}

// The same for CHAIN: squares of the coefficients themselves.
static int own_squares(struct ct_exs *x, ct_ex h, ct_ex mass,
                       struct ct_foreshortening_products square[CT_LEGENDRE_AXIAL],
                       ct_ex weights[CT_LEGENDRE_AXIAL])
{
    for (int k = 0; k < CT_LEGENDRE_AXIAL; k++) {
        ct_ex by[CT_LEGENDRE_AXIAL] = {{0}};
        by[k] = CT_EX_ONE;
        square[k] = ct_foreshortening_axial_forces(x, h, by, true);
        weights[k] = weighted(x, mass, h, k);
    }
    return CT_LEGENDRE_AXIAL;
}

static struct ct_foreshortening_products scaled_products(struct ct_exs *x, ct_ex c,
                                                         struct ct_foreshortening_products d)
{
    return (struct ct_foreshortening_products){ct_ex_mul(x, c, d.s00), ct_ex_mul(x, c, d.s11),
                                               ct_ex_mul(x, c, d.s22), ct_ex_mul(x, c, d.s01),
                                               ct_ex_mul(x, c, d.s02), ct_ex_mul(x, c, d.s12)};
}

static void add_pair(struct ct_exs *x, struct ct_element_sums *s, int i, int j, ct_ex v)
{
    s->M[i][j] = ct_ex_add(x, s->M[i][j], v);
    if (i != j)
        s->M[j][i] = s->M[i][j];
}

// Mass terms of the foreshortening: with itself and with the axial dofs.
static void foreshortening_mass(struct ct_build *b, const struct ct_flexible *f, int e,
                                struct ct_element_sums *s)
{
    struct ct_exs *x = b->x;
    const ct_ex h = f->element[e].span.length, mass = mass_of(b, f, e);
    struct ct_foreshortening_products square[CT_LEGENDRE_AXIAL];
    ct_ex weights[CT_LEGENDRE_AXIAL];
    s->nsquare = is_chain(f) ? own_squares(x, h, mass, square, weights)
                             : bubble_squares(x, h, mass, square, weights);
    for (int i = 0; i < s->nsquare; i++) {
        const struct ct_foreshortening_products heavy
            = scaled_products(x, weights[i], square[i]);
        products_by_dof(b, f, e, &square[i], s->square[i]);
        products_by_dof(b, f, e, &heavy, s->heavy[i]);
        s->weight[i] = weights[i];
    }
    // u_0 = (U_i + U_i+1)/2 + ..., u_1 = (U_i+1 - U_i)/2 + ...
    ct_ex mean[CT_DOF] = {{0}}, rise[CT_DOF] = {{0}};
    const ct_ex by[2][CT_LEGENDRE_AXIAL]
        = {{ct_ex_scale(x, 0.5, mass)}, {{0}, ct_ex_scale(x, 1.0 / 6, mass)}};
    const struct ct_foreshortening_products by_mean
        = ct_foreshortening_axial_forces(x, h, by[0], is_chain(f)),
        by_rise = ct_foreshortening_axial_forces(x, h, by[1], is_chain(f));
    products_by_dof(b, f, e, &by_mean, mean);
    products_by_dof(b, f, e, &by_rise, rise);
    for (int j = 2; j < CT_BENT_DOF; j++) {
        add_pair(x, s, 0, j, ct_ex_sub(x, mean[j], rise[j]));
        add_pair(x, s, 1, j, ct_ex_add(x, mean[j], rise[j]));
    }
}

static struct ct_element_sums *sums_of(struct ct_build *b, const struct ct_flexible *f)
{
    struct ct_exs *x = b->x;
    struct ct_element_sums *s = CT_NEWN(b->arena, struct ct_element_sums, f->beam->nelement);
    for (int e = 0; e < f->beam->nelement; e++) {
        ct_ex K[CT_DOF][CT_DOF];
        ct_element_matrices(b, f, e, K, s[e].M);
        s[e].m = mass_of(b, f, e);
        s[e].moment = ct_ex3_scale(x, s[e].m, f->inertia->series[e].place[0]);
        sweep_element(b, f, e, &s[e]);
        foreshortening_mass(b, f, e, &s[e]);
    }
    return s;
}

const struct ct_inertia_method ct_inertia_legendre = {.derive = derive,
                                                      .rows = rows,
                                                      .wrench = wrench,
                                                      .relative_momentum = relative_momentum,
                                                      .sums = sums_of};
