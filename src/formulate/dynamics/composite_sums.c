// See composite_sums.h.
#include "formulate/dynamics/composite_sums.h"

#include "formulate/dynamics/dynamics.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

static const struct ct_composite_pair *find_pair(const struct ct_composite_sums *s, int anchor,
                                                 int cluster)
{
    const int i = ct_pairs_get(&s->pair_of, anchor, cluster);
    return i < 0 ? NULL : &s->pair[i];
}

// The pair of an anchor and a cluster; created at the first call.
static struct ct_composite_pair *take_pair(struct ct_composite_sums *s, int anchor, int cluster)
{
    const int found = ct_pairs_get(&s->pair_of, anchor, cluster);
    if (found >= 0)
        return &s->pair[found];
    const struct ct_composite_pair p = {
        .cluster = cluster, .next = s->first_pair[anchor], .first_part = -1, .last_part = -1};
    ct_pairs_put(s->b->arena, &s->pair_of, anchor, cluster, (int)s->npair);
    s->first_pair[anchor] = (int)s->npair;
    CT_PUSH(s->b->arena, s->pair, s->npair, s->pair_cap, p);
    return &s->pair[s->npair - 1];
}

static void add_part(struct ct_composite_sums *s, struct ct_composite_pair *p, int body,
                     int child)
{
    const struct ct_composite_part part = {body, child, -1};
    *(p->last_part < 0 ? &p->first_part : &s->part[p->last_part].next) = (int)s->npart;
    p->last_part = (int)s->npart;
    CT_PUSH(s->b->arena, s->part, s->npart, s->part_cap, part);
}

int ct_composite_sums_first_part(const struct ct_composite_sums *s, int anchor, int cluster)
{
    const struct ct_composite_pair *p = find_pair(s, anchor, cluster);
    return p ? p->first_part : -1;
}

ct_ex3 ct_composite_sums_body_moment(struct ct_composite_sums *s, int body)
{
    if (!s->has_moment[body])
        s->moment[body]
            = ct_cluster_turn(s->b, s->b->dynamics.masses.augmented_body[body].cluster,
                              s->b->dynamics.masses.augmented_body[body].moment);
    s->has_moment[body] = true;
    return s->moment[body];
}

bool ct_composite_sums_turns_with(const struct ct_composite_sums *s, int cluster,
                                  int star_cluster)
{
    return ct_cluster_is_outboard(s->b, cluster, star_cluster);
}

ct_ex3 ct_composite_sums_link(struct ct_composite_sums *s, int anchor)
{
    return ct_build_in_plane(s->b, ct_link_vector(s->b, anchor));
}

// Does a rotation of the augmented body accelerate a mass, by its first moment or through a link?
static bool accelerates_mass(const struct ct_build *b, const struct ct_augmented_body *s)
{
    for (int k = 0; k < s->nchild; k++)
        if (!ct_ex_is_zero(
                b->dynamics.masses.mass[b->dynamics.masses.child[s->first_child + k]]))
            return true;
    return !ct_ex3_is_zero(s->moment);
}

static void count_augmented_body(struct ct_composite_sums *s, int anchor, int body)
{
    const struct ct_build *b = s->b;
    const struct ct_augmented_body *self = &b->dynamics.masses.augmented_body[body];
    const bool has_mass = accelerates_mass(b, self);
    s->nstar[anchor] += has_mass;
    for (int c = self->cluster; c > 0; c = b->kinematics->cluster[c].parent) {
        struct ct_composite_pair *p = take_pair(s, anchor, c);
        p->nturning += has_mass;
        add_part(s, p, body, -1);
    }
    for (int k = 0; k < self->nchild; k++) {
        const int child = b->dynamics.masses.child[self->first_child + k];
        s->nstar[anchor] += s->nstar[child];
        for (int i = s->first_pair[child]; i >= 0; i = s->pair[i].next) {
            const int n = s->pair[i].nturning;
            if (!n)
                continue;
            struct ct_composite_pair *p = take_pair(s, anchor, s->pair[i].cluster);
            p->nturning += n;
            add_part(s, p, body, child);
        }
    }
}

static void count_augmented_bodies(struct ct_composite_sums *s)
{
    const struct ct_build *b = s->b;
    for (size_t i = 0; i < b->kinematics->nanchor; i++)
        s->first[i] = s->first_pair[i] = -1;
    for (size_t i = b->dynamics.masses.naugmented_body; i-- > 0;) {
        s->next[i] = s->first[b->dynamics.masses.augmented_body[i].anchor];
        s->first[b->dynamics.masses.augmented_body[i].anchor] = (int)i;
    }
    for (size_t a = b->kinematics->nanchor; a-- > 0;) // outboard anchors have larger numbers
        for (int i = s->first[a]; i >= 0; i = s->next[i])
            count_augmented_body(s, (int)a, i);
}

