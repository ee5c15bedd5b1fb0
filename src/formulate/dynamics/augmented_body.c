// See dynamics.h: masses that move alike, lumped on augmented bodies.
#include "formulate/beam/flexible_body.h"

void ct_inertia_add_point(struct ct_build *b, ct_ex33 *L, ct_ex m, ct_ex3 v)
{
    struct ct_exs *x = b->x;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const ct_ex other
            = ct_ex_add(x, ct_ex_mul(x, v.e[j], v.e[j]), ct_ex_mul(x, v.e[k], v.e[k]));
        L->e[i + 3 * i] = ct_ex_add(x, L->e[i + 3 * i], ct_ex_mul(x, m, other));
        const ct_ex cross = ct_ex_mul(x, m, ct_ex_mul(x, v.e[i], v.e[j]));
        L->e[i + 3 * j] = ct_ex_sub(x, L->e[i + 3 * j], cross);
        L->e[j + 3 * i] = ct_ex_sub(x, L->e[j + 3 * i], cross);
    }
}

static struct ct_augmented_body *augmented_body_of(struct ct_build *b, int anchor, int cluster)
{
    for (size_t i = 0; i < b->naugmented_body; i++)
        if (b->augmented_body[i].anchor == anchor && b->augmented_body[i].cluster == cluster)
            return &b->augmented_body[i];
    const struct ct_augmented_body s = {.anchor = anchor, .cluster = cluster};
    CT_PUSH(b->arena, b->augmented_body, b->naugmented_body, b->augmented_body_cap, s);
    return &b->augmented_body[b->naugmented_body - 1];
}

static void add_mass(struct ct_build *b, int anchor, int cluster, ct_ex m, ct_ex3 local)
{
    struct ct_augmented_body *s = augmented_body_of(b, anchor, cluster);
    const ct_ex3 v = ct_build_in_plane(b, local);
    s->moment = ct_ex3_add(b->x, s->moment, ct_ex3_scale(b->x, m, v));
    ct_inertia_add_point(b, &b->cluster[cluster].L, m, v);
}

void ct_augmented_bodies_add(struct ct_build *b, int anchor, int cluster, ct_ex m,
                             ct_ex3 moment, const ct_ex33 *inertia)
{
    struct ct_augmented_body *s = augmented_body_of(b, anchor, cluster);
    ct_ex33 *L = &b->cluster[cluster].L;
    s->moment = ct_ex3_add(b->x, s->moment, ct_build_in_plane(b, moment));
    for (int i = 0; i < 9; i++)
        L->e[i] = ct_ex_add(b->x, L->e[i], inertia->e[i]);
    b->anchor[anchor].mass = ct_ex_add(b->x, b->anchor[anchor].mass, m);
}

// Inertia of a body turned from its own axes into its cluster's: S I S'.
static void add_inertia(struct ct_build *b, const struct ct_body *body,
                        const struct ct_node_placement *p)
{
    const ct_ex *I = body->inertia;
    const ct_ex33 own = {{I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2]}};
    const ct_ex33 t = ct_ex33_transpose(&p->S);
    const ct_ex33 half = ct_ex33_mul(b->x, &own, &t), turned = ct_ex33_mul(b->x, &p->S, &half);
    ct_ex33 *L = &b->cluster[p->frame].L;
    for (int i = 0; i < 9; i++)
        L->e[i] = ct_ex_add(b->x, L->e[i], turned.e[i]);
}

static void link_children(struct ct_build *b)
{
    size_t cap = 0, n = 0;
    for (size_t i = 0; i < b->naugmented_body; i++) {
        struct ct_augmented_body *s = &b->augmented_body[i];
        s->first_child = (int)n;
        for (size_t a = 1; a < b->nanchor; a++)
            if (b->anchor[a].parent == s->anchor && b->anchor[a].cluster == s->cluster) {
                CT_PUSH(b->arena, b->child, n, cap, (int)a);
                s->nchild++;
            }
    }
}

void ct_augmented_bodies_lump(struct ct_build *b)
{
    if (b->is_lumped)
        return;
    b->is_lumped = true;
    for (size_t i = 1; i < b->model->nbody; i++) {
        const struct ct_body *body = &b->model->body[i];
        const struct ct_node_placement *p = &b->placement[b->node_of_com[i]];
        if (body->beam)
            continue;
        b->anchor[p->anchor].mass = ct_ex_add(b->x, b->anchor[p->anchor].mass, body->mass);
        if (!ct_ex_is_zero(body->mass))
            add_mass(b, p->anchor, p->cluster, body->mass, p->local);
        if (!body->is_particle)
            add_inertia(b, body, p);
    }
    ct_flexible_lump(b);
    for (size_t a = b->nanchor; a-- > 1;) {
        const struct ct_anchor *self = &b->anchor[a];
        b->anchor[self->parent].mass
            = ct_ex_add(b->x, b->anchor[self->parent].mass, self->mass);
        augmented_body_of(b, self->parent,
                          self->cluster); // also without mass: loads pass through it
        if (!ct_ex_is_zero(self->mass))
            add_mass(b, self->parent, self->cluster, self->mass, self->local);
    }
    link_children(b);
}
