// A graph and its trees as readable text; see print.h.
#include "graph/print.h"

#include <stdarg.h>
#include <string.h>

// Layout: [columns] wider lines are wrapped, wider matrices are not printed
static const int page_width = 100;
static const int max_equations = 60; // Layout: of each kind

// ---- columns ------------------------------------------------------------------------------

/// Width of a UTF-8 string in columns: its number of code points.
static int width_of(const char *s)
{
    int n = 0;
    for (; *s; s++)
        n += ((unsigned char)*s & 0xC0) != 0x80;
    return n;
}

/// Print s, padded with spaces to `width` columns.
static void print_left(FILE *out, const char *s, int width)
{
    fprintf(out, "%s%*s", s, width > width_of(s) ? width - width_of(s) : 0, "");
}

static void print_right(FILE *out, const char *s, int width)
{
    fprintf(out, "%*s%s", width > width_of(s) ? width - width_of(s) : 0, "", s);
}

static int widest(const char *(*name)(void *data, int i), void *data, int n, const char *head)
{
    int width = width_of(head);
    for (int i = 0; i < n; i++)
        if (width_of(name(data, i)) > width)
            width = width_of(name(data, i));
    return width;
}

// ---- nodes and edges ----------------------------------------------------------------------

static void print_nodes(FILE *out, const struct ct_graph_view *view)
{
    fprintf(out, "nodes\n");
    for (int v = 0; v < view->g->nnode; v++)
        fprintf(out, "  %3d  %s\n", v, view->names->node(view->names->data, v));
}

/// Weight and role of edge e in one tree.
static void print_role(FILE *out, const struct ct_tree *t, const int *weight, int e)
{
    if (weight && weight[e] >= 0)
        fprintf(out, "  %6d", weight[e]);
    else
        fprintf(out, "  %6s", "-");
    fprintf(out, "  %s", t->is_branch[e] ? "branch" : "chord");
}

static void print_edges(FILE *out, const struct ct_graph_view *view)
{
    const struct ct_graph_names *names = view->names;
    const int nedge = view->g->nedge, nnode = view->g->nnode;
    const int edge = widest(names->edge, names->data, nedge, "name");
    const int kind = widest(names->kind, names->data, nedge, "kind");
    const int node = widest(names->node, names->data, nnode, "from");

    fprintf(out, "\nedges\n%*s  translation     rotation\n", edge + kind + 2 * node + 13, "");
    fprintf(out, "    #  %-*s  %-*s  %-*s    %-*s  weight  tree    weight  tree\n", edge,
            "name", kind, "kind", node, "from", node, "to");
    for (int e = 0; e < nedge; e++) {
        fprintf(out, "  %3d  ", e + 1);
        print_left(out, names->edge(names->data, e), edge);
        fprintf(out, "  ");
        print_left(out, names->kind(names->data, e), kind);
        fprintf(out, "  ");
        print_left(out, names->node(names->data, view->g->edge[e].tail), node);
        fprintf(out, " -> ");
        print_left(out, names->node(names->data, view->g->edge[e].head), node);
        print_role(out, view->T, names->weight_trans, e);
        fprintf(out, "%*s", view->T->is_branch[e] ? 0 : 1,
                ""); // "chord" is one letter shorter than "branch"
        print_role(out, view->R, names->weight_rot, e);
        fprintf(out, "\n");
    }
}

// ---- the incidence matrix -----------------------------------------------------------------

/// Heading of column e: the name of the edge or, to save width, its number (in text[12]).
static const char *column_head(const struct ct_graph_names *names, int e, bool by_number,
                               char text[12])
{
    if (!by_number)
        return names->edge(names->data, e);
    snprintf(text, 12, "%d", e + 1);
    return text;
}

static int column_width(const struct ct_graph_names *names, int e, bool by_number)
{
    char text[12];
    const int width = width_of(column_head(names, e, by_number, text));
    return width > 2 ? width : 2;
}

static int matrix_width(const struct ct_graph_view *view, int left, bool by_number)
{
    for (int e = 0; e < view->g->nedge; e++)
        left += 1 + column_width(view->names, e, by_number);
    return left;
}

static int incidence(struct ct_edge edge, int v)
{
    return (edge.head == v) - (edge.tail == v);
}

