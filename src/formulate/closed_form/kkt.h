// The equations of motion with loops as one symmetric system of expressions, factored with a fixed
// order of pivots.
//
//     [ M  J' ] [   u'  ]   [  Q   ]
//     [ J  0  ] [ -lam  ] = [ -gam ]       = L D L',  D of blocks of one or two rows
//
// The next pivot is the one that makes fewest products per row among those whose multipliers at the
// state of the probe are not large; a row without a diagonal entry goes together with a neighbour.
// Numbers are scaled to a unit diagonal of M and rows of J of size one, so that masses and lengths
// compare. Of two orders the one with fewer operations is taken by those who factor.
//
// Source: least degree, Tinney and Walker (1967), key tinney1967; blocks of two for indefinite
// matrices, Bunch and Kaufman (1977), key bunch1977.
#ifndef CT_FORMULATE_CLOSED_FORM_KKT_H
#define CT_FORMULATE_CLOSED_FORM_KKT_H

#include "formulate/closed_form/numeric_probe.h"

struct ct_kkt {
    size_t n, npivot;
    struct ct_kkt_pivot *pivot; // in their order
    double operations;          // of factoring and one solution, by the pattern
};

struct ct_kkt_pivot {
    int size, at[2];
    ct_ex P[3]; // diagonal entry; or first, both, second
    ct_ex value,
        reciprocal; // entry or determinant (of the entry beside the diagonal where the second is 0)
    double number,
        strength; // at the state of the probe; 1 over the largest multiplier, at most 1
    struct ct_kkt_factor *factor;
    size_t nfactor, factor_cap;
};

struct ct_kkt_factor { // of L: row -= f * pivot's rows
    int row;
    ct_ex f[2];
};

/// By least degree, or along the system: better for long chains, where least degree leaves a dense
/// rest; by least degree and among equals in the order of places: in long beams, where least degree
/// joins nodes from all over.
enum ct_kkt_order { CT_KKT_DEGREE, CT_KKT_ALONG, CT_KKT_POSITIONS, CT_KKT_NORDER };

/// Rows of M (n, both triangles) and J (m).
struct ct_kkt_system {
    struct ct_probed_row *M, *J;
    size_t n, m;
    double threshold; // multipliers of pivots are at most 1 over it, where that is possible
    const int *position_along; // along beams (n + m); NULL: there are none
};

/// Factor. x NULL: only the pattern and the probe, for the operations.
/// NULL if it is singular at the state of the probe or takes as many nodes of x (operations, if
/// NULL) as `most`, or more, or has no places for an order by them.
struct ct_kkt *ct_kkt_factor(struct ct_arena *a, struct ct_exs *x,
                             const struct ct_kkt_system *system, enum ct_kkt_order order,
                             double most);
/// y (n, out) for the right side b (n; lost).
void ct_kkt_solve(const struct ct_kkt *k, struct ct_exs *x, ct_ex *b, ct_ex *y);

#endif
