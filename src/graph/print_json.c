// A graph and its trees as JSON; see print.h.
#include "graph/print.h"

/// Print s as a JSON string. UTF-8 is copied; quotes, backslashes and control characters are
/// escaped as RFC 8259 demands.
static void print_string(FILE *out, const char *s)
{
    fputc('"', out);
    for (; *s; s++) {
        const unsigned char c = (unsigned char)*s;
        if (c == '"' || c == '\\')
            fprintf(out, "\\%c", c);
        else if (c < 0x20)
            fprintf(out, "\\u%04x", c);
        else
            fputc(c, out);
    }
    fputc('"', out);
}

static void print_member(FILE *out, const char *key, const char *value)
{
    fprintf(out, ", \"%s\": ", key);
    print_string(out, value);
}

/// Separator after element i of n.
static const char *separator(int i, int n)
{
    return i + 1 < n ? "," : "";
}

static void print_nodes(FILE *out, const struct ct_graph_view *view)
{
    const int n = view->g->nnode;
    fprintf(out, "  \"nodes\": [\n");
    for (int v = 0; v < n; v++) {
        fprintf(out, "    {\"id\": %d", v);
        print_member(out, "name", view->names->node(view->names->data, v));
        fprintf(out, "}%s\n", separator(v, n));
    }
    fprintf(out, "  ],\n");
}

static const char *truth(bool b)
{
    return b ? "true" : "false";
}

static void print_edges(FILE *out, const struct ct_graph_view *view)
{
    const struct ct_graph_names *names = view->names;
    const int n = view->g->nedge;
    fprintf(out, "  \"edges\": [\n");
    for (int e = 0; e < n; e++) {
        fprintf(out, "    {\"id\": %d", e + 1);
        print_member(out, "name", names->edge(names->data, e));
        print_member(out, "kind", names->kind(names->data, e));
        fprintf(out, ", \"tail\": %d, \"head\": %d", view->g->edge[e].tail,
                view->g->edge[e].head);
        if (names->weight_trans)
            fprintf(out, ", \"weight_translation\": %d", names->weight_trans[e]);
        if (names->weight_rot)
            fprintf(out, ", \"weight_rotation\": %d", names->weight_rot[e]);
        fprintf(out, ", \"branch_translation\": %s, \"branch_rotation\": %s}%s\n",
                truth(view->T->is_branch[e]), truth(view->R->is_branch[e]), separator(e, n));
    }
    fprintf(out, "  ],\n");
}

/// Print the rows of a cutset or circuit matrix: own edge, edges of the sum and their signs.
static void print_rows(FILE *out, struct ct_arena *scratch, const char *key,
                       const char *own_key, const struct ct_incidence *S, const int *own)
{
    struct ct_incidence St;
    ct_incidence_transpose(scratch, S, &St);
    fprintf(out, "    \"%s\": [\n", key);
    for (int i = 0; i < S->nrow; i++) {
        const int end = St.start[i + 1];
        fprintf(out, "      {\"%s\": %d, \"edges\": [", own_key, own[i] + 1);
        for (int k = St.start[i]; k < end; k++)
            fprintf(out, "%d%s", St.row[k] + 1, k + 1 < end ? ", " : "], \"signs\": [");
        for (int k = St.start[i]; k < end; k++)
            fprintf(out, "%d%s", St.value[k], k + 1 < end ? ", " : "]}");
        fprintf(out, "%s\n", separator(i, S->nrow));
    }
    fprintf(out, "    ]");
}

static void print_tree(FILE *out, struct ct_arena *scratch, const struct ct_graph_view *view,
                       const struct ct_tree *t, const char *key)
{
    struct ct_incidence Af, Bf;
    ct_cutsets_derive(scratch, view->g, t, &Af);
    ct_circuits_derive(scratch, view->g, t, &Bf);
    fprintf(out, "  \"%s\": {\n", key);
    print_rows(out, scratch, "cutsets", "branch", &Af, t->branch);
    fprintf(out, ",\n");
    print_rows(out, scratch, "circuits", "chord", &Bf, t->chord);
    fprintf(out, "\n  }");
}

void ct_graph_print_json(FILE *out, struct ct_arena *scratch, const struct ct_graph_view *view)
{
    fprintf(out, "{\n");
    print_nodes(out, view);
    print_edges(out, view);
    print_tree(out, scratch, view, view->T, "translation");
    fprintf(out, ",\n");
    print_tree(out, scratch, view, view->R, "rotation");
    fprintf(out, "\n}\n");
}
