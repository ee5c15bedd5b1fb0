// Sorted seeds of forward differentiation, for symbolic and numeric Jacobians.
#ifndef CT_EXPR_SEED_H
#define CT_EXPR_SEED_H

#include "expr/ex.h"

/// A copy of n seeds by symbol and then by direction; lives in a.
const struct ct_seed *ct_seeds_sorted(struct ct_arena *a, const struct ct_seed *seed, size_t n);
/// Index of the first of n sorted seeds whose symbol is node id; if there is none, where it would
/// be.
size_t ct_seeds_find(const struct ct_seed *seed, size_t n, uint32_t id);

#endif
