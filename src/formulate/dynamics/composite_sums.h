// Composite sums: sums of lever arms, first moments and inertias over everything outboard of an
// anchor that rotates with a cluster. mass_matrix.c uses them and gives the formulas.
#ifndef CT_FORMULATE_DYNAMICS_COMPOSITE_SUMS_H
#define CT_FORMULATE_DYNAMICS_COMPOSITE_SUMS_H

#include "formulate/build.h"

/// The bodies outboard of an anchor that rotate with a cluster. Pairs without such bodies are not
/// listed, so that the cost of independent mechanisms adds up.
struct ct_composite_pair {
    int cluster;
    int next;     // next pair of the same anchor; -1: none
    int nturning; // number of augmented bodies with mass that rotate with the cluster
    int first_part, last_part; // first and last term of their sum; -1: none
    ct_ex3 g, h;               // lever arm and first moment; computed when needed
    bool has_g, has_h;
};

/// A term of such a sum: an augmented body of the anchor that rotates with the cluster, or (child
/// >= 0) the anchor at the end of one of its links.
struct ct_composite_part {
    int body, child, next;
};

struct ct_composite_sums {
    struct ct_build *b;
    int *nstar; // number of augmented bodies with mass outboard of an anchor
    struct ct_composite_pair *pair;
    size_t npair, pair_cap;
    struct ct_composite_part *part;
    size_t npart, part_cap;
    struct ct_pairs pair_of; // (anchor, cluster) -> number of the pair
    int *first_pair;         // by anchor; -1: none
    ct_ex3 *moment;          // by augmented body, ground components
    bool *has_moment;
    ct_ex3 *all; // by anchor: first moment of everything outboard
    bool *has_all;
    ct_ex33 *cross; // by anchor: inertia of its links with the first moments that they carry
    bool *has_cross;
    // by cluster: augmented inertia of it and its outboard clusters, ground components
    ct_ex33 *inertia;
    ct_ex33 *descendants; // the same of the outboard clusters alone
    int *first, *next;    // linked list of the augmented bodies of an anchor
    // start: by cluster, the anchor at which the sum of what rotates with it starts; -1: nothing
    // does
    int *start;
};

/// How much of what is outboard of an anchor rotates with a cluster.
enum ct_turning { CT_TURNS_NONE, CT_TURNS_SOME, CT_TURNS_ALL };

struct ct_composite_sums ct_composite_sums_create(struct ct_build *b);

enum ct_turning ct_composite_sums_turning(const struct ct_composite_sums *s, int anchor,
                                          int cluster);
/// The first term for an anchor and a cluster, an index in s->part; -1: none.
int ct_composite_sums_first_part(const struct ct_composite_sums *s, int anchor, int cluster);
bool ct_composite_sums_turns_with(const struct ct_composite_sums *s, int cluster,
                                  int star_cluster);

/// In ground components: the first moment of an augmented body; the vector from the parent of an
/// anchor to the anchor (planar: its in-plane part).
ct_ex3 ct_composite_sums_body_moment(struct ct_composite_sums *s, int body);
ct_ex3 ct_composite_sums_link(struct ct_composite_sums *s, int anchor);
/// Lever arm: sum of the vectors on the path to an anchor that rotate with a cluster.
ct_ex3 ct_composite_sums_lever_arm(struct ct_composite_sums *s, int anchor, int cluster);
/// First moments outboard of an anchor: of everything, and of what rotates with a cluster.
ct_ex3 ct_composite_sums_moment(struct ct_composite_sums *s, int anchor);
ct_ex3 ct_composite_sums_moment_turning(struct ct_composite_sums *s, int anchor, int cluster);
/// Adds to sum the inertia of everything that rotates with a cluster, about the point where its
/// rotating vectors start.
void ct_composite_sums_add_full(struct ct_composite_sums *s, int anchor, int cluster,
                                ct_ex33 *sum);

#endif
