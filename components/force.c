// Applied force at the origin of a frame, in ground axes or in the turning axes of a frame.
#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/constraint_row.h"

static const struct ct_key keys[] = {
    {"at", CT_VALUE_FRAME, CT_KEY_REQUIRED, NULL, 1, 1, "frame at whose origin the force acts"},
    {"value", CT_VALUE_VEC3, CT_KEY_REQUIRED | CT_KEY_STATE, "N", 3, 3,
     "components [fx, fy, fz]"},
    {"in", CT_VALUE_FRAME, 0, NULL, 1, 1, "frame of the components (ground)"},
};

static void apply(struct ct_build *b, const struct ct_instance *self)
{
    const int node = b->topology->node_of_frame[self->to];
    struct ct_load l = {.self = self, .head = node, .force = ct_load_vector(b, self)};
    l.power = ct_ex3_dot(b->x, l.force, ct_node_velocity(b, node));
    ct_load_add(b, &l);
}

static bool signal(struct ct_build *b, const struct ct_instance *self, const char *name,
                   ct_ex *out)
{
    return ct_vector_signal(name, "force", ct_load_vector(b, self), out);
}

const struct ct_component_class ct_component_force = {
    .name = "force",
    .summary = "force at the origin of a frame",
    .family = CT_FAMILY_FORCE,
    .key = keys,
    .nkey = COUNT(keys),
    .is_moment_free = true,
    .across = "free",
    .through = "F = value, T = 0",
    .applied = CT_APPLIED_FORCE,
    .apply = apply,
    .signal = signal,
    .signals = "force.x, .y, .z",
};
