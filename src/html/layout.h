// Computes positions of the vertices of a linear graph on a page.
//
// Distances on the page approximate path lengths in the graph (stress majorization), so that
// circuits look like loops. Source: Gansner, Koren and North (2005), Graph drawing by stress
// majorization.
#ifndef CT_HTML_LAYOUT_H
#define CT_HTML_LAYOUT_H

#include "graph/graph.h"

struct ct_place { // [px], y downwards
    double x, y;
};

/// at (nnode, out): positions with the centre at 0 and the larger extent along x. length
/// (nedge): wanted lengths of edges [px]. The same graph gives the same positions. Cost O(n^3).
void ct_layout_find(struct ct_arena *scratch, const struct ct_graph *g, const double *length,
                    struct ct_place *at);

#endif
