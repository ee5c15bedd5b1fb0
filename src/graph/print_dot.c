// A graph and its trees as Graphviz source; see print.h.
//
// Nodes are ranked from left to right by the translational tree, so that the picture grows from
// ground outwards; other edges do not rank. Graphviz ranks by the order in which an edge is
// written. A branch that points towards ground is therefore written parent first, with its arrow at
// the tail. In a large graph most edges would meet at ground: each edge to ground that is no
// translational branch gets a ground symbol of its own. In a deep tree the points of a body are
// stacked vertically, so that a body takes one column. Clusters around bodies are not used, because
// Graphviz drops edges that do not rank across clusters.
#include "graph/print.h"

static const int large_graph = 12; // Layout: nodes; a slider-crank with its arms has 8
// Layout: edges from ground; beyond, a row of nodes overflows a page
static const int deep_tree = 10;

// Style of an edge by the trees in which it is a branch; the meaning of quiet or marked edges
// depends on their kind. The colours are those of Okabe and Ito, which colour-blind readers can
// distinguish.
struct look {
    const char *meaning, *color, *style, *penwidth;
};

enum { BOTH, TRANS_ONLY, ROT_ONLY, CHORD, MARKED, QUIET, NLOOK };

static const struct look looks[NLOOK] = {
    [BOTH] = {"branch of both trees", "#000000", "solid", "2.6"},
    [TRANS_ONLY] = {"translation only", "#0072B2", "solid", "2.6"},
    [ROT_ONLY] = {"rotation only", "#D55E00", "solid", "2.6"},
    [CHORD] = {"chord of both", "#8C8C8C", "dashed", "1.1"},
    [MARKED] = {NULL, "#009E73", "solid", "2.0"},
    [QUIET] = {NULL, "#B4B4B4", "solid", "0.8"},
};

static int look_of(const struct ct_graph_view *view, int e)
{
    const bool T = view->T->is_branch[e], R = view->R->is_branch[e];
    if (T && R && view->names->is_marked && view->names->is_marked[e])
        return MARKED;
    if (T && R)
        return view->names->is_quiet && view->names->is_quiet[e] ? QUIET : BOTH;
    return T ? TRANS_ONLY : R ? ROT_ONLY : CHORD;
}

/// Print s inside an HTML-like label, which must not be empty; control characters become blanks.
static void print_escaped(FILE *out, const char *s)
{
    if (!*s)
        fputs("&#160;", out);
    for (; *s; s++) {
        const unsigned char c = (unsigned char)*s;
        if (c == '&')
            fputs("&amp;", out);
        else if (c == '<')
            fputs("&lt;", out);
        else if (c == '>')
            fputs("&gt;", out);
        else if (c == '"')
            fputs("&quot;", out);
        else if (c == '\\')
            fputs("&#92;", out);
        else
            fputc(c < 0x20 ? ' ' : c, out);
    }
}

/// first[NLOOK]: the first edge of each style, or -1.
static void find_looks(const struct ct_graph_view *view, int *first)
{
    for (int k = 0; k < NLOOK; k++)
        first[k] = -1;
    for (int e = view->g->nedge - 1; e >= 0; e--)
        first[look_of(view, e)] = e;
}

/// Print a legend of the styles that occur, as the label of the picture.
static void print_legend(FILE *out, const struct ct_graph_view *view)
{
    int first[NLOOK];
    find_looks(view, first);
    fprintf(out, "  label=<<table border=\"0\" cellspacing=\"6\"><tr>\n");
    for (int k = 0; k < NLOOK; k++) {
        if (first[k] < 0)
            continue;
        fprintf(out, "    <td><font color=\"%s\">%s</font> ", looks[k].color,
                k == CHORD ? "- - -" : "<b>&mdash;&mdash;</b>");
        print_escaped(out, !looks[k].meaning ? view->names->kind(view->names->data, first[k])
                                             : looks[k].meaning);
        fprintf(out, "</td>\n");
    }
    if (view->g->nnode > large_graph)
        fprintf(out, "    <td>small house: ground again</td>\n");
    fprintf(out, "  </tr></table>>\n");
}

