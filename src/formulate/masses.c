// Lumped masses and the mass matrix.
//
// Spin r about the axis s moves everything whose vectors turn with its cluster. With the reach
// g (sum of the turning vectors on the path to a point) a point moves by s x g, and
//
//   M_r'r = s' . [ sum over stars that turn with r' of  b x (s x g) + sum over links d x (s x h)
//                  + (augmented inertia of what turns with both) s ]
//
// where b is a star's first moment and h the sum of the first moments outboard of a link that turn
// with r. Where everything outboard turns together, h and the inertia are composites that are summed
// once. In a planar mechanism all this is scalar. Columns are taken for the outer of two spins.
#include "formulate/flexible.h"

#include <assert.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- lumping --------------------------------------------------------------------------------------

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

static struct ct_star *star_of(struct ct_build *b, int anchor, int cluster)
{
    for (size_t i = 0; i < b->nstar; i++)
        if (b->star[i].anchor == anchor && b->star[i].cluster == cluster)
            return &b->star[i];
    const struct ct_star s = {.anchor = anchor, .cluster = cluster};
    CT_PUSH(b->arena, b->star, b->nstar, b->star_cap, s);
    return &b->star[b->nstar - 1];
}

static void add_mass(struct ct_build *b, int anchor, int cluster, ct_ex m, ct_ex3 local)
{
    struct ct_star *s = star_of(b, anchor, cluster);
    const ct_ex3 v = ct_build_in_plane(b, local);
    s->moment = ct_ex3_add(b->x, s->moment, ct_ex3_scale(b->x, m, v));
    ct_inertia_add_point(b, &b->cluster[cluster].L, m, v);
}

void ct_masses_add(struct ct_build *b, int anchor, int cluster, ct_ex m, ct_ex3 moment,
                   const ct_ex33 *inertia)
{
    struct ct_star *s = star_of(b, anchor, cluster);
    ct_ex33 *L = &b->cluster[cluster].L;
    s->moment = ct_ex3_add(b->x, s->moment, ct_build_in_plane(b, moment));
    for (int i = 0; i < 9; i++)
        L->e[i] = ct_ex_add(b->x, L->e[i], inertia->e[i]);
    b->anchor[anchor].mass = ct_ex_add(b->x, b->anchor[anchor].mass, m);
}

// Inertia of a body turned from its own axes into its cluster's: S I S'.
static void add_inertia(struct ct_build *b, const struct ct_body *body,
                        const struct ct_place *p)
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
    for (size_t i = 0; i < b->nstar; i++) {
        struct ct_star *s = &b->star[i];
        s->first_child = (int)n;
        for (size_t a = 1; a < b->nanchor; a++)
            if (b->anchor[a].parent == s->anchor && b->anchor[a].cluster == s->cluster) {
                CT_PUSH(b->arena, b->child, n, cap, (int)a);
                s->nchild++;
            }
    }
}

void ct_masses_lump(struct ct_build *b)
{
    if (b->is_lumped)
        return;
    b->is_lumped = true;
    for (size_t i = 1; i < b->model->nbody; i++) {
        const struct ct_body *body = &b->model->body[i];
        const struct ct_place *p = &b->place[b->node_of_com[i]];
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
        star_of(b, self->parent, self->cluster); // also without mass: loads pass through it
        if (!ct_ex_is_zero(self->mass))
            add_mass(b, self->parent, self->cluster, self->mass, self->local);
    }
    link_children(b);
}

// ---- sums over what hangs on an anchor ------------------------------------------------------------

// Everything below is asked for by (anchor, cluster of the spin); filled when first needed.
struct reach {
    struct ct_build *b;
    int *nstar;    // stars with mass outboard of an anchor
    int *nturning; // those that turn with a cluster: [anchor + nanchor * cluster]
    ct_ex3 *g, *h; // [anchor + nanchor * cluster]
    bool *has_g, *has_h;
    ct_ex3 *moment; // by star, ground components
    bool *has_moment;
    ct_ex3 *all; // by anchor: first moments of everything outboard
    bool *has_all;
    ct_ex33 *cross; // by anchor: inertia of the links against what they carry
    bool *has_cross;
    ct_ex33 *inertia;  // by cluster: augmented inertia of it and the clusters outboard, ground
    ct_ex33 *outboard; // the same of the clusters outboard alone
    int *first, *next; // stars of an anchor, chained
    int *
        start; // by cluster: anchor from which on what turns with it is summed; -1: nothing does
};

