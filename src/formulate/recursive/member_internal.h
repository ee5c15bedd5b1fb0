// What the files that make members share: member.c places them, member_section.c those of beams,
// member_load.c gives them inertia and loads, member_velocity.c their velocities.
//
// Order: place, flatten, add bodies, lump, find axes, add beams, velocities, loads.
#ifndef CT_FORMULATE_RECURSIVE_MEMBER_INTERNAL_H
#define CT_FORMULATE_RECURSIVE_MEMBER_INTERNAL_H

#include "formulate/recursive/member.h"

/// Members while they are made.
struct ct_member_build {
    struct ct_build *b;
    struct ct_members *s;
    int *of_node;    ///< member
    ct_ex3 *offset;  ///< of a node from its member's origin, in axes of the member's cluster
    int *of_cluster; ///< the member that turns it, or -1
    int *of_speed;
};

/// What a joint does between a node of a member and the next node.
struct ct_passage {
    const struct ct_edge_info *e;
    int cluster[CT_MAX_COORD], ncluster; ///< new ones, in order
    bool is_absolute;
    ct_ex3 vector;    ///< that of the joint, in axes of the cluster where it is fixed
    bool vector_last; ///< in the axes behind the turns
    const ct_ex33 *S; ///< axes of the node that it starts from
};

/// A new member at r from its parent, with the axes of a cluster (-1: still open). Returns its
/// number.
int ct_member_add(struct ct_member_build *w, int parent, int cluster, ct_ex3 r);
/// The member's screw for a speed, made when first asked for.
struct ct_screw *ct_member_screw(struct ct_build *b, struct ct_member *m, int speed);
/// Turn by `by` about an axis per unit of a speed.
void ct_member_screw_turn(struct ct_build *b, struct ct_member *m, int speed, ct_ex by,
                          ct_ex3 axis);
/// The member turns as a cluster does; its spins are still to be added.
struct ct_member *ct_member_take_cluster(struct ct_member_build *w, int member, int cluster);
/// Number i of the spins of the member's cluster, but for its screws. S: axes of the node the joint
/// starts from. Returns its axis.
ct_ex3 ct_member_rotation_axis(struct ct_member_build *w, struct ct_member *m, const ct_ex33 *S,
                               int i);

/// The base of a beam that a node carries, unless it is there already.
void ct_member_attach_base(struct ct_member_build *w, const struct ct_flexible *f, int member,
                           ct_ex3 offset);
/// From the base of a beam to a section (sign +1) or back. False where members cannot do that.
bool ct_member_pass_section(struct ct_member_build *w, const struct ct_passage *p, int sign,
                            int *member, ct_ex3 *offset);

/// Out of axes of a cluster into those the member uses: in a plane e1, e2, n.
ct_ex3 ct_member_express(struct ct_build *b, int cluster, ct_ex3 local);
/// Ground components of a force or a torque into the member's axes.
ct_ex3 ct_member_express_ground(struct ct_build *b, int cluster, ct_ex3 v);

/// Inertia of rigid bodies, in axes of the members' clusters.
void ct_members_add_bodies(struct ct_member_build *w);
/// Hand over towards ground what joints do not feel.
void ct_members_lump(struct ct_member_build *w);
/// Rigid part of the inertia of beams now, at their bases, in the axes that are used.
void ct_members_add_beams(struct ct_member_build *w);
/// Forces and torques of b->loads->load, at the members' origins.
void ct_members_load(struct ct_member_build *w);
/// Angular velocities, what follows from them, and the turning part of the biases.
void ct_members_turn(struct ct_build *b, struct ct_members *s);

#endif
