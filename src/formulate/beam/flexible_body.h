// Flexible bodies in a floating frame of reference: elastic coordinates of beams, positions along
// them, their inertia and stiffness.  (formulation 1.2, 5.3)
//
//   elastic coordinate k   an unknown of the model: a nodal displacement or rotation, or the share of a mode
//   freedom f              8 per node (u v w rx ry rz, and rm um of the element before it): sum over k of part coef *
//                          coordinate; fixed ones are zero
//   dof j                  14 of an element, each a freedom with a sign (the slope dw/dx is -ry):
//                          0 1 axial | 2-5 along y: v, dv/dx, v, dv/dx | 6-9 along z the same | 10 axial in the middle
//                          | 11-13 twist
//
// Axes are those of the beam; `base` is the node of its body frame, at an anchor without offset.
//
// Axial displacement of the axis, c the foreshortening up to the element (formulation 1.7):
//   LINEAR   (1 - xi) u_i + xi u_i+1; to this and to the others 4 xi (1 - xi) um is added
//   LOCAL    the same of the axial places U = s + c of the nodes, + (a' D a + b' D b)/2,  D = xi E(1) - E(xi)
//   CHAIN    the same of the stretch s, + c_i - (a' E a + b' E b)/2,  c_i+1 = c_i - (a' E(1) a + b' E(1) b)/2
// LOCAL and CHAIN are one model in two sets of coordinates; in LOCAL ones an element sees its own
// nodes only.
#ifndef CT_FORMULATE_BEAM_FLEXIBLE_BODY_H
#define CT_FORMULATE_BEAM_FLEXIBLE_BODY_H

#include "formulate/build.h"
#include "formulate/beam/shape_function.h"

/// A linear beam is good enough below this indicator. Default: a hint at other formulations that users
/// may ignore. Test: beam_choice.
#define CT_VALIDITY_LIMIT 0.01
/// Slope of a section against the frame of its beam up to which displacements of second order in it
/// will do (section 5.3). Derived: what is left out, slope^4 / 8, is a thousandth.
#define CT_SLOPE_LIMIT 0.3

// Definition: dofs below CT_AXIS_DOF move the axis, those of bending are 2 ... CT_BENT_DOF - 1; stretch and
// twist have CT_LINE_DOF each.
enum { CT_DOF = 14, CT_BENT_DOF = 10, CT_MIDDLE_DOF = 10, CT_AXIS_DOF = 11, CT_LINE_DOF = 3 };
/// Kinds of freedoms of a node. CT_FREEDOM_RM, UM: twist and stretch in the middle of the element
/// before it beyond the mean of its ends.
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
    // that it is, or that its static shape is for; -1: share of a mode or a given shape
    int freedom;
    ct_ex value, rate, acceleration;
    ct_ex start, start_rate; // with `initial`, of parameters
};

struct ct_freedom {
    ct_ex value, rate, acceleration;
    int npart;
    struct ct_part *part;
};

struct ct_element {
    struct ct_span span;
    ct_ex radius
        [2]; // CHAIN, higher-order: I/A by plane, what rotation gradients draw the axis in by  [m^2]
    int freedom[CT_DOF];                                     // -1: fixed
    ct_ex value[CT_DOF], rate[CT_DOF], acceleration[CT_DOF]; // of the dofs
    ct_ex c, c_rate,
        c_bias; // CHAIN: foreshortening at its start, its rate, second derivative with u' = 0
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
    unsigned excited;    // what the scene can excite of it, if more is kept
    enum ct_axial axial; // of forces
    enum ct_axial
        kinematics; // of places and of the mass matrix: the same, but LINEAR where only forces foreshorten
    enum ct_beam_formulation formulation;
    const char *why; // this formulation; NULL: as asked for
    struct ct_elastic *elastic;
    int nelastic;
    int nstart; // of these, the last: foreshortening at the starts of elements (beam_augmented.h)
    struct ct_freedom *freedom; // CT_NODE_FREEDOM (nelement + 1)
    struct ct_element *element;
    struct ct_bending shape;
    struct ct_shape line[CT_LINE_DOF];              // stretch and twist
    struct ct_shape shortening[4][4], bubble[4][4]; // E(xi), D(xi)
    struct ct_shape curving[4][4];        // integral of the sections' rotation gradients, as E
    struct ct_condensation *condensation; // NULL: no rotation follows (beam_dynamics.h)
    const struct ct_condensation *
        former_condensation; // where those that follow are coordinates: as if they were not (beam_augmented.h)
    double start_missed; // share of the start that modes or given shapes leave out
    int most_modes;      // of `modes`: how many there are
    double cut; // frequency of modes of which some are kept and some not [rad/s]; else 0
    int uncut
        [2]; // then: the nearest numbers of modes, below and above, that keep all or none of these
    ct_ex strain;               // [J], once the stiffness is derived
    struct ct_inertia *inertia; // beam_dynamics.c
};

/// Axial displacement of the axis at one place of an element.
struct ct_axial_field {
    ct_ex value, rate, bias;  // bias: second derivative with u' = 0
    ct_ex slope[CT_AXIS_DOF]; // by the element's own dofs
};

// ---- flexible_body.c: coordinates and places ----------------------------------------------------

/// One per beam of the model, in b->flexible; their base is set where nodes are made.
void ct_flexible_create(struct ct_build *b);
/// What may deform, by the beam and the plane; elements and their freedoms.
void ct_flexible_choose_deformation(struct ct_build *b);
/// The beam of a body; NULL if it is none.
struct ct_flexible *ct_flexible_of(const struct ct_build *b, int body);
/// The beam whose section the edge leads to; NULL: none.
struct ct_flexible *ct_flexible_of_edge(const struct ct_build *b, const struct ct_edge_info *e);
/// Are all coordinates of beam f small, by its formulation or its name?
bool ct_flexible_is_small(const struct ct_build *b, const struct ct_flexible *f);
/// Can all beams be articulated bodies (recursive/member.h), as far as their kinematics and
/// coordinates that are small go?
bool ct_flexible_may_be_articulated(const struct ct_build *b);
/// Unknowns of the elastic coordinates (elastic_coordinates.c), after those of joints and bodies.
void ct_flexible_unknowns(struct ct_build *b, struct ct_flexible *f);
void ct_axial_field(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex xi,
                    enum ct_axial axial, struct ct_axial_field *a);
/// The section at x. axial: the kinematics in use; f->kinematics is that of places.
void ct_flexible_station(struct ct_build *b, const struct ct_flexible *f, ct_ex x,
                         enum ct_axial axial, struct ct_station *s);
/// Slides (m = 0 ... nelastic-1, beam axes) and turns of a station by elastic coordinate.
void ct_station_partials(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn);
/// The same without what the elements before its own do in a CHAIN; freedoms that follow behind the
/// coordinates, nelastic + number.
void ct_station_own_partials(struct ct_build *b, const struct ct_flexible *f,
                             const struct ct_station *s, ct_ex3 *slide, ct_ex3 *turn);
/// Each coordinate is that of one node; what follows is a sum of them.
bool ct_flexible_is_nodal(const struct ct_flexible *f);
/// CHAIN in coordinates of nodes: an element sees its own nodes and the foreshortening at its
/// start, nothing else.
bool ct_flexible_is_augmented(const struct ct_flexible *f);
/// The elastic coordinate that is the foreshortening at the start of an element, 1 ... nstart.
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
