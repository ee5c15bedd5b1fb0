// Several loops in one. Where loops follow each other over the same rows, as those over the elements of a beam do, a row of
// each after the other leaves fewer results behind than each loop for itself:
//
//     A A A A | B B B B      ->      A | A B | A B | A B | B
//
// What always holds: the same instructions on the same operands; only their order is another.
#ifndef CT_CODEGEN_MERGE_H
#define CT_CODEGEN_MERGE_H

#include "codegen/roll.h"

/// The loops of n instructions, merged or not, whichever leaves fewer results, straight code and time to wait; order is changed
/// accordingly, but for its first nfixed ones. Other arguments as those of ct_roll_find. Cost: its, or twice where
/// results are more than the nearest cache holds; with fewer nothing is merged.
struct ct_roll ct_merge_loops(struct ct_arena *a, const struct ct_listing *l, uint32_t *order,
                              uint32_t n, uint32_t nfixed, const bool is_alone[CT_NKIND],
                              uint32_t nwork, uint32_t rows, uint32_t lanes);

#endif
