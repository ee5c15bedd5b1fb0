// Composite sums, over what hangs on an anchor: what a spin of a cluster reaches, first moments,
// inertia. For mass_matrix.c, which says what they are for.
#ifndef CT_FORMULATE_DYNAMICS_COMPOSITE_SUMS_H
#define CT_FORMULATE_DYNAMICS_COMPOSITE_SUMS_H

#include "formulate/build.h"

/// What hangs on an anchor and turns with a cluster: pairs that have nothing in common are not
/// listed, so that mechanisms side by side cost as much as each alone.
struct ct_composite_pair {
    int cluster;
    int next;                  // pair of the same anchor; -1: none
    int nturning;              // augmented bodies with mass that turn with the cluster
    int first_part, last_part; // what they are the sum of; -1: nothing
    ct_ex3 g, h;               // reach and first moment; filled when first needed
    bool has_g, has_h;
};

/// A term of such a sum: an augmented body of the anchor that turns with the cluster, or (child >= 0)
/// an anchor behind one of its links.
struct ct_composite_part {
    int body, child, next;
};

struct ct_composite_sums {
    struct ct_build *b;
    int *nstar; // augmented bodies with mass outboard of an anchor
    struct ct_composite_pair *pair;
    size_t npair, pair_cap;
    struct ct_composite_part *part;
    size_t npart, part_cap;
    struct ct_pairs pair_of; // (anchor, cluster)
    int *first_pair;         // by anchor; -1: none
    ct_ex3 *moment;          // by augmented body, ground components
    bool *has_moment;
    ct_ex3 *all; // by anchor: first moments of everything outboard
    bool *has_all;
    ct_ex33 *cross; // by anchor: inertia of the links against what they carry
    bool *has_cross;
    ct_ex33 *inertia; // by cluster: augmented inertia of it and the clusters outboard, ground
    ct_ex33 *descendants; // the same of the clusters outboard alone
    int *first, *next;    // augmented bodies of an anchor, chained
    int *
        start; // by cluster: anchor from which on what turns with it is summed; -1: nothing does
};

/// How much of what hangs on an anchor turns with a cluster.
enum ct_turning { CT_TURNS_NONE, CT_TURNS_SOME, CT_TURNS_ALL };

struct ct_composite_sums ct_composite_sums_create(struct ct_build *b);

enum ct_turning ct_composite_sums_turning(const struct ct_composite_sums *s, int anchor,
                                          int cluster);
/// The first part of what hangs on an anchor and turns with a cluster, a number of s->part; -1: none.
int ct_composite_sums_first_part(const struct ct_composite_sums *s, int anchor, int cluster);
bool ct_composite_sums_turns_with(const struct ct_composite_sums *s, int cluster,
                                  int star_cluster);

/// In ground components: the first moment of an augmented body, and the vector from an anchor's parent to it, in its plane.
ct_ex3 ct_composite_sums_body_moment(struct ct_composite_sums *s, int star);
ct_ex3 ct_composite_sums_link(struct ct_composite_sums *s, int anchor);
/// Sum of the vectors on the path to an anchor that turn with a cluster.
ct_ex3 ct_composite_sums_reach(struct ct_composite_sums *s, int anchor, int cluster);
/// First moments outboard of an anchor: of everything, and of what turns with a cluster.
ct_ex3 ct_composite_sums_moment(struct ct_composite_sums *s, int anchor);
ct_ex3 ct_composite_sums_moment_turning(struct ct_composite_sums *s, int anchor, int cluster);
/// Inertia of everything that turns with a cluster, about the point where its vectors start: added to sum.
void ct_composite_sums_add_full(struct ct_composite_sums *s, int anchor, int cluster,
                                ct_ex33 *sum);

#endif
