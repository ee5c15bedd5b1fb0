// Simplification for reading: collects like terms, applies trigonometric identities and pulls out
// common factors.
//
//     expand        m*(l*cos(q)*l*cos(q) + l*sin(q)*l*sin(q))  ->  m l^2 cos^2 q + m l^2 sin^2 q
//     identities    cos^2 + sin^2 = 1, cos a cos b + sin a sin b = cos(a - b), ...  ->  m l^2
//     regroup       common factors outside, accelerations first  ->  m*l^2
//
// The expression is written as a polynomial. Its indeterminates are called atoms: symbols, sines
// and cosines of canonical angles, and any other subexpression as it stands. Identities are applied
// where they make the polynomial shorter. The result is factored for reading. It is not meant for
// evaluation: the original nested expression costs less to evaluate than its expanded sum.
//
// What always holds: the result equals the expression up to round-off wherever both are defined
// (x/x becomes 1). The same input gives the same result. The result is never larger than the
// expression.
#ifndef CT_EXPR_COLLECT_H
#define CT_EXPR_COLLECT_H

#include "expr/ex.h"

/// All zero: the defaults.
struct ct_collect_options {
    size_t limit; // most terms of one polynomial; 0: 2000. A larger sum becomes one atom
    struct ct_arena *scratch; // work space; NULL: the arena of the store
    /// Unit quaternions, four symbols each: the square of the first symbol is replaced by 1 minus
    /// the squares of the others. The results are then valid for quaternions of length one.
    ct_ex (*quaternion)[4];
    size_t nquaternion;
};

/// e with like terms collected. New nodes are made in x. Cost: that of the expanded terms, which
/// the limit bounds. When a fixed budget of nodes is used up, the remaining ones stay as they are.
ct_ex ct_ex_collect(struct ct_exs *x, ct_ex e, const struct ct_collect_options *options);

/// Operators and operands that a full print of e shows. Cost: nodes below e.
double ct_ex_tree_size(struct ct_exs *x, struct ct_arena *scratch, ct_ex e);

#endif
