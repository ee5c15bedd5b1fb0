// Which speeds can share an entry of the mass matrix: those that move a common mass.
//
// The vector from ground to a mass is a sum of links, and the mass is moved by the clusters that turn
// one of them. Two rotations are coupled if a path from ground outwards meets both; a rotation is
// coupled with a slide if the slide lies on such a path.
#ifndef CT_FORMULATE_DYNAMICS_COUPLINGS_H
#define CT_FORMULATE_DYNAMICS_COUPLINGS_H

#include "formulate/dynamics/composite_sums.h"

struct ct_couplings;

struct ct_index_list {
    const int *index; // ascending
    size_t n;
};

/// Lives in the arena of the build. Cost: the number of couplings, times its logarithm.
const struct ct_couplings *ct_couplings_find(const struct ct_composite_sums *s);
/// Rotation axes of the clusters coupled with a cluster, its own included.
struct ct_index_list ct_couplings_axes(const struct ct_couplings *c, int cluster);
/// Anchors with slides that are coupled with a cluster.
struct ct_index_list ct_couplings_slides(const struct ct_couplings *c, int cluster);

#endif
