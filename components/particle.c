// Particle: mass without rotation; its axes stay parallel to ground.
//
//   through  F = mass (g - a)                         [N]
#include "component/class.h"

static const struct ct_key keys[] = {
    {"mass", CT_VALUE_SCALAR, 0, "kg", 1, 1, "mass (0)"},
    {"shape", CT_VALUE_SOLIDS, 0, NULL, 0, 0,
     "what it is drawn with: {box: [a, b, c]}, {cylinder: [radius, length], axis: z}, {sphere: "
     "radius}, "
     "{lines: [[x, y, z], ...]} or {file: FILE.stl, scale: 1}, each with at, rotate and color; "
     "or a list "
     "of them (its frames)"},
};

const struct ct_component_class ct_component_particle = {
    .name = "particle",
    .summary = "point mass; no rotation",
    .family = CT_FAMILY_BODY,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d relative to ground",
    .through = "F = mass*(g - a)",
};
