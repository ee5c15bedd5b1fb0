// Where an expression switches along a symbol: its pieces in between are smooth, and quadrature of each is accurate.
#ifndef CT_EXPR_SWITCHES_H
#define CT_EXPR_SWITCHES_H

#include "expr/ex.h"

/**
 * Places in (from, to) where f switches as a function of the symbol s: the roots of the arguments of abs and sign, and of the
 * difference of those of min, max, <, <=, > and >=, be they jumps or kinks.
 *
 * A difference of first degree in s is solved as such. Any other is enclosed in intervals that are halved while they may hold a root
 * (interval arithmetic over the nodes, Moore, Kearfott and Cloud 2009, chapter 5): no root is missed, and where several that are
 * next to each other cannot be told apart from one, it is one place.
 *
 * value  in    of all symbols but s; entry of s: work
 * place  out   ascending, those nearer to each other or to an end than 1e-9 (to - from) only once or not at all
 * most         room in place
 *
 * Returns how many, -1 where they cannot be told: more than `most`, or an argument that is 0 in more intervals than are looked at.
 * Cost: nodes below f, about 100 times for a difference of higher degree.
 */
int ct_ex_switches(struct ct_exs *x, struct ct_arena *scratch, ct_ex f, ct_ex s, double from,
                   double to, double *value, double *place, int most);

#endif
