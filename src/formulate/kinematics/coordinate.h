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

/// Unit wrench on the head, the opposite on the tail, both along the line through the head
/// (carried) or each at its own origin (not carried: full translational rows, where both origins
/// coincide).
struct ct_wrench {
    ct_ex3 force, torque; // ground components
};

/// Coordinate of a joint or body edge by index in b->kinematics->coordinate: unknown, driven or measured; its
/// rate and its acceleration at a level. For a number of a quaternion the speed is the component of
/// angular velocity of the same place.
ct_ex ct_coordinate_value(struct ct_build *b, int coordinate);
ct_ex ct_coordinate_speed(struct ct_build *b, int coordinate);
ct_ex ct_coordinate_acceleration(struct ct_build *b, int coordinate, enum ct_level level);
/// Wrench conjugate to the speed of a measured coordinate; false if there is none (a particle, the
/// last number of a quaternion).
bool ct_coordinate_wrench(struct ct_build *b, int coordinate, struct ct_wrench *w);

/// Quaternion of R, followed continuously from its last value.
void ct_quaternion_follow(struct ct_build *b, const char *name, const ct_ex33 *R, ct_ex out[4]);
/// Index in b->kinematics->coordinate of a name such as "a" or "a.q2"; -1 if it is not one.
int ct_coordinate_find(const struct ct_build *b, const char *name);

/// Is it an unknown, or driven? Else it is measured.
bool ct_coordinate_is_known(const struct ct_coordinate *c);
/// Angle about the normal of the plane, of a vector of the plane given in the node's axes, from
/// ground.
ct_ex ct_angle_in_plane(struct ct_build *b, int node, ct_ex3 v);
/// d/dt of p . (d' - w_a x d) with p fixed in the tail's axes.  (4.3)
ct_ex ct_along_acceleration(struct ct_build *b, struct ct_ends n, ct_ex3 p,
                            enum ct_level level);
/// Its symbol; the update is to be filled in. joint -1: of none.
ct_ex ct_memory_new(struct ct_build *b, enum ct_memory_kind kind, const char *name, int joint,
                    int place);

/// Power of a wrench on head against tail: F . (v_head - v_tail - w_tail x d) + T . w_rel.  (0.3)
ct_ex ct_load_power(struct ct_build *b, int tail, int head, ct_ex3 force, ct_ex3 torque);

/// A value that is found at the assembled start and kept: its symbol. joint -1: of none.
ct_ex ct_memory_keep(struct ct_build *b, const char *name, int joint, ct_ex at_start);

#endif
