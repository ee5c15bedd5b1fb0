// Universal joint: rotation about an axis a of `from`, then about an axis b of `to`.
//
//   across   d = 0, S = Rot(a, q1) Rot(b, q2)      2 angles [rad]
//   through  T along a and b follow the efforts     F and one torque are reactions
//
// Speeds of a chord: w = a u1 + b u2 with c = a . b constant, so
// u1 = (a - c b) . w / (1 - c^2) and u2 = (b - c a) . w / (1 - c^2).
#include "component/class.h"

static const struct ct_key keys[] = {
    {"axes", CT_VALUE_AXES, 0, "", 6, 6,
     "first axis, fixed in `from`, and second, fixed in `to` (x, y)"},
};

static void motion(struct ct_exs *x, const struct ct_instance *self, struct ct_motion *m)
{
    const struct ct_value *axes = ct_instance_value(self, "axes");
    const double ex[3] = {1, 0, 0}, ey[3] = {0, 1, 0};
    ct_ex3 a = ct_ex3_const(x, ex), b = ct_ex3_const(x, ey);
    if (axes->given) {
        a = (ct_ex3){{axes->e[0], axes->e[1], axes->e[2]}};
        b = (ct_ex3){{axes->e[3], axes->e[4], axes->e[5]}};
    }
    ct_motion_add_rotation(m, a, m->coord[0]);
    ct_motion_add_rotation(m, b, m->coord[1]);
    ct_motion_lock_translation(x, m);
    m->nrot = 1;
    m->rot_from[0] = a;
    m->rot_to[0] = b;

    const ct_ex c = ct_ex3_dot(x, a, b);
    const ct_ex s2 = ct_ex_sub(x, CT_EX_ONE, ct_ex_mul(x, c, c));
    const ct_ex direct = ct_ex_div(x, CT_EX_ONE, s2),
                crossed = ct_ex_neg(x, ct_ex_div(x, c, s2));
    m->nmeasure = 2;
    m->measure[0] = (struct ct_measure){.kind = CT_MEASURE_ANGLE,
                                        .about = a,
                                        .v = b,
                                        .w = b,
                                        .from = ct_ex3_scale(x, direct, a),
                                        .to = ct_ex3_scale(x, crossed, b)};
    m->measure[1] = (struct ct_measure){.kind = CT_MEASURE_ANGLE,
                                        .reversed = true,
                                        .about = b,
                                        .v = a,
                                        .w = a,
                                        .from = ct_ex3_scale(x, crossed, a),
                                        .to = ct_ex3_scale(x, direct, b)};
}

const struct ct_component_class ct_component_universal = {
    .name = "universal",
    .summary = "rotation about two axes through one point",
    .family = CT_FAMILY_JOINT,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "d = 0, S = Rot(a, q1) Rot(b, q2)",
    .through = "a.T and b.T follow the effort laws; F and (a x b).T are reactions",
    .ncoord = 2,
    .nfree = 2,
    .motion = motion,
};