enum ct_turning ct_composite_sums_turning(const struct ct_composite_sums *s, int anchor,
                                          int cluster)
{
    const struct ct_composite_pair *p = find_pair(s, anchor, cluster);
    return !p || !p->nturning             ? CT_TURNS_NONE
         : p->nturning < s->nstar[anchor] ? CT_TURNS_SOME
                                          : CT_TURNS_ALL;
}

// Finds for each cluster the innermost anchor outboard of which everything rotates with it. If
// there is none: the outermost anchor inboard of everything that rotates with it.
static void find_starts(struct ct_composite_sums *s)
{
    const struct ct_build *b = s->b;
    for (size_t c = 0; c < b->kinematics->ncluster; c++)
        s->start[c] = -1;
    for (size_t i = 0; i < b->dynamics.masses.naugmented_body; i++)
        for (int c = b->dynamics.masses.augmented_body[i].cluster;
             c > 0 && accelerates_mass(b, &b->dynamics.masses.augmented_body[i]);
             c = b->kinematics->cluster[c].parent) {
            int other = b->dynamics.masses.augmented_body[i].anchor;
            if (s->start[c] < 0)
                s->start[c] = other;
            while (s->start[c] != other) // parents have smaller numbers
                *(s->start[c] > other ? &s->start[c] : &other)
                    = b->kinematics->anchor[s->start[c] > other ? s->start[c] : other].parent;
        }
    for (size_t c = 1; c < b->kinematics->ncluster; c++)
        for (int a = s->start[c]; a >= 0; a = a ? b->kinematics->anchor[a].parent : -1)
            if (ct_composite_sums_turning(s, a, (int)c) == CT_TURNS_ALL)
                s->start[c] = a;
}

ct_ex3 ct_composite_sums_lever_arm(struct ct_composite_sums *s, int anchor, int cluster)
{
    if (anchor == 0)
        return zero3;
    const struct ct_composite_pair *known = find_pair(s, anchor, cluster);
    if (known && known->has_g)
        return known->g;
    const struct ct_anchor *a = &s->b->kinematics->anchor[anchor];
    ct_ex3 g = ct_composite_sums_lever_arm(s, a->parent, cluster);
    if (ct_composite_sums_turns_with(s, cluster, a->cluster))
        g = ct_ex3_add(s->b->x, g, ct_composite_sums_link(s, anchor));
    if (ct_ex3_is_zero(g))
        return g;
    struct ct_composite_pair *p = take_pair(s, anchor, cluster);
    p->g = g;
    p->has_g = true;
    return g;
}

ct_ex3 ct_composite_sums_moment(struct ct_composite_sums *s, int anchor)
{
    struct ct_build *b = s->b;
    if (!s->has_all[anchor]) {
        ct_ex3 sum = zero3;
        for (int i = s->first[anchor]; i >= 0; i = s->next[i]) {
            sum = ct_ex3_add(b->x, sum, ct_composite_sums_body_moment(s, i));
            for (int k = 0; k < b->dynamics.masses.augmented_body[i].nchild; k++)
                sum = ct_ex3_add(
                    b->x, sum,
                    ct_composite_sums_moment(
                        s, b->dynamics.masses
                               .child[b->dynamics.masses.augmented_body[i].first_child + k]));
        }
        s->all[anchor] = sum;
        s->has_all[anchor] = true;
    }
    return s->all[anchor];
}

ct_ex3 ct_composite_sums_moment_turning(struct ct_composite_sums *s, int anchor, int cluster)
{
    struct ct_build *b = s->b;
    const enum ct_turning part = ct_composite_sums_turning(s, anchor, cluster);
    if (part == CT_TURNS_NONE)
        return zero3;
    if (part == CT_TURNS_ALL)
        return ct_composite_sums_moment(s, anchor);
    const struct ct_composite_pair *known = find_pair(s, anchor, cluster);
    if (known->has_h)
        return known->h;
    ct_ex3 sum = zero3;
    for (int i = known->first_part; i >= 0; i = s->part[i].next) {
        const struct ct_composite_part *t = &s->part[i];
        sum = ct_ex3_add(b->x, sum,
                         t->child < 0 ? ct_composite_sums_body_moment(s, t->body)
                                      : ct_composite_sums_moment_turning(s, t->child, cluster));
    }
    struct ct_composite_pair *p = take_pair(s, anchor, cluster);
    p->h = sum;
    p->has_h = true;
    return sum;
}

// ---- composite inertia --------------------------------------------------------------------------

static void add_tensor(struct ct_build *b, ct_ex33 *sum, const ct_ex33 *a)
{
    for (int i = 0; i < 9; i++)
        sum->e[i] = ct_ex_add(b->x, sum->e[i], a->e[i]);
}

