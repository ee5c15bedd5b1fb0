// See couplings.h.
#include "formulate/dynamics/couplings.h"

#include "base/sort.h"
#include "formulate/mass_sums.h"

// Lists by cluster in one array; the list of cluster c begins at first[c].
struct lists {
    int *index;
    size_t *first;
};

struct ct_couplings {
    struct lists axes, slides;
};

struct entry {
    int cluster, index;
};

struct entries {
    struct entry *entry;
    size_t n, cap;
};

struct search {
    const struct ct_build *b;
    struct ct_arena *a;
    struct entries axes, slides;
    int *rotating; // clusters that rotate a link of the current path
    size_t nrotating;
    bool *is_rotating; // by cluster
};

static void add(struct search *s, struct entries *l, int cluster, int index)
{
    const struct entry e = {cluster, index};
    CT_PUSH(s->a, l->entry, l->n, l->cap, e);
}

static void add_axes(struct search *s, int cluster, int other)
{
    const struct ct_cluster *c = &s->b->kinematics->cluster[other];
    for (int k = 0; k < c->naxis; k++)
        add(s, &s->axes, cluster, c->first_axis + k);
}

// Extends the path by a vector that rotates with a cluster and so with its inboard clusters.
static void enter(struct search *s, int cluster)
{
    for (int c = cluster; c > 0 && !s->is_rotating[c];
         c = s->b->kinematics->cluster[c].parent) {
        s->is_rotating[c] = true;
        s->rotating[s->nrotating++] = c;
        for (size_t i = 0; i < s->nrotating; i++) {
            add_axes(s, c, s->rotating[i]);
            add_axes(s, s->rotating[i], c);
        }
    }
}

static void leave(struct search *s, size_t nrotating)
{
    while (s->nrotating > nrotating)
        s->is_rotating[s->rotating[--s->nrotating]] = false;
}

static int compare_enter(const void *context, const void *a, const void *b)
{
    const struct ct_anchor *anchor = context;
    const int x = anchor[*(const int *)a].enter, y = anchor[*(const int *)b].enter;
    return (x > y) - (x < y);
}

// Visits the anchors in preorder. The path to an anchor is the previous path, shortened and
// extended.
static void walk(struct search *s, const struct ct_composite_sums *sums)
{
    const struct ct_build *b = s->b;
    int *order = CT_NEWN(s->a, int, b->kinematics->nanchor),
        *path = CT_NEWN(s->a, int, b->kinematics->nanchor);
    size_t *before = CT_NEWN(s->a, size_t, b->kinematics->nanchor),
           depth = 0; // nrotating by depth of the path
    for (size_t i = 0; i < b->kinematics->nanchor; i++)
        order[i] = (int)i;
    ct_sort(s->a, order, b->kinematics->nanchor, sizeof *order, compare_enter,
            b->kinematics->anchor);
    for (size_t i = 0; i < b->kinematics->nanchor; i++) {
        const int a = order[i];
        while (depth > 0 && !ct_anchor_is_outboard(b, path[depth - 1], a))
            leave(s, before[--depth]);
        before[depth] = s->nrotating;
        path[depth++] = a;
        if (a > 0)
            enter(s, b->kinematics->anchor[a].cluster);
        if (b->kinematics->anchor[a].ntranslation_axis) {
            for (size_t k = 0; k < s->nrotating; k++)
                add(s, &s->slides, s->rotating[k], a);
            for (int k = sums->first_pair[a]; k >= 0; k = sums->pair[k].next)
                add(s, &s->slides, sums->pair[k].cluster, a);
        }
        for (int k = sums->first[a]; k >= 0; k = sums->next[k]) {
            const size_t here = s->nrotating;
            enter(s, b->dynamics.masses.augmented_body[k].cluster);
            leave(s, here);
        }
    }
}

static int compare_entries(const void *context, const void *a, const void *b)
{
    (void)context;
    const struct entry *x = a, *y = b;
    return x->cluster != y->cluster ? (x->cluster > y->cluster) - (x->cluster < y->cluster)
                                    : (x->index > y->index) - (x->index < y->index);
}

// The entries sorted, without duplicates.
static struct lists list(struct search *s, struct entries *l)
{
    struct lists out = {CT_NEWN(s->b->arena, int, l->n + 1),
                        CT_NEWN(s->b->arena, size_t, s->b->kinematics->ncluster + 1)};
    ct_sort(s->a, l->entry, l->n, sizeof *l->entry, compare_entries, NULL);
    size_t n = 0, at = 0;
    for (size_t c = 0; c < s->b->kinematics->ncluster; c++) {
        out.first[c] = n;
        for (; at < l->n && l->entry[at].cluster == (int)c; at++)
            if (n == out.first[c] || out.index[n - 1] != l->entry[at].index)
                out.index[n++] = l->entry[at].index;
    }
    out.first[s->b->kinematics->ncluster] = n;
    return out;
}

const struct ct_couplings *ct_couplings_find(const struct ct_composite_sums *sums)
{
    const struct ct_build *b = sums->b;
    struct search s = {.b = b, .a = b->ctx->scratch};
    s.rotating = CT_NEWN(s.a, int, b->kinematics->ncluster);
    s.is_rotating = CT_NEWN(s.a, bool, b->kinematics->ncluster);
    for (size_t c = 1; c < b->kinematics->ncluster;
         c++) // inertia couples a cluster with its inboard clusters
        for (int in = (int)c; in > 0; in = b->kinematics->cluster[in].parent) {
            add_axes(&s, (int)c, in);
            add_axes(&s, in, (int)c);
        }
    walk(&s, sums);
    struct ct_couplings *c = CT_NEW(b->arena, struct ct_couplings);
    c->axes = list(&s, &s.axes);
    c->slides = list(&s, &s.slides);
    return c;
}

static struct ct_index_list list_of(const struct lists *l, int cluster)
{
    return (struct ct_index_list){l->index + l->first[cluster],
                                  l->first[cluster + 1] - l->first[cluster]};
}

struct ct_index_list ct_couplings_axes(const struct ct_couplings *c, int cluster)
{
    return list_of(&c->axes, cluster);
}

struct ct_index_list ct_couplings_slides(const struct ct_couplings *c, int cluster)
{
    return list_of(&c->slides, cluster);
}
