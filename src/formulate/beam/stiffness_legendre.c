// Stiffness of cubic elements with constant sections, by the coefficients of legendre.h; see
// stiffness.h. Equal to the element matrices of stiffness.c up to round-off:
//
//     bending EI/h (D_11 + 3 D_22)     twist GJ/(2h) t^2, t = phi2 - phi1
//     stretch u_2 - u_1 + S(1)
#include "formulate/beam/stiffness.h"
#include "formulate/beam/legendre.h"

struct bent {
    struct ct_legendre_bending value[2], rate[2];
    ct_ex h, per; // per: 1/h
    ct_ex K[2];   // EI/h
};

bool ct_stiffness_has_legendre(struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    const ct_ex section[]
        = {beam->E, beam->G, beam->area, beam->Iy, beam->Iz, beam->J, beam->mass_per_length};
    unsigned kinds = 0;
    for (size_t i = 0; i < COUNT(section); i++)
        kinds |= ct_ex_kinds(b->x, section[i]);
    return !(kinds & 1u << CT_SYM_LOCAL) && beam->theory == CT_BEAM_EULER_BERNOULLI
        && f->formulation == CT_BEAM_FORESHORTENING && !beam->higher_order
        && !beam->has_quadratic_twist // couple() supports linear twist only
        && !beam->has_quadratic_stretch && ct_flexible_stiffness_rule(beam) == CT_RULE_FULL
        && ct_ex_is_zero(beam->damping_mass);
}

static struct bent bent_of(struct ct_build *b, const struct ct_flexible *f, int e)
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[e];
    const struct ct_beam *beam = f->beam;
    struct bent s = {.h = self->span.length};
    s.per = ct_ex_div(x, CT_EX_ONE, s.h);
    for (int plane = 0; plane < 2; plane++) {
        const int first = plane ? 6 : 2;
        const ct_ex EI = ct_ex_mul(x, beam->E, plane ? beam->Iy : beam->Iz);
        if (!(f->deformation & (plane ? CT_BEAM_BENDING_Y : CT_BEAM_BENDING_Z)))
            continue;
        s.value[plane] = ct_legendre_bending_of(x, beam->theory, s.h, self->value + first);
        s.rate[plane] = ct_legendre_bending_of(x, beam->theory, s.h, self->rate + first);
        s.K[plane] = ct_ex_mul(x, s.per, EI);
    }
    return s;
}

static void add(struct ct_exs *x, ct_ex *sum, ct_ex v)
{
    *sum = ct_ex_add(x, *sum, v);
}

// k v and its damping beta k rate, for V = k v^2/2
static ct_ex spring(struct ct_build *b, const struct ct_flexible *f, ct_ex k, ct_ex v,
                    ct_ex rate, struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const ct_ex elastic = ct_ex_mul(x, k, v);
    const ct_ex drag = ct_ex_mul(x, ct_ex_mul(x, f->beam->damping_stiffness, k), rate);
    add(x, &out->energy, ct_ex_scale(x, 0.5, ct_ex_mul(x, elastic, v)));
    add(x, &out->drag, ct_ex_mul(x, drag, rate));
    return ct_ex_add(x, elastic, drag);
}

// Axial force.
static ct_ex stretch(struct ct_build *b, const struct ct_flexible *f, int e,
                     const struct bent *s, struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[e];
    const ct_ex EA = ct_ex_mul(x, f->beam->E, f->beam->area);
    ct_ex v = ct_ex_sub(x, self->value[1], self->value[0]);
    ct_ex rate = ct_ex_sub(x, self->rate[1], self->rate[0]);
    if (f->axial == CT_AXIAL_LOCAL) {
        const struct ct_foreshortening_products of
            = ct_foreshortening_products_of(x, s->value),
            by = ct_foreshortening_products_rate(x, s->value, s->rate);
        add(x, &v, ct_foreshortening_total(x, s->h, &of));
        add(x, &rate, ct_foreshortening_total(x, s->h, &by));
    }
    return spring(b, f, ct_ex_mul(x, s->per, EA), v, rate, out);
}

// Forces on the slopes by the axial force and by the bending moments.
static void bend(struct ct_build *b, const struct ct_flexible *f, int plane, ct_ex N,
                 const struct bent *s, struct ct_legendre_bending *force,
                 struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const ct_ex K[CT_LEGENDRE_SLOPES] = {{0}, s->K[plane], ct_ex_scale(x, 3, s->K[plane])};
    const ct_ex tension[CT_LEGENDRE_SLOPES]
        = {ct_ex_mul(x, s->per, N), ct_ex_mul(x, ct_ex_scale(x, 1.0 / 12, s->h), N),
           ct_ex_mul(x, ct_ex_scale(x, 1.0 / 20, s->h), N)};
    for (int k = 0; k < CT_LEGENDRE_SLOPES; k++) {
        const ct_ex v = s->value[plane].slope[k], r = s->rate[plane].slope[k];
        const ct_ex drag = ct_ex_mul(x, ct_ex_mul(x, f->beam->damping_stiffness, K[k]), r);
        add(x, &force->slope[k], ct_ex_mul(x, ct_ex_add(x, K[k], tension[k]), v));
        add(x, &force->slope[k], drag);
        add(x, &out->drag, ct_ex_mul(x, drag, r));
        add(x, &out->energy, ct_ex_scale(x, 0.5, ct_ex_mul(x, K[k], ct_ex_mul(x, v, v))));
    }
}

