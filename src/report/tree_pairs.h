// The pairs of trees that were weighed, and why one of them was chosen.
//
// What always holds: each pair that is listed can be chosen again, by its number (`--tree 2`)
// or by the names of its branches (a tree file).
#ifndef CT_REPORT_TREE_PAIRS_H
#define CT_REPORT_TREE_PAIRS_H

#include "formulate/formulate.h"

#include <stdio.h>

/// The number of the pair of trees that the equations are on, from 0; -1: it is none of those
/// listed.
int ct_tree_pairs_chosen(const struct ct_equations *e, const struct ct_tree_report *r);

/// A sentence: how the pair was chosen, and what others would cost.
const char *ct_tree_pairs_reason(struct ct_arena *a, const struct ct_equations *e,
                                 const struct ct_tree_report *r);

/// Names of branches (by edge) that are no arms, as a tree file has them. *name lives in a.
size_t ct_tree_pairs_names(struct ct_arena *a, const struct ct_equations *e,
                           const bool *is_branch, const char *const **name);

void ct_tree_pairs_print_text(FILE *out, struct ct_arena *a, const struct ct_equations *e,
                              const struct ct_tree_report *r);
void ct_tree_pairs_print_json(FILE *out, struct ct_arena *a, const struct ct_equations *e,
                              const struct ct_tree_report *r);

#endif
