// Jacobian scarcity: intermediate values become auxiliary unknowns, so that an extended Jacobian
// has fewer nonzeros.
//
//     d f = f_s ds + f_k dk,     dk = k_s ds + k_k dk     k: values of some nodes below f
//
// If n values depend on n seeds through one sum, an auxiliary unknown k for the sum needs 2 n
// entries in place of n^2. The computational graph of single operations has the fewest entries and
// the most auxiliary unknowns. Its vertices are eliminated by the chain rule, those that add the
// fewest edges first. Source: Griewank and Vogel (2005), key griewank2005.
#ifndef CT_EXPR_SCARCITY_H
#define CT_EXPR_SCARCITY_H

#include "expr/ex.h"

struct ct_scarcity;

/// Computational graph of f (nf) by the seeds; direction d belongs to column d modulo ncolumn. It
/// lives in a. Cost: nodes below f.
struct ct_scarcity *ct_scarcity_create(struct ct_exs *x, struct ct_arena *a, const ct_ex *f,
                                       size_t nf, const struct ct_seed *seed, size_t nseed,
                                       uint32_t ncolumn);
/// One pass over all vertices, from f down: eliminate those that add at most `most` edges (fill).
void ct_scarcity_thin(struct ct_scarcity *s, long most);
/// The remaining nodes, ascending; *node lives in a.
size_t ct_scarcity_nodes(const struct ct_scarcity *s, struct ct_arena *a, ct_ex **node);
/// Entries of the extended Jacobian. Rows: f, then the remaining nodes. Columns: seeds, then the
/// remaining nodes. *row and *column live in a.
size_t ct_scarcity_entries(const struct ct_scarcity *s, struct ct_arena *a, int **row,
                           int **column);

#endif
