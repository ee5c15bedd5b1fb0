// Fundamental circuits by the path method of formulation 3.2: no elimination, no arithmetic.
//
// Both ends of a chord are followed up to their common ancestor. Let sg(v) = +1 where the parent
// edge of v points away from ground. The entry of B_t is then -sg on the way up from the head and
// +sg on the way down to the tail.
#include "graph/graph.h"

static int common_ancestor(const struct ct_tree *t, int a, int b)
{
    while (a != b) {
        if (t->depth[a] >= t->depth[b])
            a = t->parent[a];
        else
            b = t->parent[b];
    }
    return a;
}

int ct_tree_circuit(const struct ct_graph *g, const struct ct_tree *t, int e, int *branch,
                    signed char *sign)
{
    const int tail = g->edge[e].tail, head = g->edge[e].head;
    const int top = common_ancestor(t, tail, head);
    const int nup = t->depth[head] - t->depth[top];
    const int n = nup + t->depth[tail] - t->depth[top];

    for (int v = head, k = 0; v != top; v = t->parent[v], k++) {
        branch[k] = t->parent_edge[v];
        sign[k] = (signed char)-t->sign[v];
    }
    // the path down to the tail is found from its end, so it is filled backwards
    for (int v = tail, k = n - 1; v != top; v = t->parent[v], k--) {
        branch[k] = t->parent_edge[v];
        sign[k] = (signed char)t->sign[v];
    }
    return n;
}

/// Entries in each column of B_f, counted into start[e + 1].
static void count_columns(const struct ct_graph *g, const struct ct_tree *t, int *branch,
                          signed char *sign, int *start)
{
    for (int k = 0; k < t->nchord; k++) {
        const int n = ct_tree_circuit(g, t, t->chord[k], branch, sign);
        start[t->chord[k] + 1]++;
        for (int i = 0; i < n; i++)
            start[branch[i] + 1]++;
    }
}

void ct_circuits_derive(struct ct_arena *a, const struct ct_graph *g, const struct ct_tree *t,
                        struct ct_incidence *Bf)
{
    int *branch = CT_NEWN(a, int, t->nbranch), *start = CT_NEWN(a, int, g->nedge + 1);
    signed char *sign = CT_NEWN(a, signed char, t->nbranch);
    count_columns(g, t, branch, sign, start);

    int *next = ct_incidence_create(a, t->nchord, g->nedge, start, Bf);
    for (int k = 0; k < t->nchord; k++) { // ascending: the rows of a column come out sorted
        const int c = t->chord[k], n = ct_tree_circuit(g, t, c, branch, sign);
        Bf->row[next[c]] = k;
        Bf->value[next[c]++] = 1;
        for (int i = 0; i < n; i++) {
            Bf->row[next[branch[i]]] = k;
            Bf->value[next[branch[i]]++] = sign[i];
        }
    }
}

void ct_incidence_derive(struct ct_arena *a, const struct ct_graph *g, struct ct_incidence *A)
{
    int *start = CT_NEWN(a, int, g->nedge + 1);
    for (int e = 0; e < g->nedge; e++)
        start[e + 1] = (g->edge[e].head != 0) + (g->edge[e].tail != 0);
    int *next = ct_incidence_create(a, g->nnode - 1, g->nedge, start, A);
    for (int e = 0; e < g->nedge; e++) {
        const int head = g->edge[e].head, tail = g->edge[e].tail;
        const int first = head < tail ? head : tail, second = head < tail ? tail : head;
        for (int i = 0; i < 2; i++) { // rows in order
            const int v = i ? second : first;
            if (v == 0)
                continue;
            A->row[next[e]] = v - 1;
            A->value[next[e]++] = v == head ? 1 : -1;
        }
    }
}
