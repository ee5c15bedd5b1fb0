// Weld: `from` and `to` coincide permanently.
//
//   across   d = 0, S = 1          translation [m], rotation    no freedom
//   through  F, T any              force [N], torque [N m]      6 reactions
//
// Source: McPhee (1996), key mcphee1996.
#include "component/class.h"

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    (void)self;
    ct_motion_lock_translation(x, m);
    ct_motion_lock_rotation(x, m);
}

const struct ct_component_class ct_component_weld = {
    .name = "weld",
    .summary = "two frames coincide",
    .family = CT_FAMILY_JOINT,
    .across = "d = 0, S = 1",
    .through = "F, T are reactions",
    .motion = motion,
};
