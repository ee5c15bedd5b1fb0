// Rotations of nodes that move no mass, and on which no moment acts.
#ifndef CT_FORMULATE_BEAM_MASSLESS_ROTATIONS_H
#define CT_FORMULATE_BEAM_MASSLESS_ROTATIONS_H

#include "formulate/beam/degrees_of_freedom.h"

/// Rotations of nodes without inertia and moment (massless_rotations.c). follows (6 per node,
/// out): by freedom, fixed ones included. False if there are none.
bool ct_flexible_find_massless_rotations(struct ct_build *b, const struct ct_flexible *f,
                                         bool *follows);
/// The joint about whose axis nothing but the section at the beam's start turns, without inertia,
/// where the other nodes stay: exactly where the axis is straight, nearly where foreshortening
/// moves nodes of a bent one. -1: none.
int ct_flexible_bare_joint(struct ct_build *b, const struct ct_flexible *f);

#endif
