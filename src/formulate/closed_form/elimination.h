// Accelerations of a closed system in closed form: embedding, (6.2), unrolled along a fixed order
// of pivots.
//
//     J_d = L U in blocks of one or two rows      B = -J_d^-1 J_i,   J_d c = -gam
//     (B' M B) z = B' (Q - M c)                   u' = [B; 1] z + [c; 0],   J_d' lam = (M u' - Q)_d
//
// Every entry carries its value at one state, a numeric probe, beside its expression: pivots are
// taken where they cost least among those that are large enough there. Two rows of one joint go
// together where they can: the determinant of a planar loop does not care how the loop is turned,
// while a single entry passes through zero.
//
// Source: pivots by least cost with a threshold, Markowitz (1957), key markowitz1957; the same in
// blocks, Duff, Erisman and Reid (2017), key duff2017; refinement, Skeel (1980), key skeel1980.
#ifndef CT_FORMULATE_CLOSED_FORM_ELIMINATION_H
#define CT_FORMULATE_CLOSED_FORM_ELIMINATION_H

#include "formulate/equations.h"
#include "formulate/closed_form/kkt.h"

/// What is eliminated: kept rows (rank), as many dependent columns, and the other columns (nfree).
struct ct_partition_sets {
    const int *row, *dependent, *independent;
    size_t rank, nfree;
    const struct ct_pivot_order *pivots; // NULL: it is made where it is needed, unless
    bool has_no_pivots;                  // there is none
    const double *value; // by symbol, at the state of the probe; NULL: beams are not carried
};

/// How all equations would be eliminated as one system, (nu + rank) rows and columns in the order
/// of its pivots, so that these are on the diagonal or next to it. NULL: it is singular.
struct ct_pivot_order {
    int *row, *column; // NULL: only the system with more unknowns takes few enough operations
    bool
        is_augmented; // with the starts of elements as unknowns (beam_augmented.h): way and operations are of that
    enum ct_kkt_order way;
    // of the solution, the pivots of J_d included; M, Q, J, gam not, but for what M_c and J_c take
    // more or less than M and J
    double operations;
};

struct ct_closed {
    size_t rank, npivot, nfree, nB;
    int *row;     // kept rows, ascending: what lam counts by
    ct_ex *pivot; // of each block of J_d that is not constant: an entry, or a determinant
    double *
        scale; // pivot to strength: its size against the largest entries of its rows, 1 at most
    ct_ex *inertia;  // pivots of B' M B (nfree), positive; as one system: none
    ct_ex *B;        // its entries that are not zero by structure; as one system: none
    ct_ex *a, *lam;  // u' (nu), multipliers (rank)
    ct_ex *residual; // M u' - Q - J' lam, J u' + gam  (nu + rank)
    ct_ex *better_a, *better_lam, *better_residual; // after one step of refinement
    ct_ex *dq, *du, *shift; // d, e, f of (6.3b) (nu, zero in the independent places)
    size_t nshift;          // nu; 0: there are redundant rows, and f is not found
};

/// Accelerations by coordinate partitioning, as above, or from [M J'; J 0] as one system (kkt.h),
/// where it is shorter that of beam_augmented.h. Projections take J_d in both.
enum ct_closed_way { CT_CLOSED_PARTITION, CT_CLOSED_KKT };

/// Derive into x, a copy of e->x, with at most so many new nodes. M (nM), J (nJ): values of e->M,
/// e->J at the state of the probe. The result lives in a. NULL if J_d is singular there or the
/// nodes do not suffice.
struct ct_closed *ct_closed_derive(struct ct_arena *a, struct ct_exs *x,
                                   const struct ct_equations *e,
                                   const struct ct_partition_sets *p, const double *M,
                                   const double *J, enum ct_closed_way way, size_t most_nodes);
/// By patterns and numbers at the state of the probe; in a. NULL if the system is singular or takes more than `most` operations.
struct ct_pivot_order *ct_pivot_order_find(struct ct_arena *a, const struct ct_equations *e,
                                           const struct ct_partition_sets *p, const double *M,
                                           const double *J, double most);

#endif
