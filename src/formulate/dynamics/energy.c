// See energy.h.
#include "formulate/dynamics/energy.h"
#include "formulate/signals/momentum.h"

#include "formulate/beam/flexible_body.h"
#include "formulate/beam/stiffness.h"
#include "formulate/beam_dynamics/beam_dynamics.h"

// Returns twice the kinetic energy of a beam and adds its potential and strain energy.
static ct_ex beam_energies(struct ct_build *b, struct ct_flexible *f)
{
    struct ct_exs *x = b->x;
    const struct ct_flexible_state s = ct_flexible_momentum(b, f);
    b->eqs->strain = ct_ex_add(x, b->eqs->strain, ct_flexible_strain(b, f));
    b->eqs->potential = ct_ex_sub(
        x, b->eqs->potential,
        ct_ex3_dot(x, b->model->gravity, ct_beam_total_vector(b, f, CT_SUM_CENTRE)));
    return s.twice_kinetic;
}

// Weighted sum of squares of the relative speeds of all joints and of the elastic speeds of beams.
// It does not depend on the trees.
static ct_ex continuous_speeds(struct ct_build *b)
{
    // Weight of elastic speeds, so large that they change only where joints alone cannot close a
    // loop. Then the number of elements does not matter. Derived: masses and lengths of joints
    // differ by less than a million.
    const double share_of_beams = 1e6;
    struct ct_exs *x = b->x;
    const struct ct_equations *e = b->eqs;
    ct_ex joints = CT_EX_ZERO, beams = CT_EX_ZERO;
    for (size_t i = 0; i < b->model->njoint; i++) {
        const struct ct_instance *self = &b->model->joint[i];
        for (int k = 0;
             k < self->nfree && self->from >= 0 && b->topology->edge_of_joint[i] >= 0; k++) {
            const int first = b->topology->edge[b->topology->edge_of_joint[i]].first_coordinate;
            const ct_ex u = ct_coordinate_speed(b, first + k);
            joints = ct_ex_add(x, joints, ct_ex_mul(x, u, u));
        }
    }
    for (size_t i = 0; i < e->nu; i++)
        if (e->u[i].beam)
            beams = ct_ex_add(x, beams, ct_ex_mul(x, e->u[i].symbol, e->u[i].symbol));
    return ct_ex_scale(x, 0.5, ct_ex_add(x, joints, ct_ex_scale(x, share_of_beams, beams)));
}

void ct_energies_derive(struct ct_build *b)
{
    struct ct_exs *x = b->x;
    struct ct_equations *e = b->eqs;
    ct_ex kinetic = CT_EX_ZERO;
    for (size_t i = 0; i < b->nflexible; i++)
        kinetic = ct_ex_add(x, kinetic, beam_energies(b, &b->flexible[i]));
    e->power = ct_ex_add(x, e->power, ct_flexible_dissipation(b));
    for (size_t i = 1; i < b->model->nbody; i++) {
        const struct ct_body *body = &b->model->body[i];
        const int node = b->topology->node_of_com[i];
        if (body->beam)
            continue;
        const ct_ex3 v = ct_node_velocity(b, node);
        const ct_ex weight = ct_ex_mul(
            x, body->mass, ct_ex3_dot(x, b->model->gravity, ct_node_position(b, node)));
        kinetic = ct_ex_add(x, kinetic, ct_ex_mul(x, body->mass, ct_ex3_dot(x, v, v)));
        kinetic = ct_ex_add(
            x, kinetic,
            ct_ex3_dot(x, ct_cluster_velocity(b, b->kinematics->placement[node].frame),
                       ct_body_angular_momentum(b, i)));
        e->potential = ct_ex_sub(x, e->potential, weight);
    }
    e->kinetic = ct_ex_scale(x, 0.5, kinetic);
    e->continuity = b->model->simulation.rate_jumps == CT_RATE_CONTINUOUS ? continuous_speeds(b)
                                                                          : CT_EX_ZERO;
    for (size_t i = 0; i < b->topology->ncoordinate; i++) {
        const struct ct_coordinate *c = &b->kinematics->coordinate[i];
        if (c->driver < 0)
            continue;
        struct ct_driver *d = &e->driver[c->driver];
        d->effort = ct_driver_effort(b, (int)i);
        e->power = ct_ex_add(x, e->power, ct_ex_mul(x, d->effort, d->rate));
    }
    e->work_symbol = ct_ex_sym(x, CT_SYM_WORK, "work", 0);
    if (ct_ex_is_zero(e->power))
        e->work_symbol = CT_EX_ZERO;
    const ct_ex stored = ct_ex_add(x, e->kinetic, ct_ex_add(x, e->potential, e->strain));
    e->total = ct_ex_sub(x, stored, e->work_symbol);
}
