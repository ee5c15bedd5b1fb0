// Kinematics by circuit equations: rotations along T_R, places along T_T.  (formulation 4.1)
//
// An expression is generated when it is first asked for, and kept. What nobody asks for is not generated.
#ifndef CT_FORMULATE_KINEMATICS_KINEMATICS_H
#define CT_FORMULATE_KINEMATICS_KINEMATICS_H

#include "formulate/build.h"
#include "formulate/kinematics/switch.h"

/// Accelerations with all u' = 0, or with the symbols of u'.
enum ct_level { CT_BIAS, CT_FULL };

/// Unknowns and drivers of the chosen trees; then clusters and spins, anchors and places.
void ct_unknowns_choose(struct ct_build *b, struct ct_kinematics *kinematics);
void ct_rotation_derive(struct ct_build *b, struct ct_kinematics *kinematics);
void ct_translation_derive(struct ct_build *b, struct ct_kinematics *kinematics);
/// Slides and turns of the sections of beams anew, for other elastic coordinates at the same places.
void ct_translation_slide_sections(struct ct_build *b, struct ct_kinematics *kinematics);
void ct_rotation_turn_sections(struct ct_build *b, struct ct_kinematics *kinematics);

/// d/dt of an expression of coordinates and time: coordinates change at their speeds; speeds are held.
ct_ex ct_build_rate(struct ct_build *b, ct_ex e);
/// The same for a vector.
ct_ex3 ct_build_rate3(struct ct_build *b, ct_ex3 e);

/// d(trial expression)/d(coordinate k) of an edge, at the edge's coordinates.
ct_ex ct_edge_partial(struct ct_build *b, const struct ct_edge_info *e, ct_ex trial, int k);

// ---- clusters --------------------------------------------------------------------------------

ct_ex3 ct_cluster_velocity(const struct ct_build *b, int c);              // w [rad/s]
ct_ex3 ct_cluster_acceleration(struct ct_build *b, int c, enum ct_level); // al [rad/s^2]
/// The same in the cluster's own axes. False where it does not turn against ground, or about axes that are not fixed in it.
bool ct_cluster_own_rates(struct ct_build *b, int c, enum ct_level, ct_ex3 *w, ct_ex3 *al);
/// w and al of cluster `to` less those of `from`, along the path of the rotational tree.
ct_ex3 ct_cluster_path_velocity(struct ct_build *b, int from, int to);
ct_ex3 ct_cluster_path_acceleration(struct ct_build *b, int from, int to, enum ct_level level);
/// Axes of c -> axes of its parent.
ct_ex33 ct_cluster_relative(struct ct_build *b, int c);
/// R_c v for a local vector.
ct_ex3 ct_cluster_turn(struct ct_build *b, int c, ct_ex3 local);
/// w x v and w x (w x v) for a vector v fixed in the cluster (the planar form is -w^2 v).
ct_ex3 ct_cluster_cross_velocity(struct ct_build *b, int c, ct_ex3 v);
ct_ex3 ct_cluster_centripetal(struct ct_build *b, int c, ct_ex3 v);

/// Planar: does spin r turn about the normal (true) or its opposite?
bool ct_rotation_axis_is_positive(const struct ct_build *b, size_t r);

// ---- links: the vector from an anchor's parent to the anchor --------------------------------------

ct_ex3 ct_link_vector(struct ct_build *b, int a);
ct_ex3 ct_link_velocity(struct ct_build *b, int a);
ct_ex3 ct_link_acceleration(struct ct_build *b, int a, enum ct_level level);
/// The part of it that comes from sliding: Coriolis and along the slide.
ct_ex3 ct_link_sliding_acceleration(struct ct_build *b, int a, enum ct_level level);

// ---- nodes -------------------------------------------------------------------------------------

ct_ex33 ct_node_rotation(struct ct_build *b, int node);
ct_ex3 ct_node_turn(struct ct_build *b, int node, ct_ex3 v);   // axes of the node -> ground
ct_ex3 ct_node_unturn(struct ct_build *b, int node, ct_ex3 v); // ground -> axes of the node
ct_ex3 ct_node_position(struct ct_build *b, int node);
ct_ex3 ct_node_velocity(struct ct_build *b, int node);
ct_ex3 ct_node_acceleration(struct ct_build *b, int node, enum ct_level level);
ct_ex3 ct_anchor_acceleration(struct ct_build *b, int a, enum ct_level level);

/// Place, velocity and acceleration of node `head` less that of node `tail`, along the tree path that
/// joins them: what both share cancels before it is written.
ct_ex3 ct_path_position(struct ct_build *b, int tail, int head);
ct_ex3 ct_path_velocity(struct ct_build *b, int tail, int head);
ct_ex3 ct_path_acceleration(struct ct_build *b, int tail, int head, enum ct_level level);
/// Place and velocity of node `head` as seen from node `tail`, in its axes. What turns with the tail is summed in those axes, so that
/// what slides beside the tail has no round-off of the tail's own place in it.
ct_ex3 ct_path_position_seen(struct ct_build *b, int tail, int head);
ct_ex3 ct_path_velocity_seen(struct ct_build *b, int tail, int head);

/// marked (ncluster, out): clusters whose spins may change the path from tail to head or the axes at its ends.
void ct_path_mark(struct ct_build *b, int tail, int head, bool *marked);

/// Sweep of node `head` seen from node `tail` for a unit rate of spin r: axis_r x the sum of the path's vectors that
/// turn with r, less those that would turn with the tail when carried is true (then the path is seen from the tail's
/// axes): dv_head - dv_tail (- dw_tail x d).  False if it is zero by structure.
bool ct_path_sweep(struct ct_build *b, int tail, int head, size_t r, bool carried,
                   ct_ex3 *sweep);
/// Vectors of the branches between the nodes that some spin turns against the other end (of a row seen from the tail's axes:
/// against the tail), each in axes of its own. Coefficients of a row are sums over them, which may cancel; the sum of their
/// lengths is what these were made of.
const ct_ex3 *ct_path_levers(struct ct_build *b, int tail, int head, bool carried, size_t *n);
/// +1, -1 or 0: the slide of an anchor lies on the path's head side, tail side, or on neither (both).
int ct_path_translation_side(struct ct_build *b, int tail, int head, int anchor);

#endif
