// Simplification for reading: like terms collected, trigonometric identities, common factors.
//
//     expand        m*(l*cos(q)*l*cos(q) + l*sin(q)*l*sin(q))  ->  m l^2 cos^2 q + m l^2 sin^2 q
//     identities    cos^2 + sin^2 = 1, cos a cos b + sin a sin b = cos(a - b), ...  ->  m l^2
//     regroup       common factors outside, accelerations first  ->  m*l^2
//
// The expression becomes a polynomial over atoms (symbols, sines and cosines of canonical angles,
// anything else as it is), identities are applied where they make it shorter, and the result is
// factored for reading. Nothing here is for evaluation: a factored recursion is cheaper to run than
// its expanded sum.
//
// What always holds: the result equals the expression up to round-off, wherever both are defined
// (x/x is 1); same input, same result; the result is never larger than the expression.
#ifndef CT_EXPR_COLLECT_H
#define CT_EXPR_COLLECT_H

#include "expr/ex.h"

/// All zero: the defaults.
struct ct_collect_options {
    size_t limit;             // terms of one polynomial; 0: 2000. Larger sums stay as one atom
    struct ct_arena *scratch; // work space; NULL: the arena of the store
    /// Unit quaternions, four symbols each: the square of the first number is one less the squares
    /// of the others. Results then equal the expression where the quaternions have length one.
    ct_ex (*quaternion)[4];
    size_t nquaternion;
};

/// e with like terms collected. New nodes are made in x. Cost: that of the expanded terms, bounded
/// by the limit; nodes beyond a fixed budget are kept as they are.
ct_ex ct_ex_collect(struct ct_exs *x, ct_ex e, const struct ct_collect_options *options);

/// e = sum over k of coefficient[k] s[k] + rest, each collected, for symbols s[0 ... n). False if
/// e is not linear in them: then rest holds what is not.
bool ct_ex_collect_linear(struct ct_exs *x, ct_ex e, const ct_ex *s, size_t n,
                          ct_ex *coefficient, ct_ex *rest,
                          const struct ct_collect_options *options);

/// Operators and operands that a full print of e shows. Cost: nodes below e.
double ct_ex_tree_size(struct ct_exs *x, struct ct_arena *scratch, ct_ex e);

#endif
