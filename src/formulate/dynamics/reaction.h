// Reactions of joints by cutset equations, on request.  (formulation 5.5)
#ifndef CT_FORMULATE_DYNAMICS_REACTION_H
#define CT_FORMULATE_DYNAMICS_REACTION_H

#include "formulate/dynamics/dynamics.h"

/// Total force and torque that frame `from` of a joint exerts on frame `to` at the origin of `to`,
/// in ground components and in terms of u' and lam.
void ct_reaction_derive(struct ct_build *b, int joint, ct_ex3 *force, ct_ex3 *torque);

/// Is component i, in axes of `from`, of the force (torque) of a joint determined? In a planar
/// mechanism chords have no out-of-plane rows. Their out-of-plane reactions, and those of all
/// joints in a loop with them, are undetermined. For a joint in no such loop the equilibrium of its
/// outboard side determines them for any trees.
bool ct_reaction_is_known(const struct ct_build *b, int joint, bool is_force, int i);

/// The same for any edge, about the origin of its head. If it is a branch of both trees: the total
/// wrench on its head. Otherwise: the part without constraint rows of its own.
void ct_reaction_of_edge(struct ct_build *b, int edge, ct_ex3 *force, ct_ex3 *torque);
/// The same test for any edge. Component i is in axes that differ from those of its tail by a
/// rotation about the normal.
bool ct_reaction_of_edge_is_known(const struct ct_build *b, int edge, bool is_force, int i);

#endif
