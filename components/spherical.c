// Spherical joint: `from` and `to` share a point, rotation is free.
//
//   across   d = 0, S = S(p)         unit quaternion p = q1..q4, scalar first
//   through  T = effort law          F is a reaction
//
// Speeds are the angular velocity of `to` relative to `from` in axes of `to`, so no orientation is
// singular. Source: formulation (7.1), (7.2).
#include "component/class.h"

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    (void)self;
    m->quaternion = 0;
    ct_motion_lock_translation(x, m);
    m->nmeasure = 1;
    m->measure[0].kind = CT_MEASURE_QUATERNION;
}

const struct ct_component_class ct_component_spherical = {
    .name = "spherical",
    .summary = "two frames share a point; rotation is free",
    .family = CT_FAMILY_JOINT,
    .is_moment_free = true,
    .across = "d = 0, S = S(q1..q4) with S' = S u~",
    .through = "T = effort - damping*u; F is a reaction",
    .ncoord = 4,
    .nfree = 3,
    .motion = motion,
};
