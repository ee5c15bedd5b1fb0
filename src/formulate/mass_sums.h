// Functions that add masses to augmented bodies, to inertia tensors and to entries of the mass
// matrix.
#ifndef CT_FORMULATE_MASS_SUMS_H
#define CT_FORMULATE_MASS_SUMS_H

#include "expr/symmetric.h"
#include "formulate/build.h"

/// Augmented body: an anchor and a cluster in which the vectors to its masses and to the next
/// anchors are fixed.
struct ct_augmented_body {
    int anchor, cluster;
    // moment: local first moment of its masses and of the masses outboard of its links [kg m]
    ct_ex3 moment;
    // entries of b->dynamics.masses.child: anchors whose link belongs to the augmented body
    int first_child, nchild;
};

/// The augmented body of an anchor and a cluster; created at the first call.
struct ct_augmented_body *ct_augmented_body_of(struct ct_build *b, int anchor, int cluster);
/// Adds m (v.v 1 - v v') to a tensor.
void ct_inertia_add_point(struct ct_build *b, ct_ex33 *L, ct_ex m, ct_ex3 v);
/// Adds a point mass at the vector `local` from an anchor, in axes of the cluster.
void ct_augmented_bodies_add_point(struct ct_build *b, int anchor, int cluster, ct_ex m,
                                   ct_ex3 local);
/// Adds a mass at an anchor with first moment and inertia (both local) fixed in the cluster.
void ct_augmented_bodies_add(struct ct_build *b, int anchor, int cluster, ct_ex m,
                             ct_ex3 moment, const ct_ex33 *inertia);
/// Adds m times the product of two sums of terms to M (nu x nu).
void ct_mass_spread(struct ct_build *b, struct ct_symmetric *M, const struct ct_term *p, int np,
                    const struct ct_term *q, int nq, ct_ex m);

#endif
