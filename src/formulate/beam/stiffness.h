// Stiffness and damping of beams.
#ifndef CT_FORMULATE_BEAM_STIFFNESS_H
#define CT_FORMULATE_BEAM_STIFFNESS_H

#include "formulate/beam/degrees_of_freedom.h"
#include "formulate/beam/section_properties.h"

/// Stiffness and mass of an element at rest by its dofs; those between stretch and bending are
/// zero.
void ct_element_matrices(struct ct_build *b, const struct ct_flexible *f, int e,
                         ct_ex K[CT_DOF][CT_DOF], ct_ex M[CT_DOF][CT_DOF]);
/// Stiffness of one element: forces on its dofs, strain energy, twice the dissipated power.
struct ct_element_force {
    ct_ex row[CT_DOF];
    ct_ex energy, drag;
};
/// Does stiffness_legendre.c apply? For foreshortened cubic elements of constant sections.
bool ct_stiffness_has_legendre(struct ct_build *b, const struct ct_flexible *f);
struct ct_element_force ct_element_force_legendre(struct ct_build *b,
                                                  const struct ct_flexible *f, int e);
/// Adds the forces of stiffness and damping of the beam to those on the freedoms.
void ct_stiffness_rows(struct ct_build *b, const struct ct_flexible *f, ct_ex *by_freedom);

/// Strain energy [J].
ct_ex ct_flexible_strain(struct ct_build *b, const struct ct_flexible *f);
/// Power of the beams' own damping, negative.
ct_ex ct_flexible_dissipation(struct ct_build *b);

#endif
