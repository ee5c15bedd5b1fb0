// Reactions of joints recovered from cutsets, on request.  (formulation 5.5)
#ifndef CT_FORMULATE_REACTION_H
#define CT_FORMULATE_REACTION_H

#include "formulate/dynamics.h"

/// Force and torque that the joint's `from` exerts on its `to` at the origin of `to`, everything the joint
/// transmits, in ground components and in terms of u' and lam.
void ct_reaction_derive(struct ct_build *b, int joint, ct_ex3 *force, ct_ex3 *torque);

/// Is component i, in axes of `from`, of a joint's force (torque) known? In a planar mechanism chords have no
/// rows out of the plane: what they transmit there is open, and so is what shares a circuit with them.
bool ct_reaction_is_known(const struct ct_build *b, int joint, bool is_force, int i);

/// The same of any edge that is a branch of both trees: what it exerts on its head, about the head's origin.
void ct_reaction_of_edge(struct ct_build *b, int edge, ct_ex3 *force, ct_ex3 *torque);
/// The same question for such an edge; component i in axes that differ from its tail's by a turn in the plane.
bool ct_reaction_of_edge_is_known(const struct ct_build *b, int edge, bool is_force, int i);

#endif
