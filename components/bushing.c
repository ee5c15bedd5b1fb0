// Bushing: springs and dampers against displacement and rotation of one frame in another.
//
//   through  F = -k d - c d', T = -k phi - c w       in axes of `from`, at the origin of `to`
//
// d is the position of `to` relative to `from`, d' its rate in these axes, phi the rotation vector
// (|phi| < pi), w the relative angular velocity. Source: formulation 7.3 for the rotation vector.
#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/constraint_row.h"

static const struct ct_key keys[] = {
    {"from", CT_VALUE_FRAME, CT_KEY_REQUIRED, NULL, 1, 1, "frame in whose axes it acts"},
    {"to", CT_VALUE_FRAME, CT_KEY_REQUIRED, NULL, 1, 1, "frame on whose origin it acts"},
    {"stiffness", CT_VALUE_LIST, 0, NULL, 6, 6,
     "three translational [N/m], three rotational [N*m/rad] (0)"},
    {"damping", CT_VALUE_LIST, 0, NULL, 6, 6,
     "three translational [N*s/m], three rotational [N*m*s/rad] (0)"},
};

static ct_ex3 three(const struct ct_instance *self, const char *key, int first)
{
    const struct ct_value *v = ct_instance_value(self, key);
    ct_ex3 e = {{{0}, {0}, {0}}};
    for (int i = 0; i < 3 && v->given; i++)
        e.e[i] = v->e[first + i];
    return e;
}

static ct_ex3 times(struct ct_exs *x, ct_ex3 a, ct_ex3 b)
{
    for (int i = 0; i < 3; i++)
        a.e[i] = ct_ex_mul(x, a.e[i], b.e[i]);
    return a;
}

// Rotation vector of R from its axial part s = sin(t) n and cosine c = (trace - 1)/2: phi =
// t/sin(t) s with t = atan2(|s|, c); near t = 0 the factor is its series 1 + |s|^2/6 + 3
// |s|^4/40.
static ct_ex3 rotation_vector(struct ct_exs *x, const ct_ex33 *R)
{
    const ct_ex3 s = {{ct_ex_scale(x, 0.5, ct_ex_sub(x, R->e[5], R->e[7])),
                       ct_ex_scale(x, 0.5, ct_ex_sub(x, R->e[6], R->e[2])),
                       ct_ex_scale(x, 0.5, ct_ex_sub(x, R->e[1], R->e[3]))}};
    const ct_ex c = ct_ex_scale(
        x, 0.5, ct_ex_sub(x, ct_ex_add(x, R->e[0], ct_ex_add(x, R->e[4], R->e[8])), CT_EX_ONE));
    const ct_ex s2 = ct_ex3_dot(x, s, s);
    // |s|^2. Derived: the next term of the series, 5/112 |s|^6, is below the unit round-off
    const double small = 1e-6;
    const ct_ex is_small = ct_ex_mul(x, ct_ex_fun2(x, CT_OP_LT, s2, ct_ex_const(x, small)),
                                     ct_ex_fun2(x, CT_OP_GT, c, CT_EX_ZERO));
    const ct_ex series = ct_ex_add(
        x, CT_EX_ONE,
        ct_ex_mul(x, s2, ct_ex_add(x, ct_ex_const(x, 1.0 / 6), ct_ex_scale(x, 3.0 / 40, s2))));
    const ct_ex sine = ct_ex_fun(x, CT_OP_SQRT, ct_ex_if(x, is_small, CT_EX_ONE, s2));
    const ct_ex exact = ct_ex_div(x, ct_ex_fun2(x, CT_OP_ATAN2, sine, c), sine);
    return ct_ex3_scale(x, ct_ex_if(x, is_small, series, exact), s);
}

static void apply(struct ct_build *b, const struct ct_instance *self)
{
    struct ct_exs *x = b->x;
    const int tail = b->topology->node_of_frame[self->from],
              head = b->topology->node_of_frame[self->to];
    const int from = b->kinematics->placement[tail].frame,
              to = b->kinematics->placement[head].frame;
    const ct_ex3 k = three(self, "stiffness", 0), kr = three(self, "stiffness", 3);
    const ct_ex3 c = three(self, "damping", 0), cr = three(self, "damping", 3);
    const ct_ex3 place = ct_path_position_in_tail(b, tail, head);
    const ct_ex3 rate = ct_path_velocity_in_tail(b, tail, head);
    const ct_ex3 w = ct_node_unturn(b, tail, ct_cluster_path_velocity(b, from, to));
    const ct_ex33 A = ct_node_rotation(b, tail), B = ct_node_rotation(b, head);
    const ct_ex33 T = ct_ex33_transpose(&A), R = ct_ex33_mul(x, &T, &B);
    const ct_ex3 phi = ct_ex3_is_zero(kr) ? kr : rotation_vector(x, &R);

    const ct_ex3 pull = times(x, k, place), drag = times(x, c, rate);
    const ct_ex3 twist = times(x, kr, phi), brake = times(x, cr, w);
    struct ct_load l = {.self = self, .tail = tail, .head = head};
    l.force = ct_node_turn(b, tail, ct_ex3_neg(x, ct_ex3_add(x, pull, drag)));
    l.torque = ct_node_turn(b, tail, ct_ex3_neg(x, ct_ex3_add(x, twist, brake)));
    l.power = ct_ex_neg(x, ct_ex_add(x, ct_ex3_dot(x, drag, rate), ct_ex3_dot(x, brake, w)));
    l.potential = ct_ex_scale(x, 0.5, ct_ex3_dot(x, pull, place));
    // the torque -k phi has the potential k |phi|^2/2 if k is isotropic; otherwise its work is
    // counted as power
    if (ct_ex_same(kr.e[0], kr.e[1]) && ct_ex_same(kr.e[1], kr.e[2]))
        l.potential = ct_ex_add(x, l.potential, ct_ex_scale(x, 0.5, ct_ex3_dot(x, twist, phi)));
    else
        l.power = ct_ex_sub(x, l.power, ct_ex3_dot(x, twist, w));
    ct_load_add(b, &l);
}

static bool signal(struct ct_build *b, const struct ct_instance *self, const char *name,
                   ct_ex *out)
{
    for (size_t i = 0; i < b->loads->nload; i++)
        if (b->loads->load[i].self == self)
            return ct_vector_signal(name, "force", b->loads->load[i].force, out)
                || ct_vector_signal(name, "torque", b->loads->load[i].torque, out);
    return false;
}

const struct ct_component_class ct_component_bushing = {
    .name = "bushing",
    .summary = "springs and dampers against displacement and rotation",
    .family = CT_FAMILY_FORCE,
    .key = keys,
    .nkey = COUNT(keys),
    .across = "free",
    .through = "F = -k*d - c*d', T = -k*phi - c*w in axes of `from`",
    .apply = apply,
    .signal = signal,
    .signals = "force.x, .y, .z and torque.x, .y, .z",
};
