// The linear graph of a model: nodes, edges, coordinates, and whether all stays in a plane.
#ifndef CT_FORMULATE_TOPOLOGY_LINEAR_GRAPH_H
#define CT_FORMULATE_TOPOLOGY_LINEAR_GRAPH_H

#include "formulate/build.h"

/// b->topology of b->model, and the list of its coordinates; planar mechanisms are recognised when
/// allowed.
void ct_linear_graph_derive(struct ct_build *b, bool planar_allowed);

/// Motion of an edge for the coordinates in m->coord.
void ct_linear_graph_edge_motion(struct ct_build *b, const struct ct_edge_info *e,
                                 struct ct_motion *m);

/// Where this is allowed and every joint keeps to one plane: b->topology->is_planar, and b->topology->plane, its axes e1, e2 and normal n in
/// components of ground; else n is the third of ground. After the coordinates of joints.
void ct_planarity_detect(struct ct_build *b, struct ct_topology *t, bool allowed);

/// Name of direction i of the plane, 0 to 2 (of ground, where all may leave it): "x", "y", "z" along an axis of ground,
/// else "e1", "e2", "e3".
const char *ct_plane_axis_name(const struct ct_build *b, int i);

#endif
