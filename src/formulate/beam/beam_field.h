// Fields u v w rx along a beam as expressions of x in the model: shapes that replace the nodal
// freedoms, and initial deflections and rates.
#ifndef CT_FORMULATE_BEAM_BEAM_FIELD_H
#define CT_FORMULATE_BEAM_BEAM_FIELD_H

#include "formulate/beam/flexible_body.h"

/// Value of a nodal freedom for the field g: g or its slope at the node; for a mid-element freedom,
/// g there minus the mean of the ends. Zero if the field does not affect the freedom.
ct_ex ct_field_freedom(struct ct_build *b, const struct ct_flexible *f, enum ct_beam_field kind,
                       ct_ex g, int node, int freedom);
/// Deformations (bits) that the beam's shapes belong to.
unsigned ct_fields_family(const struct ct_beam *beam);
/// Does `initial` contain twist or deflections out of the plane? The plane is that of bending-z if
/// about_z, else of bending-y.
bool ct_fields_leave_plane(const struct ct_beam *beam, bool about_z);
/// Sets the start values of the elastic coordinates. Errors: CT_E_INITIAL if the beam lacks that
/// deformation.
void ct_fields_start(struct ct_build *b, struct ct_flexible *f);

#endif
