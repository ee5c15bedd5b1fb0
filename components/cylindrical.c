// Cylindrical joint: translation along and rotation about one axis.
//
//   across   d = axis q1, S = Rot(axis, q2)    1 length [m], 1 angle [rad]
//   through  axis . F, axis . T = effort laws  the rest of F and T are reactions
//
// Source: McPhee (1996), key mcphee1996.
#include "component/class.h"

static const struct ct_key keys[] = {
    {"axis", CT_VALUE_AXIS, 0, "", 3, 3, "common axis in axes of `from` (z)"},
};

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    const ct_ex3 n = ct_instance_axis(x, self, "axis", 2);
    ct_ex3 e1, e2;
    ct_axes_normal(x, n, m->value, &e1, &e2);
    m->d = ct_ex3_scale(x, m->coord[0], n);
    ct_motion_add_rotation(m, n, m->coord[1]);
    m->ntrans = m->nrot = 2;
    m->trans[0] = m->rot_from[0] = e1;
    m->trans[1] = m->rot_from[1] = e2;
    m->rot_to[0] = m->rot_to[1] = n;
    ct_motion_measure_length(m, n);
    ct_motion_measure_angle(m, n, e1);
}

const struct ct_component_class ct_component_cylindrical = {
    .name = "cylindrical",
    .summary = "translation along and rotation about one axis",
    .family = CT_FAMILY_JOINT,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d = axis*q1, S = Rot(axis, q2)",
    .through = "axis.F and axis.T follow the effort laws; the rest of F and T are reactions",
    .ncoord = 2,
    .nfree = 2,
    .motion = motion,
};
