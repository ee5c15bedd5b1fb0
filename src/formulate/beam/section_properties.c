// See section_properties.h.
#include "formulate/beam/section_properties.h"

#include <math.h>

enum ct_rule ct_flexible_mass_rule(const struct ct_beam *beam)
{
    return beam->is_lumped                        ? CT_RULE_ENDS
         : beam->integration == CT_BEAM_ONE_POINT ? CT_RULE_MIDDLE
                                                  : CT_RULE_FULL;
}

enum ct_rule ct_flexible_stiffness_rule(const struct ct_beam *beam)
{
    return beam->integration == CT_BEAM_FULL ? CT_RULE_FULL : CT_RULE_MIDDLE;
}

bool ct_flexible_turns_inertia(const struct ct_build *b, const struct ct_flexible *f)
{
    return f->formulation == CT_BEAM_FORESHORTENING && f->beam->has_rotary
        && !b->topology->is_planar;
}

// Inertia per length about the axes; torsion has a default if none is given.
struct ct_profile ct_flexible_rotary(const struct ct_flexible *f, int axis)
{
    const struct ct_beam *beam = f->beam;
    struct ct_profile g = {beam->x, CT_EX_ZERO};
    if (beam->has_rotary)
        g.value = beam->rotary[axis];
    else if (axis == 0 && f->deformation & CT_BEAM_TORSION)
        g.value = beam->twist_inertia;
    return g;
}

ct_ex ct_flexible_shear(struct ct_build *b, const struct ct_flexible *f, int plane)
{
    const struct ct_beam *beam = f->beam;
    return beam->theory == CT_BEAM_TIMOSHENKO
             ? ct_ex_mul(b->x, beam->shear_factor[plane], ct_ex_mul(b->x, beam->G, beam->area))
             : CT_EX_ZERO;
}

// With slopes and rotations linear in an element, a curvature c gives the moment EI c h and the
// shear c (x - h/2), which vanishes at the midpoint: (EI + k GA h^2/12) c^2 h/2.
double ct_flexible_locking(struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_beam *beam = f->beam;
    double most = 0;
    if (beam->theory != CT_BEAM_TIMOSHENKO || ct_flexible_stiffness_rule(beam) != CT_RULE_FULL)
        return 0;
    for (int plane = 0; plane < 2; plane++) {
        const struct ct_profile GA
            = {beam->x, ct_flexible_shear(b, f, plane)},
            EI = {beam->x, ct_ex_mul(b->x, beam->E, plane ? beam->Iy : beam->Iz)};
        const bool bends = f->deformation & (plane ? CT_BEAM_BENDING_Y : CT_BEAM_BENDING_Z);
        for (int e = 0; e < beam->nelement && bends; e++) {
            const struct ct_span *s = &f->element[e].span;
            const double h = ct_ex_value(b->x, s->length, b->value),
                         shear = ct_ex_value(b->x, ct_profile_at(b->x, &GA, s, 0.5), b->value),
                         bend = ct_ex_value(b->x, ct_profile_at(b->x, &EI, s, 0.5), b->value);
            most = fmax(most, shear * h * h / (12 * bend));
        }
    }
    return most;
}

ct_ex ct_flexible_integral(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex g,
                           const struct ct_shape *p, const struct ct_shape *q,
                           enum ct_rule rule)
{
    const struct ct_profile profile = {f->beam->x, g};
    const struct ct_shape both = ct_shape_mul(p, q);
    if (ct_ex_is_zero(g) || ct_shape_is_zero(&both))
        return CT_EX_ZERO;
    return ct_shape_integral(b->x, &profile, &both, &f->element[e].span, rule);
}

ct_ex ct_stiffer(struct ct_exs *x, ct_ex I, ct_ex other)
{
    return ct_ex_fun2(x, CT_OP_MAX, ct_ex_sub(x, I, other), CT_EX_ZERO);
}
