// See constraint_offset.h.
#include "formulate/kinematics/constraint_offset.h"
#include "formulate/kinematics/coordinate.h"

static void new_offset(struct ct_build *b, bool is_rotation)
{
    struct ct_equations *s = b->eqs;
    const struct ct_constraint_offset gap = {s->nmemory, is_rotation};
    CT_PUSH(b->arena, s->offset, s->noffset, s->offset_cap, gap);
}

ct_ex ct_constraint_offset_subtract(struct ct_build *b, const struct ct_edge_info *e, ct_ex phi)
{
    if (!b->options->has_offsets)
        return phi;
    new_offset(b, false);
    return ct_ex_sub(b->x, phi, ct_memory_keep(b, e->name, e->index, phi));
}

void ct_constraint_offset_rotate(struct ct_build *b, const struct ct_edge_info *e, int tail,
                                 int head, ct_ex3 *s, int n)
{
    if (!b->options->has_offsets || !n)
        return;
    const ct_ex33 A = ct_node_rotation(b, tail), B = ct_node_rotation(b, head);
    const ct_ex33 T = ct_ex33_transpose(&A), R = ct_ex33_mul(b->x, &T, &B);
    ct_ex33 kept;
    new_offset(b, true);
    for (int i = 0; i < 9; i++)
        kept.e[i] = ct_memory_keep(b, e->name, e->index, R.e[i]);
    for (int i = 0; i < n; i++)
        s[i] = ct_ex33_apply(b->x, &kept, s[i]);
}
