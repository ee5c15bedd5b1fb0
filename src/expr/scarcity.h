// Inner values of expressions by which their Jacobian has fewer entries: what sums along a chain are to all that they reach.
//
//     d f = f_s ds + f_k dk,     dk = k_s ds + k_k dk          k: values of some nodes below f, each of earlier ones
//
// where n values depend on n seeds by one sum, its value for a k takes 2 n entries for n^2. From the graph of single operations,
// which has the least entries there can be but most values, nodes are eliminated by the chain rule, those first that add least.
// Source: Griewank and Vogel (2005), key griewank2005.
#ifndef CT_EXPR_SCARCITY_H
#define CT_EXPR_SCARCITY_H

#include "expr/ex.h"

struct ct_scarcity;

/// The graph of f (nf) by the seeds, whose directions count as columns modulo ncolumn. It lives in a, which it uses up.
/// Cost: nodes below f
struct ct_scarcity *ct_scarcity_create(struct ct_exs *x, struct ct_arena *a, const ct_ex *f,
                                       size_t nf, const struct ct_seed *seed, size_t nseed,
                                       uint32_t ncolumn);
/// Once through all nodes, from f down: those are eliminated whose entries, less those that they had, are at most so many.
void ct_scarcity_thin(struct ct_scarcity *s, long most);
/// The nodes that are left, ascending; *node lives in a.
size_t ct_scarcity_nodes(const struct ct_scarcity *s, struct ct_arena *a, ct_ex **node);
/// The entries: rows of f, then of the nodes that are left; columns, then these nodes. *row and *column live in a.
size_t ct_scarcity_entries(const struct ct_scarcity *s, struct ct_arena *a, int **row,
                           int **column);

#endif