static void print_nodes(FILE *out, const struct ct_graph_view *view)
{
    const struct ct_graph_names *names = view->names;
    for (int v = 0; v < view->g->nnode; v++) {
        fprintf(out, "  n%d [label=<", v);
        print_escaped(out, names->node(names->data, v));
        fprintf(out, ">%s]\n",
                v == 0 ? ", shape=house, fillcolor=\"#D9D9D9\", style=filled" : "");
    }
}

static void print_edge_label(FILE *out, const struct ct_graph_names *names, int e, int look)
{
    const char *const small = "<font point-size=\"8\" color=\"#777777\">";
    fprintf(out, "label=<%s%d ", look == QUIET ? small : "", e + 1);
    print_escaped(out, names->edge(names->data, e));
    if (look != QUIET) {
        fprintf(out, "<br/>%s", small);
        print_escaped(out, names->kind(names->data, e));
    }
    fprintf(out, "</font>>");
}

static bool is_deep(const struct ct_tree *t)
{
    return t->depth[t->order[t->nnode - 1]]
         > deep_tree; // breadth first: the last node is the deepest
}

/// Print node v as an end of edge e: the node itself, or a ground symbol of that edge.
static void print_end(FILE *out, int v, int e, bool own_ground)
{
    fprintf(out, "%c%d", own_ground && v == 0 ? 'g' : 'n', own_ground && v == 0 ? e : v);
}

static void print_edge(FILE *out, const struct ct_graph_view *view, int e)
{
    const bool large = view->g->nnode > large_graph;
    const struct ct_edge edge = view->g->edge[e];
    const bool is_branch = view->T->is_branch[e], back = view->T->parent_edge[edge.tail] == e;
    const bool own_ground = large && !is_branch && (edge.tail == 0 || edge.head == 0);
    const int look = look_of(view, e);

    if (own_ground)
        fprintf(out,
                "  g%d [label=\"\", shape=house, fillcolor=\"#D9D9D9\", style=filled, "
                "fixedsize=true, width=0.16, height=0.13]\n",
                e);
    fprintf(out, "  ");
    print_end(out, back ? edge.head : edge.tail, e, own_ground);
    fprintf(out, " -> ");
    print_end(out, back ? edge.tail : edge.head, e, own_ground);
    fprintf(out, " [");
    if (!large || look != QUIET) {
        print_edge_label(out, view->names, e, look);
        fprintf(out, ", ");
    }
    fprintf(out, "color=\"%s\", fontcolor=\"%s\", style=%s, penwidth=%s%s%s%s]\n",
            looks[look].color, looks[look].color, looks[look].style, looks[look].penwidth,
            back ? ", dir=back" : "", is_branch || own_ground ? "" : ", constraint=false",
            is_deep(view->T) && look == QUIET ? ", minlen=0" : "");
}

void ct_graph_print_dot(FILE *out, const struct ct_graph_view *view)
{
    fprintf(out, "digraph cotree {\n"
                 "  graph [rankdir=LR, fontname=\"Helvetica\", fontsize=11, labelloc=b,\n"
                 "    nodesep=0.35, ranksep=0.55]\n"
                 "  node [shape=box, style=\"rounded,filled\", fillcolor=\"#F4F7FA\", "
                 "color=\"#5A6772\",\n"
                 "    fontname=\"Helvetica\", fontsize=11, margin=\"0.09,0.04\", height=0.3]\n"
                 "  edge [fontname=\"Helvetica\", fontsize=10, arrowsize=0.7]\n");
    if (view->g->nedge > 0)
        print_legend(out, view);
    print_nodes(out, view);
    for (int e = 0; e < view->g->nedge; e++)
        print_edge(out, view, e);
    fprintf(out, "}\n");
}
