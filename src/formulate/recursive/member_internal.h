// Shared declarations of the files that make members: member.c (geometry), member_section.c
// (beams), member_load.c (inertia and loads), member_velocity.c (velocities).
//
// Order: place, flatten, add bodies, lump, find axes, add beams, velocities, loads.
#ifndef CT_FORMULATE_RECURSIVE_MEMBER_INTERNAL_H
#define CT_FORMULATE_RECURSIVE_MEMBER_INTERNAL_H

#include "formulate/recursive/member.h"

/// Members under construction.
struct ct_member_build {
    struct ct_build *b;
    struct ct_members *s;
    int *of_node;    ///< member
    ct_ex3 *offset;  ///< of a node from its member's origin, in axes of the member's cluster
    int *of_cluster; ///< the member that has its rotation, or -1
    int *of_speed;
};

/// Motion of a joint between a node of a member and the next node.
struct ct_passage {
    const struct ct_edge_info *e;
    int cluster[CT_MAX_COORD], ncluster; ///< new ones, in order
    bool is_absolute;
    ct_ex3 vector;    ///< vector of the joint, in axes of the cluster in which it is fixed
    bool vector_last; ///< the vector is fixed after the rotations
    const ct_ex33 *S; ///< axes of the node at which it starts
};

/// A new member at r from its parent, with the axes of a cluster (-1: not set yet). Returns its
/// number.
int ct_member_add(struct ct_member_build *w, int parent, int cluster, ct_ex3 r);
/// The screw of the member for a speed; created at the first call.
struct ct_screw *ct_member_screw(struct ct_build *b, struct ct_member *m, int speed);
/// Adds to the screw of a speed a rotation of rate `by` about an axis.
void ct_member_screw_turn(struct ct_build *b, struct ct_member *m, int speed, ct_ex by,
                          ct_ex3 axis);
/// Gives the member the axes of a cluster; its rotation axes are added later.
struct ct_member *ct_member_take_cluster(struct ct_member_build *w, int member, int cluster);
/// Adds rotation axis i of the member's cluster without its screws. S: axes of the node at which
/// the joint starts. Returns the axis.
ct_ex3 ct_member_rotation_axis(struct ct_member_build *w, struct ct_member *m, const ct_ex33 *S,
                               int i);

/// Adds the base of a beam at a node, unless it exists.
void ct_member_attach_base(struct ct_member_build *w, const struct ct_flexible *f, int member,
                           ct_ex3 offset);
/// Adds the members from the base of a beam to a section (sign +1) or back. False if members cannot
/// represent it.
bool ct_member_pass_section(struct ct_member_build *w, const struct ct_passage *p, int sign,
                            int *member, ct_ex3 *offset);

/// Transforms from axes of a cluster to axes of the member (in a plane e1, e2, n).
ct_ex3 ct_member_express(struct ct_build *b, int cluster, ct_ex3 local);
/// Transforms a force or torque from ground components to axes of the member.
ct_ex3 ct_member_express_ground(struct ct_build *b, int cluster, ct_ex3 v);

/// Adds the inertia of rigid bodies, in axes of the clusters of the members.
void ct_members_add_bodies(struct ct_member_build *w);
/// Moves inertia that a joint does not move to the parent.
void ct_members_lump(struct ct_member_build *w);
/// Adds the present rigid-body inertia of beams at their bases, in the final axes.
void ct_members_add_beams(struct ct_member_build *w);
/// Adds the loads b->loads->load at the origins of the members.
void ct_members_load(struct ct_member_build *w);
/// Derives angular velocities, their products and the rotational part of the biases.
void ct_members_turn(struct ct_build *b, struct ct_members *s);

#endif
