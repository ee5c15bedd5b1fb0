// Positions along the translational tree: anchors connected by links, nodes at constant offsets.
//
// Consecutive branch vectors that are constant in the same cluster are added to one vector. A new
// anchor is made only where the cluster changes or the branch has translational coordinates.
#include "formulate/beam/flexible_body.h"
#include "formulate/kinematics/kinematics.h"

#include <assert.h>
#include <string.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

static bool same3(ct_ex3 a, ct_ex3 b)
{
    return ct_ex_same(a.e[0], b.e[0]) && ct_ex_same(a.e[1], b.e[1])
        && ct_ex_same(a.e[2], b.e[2]);
}

static bool is_moving(const struct ct_build *b, ct_ex3 v)
{
    const unsigned moving = 1u << CT_SYM_Q | 1u << CT_SYM_TIME;
    return (ct_ex_kinds(b->x, v.e[0]) | ct_ex_kinds(b->x, v.e[1]) | ct_ex_kinds(b->x, v.e[2]))
         & moving;
}

// ---- anchors ------------------------------------------------------------------------------------

static int add_anchor(struct ct_build *b, struct ct_kinematics *kinematics, int parent,
                      int cluster, ct_ex3 local)
{
    const struct ct_anchor a = {.parent = parent, .cluster = cluster, .local = local};
    CT_PUSH(b->arena, kinematics->anchor, kinematics->nanchor, kinematics->anchor_cap, a);
    return (int)kinematics->nanchor - 1;
}

// The anchor at a position; an existing one is reused.
static int anchor_at(struct ct_build *b, struct ct_kinematics *kinematics,
                     const struct ct_node_placement *p)
{
    if (ct_ex3_is_zero(p->local))
        return p->anchor;
    for (size_t i = kinematics->nanchor; i-- > 1;) {
        const struct ct_anchor *a = &kinematics->anchor[i];
        if (a->parent == p->anchor && a->cluster == p->cluster && !a->moves
            && same3(a->local, p->local))
            return (int)i;
    }
    return add_anchor(b, kinematics, p->anchor, p->cluster, p->local);
}

static void add_translation_axis(struct ct_build *b, struct ct_anchor *a, int speed, int driver,
                                 int sign, ct_ex3 along, ct_ex3 extra)
{
    if (sign < 0) {
        along = ct_ex3_neg(b->x, along);
        extra = ct_ex3_neg(b->x, extra);
    }
    if (!ct_ex3_is_zero(along) || !ct_ex3_is_zero(extra))
        a->translation_axis[a->ntranslation_axis++]
            = (struct ct_translation_axis){speed, driver, along, extra};
}

// Translation axes of a beam section along its elastic coordinates; `tail`: axes of the beam.
static void slide_section(struct ct_build *b, const struct ct_edge_info *e,
                          const struct ct_node_placement *tail, int sign, struct ct_anchor *a)
{
    const struct ct_flexible *f = ct_flexible_of_edge(b, e);
    const struct ct_edge_kinematics *kin = ct_edge_kinematics(b, e);
    a->translation_axis = CT_NEWN(b->arena, struct ct_translation_axis, f->nelastic + 1);
    a->ntranslation_axis = 0;
    for (int k = 0; k < f->nelastic; k++) {
        const ct_ex3 along = ct_ex33_apply(b->x, &tail->S, kin->translation[k]);
        ct_ex3 extra = zero3;
        if (kin->foreshortened)
            extra
                = ct_ex3_sub(b->x, ct_ex33_apply(b->x, &tail->S, kin->foreshortened[k]), along);
        add_translation_axis(b, a, f->elastic[k].u, -1, sign, along, extra);
    }
}

