// Constraint offsets: how far a joint that closes a loop is from closing it. A row less its
// offset holds at any start, and the loop is closed by continuation: the offsets are reduced in
// steps.  (formulation 9.1)
//
//     tail --- offset --- head      phi - g = 0;  of rotations  (R_g s | t), R_g turns the tail's axes to the head's
//
// Offsets are memories (equations.h): they take their values at the start and keep them until
// they are set. Without b->options->has_offsets both functions return their argument.
#ifndef CT_FORMULATE_KINEMATICS_CONSTRAINT_OFFSET_H
#define CT_FORMULATE_KINEMATICS_CONSTRAINT_OFFSET_H

#include "formulate/kinematics/kinematics.h"

struct ct_constraint_offset {
    size_t first;     // memory
    bool is_rotation; // nine entries of R_g, column by column; else one number
};

/// phi less its offset.
ct_ex ct_constraint_offset_subtract(struct ct_build *b, const struct ct_edge_info *e,
                                    ct_ex phi);
/// Vectors in axes of the tail, as the row takes them: s[i] becomes R_g s[i].
void ct_constraint_offset_rotate(struct ct_build *b, const struct ct_edge_info *e, int tail,
                                 int head, ct_ex3 *s, int n);

#endif
