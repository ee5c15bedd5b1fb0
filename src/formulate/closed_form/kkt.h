// The equations of motion with loops as one symmetric system of expressions, factored with a fixed
// order of pivots.
//
//     [ M  J' ] [   u'  ]   [  Q   ]
//     [ J  0  ] [ -lam  ] = [ -gam ]       = L D L',  D of blocks of one or two rows
//
// The next pivot has the fewest products per row among those with small multipliers at the state of
// the probe. A row without a diagonal entry forms a block with a neighbour. Values are scaled to a
// unit diagonal of M and rows of J of size one, so that units do not matter. The caller takes the
// order with the fewest operations.
//
// Source: least degree, Tinney and Walker (1967), key tinney1967; blocks of two for indefinite
// matrices, Bunch and Kaufman (1977), key bunch1977.
#ifndef CT_FORMULATE_CLOSED_FORM_KKT_H
#define CT_FORMULATE_CLOSED_FORM_KKT_H

#include "formulate/closed_form/numeric_probe.h"

struct ct_kkt {
    size_t n, npivot;
    struct ct_kkt_pivot *pivot; // in the order of elimination
    double operations;          // for factorization and one solution, from the pattern
};

struct ct_kkt_pivot {
    int size, at[2];
    ct_ex P[3]; // diagonal entry; or entries (1,1), (1,2), (2,2)
    // reciprocal: of the entry or determinant (of the off-diagonal entry if the second diagonal
    // entry is 0)
    ct_ex value, reciprocal;
    // strength: 1/(largest multiplier) at the state of the probe, at most 1
    double number, strength;
    struct ct_kkt_factor *factor;
    size_t nfactor, factor_cap;
};

struct ct_kkt_factor { // of L: row -= f * pivot's rows
    int row;
    ct_ex f[2];
};

/// DEGREE: least degree. ALONG: along the system, better for long chains, where least degree leaves
/// a dense rest. POSITIONS: least degree with ties in the order of positions, better for long
/// beams, where least degree couples distant nodes.
enum ct_kkt_order { CT_KKT_DEGREE, CT_KKT_ALONG, CT_KKT_POSITIONS, CT_KKT_NORDER };

/// Rows of M (n, both triangles) and J (m).
struct ct_kkt_system {
    struct ct_probed_row *M, *J;
    size_t n, m;
    double threshold;          // multipliers of pivots are at most 1/threshold, if possible
    const int *position_along; // along beams (n + m); NULL: there are none
};

/// Factors the system. x NULL: only the pattern and the probe values, to count operations. Returns
/// NULL if the system is singular at the state of the probe, takes `most` nodes of x (operations,
/// if x is NULL) or more, or lacks the positions that the order needs.
struct ct_kkt *ct_kkt_factor(struct ct_arena *a, struct ct_exs *x,
                             const struct ct_kkt_system *system, enum ct_kkt_order order,
                             double most);
/// y (n, out) for the right side b (n; overwritten).
void ct_kkt_solve(const struct ct_kkt *k, struct ct_exs *x, ct_ex *b, ct_ex *y);

#endif
