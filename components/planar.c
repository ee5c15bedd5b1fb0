// Planar joint: motion in a plane of `from` and rotation about its normal.
//
//   across   d = e1 q1 + e2 q2, S = Rot(normal, q3)       2 lengths [m], 1 angle [rad]
//   through  e1 . F, e2 . F, normal . T follow efforts    the rest are reactions
//
// e1, e2: y, z for normal x; z, x for normal y; x, y for normal z.
#include "component/class.h"

static const struct ct_key keys[] = {
    {"normal", CT_VALUE_AXIS, 0, "", 3, 3, "normal of the plane in axes of `from` (z)"},
};

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    const ct_ex3 n = ct_instance_axis(x, self, "normal", 2);
    ct_ex3 e1, e2;
    ct_axes_normal(x, n, m->value, &e1, &e2);
    m->d = ct_ex3_add(x, ct_ex3_scale(x, m->coord[0], e1), ct_ex3_scale(x, m->coord[1], e2));
    ct_motion_add_rotation(m, n, m->coord[2]);
    m->ntrans = 1;
    m->trans[0] = n;
    m->nrot = 2;
    m->rot_from[0] = e1;
    m->rot_from[1] = e2;
    m->rot_to[0] = m->rot_to[1] = n;
    ct_motion_measure_length(m, e1);
    ct_motion_measure_length(m, e2);
    ct_motion_measure_angle(m, n, e1);
}

const struct ct_component_class ct_component_planar = {
    .name = "planar",
    .summary = "motion in a plane and rotation about its normal",
    .family = CT_FAMILY_JOINT,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d = e1*q1 + e2*q2, S = Rot(normal, q3)",
    .through = "e1.F, e2.F and normal.T follow the effort laws; the rest are reactions",
    .ncoord = 3,
    .nfree = 3,
    .motion = motion,
};
