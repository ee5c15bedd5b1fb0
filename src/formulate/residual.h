// Residual form and its Jacobians, for implicit integration.  (formulation 5.2, 8.2)
#ifndef CT_FORMULATE_RESIDUAL_H
#define CT_FORMULATE_RESIDUAL_H

#include "formulate/dynamics.h"

/// r = M u' - Q - J' lam by the full sweep, and its derivatives along the coordinates, by u and by u'; dv/dq of the
/// rows. The rest is in the equations: dr/dlam = -J', dPhi/dq = dv/du = J. Into b->eqs->residual.
///
/// Cost    O(nodes of r times the speeds each depends on)
void ct_residual_derive(struct ct_build *b);

#endif
