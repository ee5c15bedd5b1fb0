// Names for the expressions of the recursion, such as angular velocities; see reduced.h.
#include "report/reduced.h"

struct labels {
    struct ct_build *b;
    enum ct_level level;
};

// Sets the label of an expression. The label of -e is stored with a sign at e, in the recursive
// form alone, where share.h removes the sign.
static void label(const struct labels *l, ct_ex e, const char *letter, const char *name,
                  const char *part)
{
    struct ct_exs *x = l->b->x;
    const struct ct_exnode n = *ct_ex_node(x, e);
    const bool is_negative = n.op == CT_OP_NEG;
    if (ct_ex_is_const(x, e, NULL) || ct_ex_symbol(x, e)
        || (is_negative && l->level != CT_FULL))
        return;
    ct_ex_label(
        x, is_negative ? (ct_ex){n.a} : e,
        ct_arena_printf(x->arena, "%s%s_%s%s", is_negative ? "-" : "", letter, name, part));
}

static void label3(const struct labels *l, ct_ex3 v, const char *letter, const char *name)
{
    static const char *const part[] = {".x", ".y", ".z"};
    for (int i = 0; i < 3; i++)
        label(l, v.e[i], letter, name, part[i]);
}

static void label33(const struct labels *l, const ct_ex33 *A, const char *letter,
                    const char *name)
{
    static const char *const part[]
        = {".xx", ".yx", ".zx", ".xy", ".yy", ".zy", ".xz", ".yz", ".zz"};
    for (int i = 0; i < 9; i++)
        label(l, A->e[i], letter, name, part[i]);
}

// The first node of each cluster, the frame of its own body if there is one; and the first node
// at each anchor.
static void name_clusters(const struct ct_build *b, const char **cluster, const char **anchor)
{
    for (size_t i = 0; i < b->topology->nnode; i++) {
        const struct ct_node_placement *p = &b->kinematics->placement[i];
        if (!cluster[p->frame])
            cluster[p->frame] = b->topology->node[i].name;
        if (!anchor[p->anchor] && ct_ex3_is_zero(p->local))
            anchor[p->anchor] = b->topology->node[i].name;
    }
}

static bool is_same(ct_ex3 a, ct_ex3 b)
{
    return ct_ex_same(a.e[0], b.e[0]) && ct_ex_same(a.e[1], b.e[1])
        && ct_ex_same(a.e[2], b.e[2]);
}

// Anchors with nodes placed relative to the previous anchor: the last of these nodes, the frame
// from which the path continues.
static void name_ends_of_links(struct ct_build *b, const char **anchor)
{
    const struct ct_kinematics *k = b->kinematics;
    size_t *first = CT_NEWN(b->ctx->scratch, size_t, k->nanchor + 1),
           *next = CT_NEWN(b->ctx->scratch, size_t, k->nanchor + 1);
    for (size_t a = k->nanchor; a-- > 1;) {
        next[a] = first[k->anchor[a].parent];
        first[k->anchor[a].parent] = a;
    }
    for (size_t i = b->topology->nnode; i-- > 0;) {
        const struct ct_node_placement *p = &k->placement[i];
        for (size_t a = first[p->anchor]; a; a = next[a])
            if (!anchor[a] && k->anchor[a].cluster == p->cluster
                && is_same(k->anchor[a].local, p->local))
                anchor[a] = b->topology->node[i].name;
    }
}

static void label_cluster(const struct labels *l, int c, const char *name)
{
    struct ct_build *b = l->b;
    const struct ct_cluster *self = &b->kinematics->cluster[c];
    if (self->has_angle) {
        label(l, self->angle, "phi", name, "");
        label(l, ct_ex_fun(b->x, CT_OP_SIN, self->angle), "s", name, "");
        label(l, ct_ex_fun(b->x, CT_OP_COS, self->angle), "c", name, "");
    }
    label33(l, &self->R, "R", name);
    label3(l, self->w, "w", name);
    if (b->cache.cluster[c].has_al[l->level])
        label3(l, b->cache.cluster[c].al[l->level], "al", name);
}

static void label_anchor(const struct labels *l, int a, const char *name)
{
    const struct ct_anchor_cache *self = &l->b->cache.anchor[a];
    if (self->has_d)
        label3(l, self->d, "d", name);
    if (self->has_v)
        label3(l, self->v, "v", name);
    if (l->level == CT_BIAS && self->has_a[CT_BIAS])
        label3(l, self->a[CT_BIAS], "a", name);
}

// Labels the sums over outboard bodies at each anchor: masses, first moments, inertias.
static void label_lumped(const struct labels *l, const char *const *cluster,
                         const char *const *anchor)
{
    const struct ct_lumped_masses *m = &l->b->dynamics.masses;
    for (size_t a = 1; a < l->b->kinematics->nanchor; a++)
        if (anchor[a])
            label(l, m->mass[a], "m", anchor[a], "");
    for (size_t i = 0; i < m->naugmented_body; i++)
        if (cluster[m->augmented_body[i].cluster])
            label3(l, m->augmented_body[i].moment, "h", cluster[m->augmented_body[i].cluster]);
    for (size_t c = 1; c < l->b->kinematics->ncluster; c++)
        if (cluster[c])
            label33(l, &m->inertia[c], "I", cluster[c]);
}

void ct_reduced_label(struct ct_equations *e, enum ct_level level)
{
    struct ct_build *b = e->build;
    const struct labels labels = {b, level}, *l = &labels;
    const char **cluster = CT_NEWN(b->x->arena, const char *, b->kinematics->ncluster + 1);
    const char **anchor = CT_NEWN(b->x->arena, const char *, b->kinematics->nanchor + 1);
    name_clusters(b, cluster, anchor);
    if (level == CT_FULL)
        name_ends_of_links(b, anchor);
    for (size_t c = 1; c < b->kinematics->ncluster; c++)
        if (cluster[c])
            label_cluster(l, (int)c, cluster[c]);
    for (size_t a = 1; a < b->kinematics->nanchor; a++)
        if (anchor[a])
            label_anchor(l, (int)a, anchor[a]);
    const struct ct_sweep *s = b->dynamics.sweep[level];
    for (size_t a = 1; s && a < b->kinematics->nanchor; a++)
        if (anchor[a]) {
            label3(l, level == CT_FULL ? s->rest[a] : s->force[a], "F", anchor[a]);
            if (level == CT_FULL)
                label3(l, s->apparent[a], "a", anchor[a]);
        }
    for (size_t c = 1; s && c < b->kinematics->ncluster; c++)
        if (cluster[c])
            label3(l, s->torque[c], "T", cluster[c]);
    if (s && level == CT_FULL)
        label_lumped(l, cluster, anchor);
}
