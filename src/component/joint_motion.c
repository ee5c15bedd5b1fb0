// Building blocks of joint kinematics: axes, rotations, constraint rows, measures; see class.h.
#include "component/class.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

ct_ex3 ct_instance_axis(struct ct_exs *x, const struct ct_instance *self, const char *key,
                        int standard)
{
    const struct ct_value *v = ct_instance_value(self, key);
    double e[3] = {0};
    e[standard] = 1;
    return v->given ? (ct_ex3){{v->e[0], v->e[1], v->e[2]}} : ct_ex3_const(x, e);
}

const struct ct_motion *ct_motion_keep(struct ct_arena *a, const struct ct_motion *m)
{
    const size_t size
        = offsetof(struct ct_motion, measure) + (size_t)m->nmeasure * sizeof *m->measure;
    return memcpy(ct_arena_alloc(a, size), m, size);
}

void ct_motion_add_rotation(struct ct_motion *m, ct_ex3 axis, ct_ex angle)
{
    m->turn[m->nturn++] = (struct ct_turn){axis, angle};
}

void ct_motion_lock_translation(struct ct_exs *x, struct ct_motion *m)
{
    for (int i = 0; i < 3; i++) {
        double e[3] = {0};
        e[i] = 1;
        m->trans[i] = ct_ex3_const(x, e);
    }
    m->ntrans = 3;
}

void ct_motion_lock_rotation(struct ct_exs *x, struct ct_motion *m)
{
    for (int i = 0; i < 3; i++) {
        double s[3] = {0}, t[3] = {0};
        s[(i + 1) % 3] = 1;
        t[(i + 2) % 3] = 1;
        m->rot_from[i] = ct_ex3_const(x, s);
        m->rot_to[i] = ct_ex3_const(x, t);
    }
    m->nrot = 3;
}

void ct_motion_measure_length(struct ct_motion *m, ct_ex3 along)
{
    m->measure[m->nmeasure++] = (struct ct_measure){.kind = CT_MEASURE_LENGTH, .along = along};
}

void ct_motion_measure_angle(struct ct_motion *m, ct_ex3 n, ct_ex3 across)
{
    m->measure[m->nmeasure++] = (struct ct_measure){
        .kind = CT_MEASURE_ANGLE, .about = n, .v = across, .w = across, .from = n};
}

// e1 = the coordinate axis most nearly normal to n, made normal to n and of unit length; e2 = n x
// e1. The search starts after the axis nearest to n, so that z gives (x, y), x gives (y, z) and y
// gives (z, x).
void ct_axes_normal(struct ct_exs *x, ct_ex3 n, const double *value, ct_ex3 *e1, ct_ex3 *e2)
{
    double v[3];
    int along = 0;
    for (int i = 0; i < 3; i++) {
        v[i] = fabs(ct_ex_value(x, n.e[i], value));
        if (v[i] > v[along])
            along = i;
    }
    int best = (along + 1) % 3;
    if (v[(along + 2) % 3] < v[best])
        best = (along + 2) % 3;
    double axis[3] = {0};
    axis[best] = 1;
    const ct_ex3 e = ct_ex3_const(x, axis);
    const ct_ex3 across = ct_ex3_sub(x, e, ct_ex3_scale(x, n.e[best], n));
    const ct_ex length = ct_ex_fun(x, CT_OP_SQRT, ct_ex3_dot(x, across, across));
    for (int i = 0; i < 3; i++)
        e1->e[i] = ct_ex_div(x, across.e[i], length);
    *e2 = ct_ex3_cross(x, n, *e1);
}
