// Stiffness of cubic elements with constant sections, by the amplitudes of amplitude.h; see elastic.h. What
// elastic_stiffness.c does with matrices of the dofs, to round-off:
//
//     bending EI/h (D_11 + 3 D_22)     twist GJ/(2h) t^2, t = phi2 - phi1     stretch u_2 - u_1 + S(1)
#include "formulate/amplitude.h"
#include "formulate/elastic.h"

struct bent {
    struct ct_bent value[2], rate[2];
    ct_ex h, per; // per: 1/h
    ct_ex K[2];   // EI/h
};

bool ct_stiffness_has_amplitudes(struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    const ct_ex section[]
        = {beam->E, beam->G, beam->area, beam->Iy, beam->Iz, beam->J, beam->mass_per_length};
    unsigned kinds = 0;
    for (size_t i = 0; i < COUNT(section); i++)
        kinds |= ct_ex_kinds(b->x, section[i]);
    return !(kinds & 1u << CT_SYM_LOCAL) && beam->theory == CT_BEAM_EULER_BERNOULLI
        && f->formulation == CT_BEAM_FORESHORTENING && !beam->higher_order
        && !beam->has_quadratic_twist // couple() knows one twist of an element
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
        s.value[plane] = ct_bent_of(x, beam->theory, s.h, self->value + first);
        s.rate[plane] = ct_bent_of(x, beam->theory, s.h, self->rate + first);
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
        const struct ct_draw of = ct_draw_of(x, s->value),
                             by = ct_draw_by(x, s->value, s->rate);
        add(x, &v, ct_draw_whole(x, s->h, &of));
        add(x, &rate, ct_draw_whole(x, s->h, &by));
    }
    return spring(b, f, ct_ex_mul(x, s->per, EA), v, rate, out);
}

// Of the axial force, which turns with the slopes, and of the bending moments.
static void bend(struct ct_build *b, const struct ct_flexible *f, int plane, ct_ex N,
                 const struct bent *s, struct ct_bent *force, struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const ct_ex K[CT_SLOPES] = {{0}, s->K[plane], ct_ex_scale(x, 3, s->K[plane])};
    const ct_ex tension[CT_SLOPES]
        = {ct_ex_mul(x, s->per, N), ct_ex_mul(x, ct_ex_scale(x, 1.0 / 12, s->h), N),
           ct_ex_mul(x, ct_ex_scale(x, 1.0 / 20, s->h), N)};
    for (int k = 0; k < CT_SLOPES; k++) {
        const ct_ex v = s->value[plane].slope[k], r = s->rate[plane].slope[k];
        const ct_ex drag = ct_ex_mul(x, ct_ex_mul(x, f->beam->damping_stiffness, K[k]), r);
        add(x, &force->slope[k], ct_ex_mul(x, ct_ex_add(x, K[k], tension[k]), v));
        add(x, &force->slope[k], drag);
        add(x, &out->drag, ct_ex_mul(x, drag, r));
        add(x, &out->energy, ct_ex_scale(x, 0.5, ct_ex_mul(x, K[k], ct_ex_mul(x, v, v))));
    }
}

