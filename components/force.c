// Applied force at the origin of a frame, in ground axes or in the turning axes of a frame.
#include "formulate/dynamics.h"
#include "formulate/row.h"

#include <string.h>

static const struct ct_key keys[] = {
    {"at", CT_VALUE_FRAME, CT_KEY_REQUIRED, NULL, 1, 1, "frame at whose origin the force acts"},
    {"value", CT_VALUE_VEC3, CT_KEY_REQUIRED | CT_KEY_STATE, "N", 3, 3,
     "components [fx, fy, fz]"},
    {"in", CT_VALUE_FRAME, 0, NULL, 1, 1, "frame of the components (ground)"},
};

static ct_ex3 ground_value(struct ct_build *b, const struct ct_instance *self)
{
    const struct ct_value *value = ct_instance_value(self, "value"),
                          *in = ct_instance_value(self, "in");
    ct_ex3 v;
    for (int i = 0; i < 3; i++)
        v.e[i] = ct_build_value(b, value->e[i]);
    return in->given ? ct_node_turn(b, b->node_of_frame[in->frame], v) : v;
}

static void apply(struct ct_build *b, const struct ct_instance *self)
{
    const int node = b->node_of_frame[self->to];
    struct ct_load l = {.self = self, .head = node, .force = ground_value(b, self)};
    l.power = ct_ex3_dot(b->x, l.force, ct_node_velocity(b, node));
    ct_load_add(b, &l);
}

static bool signal(struct ct_build *b, const struct ct_instance *self, const char *name,
                   ct_ex *out)
{
    static const char *const names[] = {"force.x", "force.y", "force.z"};
    const ct_ex3 v = ground_value(b, self);
    for (int i = 0; i < 3; i++)
        if (!strcmp(name, names[i])) {
            *out = v.e[i];
            return true;
        }
    return false;
}

const struct ct_component_class ct_component_force = {
    .name = "force",
    .summary = "force at the origin of a frame",
    .family = CT_FAMILY_FORCE,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "free",
    .through = "F = value, T = 0",
    .apply = apply,
    .signal = signal,
};
