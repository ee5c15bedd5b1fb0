// Disjoint sets with path halving; see pieces.h.
#include "graph/pieces.h"

void ct_pieces_init(struct ct_arena *a, int nnode, struct ct_pieces *p)
{
    *p = (struct ct_pieces){.nnode = nnode, .up = CT_NEWN(a, int, nnode)};
    ct_pieces_reset(p);
}

void ct_pieces_reset(struct ct_pieces *p)
{
    p->npiece = p->nnode;
    for (int v = 0; v < p->nnode; v++)
        p->up[v] = v;
}

int ct_pieces_find(struct ct_pieces *p, int v)
{
    while (p->up[v] != v)
        v = p->up[v] = p->up[p->up[v]];
    return v;
}

bool ct_pieces_join(struct ct_pieces *p, struct ct_edge edge)
{
    const int a = ct_pieces_find(p, edge.tail), b = ct_pieces_find(p, edge.head);
    if (a == b)
        return false;
    p->up[a < b ? b : a] = a < b ? a : b;
    p->npiece--;
    return true;
}
