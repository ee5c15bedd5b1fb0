// Reactions of joints recovered from cutsets, on request.  (formulation 5.5)
#ifndef CT_FORMULATE_DYNAMICS_REACTION_H
#define CT_FORMULATE_DYNAMICS_REACTION_H

#include "formulate/dynamics/dynamics.h"

/// Force and torque that the joint's `from` exerts on its `to` at the origin of `to`, everything
/// the joint transmits, in ground components and in terms of u' and lam.
void ct_reaction_derive(struct ct_build *b, int joint, ct_ex3 *force, ct_ex3 *torque);

/// Is component i, in axes of `from`, of a joint's force (torque) known? In a planar mechanism
/// chords have no rows out of the plane: what they transmit there is open, and so is what shares a
/// circuit of links with them. What hangs on a joint that is in no such circuit determines it,
/// whatever the trees.
bool ct_reaction_is_known(const struct ct_build *b, int joint, bool is_force, int i);

/// The same of any edge, about its head's origin: all it exerts on its head if it is a branch of
/// both trees, else what has no row of its own.
void ct_reaction_of_edge(struct ct_build *b, int edge, ct_ex3 *force, ct_ex3 *torque);
/// The same question for such an edge; component i in axes that differ from its tail's by a turn in
/// the plane.
bool ct_reaction_of_edge_is_known(const struct ct_build *b, int edge, bool is_force, int i);

#endif
