// Jacobian scarcity: intermediate values as auxiliary unknowns that leave fewer nonzeros in an
// extended Jacobian.
//
//     d f = f_s ds + f_k dk,     dk = k_s ds + k_k dk     k: values of some nodes below f
//
// Where n values depend on n seeds by one sum, an auxiliary k for the sum takes 2 n entries for
// n^2. The computational graph of single operations has the fewest entries and the most auxiliary
// values. Its vertices are eliminated by the chain rule, those first that add the fewest edges.
// Source: Griewank and Vogel (2005), key griewank2005.
#ifndef CT_EXPR_SCARCITY_H
#define CT_EXPR_SCARCITY_H

#include "expr/ex.h"

struct ct_scarcity;

/// Computational graph of f (nf) by the seeds; directions are columns modulo ncolumn. It lives in
/// a. Cost: nodes below f
struct ct_scarcity *ct_scarcity_create(struct ct_exs *x, struct ct_arena *a, const ct_ex *f,
                                       size_t nf, const struct ct_seed *seed, size_t nseed,
                                       uint32_t ncolumn);
/// One pass over all vertices, from f down: eliminate those that add at most `most` edges (fill).
void ct_scarcity_thin(struct ct_scarcity *s, long most);
/// The remaining nodes, ascending; *node lives in a.
size_t ct_scarcity_nodes(const struct ct_scarcity *s, struct ct_arena *a, ct_ex **node);
/// Entries of the extended Jacobian: rows of f, then of the remaining nodes; columns of the seeds,
/// then these nodes. *row and *column live in a.
size_t ct_scarcity_entries(const struct ct_scarcity *s, struct ct_arena *a, int **row,
                           int **column);

#endif
