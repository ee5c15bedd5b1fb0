// Rigid body: mass and inertia about the centre of mass.
//
//   through  F = mass (g - a_C)                       [N]
//            T = -(I al + w x I w)                    [N m]   about C
//
// Source: formulation (1.4).
#include "component/class.h"

static const struct ct_key keys[] = {
    {"mass", CT_VALUE_SCALAR, 0, "kg", 1, 1, "mass (0)"},
    {"inertia", CT_VALUE_LIST, 0, "kg*m^2", 1, 6,
     "about the centre of mass in body axes: one moment for every axis, [Ixx, Iyy, Izz] or "
     "[Ixx, Iyy, Izz, Ixy, Ixz, Iyz] (0)"},
    {"com", CT_VALUE_VEC3, 0, "m", 3, 3, "centre of mass, from the body's frame ([0, 0, 0])"},
    {"points", CT_VALUE_POINTS, 0, NULL, 0, 0,
     "frames fixed to the body: {NAME: [x, y, z]} or {NAME: {at: [x, y, z], rotate: [axis, "
     "angle]}}"},
    {"shape", CT_VALUE_SOLIDS, 0, NULL, 0, 0,
     "what it is drawn with: {box: [a, b, c]}, {cylinder: [radius, length], axis: z}, {sphere: "
     "radius}, "
     "{lines: [[x, y, z], ...]} or {file: FILE.stl, scale: 1}, each with at, rotate and color; "
     "or a list "
     "of them (its frames)"},
};

const struct ct_component_class ct_component_rigid = {
    .name = "rigid",
    .summary = "rigid body with mass, inertia and points",
    .family = CT_FAMILY_BODY,
    .is_standard = true,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d, S of the centre of mass relative to ground",
    .through = "F = mass*(g - a), T = -(I*al + w x I*w)",
};
