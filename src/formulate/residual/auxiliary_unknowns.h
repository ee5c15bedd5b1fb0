// Auxiliary unknowns of the residual, which make the matrices of implicit integrators sparse.
// (formulation 8.2)
#ifndef CT_FORMULATE_RESIDUAL_AUXILIARY_UNKNOWNS_H
#define CT_FORMULATE_RESIDUAL_AUXILIARY_UNKNOWNS_H

#include "formulate/dynamics/dynamics.h"

/// Chooses subexpressions of r (nu) as auxiliary unknowns, in ascending order, if the matrix (8.19)
/// is predicted to be cheaper with them. Returns their number; 0: none. seed: from
/// ct_residual_seeds, nu directions each for positions, speeds and u'. *inner lives in the arena of
/// b.  (8.20)
size_t ct_auxiliary_unknowns_choose(struct ct_build *b, const ct_ex *r,
                                    const struct ct_seed *seed, size_t nseed, ct_ex **inner);

#endif
