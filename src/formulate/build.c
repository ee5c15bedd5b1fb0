// See build.h.
#include "formulate/build.h"

#include <string.h>

ct_ex3 ct_build_in_plane(struct ct_build *b, ct_ex3 v)
{
    if (!b->topology->is_planar)
        return v;
    const ct_ex3 n = b->topology->plane[2];
    return ct_ex3_sub(b->x, v, ct_ex3_scale(b->x, ct_ex3_dot(b->x, n, v), n));
}

void ct_build_note_left_out(struct ct_build *b, const char *what, const char *why)
{
    const struct ct_left_out l = {what, why};
    CT_PUSH(b->arena, b->eqs->left_out, b->eqs->nleft_out, b->eqs->left_out_cap, l);
}

bool ct_build_is_small(const struct ct_build *b, const char *name, struct ct_mark *at)
{
    const struct ct_value *v = &b->model->simulation.small;
    for (size_t i = 0; v->given && i < v->n; i++)
        if (!strcmp(v->name[i], name)) {
            if (at)
                *at = v->at[i];
            return true;
        }
    return false;
}

bool ct_joint_is_active(const struct ct_instance *joint)
{
    static const char *const keys[] = {"stiffness", "damping", "effort", "motion"};
    for (size_t i = 0; i < COUNT(keys) && joint->cls->motion; i++)
        if (ct_instance_value(joint, keys[i])->given)
            return true;
    return false;
}