// Places a node after a branch with translational coordinates: it gets its own anchor.
static void place_translating(struct ct_build *b, struct ct_kinematics *kinematics,
                              const struct ct_edge_info *e, const struct ct_node_placement *p,
                              const struct ct_node_placement *tail, int sign, ct_ex3 vector,
                              struct ct_node_placement *self)
{
    const int cluster = tail->frame;
    const bool goes_on = p->cluster == cluster;
    const ct_ex3 fixed = goes_on ? p->local : zero3;
    const int parent = goes_on ? p->anchor : anchor_at(b, kinematics, p);
    const int i = add_anchor(b, kinematics, parent, cluster, ct_ex3_add(b->x, fixed, vector));
    struct ct_anchor *a = &kinematics->anchor[i];
    a->moves = true;
    a->fixed = fixed;
    a->sliding = vector;
    if (e->beam >= 0)
        slide_section(b, e, tail, sign, a);
    else
        a->translation_axis = CT_NEWN(b->arena, struct ct_translation_axis, e->ncoordinate + 1);
    for (int k = 0; k < e->ncoordinate; k++) {
        const struct ct_coordinate *c = &b->kinematics->coordinate[e->first_coordinate + k];
        ct_ex3 p_tail;
        for (int j = 0; j < 3; j++)
            p_tail.e[j] = ct_edge_partial(b, e, e->trial->d.e[j], k);
        add_translation_axis(b, a, c->u, c->driver, sign, ct_ex33_apply(b->x, &tail->S, p_tail),
                             zero3);
    }
    a->drift = ct_build_rate3(b, vector);
    a->drift_bias = ct_build_rate3(b, a->drift);
    self->anchor = i;
    self->cluster = cluster;
    self->local = zero3;
}

// Placement of the node whose axes the branch vector to `node` refers to.
static const struct ct_node_placement *tail_of(const struct ct_build *b, int node)
{
    return &b->kinematics->placement[b->T.sign[node] > 0 ? b->T.parent[node] : node];
}

// Vector along the branch to a node, in axes of its cluster.
static ct_ex3 branch_vector(struct ct_build *b, int node)
{
    const struct ct_edge_info *e = &b->topology->edge[b->T.parent_edge[node]];
    const ct_ex3 d = ct_edge_kinematics(b, e)->d,
                 vector = ct_ex33_apply(b->x, &tail_of(b, node)->S, d);
    return b->T.sign[node] < 0 ? ct_ex3_neg(b->x, vector) : vector;
}

void ct_translation_slide_sections(struct ct_build *b, struct ct_kinematics *kinematics)
{
    for (int node = 1; node < (int)b->topology->nnode; node++) {
        const struct ct_edge_info *e = &b->topology->edge[b->T.parent_edge[node]];
        if (e->beam >= 0 && is_moving(b, branch_vector(b, node)))
            slide_section(b, e, tail_of(b, node), b->T.sign[node],
                          &kinematics->anchor[kinematics->placement[node].anchor]);
    }
}

// (4.1): r_c = r_p + sign R_tail d, d in axes of the branch's tail.
static void place_node(struct ct_build *b, struct ct_kinematics *kinematics, int node)
{
    const int parent = b->T.parent[node], sign = b->T.sign[node];
    const struct ct_edge_info *e = &b->topology->edge[b->T.parent_edge[node]];
    const struct ct_node_placement *tail = tail_of(b, node);
    const struct ct_node_placement p = kinematics->placement[parent];
    struct ct_node_placement *self = &kinematics->placement[node];
    const ct_ex3 vector = branch_vector(b, node);
    self->anchor = p.anchor;
    self->cluster = p.cluster;
    self->local = p.local;
    if (ct_ex3_is_zero(vector))
        return;
    if (is_moving(b, vector)) {
        place_translating(b, kinematics, e, &p, tail, sign, vector, self);
    } else if (p.cluster == tail->frame || ct_ex3_is_zero(p.local)) {
        self->cluster = tail->frame;
        self->local = ct_ex3_add(b->x, p.local, vector);
    } else {
        self->anchor = anchor_at(b, kinematics, &p);
        self->cluster = tail->frame;
        self->local = vector;
    }
}

static void number_anchors(struct ct_build *b, struct ct_kinematics *kinematics)
{
    int *size = CT_NEWN(b->arena, int, kinematics->nanchor),
        *next = CT_NEWN(b->arena, int, kinematics->nanchor);
    for (size_t a = kinematics->nanchor; a-- > 1;)
        size[kinematics->anchor[a].parent] += ++size[a];
    kinematics->anchor[0].leave = size[0];
    next[0] = 1;
    for (size_t a = 1; a < kinematics->nanchor; a++) {
        struct ct_anchor *self = &kinematics->anchor[a];
        self->enter = next[self->parent];
        self->leave = self->enter + size[a] - 1;
        next[self->parent] += size[a];
        next[a] = self->enter + 1;
    }
}

// Makes an anchor at the base of a beam, as origin for its masses.
static void anchor_base(struct ct_build *b, struct ct_kinematics *kinematics, int node)
{
    struct ct_node_placement *p = &kinematics->placement[node];
    p->anchor = anchor_at(b, kinematics, p);
    p->cluster = p->frame;
    p->local = zero3;
}

