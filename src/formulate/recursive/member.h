// Members: rigid bodies connected by joints in one tree, for recursive algorithms.
//
//     ground (0) --shift r, translation--rotation--> member --> member ...
//
// In space each member has its own axes (those of its cluster), in which shifts, inertias and most
// joint axes are constant. In a plane all members use the axes (e1, e2, n) of the plane, so that no
// vector needs a rotation.
//
// A beam has its own member, the base. A section is one or more members that elastic coordinates
// move relative to the base. The base and all members that elastic coordinates of a beam move are
// connected; the innermost of them is the root. In a plane the base and the members that translate
// relative to it have the axes (x of the beam, n x x, n).
//
// What always holds: a member's parent has a smaller number; number 0 is ground. Each unknown speed
// of a joint moves one member. Masses are lumped towards ground: inertia that a joint does not move
// is added to the parent. Examples: a mass on the axis of a revolute joint, a thin rod along it,
// the moments of inertia at a prismatic joint.
#ifndef CT_FORMULATE_RECURSIVE_MEMBER_H
#define CT_FORMULATE_RECURSIVE_MEMBER_H

#include "formulate/dynamics/dynamics.h"

/// Motion per unit of a speed, at the member's origin, in its axes.
struct ct_screw {
    // < 0: for the foreshortening at the start of element -speed (flexible_body.h: CHAIN), or from
    // -nelement on for a condensed rotation
    int speed;
    ct_ex3 rotation, translation;
    // 0..2: a rotation about this coordinate axis alone, 3..5: a translation along one; else -1
    int axis;
};

struct ct_member {
    int parent, cluster;
    // is_absolute: its angle is relative to ground, its position to the parent (in a plane only)
    bool is_absolute;
    bool rotates, translates;
    bool has_axes; // R is not the unit matrix
    bool is_ready; // it is given in its final axes
    int beam;  // beam number plus one if its screws are of elastic coordinates; 0: of joints
    int axis;  // coordinate axis of the rotation, 0..2; else -1
    ct_ex33 R; // rotation from its axes to its parent's
    // vector from the parent's origin to its own [m], in axes of the parent; drift too
    ct_ex3 r;
    // drift, drift_bias: the rate of r relative to the parent, and its second derivative with all
    // u' = 0
    ct_ex3 drift, drift_bias;
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

/// The members of a beam.
struct ct_member_beam {
    int base, root;
    ct_ex33 A; // axes of the beam -> those of its base
};

struct ct_members {
    struct ct_member *member;
    size_t n, cap;
    const int *of_speed;         // by speed: the member that it moves; elastic speeds: 0
    struct ct_member_beam *beam; // by b->flexible
    size_t nbeam;
};

/// Members of an open system. NULL if the recursive form does not apply: the translational and
/// rotational trees differ (except for angles in a plane), equations are truncated to first order,
/// or foreshortening of beams enters forces only. After ct_loads_derive.
const struct ct_members *ct_members_derive(struct ct_build *b);

/// R v and R' v: transforms a vector from axes of a member to axes of its parent, and back.
ct_ex3 ct_member_out(struct ct_build *b, const struct ct_member *m, ct_ex3 v);
ct_ex3 ct_member_in(struct ct_build *b, const struct ct_member *m, ct_ex3 v);
/// R A R' for any matrix A; about a coordinate axis with 12 products, 9 if A is symmetric.
void ct_member_turn_tensor(struct ct_build *b, const struct ct_member *m, ct_ex33 *A);

/// Acceleration of the origin at u' = 0: centripetal, Coriolis and prescribed; in axes of the
/// parent.
ct_ex3 ct_member_shift_bias(struct ct_build *b, const struct ct_members *s, int m);
/// The same without the centripetal part.
ct_ex3 ct_member_slide_bias(struct ct_build *b, const struct ct_members *s, int m);
/// Acceleration of ground that stands for gravity: -g.
ct_ex3 ct_members_gravity_acceleration(struct ct_build *b);
/// w x J w for the inertia of a member, by products of the components of w.
ct_ex3 ct_member_gyroscopic(struct ct_build *b, const struct ct_member *m);

#endif
