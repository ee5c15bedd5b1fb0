// Where masses are put while equations are made: on augmented bodies, into inertia tensors, into
// entries of the mass matrix.
#ifndef CT_FORMULATE_MASS_SUMS_H
#define CT_FORMULATE_MASS_SUMS_H

#include "formulate/build.h"

/// An anchor together with the cluster in which the vectors to its masses and next anchors are
/// fixed.
struct ct_augmented_body {
    int anchor, cluster;
    ct_ex3
        moment; // local: sum of mass * vector, of masses at it and of what hangs on its links [kg m]
    int first_child,
        nchild; // in b->dynamics.masses.child: anchors whose link belongs to the augmented body
};

/// The augmented body of an anchor and a cluster, made when first asked for.
struct ct_augmented_body *ct_augmented_body_of(struct ct_build *b, int anchor, int cluster);
/// m (v.v 1 - v v') added to a tensor.
void ct_inertia_add_point(struct ct_build *b, ct_ex33 *L, ct_ex m, ct_ex3 v);
/// A point mass at `local` from an anchor, in axes of the cluster that it turns with.
void ct_augmented_bodies_add_point(struct ct_build *b, int anchor, int cluster, ct_ex m,
                                   ct_ex3 local);
/// A mass at an anchor whose first moment and inertia (both local) turn with a cluster.
void ct_augmented_bodies_add(struct ct_build *b, int anchor, int cluster, ct_ex m,
                             ct_ex3 moment, const ct_ex33 *inertia);
/// Add v to entry (i, j) of the lower triangle M (nu x nu), whichever of i and j is larger.
void ct_mass_add_entry(struct ct_build *b, ct_ex *M, int i, int j, ct_ex v);
/// m between two motions, spread over the unknowns they belong to, added to the lower triangle M
/// (nu x nu).
void ct_mass_spread(struct ct_build *b, ct_ex *M, const struct ct_term *p, int np,
                    const struct ct_term *q, int nq, ct_ex m);

#endif