// d x (s x h) + h x (s x d) = [2 (d.h) 1 - d h' - h d'] s; planar: 2 (d.h), in the last entry.
static ct_ex33 cross_inertia(struct ct_build *b, ct_ex3 d, ct_ex3 h)
{
    struct ct_exs *x = b->x;
    const ct_ex twice = ct_ex_scale(x, 2, ct_ex3_dot(x, d, h));
    ct_ex33 X = {{{0}}};
    if (b->topology->is_planar) {
        X.e[8] = twice;
        return X;
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++) {
            const ct_ex both
                = ct_ex_add(x, ct_ex_mul(x, d.e[i], h.e[j]), ct_ex_mul(x, h.e[i], d.e[j]));
            const ct_ex v = i == j ? ct_ex_sub(x, twice, both) : ct_ex_neg(x, both);
            X.e[i + 3 * j] = X.e[j + 3 * i] = v;
        }
    return X;
}

static const ct_ex33 *cross_descendants(struct ct_composite_sums *s, int anchor)
{
    struct ct_build *b = s->b;
    if (!s->has_cross[anchor]) {
        ct_ex33 sum = {{{0}}};
        for (int i = s->first[anchor]; i >= 0; i = s->next[i])
            for (int k = 0; k < b->dynamics.masses.augmented_body[i].nchild; k++) {
                const int child
                    = b->dynamics.masses
                          .child[b->dynamics.masses.augmented_body[i].first_child + k];
                const ct_ex33 X = cross_inertia(b, ct_composite_sums_link(s, child),
                                                ct_composite_sums_moment(s, child));
                add_tensor(b, &sum, cross_descendants(s, child));
                add_tensor(b, &sum, &X);
            }
        s->cross[anchor] = sum;
        s->has_cross[anchor] = true;
    }
    return &s->cross[anchor];
}

// Augmented inertia of a cluster in ground components; planar: about the normal, in the last entry.
ct_ex33 ct_cluster_inertia(struct ct_build *b, int c)
{
    struct ct_exs *x = b->x;
    const ct_ex33 *L = &b->dynamics.masses.inertia[c], *R = &b->kinematics->cluster[c].R;
    ct_ex33 out = {{{0}}};
    if (b->topology->is_planar) {
        out.e[8]
            = ct_ex3_dot(x, b->topology->plane[2], ct_ex33_apply(x, L, b->topology->plane[2]));
        return out;
    }
    const ct_ex33 half = ct_ex33_mul(x, R, L);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++) {
            const ct_ex3 row = {{half.e[i], half.e[i + 3], half.e[i + 6]}};
            const ct_ex3 column = {{R->e[j], R->e[j + 3], R->e[j + 6]}};
            out.e[i + 3 * j] = out.e[j + 3 * i] = ct_ex3_dot(x, row, column);
        }
    return out;
}

static void sum_inertias(struct ct_composite_sums *s)
{
    struct ct_build *b = s->b;
    for (size_t c = b->kinematics->ncluster; c-- > 1;) {
        const ct_ex33 own = ct_cluster_inertia(b, (int)c);
        add_tensor(b, &s->inertia[c], &s->descendants[c]);
        add_tensor(b, &s->inertia[c], &own);
        if (b->kinematics->cluster[c].parent > 0)
            add_tensor(b, &s->descendants[b->kinematics->cluster[c].parent], &s->inertia[c]);
    }
}

void ct_composite_sums_add_full(struct ct_composite_sums *s, int anchor, int cluster,
                                ct_ex33 *sum)
{
    struct ct_build *b = s->b;
    const enum ct_turning part = ct_composite_sums_turning(s, anchor, cluster);
    if (part == CT_TURNS_NONE)
        return;
    if (part == CT_TURNS_ALL) {
        add_tensor(b, sum, cross_descendants(s, anchor));
        return;
    }
    for (int i = ct_composite_sums_first_part(s, anchor, cluster); i >= 0; i = s->part[i].next)
        if (s->part[i].child >= 0)
            ct_composite_sums_add_full(s, s->part[i].child, cluster, sum);
}

struct ct_composite_sums ct_composite_sums_create(struct ct_build *b)
{
    const size_t na = b->kinematics->nanchor, nc = b->kinematics->ncluster,
                 ns = b->dynamics.masses.naugmented_body + 1;
    struct ct_composite_sums s = {.b = b};
    s.nstar = CT_NEWN(b->arena, int, na);
    s.first_pair = CT_NEWN(b->arena, int, na);
    s.moment = CT_NEWN(b->arena, ct_ex3, ns);
    s.has_moment = CT_NEWN(b->arena, bool, ns);
    s.all = CT_NEWN(b->arena, ct_ex3, na);
    s.has_all = CT_NEWN(b->arena, bool, na);
    s.cross = CT_NEWN(b->arena, ct_ex33, na);
    s.has_cross = CT_NEWN(b->arena, bool, na);
    s.inertia = CT_NEWN(b->arena, ct_ex33, nc);
    s.descendants = CT_NEWN(b->arena, ct_ex33, nc);
    s.first = CT_NEWN(b->arena, int, na);
    s.next = CT_NEWN(b->arena, int, ns);
    s.start = CT_NEWN(b->arena, int, nc);
    count_augmented_bodies(&s);
    find_starts(&s);
    sum_inertias(&s);
    return s;
}
