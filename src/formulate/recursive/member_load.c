// Inertia of members and loads on them; see member.h.
#include "formulate/recursive/member_internal.h"

#include "formulate/beam_dynamics/beam_dynamics.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- inertia ------------------------------------------------------------------------------------

static void add_tensor(struct ct_build *b, ct_ex33 *sum, const ct_ex33 *A)
{
    for (int i = 0; i < 9; i++)
        sum->e[i] = ct_ex_add(b->x, sum->e[i], A->e[i]);
}

// Adds 2 (d.h) 1 - d h' - h d': the change of inertia by a first moment h at d; with h = m d/2 that
// of a point mass m.
static void add_arm(struct ct_build *b, ct_ex33 *J, ct_ex3 d, ct_ex3 h)
{
    struct ct_exs *x = b->x;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const ct_ex other
            = ct_ex_add(x, ct_ex_mul(x, d.e[j], h.e[j]), ct_ex_mul(x, d.e[k], h.e[k]));
        const ct_ex cross
            = ct_ex_add(x, ct_ex_mul(x, d.e[i], h.e[j]), ct_ex_mul(x, h.e[i], d.e[j]));
        J->e[i + 3 * i] = ct_ex_add(x, J->e[i + 3 * i], ct_ex_scale(x, 2, other));
        J->e[i + 3 * j] = ct_ex_sub(x, J->e[i + 3 * j], cross);
        J->e[j + 3 * i] = ct_ex_sub(x, J->e[j + 3 * i], cross);
    }
}

// Adds mass m, first moment h and inertia J about a point at v from the origin of the member.
static void add_inertia(struct ct_member_build *w, int member, ct_ex3 v, ct_ex mass, ct_ex3 h,
                        const ct_ex33 *J)
{
    struct ct_exs *x = w->b->x;
    struct ct_member *m = &w->s->member[member];
    const ct_ex3 carried = ct_ex3_scale(x, mass, v);
    if (!member)
        return; // ground does not move
    m->mass = ct_ex_add(x, m->mass, mass);
    m->moment = ct_ex3_add(x, m->moment, ct_ex3_add(x, h, carried));
    add_arm(w->b, &m->J, v, ct_ex3_add(x, h, ct_ex3_scale(x, ct_ex_const(x, 0.5), carried)));
    add_tensor(w->b, &m->J, J);
}

void ct_members_add_bodies(struct ct_member_build *w)
{
    struct ct_build *b = w->b;
    for (size_t i = 1; i < b->model->nbody; i++) {
        const struct ct_body *body = &b->model->body[i];
        const int node = b->topology->node_of_com[i];
        if (body->beam)
            continue;
        const ct_ex *I = body->inertia;
        ct_ex33 turned = {{{0}}};
        if (!body->is_particle) {
            const ct_ex33 own = {{I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2]}};
            const ct_ex33 *S = &b->kinematics->placement[node].S, t = ct_ex33_transpose(S);
            const ct_ex33 half = ct_ex33_mul(b->x, &own, &t);
            turned = ct_ex33_mul(b->x, S, &half);
        }
        add_inertia(w, w->of_node[node], w->offset[node], body->mass, zero3, &turned);
    }
}

// Moves a first moment along a rotation axis, and the inertia of a rod along it, to the parent.
static void take_off_axis(struct ct_build *b, struct ct_member *m, ct_ex3 *h, ct_ex33 *J)
{
    struct ct_exs *x = b->x;
    const int i = m->axis, j = (i + 1) % 3, k = (i + 2) % 3;
    h->e[i] = m->moment.e[i];
    m->moment.e[i] = CT_EX_ZERO;
    const ct_ex rod = m->J.e[j + 3 * j];
    J->e[j + 3 * j] = J->e[k + 3 * k] = rod;
    m->J.e[j + 3 * j] = CT_EX_ZERO;
    m->J.e[k + 3 * k] = ct_ex_sub(x, m->J.e[k + 3 * k], rod);
}

// Moves inertia that the joint does not move to the parent.
static void lump(struct ct_member_build *w, struct ct_member *m)
{
    ct_ex33 J = {{{0}}};
    ct_ex3 h = zero3;
    ct_ex mass = CT_EX_ZERO;
    if (m->rotates && !m->translates) { // the origin is fixed in the parent
        mass = m->mass;
        m->mass = CT_EX_ZERO;
        if (m->axis >= 0 && !w->b->topology->is_planar)
            take_off_axis(w->b, m, &h, &J);
    } else if (!m->rotates) {
        J = m->J;
        m->J = (ct_ex33){{{0}}};
        add_inertia(w, m->parent, zero3, mass, h, &J);
        return;
    }
    add_inertia(w, m->parent, m->r, mass, h, &J);
}

void ct_members_lump(struct ct_member_build *w)
{
    for (size_t m = w->s->n; m-- > 1;)
        lump(w, &w->s->member[m]);
}

void ct_members_add_beams(struct ct_member_build *w)
{
    struct ct_build *b = w->b;
    if (w->s->nbeam)
        ct_augmented_bodies_lump(b);
    for (size_t i = 0; i < w->s->nbeam; i++) {
        const struct ct_member_beam *at = &w->s->beam[i];
        const struct ct_inertia *I = b->flexible[i].inertia;
        struct ct_member *m = &w->s->member[at->base];
        const ct_ex33 t = ct_ex33_transpose(&at->A), half = ct_ex33_mul(b->x, &I->inertia, &t);
        const ct_ex33 J = ct_ex33_mul(b->x, &at->A, &half);
        ct_ex3 moment = ct_ex33_apply(b->x, &at->A, I->moment);
        m->mass = ct_ex_add(b->x, m->mass, I->mass);
        if (b->topology->is_planar) {
            moment.e[2] = CT_EX_ZERO;
            m->J.e[8] = ct_ex_add(b->x, m->J.e[8], J.e[8]);
        } else {
            add_tensor(b, &m->J, &J);
        }
        m->moment = ct_ex3_add(b->x, m->moment, moment);
    }
}

// ---- loads --------------------------------------------------------------------------------------

static void apply_at(struct ct_member_build *w, int node, ct_ex3 force, ct_ex3 torque)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    struct ct_member *m = &w->s->member[w->of_node[node]];
    const ct_ex3 f = ct_member_express_ground(b, m->cluster, force),
                 arm = ct_member_express(b, m->cluster, w->offset[node]);
    m->force = ct_ex3_add(x, m->force, f);
    m->torque = ct_ex3_add(x, m->torque, ct_ex3_cross(x, arm, f));
    if (!b->topology->node[node].is_particle)
        m->torque = ct_ex3_add(x, m->torque, ct_member_express_ground(b, m->cluster, torque));
}

void ct_members_load(struct ct_member_build *w)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    for (size_t i = 0; i < b->loads->nload; i++) {
        const struct ct_load *l = &b->loads->load[i];
        ct_ex3 back = l->torque;
        apply_at(w, l->head, l->force, l->torque);
        if (l->tail == 0)
            continue;
        if (!l->is_central)
            back = ct_ex3_add(x, back,
                              ct_ex3_cross(x, ct_path_position(b, l->tail, l->head), l->force));
        apply_at(w, l->tail, ct_ex3_neg(x, l->force), ct_ex3_neg(x, back));
    }
}
