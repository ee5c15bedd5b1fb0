// Rows: what is measured between two frames, as a coordinate or as a constraint.  (formulation 4.2)
#ifndef CT_FORMULATE_ROW_H
#define CT_FORMULATE_ROW_H

#include "formulate/kinematics.h"

/// Unit wrench on the head, the opposite on the tail, both along the line through the head (carried) or each at
/// its own origin (not carried: full translational rows, where both origins coincide).
struct ct_wrench {
    ct_ex3 force, torque; // ground components
};

/// The wrench pair a multiplier stands for.
struct ct_pull {
    int row, tail, head;
    int joint; // that transmits it: of the row, of a gear the joints it couples
    ct_ex3 force, torque;
    bool carried;
};

/// Coefficients of the unknown speeds in a row, and the part driven by time: v = sum coef u + driven.
struct ct_linear {
    ct_ex *coef; // nu
    ct_ex driven;
};

/// Coordinate of a joint or body edge by index in b->coordinate: unknown, driven or measured; its rate and its
/// acceleration at a level. For a number of a quaternion the speed is the component of angular velocity of the same place.
ct_ex ct_coordinate_value(struct ct_build *b, int coordinate);
ct_ex ct_coordinate_speed(struct ct_build *b, int coordinate);
ct_ex ct_coordinate_acceleration(struct ct_build *b, int coordinate, enum ct_level level);
/// Wrench conjugate to the speed of a measured coordinate; false if there is none (a particle, the last number of a
/// quaternion).
bool ct_coordinate_wrench(struct ct_build *b, int coordinate, struct ct_wrench *w);

/// Rows of all joints that are chords, of rods, gears and driven chords.
bool ct_rows_derive(struct ct_build *b);

/// One scalar row along a wrench; used by classes (distance).
void ct_row_add(struct ct_build *b, const struct ct_instance *self, const char *what, int tail,
                int head, const struct ct_wrench *w, bool carried, ct_ex phi, ct_ex gam);
/// A row that couples two coordinates: q_a - ratio q_b = const, the constant from the assembled start.
void ct_row_couple(struct ct_build *b, const struct ct_instance *self, int coordinate_a,
                   int coordinate_b, ct_ex ratio);
/// A constant that takes the value of `at_start` in the assembled start and keeps it.
ct_ex ct_row_offset(struct ct_build *b, const struct ct_instance *self, ct_ex at_start);
/// The same under any name; joint -1: of none.
ct_ex ct_row_keep(struct ct_build *b, const char *name, int joint, ct_ex at_start);
/// Quaternion of R, followed continuously from its last value.
void ct_quaternion_follow(struct ct_build *b, const char *name, const ct_ex33 *R, ct_ex out[4]);
/// Index in b->coordinate of a name such as "a" or "a.q2"; -1 if it is not one.
int ct_coordinate_find(const struct ct_build *b, const char *name);

#endif
