// The pairs of trees that the search compared, and the reason for the choice.
//
// What always holds: each listed pair can be requested by its number (`--tree 2`) or by the
// names of its branches (a tree file).
#ifndef CT_REPORT_TREE_PAIRS_H
#define CT_REPORT_TREE_PAIRS_H

#include "formulate/formulate.h"

#include <stdio.h>

/// The number, from 0, of the pair of trees of the equations; -1: it is not listed.
int ct_tree_pairs_chosen(const struct ct_equations *e, const struct ct_tree_report *r);

/// A sentence: how the pair was chosen, and the cost of others.
const char *ct_tree_pairs_reason(struct ct_arena *a, const struct ct_equations *e,
                                 const struct ct_tree_report *r);

/// Names of branches (by edge) other than arms, as in a tree file. *name lives in a.
size_t ct_tree_pairs_names(struct ct_arena *a, const struct ct_equations *e,
                           const bool *is_branch, const char *const **name);

void ct_tree_pairs_print_text(FILE *out, struct ct_arena *a, const struct ct_equations *e,
                              const struct ct_tree_report *r);
void ct_tree_pairs_print_json(FILE *out, struct ct_arena *a, const struct ct_equations *e,
                              const struct ct_tree_report *r);

#endif
