// Coordinates of joints and bodies: unknown, driven, or measured between two frames.  (formulation
// 1.3)
#ifndef CT_FORMULATE_KINEMATICS_COORDINATE_H
#define CT_FORMULATE_KINEMATICS_COORDINATE_H

#include "formulate/kinematics/kinematics.h"

struct ct_ends {
    int tail, head; // nodes
};

static inline struct ct_ends ct_edge_ends(const struct ct_build *b, int edge)
{
    return (struct ct_ends){b->topology->wiring[edge].tail, b->topology->wiring[edge].head};
}

/// Unit wrench on the head and the opposite on the tail. carried: both act along the line through
/// the head. Not carried: each acts at its own origin; for full translational rows, whose origins
/// coincide.
struct ct_wrench {
    ct_ex3 force, torque; // ground components
};

/// Coordinate of a joint or body edge by index in b->kinematics->coordinate: unknown, driven or
/// measured; then its rate, and its acceleration at a level. For quaternion parameter i the speed
/// is component i of the angular velocity.
ct_ex ct_coordinate_value(struct ct_build *b, int coordinate);
ct_ex ct_coordinate_speed(struct ct_build *b, int coordinate);
ct_ex ct_coordinate_acceleration(struct ct_build *b, int coordinate, enum ct_level level);
/// Wrench conjugate to the speed of a measured coordinate; false if there is none (a particle, the
/// last number of a quaternion).
bool ct_coordinate_wrench(struct ct_build *b, int coordinate, struct ct_wrench *w);

/// Quaternion of R with a continuous sign, from its last value.
void ct_quaternion_follow(struct ct_build *b, const char *name, const ct_ex33 *R, ct_ex out[4]);
/// Index in b->kinematics->coordinate of a name such as "a" or "a.q2"; -1 if it is not one.
int ct_coordinate_find(const struct ct_build *b, const char *name);

/// Is it unknown or driven? Otherwise it is measured.
bool ct_coordinate_is_known(const struct ct_coordinate *c);
/// Angle about the normal of an in-plane vector, relative to ground. v: in axes of the node.
ct_ex ct_angle_in_plane(struct ct_build *b, int node, ct_ex3 v);
/// d/dt of p . (d' - w_a x d) with p fixed in the tail's axes.  (4.3)
ct_ex ct_along_acceleration(struct ct_build *b, struct ct_ends n, ct_ex3 p,
                            enum ct_level level);
/// Adds a memory and returns its symbol; the caller sets the update. joint -1: none.
ct_ex ct_memory_new(struct ct_build *b, enum ct_memory_kind kind, const char *name, int joint,
                    int place);

/// Power of a wrench on head against tail: F . (v_head - v_tail - w_tail x d) + T . w_rel.  (0.3)
ct_ex ct_load_power(struct ct_build *b, int tail, int head, ct_ex3 force, ct_ex3 torque);

/// Symbol of a constant whose value is computed in the assembled start configuration. joint -1:
/// none.
ct_ex ct_memory_keep(struct ct_build *b, const char *name, int joint, ct_ex at_start);

#endif
