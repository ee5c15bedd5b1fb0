// The linear graph of a model: nodes, edges, coordinates, and whether all stays in a plane.
#ifndef CT_FORMULATE_TOPOLOGY_H
#define CT_FORMULATE_TOPOLOGY_H

#include "formulate/build.h"

/// Nodes, edges and coordinates of b->model; planar mechanisms are recognised when allowed.
bool ct_topology_derive(struct ct_build *b, bool planar_allowed);

/// Motion of an edge for the coordinates in m->coord.
void ct_topology_motion(struct ct_build *b, const struct ct_edge_info *e, struct ct_motion *m);

/// Note what the equations leave out and why.
void ct_topology_left_out(struct ct_build *b, const char *what, const char *why);

#endif
