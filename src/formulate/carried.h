// Beams that do not stretch among the equations of closed systems, with as many entries as elements.  (formulation 6.4)
//
// In a CHAIN all that lies beyond the start of an element moves along with the foreshortening c there, so that M and J have
// an entry for each two nodes. With the accelerations c'' of these starts, as far as they come from u', for further unknowns
//
//     y = (u', c'') = P u',   c_i'' = c_i-1'' + g_i-1 . a_i-1''       M = P' M_c P,   J = J_c P
//
// an element sees its own nodes and c. Right sides, coordinates and rows stay as they are: M u' - J' lam = Q and J u' = -gam
// are
//
//     [ M_c  J_c'  L' ] [   y  ]   [ Q, 0 ]
//     [ J_c   0    0  ] [ -lam ] = [ -gam ],      L y = 0 the sums above; n are forces along the axis
//     [ L     0    0  ] [  -n  ]   [   0  ]
#ifndef CT_FORMULATE_CARRIED_H
#define CT_FORMULATE_CARRIED_H

#include "formulate/equations.h"

struct ct_carried {
    size_t nu, n;           // speeds; unknowns: these, then the starts of elements
    struct ct_entry *M, *J; // lower triangle (n); rows of the equations, columns below n
    struct ct_entry *
        sum; // P: y_row = sum of value y_column, columns below the row, rows nu ... n - 1 in order
    size_t nM, nJ, nsum;
    size_t M_cap, J_cap, sum_cap;
};

/// After the dynamics of b; NULL where no beam of b has a CHAIN of several elements in nodal coordinates that all are
/// unknowns, or b is truncated.
struct ct_carried *ct_carried_derive(struct ct_build *b);
/// y (n) = P y, its first nu given.
void ct_carried_extend(struct ct_exs *x, const struct ct_carried *c, ct_ex *y);
/// f (n) = P' f in its first nu; the others are lost.
void ct_carried_fold(struct ct_exs *x, const struct ct_carried *c, ct_ex *f);

#endif
