// Properties of the sections of a beam, and how they are integrated over an element.
#ifndef CT_FORMULATE_BEAM_SECTION_PROPERTIES_H
#define CT_FORMULATE_BEAM_SECTION_PROPERTIES_H

#include "formulate/beam/flexible_body.h"

/// Rules of integration of the beam's mass and stiffness.
enum ct_rule ct_flexible_mass_rule(const struct ct_beam *beam);
enum ct_rule ct_flexible_stiffness_rule(const struct ct_beam *beam);
/// Does the rotary inertia rotate with the sections? Yes if foreshortening is included; otherwise
/// it is of first order, along the axes of the beam.
bool ct_flexible_turns_inertia(const struct ct_build *b, const struct ct_flexible *f);
/// Inertia per length of the section about an axis.
struct ct_profile ct_flexible_rotary(const struct ct_flexible *f, int axis);
/// Shear stiffness k G area of Timoshenko's sections, plane 0 along y, 1 along z; 0 without shear.
ct_ex ct_flexible_shear(struct ct_build *b, const struct ct_flexible *f, int plane);
/// Integral of g p q over element e.
ct_ex ct_flexible_integral(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex g,
                           const struct ct_shape *p, const struct ct_shape *q,
                           enum ct_rule rule);
/// second - other, second moments of area, where it is positive, else 0: of the axis about which
/// a section is stiffer.  (5.6b)
ct_ex ct_stiffer(struct ct_exs *x, ct_ex second, ct_ex other);
/// Shear locking of fully integrated Timoshenko elements, additional bending stiffness relative to
/// EI: the largest k GA h^2/(12 EI).
double ct_flexible_locking(struct ct_build *b, const struct ct_flexible *f);

#endif
