// The mass matrix by cutset sums over composite bodies.
//
// Rotation r about the axis s moves every point whose path contains vectors that rotate with its
// cluster. With the lever arm g (sum of these vectors on the path to a point) the point moves by
// s x g, and
//
//   M_r'r = s' . [ sum over augmented bodies that rotate with r' of  b x (s x g)
//                  + sum over links  d x (s x h)
//                  + (augmented inertia of what rotates with both) s ]
//
// where b is the first moment of an augmented body, d a link and h the sum of the outboard first
// moments that rotate with r. If everything outboard rotates with r, h and the inertia are those of
// a composite body, which are summed once. In a planar mechanism all terms are scalar. Of two
// coupled rotations the outer one is the column.
#include "formulate/beam/flexible_body.h"
#include "formulate/dynamics/composite_sums.h"
#include "formulate/dynamics/couplings.h"
#include "formulate/mass_sums.h"
#include "formulate/dynamics/dynamics.h"
#include "formulate/kinematics/kinematics.h"
#include "formulate/beam_dynamics/beam_dynamics.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- torques of a column -----------------------------------------------------------------------

// The current column: rotation of `cluster` about `axis`.
struct column {
    int cluster;
    ct_ex3 axis;
    ct_ex33 inertia;
    bool is_local;   // the inertia contains no outboard cluster, and the axis is fixed in it
    ct_ex3 momentum; // inertia * axis in axes of the cluster, constant
    ct_ex3 *torque;  // by anchor: torque of everything outboard
    int *has_torque; // by anchor: equal to `number` if torque is valid for this column
    int number;      // columns are numbered from 1
};

// a x (axis x v): planar: (a . v) along the axis.
static ct_ex3 double_cross(struct ct_build *b, const struct column *c, ct_ex3 a, ct_ex3 v)
{
    if (b->topology->is_planar)
        return ct_ex3_scale(b->x, ct_ex3_dot(b->x, a, v), c->axis);
    return ct_ex3_cross(b->x, a, ct_ex3_cross(b->x, c->axis, v));
}

static ct_ex3 augmented_body_torque(struct ct_composite_sums *s, const struct column *c,
                                    int body)
{
    struct ct_build *b = s->b;
    const struct ct_augmented_body *self = &b->dynamics.masses.augmented_body[body];
    ct_ex3 sum = double_cross(b, c, ct_composite_sums_body_moment(s, body),
                              ct_composite_sums_lever_arm(s, self->anchor, c->cluster));
    for (int k = 0; k < self->nchild; k++) {
        const int child = b->dynamics.masses.child[self->first_child + k];
        sum = ct_ex3_add(b->x, sum,
                         double_cross(b, c, ct_composite_sums_link(s, child),
                                      ct_composite_sums_moment_turning(s, child, c->cluster)));
    }
    return sum;
}

// Torque of everything outboard about an anchor, without the augmented inertia of the column.
static ct_ex3 anchor_torque(struct ct_composite_sums *s, const struct column *c, int anchor)
{
    struct ct_build *b = s->b;
    if (!s->nstar[anchor])
        return zero3;
    if (c->has_torque[anchor] == c->number)
        return c->torque[anchor];
    if (ct_composite_sums_turning(s, anchor, c->cluster) != CT_TURNS_SOME)
        return double_cross(b, c, ct_composite_sums_moment(s, anchor),
                            ct_composite_sums_lever_arm(s, anchor, c->cluster));
    ct_ex3 sum = zero3;
    for (int i = s->first[anchor]; i >= 0; i = s->next[i]) {
        sum = ct_ex3_add(b->x, sum, augmented_body_torque(s, c, i));
        for (int k = 0; k < b->dynamics.masses.augmented_body[i].nchild; k++)
            sum = ct_ex3_add(
                b->x, sum,
                anchor_torque(
                    s, c,
                    b->dynamics.masses
                        .child[b->dynamics.masses.augmented_body[i].first_child + k]));
    }
    c->torque[anchor] = sum;
    c->has_torque[anchor] = c->number;
    return sum;
}

// Torque on everything that rotates with the cluster of a row.
static ct_ex3 row_torque(struct ct_composite_sums *s, const struct column *c, int row,
                         int anchor)
{
    struct ct_build *b = s->b;
    const enum ct_turning part = ct_composite_sums_turning(s, anchor, row);
    if (part == CT_TURNS_NONE)
        return zero3;
    if (part == CT_TURNS_ALL)
        return anchor_torque(s, c, anchor);
    ct_ex3 sum = zero3;
    for (int i = ct_composite_sums_first_part(s, anchor, row); i >= 0; i = s->part[i].next) {
        const struct ct_composite_part *t = &s->part[i];
        sum = ct_ex3_add(b->x, sum,
                         t->child < 0 ? augmented_body_torque(s, c, t->body)
                                      : row_torque(s, c, row, t->child));
    }
    return sum;
}