static size_t at(const struct reach *s, int anchor, int cluster)
{
    return (size_t)anchor + s->b->nanchor * (size_t)cluster;
}

static bool turns_with(const struct reach *s, int cluster, int star_cluster)
{
    return ct_cluster_is_outboard(s->b, cluster, star_cluster);
}

static ct_ex3 star_moment(struct reach *s, int star)
{
    if (!s->has_moment[star])
        s->moment[star]
            = ct_cluster_turn(s->b, s->b->star[star].cluster, s->b->star[star].moment);
    s->has_moment[star] = true;
    return s->moment[star];
}

static ct_ex3 link_in_plane(struct reach *s, int anchor)
{
    return ct_build_in_plane(s->b, ct_link_vector(s->b, anchor));
}

// A star counts if a turn of it accelerates anything: by its first moment or through a link.
static bool is_felt(const struct ct_build *b, const struct ct_star *s)
{
    for (int k = 0; k < s->nchild; k++)
        if (!ct_ex_is_zero(b->anchor[b->child[s->first_child + k]].mass))
            return true;
    return !ct_ex3_is_zero(s->moment);
}

static void count_stars(struct reach *s)
{
    const struct ct_build *b = s->b;
    for (size_t i = 0; i < b->nanchor; i++)
        s->first[i] = -1;
    for (size_t i = b->nstar; i-- > 0;) {
        s->next[i] = s->first[b->star[i].anchor];
        s->first[b->star[i].anchor] = (int)i;
        if (!is_felt(b, &b->star[i]))
            continue;
        s->nstar[b->star[i].anchor]++;
        for (int c = b->star[i].cluster; c > 0; c = b->cluster[c].parent)
            s->nturning[at(s, b->star[i].anchor, c)]++;
    }
    for (size_t a = b->nanchor; a-- > 1;) {
        s->nstar[b->anchor[a].parent] += s->nstar[a];
        for (size_t c = 1; c < b->ncluster; c++)
            s->nturning[at(s, b->anchor[a].parent, (int)c)]
                += s->nturning[at(s, (int)a, (int)c)];
    }
}

enum share { NONE, SOME, ALL };

static enum share share(const struct reach *s, int anchor, int cluster)
{
    const int n = s->nturning[at(s, anchor, cluster)];
    return !n ? NONE : n < s->nstar[anchor] ? SOME : ALL;
}

// The innermost anchor outboard of which everything turns with a cluster; if there is none, the outermost one
// inboard of all that does.
static void find_starts(struct reach *s)
{
    const struct ct_build *b = s->b;
    for (size_t c = 0; c < b->ncluster; c++)
        s->start[c] = -1;
    for (size_t i = 0; i < b->nstar; i++)
        for (int c = b->star[i].cluster; c > 0 && is_felt(b, &b->star[i]);
             c = b->cluster[c].parent) {
            int other = b->star[i].anchor;
            if (s->start[c] < 0)
                s->start[c] = other;
            while (s->start[c] != other) // numbers grow outwards
                *(s->start[c] > other ? &s->start[c] : &other)
                    = b->anchor[s->start[c] > other ? s->start[c] : other].parent;
        }
    for (size_t c = 1; c < b->ncluster; c++)
        for (int a = s->start[c]; a >= 0; a = a ? b->anchor[a].parent : -1)
            if (share(s, a, (int)c) == ALL)
                s->start[c] = a;
}

// Sum of the vectors on the path to an anchor that turn with a cluster.
static ct_ex3 reach_of(struct reach *s, int anchor, int cluster)
{
    const size_t i = at(s, anchor, cluster);
    if (anchor == 0)
        return zero3;
    if (!s->has_g[i]) {
        const struct ct_anchor *a = &s->b->anchor[anchor];
        s->g[i] = reach_of(s, a->parent, cluster);
        if (turns_with(s, cluster, a->cluster))
            s->g[i] = ct_ex3_add(s->b->x, s->g[i], link_in_plane(s, anchor));
        s->has_g[i] = true;
    }
    return s->g[i];
}

// First moments outboard of an anchor: of everything, and of what turns with a cluster.
static ct_ex3 moment_outboard(struct reach *s, int anchor)
{
    struct ct_build *b = s->b;
    if (!s->has_all[anchor]) {
        ct_ex3 sum = zero3;
        for (int i = s->first[anchor]; i >= 0; i = s->next[i]) {
            sum = ct_ex3_add(b->x, sum, star_moment(s, i));
            for (int k = 0; k < b->star[i].nchild; k++)
                sum = ct_ex3_add(b->x, sum,
                                 moment_outboard(s, b->child[b->star[i].first_child + k]));
        }
        s->all[anchor] = sum;
        s->has_all[anchor] = true;
    }
    return s->all[anchor];
}

