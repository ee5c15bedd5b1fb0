// See dynamics.h: lumps the masses on augmented bodies.
#include "formulate/beam/flexible_body.h"
#include "formulate/mass_sums.h"
#include "formulate/dynamics/dynamics.h"
#include "formulate/beam_dynamics/beam_dynamics.h"

// Adds the inertia of a body in axes of its cluster: S I S'.
static void add_inertia(struct ct_build *b, const struct ct_body *body,
                        const struct ct_node_placement *p)
{
    const ct_ex *I = body->inertia;
    const ct_ex33 own = {{I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2]}};
    const ct_ex33 t = ct_ex33_transpose(&p->S);
    const ct_ex33 half = ct_ex33_mul(b->x, &own, &t), turned = ct_ex33_mul(b->x, &p->S, &half);
    ct_ex33 *L = &b->dynamics.masses.inertia[p->frame];
    for (int i = 0; i < 9; i++)
        L->e[i] = ct_ex_add(b->x, L->e[i], turned.e[i]);
}

// Lists the child anchors of each augmented body. Every link belongs to one augmented body.
static void link_children(struct ct_build *b)
{
    const struct ct_kinematics *k = b->kinematics;
    struct ct_lumped_masses *s = &b->dynamics.masses;
    int *n = CT_NEWN(b->arena, int, s->naugmented_body + 1), first = 0;
    for (size_t a = 1; a < k->nanchor; a++)
        ct_augmented_body_of(b, k->anchor[a].parent, k->anchor[a].cluster)->nchild++;
    for (size_t i = 0; i < s->naugmented_body; i++) {
        s->augmented_body[i].first_child = first;
        first += s->augmented_body[i].nchild;
    }
    s->child = CT_NEWN(b->arena, int, k->nanchor);
    for (size_t a = 1; a < k->nanchor; a++) {
        const struct ct_augmented_body *of
            = ct_augmented_body_of(b, k->anchor[a].parent, k->anchor[a].cluster);
        s->child[of->first_child + n[of - s->augmented_body]++] = (int)a;
    }
}

void ct_augmented_bodies_lump(struct ct_build *b)
{
    if (b->dynamics.masses.is_lumped)
        return;
    b->dynamics.masses.is_lumped = true;
    ct_ex *mass = b->dynamics.masses.mass = CT_NEWN(b->arena, ct_ex, b->kinematics->nanchor);
    b->dynamics.masses.inertia = CT_NEWN(b->arena, ct_ex33, b->kinematics->ncluster);
    for (size_t i = 1; i < b->model->nbody; i++) {
        const struct ct_body *body = &b->model->body[i];
        const struct ct_node_placement *p
            = &b->kinematics->placement[b->topology->node_of_com[i]];
        if (body->beam)
            continue;
        mass[p->anchor] = ct_ex_add(b->x, mass[p->anchor], body->mass);
        if (!ct_ex_is_zero(body->mass))
            ct_augmented_bodies_add_point(b, p->anchor, p->cluster, body->mass, p->local);
        if (!body->is_particle)
            add_inertia(b, body, p);
    }
    ct_flexible_lump(b);
    for (size_t a = b->kinematics->nanchor; a-- > 1;) {
        const struct ct_anchor *self = &b->kinematics->anchor[a];
        mass[self->parent] = ct_ex_add(b->x, mass[self->parent], mass[a]);
        ct_augmented_body_of(b, self->parent,
                             self->cluster); // also if it has no mass: it transmits loads
        if (!ct_ex_is_zero(mass[a]))
            ct_augmented_bodies_add_point(b, self->parent, self->cluster, mass[a], self->local);
    }
    link_children(b);
}