static ct_ex3 column_inertia_torque(struct ct_build *b, const struct column *c)
{
    if (b->topology->is_planar)
        return ct_ex3_scale(b->x, c->inertia.e[8], c->axis);
    if (c->is_local)
        return ct_cluster_turn(b, c->cluster, c->momentum);
    return ct_ex33_apply(b->x, &c->inertia, c->axis);
}

// ---- the matrix --------------------------------------------------------------------------------

static void spread_self(struct ct_build *b, struct ct_symmetric *M, const struct ct_term *p,
                        int np, ct_ex m)
{
    for (int i = 0; i < np; i++)
        for (int j = 0; j <= i; j++)
            if (p[i].speed >= 0 && p[j].speed >= 0)
                ct_symmetric_add(b->x, M, (size_t)p[i].speed, (size_t)p[j].speed,
                                 ct_ex_mul(b->x, ct_ex_mul(b->x, p[i].coef, p[j].coef), m));
}

static bool has_unknown(const struct ct_term *p, int np)
{
    for (int i = 0; i < np; i++)
        if (p[i].speed >= 0)
            return true;
    return false;
}

// Is the entry of clusters r and c computed from column c? Of two nested clusters the outer one is
// the column. Of two others it is the one whose rotating vectors start farther from ground.
static bool is_row_of(const struct ct_build *b, const int *depth, int r, int c)
{
    if (ct_cluster_is_outboard(b, r, c))
        return true;
    if (ct_cluster_is_outboard(b, c, r))
        return false;
    return depth[r] != depth[c] ? depth[r] < depth[c] : r < c;
}

