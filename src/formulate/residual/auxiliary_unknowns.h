// Auxiliary unknowns of the residual (inner values) that make the matrices of implicit methods
// sparse.  (formulation 8.2)
#ifndef CT_FORMULATE_RESIDUAL_AUXILIARY_UNKNOWNS_H
#define CT_FORMULATE_RESIDUAL_AUXILIARY_UNKNOWNS_H

#include "formulate/dynamics/dynamics.h"

/// Nodes below r (nu), ascending, by whose variations the matrix (8.19) is predicted to take less
/// than without; 0: none. seed: as ct_residual_seeds gives them, nu directions after one another.
/// *inner lives in the arena of b.  (8.20)
size_t ct_auxiliary_unknowns_choose(struct ct_build *b, const ct_ex *r,
                                    const struct ct_seed *seed, size_t nseed, ct_ex **inner);

#endif
