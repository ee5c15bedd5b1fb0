// Flexible bodies in a floating frame of reference. This folder defines the finite elements of
// beams: elastic coordinates, shape functions, kinematics of sections, stiffness, modal reduction
// and static condensation.  (formulation 1.2, 5.3)
//
//   elastic coordinate k   unknown of the model: nodal displacement, rotation, or modal coordinate
//   freedom f              8 per node (u v w rx ry rz, and rm um of the element before it):
//                          sum over k of coef * coordinate; fixed ones are zero
//   dof j                  14 of an element, each a freedom with a sign (the slope dw/dx is -ry):
//                          0 1 axial | 2-5 along y: v, dv/dx, v, dv/dx | 6-9 along z the same
//                          | 10 axial in the middle | 11-13 twist
//
// Axes are those of the beam; `base` is the node of its body frame, at an anchor without offset.
//
// Axial displacement of the axis, c the foreshortening up to the element (formulation 1.7):
//   LINEAR   (1 - xi) u_i + xi u_i+1; to this and to the others 4 xi (1 - xi) um is added
//   LOCAL    the same of the axial node positions U = s + c, + (a' D a + b' D b)/2,
//            D = xi E(1) - E(xi)
//   CHAIN    the same of the stretch s, + c_i - (a' E a + b' E b)/2,
//            c_i+1 = c_i - (a' E(1) a + b' E(1) b)/2
// LOCAL and CHAIN are one model in two sets of coordinates; in LOCAL ones an element depends on its
// own nodes only.
#ifndef CT_FORMULATE_BEAM_FLEXIBLE_BODY_H
#define CT_FORMULATE_BEAM_FLEXIBLE_BODY_H

#include "formulate/build.h"
#include "formulate/beam/shape_function.h"

/// A linear beam is accurate enough below this value of the validity indicator. Default: above it a
/// hint suggests other formulations; users may ignore it. Test: beam_choice.
#define CT_VALIDITY_LIMIT 0.01
/// Largest slope of a section relative to the frame of its beam for which displacements of second
/// order are sufficient (section 5.3). Derived: the neglected term slope^4 / 8 is a thousandth.
#define CT_SLOPE_LIMIT 0.3

// Definition: dofs below CT_AXIS_DOF move the axis, those of bending are 2 ... CT_BENT_DOF - 1;
// stretch and twist have CT_LINE_DOF each.
enum { CT_DOF = 14, CT_BENT_DOF = 10, CT_MIDDLE_DOF = 10, CT_AXIS_DOF = 11, CT_LINE_DOF = 3 };
/// Kinds of freedoms of a node. CT_FREEDOM_RM, UM: twist and stretch in the middle of the element
/// before the node, minus the mean of its ends.
enum ct_freedom_kind {
    CT_FREEDOM_U,
    CT_FREEDOM_V,
    CT_FREEDOM_W,
    CT_FREEDOM_RX,
    CT_FREEDOM_RY,
    CT_FREEDOM_RZ,
    CT_FREEDOM_RM,
    CT_FREEDOM_UM,
    CT_NODE_FREEDOM
};
enum ct_axial { CT_AXIAL_LINEAR, CT_AXIAL_LOCAL, CT_AXIAL_CHAIN };

struct ct_part {
    int k; // elastic coordinate
    ct_ex coef;
};

struct ct_elastic {
    const char *name;
    int q, u;
    // its nodal freedom, or that of its static shape; -1: coordinate of a mode or a given shape
    int freedom;
    ct_ex value, rate, acceleration;
    ct_ex start, start_rate; // start value and rate from `initial`, functions of parameters
};

struct ct_freedom {
    ct_ex value, rate, acceleration;
    int npart;
    struct ct_part *part;
};

struct ct_element {
    struct ct_span span;
    // CHAIN, higher-order: I/A by plane, for foreshortening by rotation gradients  [m^2]
    ct_ex radius[2];
    int freedom[CT_DOF];                                     // -1: fixed
    ct_ex value[CT_DOF], rate[CT_DOF], acceleration[CT_DOF]; // of each dof
    // CHAIN: foreshortening at its start, its rate, second derivative with u' = 0
    ct_ex c, c_rate, c_bias;
    ct_ex g[CT_AXIS_DOF]; // CHAIN: d(c of the next element - c)/d(dof)
};

/// A section of the beam: displacement u of the axis, rotation by angle as of section_rotation.h
/// (1.7b).
struct ct_station {
    int element;
    enum ct_axial axial;
    ct_ex xi;
    ct_ex3 position; // x + u
    ct_ex angle[3];
};

