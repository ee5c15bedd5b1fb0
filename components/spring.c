// Spring and damper along the line between two points.
//
//   through  F = -n (k (|d| - length) + c |d|'),  n = d/|d|        [N]
//
// Source: formulation 1.4.
#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/constraint_row.h"

#include <string.h>

static const struct ct_key keys[] = {
    {"from", CT_VALUE_FRAME, CT_KEY_REQUIRED, NULL, 1, 1, "frame of one end"},
    {"to", CT_VALUE_FRAME, CT_KEY_REQUIRED, NULL, 1, 1, "frame of the other end"},
    {"stiffness", CT_VALUE_SCALAR, 0, "N/m", 1, 1, "stiffness (0)"},
    {"length", CT_VALUE_SCALAR, 0, "m", 1, 1, "length without force (0)"},
    {"damping", CT_VALUE_SCALAR, 0, "N*s/m", 1, 1, "damping along the line (0)"},
};

static ct_ex given(const struct ct_instance *self, const char *key)
{
    const struct ct_value *v = ct_instance_value(self, key);
    return v->given ? v->e[0] : CT_EX_ZERO;
}

// Length, rate of length, tension; d is the vector from one end to the other.
struct state {
    ct_ex3 d;
    ct_ex length, rate, stretch, drag, tension;
};

static struct state find_state(struct ct_build *b, const struct ct_instance *self)
{
    struct ct_exs *x = b->x;
    const int tail = b->topology->node_of_frame[self->from],
              head = b->topology->node_of_frame[self->to];
    struct state s = {.d = ct_path_position(b, tail, head)};
    s.length = ct_ex_fun(x, CT_OP_SQRT, ct_ex3_dot(x, s.d, s.d));
    s.stretch = ct_ex_sub(x, s.length, given(self, "length"));
    s.rate = ct_ex_div(x, ct_ex3_dot(x, s.d, ct_path_velocity(b, tail, head)), s.length);
    s.drag = ct_ex_mul(x, given(self, "damping"), s.rate);
    s.tension = ct_ex_add(x, ct_ex_mul(x, given(self, "stiffness"), s.stretch), s.drag);
    return s;
}

static void apply(struct ct_build *b, const struct ct_instance *self)
{
    struct ct_exs *x = b->x;
    const struct state s = find_state(b, self);
    struct ct_load l = {.self = self,
                        .tail = b->topology->node_of_frame[self->from],
                        .head = b->topology->node_of_frame[self->to],
                        .is_central = true};
    // with zero natural length the force is k d, and the length is not needed
    const ct_ex per_length
        = ct_ex_is_zero(given(self, "length")) && ct_ex_is_zero(given(self, "damping"))
            ? given(self, "stiffness")
            : ct_ex_div(x, s.tension, s.length);
    l.force = ct_ex3_neg(x, ct_ex3_scale(x, per_length, s.d));
    l.potential = ct_ex_scale(
        x, 0.5, ct_ex_mul(x, given(self, "stiffness"), ct_ex_mul(x, s.stretch, s.stretch)));
    l.power = ct_ex_neg(x, ct_ex_mul(x, s.drag, s.rate));
    ct_load_add(b, &l);
}

static bool signal(struct ct_build *b, const struct ct_instance *self, const char *name,
                   ct_ex *out)
{
    const struct state s = find_state(b, self);
    const char *const names[] = {"force", "length", "rate"};
    const ct_ex values[] = {s.tension, s.length, s.rate};
    for (int i = 0; i < 3; i++)
        if (!strcmp(name, names[i])) {
            *out = values[i];
            return true;
        }
    return false;
}

const struct ct_component_class ct_component_spring = {
    .name = "spring",
    .summary = "spring and damper along the line between two points",
    .family = CT_FAMILY_FORCE,
    .key = keys,
    .nkey = COUNT(keys),
    .is_moment_free = true,
    .across = "free",
    .through = "F = -(stiffness*(|d| - length) + damping*|d|')*d/|d|, T = 0",
    .apply = apply,
    .signal = signal,
    .signals = "force, length and rate",
};
