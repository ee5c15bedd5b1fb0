// What a scene can excite in its beams: what it cannot is left out.  (formulation 5.6)
#ifndef CT_FORMULATE_EXCITE_H
#define CT_FORMULATE_EXCITE_H

#include "formulate/flexible.h"

/// May the beams of a mechanism whose joints keep to the plane b->plane keep to it, too? Each must bend about the normal,
/// and nothing may push it out of the plane: gravity, loads, inertia and arms lie in it; or the beam is told to deform
/// there alone. One that is told to leave the plane does, and with b->frees_beams one that can. U: axes of the nodes at rest (topology.c). layer: place of each node along the normal.
bool ct_excite_keeps_plane(struct ct_build *b, ct_ex33 *const *U);

/// Why the beam does not twist, for `left_out`; NULL if it does: by a joint, a torque or an arm off its axis beyond the base,
/// or, in a foreshortened beam of unequal Iy and Iz, by bending about both axes. f->formulation must be known.
const char *ct_excite_no_twist(const struct ct_build *b, const struct ct_flexible *f);

#endif
