// What the files that make members share: member.c places them, member_load.c gives them inertia and loads,
// member_motion.c their velocities.
//
// Order: place, flatten, add bodies, lump, find axes, add beams, velocities, loads.
#ifndef CT_FORMULATE_MEMBER_WORK_H
#define CT_FORMULATE_MEMBER_WORK_H

#include "formulate/member.h"

/// Members while they are made.
struct ct_member_work {
    struct ct_build *b;
    struct ct_members *s;
    int *of_node;    ///< member
    ct_ex3 *offset;  ///< of a node from its member's origin, in axes of the member's cluster
    int *of_cluster; ///< the member that turns it, or -1
    int *of_speed;
};

/// Out of axes of a cluster into those the member uses: in a plane e1, e2, n.
ct_ex3 ct_member_express(struct ct_build *b, int cluster, ct_ex3 local);
/// Ground components of a force or a torque into the member's axes.
ct_ex3 ct_member_express_ground(struct ct_build *b, int cluster, ct_ex3 v);

/// Inertia of rigid bodies, in axes of the members' clusters.
void ct_members_add_bodies(struct ct_member_work *w);
/// Hand over towards ground what joints do not feel.
void ct_members_lump(struct ct_member_work *w);
/// Rigid part of the inertia of beams now, at their bases, in the axes that are used.
void ct_members_add_beams(struct ct_member_work *w);
/// Forces and torques of b->load, at the members' origins.
void ct_members_load(struct ct_member_work *w);
/// Angular velocities, what follows from them, and the turning part of the biases.
void ct_members_turn(struct ct_build *b, struct ct_members *s);

#endif
