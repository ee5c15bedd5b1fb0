// See gap.h.
#include "formulate/gap.h"
#include "formulate/row.h"

static void new_gap(struct ct_build *b, bool is_rotation)
{
    struct ct_equations *s = b->eqs;
    const struct ct_gap gap = {s->nmemory, is_rotation};
    CT_PUSH(b->arena, s->gap, s->ngap, s->gap_cap, gap);
}

ct_ex ct_gap_number(struct ct_build *b, const struct ct_edge_info *e, ct_ex phi)
{
    if (!b->has_gaps)
        return phi;
    new_gap(b, false);
    return ct_ex_sub(b->x, phi, ct_row_keep(b, e->name, e->index, phi));
}

void ct_gap_turn(struct ct_build *b, const struct ct_edge_info *e, int tail, int head,
                 ct_ex3 *s, int n)
{
    if (!b->has_gaps || !n)
        return;
    const ct_ex33 A = ct_node_rotation(b, tail), B = ct_node_rotation(b, head);
    const ct_ex33 T = ct_ex33_transpose(&A), R = ct_ex33_mul(b->x, &T, &B);
    ct_ex33 kept;
    new_gap(b, true);
    for (int i = 0; i < 9; i++)
        kept.e[i] = ct_row_keep(b, e->name, e->index, R.e[i]);
    for (int i = 0; i < n; i++)
        s[i] = ct_ex33_apply(b->x, &kept, s[i]);
}
