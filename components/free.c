// Free joint: no constraint; coordinates for the relative motion of two frames.
//
//   across   d = (q1, q2, q3), S = S(q4..q7)       position in axes of `from`, unit quaternion
//   through  F, T follow the effort laws           no reaction
//
// Speeds: u1..u3 rates of q1..q3, u4..u6 angular velocity of `to` relative to `from` in axes of
// `to`.
#include "component/class.h"

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    (void)self;
    m->d = (ct_ex3){{m->coord[0], m->coord[1], m->coord[2]}};
    m->quaternion = 3;
    for (int i = 0; i < 3; i++) {
        double e[3] = {0};
        e[i] = 1;
        ct_motion_measure_length(m, ct_ex3_const(x, e));
    }
    m->measure[m->nmeasure++].kind = CT_MEASURE_QUATERNION;
}

const struct ct_component_class ct_component_free = {
    .name = "free",
    .summary = "no constraint: position and orientation of one frame in another",
    .family = CT_FAMILY_JOINT,
    .across = "d = (q1, q2, q3), S = S(q4..q7) with S' = S (u4, u5, u6)~",
    .through = "F and T follow the effort laws",
    .ncoord = 7,
    .nfree = 6,
    .motion = motion,
};