static void rotation_column(struct ct_composite_sums *s, struct ct_symmetric *M, size_t r,
                            const struct column *c, const int *depth,
                            const struct ct_couplings *couplings)
{
    struct ct_build *b = s->b;
    const struct ct_rotation_axis *self = &b->kinematics->rotation_axis[r];
    const ct_ex3 own = column_inertia_torque(b, c);
    const struct ct_index_list rows = ct_couplings_axes(couplings, c->cluster);
    for (size_t i = 0; i < rows.n; i++) {
        const size_t row = (size_t)rows.index[i];
        const struct ct_rotation_axis *other = &b->kinematics->rotation_axis[row];
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
    // translations inboard or outboard of the rotation: p . (s x (m g + h))
    const struct ct_index_list slides = ct_couplings_slides(couplings, c->cluster);
    for (size_t i = 0; i < slides.n; i++) {
        const size_t a = (size_t)slides.index[i];
        const struct ct_anchor *anchor = &b->kinematics->anchor[a];
        for (int k = 0; k < anchor->ntranslation_axis; k++) {
            const struct ct_translation_axis *slide = &anchor->translation_axis[k];
            const struct ct_term along = {slide->speed, slide->driver, CT_EX_ONE};
            if (slide->speed < 0)
                continue;
            const ct_ex3 g = ct_composite_sums_lever_arm(s, (int)a, c->cluster);
            const ct_ex3 moved
                = ct_ex3_add(b->x, ct_ex3_scale(b->x, b->dynamics.masses.mass[a], g),
                             ct_composite_sums_moment_turning(s, (int)a, c->cluster));
            if (ct_ex3_is_zero(moved))
                continue;
            const ct_ex3 p = ct_cluster_turn(b, anchor->cluster, slide->p);
            const ct_ex m = ct_ex3_dot(b->x, p, ct_ex3_cross(b->x, c->axis, moved));
            ct_mass_spread(b, M, self->term, self->nterm, &along, 1, m);
        }
    }
}

static void translation_pair(struct ct_build *b, struct ct_symmetric *M, size_t i, size_t j)
{
    const struct ct_anchor *out = &b->kinematics->anchor[i], *in = &b->kinematics->anchor[j];
    for (int k = 0; k < out->ntranslation_axis; k++)
        for (int l = 0; l < (i == j ? k + 1 : in->ntranslation_axis); l++) {
            if (out->translation_axis[k].speed < 0 || in->translation_axis[l].speed < 0)
                continue;
            const bool fixed = out->cluster == in->cluster;
            const ct_ex3 p = fixed
                               ? out->translation_axis[k].p
                               : ct_cluster_turn(b, out->cluster, out->translation_axis[k].p);
            const ct_ex3 q = fixed ? in->translation_axis[l].p
                                   : ct_cluster_turn(b, in->cluster, in->translation_axis[l].p);
            const ct_ex m = ct_ex_mul(b->x, b->dynamics.masses.mass[i], ct_ex3_dot(b->x, p, q));
            const struct ct_term tp = {out->translation_axis[k].speed, -1, CT_EX_ONE};
            const struct ct_term tq = {in->translation_axis[l].speed, -1, CT_EX_ONE};
            if (i == j && k == l)
                spread_self(b, M, &tp, 1, m);
            else
                ct_mass_spread(b, M, &tp, 1, &tq, 1, m);
        }
}

// Entries between the translations of an anchor and those of its inboard anchors.
static void translation_pairs(struct ct_build *b, struct ct_symmetric *M)
{
    int *sliding = CT_NEWN(
            b->arena, int,
            b->kinematics
                ->nanchor), // nearest anchor inboard with translation, itself included; 0: none
        *path = CT_NEWN(b->arena, int, b->kinematics->nanchor);
    for (size_t i = 1; i < b->kinematics->nanchor; i++) {
        const bool slides = b->kinematics->anchor[i].ntranslation_axis > 0;
        sliding[i] = slides ? (int)i : sliding[b->kinematics->anchor[i].parent];
        size_t n = 0;
        for (int a = slides ? (int)i : 0; a > 0; a = sliding[b->kinematics->anchor[a].parent])
            path[n++] = a;
        while (n-- > 0)
            translation_pair(b, M, i, (size_t)path[n]);
    }
}

// Depth, in anchors, of the innermost augmented body that rotates with each cluster.
static int *start_depths(struct ct_composite_sums *s)
{
    struct ct_build *b = s->b;
    int *depth = CT_NEWN(b->arena, int, b->kinematics->ncluster),
        *of = CT_NEWN(b->arena, int, b->kinematics->nanchor);
    for (size_t a = 1; a < b->kinematics->nanchor; a++)
        of[a] = of[b->kinematics->anchor[a].parent] + 1;
    for (size_t c = 0; c < b->kinematics->ncluster; c++)
        depth[c] = (int)b->kinematics->nanchor;
    for (size_t i = 0; i < b->dynamics.masses.naugmented_body; i++)
        for (int c = b->dynamics.masses.augmented_body[i].cluster; c > 0;
             c = b->kinematics->cluster[c].parent)
            if (of[b->dynamics.masses.augmented_body[i].anchor] < depth[c])
                depth[c] = of[b->dynamics.masses.augmented_body[i].anchor];
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
    struct ct_composite_sums s = ct_composite_sums_create(b);
    struct ct_arena *work = ct_arena_create_under(b->ctx->scratch);
    struct ct_symmetric M = ct_symmetric_create(work, e->nu);
    const int *depth = start_depths(&s);
    const struct ct_couplings *couplings = ct_couplings_find(&s);
    struct column c = {.torque = CT_NEWN(b->arena, ct_ex3, b->kinematics->nanchor),
                       .has_torque = CT_NEWN(b->arena, int, b->kinematics->nanchor)};
    for (size_t r = 0; r < b->kinematics->nrotation_axis; r++) {
        const struct ct_rotation_axis *self = &b->kinematics->rotation_axis[r];
        if (!has_unknown(self->term, self->nterm))
            continue;
        c.number++;
        c.cluster = self->cluster;
        c.axis = self->axis;
        c.inertia = s.descendants[c.cluster];
        ct_composite_sums_add_full(&s, 0, c.cluster, &c.inertia);
        c.is_local
            = !b->topology->is_planar && !ct_ex3_is_zero(self->local) && is_zero(&c.inertia);
        if (c.is_local) {
            c.momentum
                = ct_ex33_apply(b->x, &b->dynamics.masses.inertia[c.cluster], self->local);
        } else {
            c.inertia = s.inertia[c.cluster];
            ct_composite_sums_add_full(&s, 0, c.cluster, &c.inertia);
        }
        rotation_column(&s, &M, r, &c, depth, couplings);
    }
    translation_pairs(b, &M);
    ct_flexible_mass(b, &M);
    for (size_t k = e->nmotion; k < e->nmotion + e->nstate; k++)
        *ct_symmetric_at(&M, k, k) = CT_EX_ONE;
    for (size_t i = 0; i < e->nu; i++)
        for (size_t j = 0; j < M.row[i].n && M.row[i].place[j].column <= i; j++) {
            const struct ct_symmetric_place *p = &M.row[i].place[j];
            const struct ct_entry entry = {(int)i, (int)p->column, M.value[p->value]};
            if (!ct_ex_is_zero(entry.value))
                CT_PUSH(b->arena, e->M, e->nM, e->M_cap, entry);
        }
    ct_arena_destroy(work);
}
