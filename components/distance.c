// Distance joint: a massless rod of fixed length between two points.
//
//   across   |d| = length                          1 constraint [m]
//   through  force along d                         1 reaction [N]
//
// Row (|d|^2 - L^2)/(2 L), so that the multiplier is the force in the rod. Source: formulation 4.2.
#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/constraint_row.h"

static const struct ct_key keys[] = {
    {"length", CT_VALUE_SCALAR, 0, "m", 1, 1, "length of the rod (the distance at the start)"},
};

static void apply(struct ct_build *b, const struct ct_instance *self)
{
    struct ct_exs *x = b->x;
    const int tail = b->topology->node_of_frame[self->from],
              head = b->topology->node_of_frame[self->to];
    const struct ct_value *length = ct_instance_value(self, "length");
    const ct_ex3 zero = {{{0}, {0}, {0}}};
    const ct_ex3 d = ct_path_position(b, tail, head), v = ct_path_velocity(b, tail, head);
    const ct_ex square = ct_ex3_dot(x, d, d);
    const ct_ex L = length->given ? length->e[0]
                                  : ct_row_offset(b, self, ct_ex_fun(x, CT_OP_SQRT, square));
    const ct_ex phi
        = ct_ex_div(x, ct_ex_sub(x, square, ct_ex_mul(x, L, L)), ct_ex_scale(x, 2, L));
    const ct_ex gam
        = ct_ex_div(x,
                    ct_ex_add(x, ct_ex3_dot(x, d, ct_path_acceleration(b, tail, head, CT_BIAS)),
                              ct_ex3_dot(x, v, v)),
                    L);
    struct ct_wrench w = {zero, zero};
    for (int i = 0; i < 3; i++)
        w.force.e[i] = ct_ex_div(x, d.e[i], L);
    ct_row_add(b, self, "length", tail, head, &w, false, phi, gam);
}

const struct ct_component_class ct_component_distance = {
    .name = "distance",
    .summary = "a massless rod of fixed length between two points",
    .family = CT_FAMILY_JOINT,
    .key = keys,
    .nkey = COUNT(keys),
    .is_moment_free = true,
    .across = "|d| = length",
    .through = "F along d is the reaction; T = 0",
    .apply = apply,
};
