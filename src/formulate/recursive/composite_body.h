// Mass matrix and forces of open systems in axes of the members: composite bodies and inverse
// dynamics.
#ifndef CT_FORMULATE_RECURSIVE_COMPOSITE_BODY_H
#define CT_FORMULATE_RECURSIVE_COMPOSITE_BODY_H

#include "expr/symmetric.h"
#include "formulate/recursive/member.h"

/// M (lower triangle of nu x nu, out, column-major; zero if two speeds are not coupled)
/// and Q (nu, out) for the members of an open system and the efforts along its speeds.
///
/// Cost    O(members times depth)
/// Source  Featherstone (2008), key featherstone2008, sections 5.3 and 6.2
void ct_composite_derive(struct ct_build *b, const struct ct_members *s, const ct_ex *effort,
                         struct ct_symmetric *M, ct_ex *Q);

/// r = M u' - Q (nu, out) with the symbols u': inverse dynamics minus the efforts along the speeds.
///
/// Cost    O(members)
void ct_composite_residual(struct ct_build *b, const struct ct_members *s, const ct_ex *effort,
                           ct_ex *r);

#endif
