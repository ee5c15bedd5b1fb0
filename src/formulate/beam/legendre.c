// See legendre.h.
#include "formulate/beam/legendre.h"

static ct_ex half(struct ct_exs *x, ct_ex v)
{
    return ct_ex_scale(x, 0.5, v);
}

// c h v; c h is computed first
static ct_ex times(struct ct_exs *x, double c, ct_ex h, ct_ex v)
{
    return ct_ex_mul(x, ct_ex_scale(x, c, h), v);
}

static ct_ex per(struct ct_exs *x, ct_ex v, ct_ex h)
{
    return ct_ex_mul(x, ct_ex_div(x, CT_EX_ONE, h), v);
}

static void add(struct ct_exs *x, ct_ex *sum, ct_ex v)
{
    *sum = ct_ex_add(x, *sum, v);
}

// ---- bending ------------------------------------------------------------------------------------

struct ct_legendre_bending ct_legendre_bending_of(struct ct_exs *x, enum ct_beam_theory theory,
                                                  ct_ex h, const ct_ex *dof)
{
    struct ct_legendre_bending s = {0};
    const ct_ex rise = ct_ex_sub(x, dof[2], dof[0]);
    const ct_ex turns = ct_ex_add(x, dof[1], dof[3]), bend = ct_ex_sub(x, dof[3], dof[1]);
    s.slope[0] = rise;
    s.deflection[0] = half(x, ct_ex_add(x, dof[0], dof[2]));
    s.deflection[1] = half(x, rise);
    if (theory == CT_BEAM_TIMOSHENKO) {
        s.rotation[0] = half(x, turns);
        s.rotation[1] = bend;
        return s;
    }
    s.slope[1] = s.deflection[2] = bend;
    s.slope[2] = s.deflection[3] = ct_ex_sub(x, turns, ct_ex_scale(x, 2, per(x, rise, h)));
    s.deflection[0] = ct_ex_sub(x, s.deflection[0], times(x, 1.0 / 12, h, bend));
    s.deflection[1] = ct_ex_sub(x, s.deflection[1], times(x, 1.0 / 20, h, s.slope[2]));
    s.rotation[0] = per(x, rise, h);
    s.rotation[1] = s.slope[1];
    s.rotation[2] = s.slope[2];
    return s;
}

void ct_legendre_bending_add_forces(struct ct_exs *x, enum ct_beam_theory theory, ct_ex h,
                                    const struct ct_legendre_bending *force, ct_ex *dof)
{
    const ct_ex *p = force->deflection, *s = force->slope, *r = force->rotation;
    ct_ex by_rise = ct_ex_add(x, s[0], half(x, p[1])), turns = half(x, r[0]), bend = r[1];
    if (theory != CT_BEAM_TIMOSHENKO) {
        turns = ct_ex_add(x, ct_ex_add(x, s[2], p[3]), r[2]);
        turns = ct_ex_sub(x, turns, times(x, 1.0 / 20, h, p[1]));
        bend = ct_ex_add(x, ct_ex_add(x, s[1], p[2]), r[1]);
        bend = ct_ex_sub(x, bend, times(x, 1.0 / 12, h, p[0]));
        by_rise
            = ct_ex_add(x, by_rise, per(x, ct_ex_sub(x, r[0], ct_ex_scale(x, 2, turns)), h));
    }
    const ct_ex mean = half(x, p[0]);
    dof[0] = ct_ex_sub(x, mean, by_rise);
    dof[1] = ct_ex_sub(x, turns, bend);
    dof[2] = ct_ex_add(x, mean, by_rise);
    dof[3] = ct_ex_add(x, turns, bend);
}

// ---- foreshortening -----------------------------------------------------------------------------

// Sum over both planes of s_i t_j, and of s_j t_i if s and t differ.
static ct_ex products(struct ct_exs *x, const struct ct_legendre_bending s[2],
                      const struct ct_legendre_bending t[2], int i, int j)
{
    ct_ex sum = CT_EX_ZERO;
    for (int plane = 0; plane < 2; plane++) {
        add(x, &sum, ct_ex_mul(x, s[plane].slope[i], t[plane].slope[j]));
        if (i != j && s != t)
            add(x, &sum, ct_ex_mul(x, s[plane].slope[j], t[plane].slope[i]));
    }
    return sum;
}

struct ct_foreshortening_products
ct_foreshortening_products_rate(struct ct_exs *x, const struct ct_legendre_bending s[2],
                                const struct ct_legendre_bending t[2])
{
    return (struct ct_foreshortening_products){
        products(x, s, t, 0, 0), products(x, s, t, 1, 1), products(x, s, t, 2, 2),
        products(x, s, t, 0, 1), products(x, s, t, 0, 2), products(x, s, t, 1, 2)};
}

