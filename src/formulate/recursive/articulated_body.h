// Accelerations of open systems by articulated bodies: O(members) operations, no mass matrix.
#ifndef CT_FORMULATE_RECURSIVE_ARTICULATED_BODY_H
#define CT_FORMULATE_RECURSIVE_ARTICULATED_BODY_H

#include "formulate/recursive/member.h"

/// u' (nu) for the members of an open system and the efforts along its speeds (nu).
///
/// pivot   out   articulated inertia D of each speed (nu); 0 if a speed moves no mass
///
/// Cost    O(members)
/// Source  Featherstone (2008), key featherstone2008, section 7.3
ct_ex *ct_articulated_solve(struct ct_build *b, const struct ct_members *s, const ct_ex *effort,
                            ct_ex *pivot);

#endif
