// Constraint offsets: what is left open where joints close loops. With them the rows of joints hold at any start, and a loop can be
// closed little by little.  (formulation 9.1)
//
//     tail ---- gap ---- head       phi - g = 0;  of rotations  (R_g s | t), R_g turns the tail's axes to the head's
//
// A gap is memory (equations.h): numbers that take their values where the memories start and keep them until somebody
// changes them. Without b->has_gaps all functions hand back what they are given.
#ifndef CT_FORMULATE_KINEMATICS_CONSTRAINT_OFFSET_H
#define CT_FORMULATE_KINEMATICS_CONSTRAINT_OFFSET_H

#include "formulate/kinematics/kinematics.h"

struct ct_constraint_offset {
    size_t first;     // memory
    bool is_rotation; // nine entries of R_g, column by column; else one number
};

/// phi less its gap.
ct_ex ct_constraint_offset_subtract(struct ct_build *b, const struct ct_edge_info *e,
                                    ct_ex phi);
/// Vectors of the tail's axes as the row shall take them: s[i] becomes R_g s[i].
void ct_constraint_offset_rotate(struct ct_build *b, const struct ct_edge_info *e, int tail,
                                 int head, ct_ex3 *s, int n);

#endif
