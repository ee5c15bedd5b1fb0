// Where the vertices of a linear graph stand on a page.
//
// Distances on the page follow those along edges (stress majorization), so that circuits look like loops.
// Source: Gansner, Koren and North (2005), Graph drawing by stress majorization.
#ifndef CT_HTML_LAYOUT_H
#define CT_HTML_LAYOUT_H

#include "graph/graph.h"

struct ct_place { // [px], y downwards
    double x, y;
};

/// at (nnode, out); length (nedge): wanted of edges [px]. The centre is at 0, the longer extent lies across. The same graph gives the
/// same places. Cost O(n^3).
void ct_layout_find(struct ct_arena *scratch, const struct ct_graph *g, const double *length,
                    struct ct_place *at);

#endif
