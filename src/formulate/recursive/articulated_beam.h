// Between the files of articulated bodies: what hangs on a member, and the elastic coordinates of
// beams.
//
// Elastic coordinates e of a beam move several members. Those that lie outboard of the base, and
// the base, are summed first: on the way inwards what hangs on a member also feels their
// accelerations, n, f += C e'', and its forces act on their rows,
//
//     M e'' + C' (al, a) + row = effort,    at a member they move by s:  M += s' I s + s' C + C' s,  row += s . f0,  C += I s
//
// and at the innermost of these members they are eliminated one by one, from the tip of the beam
// inwards. In a CHAIN an element moves with its own dofs and c, the foreshortening at its start
// (flexible_body.h), which is one more coordinate until all beyond it are eliminated; then c of the
// element before and g . dofs of that element are put in for it. So every element sees its
// neighbours only.
#ifndef CT_FORMULATE_RECURSIVE_ARTICULATED_BEAM_H
#define CT_FORMULATE_RECURSIVE_ARTICULATED_BEAM_H

#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/recursive/member.h"

enum { CT_SPATIAL_SIZE = 6 }; // Definition: al, a or n, f

/// A wrench n, f or a motion al, a.
struct ct_spatial_vector {
    ct_ex e[CT_SPATIAL_SIZE];
};

/// What hangs on a member, at its origin, in its axes (articulated_body.c).
struct ct_articulated_body {
    ct_ex33 J, B, M;
    ct_ex3 n, f;
    // of each freedom of a joint, in the order of elimination
    ct_ex G[CT_MAX_COORD][CT_SPATIAL_SIZE]; // P/D
    ct_ex u0[CT_MAX_COORD];                 // (effort - s . f0)/D
    ct_ex3 al, a;                           // accelerations
    struct ct_spatial_vector *C;            // of a beam's member, by elastic coordinate
};

/// Elastic coordinates of a beam (n), in a CHAIN also c of its elements, n + element, then its
/// freedoms that follow, and as many multipliers of the sums that they satisfy (beam_dynamics.h).
struct ct_articulated_beam {
    const struct ct_flexible *f;
    int n, nall, nfollow;
    bool is_augmented; // there are c
    bool
        follows; // what follows is eliminated with its multipliers; else it is known afterwards, as a sum
    int *number; // by speed: its place, or -1
    ct_ex *M;    // nall x nall, lower triangle; eliminated: entries over the pivot
    ct_ex *row;  // then what is left of the effort, over the pivot
    struct ct_spatial_vector *G; // C over the pivot
    ct_ex *a;                    // e''
    int *order, nstep;           // of elimination
    bool *is_done;               // by coordinate: eliminated; on the way back: known
};

struct ct_articulated {
    struct ct_build *b;
    struct ct_arena *work; // for what the solution does not need
    const struct ct_members *s;
    const ct_ex *effort;
    ct_ex *pivot;
    struct ct_articulated_body *body;
    struct ct_articulated_beam *elastic; // by beam
    ct_ex *M, *row; // of all beams alone, by speed: lower triangle (nu x nu), (nu)
};

/// Entry (i, j) of a body's matrix, its rows n, f and columns al, a.
ct_ex ct_articulated_entry(const struct ct_articulated_body *k, int i, int j);
void ct_articulated_set(struct ct_articulated_body *k, int i, int j, ct_ex v);
/// Component i of n, f.
ct_ex *ct_articulated_force(struct ct_articulated_body *k, int i);
ct_ex ct_screw_direction(const struct ct_screw *s, int i);
/// P = I s (out); returns D = s . P.
ct_ex ct_articulated_project(struct ct_articulated *w, const struct ct_articulated_body *k,
                             const struct ct_screw *s, ct_ex P[CT_SPATIAL_SIZE]);

/// Beam number i of w, empty.
void ct_articulated_beam_start(struct ct_articulated *w, size_t i);
/// Add what member i of a beam is and how its elastic coordinates move it; at the root eliminate
/// them.
void ct_articulated_beam_sum(struct ct_articulated *w, int i);
/// C on its way to the parent of member i, with the rows of what is known of the accelerations.
void ct_articulated_beam_hand(struct ct_articulated *w, int i);
/// The part of member i's acceleration that elastic coordinates give it, theirs into out by speed;
/// at the root theirs are found.
void ct_articulated_beam_accelerate(struct ct_articulated *w, int i, ct_ex *out);

#endif