struct ct_foreshortening_products
ct_foreshortening_products_of(struct ct_exs *x, const struct ct_legendre_bending s[2])
{
    struct ct_foreshortening_products d = ct_foreshortening_products_rate(x, s, s);
    d.s00 = half(x, d.s00);
    d.s11 = half(x, d.s11);
    d.s22 = half(x, d.s22);
    return d;
}

void ct_foreshortening_products_add_forces(struct ct_exs *x,
                                           const struct ct_legendre_bending *s,
                                           const struct ct_foreshortening_products *force,
                                           struct ct_legendre_bending *out)
{
    const ct_ex by[CT_LEGENDRE_SLOPES][CT_LEGENDRE_SLOPES]
        = {{force->s00, force->s01, force->s02},
           {force->s01, force->s11, force->s12},
           {force->s02, force->s12, force->s22}};
    for (int i = 0; i < CT_LEGENDRE_SLOPES; i++)
        for (int j = 0; j < CT_LEGENDRE_SLOPES; j++)
            add(x, &out->slope[i], ct_ex_mul(x, by[i][j], s->slope[j]));
}

ct_ex ct_foreshortening_total(struct ct_exs *x, ct_ex h,
                              const struct ct_foreshortening_products *d)
{
    const ct_ex bent
        = ct_ex_add(x, times(x, 1.0 / 12, h, d->s11), times(x, 1.0 / 20, h, d->s22));
    return ct_ex_add(x, per(x, d->s00, h), bent);
}

struct ct_foreshortening_products ct_foreshortening_total_forces(struct ct_exs *x, ct_ex h,
                                                                 ct_ex force)
{
    return (struct ct_foreshortening_products){.s00 = per(x, force, h),
                                               .s11 = times(x, 1.0 / 12, h, force),
                                               .s22 = times(x, 1.0 / 20, h, force)};
}

void ct_foreshortening_axial(struct ct_exs *x, ct_ex h,
                             const struct ct_foreshortening_products *d, bool is_chain,
                             ct_ex *u)
{
    add(x, &u[0], ct_ex_scale(x, 1.0 / 12, d->s01));
    add(x, &u[0], times(x, 1.0 / 60, h, d->s12));
    add(x, &u[1], ct_ex_scale(x, 1.0 / 20, d->s02));
    add(x, &u[1], times(x, 1.0 / 60, h, d->s11));
    add(x, &u[1], times(x, 1.0 / 140, h, d->s22));
    u[2]
        = ct_ex_sub(x, u[2], ct_ex_add(x, per(x, d->s01, h), ct_ex_scale(x, 1.0 / 14, d->s12)));
    u[3] = ct_ex_sub(x, u[3], ct_ex_add(x, per(x, d->s02, h), ct_ex_scale(x, 1.0 / 3, d->s11)));
    u[4] = ct_ex_sub(x, u[4], d->s12);
    u[5] = ct_ex_sub(x, u[5], d->s22);
    const ct_ex ends = is_chain ? half(x, ct_foreshortening_total(x, h, d)) : CT_EX_ZERO;
    for (int k = 0; k < 2; k++)
        u[k] = ct_ex_sub(x, u[k], ends);
}

struct ct_foreshortening_products
ct_foreshortening_axial_forces(struct ct_exs *x, ct_ex h, const ct_ex *force, bool is_chain)
{
    const ct_ex *f = force;
    const ct_ex ends = is_chain ? half(x, ct_ex_add(x, f[0], f[1])) : CT_EX_ZERO;
    const struct ct_foreshortening_products whole = ct_foreshortening_total_forces(x, h, ends);
    struct ct_foreshortening_products d = {
        .s00 = ct_ex_neg(x, whole.s00),
        .s01 = ct_ex_sub(x, ct_ex_scale(x, 1.0 / 12, f[0]), per(x, f[2], h)),
        .s02 = ct_ex_sub(x, ct_ex_scale(x, 1.0 / 20, f[1]), per(x, f[3], h)),
        .s12 = ct_ex_sub(x, times(x, 1.0 / 60, h, f[0]), ct_ex_scale(x, 1.0 / 14, f[2])),
        .s11 = ct_ex_sub(x, times(x, 1.0 / 60, h, f[1]), ct_ex_scale(x, 1.0 / 3, f[3])),
        .s22 = ct_ex_sub(x, times(x, 1.0 / 140, h, f[1]), f[5]),
    };
    d.s12 = ct_ex_sub(x, d.s12, f[4]);
    d.s11 = ct_ex_sub(x, d.s11, whole.s11);
    d.s22 = ct_ex_sub(x, d.s22, whole.s22);
    return d;
}
