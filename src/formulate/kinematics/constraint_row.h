// Constraint rows: a relative displacement or rotation of two frames that must vanish.
// (formulation 4.2)
#ifndef CT_FORMULATE_KINEMATICS_CONSTRAINT_ROW_H
#define CT_FORMULATE_KINEMATICS_CONSTRAINT_ROW_H

#include "formulate/kinematics/coordinate.h"

/// The wrench pair a multiplier stands for.
struct ct_multiplier_wrench {
    int row, tail, head;
    int joint; // the joint that transmits it; for a gear the coupled joints
    ct_ex3 force, torque;
    bool carried;
};

/// A branch coordinate coupled by a gear: the generalised force factor * lam acts along it, in
/// addition to the reaction of the joint.
struct ct_coupling {
    int row, coordinate;
    ct_ex factor;
};

/// Coefficients of the unknown speeds in a row, and the part driven by time: v = sum coef u +
/// driven.
struct ct_linear {
    ct_ex *coef; // nu
    ct_ex driven;
};

/// Derives the rows of all chord joints, rods, gears and driven chords.
bool ct_rows_derive(struct ct_build *b);

/// Coefficients of the speeds (nu) in the power of the row's wrench pairs. Valid until the next
/// call.
const ct_ex *ct_row_coefficients(struct ct_build *b, int row);

/// Adds one scalar row along a wrench; used by component classes (distance).
void ct_row_add(struct ct_build *b, const struct ct_instance *self, const char *what, int tail,
                int head, const struct ct_wrench *w, bool carried, ct_ex phi, ct_ex gam);
/// Adds the row q_a - ratio q_b = const. Assembly sets the constant at the start.
void ct_row_couple(struct ct_build *b, const struct ct_instance *self, int coordinate_a,
                   int coordinate_b, ct_ex ratio);
/// A constant that is set to the value of `at_start` in the assembled start configuration.
ct_ex ct_row_offset(struct ct_build *b, const struct ct_instance *self, ct_ex at_start);

#endif