static ct_ex3 moment_turning(struct reach *s, int anchor, int cluster)
{
    struct ct_build *b = s->b;
    const size_t at_pair = at(s, anchor, cluster);
    const enum share part = share(s, anchor, cluster);
    if (part == NONE)
        return zero3;
    if (part == ALL)
        return moment_outboard(s, anchor);
    if (!s->has_h[at_pair]) {
        ct_ex3 sum = zero3;
        for (int i = s->first[anchor]; i >= 0; i = s->next[i]) {
            if (turns_with(s, cluster, b->star[i].cluster))
                sum = ct_ex3_add(b->x, sum, star_moment(s, i));
            for (int k = 0; k < b->star[i].nchild; k++)
                sum = ct_ex3_add(
                    b->x, sum,
                    moment_turning(s, b->child[b->star[i].first_child + k], cluster));
        }
        s->h[at_pair] = sum;
        s->has_h[at_pair] = true;
    }
    return s->h[at_pair];
}

// ---- composite inertia ------------------------------------------------------------------------------

static void add_tensor(struct ct_build *b, ct_ex33 *sum, const ct_ex33 *a)
{
    for (int i = 0; i < 9; i++)
        sum->e[i] = ct_ex_add(b->x, sum->e[i], a->e[i]);
}

// d x (s x h) + h x (s x d) = [2 (d.h) 1 - d h' - h d'] s; planar: 2 (d.h), kept in the last entry.
static ct_ex33 cross_inertia(struct ct_build *b, ct_ex3 d, ct_ex3 h)
{
    struct ct_exs *x = b->x;
    const ct_ex twice = ct_ex_scale(x, 2, ct_ex3_dot(x, d, h));
    ct_ex33 X = {{{0}}};
    if (b->is_planar) {
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

static const ct_ex33 *cross_outboard(struct reach *s, int anchor)
{
    struct ct_build *b = s->b;
    if (!s->has_cross[anchor]) {
        ct_ex33 sum = {{{0}}};
        for (int i = s->first[anchor]; i >= 0; i = s->next[i])
            for (int k = 0; k < b->star[i].nchild; k++) {
                const int child = b->child[b->star[i].first_child + k];
                const ct_ex33 X
                    = cross_inertia(b, link_in_plane(s, child), moment_outboard(s, child));
                add_tensor(b, &sum, cross_outboard(s, child));
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
    const ct_ex33 *L = &b->cluster[c].L, *R = &b->cluster[c].R;
    ct_ex33 out = {{{0}}};
    if (b->is_planar) {
        out.e[8] = ct_ex3_dot(x, b->plane[2], ct_ex33_apply(x, L, b->plane[2]));
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

static void sum_inertias(struct reach *s)
{
    struct ct_build *b = s->b;
    for (size_t c = b->ncluster; c-- > 1;) {
        const ct_ex33 own = ct_cluster_inertia(b, (int)c);
        add_tensor(b, &s->inertia[c], &s->outboard[c]);
        add_tensor(b, &s->inertia[c], &own);
        if (b->cluster[c].parent > 0)
            add_tensor(b, &s->outboard[b->cluster[c].parent], &s->inertia[c]);
    }
}

// Inertia of everything that turns with a cluster, about the point where its vectors start.
static void add_full_anchors(struct reach *s, int anchor, int cluster, ct_ex33 *sum)
{
    struct ct_build *b = s->b;
    const enum share part = share(s, anchor, cluster);
    if (part == NONE)
        return;
    if (part == ALL) {
        add_tensor(b, sum, cross_outboard(s, anchor));
        return;
    }
    for (int i = s->first[anchor]; i >= 0; i = s->next[i])
        for (int k = 0; k < b->star[i].nchild; k++)
            add_full_anchors(s, b->child[b->star[i].first_child + k], cluster, sum);
}

// ---- torques of a column ----------------------------------------------------------------------------

// The column under work: spin of `cluster` about `axis`.
struct column {
    int cluster;
    ct_ex3 axis;
    ct_ex33 inertia;
    bool is_local;   // the inertia is the cluster's own and the axis is fixed in it:
    ct_ex3 momentum; // their product in its axes, constant
    ct_ex3 *torque;  // by anchor, of everything outboard
    bool *has_torque;
};

// a x (axis x v): planar: (a . v) along the axis.
static ct_ex3 double_cross(struct ct_build *b, const struct column *c, ct_ex3 a, ct_ex3 v)
{
    if (b->is_planar)
        return ct_ex3_scale(b->x, ct_ex3_dot(b->x, a, v), c->axis);
    return ct_ex3_cross(b->x, a, ct_ex3_cross(b->x, c->axis, v));
}

static ct_ex3 star_torque(struct reach *s, const struct column *c, int star)
{
    struct ct_build *b = s->b;
    const struct ct_star *self = &b->star[star];
    ct_ex3 sum
        = double_cross(b, c, star_moment(s, star), reach_of(s, self->anchor, c->cluster));
    for (int k = 0; k < self->nchild; k++) {
        const int child = b->child[self->first_child + k];
        sum = ct_ex3_add(
            b->x, sum,
            double_cross(b, c, link_in_plane(s, child), moment_turning(s, child, c->cluster)));
    }
    return sum;
}

// Torque about an anchor of everything outboard, the inertia of the column itself left out.
static ct_ex3 anchor_torque(struct reach *s, const struct column *c, int anchor)
{
    struct ct_build *b = s->b;
    if (!s->nstar[anchor])
        return zero3;
    if (c->has_torque[anchor])
        return c->torque[anchor];
    if (share(s, anchor, c->cluster) != SOME)
        return double_cross(b, c, moment_outboard(s, anchor), reach_of(s, anchor, c->cluster));
    ct_ex3 sum = zero3;
    for (int i = s->first[anchor]; i >= 0; i = s->next[i]) {
        sum = ct_ex3_add(b->x, sum, star_torque(s, c, i));
        for (int k = 0; k < b->star[i].nchild; k++)
            sum = ct_ex3_add(b->x, sum,
                             anchor_torque(s, c, b->child[b->star[i].first_child + k]));
    }
    c->torque[anchor] = sum;
    c->has_torque[anchor] = true;
    return sum;
}

// Torque on all that turns with a row's cluster.
static ct_ex3 row_torque(struct reach *s, const struct column *c, int row, int anchor)
{
    struct ct_build *b = s->b;
    const enum share part = share(s, anchor, row);
    if (part == NONE)
        return zero3;
    if (part == ALL)
        return anchor_torque(s, c, anchor);
    ct_ex3 sum = zero3;
    for (int i = s->first[anchor]; i >= 0; i = s->next[i]) {
        if (turns_with(s, row, b->star[i].cluster))
            sum = ct_ex3_add(b->x, sum, star_torque(s, c, i));
        for (int k = 0; k < b->star[i].nchild; k++)
            sum = ct_ex3_add(b->x, sum,
                             row_torque(s, c, row, b->child[b->star[i].first_child + k]));
    }
    return sum;
}

static ct_ex3 column_inertia_torque(struct ct_build *b, const struct column *c)
{
    if (b->is_planar)
        return ct_ex3_scale(b->x, c->inertia.e[8], c->axis);
    if (c->is_local)
        return ct_cluster_turn(b, c->cluster, c->momentum);
    return ct_ex33_apply(b->x, &c->inertia, c->axis);
}

// ---- the matrix -------------------------------------------------------------------------------------

static void add_entry(struct ct_build *b, ct_ex *M, int k, int l, ct_ex v)
{
    const size_t n = b->eqs->nu;
    const size_t i = (size_t)(k > l ? k : l) + n * (size_t)(k > l ? l : k);
    M[i] = ct_ex_add(b->x, M[i], v);
}

void ct_mass_spread(struct ct_build *b, ct_ex *M, const struct ct_term *p, int np,
                    const struct ct_term *q, int nq, ct_ex m)
{
    for (int i = 0; i < np; i++)
        for (int j = 0; j < nq; j++) {
            if (p[i].speed < 0 || q[j].speed < 0)
                continue;
            ct_ex v = ct_ex_mul(b->x, ct_ex_mul(b->x, p[i].coef, q[j].coef), m);
            if (p[i].speed == q[j].speed)
                v = ct_ex_scale(b->x, 2, v);
            add_entry(b, M, p[i].speed, q[j].speed, v);
        }
}

static void spread_self(struct ct_build *b, ct_ex *M, const struct ct_term *p, int np, ct_ex m)
{
    for (int i = 0; i < np; i++)
        for (int j = 0; j <= i; j++)
            if (p[i].speed >= 0 && p[j].speed >= 0)
                add_entry(b, M, p[i].speed, p[j].speed,
                          ct_ex_mul(b->x, ct_ex_mul(b->x, p[i].coef, p[j].coef), m));
}

static bool has_unknown(const struct ct_term *p, int np)
{
    for (int i = 0; i < np; i++)
        if (p[i].speed >= 0)
            return true;
    return false;
}

// Does the column of cluster c serve the row of cluster r? The outer one of two nested clusters is the
// column; of two side by side the one whose vectors start farther out.
static bool is_row_of(const struct ct_build *b, const int *depth, int r, int c)
{
    if (ct_cluster_is_outboard(b, r, c))
        return true;
    if (ct_cluster_is_outboard(b, c, r))
        return false;
    return depth[r] != depth[c] ? depth[r] < depth[c] : r < c;
}

static void spin_column(struct reach *s, ct_ex *M, size_t r, const struct column *c,
                        const int *depth)
{
    struct ct_build *b = s->b;
    const struct ct_spin *self = &b->spin[r];
    const ct_ex3 own = column_inertia_torque(b, c);
    for (size_t row = 0; row < b->nspin; row++) {
        const struct ct_spin *other = &b->spin[row];
        const bool same = other->cluster == c->cluster;
        if ((same && row > r) || !is_row_of(b, depth, other->cluster, c->cluster)
            || !has_unknown(other->term, other->nterm))
            continue;
        const int start = s->start[other->cluster];
        ct_ex3 torque = start < 0 ? zero3 : row_torque(s, c, other->cluster, start);
        const bool is_fixed = same && c->is_local && !ct_ex3_is_zero(other->local);
        if (!is_fixed && ct_cluster_is_outboard(b, other->cluster, c->cluster))
            torque = ct_ex3_add(b->x, own, torque);
        ct_ex m = ct_ex3_dot(b->x, other->axis, torque);
        if (is_fixed)
            m = ct_ex_add(b->x, m, ct_ex3_dot(b->x, other->local, c->momentum));
        if (row == r)
            spread_self(b, M, self->term, self->nterm, m);
        else
            ct_mass_spread(b, M, self->term, self->nterm, other->term, other->nterm, m);
    }
    // slides carried by the spin, or that carry it: p . (s x (m g + h))
    for (size_t a = 1; a < b->nanchor; a++) {
        const struct ct_anchor *anchor = &b->anchor[a];
        for (int k = 0; k < anchor->nslide; k++) {
            const struct ct_slide *slide = &anchor->slide[k];
            const struct ct_term along = {slide->speed, slide->driver, CT_EX_ONE};
            if (slide->speed < 0)
                continue;
            const ct_ex3 g = reach_of(s, (int)a, c->cluster);
            const ct_ex3 moved = ct_ex3_add(b->x, ct_ex3_scale(b->x, anchor->mass, g),
                                            moment_turning(s, (int)a, c->cluster));
            if (ct_ex3_is_zero(moved))
                continue;
            const ct_ex3 p = ct_cluster_turn(b, anchor->cluster, slide->p);
            const ct_ex m = ct_ex3_dot(b->x, p, ct_ex3_cross(b->x, c->axis, moved));
            ct_mass_spread(b, M, self->term, self->nterm, &along, 1, m);
        }
    }
}

static void slide_pairs(struct ct_build *b, ct_ex *M)
{
    for (size_t i = 1; i < b->nanchor; i++)
        for (size_t j = 1; j <= i; j++) {
            if (!b->anchor[i].nslide || !b->anchor[j].nslide
                || !ct_anchor_is_outboard(b, (int)j, (int)i))
                continue;
            const struct ct_anchor *out = &b->anchor[i], *in = &b->anchor[j];
            for (int k = 0; k < out->nslide; k++)
                for (int l = 0; l < (i == j ? k + 1 : in->nslide); l++) {
                    if (out->slide[k].speed < 0 || in->slide[l].speed < 0)
                        continue;
                    const bool fixed = out->cluster == in->cluster;
                    const ct_ex3 p = fixed ? out->slide[k].p
                                           : ct_cluster_turn(b, out->cluster, out->slide[k].p);
                    const ct_ex3 q = fixed ? in->slide[l].p
                                           : ct_cluster_turn(b, in->cluster, in->slide[l].p);
                    const ct_ex m = ct_ex_mul(b->x, out->mass, ct_ex3_dot(b->x, p, q));
                    const struct ct_term tp = {out->slide[k].speed, -1, CT_EX_ONE};
                    const struct ct_term tq = {in->slide[l].speed, -1, CT_EX_ONE};
                    if (i == j && k == l)
                        spread_self(b, M, &tp, 1, m);
                    else
                        ct_mass_spread(b, M, &tp, 1, &tq, 1, m);
                }
        }
}

static struct reach reach_create(struct ct_build *b)
{
    const size_t na = b->nanchor, nc = b->ncluster, ns = b->nstar + 1;
    struct reach s = {.b = b};
    s.nstar = CT_NEWN(b->arena, int, na);
    s.nturning = CT_NEWN(b->arena, int, na *nc);
    s.g = CT_NEWN(b->arena, ct_ex3, na * nc);
    s.h = CT_NEWN(b->arena, ct_ex3, na * nc);
    s.has_g = CT_NEWN(b->arena, bool, na *nc);
    s.has_h = CT_NEWN(b->arena, bool, na *nc);
    s.moment = CT_NEWN(b->arena, ct_ex3, ns);
    s.has_moment = CT_NEWN(b->arena, bool, ns);
    s.all = CT_NEWN(b->arena, ct_ex3, na);
    s.has_all = CT_NEWN(b->arena, bool, na);
    s.cross = CT_NEWN(b->arena, ct_ex33, na);
    s.has_cross = CT_NEWN(b->arena, bool, na);
    s.inertia = CT_NEWN(b->arena, ct_ex33, nc);
    s.outboard = CT_NEWN(b->arena, ct_ex33, nc);
    s.first = CT_NEWN(b->arena, int, na);
    s.next = CT_NEWN(b->arena, int, ns);
    s.start = CT_NEWN(b->arena, int, nc);
    count_stars(&s);
    find_starts(&s);
    sum_inertias(&s);
    return s;
}

// Depth in anchors of the first star that turns with a cluster.
static int *start_depths(struct reach *s)
{
    struct ct_build *b = s->b;
    int *depth = CT_NEWN(b->arena, int, b->ncluster), *of = CT_NEWN(b->arena, int, b->nanchor);
    for (size_t a = 1; a < b->nanchor; a++)
        of[a] = of[b->anchor[a].parent] + 1;
    for (size_t c = 0; c < b->ncluster; c++)
        depth[c] = (int)b->nanchor;
    for (size_t i = 0; i < b->nstar; i++)
        for (int c = b->star[i].cluster; c > 0; c = b->cluster[c].parent)
            if (of[b->star[i].anchor] < depth[c])
                depth[c] = of[b->star[i].anchor];
    return depth;
}

static bool is_zero(const ct_ex33 *A)
{
    for (int i = 0; i < 9; i++)
        if (!ct_ex_is_zero(A->e[i]))
            return false;
    return true;
}

void ct_mass_matrix_derive(struct ct_build *b)
{
    struct ct_equations *e = b->eqs;
    struct reach s = reach_create(b);
    ct_ex *M = CT_NEWN(b->arena, ct_ex, e->nu * e->nu + 1);
    const int *depth = start_depths(&s);
    for (size_t r = 0; r < b->nspin; r++) {
        const struct ct_spin *self = &b->spin[r];
        struct column c = {.cluster = self->cluster, .axis = self->axis};
        if (!has_unknown(self->term, self->nterm))
            continue;
        c.inertia = s.outboard[c.cluster];
        c.torque = CT_NEWN(b->arena, ct_ex3, b->nanchor);
        c.has_torque = CT_NEWN(b->arena, bool, b->nanchor);
        add_full_anchors(&s, 0, c.cluster, &c.inertia);
        c.is_local = !b->is_planar && !ct_ex3_is_zero(self->local) && is_zero(&c.inertia);
        if (c.is_local) {
            c.momentum = ct_ex33_apply(b->x, &b->cluster[c.cluster].L, self->local);
        } else {
            c.inertia = s.inertia[c.cluster];
            add_full_anchors(&s, 0, c.cluster, &c.inertia);
        }
        spin_column(&s, M, r, &c, depth);
    }
    slide_pairs(b, M);
    ct_flexible_mass(b, M);
    for (size_t i = 0; i < e->nu; i++)
        for (size_t j = 0; j <= i; j++) {
            const struct ct_entry entry = {(int)i, (int)j, M[i + e->nu * j]};
            if (!ct_ex_is_zero(entry.value))
                CT_PUSH(b->arena, e->M, e->nM, e->M_cap, entry);
        }
}