static void print_matrix(FILE *out, const struct ct_graph_view *view)
{
    const struct ct_graph_names *names = view->names;
    const int left = 2 + widest(names->node, names->data, view->g->nnode, "");
    const bool by_number = matrix_width(view, left, false) > page_width;
    fprintf(out, "\nincidence (1 at the head of an edge, -1 at its tail; ground left out)\n");
    if (by_number && matrix_width(view, left, true) > page_width) {
        fprintf(out, "  too wide to print: %d edges\n", view->g->nedge);
        return;
    }
    fprintf(out, "%*s", left, "");
    for (int e = 0; e < view->g->nedge; e++) {
        char text[12];
        fprintf(out, " ");
        print_right(out, column_head(names, e, by_number, text),
                    column_width(names, e, by_number));
    }
    fprintf(out, "\n");
    for (int v = 1; v < view->g->nnode; v++) {
        fprintf(out, "  ");
        print_left(out, names->node(names->data, v), left - 2);
        for (int e = 0; e < view->g->nedge; e++) {
            static const char *const entry[] = {"-1", ".", "1"};
            fprintf(out, " %*s", column_width(names, e, by_number),
                    entry[1 + incidence(view->g->edge[e], v)]);
        }
        fprintf(out, "\n");
    }
}

// ---- equations ----------------------------------------------------------------------------

// A line that is wrapped between terms.
struct line {
    FILE *out;
    int column;
};

static void print_term(struct line *l, const char *sign, const char *name)
{
    const int width = width_of(sign) + width_of(name);
    if (l->column + width > page_width) {
        fprintf(l->out, "\n       ");
        l->column = 7;
    }
    fprintf(l->out, "%s%s", sign, name);
    l->column += width;
}

/// Print one row of a cutset or circuit matrix (column i of its transpose St), its own edge first.
static void print_equation(FILE *out, const struct ct_incidence *St, int i, int own,
                           const struct ct_graph_names *names)
{
    struct line l = {out, 0};
    print_term(&l, "    ", names->edge(names->data, own));
    for (int k = St->start[i]; k < St->start[i + 1]; k++)
        if (St->row[k] != own)
            print_term(&l, St->value[k] > 0 ? " + " : " - ",
                       names->edge(names->data, St->row[k]));
    print_term(&l, " = ", "0");
    fprintf(out, "\n");
}

static void print_rows(FILE *out, struct ct_arena *scratch, const struct ct_incidence *S,
                       const int *own, const struct ct_graph_names *names)
{
    struct ct_incidence St;
    ct_incidence_transpose(scratch, S, &St);
    const int n = S->nrow > max_equations ? max_equations : S->nrow;
    for (int i = 0; i < n; i++)
        print_equation(out, &St, i, own[i], names);
    if (S->nrow == 0)
        fprintf(out, "    none\n");
    if (S->nrow > n)
        fprintf(out, "    ... and %d more\n", S->nrow - n);
}

static void print_equations(FILE *out, struct ct_arena *scratch,
                            const struct ct_graph_view *view, const struct ct_tree *t,
                            const char *title)
{
    struct ct_incidence Af, Bf;
    ct_cutsets_derive(scratch, view->g, t, &Af);
    ct_circuits_derive(scratch, view->g, t, &Bf);
    fprintf(out, "\n%s\n  cutsets, for through variables, one per branch\n", title);
    print_rows(out, scratch, &Af, t->branch, view->names);
    fprintf(out, "  circuits, for across variables, one per chord\n");
    print_rows(out, scratch, &Bf, t->chord, view->names);
}

void ct_graph_print(FILE *out, struct ct_arena *scratch, const struct ct_graph_view *view)
{
    const size_t size = (size_t)view->g->nedge * sizeof(bool);
    fprintf(out,
            "linear graph: %d nodes, %d edges; each tree has %d branches and %d chords\n\n",
            view->g->nnode, view->g->nedge, view->T->nbranch, view->T->nchord);
    print_nodes(out, view);
    print_edges(out, view);
    print_matrix(out, view);
    if (size == 0 || memcmp(view->T->is_branch, view->R->is_branch, size) == 0) {
        print_equations(out, scratch, view, view->T, "translation and rotation: the same tree");
        return;
    }
    print_equations(out, scratch, view, view->T, "translation");
    print_equations(out, scratch, view, view->R, "rotation");
}
