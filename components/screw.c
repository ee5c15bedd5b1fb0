// Screw joint: translation along the axis in proportion to the rotation about it.
//
//   across   d = axis pitch q/(2 pi), S = Rot(axis, q)          1 angle [rad]
//   through  axis . T + pitch/(2 pi) axis . F = effort law      5 reactions
//
// One coordinate serves both graphs, so the joint is a branch of both trees.
#include "base/pi.h"
#include "component/class.h"

static const struct ct_key keys[] = {
    {"axis", CT_VALUE_AXIS, 0, "", 3, 3, "axis in axes of `from` (z)"},
    {"pitch", CT_VALUE_SCALAR, CT_KEY_REQUIRED, "m", 1, 1,
     "length per turn, positive for a right-handed screw"},
};

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    const ct_ex3 n = ct_instance_axis(x, self, "axis", 2);
    const ct_ex per_radian
        = ct_ex_div(x, ct_instance_value(self, "pitch")->e[0], ct_ex_const(x, 2 * CT_PI));
    ct_ex3 e1, e2;
    ct_axes_normal(x, n, m->value, &e1, &e2);
    m->d = ct_ex3_scale(x, ct_ex_mul(x, per_radian, m->coord[0]), n);
    ct_motion_add_rotation(m, n, m->coord[0]);
    ct_motion_measure_angle(m, n, e1);
}

const struct ct_component_class ct_component_screw = {
    .name = "screw",
    .summary = "rotation about an axis with proportional translation along it",
    .family = CT_FAMILY_JOINT,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d = axis*pitch*q/(2*pi), S = Rot(axis, q)",
    .through = "axis.T + pitch/(2*pi)*axis.F = effort - stiffness*(q - rest) - damping*u; "
               "the rest are reactions",
    .ncoord = 1,
    .nfree = 1,
    .always_branch = true,
    .motion = motion,
};
