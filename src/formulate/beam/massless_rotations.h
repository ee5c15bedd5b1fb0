// Rotations of nodes without inertia and without applied moment.
#ifndef CT_FORMULATE_BEAM_MASSLESS_ROTATIONS_H
#define CT_FORMULATE_BEAM_MASSLESS_ROTATIONS_H

#include "formulate/beam/degrees_of_freedom.h"

/// Rotations of nodes without inertia and moment (massless_rotations.c). is_condensed (6 per node,
/// out): by freedom, fixed ones included. False if there are none.
bool ct_flexible_find_massless_rotations(struct ct_build *b, const struct ct_flexible *f,
                                         bool *is_condensed);
/// The joint that rotates only the first section of the beam, which has no inertia, while the other
/// nodes stay fixed. This is exact for a straight axis and approximate for a bent one with
/// foreshortening. -1: none.
int ct_flexible_bare_joint(struct ct_build *b, const struct ct_flexible *f);

#endif
