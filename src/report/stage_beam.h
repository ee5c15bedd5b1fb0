// Beams on the pages of the derivation.
//
// An element is printed once, as a function of its own dofs; a table lists the coordinates of
// each element for them.
#ifndef CT_REPORT_STAGE_BEAM_H
#define CT_REPORT_STAGE_BEAM_H

#include "formulate/beam/flexible_body.h"
#include "report/derivation.h"

/// The element of a beam, with symbols instead of its dofs; constants of the sections where
/// these do not vary.
struct ct_beam_element {
    struct ct_exs *x;
    ct_ex dof[CT_DOF]; // zero where the beam does not deform that way
    ct_ex xi, h;       // position on the element, 0 ... 1; its length
    ct_ex axial;       // displacement along the axis without foreshortening
    ct_ex shortening;  // int (v'^2 + w'^2)/2 dx over the element
    ct_ex v, w, twist;
    ct_ex stretch; // the symbol s
    // strain energy [J]: axial with s for the stretch, bending-z, bending-y, torsion
    ct_ex energy[4];
    // the sections do not vary: energy and shortening are known in closed form
    bool is_constant;
};

/// Name of dof j: u1 u2 v1 alpha1 v2 alpha2 w1 beta1 w2 beta2 phi1 phi2.
const char *ct_beam_dof_name(int j);
void ct_beam_element_derive(struct ct_build *b, const struct ct_flexible *f,
                            struct ct_beam_element *out);

/// As in model files.
const char *ct_beam_formulation_name(enum ct_beam_formulation f);
/// "2 elements, 12 elastic coordinates; deforms by axial, bending-z; foreshortening (auto);
/// frame clamped"
const char *ct_beam_sentence(struct ct_arena *a, const struct ct_flexible *f);

/// Terminal equations: inertia, elastic coordinates, the element and its coordinates.
void ct_beams_put_terminal(struct ct_derivation *d);
/// The matrices of the beam and the shape integrals of its element in the notation of
/// liang2017. (stage_beam_matrices.c)
void ct_beam_matrices_put(struct ct_derivation *d, size_t beam);
/// Angular velocity of its frame, if the matrices use a name for it.
void ct_beam_matrices_put_angular_velocity(struct ct_derivation *d, size_t beam);
void ct_beam_matrices_put_element(struct ct_derivation *d, const struct ct_flexible *f);
/// Arms to sections.
void ct_beams_put_arms(struct ct_derivation *d);
/// One equation per elastic coordinate: the generalised force of the beam acts on its arms.
void ct_beams_put_cutsets(struct ct_derivation *d);

#endif
