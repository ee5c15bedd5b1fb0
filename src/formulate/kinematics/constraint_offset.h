// Constraint offsets: the residual of a loop-closing joint at the start. A row minus its offset is
// zero for any start configuration. Assembly by continuation then reduces the offsets to zero in
// steps.  (formulation 9.1)
//
//     tail --- offset --- head      translation: phi - g = 0
//                                       rotation: (R_g s) . t = 0, R_g from tail to head
//
// Offsets are memories (equations.h): they are set at the start and stay constant until assembly
// changes them. Without b->options->has_offsets both functions return their argument.
#ifndef CT_FORMULATE_KINEMATICS_CONSTRAINT_OFFSET_H
#define CT_FORMULATE_KINEMATICS_CONSTRAINT_OFFSET_H

#include "formulate/kinematics/kinematics.h"

struct ct_constraint_offset {
    size_t first;     // index of its first memory
    bool is_rotation; // nine entries of R_g, column by column; else one number
};

/// phi minus its offset.
ct_ex ct_constraint_offset_subtract(struct ct_build *b, const struct ct_edge_info *e,
                                    ct_ex phi);
/// Rotates vectors in axes of the tail by the offset: s[i] becomes R_g s[i].
void ct_constraint_offset_rotate(struct ct_build *b, const struct ct_edge_info *e, int tail,
                                 int head, ct_ex3 *s, int n);

#endif