// (5.6b) at the two Gauss points z = +-1/sqrt(3), where the curvatures are exact.
// With the slopes g of v and w of w, p = m + t z/2 and D = E (Iz - Iy)/h if that is positive,
//
//     GJ/(2h) ((t + c_0/2)^2 - t^2 + c_1^2/12)
//     + D/2 ((g_1 + a_0)^2 - g_1^2 + (3 g_2 + a_1)^2/3 - 3 g_2^2)
//
//     c_0 = (g_1 w_0 - g_0 w_1)/h + (g_2 w_1 - g_1 w_2)/2,   c_1 = 3 (g_2 w_0 - g_0 w_2)/h
//     a_0 = m w_1 + t w_2/2,   a_1 = 3 m w_2 + t w_1/2
//
// and where Iy > Iz the same with -p, g and w exchanged.

// Adds D/2 (...) of the stiff plane i: force by slopes; by[0], by[1]: derivatives by m and t.
static void bend_turned(struct ct_exs *x, ct_ex D, ct_ex m, ct_ex t, const ct_ex *stiff,
                        const ct_ex *soft, struct ct_legendre_bending *force_stiff,
                        struct ct_legendre_bending *force_soft, ct_ex by[2],
                        struct ct_element_force *out)
{
    const ct_ex half = ct_ex_scale(x, 0.5, t), sixth = ct_ex_scale(x, 1.0 / 6, t);
    const ct_ex a0 = ct_ex_add(x, ct_ex_mul(x, m, soft[1]), ct_ex_mul(x, half, soft[2])),
                a1 = ct_ex_add(x, ct_ex_scale(x, 3, ct_ex_mul(x, m, soft[2])),
                               ct_ex_mul(x, half, soft[1]));
    // derivatives by a_0 and, three times, a_1; without the bending stiffness
    const ct_ex turned0 = ct_ex_mul(x, D, a0), turned1 = ct_ex_mul(x, D, a1);
    const ct_ex M0 = ct_ex_add(x, ct_ex_mul(x, D, stiff[1]), turned0),
                M1 = ct_ex_add(x, ct_ex_scale(x, 3, ct_ex_mul(x, D, stiff[2])), turned1);
    add(x, &force_stiff->slope[1], turned0);
    add(x, &force_stiff->slope[2], turned1);
    add(x, &force_soft->slope[1], ct_ex_add(x, ct_ex_mul(x, M0, m), ct_ex_mul(x, M1, sixth)));
    add(x, &force_soft->slope[2], ct_ex_add(x, ct_ex_mul(x, M0, half), ct_ex_mul(x, M1, m)));
    add(x, &by[0], ct_ex_add(x, ct_ex_mul(x, M0, soft[1]), ct_ex_mul(x, M1, soft[2])));
    add(x, &by[1],
        ct_ex_scale(x, 0.5,
                    ct_ex_add(x, ct_ex_mul(x, M0, soft[2]),
                              ct_ex_scale(x, 1.0 / 3, ct_ex_mul(x, M1, soft[1])))));
    const ct_ex mean = ct_ex_add(x, ct_ex_mul(x, M0, a0), ct_ex_mul(x, turned0, stiff[1]));
    const ct_ex bow = ct_ex_add(x, ct_ex_scale(x, 1.0 / 3, ct_ex_mul(x, M1, a1)),
                                ct_ex_mul(x, turned1, stiff[2]));
    add(x, &out->energy, ct_ex_scale(x, 0.5, ct_ex_add(x, mean, bow)));
}

