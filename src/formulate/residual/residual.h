// Residual form and its Jacobians, for implicit integration.  (formulation 5.2, 8.2)
#ifndef CT_FORMULATE_RESIDUAL_RESIDUAL_H
#define CT_FORMULATE_RESIDUAL_RESIDUAL_H

#include "formulate/dynamics/dynamics.h"

/// r = M u' - Q - J' lam by the full sweep, and its derivatives along the coordinates, by u and by
/// u'; dv/dq of the rows. The rest is in the equations: dr/dlam = -J', dPhi/dq = dv/du = J. Into
/// b->eqs->residual.
///
/// As entries each slope has an expression. Along directions r' and v' are derived once for a
/// motion whose numbers are inputs; entries that share no row are read off one evaluation, and
/// several evaluations go side by side in lanes. AUTO takes what is predicted to cost less in a run
/// of some hundred Jacobians, making the code included.
///
/// Cost    ENTRIES: O(nodes of r times the speeds each depends on); ALONG: O(nodes of r)
enum ct_slope_form { CT_SLOPES_AUTO, CT_SLOPES_ENTRIES, CT_SLOPES_ALONG };
void ct_residual_derive(struct ct_build *b, enum ct_slope_form form);
/// Only r.
void ct_residual_rows(struct ct_build *b);
/// What its derivatives are taken by: symbols and their rates of change in the directions k of the
/// places, nu + k of the speeds, 2 nu + k of u'. Returns their number; *nplace: those of the
/// places, which come first. *out lives in a.
size_t ct_residual_seeds(struct ct_build *b, struct ct_arena *a, struct ct_seed **out,
                         size_t *nplace);

/// Derivatives of f (nf) in the directions: places, speeds, u' (nu each), multipliers (nrow), then
/// the symbols of `more` (nmore). *out lives in a.
size_t ct_slopes_derive(struct ct_build *b, struct ct_arena *a, const ct_ex *f, size_t nf,
                        const ct_ex *more, size_t nmore, struct ct_slope **out);

#endif
