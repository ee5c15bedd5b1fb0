// Jumps and kinks of an expression along a symbol: between them it is smooth, and quadrature
// converges.
#ifndef CT_EXPR_SWITCHES_H
#define CT_EXPR_SWITCHES_H

#include "expr/ex.h"

/// Places closer than this part of the whole are one. Default: a short element is stiff and costs
/// steps, and places have round-off. Test: switches.
#define CT_SAME_PLACE 1e-9

/**
 * Switching points of f in (from, to) as a function of the symbol s: roots of the arguments of abs
 * and sign, and of the difference of those of min, max, <, <=, > and >=.
 *
 * A linear difference is solved directly. Any other is enclosed by bisection with interval
 * arithmetic (Moore, Kearfott and Cloud 2009, chapter 5): no root is missed, and roots closer than
 * the smallest interval count as one.
 *
 * value  in    of all symbols but s; entry of s: work
 * place  out   ascending; points closer than 1e-9 (to - from) to each other are one, to an end none
 * most         room in place
 *
 * Returns their number, -1 if there are more than `most` or the bisection exceeds its limit.
 * Cost: nodes below f, about 100 times for a difference of higher degree.
 */
int ct_ex_switches(struct ct_exs *x, struct ct_arena *scratch, ct_ex f, ct_ex s, double from,
                   double to, double *value, double *place, int most);

#endif
