// See momentum.h.
#include "formulate/signals/momentum.h"

#include "formulate/beam_dynamics/beam_dynamics.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

static ct_ex3 body_momentum(struct ct_build *b, size_t i)
{
    return ct_ex3_scale(b->x, b->model->body[i].mass,
                        ct_node_velocity(b, b->topology->node_of_com[i]));
}

ct_ex3 ct_body_angular_momentum(struct ct_build *b, size_t i)
{
    const struct ct_body *body = &b->model->body[i];
    const int node = b->topology->node_of_com[i];
    if (body->is_particle)
        return zero3;
    const ct_ex *I = body->inertia;
    const ct_ex33 own = {{I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2]}};
    const ct_ex3 w
        = ct_node_unturn(b, node, ct_cluster_velocity(b, b->kinematics->placement[node].frame));
    return ct_node_turn(b, node, ct_ex33_apply(b->x, &own, w));
}

ct_ex3 ct_beam_total_vector(struct ct_build *b, struct ct_flexible *f,
                            enum ct_system_total property)
{
    struct ct_exs *x = b->x;
    ct_flexible_inertia_derive(b, f);
    const struct ct_flexible_state s = ct_flexible_momentum(b, f);
    const ct_ex3 r = ct_node_position(b, f->base);
    if (property == CT_SUM_CENTRE)
        return ct_ex3_add(x, ct_ex3_scale(x, s.mass, r), s.moment);
    return property == CT_SUM_MOMENTUM
             ? s.momentum
             : ct_ex3_add(x, ct_ex3_cross(x, r, s.momentum), s.angular_momentum);
}

ct_ex3 ct_system_total_vector(struct ct_build *b, enum ct_system_total property)
{
    struct ct_exs *x = b->x;
    ct_ex3 sum = zero3;
    ct_ex mass = CT_EX_ZERO;
    for (size_t i = 1; i < b->model->nbody; i++) {
        const ct_ex3 r = ct_node_position(b, b->topology->node_of_com[i]);
        const ct_ex m = b->model->body[i].mass;
        struct ct_flexible *f = ct_flexible_of(b, (int)i);
        mass = ct_ex_add(x, mass, m);
        if (f) {
            sum = ct_ex3_add(x, sum, ct_beam_total_vector(b, f, property));
            continue;
        }
        if (property == CT_SUM_CENTRE)
            sum = ct_ex3_add(x, sum, ct_ex3_scale(x, m, r));
        else if (property == CT_SUM_MOMENTUM)
            sum = ct_ex3_add(x, sum, body_momentum(b, i));
        else
            sum = ct_ex3_add(x, sum,
                             ct_ex3_add(x, ct_ex3_cross(x, r, body_momentum(b, i)),
                                        ct_body_angular_momentum(b, i)));
    }
    for (int i = 0; i < 3 && property == CT_SUM_CENTRE; i++)
        sum.e[i] = ct_ex_div(x, sum.e[i], mass);
    return sum;
}
