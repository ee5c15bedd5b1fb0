// Names by meaning for the expressions of the recursion; see reduced.h.
#include "report/reduced.h"

#include "formulate/dynamics/dynamics.h"

static void label(struct ct_build *b, ct_ex e, const char *letter, const char *name,
                  const char *part)
{
    if (ct_ex_is_const(b->x, e, NULL) || ct_ex_symbol(b->x, e))
        return;
    const bool negative = ct_ex_node(b->x, e)->op == CT_OP_NEG;
    if (negative) // the same text without its sign belongs to someone else
        return;
    ct_ex_label(b->x, e, ct_arena_printf(b->x->arena, "%s_%s%s", letter, name, part));
}

static void label3(struct ct_build *b, ct_ex3 v, const char *letter, const char *name)
{
    static const char *const part[] = {".x", ".y", ".z"};
    for (int i = 0; i < 3; i++)
        label(b, v.e[i], letter, name, part[i]);
}

static void label33(struct ct_build *b, const ct_ex33 *A, const char *letter, const char *name)
{
    static const char *const part[]
        = {".xx", ".yx", ".zx", ".xy", ".yy", ".zy", ".xz", ".yz", ".zz"};
    for (int i = 0; i < 9; i++)
        label(b, A->e[i], letter, name, part[i]);
}

// The first node that turns with each cluster, its own body's frame if there is one; and the first at
// each anchor.
static void name_places(const struct ct_build *b, const char **cluster, const char **anchor)
{
    for (size_t i = 0; i < b->topology->nnode; i++) {
        const struct ct_node_placement *p = &b->kinematics->placement[i];
        if (!cluster[p->frame])
            cluster[p->frame] = b->topology->node[i].name;
        if (!anchor[p->anchor] && ct_ex3_is_zero(p->local))
            anchor[p->anchor] = b->topology->node[i].name;
    }
}

static void label_cluster(struct ct_build *b, int c, const char *name)
{
    const struct ct_cluster *self = &b->kinematics->cluster[c];
    if (self->has_angle) {
        label(b, self->angle, "phi", name, "");
        label(b, ct_ex_fun(b->x, CT_OP_SIN, self->angle), "s", name, "");
        label(b, ct_ex_fun(b->x, CT_OP_COS, self->angle), "c", name, "");
    }
    label33(b, &self->R, "R", name);
    label3(b, self->w, "w", name);
    if (b->cache.cluster[c].has_al[CT_BIAS])
        label3(b, b->cache.cluster[c].al[CT_BIAS], "al", name);
}

static void label_anchor(struct ct_build *b, int a, const char *name)
{
    const struct ct_anchor_cache *self = &b->cache.anchor[a];
    if (self->has_d)
        label3(b, self->d, "d", name);
    if (self->has_v)
        label3(b, self->v, "v", name);
    if (self->has_a[CT_BIAS])
        label3(b, self->a[CT_BIAS], "a", name);
}

void ct_reduced_label(struct ct_equations *e)
{
    struct ct_build *b = e->build;
    const char **cluster = CT_NEWN(b->x->arena, const char *, b->kinematics->ncluster + 1);
    const char **anchor = CT_NEWN(b->x->arena, const char *, b->kinematics->nanchor + 1);
    name_places(b, cluster, anchor);
    for (size_t c = 1; c < b->kinematics->ncluster; c++)
        if (cluster[c])
            label_cluster(b, (int)c, cluster[c]);
    for (size_t a = 1; a < b->kinematics->nanchor; a++)
        if (anchor[a])
            label_anchor(b, (int)a, anchor[a]);
    const struct ct_sweep *s = b->dynamics.sweep[CT_BIAS];
    for (size_t a = 1; s && a < b->kinematics->nanchor; a++)
        if (anchor[a])
            label3(b, s->force[a], "F", anchor[a]);
    for (size_t c = 1; s && c < b->kinematics->ncluster; c++)
        if (cluster[c])
            label3(b, s->torque[c], "T", cluster[c]);
}
