// Points where an expression jumps or has a kink as a function of one symbol. Between them it is
// smooth, so that quadrature converges.
#ifndef CT_EXPR_SWITCHES_H
#define CT_EXPR_SWITCHES_H

#include "expr/ex.h"

/// Switching points closer than this part of the interval are merged. Default: below it, an element
/// between two points is so stiff that it costs steps; above it, distinct points are lost. Test:
/// switches.
#define CT_SAME_PLACE 1e-9

/**
 * Switching points of f in (from, to) as a function of the symbol s: roots of the arguments of abs
 * and sign, and of the difference of those of min, max, <, <=, > and >=.
 *
 * A linear difference is solved directly. Any other is enclosed by bisection with interval
 * arithmetic (Moore, Kearfott and Cloud 2009, chapter 5): no root is missed, and roots closer than
 * the smallest interval are merged.
 *
 * value  in    values of all symbols; the entry of s is workspace
 * place  out   points, ascending; points closer than 1e-9 (to - from) are merged, and points that
 *              close to an end are omitted
 * most   in    capacity of place
 *
 * Returns their number, -1 if there are more than `most` or the bisection exceeds its limit.
 * Cost: nodes below f, about 100 times for a difference of higher degree.
 */
int ct_ex_switches(struct ct_exs *x, struct ct_arena *scratch, ct_ex f, ct_ex s, double from,
                   double to, double *value, double *place, int most);

#endif
