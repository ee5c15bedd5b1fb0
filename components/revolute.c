// Revolute joint: rotation about one axis.
//
//   across   d = 0, S = Rot(axis, q)           1 angle [rad]
//   through  axis . T = effort law             F and T across the axis are reactions
//
// Source: formulation of McPhee (1996), key mcphee1996.
#include "component/class.h"

static const struct ct_key keys[] = {
    {"axis", CT_VALUE_AXIS, 0, "", 3, 3, "axis of rotation in axes of `from` (z)"},
};

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    const ct_ex3 n = ct_instance_axis(x, self, "axis", 2);
    ct_ex3 e1, e2;
    ct_axes_normal(x, n, m->value, &e1, &e2);
    ct_motion_add_rotation(m, n, m->coord[0]);
    ct_motion_lock_translation(x, m);
    m->nrot = 2; // e1 . n = e2 . n = 0
    m->rot_from[0] = e1;
    m->rot_from[1] = e2;
    m->rot_to[0] = m->rot_to[1] = n;
    ct_motion_measure_angle(m, n, e1);
}

const struct ct_component_class ct_component_revolute = {
    .name = "revolute",
    .summary = "rotation about one axis",
    .family = CT_FAMILY_JOINT,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d = 0, S = Rot(axis, q)",
    .through
    = "axis.T = effort - stiffness*(q - rest) - damping*u; F and the rest of T are reactions",
    .ncoord = 1,
    .nfree = 1,
    .motion = motion,
};
