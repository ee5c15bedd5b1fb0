// Sparsity pattern of the mass matrix: two speeds are coupled if they move a common mass.
//
// The vector from ground to a mass is a sum of links. The clusters that rotate one of these links
// move the mass. Two rotations are coupled if one path from ground outwards contains links that
// rotate with each. A rotation and a translation are coupled if such a path contains the
// translation.
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
/// Anchors with translation axes that are coupled with a cluster.
struct ct_index_list ct_couplings_slides(const struct ct_couplings *c, int cluster);

#endif
