// Gear: two joint coordinates in a fixed ratio.
//
//   across   q_a = ratio q_b + const               1 constraint, the constant from the start
//   through  effort lam on a, -ratio lam on b      1 reaction
#include "formulate/kinematics/constraint_row.h"

static const struct ct_key keys[] = {
    {"joints", CT_VALUE_JOINTS, CT_KEY_REQUIRED, NULL, 2, 2,
     "the two coordinates, a joint's name or JOINT.q2"},
    {"ratio", CT_VALUE_SCALAR, CT_KEY_REQUIRED, NULL, 1, 1,
     "turns of the first per turn of the second"},
};

static void apply(struct ct_build *b, const struct ct_instance *self)
{
    const struct ct_value *joints = ct_instance_value(self, "joints");
    const int a = ct_coordinate_find(b, joints->name[0]),
              c = ct_coordinate_find(b, joints->name[1]);
    if (a >= 0 && c >= 0)
        ct_row_couple(b, self, a, c, ct_instance_value(self, "ratio")->e[0]);
}

const struct ct_component_class ct_component_gear = {
    .name = "gear",
    .summary = "two joint coordinates in a fixed ratio",
    .family = CT_FAMILY_JOINT,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "q_a = ratio*q_b + const",
    .through = "effort lambda on a and -ratio*lambda on b",
    .apply = apply,
};