// Adds GJ/(2h) (...); by_t: derivative by t.
static void twist_bent(struct ct_exs *x, ct_ex GJ, ct_ex per, ct_ex t, const ct_ex *g,
                       const ct_ex *w, struct ct_legendre_bending force[2], ct_ex *by_t,
                       struct ct_element_force *out)
{
    const ct_ex K = ct_ex_mul(x, per, GJ);
    const ct_ex c0 = ct_ex_add(
        x, ct_ex_mul(x, per, ct_ex_sub(x, ct_ex_mul(x, g[1], w[0]), ct_ex_mul(x, g[0], w[1]))),
        ct_ex_scale(x, 0.5, ct_ex_sub(x, ct_ex_mul(x, g[2], w[1]), ct_ex_mul(x, g[1], w[2]))));
    const ct_ex c1
        = ct_ex_mul(x, ct_ex_scale(x, 3, per),
                    ct_ex_sub(x, ct_ex_mul(x, g[2], w[0]), ct_ex_mul(x, g[0], w[2])));
    const ct_ex turned = ct_ex_scale(x, 0.5, ct_ex_mul(x, K, c0));
    // derivatives by c_0 and c_1
    const ct_ex T0 = ct_ex_scale(x, 0.5, ct_ex_add(x, ct_ex_mul(x, K, t), turned)),
                T1 = ct_ex_scale(x, 1.0 / 12, ct_ex_mul(x, K, c1));
    const ct_ex half = ct_ex_scale(x, 0.5, T0), ends = ct_ex_mul(x, per, T0),
                bow = ct_ex_mul(x, ct_ex_scale(x, 3, per), T1);
    // c_0 T_0 + c_1 T_1 = sum_ij by_ij g_i w_j, by = -by'
    const ct_ex by[CT_LEGENDRE_SLOPES][CT_LEGENDRE_SLOPES]
        = {{{0}, ct_ex_neg(x, ends), ct_ex_neg(x, bow)},
           {ends, {0}, ct_ex_neg(x, half)},
           {bow, half, {0}}};
    for (int i = 0; i < CT_LEGENDRE_SLOPES; i++)
        for (int j = 0; j < CT_LEGENDRE_SLOPES; j++) {
            add(x, &force[0].slope[i], ct_ex_mul(x, by[i][j], w[j]));
            add(x, &force[1].slope[j], ct_ex_mul(x, by[i][j], g[i]));
        }
    add(x, by_t, turned);
    const ct_ex work = ct_ex_add(x, ct_ex_mul(x, T0, c0), ct_ex_mul(x, T1, c1));
    add(x, &out->energy, ct_ex_scale(x, 0.5, ct_ex_add(x, work, ct_ex_mul(x, turned, t))));
}

static void couple(struct ct_build *b, const struct ct_flexible *f, int e, const struct bent *s,
                   struct ct_legendre_bending force[2], struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const ct_ex *p = f->element[e].value + CT_AXIS_DOF, EI = ct_ex_mul(x, s->per, f->beam->E);
    const ct_ex *g = s->value[0].slope, *w = s->value[1].slope;
    const ct_ex t = ct_ex_sub(x, p[1], p[0]), m = ct_ex_scale(x, 0.5, ct_ex_add(x, p[0], p[1]));
    ct_ex by[2] = {CT_EX_ZERO, CT_EX_ZERO}, against[2] = {CT_EX_ZERO, CT_EX_ZERO};
    bend_turned(x, ct_ex_mul(x, EI, ct_stiffer(x, f->beam->Iz, f->beam->Iy)), m, t, g, w,
                &force[0], &force[1], by, out);
    bend_turned(x, ct_ex_mul(x, EI, ct_stiffer(x, f->beam->Iy, f->beam->Iz)), ct_ex_neg(x, m),
                ct_ex_neg(x, t), w, g, &force[1], &force[0], against, out);
    twist_bent(x, ct_ex_mul(x, f->beam->G, f->beam->J), s->per, t, g, w, force, &by[1], out);
    const ct_ex by_mean = ct_ex_scale(x, 0.5, ct_ex_sub(x, by[0], against[0])),
                by_t = ct_ex_sub(x, by[1], against[1]);
    add(x, &out->row[CT_AXIS_DOF], ct_ex_sub(x, by_mean, by_t));
    add(x, &out->row[CT_AXIS_DOF + 1], ct_ex_add(x, by_mean, by_t));
}

static void twist(struct ct_build *b, const struct ct_flexible *f, int e, const struct bent *s,
                  struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const ct_ex *p = f->element[e].value + CT_AXIS_DOF, *r = f->element[e].rate + CT_AXIS_DOF;
    const ct_ex GJ = ct_ex_mul(x, f->beam->G, f->beam->J);
    const ct_ex torque = spring(b, f, ct_ex_mul(x, s->per, GJ), ct_ex_sub(x, p[1], p[0]),
                                ct_ex_sub(x, r[1], r[0]), out);
    add(x, &out->row[CT_AXIS_DOF], ct_ex_neg(x, torque));
    add(x, &out->row[CT_AXIS_DOF + 1], torque);
}

struct ct_element_force ct_element_force_legendre(struct ct_build *b,
                                                  const struct ct_flexible *f, int e)
{
    struct ct_exs *x = b->x;
    struct ct_element_force out = {0};
    struct ct_legendre_bending force[2] = {0};
    const unsigned bending = CT_BEAM_BENDING_Y | CT_BEAM_BENDING_Z;
    const struct bent s = bent_of(b, f, e);
    ct_ex N = CT_EX_ZERO;
    if (f->deformation & CT_BEAM_AXIAL) {
        N = stretch(b, f, e, &s, &out);
        out.row[0] = ct_ex_neg(x, N);
        out.row[1] = N;
    }
    for (int plane = 0; plane < 2; plane++)
        bend(b, f, plane, f->axial == CT_AXIAL_LOCAL ? N : CT_EX_ZERO, &s, &force[plane], &out);
    if (f->deformation & CT_BEAM_TORSION)
        twist(b, f, e, &s, &out);
    if ((f->deformation & bending) == bending && f->deformation & CT_BEAM_TORSION)
        couple(b, f, e, &s, force, &out);
    for (int plane = 0; plane < 2; plane++)
        ct_legendre_bending_add_forces(x, f->beam->theory, s.h, &force[plane],
                                       out.row + (plane ? 6 : 2));
    return out;
}