struct ct_flexible {
    const struct ct_beam *beam;
    const char *name;
    int body, base;
    unsigned deformation;
    unsigned excited;    // deformations that the model can excite, if more are kept
    enum ct_axial axial; // of forces
    // kinematics: of positions and the mass matrix; equal to axial, or LINEAR if only forces
    // include foreshortening
    enum ct_axial kinematics;
    enum ct_beam_formulation formulation;
    const char *why; // reason for this formulation; NULL: the user gave it
    struct ct_elastic *elastic;
    int nelastic;
    int nstart; // number of element starts, the last elastic coordinates (beam_augmented.h)
    struct ct_freedom *freedom; // CT_NODE_FREEDOM (nelement + 1)
    struct ct_element *element;
    struct ct_bending shape;
    struct ct_shape line[CT_LINE_DOF];              // stretch and twist
    struct ct_shape shortening[4][4], bubble[4][4]; // E(xi), D(xi)
    struct ct_shape curving[4][4]; // integral of the rotation gradients of the sections, like E
    struct ct_condensation *condensation; // NULL: no condensed rotations
    // former_condensation: the condensation before its rotations became coordinates
    // (beam_augmented.h)
    const struct ct_condensation *former_condensation;
    // fraction of the initial deflection that modes or given shapes cannot represent
    double start_residual;
    int most_modes; // for `modes`: number of available modes
    double cut;     // repeated frequency of which only some modes are kept [rad/s]; else 0
    // uncut: in that case the nearest numbers of modes, below and above, that keep none or all of
    // these
    int uncut[2];
    ct_ex strain;               // [J], once the stiffness is derived
    struct ct_inertia *inertia; // beam_dynamics.c
};

/// Axial displacement of the axis at one point of an element.
struct ct_axial_field {
    ct_ex value, rate, bias;  // bias: second derivative with u' = 0
    ct_ex slope[CT_AXIS_DOF]; // derivative by the dofs of the element
};

// ---- flexible_body.c: coordinates and positions
// ----------------------------------------------------

/// One per beam of the model, in b->flexible; the base is set when nodes are created.
void ct_flexible_create(struct ct_build *b);
/// Chooses the deformations from the beam and the plane; creates elements and their freedoms.
void ct_flexible_choose_deformation(struct ct_build *b);
/// The beam of a body; NULL if the body is not a beam.
struct ct_flexible *ct_flexible_of(const struct ct_build *b, int body);
/// The beam whose section is at the head of the edge; NULL: none.
struct ct_flexible *ct_flexible_of_edge(const struct ct_build *b, const struct ct_edge_info *e);
/// Are all coordinates of beam f small, by its formulation or its name?
bool ct_flexible_is_small(const struct ct_build *b, const struct ct_flexible *f);
/// Do the kinematics of all beams and the small coordinates allow the articulated-body method
/// (recursive/member.h)?
bool ct_flexible_may_be_articulated(const struct ct_build *b);
/// Unknowns of the elastic coordinates (elastic_coordinates.c), after those of joints and bodies.
void ct_flexible_unknowns(struct ct_build *b, struct ct_flexible *f);
void ct_axial_field(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex xi,
                    enum ct_axial axial, struct ct_axial_field *a);
/// The section at x. axial: the kinematics to use; f->kinematics for positions.
void ct_flexible_station(struct ct_build *b, const struct ct_flexible *f, ct_ex x,
                         enum ct_axial axial, struct ct_station *s);
/// Derivatives of translation (m = 0 ... nelastic-1, beam axes) and rotation of a station by
/// elastic coordinate.
void ct_station_partials(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn);
/// The same without the effect of previous elements in a CHAIN. Condensed rotations come after the
/// coordinates, at nelastic + number.
void ct_station_own_partials(struct ct_build *b, const struct ct_flexible *f,
                             const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn);
/// Is each coordinate that of one node? Condensed rotations are sums of them.
bool ct_flexible_is_nodal(const struct ct_flexible *f);
/// Is it a CHAIN in nodal coordinates? An element then depends only on its own nodes and the
/// foreshortening at its start.
bool ct_flexible_is_augmented(const struct ct_flexible *f);
/// The elastic coordinate for the foreshortening at the start of an element, 1 ... nstart.
static inline int ct_flexible_start(const struct ct_flexible *f, int element)
{
    return f->nelastic - f->nstart + element - 1;
}
/// Dof of the axial shape i of f->line.
static inline int ct_stretch_dof(int i)
{
    return i < 2 ? i : CT_MIDDLE_DOF;
}
/// sum over the dofs in [from, to) of the shape times the value (rate, ...) of each.
ct_ex ct_element_field(struct ct_build *b, const struct ct_element *e,
                       const struct ct_shape *shape, const ct_ex *of, int from, int n,
                       ct_ex xi);

#endif
