// Fields that the model gives along a beam, u v w rx as expressions of x: shapes that take the
// place of nodal freedoms, and deflections and rates at the start.
#ifndef CT_FORMULATE_BEAM_BEAM_FIELD_H
#define CT_FORMULATE_BEAM_BEAM_FIELD_H

#include "formulate/beam/flexible_body.h"

/// What the field g means for a freedom of a node: its value there, or its slope; of a freedom in
/// the middle of the element before the node, how far g there is from the mean of the ends. Zero
/// where it means nothing.
ct_ex ct_field_freedom(struct ct_build *b, const struct ct_flexible *f, enum ct_beam_field kind,
                       ct_ex g, int node, int freedom);
/// Deformations (bits) that the beam's shapes belong to.
unsigned ct_fields_family(const struct ct_beam *beam);
/// Fields of `initial` across the plane (normal: that of bending-z if about_z, else of bending-y),
/// or rotations.
bool ct_fields_leave_plane(const struct ct_beam *beam, bool about_z);
/// Start values of the elastic coordinates.  Errors: CT_E_INITIAL where the beam does not deform
/// that way.
void ct_fields_start(struct ct_build *b, struct ct_flexible *f);

#endif
