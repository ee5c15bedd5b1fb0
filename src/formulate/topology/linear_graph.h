// The topology of a model. This folder builds the linear graph (frames as nodes, components as
// edges), finds planar mechanisms and chooses the two spanning trees. This file: the graph.
#ifndef CT_FORMULATE_TOPOLOGY_LINEAR_GRAPH_H
#define CT_FORMULATE_TOPOLOGY_LINEAR_GRAPH_H

#include "formulate/build.h"

/// Derives b->topology from b->model, with the list of coordinates. Planar mechanisms are detected
/// if allowed.
void ct_linear_graph_derive(struct ct_build *b, bool planar_allowed);

/// Motion of an edge as a function of the coordinates in m->coord.
void ct_linear_graph_edge_motion(struct ct_build *b, const struct ct_edge_info *e,
                                 struct ct_motion *m);

/// Detects a planar mechanism, if allowed: sets is_planar if all joints move parallel to one plane,
/// and plane: its axes e1, e2 and normal n in ground components. Otherwise n is the z axis of
/// ground. Needs the coordinates of joints.
void ct_planarity_detect(struct ct_build *b, struct ct_topology *t, bool allowed);

/// Name of direction i of the plane (of ground, for spatial mechanisms), i = 0 to 2: "x", "y", "z"
/// along a ground axis, else "e1", "e2", "e3".
const char *ct_plane_axis_name(const struct ct_build *b, int i);

#endif
