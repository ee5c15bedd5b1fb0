// Deformation selection: what a scene cannot excite in its beams is left out.  (formulation 5.6)
#ifndef CT_FORMULATE_BEAM_DEFORMATION_SELECTION_H
#define CT_FORMULATE_BEAM_DEFORMATION_SELECTION_H

#include "formulate/beam/flexible_body.h"

/// May the beams of a mechanism whose joints keep to the plane b->topology->plane keep to it, too? Each must bend about the normal,
/// and nothing may push it out of the plane: gravity, loads, inertia and arms lie in it; or the beam is told to deform
/// there alone. One that is told to leave the plane does, and with b->options->keeps_all_deformations one that can: then
/// *is_spatial is set. U: axes of the nodes at rest (linear_graph.c).
bool ct_deformation_keeps_plane(struct ct_build *b, ct_ex33 *const *U, bool *is_spatial);

/// Why the beam does not twist, for `left_out`; NULL if it does: by a joint, a torque or an arm off its axis beyond the base,
/// or, in a foreshortened beam of unequal Iy and Iz, by bending about both axes. f->formulation must be known.
const char *ct_deformation_no_twist(const struct ct_build *b, const struct ct_flexible *f);

#endif
