// Kinematics by circuit equations. This folder derives rotations along the tree T_R, positions,
// velocities and accelerations along the tree T_T, the values of coordinates, and the constraint
// rows of chords.  (formulation 4.1)
//
// Each expression is generated at the first request and then stored.
#ifndef CT_FORMULATE_KINEMATICS_KINEMATICS_H
#define CT_FORMULATE_KINEMATICS_KINEMATICS_H

#include "formulate/build.h"
#include "formulate/kinematics/switch.h"

/// Accelerations with all u' = 0, or with the symbols of u'.
enum ct_level { CT_BIAS, CT_FULL };

/// Three steps: unknowns and drivers of the chosen trees; clusters and rotation axes; anchors and
/// node positions.
void ct_unknowns_choose(struct ct_build *b, struct ct_kinematics *kinematics);
void ct_rotation_derive(struct ct_build *b, struct ct_kinematics *kinematics);
void ct_translation_derive(struct ct_build *b, struct ct_kinematics *kinematics);
/// Derives the translation and rotation axes of beam sections again, for other elastic coordinates
/// of the same sections.
void ct_translation_slide_sections(struct ct_build *b, struct ct_kinematics *kinematics);
void ct_rotation_turn_sections(struct ct_build *b, struct ct_kinematics *kinematics);

/// d/dt of an expression of coordinates and time; speeds in it are taken as constant.
ct_ex ct_build_rate(struct ct_build *b, ct_ex e);
/// The same for a vector.
ct_ex3 ct_build_rate3(struct ct_build *b, ct_ex3 e);

/// d(trial expression)/d(coordinate k) of an edge, at the edge's coordinates.
ct_ex ct_edge_partial(struct ct_build *b, const struct ct_edge_info *e, ct_ex trial, int k);

// ---- clusters --------------------------------------------------------------------------------

ct_ex3 ct_cluster_velocity(const struct ct_build *b, int c);              // w [rad/s]
ct_ex3 ct_cluster_acceleration(struct ct_build *b, int c, enum ct_level); // al [rad/s^2]
/// w and al in axes of the cluster. False if its parent is not ground or an axis is not fixed in
/// it.
bool ct_cluster_own_rates(struct ct_build *b, int c, enum ct_level, ct_ex3 *w, ct_ex3 *al);
/// w and al of cluster `to` relative to `from`, summed along the path in the rotational tree.
ct_ex3 ct_cluster_path_velocity(struct ct_build *b, int from, int to);
ct_ex3 ct_cluster_path_acceleration(struct ct_build *b, int from, int to, enum ct_level level);
/// Axes of c -> axes of its parent.
ct_ex33 ct_cluster_relative(struct ct_build *b, int c);
/// R_c v for a local vector.
ct_ex3 ct_cluster_turn(struct ct_build *b, int c, ct_ex3 local);
/// w x v and w x (w x v) for a vector v fixed in the cluster (the planar form is -w^2 v).
ct_ex3 ct_cluster_cross_velocity(struct ct_build *b, int c, ct_ex3 v);
ct_ex3 ct_cluster_centripetal(struct ct_build *b, int c, ct_ex3 v);

/// Planar: is rotation axis r the normal (true) or its opposite?
bool ct_rotation_axis_is_positive(const struct ct_build *b, size_t r);

// ---- links: the vector from an anchor's parent to the anchor ------------------------------------

ct_ex3 ct_link_vector(struct ct_build *b, int a);
ct_ex3 ct_link_velocity(struct ct_build *b, int a);
ct_ex3 ct_link_acceleration(struct ct_build *b, int a, enum ct_level level);
/// Its part due to translation: Coriolis and relative acceleration.
ct_ex3 ct_link_sliding_acceleration(struct ct_build *b, int a, enum ct_level level);

// ---- nodes -------------------------------------------------------------------------------------

ct_ex33 ct_node_rotation(struct ct_build *b, int node);
ct_ex3 ct_node_turn(struct ct_build *b, int node, ct_ex3 v);   // axes of the node -> ground
ct_ex3 ct_node_unturn(struct ct_build *b, int node, ct_ex3 v); // ground -> axes of the node
ct_ex3 ct_node_position(struct ct_build *b, int node);
ct_ex3 ct_node_velocity(struct ct_build *b, int node);
ct_ex3 ct_node_acceleration(struct ct_build *b, int node, enum ct_level level);
ct_ex3 ct_anchor_acceleration(struct ct_build *b, int a, enum ct_level level);

/// Position, velocity and acceleration of node `head` relative to node `tail`, summed along the
/// tree path between them. Their common part does not appear.
ct_ex3 ct_path_position(struct ct_build *b, int tail, int head);
ct_ex3 ct_path_velocity(struct ct_build *b, int tail, int head);
ct_ex3 ct_path_acceleration(struct ct_build *b, int tail, int head, enum ct_level level);
/// Relative position and velocity of node `head` in axes of node `tail`. Vectors fixed in the tail
/// are summed in those axes, so that the round-off of the absolute position of the tail does not
/// enter.
ct_ex3 ct_path_position_in_tail(struct ct_build *b, int tail, int head);
ct_ex3 ct_path_velocity_in_tail(struct ct_build *b, int tail, int head);

/// marked (ncluster, out): clusters whose rotation can change the path from tail to head or the
/// axes at its ends.
void ct_path_mark(struct ct_build *b, int tail, int head, bool *marked);

/// Partial velocity of node `head` relative to node `tail` for a unit rate of rotation axis r:
/// dv_head - dv_tail, and - dw_tail x d if carried (velocity relative to the axes of the tail). It
/// is axis_r x the sum of the path vectors that rotate with r (relative to the tail, if carried).
/// False if it is structurally zero.
bool ct_path_partial_velocity(struct ct_build *b, int tail, int head, size_t r, bool carried,
                              ct_ex3 *velocity);
/// Branch vectors between the nodes that rotate relative to the other end (relative to the tail, if
/// carried), each in its own axes. Coefficients of a row are sums over them and may cancel; the sum
/// of their lengths gives the scale of the round-off.
const ct_ex3 *ct_path_levers(struct ct_build *b, int tail, int head, bool carried, size_t *n);
/// +1, -1 or 0: the translation axes of an anchor move only the head, only the tail, or both or
/// neither.
int ct_path_translation_side(struct ct_build *b, int tail, int head, int anchor);

#endif