void ct_translation_derive(struct ct_build *b, struct ct_kinematics *kinematics)
{
    add_anchor(b, kinematics, -1, 0, zero3);
    for (size_t i = 1; i < b->topology->nnode; i++) {
        place_node(b, kinematics, b->T.order[i]);
        const struct ct_flexible *f = ct_flexible_of(b, b->topology->node[b->T.order[i]].body);
        if (f && f->base == b->T.order[i])
            anchor_base(b, kinematics, b->T.order[i]);
    }
    number_anchors(b, kinematics);
    b->cache.anchor = CT_NEWN(b->arena, struct ct_anchor_cache, kinematics->nanchor);
}

// ---- links --------------------------------------------------------------------------------------

ct_ex3 ct_link_vector(struct ct_build *b, int i)
{
    struct ct_anchor_cache *c = &b->cache.anchor[i];
    const struct ct_anchor *a = &b->kinematics->anchor[i];
    if (!c->has_d)
        c->d = ct_cluster_turn(b, a->cluster, a->local);
    c->has_d = true;
    return c->d;
}

ct_ex3 ct_link_velocity(struct ct_build *b, int i)
{
    const struct ct_anchor *a = &b->kinematics->anchor[i];
    const ct_ex3 v = ct_cluster_cross_velocity(b, a->cluster, ct_link_vector(b, i));
    return a->moves ? ct_ex3_add(b->x, v, ct_cluster_turn(b, a->cluster, a->drift)) : v;
}

// Acceleration of a vector fixed in a cluster: al x d + w x (w x d).
static ct_ex3 carried_acceleration(struct ct_build *b, int cluster, ct_ex3 d,
                                   enum ct_level level)
{
    const ct_ex3 turning = ct_ex3_cross(b->x, ct_cluster_acceleration(b, cluster, level), d);
    return ct_ex3_add(b->x, turning, ct_cluster_centripetal(b, cluster, d));
}

ct_ex3 ct_link_sliding_acceleration(struct ct_build *b, int i, enum ct_level level)
{
    const struct ct_anchor *a = &b->kinematics->anchor[i];
    struct ct_exs *x = b->x;
    if (!a->moves)
        return zero3;
    ct_ex3 s = a->drift_bias;
    for (int k = 0; level == CT_FULL && k < a->ntranslation_axis; k++)
        if (a->translation_axis[k].speed >= 0)
            s = ct_ex3_add(x, s,
                           ct_ex3_scale(x, b->eqs->u[a->translation_axis[k].speed].derivative,
                                        a->translation_axis[k].p));
    const ct_ex3 drift = ct_cluster_turn(b, a->cluster, a->drift);
    const ct_ex3 coriolis
        = ct_ex3_scale(x, ct_ex_const(x, 2), ct_cluster_cross_velocity(b, a->cluster, drift));
    return ct_ex3_add(x, coriolis, ct_cluster_turn(b, a->cluster, s));
}

ct_ex3 ct_link_acceleration(struct ct_build *b, int i, enum ct_level level)
{
    const ct_ex3 carried = carried_acceleration(b, b->kinematics->anchor[i].cluster,
                                                ct_link_vector(b, i), level);
    return ct_ex3_add(b->x, carried, ct_link_sliding_acceleration(b, i, level));
}

// ---- anchors and nodes --------------------------------------------------------------------------

static ct_ex3 anchor_position(struct ct_build *b, int i)
{
    struct ct_anchor_cache *c = &b->cache.anchor[i];
    if (i && !c->has_p) {
        c->p = ct_ex3_add(b->x, anchor_position(b, b->kinematics->anchor[i].parent),
                          ct_link_vector(b, i));
        c->has_p = true;
    }
    return c->p;
}

static ct_ex3 anchor_velocity(struct ct_build *b, int i)
{
    struct ct_anchor_cache *c = &b->cache.anchor[i];
    if (i && !c->has_v) {
        const int parent = b->kinematics->anchor[i].parent;
        c->v = ct_ex3_add(b->x, anchor_velocity(b, parent), ct_link_velocity(b, i));
        c->has_v = true;
    }
    return c->v;
}

