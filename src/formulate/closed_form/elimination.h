// Symbolic elimination for systems with loops. This folder derives accelerations, multipliers and
// projection steps of a closed system as expressions: by coordinate partitioning (6.2) or as one
// symmetric system, with a fixed order of pivots.
//
//     J_d = L U in blocks of one or two rows      B = -J_d^-1 J_i,   J_d c = -gam
//     (B' M B) z = B' (Q - M c)                   u' = [B; 1] z + [c; 0],   J_d' lam = (M u' - Q)_d
//
// Each entry has its value at one state, the numeric probe, in addition to its expression. The next
// pivot is the cheapest one that is large enough there. Two rows of one joint form a 2 x 2 pivot if
// possible: its determinant in a planar loop does not depend on the orientation of the loop, while
// a single entry can become zero.
//
// Source: pivots by least cost with a threshold, Markowitz (1957), key markowitz1957; the same in
// blocks, Duff, Erisman and Reid (2017), key duff2017; refinement, Skeel (1980), key skeel1980.
#ifndef CT_FORMULATE_CLOSED_FORM_ELIMINATION_H
#define CT_FORMULATE_CLOSED_FORM_ELIMINATION_H

#include "formulate/equations.h"
#include "formulate/closed_form/kkt.h"

/// Pivots below this part of the largest entry of their rows are not used: where the order of pivots
/// is found others are taken, if there are any; in a run the solution is found in another way. As
/// many digits may be lost as the reciprocal has.
/// Default: digits against operations and the time of dense matrices. Test: partition_conditioning
#define CT_LEAST_STRENGTH 1e-3

/// The partition: kept rows (rank), as many dependent columns, and the independent columns (nfree).
struct ct_partition_sets {
    const int *row, *dependent, *independent;
    size_t rank, nfree;
    const struct ct_pivot_order *pivots; // NULL: find it when needed
    bool has_no_pivots;                  // no such order exists
    // by symbol, at the state of the probe; NULL: no augmented form of beams
    const double *value;
};

/// Order of elimination of all equations as one system: (nu + rank) rows and columns in the order
/// of the pivots, which are then on the diagonal or next to it.
struct ct_pivot_order {
    int *row, *column; // NULL: only the augmented system has few enough operations
    // is_augmented: the order and the operation count are those of beam_augmented.h
    bool is_augmented;
    enum ct_kkt_order way;
    // operation count of the solution with the pivots of J_d, without M, Q, J and gam. It includes
    // the difference in cost between M_c, J_c and M, J
    double operations;
};

struct ct_closed {
    size_t rank, npivot, nfree, nB;
    int *row;     // kept rows, ascending: lam has their order
    ct_ex *pivot; // of each block of J_d that is not constant: an entry, or a determinant
    // scale: pivot times scale is its size relative to the largest entries of its rows, at most 1
    double *scale;
    ct_ex *inertia;  // pivots of B' M B (nfree), positive; as one system: none
    ct_ex *B;        // its structurally nonzero entries; as one system: none
    ct_ex *a, *lam;  // u' (nu), multipliers (rank)
    ct_ex *residual; // M u' - Q - J' lam, J u' + gam  (nu + rank)
    ct_ex *better_a, *better_lam, *better_residual; // after one step of refinement
    ct_ex *dq, *du, *shift; // d, e, f of (6.3b) (nu, zero for independent speeds)
    size_t nshift;          // nu; 0: f is not derived, because there are redundant rows
};

/// Accelerations by coordinate partitioning, or from [M J'; J 0] as one system (kkt.h), in the
/// augmented form of beam_augmented.h if that is shorter. Both use J_d for projections.
enum ct_closed_way { CT_CLOSED_PARTITION, CT_CLOSED_KKT };

/// Derives the solution into x, a copy of e->x, with at most most_nodes new nodes. M (nM), J (nJ):
/// values of e->M, e->J at the state of the probe. The result lives in a. NULL if J_d is singular
/// there or the node limit is reached.
struct ct_closed *ct_closed_derive(struct ct_arena *a, struct ct_exs *x,
                                   const struct ct_equations *e,
                                   const struct ct_partition_sets *p, const double *M,
                                   const double *J, enum ct_closed_way way, size_t most_nodes);
/// Finds the order from the patterns and the values at the state of the probe. The result lives in
/// a. NULL if the system is singular or takes more than `most` operations.
struct ct_pivot_order *ct_pivot_order_find(struct ct_arena *a, const struct ct_equations *e,
                                           const struct ct_partition_sets *p, const double *M,
                                           const double *J, double most);

#endif
