// Prismatic joint: translation along one axis.
//
//   across   d = axis q, S = 1                 1 length [m]
//   through  axis . F = effort law             F across the axis and T are reactions
//
// Source: McPhee (1996), key mcphee1996.
#include "component/class.h"

static const struct ct_key keys[] = {
    {"axis", CT_VALUE_AXIS, 0, "", 3, 3, "direction of motion in axes of `from` (x)"},
};

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    const ct_ex3 n = ct_instance_axis(x, self, "axis", 0);
    ct_ex3 e1, e2;
    ct_axes_normal(x, n, m->value, &e1, &e2);
    m->d = ct_ex3_scale(x, m->coord[0], n);
    m->ntrans = 2;
    m->trans[0] = e1;
    m->trans[1] = e2;
    ct_motion_lock_rotation(x, m);
    ct_motion_measure_length(m, n);
}

const struct ct_component_class ct_component_prismatic = {
    .name = "prismatic",
    .summary = "translation along one axis",
    .family = CT_FAMILY_JOINT,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d = axis*q, S = 1",
    .through
    = "axis.F = effort - stiffness*(q - rest) - damping*u; T and the rest of F are reactions",
    .ncoord = 1,
    .nfree = 1,
    .motion = motion,
};