ct_ex3 ct_anchor_acceleration(struct ct_build *b, int i, enum ct_level level)
{
    struct ct_anchor_cache *c = &b->cache.anchor[i];
    if (i && !c->has_a[level]) {
        const int parent = b->kinematics->anchor[i].parent;
        c->a[level] = ct_ex3_add(b->x, ct_anchor_acceleration(b, parent, level),
                                 ct_link_acceleration(b, i, level));
        c->has_a[level] = true;
    }
    return c->a[level];
}

static ct_ex3 offset(struct ct_build *b, const struct ct_node_placement *p)
{
    return ct_cluster_turn(b, p->cluster, p->local);
}

ct_ex3 ct_node_position(struct ct_build *b, int node)
{
    const struct ct_node_placement *p = &b->kinematics->placement[node];
    return ct_ex3_add(b->x, anchor_position(b, p->anchor), offset(b, p));
}

ct_ex3 ct_node_velocity(struct ct_build *b, int node)
{
    const struct ct_node_placement *p = &b->kinematics->placement[node];
    return ct_ex3_add(b->x, anchor_velocity(b, p->anchor),
                      ct_cluster_cross_velocity(b, p->cluster, offset(b, p)));
}

ct_ex3 ct_node_acceleration(struct ct_build *b, int node, enum ct_level level)
{
    const struct ct_node_placement *p = &b->kinematics->placement[node];
    return ct_ex3_add(b->x, ct_anchor_acceleration(b, p->anchor, level),
                      carried_acceleration(b, p->cluster, offset(b, p), level));
}

// ---- paths --------------------------------------------------------------------------------------

struct path {
    struct ct_piece *piece;
    size_t n;
};

static void add_piece(struct path *p, int anchor, int cluster, int sign, ct_ex3 local)
{
    if (!ct_ex3_is_zero(local))
        p->piece[p->n++] = (struct ct_piece){anchor, cluster, sign, local};
}

// Path from tail to head: offsets and links up to the common anchor. It is valid until the next
// call; storing all of them would take rows times speeds.
static struct path find_path(struct ct_build *b, int tail, int head)
{
    const struct ct_node_placement *t = &b->kinematics->placement[tail],
                                   *h = &b->kinematics->placement[head];
    if (!b->cache.piece)
        b->cache.piece = CT_NEWN(b->arena, struct ct_piece, b->kinematics->nanchor + 2);
    struct path p = {b->cache.piece, 0};
    if (t->anchor == h->anchor && t->cluster == h->cluster) {
        add_piece(&p, -1, h->cluster, 1, ct_ex3_sub(b->x, h->local, t->local));
        return p;
    }
    add_piece(&p, -1, h->cluster, 1, h->local);
    add_piece(&p, -1, t->cluster, -1, t->local);
    int i = h->anchor, j = t->anchor;
    while (i != j) // parents have smaller numbers: replace the larger one by its parent
        if (i > j) {
            add_piece(&p, i, b->kinematics->anchor[i].cluster, 1,
                      b->kinematics->anchor[i].local);
            i = b->kinematics->anchor[i].parent;
        } else {
            add_piece(&p, j, b->kinematics->anchor[j].cluster, -1,
                      b->kinematics->anchor[j].local);
            j = b->kinematics->anchor[j].parent;
        }
    return p;
}

static ct_ex3 piece_vector(struct ct_build *b, const struct ct_piece *p)
{
    return p->anchor >= 0 ? ct_link_vector(b, p->anchor)
                          : ct_cluster_turn(b, p->cluster, p->local);
}

static ct_ex3 piece_velocity(struct ct_build *b, const struct ct_piece *p)
{
    return p->anchor >= 0 ? ct_link_velocity(b, p->anchor)
                          : ct_cluster_cross_velocity(b, p->cluster, piece_vector(b, p));
}

static ct_ex3 piece_acceleration(struct ct_build *b, const struct ct_piece *p,
                                 enum ct_level level)
{
    return p->anchor >= 0 ? ct_link_acceleration(b, p->anchor, level)
                          : carried_acceleration(b, p->cluster, piece_vector(b, p), level);
}

static ct_ex3 accumulate(struct ct_build *b, ct_ex3 sum, int sign, ct_ex3 v)
{
    return sign > 0 ? ct_ex3_add(b->x, sum, v) : ct_ex3_sub(b->x, sum, v);
}

