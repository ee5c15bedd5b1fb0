// Residual form of the equations for implicit integrators. This folder derives the residual r, its
// sparse Jacobians and the auxiliary unknowns that keep them sparse.  (formulation 5.2, 8.2)
#ifndef CT_FORMULATE_RESIDUAL_RESIDUAL_H
#define CT_FORMULATE_RESIDUAL_RESIDUAL_H

#include "formulate/dynamics/dynamics.h"

/// r = M u' - Q - J' lam by the full sweep, and its derivatives with respect to q, u and u'; dv/dq
/// of the constraint rows. The other blocks are known: dr/dlam = -J', dPhi/dq = dv/du = J. The
/// result is b->eqs->residual.
///
/// ENTRIES: each Jacobian entry is an expression. ALONG: r' and v' are derived once along a
/// direction whose components are inputs. One evaluation gives all entries of one colour, and
/// several evaluations run in SIMD lanes. AUTO takes the way of lower predicted cost in a run of
/// some hundred Jacobians, code generation included.
///
/// Cost    ENTRIES: O(nodes of r times the speeds each depends on); ALONG: O(nodes of r)
enum ct_slope_form { CT_SLOPES_AUTO, CT_SLOPES_ENTRIES, CT_SLOPES_ALONG };
void ct_residual_derive(struct ct_build *b, enum ct_slope_form form);
/// Derives only r.
void ct_residual_rows(struct ct_build *b);
/// The seeds of differentiation: symbols and their derivatives in the directions k of positions, nu
/// + k of speeds, 2 nu + k of u'. Returns their number; *nplace: number of position seeds, which
/// come first. *out lives in a.
size_t ct_residual_seeds(struct ct_build *b, struct ct_arena *a, struct ct_seed **out,
                         size_t *nplace);

/// Derivatives of f (nf) in the directions of positions, speeds, u' (nu each), multipliers (nrow),
/// then the symbols of `more` (nmore). *out lives in a.
size_t ct_slopes_derive(struct ct_build *b, struct ct_arena *a, const ct_ex *f, size_t nf,
                        const ct_ex *more, size_t nmore, struct ct_slope **out);

#endif
