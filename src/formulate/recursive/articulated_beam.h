// Internal data of the articulated-body method: the articulated inertia of a member and the elastic
// coordinates of beams.
//
// Elastic coordinates e of a beam move several members. The recursion therefore first keeps them as
// unknowns. The wrench of a member contains their accelerations, n, f += C e'', and its inertia
// forces enter their rows,
//
//     M e'' + C' (al, a) + row = effort
//     M += s' I s + s' C + C' s,  row += s . f0,  C += I s     at a member that e moves along s
//
// At the innermost of these members they are eliminated one by one, from the tip of the beam
// inwards. In a CHAIN an element moves with its own dofs and with c, the foreshortening at its
// start (flexible_body.h). c is an additional unknown until everything beyond it is eliminated.
// Then it is replaced by c of the previous element plus g . dofs of that element. So each element
// is coupled with its neighbours only.
#ifndef CT_FORMULATE_RECURSIVE_ARTICULATED_BEAM_H
#define CT_FORMULATE_RECURSIVE_ARTICULATED_BEAM_H

#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/recursive/member.h"

enum { CT_SPATIAL_SIZE = 6 }; // Definition: al, a or n, f

/// A wrench n, f or a motion al, a.
struct ct_spatial_vector {
    ct_ex e[CT_SPATIAL_SIZE];
};

/// Articulated body of a member, at its origin, in its axes (articulated_body.c).
struct ct_articulated_body {
    ct_ex33 J, B, M;
    ct_ex3 n, f;
    // for each joint coordinate, in the order of elimination
    ct_ex G[CT_MAX_COORD][CT_SPATIAL_SIZE]; // P/D
    ct_ex u0[CT_MAX_COORD];                 // (effort - s . f0)/D
    ct_ex3 al, a;                           // accelerations
    struct ct_spatial_vector *C;            // for a member of a beam, by elastic coordinate
};

/// Unknowns of a beam in the elimination: its n elastic coordinates; in a CHAIN c of each element,
/// n + element; then its condensed rotations and as many multipliers of their equilibrium equations
/// (static_condensation.h).
struct ct_articulated_beam {
    const struct ct_flexible *f;
    int n, nall, ncondensed;
    bool is_augmented; // c of the elements are unknowns
    // has_condensed_rotations: condensed rotations are eliminated with their multipliers; else they are computed
    // afterwards
    bool has_condensed_rotations;
    int *number;                 // by speed: its index, or -1
    struct ct_symmetric M;       // between unknowns; after elimination divided by the pivot
    ct_ex *row;                  // right side; after elimination divided by the pivot
    struct ct_spatial_vector *G; // C over the pivot
    ct_ex *a;                    // e''
    int *order, nstep;           // of elimination
    bool *is_done;               // by unknown: eliminated; in back substitution: known
};

struct ct_articulated {
    struct ct_build *b;
    struct ct_arena *work; // temporary memory
    const struct ct_members *s;
    const ct_ex *effort;
    ct_ex *pivot;
    struct ct_articulated_body *body;
    struct ct_articulated_beam *elastic; // by beam
    ct_ex *row;                          // of the beams alone, by speed
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

/// Initialises beam number i of w.
void ct_articulated_beam_start(struct ct_articulated *w, size_t i);
/// Adds the inertia of member i of a beam and its motion by elastic coordinates. Eliminates them at
/// the root.
void ct_articulated_beam_sum(struct ct_articulated *w, int i);
/// Transforms C to the parent of member i and adds known accelerations to the rows.
void ct_articulated_beam_transfer(struct ct_articulated *w, int i);
/// Adds the elastic part of the acceleration of member i. At the root it finds the elastic
/// accelerations; they are stored in out by speed.
void ct_articulated_beam_accelerate(struct ct_articulated *w, int i, ct_ex *out);

#endif