// Is it a long path from ground? Then the stored positions and velocities of intermediate anchors
// cost less than a separate sum for each node.
static bool is_long(const struct ct_build *b, int tail, int head)
{
    const struct ct_kinematics *k = b->kinematics;
    int n = !ct_ex3_is_zero(k->placement[head].local);
    for (int a = k->placement[head].anchor; tail == 0 && a > 0 && n <= CT_LONG_PATH;
         a = k->anchor[a].parent)
        n += !ct_ex3_is_zero(k->anchor[a].local);
    return n > CT_LONG_PATH;
}

ct_ex3 ct_path_position(struct ct_build *b, int tail, int head)
{
    if (is_long(b, tail, head))
        return ct_node_position(b, head);
    const struct path p = find_path(b, tail, head);
    ct_ex3 sum = zero3;
    for (size_t i = 0; i < p.n; i++)
        sum = accumulate(b, sum, p.piece[i].sign, piece_vector(b, &p.piece[i]));
    return sum;
}

ct_ex3 ct_path_velocity(struct ct_build *b, int tail, int head)
{
    if (is_long(b, tail, head))
        return ct_node_velocity(b, head);
    const struct path p = find_path(b, tail, head);
    ct_ex3 sum = zero3;
    for (size_t i = 0; i < p.n; i++)
        sum = accumulate(b, sum, p.piece[i].sign, piece_velocity(b, &p.piece[i]));
    return sum;
}

ct_ex3 ct_path_acceleration(struct ct_build *b, int tail, int head, enum ct_level level)
{
    const struct path p = find_path(b, tail, head);
    ct_ex3 sum = zero3;
    for (size_t i = 0; i < p.n; i++)
        sum = accumulate(b, sum, p.piece[i].sign, piece_acceleration(b, &p.piece[i], level));
    return sum;
}

// Is the piece fixed in the cluster of node t? Then its variable part is added to *slid and its
// constant part to *fixed, where opposite arms cancel exactly.
static bool add_own(struct ct_build *b, const struct ct_node_placement *t,
                    const struct ct_piece *p, ct_ex3 *fixed, ct_ex3 *slid)
{
    const struct ct_anchor *a = p->anchor >= 0 ? &b->kinematics->anchor[p->anchor] : NULL;
    if (p->cluster != t->frame)
        return false;
    const bool moves = a && a->moves;
    *fixed = accumulate(b, *fixed, p->sign, moves ? a->fixed : p->local);
    if (moves)
        *slid = accumulate(b, *slid, p->sign, a->sliding);
    return true;
}

ct_ex3 ct_path_position_in_tail(struct ct_build *b, int tail, int head)
{
    const struct path p = find_path(b, tail, head);
    const struct ct_node_placement *t = &b->kinematics->placement[tail];
    const ct_ex33 to_axes = ct_ex33_transpose(&t->S);
    ct_ex3 sum = zero3, fixed = zero3, slid = zero3;
    for (size_t i = 0; i < p.n; i++)
        if (!add_own(b, t, &p.piece[i], &fixed, &slid))
            sum = accumulate(b, sum, p.piece[i].sign, piece_vector(b, &p.piece[i]));
    const ct_ex3 own = ct_ex33_apply(b->x, &to_axes, ct_ex3_add(b->x, fixed, slid));
    return ct_ex3_is_zero(sum) ? own : ct_ex3_add(b->x, own, ct_node_unturn(b, tail, sum));
}

ct_ex3 ct_path_velocity_in_tail(struct ct_build *b, int tail, int head)
{
    const struct path p = find_path(b, tail, head);
    const struct ct_node_placement *t = &b->kinematics->placement[tail];
    const ct_ex33 to_axes = ct_ex33_transpose(&t->S);
    ct_ex3 sum = zero3, carried = zero3, own = zero3;
    for (size_t i = 0; i < p.n; i++) {
        const struct ct_piece *piece = &p.piece[i];
        if (piece->cluster != t->frame) {
            sum = accumulate(b, sum, piece->sign, piece_velocity(b, piece));
            carried = accumulate(b, carried, piece->sign, piece_vector(b, piece));
        } else if (piece->anchor >= 0 && b->kinematics->anchor[piece->anchor].moves) {
            own = accumulate(b, own, piece->sign, b->kinematics->anchor[piece->anchor].drift);
        }
    }
    sum = ct_ex3_sub(b->x, sum, ct_cluster_cross_velocity(b, t->frame, carried));
    own = ct_ex33_apply(b->x, &to_axes, own);
    return ct_ex3_is_zero(sum) ? own : ct_ex3_add(b->x, own, ct_node_unturn(b, tail, sum));
}

