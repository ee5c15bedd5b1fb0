// The first bending shapes of a beam in one of its planes, with masses that are welded to it.
#ifndef CT_BEAM_ERROR_BENDING_MODES_H
#define CT_BEAM_ERROR_BENDING_MODES_H

#include "formulate/beam/flexible_body.h"

/// In the plane along y (0) or z (1), the lowest first, with the values that parameters have now;
/// `state` in terms of the state. Returns how many were found, at most CT_PLANE_SHAPES, those above
/// 50 times the first frequency left away: 0 where the beam does not bend, or its first shape
/// cannot be found.
int ct_bending_modes_find(struct ct_build *b, const struct ct_flexible *f, int plane,
                          struct ct_bending_shape *out);
/// What the n shapes of both planes of a beam do to each other: `with`.
void ct_bending_modes_couple(struct ct_bending_shape *shape, int n);

#endif
