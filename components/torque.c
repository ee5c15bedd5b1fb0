// Applied torque on a frame or body, in ground axes or in the turning axes of a frame.
#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/constraint_row.h"

static const struct ct_key keys[] = {
    {"on", CT_VALUE_FRAME, CT_KEY_REQUIRED, NULL, 1, 1,
     "body or frame on which the torque acts"},
    {"value", CT_VALUE_VEC3, CT_KEY_REQUIRED | CT_KEY_STATE, "N*m", 3, 3,
     "components [tx, ty, tz]"},
    {"in", CT_VALUE_FRAME, 0, NULL, 1, 1, "frame of the components (ground)"},
};

static void apply(struct ct_build *b, const struct ct_instance *self)
{
    const int node = b->topology->node_of_frame[self->to];
    struct ct_load l = {.self = self, .head = node, .torque = ct_load_vector(b, self)};
    l.power = ct_ex3_dot(b->x, l.torque,
                         ct_cluster_velocity(b, b->kinematics->placement[node].frame));
    ct_load_add(b, &l);
}

static bool signal(struct ct_build *b, const struct ct_instance *self, const char *name,
                   ct_ex *out)
{
    return ct_vector_signal(name, "torque", ct_load_vector(b, self), out);
}

const struct ct_component_class ct_component_torque = {
    .name = "torque",
    .summary = "torque on a body or frame",
    .family = CT_FAMILY_FORCE,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "free",
    .through = "F = 0, T = value",
    .applied = CT_APPLIED_TORQUE,
    .apply = apply,
    .signal = signal,
    .signals = "torque.x, .y, .z",
};
