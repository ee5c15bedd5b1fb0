// Augmented sparse form of inextensible beams among the equations of closed systems, with as many
// entries as elements.  (formulation 6.4)
//
// In a CHAIN all that lies beyond the start of an element moves along with the foreshortening c
// there, and rotations r that follow are sums over all nodes: M and J have an entry for each two
// nodes. With r'' and the accelerations c'' of these starts, as far as they come from u', for
// further unknowns
//
//     y = (u', r'', c'') = P u',   k r'' + k_t t'' = 0,   c_i'' = c_i-1'' + g_i-1 . a_i-1''       M = P' M_c P,   J = J_c P
//
// an element sees its own nodes and c. Right sides, coordinates and rows stay as they are: M u' -
// J' lam = Q and J u' = -gam are
//
//     [ M_c  J_c'  L' ] [   y  ]   [ Q, 0 ]
//     [ J_c   0    0  ] [ -lam ] = [ -gam ],      L y = 0 the sums above; n are forces along the axis, and moments
//     [ L     0    0  ] [  -n  ]   [   0  ]
#ifndef CT_FORMULATE_CLOSED_FORM_BEAM_AUGMENTED_H
#define CT_FORMULATE_CLOSED_FORM_BEAM_AUGMENTED_H

#include "formulate/equations.h"

struct ct_beam_augmented {
    size_t nu,
        n; // speeds; unknowns: these, then by beam what follows and the starts of elements
    struct ct_entry *M, *J; // lower triangle (n); rows of the equations, columns below n
    struct ct_entry *L;     // rows nu ... n - 1, columns below n
    struct ct_entry *sum;   // of starts: y_row = sum of value y_column, from the first start on
    int *position_along;    // (n) nodes from the end of the beam; behind all where it is none's
    size_t nM, nJ, nL, nsum;
    size_t M_cap, J_cap, L_cap, sum_cap;
    const struct ct_build *build; // whose beams have all these coordinates
};

/// After the dynamics of b; NULL where no beam of b has a CHAIN of several elements in nodal
/// coordinates that would fill M, or b is truncated.
struct ct_beam_augmented *ct_beam_augmented_derive(struct ct_build *b);
/// y (n) = P y, its first nu given.
void ct_beam_augmented_extend(struct ct_exs *x, struct ct_arena *scratch,
                              const struct ct_beam_augmented *c, ct_ex *y);
/// f (n) = P' f in its first nu; the others are lost.
void ct_beam_augmented_project(struct ct_exs *x, struct ct_arena *scratch,
                               const struct ct_beam_augmented *c, ct_ex *f);

#endif
