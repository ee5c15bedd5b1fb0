// Beam: a straight elastic body, divided into finite elements along its own x axis.
//
//   across   d = R r, v = v_B + R (w x r + r_q q')           arm to a point P, r = x_P + U(q)
//            R_P = R S(theta), w_P = w_B + R Y q'
//   through  F_B = -R int mu c dx                            [N]     c: acceleration of the section
//            T_B = -R int mu r x c dx                        [N m]   minus gravity, body axes
//            effort(q) = -int mu r_q . c dx - V_q            V: strain energy
//
// Source: formulation (1.6), (5.4), (5.5).
#include "component/class.h"

static const struct ct_key keys[] = {
    {"length", CT_VALUE_SCALAR, CT_KEY_REQUIRED, "m", 1, 1, "length"},
    {"elements", CT_VALUE_ELEMENTS, CT_KEY_LENGTH, "m", 1, 0,
     "number of equal elements, or a list of the places where they end, the last one `length` "
     "(1)"},
    {"density", CT_VALUE_SCALAR, CT_KEY_SECTION, "kg/m^3", 1, 1,
     "density; or mass_per_length; may contain x"},
    {"mass_per_length", CT_VALUE_SCALAR, CT_KEY_SECTION, "kg/m", 1, 1,
     "instead of density*area; may contain x"},
    {"E", CT_VALUE_SCALAR, CT_KEY_REQUIRED | CT_KEY_SECTION, "Pa", 1, 1,
     "modulus of elasticity"},
    {"G", CT_VALUE_SCALAR, CT_KEY_SECTION, "Pa", 1, 1, "shear modulus; or nu; may contain x"},
    {"nu", CT_VALUE_SCALAR, CT_KEY_SECTION, "", 1, 1,
     "Poisson's ratio: G = E/(2*(1 + nu)); may contain x"},
    {"area", CT_VALUE_SCALAR, CT_KEY_SECTION, "m^2", 1, 1,
     "area of the section; may contain x, the place along the beam"},
    {"Iy", CT_VALUE_SCALAR, CT_KEY_SECTION, "m^4", 1, 1,
     "second moment for bending in the x-z plane; may contain x"},
    {"Iz", CT_VALUE_SCALAR, CT_KEY_SECTION, "m^4", 1, 1,
     "second moment for bending in the x-y plane; may contain x"},
    {"J", CT_VALUE_SCALAR, CT_KEY_SECTION, "m^4", 1, 1,
     "torsion constant; may contain x (Iy + Iz)"},
    {"rotary_inertia", CT_VALUE_ROTARY, CT_KEY_SECTION, "kg*m", 3, 3,
     "of sections, per length: values about x, y, z, which may contain x; or true: "
     "density*(Iy + Iz, Iy, Iz), none with lumped mass (false)"},
    {"theory", CT_VALUE_WORD, 0, "euler-bernoulli|timoshenko", 1, 1, "theory of bending"},
    {"shear_factor", CT_VALUE_LIST, CT_KEY_SECTION, "", 1, 2,
     "multiplies G*area; timoshenko needs it; [ky, kz]: along y and along z; may contain x"},
    {"geometric_stiffness", CT_VALUE_WORD, 0, "standard|higher-order", 1, 1,
     "work of the axial force"},
    {"integration", CT_VALUE_WORD, 0, "full|reduced|one-point", 1, 1,
     "reduced: stiffness at the middle of each element; one-point: mass too"},
    {"mass", CT_VALUE_WORD, 0, "consistent|lumped", 1, 1,
     "lumped: half of each element's mass at its ends"},
    {"formulation", CT_VALUE_WORD, 0, "auto|linear|foreshortening|force-only|stretch-linear", 1,
     1, "how bending shortens the axis"},
    {"quadratic_velocity", CT_VALUE_WORD, 0, "true|false", 1, 1,
     "false: centrifugal and Coriolis forces of the beam about its own frame are left out; "
     "needs "
     "formulation: linear"},
    {"twist", CT_VALUE_WORD, 0, "linear|quadratic", 1, 1,
     "shape of the twist in an element; quadratic needs integration: full and mass: "
     "consistent"},
    {"stretch", CT_VALUE_WORD, 0, "linear|quadratic", 1, 1,
     "shape of the stretch in an element; quadratic needs integration: full and mass: "
     "consistent"},
    {"frame", CT_VALUE_WORD, 0, "clamped|chord", 1, 1,
     "the body's frame follows the section at x = 0 or the line between the ends"},
    {"deformation", CT_VALUE_WORDS, 0, "axial|bending-y|bending-z|torsion", 0, 4,
     "a list of what the beam may do (auto: what the scene can excite)"},
    {"modes", CT_VALUE_COUNT, 0, NULL, 1, 1,
     "keep this many modes instead of the nodes' coordinates"},
    {"damping", CT_VALUE_RAYLEIGH, 0, NULL, 1, 1,
     "{alpha: a, beta: b}: a [1/s] times mass plus b [s] times stiffness (0)"},
    {"shapes", CT_VALUE_SHAPES, CT_KEY_SECTION, NULL, 0, 0,
     "{u: [...], v: [...], w: [...], rx: [...]}: expressions of x whose amplitudes are the "
     "coordinates, instead of the nodes'"},
    {"initial", CT_VALUE_FIELDS, CT_KEY_SECTION, NULL, 0, 0,
     "equilibrium: the static shape under the loads at t = 0; or {u:, v:, w:, rx:, rates: "
     "{...}}, expressions of x (undeformed)"},
    {"points", CT_VALUE_PLACES, CT_KEY_LENGTH, NULL, 0, 0,
     "frames fixed to sections: {NAME: x}, {NAME: [x, y, z]} or {NAME: {at: PLACE, rotate: "
     "[axis, angle]}}"},
};

const struct ct_component_class ct_component_beam = {
    .name = "beam",
    .summary = "elastic beam of finite elements, a frame at x = 0 and points",
    .family = CT_FAMILY_BODY,
    .body = CT_BODY_BEAM,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "section at x: d = r(x, q), S(x, q)",
    .through = "F = -int(mu*c), T = -int(mu*r x c), effort(q) = -int(mu*r_q . c) - V_q; c: "
               "acceleration of the section minus g",
};
