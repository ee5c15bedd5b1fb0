// Printing of a graph and its two trees: as text, as Graphviz source (dot) and as JSON.
//
// The caller supplies the names, so nothing here knows what an edge represents. Names are UTF-8 and
// may contain any character; each format escapes what it must. What always holds: the same graph,
// trees and names give the same bytes.
#ifndef CT_GRAPH_PRINT_H
#define CT_GRAPH_PRINT_H

#include "graph/graph.h"

#include <stdio.h>

struct ct_graph_names {
    const char *(*node)(void *data, int v);
    const char *(*edge)(void *data, int e);
    const char *(*kind)(void *data, int e); // what the edge is, in one word
    void *data;
    const int *weight_trans, *weight_rot; // per edge; NULL: not shown
    const bool *is_quiet;  // per edge: thin line if a branch of both trees; may be NULL
    const bool *is_marked; // per edge: colour of its own if a branch of both trees; may be NULL
};

/// What is printed: the graph, its trees of translation and rotation, and the names.
struct ct_graph_view {
    const struct ct_graph *g;
    const struct ct_tree *T, *R;
    const struct ct_graph_names *names;
};

/// Tables of nodes and edges, the incidence matrix where it fits, and the cutset and circuit
/// equations in the style of formulation (3.4). Equations beyond the first 60 of a kind are
/// counted, not printed; if both trees are the same, so are the equations, and they are printed
/// once.
void ct_graph_print(FILE *out, struct ct_arena *scratch, const struct ct_graph_view *view);

/// Graphviz source: branches solid, chords dashed, colour by tree, legend below. In graphs of more
/// than 12 nodes, quiet edges have no names, and ground is drawn again at each edge that meets it.
void ct_graph_print_dot(FILE *out, const struct ct_graph_view *view);

/// One object: nodes (id 0: ground), edges (ids from 1), and for each tree its cutsets and
/// circuits by edge id. Edges have the same numbers in all three formats.
void ct_graph_print_json(FILE *out, struct ct_arena *scratch, const struct ct_graph_view *view);

#endif
