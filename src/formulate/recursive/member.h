// Members: what moves as one rigid body, hung on each other along one tree.
//
//     ground (0) --shift r, slides--turn--> member --> member ...
//
// In space every member has axes of its own (those of its cluster), so that shifts, inertias and
// most axes of joints are constant: what recursions along a chain use. In a plane all members share
// the axes (e1, e2, n) of the plane, in which nothing need be turned.
//
// A beam hangs on a member of its own, its base; a section is one or more members that elastic
// coordinates move against it. All members that elastic coordinates of a beam move, and its base,
// are connected; the innermost of them is the root. In a plane the base and what slides against it
// have axes (x of the beam, n x x, n).
//
// What always holds: a member's parent has a smaller number; number 0 is ground. Each unknown speed
// of a joint moves one member. Masses are lumped towards ground: what a joint cannot move - a mass
// on its axis, a rod along it, for a slide the moments of inertia - is counted with the parent.
#ifndef CT_FORMULATE_RECURSIVE_MEMBER_H
#define CT_FORMULATE_RECURSIVE_MEMBER_H

#include "formulate/dynamics/dynamics.h"

/// Motion per unit of a speed, at the member's origin, in its axes.
struct ct_screw {
    // < 0: of the foreshortening at the start of element -speed (flexible_body.h: CHAIN), or, from
    // -nelement on, of a freedom that follows
    int speed;
    ct_ex3 rotation, translation;
    int axis; // 0..2: a turn about this coordinate axis alone, 3..5: a slide along one; else -1
};

struct ct_member {
    int parent, cluster;
    bool
        is_absolute; // its turn is measured from ground, its place from the parent (in a plane only)
    bool rotates, translates;
    bool has_axes; // R is not the unit matrix
    bool is_ready; // made in the axes that are used
    int beam;  // whose elastic coordinates its screws belong to, plus one; 0: those of joints
    int axis;  // of the turn: 0..2, or -1 where it is no coordinate axis
    ct_ex33 R; // its axes -> its parent's
    ct_ex3 r;  // parent's origin -> its own [m], in the parent's axes, and so
    ct_ex3 drift,
        drift_bias; // the rate of r seen from the parent, and its rate with all u' = 0
    struct ct_screw *screw;
    int nfree;
    size_t screw_cap;
    ct_ex3 w_relative, al_relative; // [rad/s], [rad/s^2] at u' = 0, own axes
    ct_ex mass;                     // [kg]
    ct_ex3 moment;                  // first moment about the origin [kg m]
    ct_ex33 J;                      // inertia about the origin [kg m^2]
    ct_ex3 force, torque;           // applied, at the origin [N, N m]
    ct_ex3 w;                       // angular velocity, own axes
    ct_ex33 U;                      // w x (w x v) = U v
};

/// Where a beam is among the members.
struct ct_member_beam {
    int base, root;
    ct_ex33 A; // axes of the beam -> those of its base
};

struct ct_members {
    struct ct_member *member;
    size_t n, cap;
    const int *of_speed;         // by speed: the member it moves; elastic ones: 0
    struct ct_member_beam *beam; // by b->flexible
    size_t nbeam;
};

/// Members of an open system; NULL where this form does not apply: translational and rotational
/// trees that differ (but for angles in a plane), equations that are cut to first order, beams
/// whose forces alone foreshorten. After ct_loads_derive.
const struct ct_members *ct_members_derive(struct ct_build *b);

/// R v and R' v: a vector out of a member's axes into its parent's, and back.
ct_ex3 ct_member_out(struct ct_build *b, const struct ct_member *m, ct_ex3 v);
ct_ex3 ct_member_in(struct ct_build *b, const struct ct_member *m, ct_ex3 v);
/// R A R' for any matrix A; about a coordinate axis with 12 products, 9 if A is symmetric.
void ct_member_turn_tensor(struct ct_build *b, const struct ct_member *m, ct_ex33 *A);

/// Accelerations of the origin that do not depend on u': centripetal, Coriolis, prescribed; in the
/// parent's axes.
ct_ex3 ct_member_shift_bias(struct ct_build *b, const struct ct_members *s, int m);
/// The same without the centripetal part.
ct_ex3 ct_member_slide_bias(struct ct_build *b, const struct ct_members *s, int m);
/// Acceleration of ground that stands for gravity: -g.
ct_ex3 ct_members_gravity_acceleration(struct ct_build *b);
/// w x J w for a member's own inertia, by products of the components of w.
ct_ex3 ct_member_gyroscopic(struct ct_build *b, const struct ct_member *m);

#endif