// int GJ p' (b' g - g' b)/2 + E (Iy - Iz) p b' g' dx with p = p_0 + t P_1/2 and the slopes g of v and w = -b of w:
//
//     GJ t/(2h) c - E (Iy - Iz)/h (p_0 a + t m/2)     (5.6b)
//
//     c = (g_1 w_0 - g_0 w_1)/h + (g_2 w_1 - g_1 w_2)/2,   a = g_1 w_1 + 3 g_2 w_2,   m = g_1 w_2 + g_2 w_1
static void couple(struct ct_build *b, const struct ct_flexible *f, int e, const struct bent *s,
                   struct ct_bent force[2], struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const ct_ex *p = f->element[e].value + CT_PLACE_DOF;
    const ct_ex *g = s->value[0].slope, *w = s->value[1].slope, per = s->per;
    const ct_ex GJ = ct_ex_mul(x, f->beam->G, f->beam->J), t = ct_ex_sub(x, p[1], p[0]);
    const ct_ex dI = ct_ex_sub(x, s->K[1], s->K[0]); // E (Iy - Iz)/h
    const ct_ex mean = ct_ex_scale(x, 0.5, ct_ex_add(x, p[0], p[1]));
    const ct_ex torque = ct_ex_mul(x, ct_ex_scale(x, 0.5, ct_ex_mul(x, per, GJ)), t);
    const ct_ex bend = ct_ex_mul(x, dI, mean), bow = ct_ex_mul(x, ct_ex_scale(x, 0.5, dI), t);
    // the energy is sum_ij by_ij g_i w_j
    const ct_ex ends = ct_ex_mul(x, per, torque), half = ct_ex_scale(x, 0.5, torque);
    const ct_ex by[CT_SLOPES][CT_SLOPES]
        = {{{0}, ct_ex_neg(x, ends), {0}},
           {ends, ct_ex_neg(x, bend), ct_ex_neg(x, ct_ex_add(x, half, bow))},
           {{0}, ct_ex_sub(x, half, bow), ct_ex_scale(x, -3, bend)}};
    for (int i = 0; i < CT_SLOPES; i++)
        for (int j = 0; j < CT_SLOPES; j++) {
            const ct_ex v = ct_ex_mul(x, by[i][j], w[j]);
            add(x, &force[0].slope[i], v);
            add(x, &force[1].slope[j], ct_ex_mul(x, by[i][j], g[i]));
            add(x, &out->energy, ct_ex_mul(x, v, g[i]));
        }
    const ct_ex c = ct_ex_add(
        x, ct_ex_mul(x, per, ct_ex_sub(x, ct_ex_mul(x, g[1], w[0]), ct_ex_mul(x, g[0], w[1]))),
        ct_ex_scale(x, 0.5, ct_ex_sub(x, ct_ex_mul(x, g[2], w[1]), ct_ex_mul(x, g[1], w[2]))));
    const ct_ex a
        = ct_ex_add(x, ct_ex_mul(x, g[1], w[1]), ct_ex_scale(x, 3, ct_ex_mul(x, g[2], w[2])));
    const ct_ex m = ct_ex_add(x, ct_ex_mul(x, g[1], w[2]), ct_ex_mul(x, g[2], w[1]));
    const ct_ex by_t = ct_ex_sub(x, ct_ex_mul(x, ct_ex_scale(x, 0.5, ct_ex_mul(x, per, GJ)), c),
                                 ct_ex_mul(x, ct_ex_scale(x, 0.5, dI), m));
    const ct_ex by_mean = ct_ex_mul(x, ct_ex_scale(x, 0.5, dI), a);
    add(x, &out->row[CT_PLACE_DOF], ct_ex_neg(x, ct_ex_add(x, by_mean, by_t)));
    add(x, &out->row[CT_PLACE_DOF + 1], ct_ex_sub(x, by_t, by_mean));
}

static void twist(struct ct_build *b, const struct ct_flexible *f, int e, const struct bent *s,
                  struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const ct_ex *p = f->element[e].value + CT_PLACE_DOF, *r = f->element[e].rate + CT_PLACE_DOF;
    const ct_ex GJ = ct_ex_mul(x, f->beam->G, f->beam->J);
    const ct_ex torque = spring(b, f, ct_ex_mul(x, s->per, GJ), ct_ex_sub(x, p[1], p[0]),
                                ct_ex_sub(x, r[1], r[0]), out);
    add(x, &out->row[CT_PLACE_DOF], ct_ex_neg(x, torque));
    add(x, &out->row[CT_PLACE_DOF + 1], torque);
}

struct ct_element_force ct_element_bent(struct ct_build *b, const struct ct_flexible *f, int e)
{
    struct ct_exs *x = b->x;
    struct ct_element_force out = {0};
    struct ct_bent force[2] = {0};
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
        ct_bent_push(x, f->beam->theory, s.h, &force[plane], out.row + (plane ? 6 : 2));
    return out;
}
