// Newton corrections that project positions and speeds on the constraints.
//
//     J_d d = -Phi      J_d e = -v      J_d f = -D d      D = dv/dq  (6.3b)
//
// Entries of independent speeds are zero. q (+) d and u + e + f leave errors of second order in Phi
// and v. f corrects e for the displacement d.
#ifndef CT_FORMULATE_CLOSED_FORM_PROJECTION_STEP_H
#define CT_FORMULATE_CLOSED_FORM_PROJECTION_STEP_H

#include "formulate/closed_form/block_elimination.h"
#include "formulate/equations.h"

/// dq, du, shift (nu, out: d, e and f, nonzero for dependent speeds) for the kept rows (J_d->rank,
/// numbers in row), as expressions of a store that is a copy of e->x. shift may be NULL. Lives in
/// a. Cost: a few times the nodes of v.
void ct_projection_step_derive(struct ct_arena *a, struct ct_exs *x,
                               const struct ct_equations *e, const int *row,
                               struct ct_blocks *J_d, ct_ex *dq, ct_ex *du, ct_ex *shift);

#endif
