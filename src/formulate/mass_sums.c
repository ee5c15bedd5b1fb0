// See mass_sums.h.
#include "formulate/mass_sums.h"

struct ct_augmented_body *ct_augmented_body_of(struct ct_build *b, int anchor, int cluster)
{
    struct ct_lumped_masses *s = &b->dynamics.masses;
    for (size_t i = s->of.n; i < s->naugmented_body; i++)
        ct_pairs_put(b->arena, &s->of, s->augmented_body[i].anchor,
                     s->augmented_body[i].cluster, (int)i);
    const int found = ct_pairs_get(&s->of, anchor, cluster);
    if (found >= 0)
        return &s->augmented_body[found];
    const struct ct_augmented_body one = {.anchor = anchor, .cluster = cluster};
    ct_pairs_put(b->arena, &s->of, anchor, cluster, (int)s->naugmented_body);
    CT_PUSH(b->arena, s->augmented_body, s->naugmented_body, s->augmented_body_cap, one);
    return &s->augmented_body[s->naugmented_body - 1];
}

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

void ct_augmented_bodies_add_point(struct ct_build *b, int anchor, int cluster, ct_ex m,
                                   ct_ex3 local)
{
    struct ct_augmented_body *s = ct_augmented_body_of(b, anchor, cluster);
    const ct_ex3 v = ct_build_in_plane(b, local);
    s->moment = ct_ex3_add(b->x, s->moment, ct_ex3_scale(b->x, m, v));
    ct_inertia_add_point(b, &b->dynamics.masses.inertia[cluster], m, v);
}

void ct_augmented_bodies_add(struct ct_build *b, int anchor, int cluster, ct_ex m,
                             ct_ex3 moment, const ct_ex33 *inertia)
{
    struct ct_augmented_body *s = ct_augmented_body_of(b, anchor, cluster);
    ct_ex33 *L = &b->dynamics.masses.inertia[cluster];
    s->moment = ct_ex3_add(b->x, s->moment, ct_build_in_plane(b, moment));
    for (int i = 0; i < 9; i++)
        L->e[i] = ct_ex_add(b->x, L->e[i], inertia->e[i]);
    b->dynamics.masses.mass[anchor] = ct_ex_add(b->x, b->dynamics.masses.mass[anchor], m);
}

void ct_mass_spread(struct ct_build *b, struct ct_symmetric *M, const struct ct_term *p, int np,
                    const struct ct_term *q, int nq, ct_ex m)
{
    for (int i = 0; i < np; i++)
        for (int j = 0; j < nq; j++) {
            if (p[i].speed < 0 || q[j].speed < 0)
                continue;
            ct_ex v = ct_ex_mul(b->x, ct_ex_mul(b->x, p[i].coef, q[j].coef), m);
            if (p[i].speed == q[j].speed)
                v = ct_ex_scale(b->x, 2, v);
            ct_symmetric_add(b->x, M, (size_t)p[i].speed, (size_t)q[j].speed, v);
        }
}
