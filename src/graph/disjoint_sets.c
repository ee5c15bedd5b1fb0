// Disjoint sets with path halving; see disjoint_sets.h.
#include "graph/disjoint_sets.h"

void ct_disjoint_sets_init(struct ct_arena *a, int nnode, struct ct_disjoint_sets *p)
{
    *p = (struct ct_disjoint_sets){.nnode = nnode, .up = CT_NEWN(a, int, nnode)};
    ct_disjoint_sets_reset(p);
}

void ct_disjoint_sets_reset(struct ct_disjoint_sets *p)
{
    p->npiece = p->nnode;
    for (int v = 0; v < p->nnode; v++)
        p->up[v] = v;
}

int ct_disjoint_sets_find(struct ct_disjoint_sets *p, int v)
{
    while (p->up[v] != v)
        v = p->up[v] = p->up[p->up[v]];
    return v;
}

bool ct_disjoint_sets_union(struct ct_disjoint_sets *p, struct ct_edge edge)
{
    const int a = ct_disjoint_sets_find(p, edge.tail), b = ct_disjoint_sets_find(p, edge.head);
    if (a == b)
        return false;
    p->up[a < b ? b : a] = a < b ? a : b;
    p->npiece--;
    return true;
}
