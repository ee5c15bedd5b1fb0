// Particle: mass without rotation; its axes stay parallel to ground.
//
//   through  F = mass (g - a)                         [N]
#include "component/class.h"

static const struct ct_key keys[] = {
    {"mass", CT_VALUE_SCALAR, 0, "kg", 1, 1, "mass (0)"},
};

const struct ct_component_class ct_component_particle = {
    .name = "particle",
    .summary = "point mass; no rotation",
    .family = CT_FAMILY_BODY,
    .body = CT_BODY_PARTICLE,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d relative to ground",
    .through = "F = mass*(g - a)",
};
