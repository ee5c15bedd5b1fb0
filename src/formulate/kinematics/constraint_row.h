// Rows: what is measured between two frames, as a constraint.  (formulation 4.2)
#ifndef CT_FORMULATE_KINEMATICS_CONSTRAINT_ROW_H
#define CT_FORMULATE_KINEMATICS_CONSTRAINT_ROW_H

#include "formulate/kinematics/coordinate.h"

/// The wrench pair a multiplier stands for.
struct ct_multiplier_wrench {
    int row, tail, head;
    int joint; // that transmits it: of the row, of a gear the joints it couples
    ct_ex3 force, torque;
    bool carried;
};

/// A coordinate of a branch that a gear's row couples: it feels factor * lam along itself, beside
/// what the joint transmits.
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

/// Rows of all joints that are chords, of rods, gears and driven chords.
bool ct_rows_derive(struct ct_build *b);

/// Coefficients of the speeds (nu) in what the row's multiplier does as wrench pairs; until the
/// next row.
const ct_ex *ct_row_coefficients(struct ct_build *b, int row);

/// One scalar row along a wrench; used by classes (distance).
void ct_row_add(struct ct_build *b, const struct ct_instance *self, const char *what, int tail,
                int head, const struct ct_wrench *w, bool carried, ct_ex phi, ct_ex gam);
/// A row that couples two coordinates: q_a - ratio q_b = const, the constant from the assembled
/// start.
void ct_row_couple(struct ct_build *b, const struct ct_instance *self, int coordinate_a,
                   int coordinate_b, ct_ex ratio);
/// A constant that takes the value of `at_start` in the assembled start and keeps it.
ct_ex ct_row_offset(struct ct_build *b, const struct ct_instance *self, ct_ex at_start);

#endif
