// A beam as read: straight along its own x axis, from 0 to `length`.  (formulation 1.2, 5.3)
//
//     node 0 ---- element 1 ---- node 1 ---- ... ---- element N ---- node N
//     body frame                 u v w rx ry rz of each: displacements and right-handed rotations
//                                along the beam's axes (ry = -dw/dx, rz = dv/dx)
//
// What always holds after ct_model_read: length > 0; end[] increases strictly and ends at `length`;
// values have the right dimension and sign. Only values of section and material contain the symbol
// x; they are smooth within each element. A missing key leaves 0 and no bit in `known`.
#ifndef CT_COMPONENT_BEAM_H
#define CT_COMPONENT_BEAM_H

#include "expr/ex.h"

/// Gauss points of an element whose section varies. Derived: exact up to degree 15, enough for a
/// quartic inertia times squares of cubic shape functions (degree 10); other sections get some
/// digits more.
enum { CT_ELEMENT_POINTS = 8 };

enum ct_beam_theory { CT_BEAM_EULER_BERNOULLI, CT_BEAM_TIMOSHENKO };
/// Integration points of an element. REDUCED: stiffness at the middle; ONE_POINT: mass too.
enum ct_beam_integration { CT_BEAM_FULL, CT_BEAM_REDUCED, CT_BEAM_ONE_POINT };
enum ct_beam_formulation {
    CT_BEAM_AUTO,
    CT_BEAM_LINEAR,
    CT_BEAM_FORESHORTENING,
    CT_BEAM_FORCE_ONLY,
    CT_BEAM_STRETCH_LINEAR
};
/// Deformations that a beam may have; bits of ct_beam.deformation. BENDING_Y is bending in the x-z
/// plane (Iy, w and ry).
enum ct_beam_deformation {
    CT_BEAM_AXIAL = 1,
    CT_BEAM_BENDING_Y = 2,
    CT_BEAM_BENDING_Z = 4,
    CT_BEAM_TORSION = 8,
    CT_BEAM_ALL = 15
};

/// A field along the axis: displacements u, v, w and twist. The first freedoms of a node are in the
/// same order.
enum ct_beam_field {
    CT_BEAM_FIELD_U,
    CT_BEAM_FIELD_V,
    CT_BEAM_FIELD_W,
    CT_BEAM_FIELD_RX,
    CT_BEAM_NFIELD
};

struct ct_beam_given {
    enum ct_beam_field kind;
    bool is_rate; // of `initial`
    ct_ex value;  // contains x
    struct ct_mark mark;
};

struct ct_beam {
    ct_ex x;      // the symbol x (LOCAL) in expressions of the section
    ct_ex length; // [m]
    int nelement;
    const ct_ex *end; // [m] ends of elements; end[nelement - 1] is `length`
    bool is_even;     // all elements have equal length
    // [m] ascending: positions of jumps and kinks of section or material; elements end there
    const double *cut;
    int ncut;
    bool is_cut;           // cuts were added to the ends of elements in the file
    ct_ex E, G;            // [Pa]; may contain x; G is 0 where neither G nor nu is given
    ct_ex area, Iy, Iz, J; // [m^2], [m^4]; may contain x
    ct_ex mass_per_length; // [kg/m]; may contain x
    bool has_rotary;       // `rotary_inertia` is neither absent nor false
    bool misses_rotary;    // `rotary_inertia: true` was given, but lumped mass has none
    ct_ex rotary[3];       // inertia per length about x, y, z [kg m]; may contain x
    // rho (Iy + Iz), for twist where torsion is present and has_rotary is false
    ct_ex twist_inertia;
    enum ct_beam_theory theory;
    ct_ex shear_factor[2]; // Timoshenko shear factors along y and along z; may contain x
    enum ct_beam_integration integration;
    bool is_lumped;
    bool higher_order; // geometric_stiffness: higher-order
    enum ct_beam_formulation formulation;
    bool is_chord;              // frame: chord
    bool lacks_quadratic;       // quadratic_velocity: false
    bool has_quadratic_twist;   // twist: quadratic
    bool has_quadratic_stretch; // stretch: quadratic
    // bits: deformations with stiffness given and not 0 (AXIAL: area, BENDING_Y: Iy, TORSION: G, J)
    unsigned known;
    bool deformation_given;
    unsigned deformation;                  // bits; CT_BEAM_ALL unless given
    int modes;                             // 0: nodal coordinates
    ct_ex damping_mass, damping_stiffness; // Rayleigh: alpha [1/s], beta [s]
    const struct ct_beam_given *shape;     // `shapes`, in place of nodal coordinates
    int nshape;
    bool starts_in_equilibrium;        // `initial: equilibrium`
    const struct ct_beam_given *start; // `initial: {v: ...}`
    int nstart;
    struct ct_mark formulation_mark, modes_mark;
};

/// Divide into n equal elements; with cuts, into equal elements between cuts, none longer than
/// length/n.
void ct_beam_divide(struct ct_exs *x, struct ct_arena *a, struct ct_beam *beam, long n,
                    double length);

#endif
