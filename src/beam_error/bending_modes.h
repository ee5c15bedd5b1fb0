// The first bending shapes of a beam in one of its planes, including masses that are welded to it.
#ifndef CT_BEAM_ERROR_BENDING_MODES_H
#define CT_BEAM_ERROR_BENDING_MODES_H

#include "formulate/beam/flexible_body.h"

/// Find the shapes in the plane along y (0) or z (1), the lowest frequency first, for the present
/// values of parameters; `state`: amplitudes as expressions of the state. Returns their number, at
/// most CT_PLANE_SHAPES; shapes above 50 times the first frequency are omitted. 0 if the beam does
/// not bend or its first shape is not found.
int ct_bending_modes_find(struct ct_build *b, const struct ct_flexible *f, int plane,
                          struct ct_bending_shape *out);
/// Compute the coupling of the n shapes of both planes of a beam: `with`.
void ct_bending_modes_couple(struct ct_bending_shape *shape, int n);

#endif