// axis x v in axes of the cluster of the axis, for v fixed there. False if no component vanishes:
// then it is not cheaper.
static bool local_partial_velocity(struct ct_build *b, const struct ct_rotation_axis *s,
                                   ct_ex3 v, ct_ex3 *velocity)
{
    const ct_ex3 local = ct_ex3_cross(b->x, s->local, v);
    bool any_zero = false;
    for (int i = 0; i < 3; i++)
        any_zero = any_zero || ct_ex_is_zero(local.e[i]);
    if (b->topology->is_planar || ct_ex3_is_zero(s->local) || !any_zero)
        return false;
    *velocity = ct_cluster_turn(b, s->cluster, local);
    return true;
}

void ct_path_mark(struct ct_build *b, int tail, int head, bool *marked)
{
    const struct path p = find_path(b, tail, head);
    int end[2] = {b->kinematics->placement[tail].frame, b->kinematics->placement[head].frame};
    memset(marked, 0, b->kinematics->ncluster * sizeof *marked);
    for (size_t i = 0; i < p.n + COUNT(end); i++)
        for (int c = i < p.n ? p.piece[i].cluster : end[i - p.n]; c > 0 && !marked[c];
             c = b->kinematics->cluster[c].parent)
            marked[c] = true;
}

bool ct_path_partial_velocity(struct ct_build *b, int tail, int head, size_t r, bool carried,
                              ct_ex3 *velocity)
{
    const struct path p = find_path(b, tail, head);
    const struct ct_rotation_axis *s = &b->kinematics->rotation_axis[r];
    const int base
        = carried
       && ct_cluster_is_outboard(b, s->cluster, b->kinematics->placement[tail].frame);
    bool any = false, is_own = true;
    ct_ex3 lever_arm = zero3, own = zero3;
    for (size_t i = 0; i < p.n; i++) {
        const struct ct_piece *piece = &p.piece[i];
        const int turns = ct_cluster_is_outboard(b, s->cluster, piece->cluster);
        if (turns == base)
            continue;
        any = true;
        const int sign = (turns - base) * piece->sign;
        lever_arm = accumulate(b, lever_arm, sign, piece_vector(b, piece));
        is_own = is_own && piece->cluster == s->cluster;
        own = accumulate(b, own, sign, piece->local);
    }
    if (!is_own || !local_partial_velocity(b, s, own, velocity))
        *velocity = ct_ex3_cross(b->x, s->axis, lever_arm);
    return any;
}

// Does any rotation axis change a vector of `cluster` in the row?
static bool is_rotated(const struct ct_build *b, int tail, int head, bool carried, int cluster)
{
    const int from = b->kinematics->placement[tail].frame,
              to = b->kinematics->placement[head].frame;
    for (size_t r = 0; r < b->kinematics->nrotation_axis; r++) {
        const int c = b->kinematics->rotation_axis[r].cluster;
        const bool is_base = carried && ct_cluster_is_outboard(b, c, from);
        if (ct_cluster_is_outboard(b, c, cluster) != is_base
            && (carried || !ct_cluster_is_outboard(b, c, from)
                || !ct_cluster_is_outboard(b, c, to)))
            return true;
    }
    return false;
}

const ct_ex3 *ct_path_levers(struct ct_build *b, int tail, int head, bool carried, size_t *n)
{
    const struct ct_tree *T = &b->T;
    ct_ex3 *lever = CT_NEWN(b->arena, ct_ex3, T->depth[tail] + T->depth[head] + 1);
    *n = 0;
    for (int i = tail, j = head; i != j;) { // replace the deeper one by its parent
        int *const k = T->depth[i] > T->depth[j] ? &i : &j;
        const struct ct_edge_info *e = &b->topology->edge[T->parent_edge[*k]];
        const ct_ex3 d = ct_edge_kinematics(b, e)->d;
        if (!ct_ex3_is_zero(d) && is_rotated(b, tail, head, carried, tail_of(b, *k)->frame))
            lever[(*n)++] = d;
        *k = T->parent[*k];
    }
    return lever;
}

int ct_path_translation_side(struct ct_build *b, int tail, int head, int anchor)
{
    const bool at_head
        = ct_anchor_is_outboard(b, anchor, b->kinematics->placement[head].anchor);
    const bool at_tail
        = ct_anchor_is_outboard(b, anchor, b->kinematics->placement[tail].anchor);
    return (int)at_head - (int)at_tail;
}
