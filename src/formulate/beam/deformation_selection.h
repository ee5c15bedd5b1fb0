// Deformation selection: excludes deformations of beams that the model cannot excite.  (formulation
// 5.6)
#ifndef CT_FORMULATE_BEAM_DEFORMATION_SELECTION_H
#define CT_FORMULATE_BEAM_DEFORMATION_SELECTION_H

#include "formulate/beam/flexible_body.h"

/// Do the beams of a mechanism with planar joints deform only in the plane b->topology->plane? Each
/// must be able to bend about the normal, and gravity, loads, inertia and arms must lie in the
/// plane, or the model must restrict the beam to it. *is_spatial is set if the model gives a beam
/// out-of-plane deformation, or if b->options->keeps_all_deformations and one is possible. U: axes
/// of the nodes at rest (linear_graph.c).
bool ct_deformation_keeps_plane(struct ct_build *b, ct_ex33 *const *U, bool *is_spatial);

/// Reason why the beam does not twist, for `left_out`; NULL if it does. It twists by a joint, a
/// torque or an arm off its axis beyond the base, or by bending about both axes if it is
/// foreshortened and Iy and Iz differ. f->formulation must be known.
const char *ct_deformation_no_twist(const struct ct_build *b, const struct ct_flexible *f);

#endif
