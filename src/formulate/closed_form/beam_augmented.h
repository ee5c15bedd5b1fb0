// Augmented sparse form of inextensible beams in closed systems. Its number of entries is
// proportional to the number of elements.  (formulation 6.4)
//
// In a CHAIN the foreshortening c at the start of an element moves everything beyond it, and
// condensed rotations r depend on all nodes. M and J then have an entry for each pair of nodes.
// Additional unknowns are r'' and c'', the parts of these accelerations that depend on u':
//
//     y = (u', r'', c'') = P u',   k r'' + k_t t'' = 0,   c_i'' = c_i-1'' + g_i-1 . a_i-1''
//     M = P' M_c P,   J = J_c P
//
// An element then depends on its own nodes and c only. Right sides, coordinates and rows do not
// change: M u' - J' lam = Q and J u' = -gam are
//
//     [ M_c  J_c'  L' ] [   y  ]   [ Q, 0 ]
//     [ J_c   0    0  ] [ -lam ] = [ -gam ],      L y = 0: the equations above
//     [ L     0    0  ] [  -n  ]   [   0  ]
#ifndef CT_FORMULATE_CLOSED_FORM_BEAM_AUGMENTED_H
#define CT_FORMULATE_CLOSED_FORM_BEAM_AUGMENTED_H

#include "formulate/equations.h"

struct ct_beam_augmented {
    // nu, n: number of speeds; of unknowns: speeds, then for each beam condensed rotations and
    // element starts
    size_t nu, n;
    struct ct_entry *M, *J; // lower triangle (n); rows of the equations, columns below n
    struct ct_entry *L;     // rows nu ... n - 1, columns below n
    struct ct_entry *sum;   // of element starts: y_row = sum of value y_column
    // (n) position by nodes from the end of the beam; other unknowns come last
    int *position_along;
    size_t nM, nJ, nL, nsum;
    size_t M_cap, J_cap, L_cap, sum_cap;
    const struct ct_build *build; // the copy whose beams have the additional coordinates
};

/// Derives the form after the dynamics of b. NULL if no beam of b is a CHAIN of several elements in
/// nodal coordinates that would fill M, or if b is truncated to first order.
struct ct_beam_augmented *ct_beam_augmented_derive(struct ct_build *b);
/// y (n) = P u' with u' in its first nu entries.
void ct_beam_augmented_extend(struct ct_exs *x, struct ct_arena *scratch,
                              const struct ct_beam_augmented *c, ct_ex *y);
/// The first nu entries of f (n) become P' f; the others are overwritten.
void ct_beam_augmented_project(struct ct_exs *x, struct ct_arena *scratch,
                               const struct ct_beam_augmented *c, ct_ex *f);

#endif
