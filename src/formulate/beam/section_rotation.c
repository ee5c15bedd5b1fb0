#include "formulate/beam/section_rotation.h"

enum { X, Y, Z };

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

int ct_section_turns(const ct_ex angle[3], struct ct_section_turn turn[4])
{
    const bool both = !ct_ex_is_zero(angle[Y]) && !ct_ex_is_zero(angle[Z]);
    int n = 0;
    if (!ct_ex_is_zero(angle[Z]))
        turn[n++] = (struct ct_section_turn){Z, both ? 0.5 : 1};
    if (!ct_ex_is_zero(angle[Y]))
        turn[n++] = (struct ct_section_turn){Y, 1};
    if (both)
        turn[n++] = (struct ct_section_turn){Z, 0.5};
    if (!ct_ex_is_zero(angle[X]))
        turn[n++] = (struct ct_section_turn){X, 1};
    return n;
}

static ct_ex3 unit(struct ct_exs *x, int axis)
{
    double n[3] = {0};
    n[axis] = 1;
    return ct_ex3_const(x, n);
}

static ct_ex33 turned(struct ct_exs *x, const ct_ex33 *S, const struct ct_section_turn *t,
                      const ct_ex angle[3])
{
    const ct_ex by = ct_ex_scale(x, t->share, angle[t->axis]);
    const ct_ex33 R = ct_ex33_axis_angle(x, unit(x, t->axis), by);
    return ct_ex33_mul(x, S, &R);
}

ct_ex33 ct_section_axes(struct ct_exs *x, const ct_ex angle[3])
{
    struct ct_section_turn turn[4];
    const int n = ct_section_turns(angle, turn);
    ct_ex33 S = ct_ex33_identity();
    for (int i = 0; i < n; i++)
        S = turned(x, &S, &turn[i], angle);
    return S;
}

// S diag(j) S'
static ct_ex33 turned_inertia(struct ct_exs *x, const ct_ex33 *S, const ct_ex j[3])
{
    ct_ex33 J;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c <= r; c++) {
            ct_ex sum = CT_EX_ZERO;
            for (int k = 0; k < 3; k++) {
                const ct_ex both = ct_ex_mul(x, S->e[r + 3 * k], S->e[c + 3 * k]);
                sum = ct_ex_add(x, sum, ct_ex_mul(x, j[k], both));
            }
            J.e[r + 3 * c] = J.e[c + 3 * r] = sum;
        }
    return J;
}

void ct_section_motion(struct ct_exs *x, bool is_small, const ct_ex j[3], ct_ex3 angle,
                       ct_ex3 rate, struct ct_section *out)
{
    struct ct_section_turn turn[4];
    const int n = is_small ? 0 : ct_section_turns(angle.e, turn);
    ct_ex33 S = ct_ex33_identity();
    *out = (struct ct_section){.is_small = is_small, .relative_velocity = zero3, .bias = zero3};
    for (int i = 0; i < n; i++) {
        const struct ct_section_turn *t = &turn[i];
        const ct_ex3 axis = ct_ex33_apply(x, &S, unit(x, t->axis));
        const ct_ex3 about = ct_ex3_scale(x, ct_ex_const(x, t->share), axis);
        const ct_ex3 own = ct_ex3_scale(x, rate.e[t->axis], about);
        // previous rotations move the axis
        out->bias = ct_ex3_add(x, out->bias, ct_ex3_cross(x, out->relative_velocity, own));
        out->relative_velocity = ct_ex3_add(x, out->relative_velocity, own);
        out->rate_columns[t->axis] = ct_ex3_add(x, out->rate_columns[t->axis], about);
        S = turned(x, &S, t, angle.e);
    }
    for (int axis = 0; axis < 3 && is_small; axis++)
        out->rate_columns[axis] = unit(x, axis);
    if (is_small)
        out->relative_velocity = rate;
    out->J = turned_inertia(x, &S, j);
}

ct_ex3 ct_section_turned(struct ct_exs *x, const struct ct_section *s, ct_ex3 rate)
{
    ct_ex3 sum = zero3;
    for (int axis = 0; axis < 3; axis++)
        sum = ct_ex3_add(x, sum, ct_ex3_scale(x, rate.e[axis], s->rate_columns[axis]));
    return sum;
}

ct_ex3 ct_section_own(struct ct_exs *x, const struct ct_section *s, ct_ex3 w,
                      const ct_ex3 *second)
{
    ct_ex3 al = second ? ct_section_turned(x, s, *second) : zero3;
    if (s->is_small)
        return ct_ex33_apply(x, &s->J, al);
    al = ct_ex3_add(x, al, ct_ex3_add(x, s->bias, ct_ex3_cross(x, w, s->relative_velocity)));
    const ct_ex3 momentum = ct_ex33_apply(x, &s->J, ct_ex3_add(x, w, s->relative_velocity));
    return ct_ex3_add(x, ct_ex33_apply(x, &s->J, al),
                      ct_ex3_cross(x, s->relative_velocity, momentum));
}

ct_ex3 ct_section_on_angles(struct ct_exs *x, const struct ct_section *s, ct_ex3 w, ct_ex3 al,
                            const ct_ex3 *second)
{
    if (s->is_small)
        return ct_ex33_apply(x, &s->J,
                             second ? ct_ex3_add(x, al, ct_section_turned(x, s, *second)) : al);
    const ct_ex3 momentum = ct_ex33_apply(x, &s->J, ct_ex3_add(x, w, s->relative_velocity));
    ct_ex3 moment = ct_ex3_add(x, ct_ex33_apply(x, &s->J, al), ct_ex3_cross(x, w, momentum));
    moment = ct_ex3_add(x, moment, ct_section_own(x, s, w, second));
    ct_ex3 work;
    for (int axis = 0; axis < 3; axis++)
        work.e[axis] = ct_ex3_dot(x, s->rate_columns[axis], moment);
    return work;
}
