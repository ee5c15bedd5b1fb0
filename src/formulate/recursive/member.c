// See member.h.
//
// Members are built node by node along the translational tree. A joint is divided into a
// translation and single rotations, each with its own member; intermediate members have no mass. If
// one coordinate is both, as in a screw, one member has both.
#include "formulate/recursive/member_internal.h"

#include "formulate/beam_dynamics/beam_dynamics.h"

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- components --------------------------------------------------------------------------------

ct_ex3 ct_member_express(struct ct_build *b, int cluster, ct_ex3 local)
{
    if (!b->topology->is_planar)
        return local;
    const ct_ex3 v = ct_cluster_turn(b, cluster, local);
    ct_ex3 out = zero3;
    for (int i = 0; i < 2; i++)
        out.e[i] = ct_ex3_dot(b->x, b->topology->plane[i], v);
    return out;
}

ct_ex3 ct_member_express_ground(struct ct_build *b, int cluster, ct_ex3 v)
{
    if (!b->topology->is_planar)
        return ct_ex33_apply_t(b->x, &b->kinematics->cluster[cluster].R, v);
    ct_ex3 out;
    for (int i = 0; i < 3; i++)
        out.e[i] = ct_ex3_dot(b->x, b->topology->plane[i], v);
    return out;
}

// ---- adding members ----------------------------------------------------------------------------

int ct_member_add(struct ct_member_build *w, int parent, int cluster, ct_ex3 r)
{
    struct ct_member m = {.parent = parent, .cluster = cluster, .axis = -1, .r = r};
    m.R = ct_ex33_identity();
    CT_PUSH(w->b->arena, w->s->member, w->s->n, w->s->cap, m);
    return (int)w->s->n - 1;
}

struct ct_screw *ct_member_screw(struct ct_build *b, struct ct_member *m, int speed)
{
    const struct ct_screw fresh = {.speed = speed, .axis = -1};
    size_t n = (size_t)m->nfree;
    for (int k = 0; k < m->nfree; k++)
        if (m->screw[k].speed == speed)
            return &m->screw[k];
    CT_PUSH(b->arena, m->screw, n, m->screw_cap, fresh);
    return &m->screw[m->nfree++];
}

static int coordinate_axis(struct ct_build *b, ct_ex3 v)
{
    double one;
    for (int i = 0; i < 3; i++)
        if (ct_ex_is_zero(v.e[(i + 1) % 3]) && ct_ex_is_zero(v.e[(i + 2) % 3]))
            return ct_ex_is_const(b->x, v.e[i], &one) && (one == 1 || one == -1) ? i : -1;
    return -1;
}

// A rotation axis in axes of the member. The axis of a reversed quaternion is fixed in the parent;
// it is column i of S there.
static ct_ex3 rotation_axis_of(struct ct_member_build *w, const struct ct_member *m,
                               const struct ct_rotation_axis *s, const ct_ex33 *S, int i)
{
    struct ct_build *b = w->b;
    if (b->topology->is_planar) {
        const bool positive
            = ct_rotation_axis_is_positive(b, (size_t)(s - b->kinematics->rotation_axis));
        return (ct_ex3){
            {CT_EX_ZERO, CT_EX_ZERO, positive ? CT_EX_ONE : ct_ex_neg(b->x, CT_EX_ONE)}};
    }
    if (!ct_ex3_is_zero(s->local))
        return s->local;
    const ct_ex3 fixed = {{S->e[3 * i], S->e[3 * i + 1], S->e[3 * i + 2]}};
    return ct_ex33_apply_t(b->x, &m->R, ct_ex3_neg(b->x, fixed));
}

// Gives the member the axes of a cluster.
struct ct_member *ct_member_take_cluster(struct ct_member_build *w, int member, int cluster)
{
    struct ct_member *m = &w->s->member[member];
    m->rotates = true;
    m->has_axes = !w->b->topology->is_planar;
    if (!w->b->topology->is_planar)
        m->R = ct_cluster_relative(w->b, cluster);
    m->cluster = cluster;
    w->of_cluster[cluster] = member;
    return m;
}

// Adds rotation axis i of a cluster without its screws. Returns the axis.
ct_ex3 ct_member_rotation_axis(struct ct_member_build *w, struct ct_member *m, const ct_ex33 *S,
                               int i)
{
    struct ct_build *b = w->b;
    const struct ct_cluster *c = &b->kinematics->cluster[m->cluster];
    const struct ct_rotation_axis *s = &b->kinematics->rotation_axis[c->first_axis + i];
    const ct_ex3 axis = rotation_axis_of(w, m, s, S, i);
    if (c->naxis == 1)
        m->axis = coordinate_axis(b, axis);
    m->w_relative = ct_ex3_add(b->x, m->w_relative, ct_ex3_scale(b->x, s->rate, axis));
    m->al_relative = ct_ex3_add(b->x, m->al_relative, ct_ex3_scale(b->x, s->bias, axis));
    return axis;
}

void ct_member_screw_turn(struct ct_build *b, struct ct_member *m, int speed, ct_ex by,
                          ct_ex3 axis)
{
    struct ct_screw *f = ct_member_screw(b, m, speed);
    f->rotation = ct_ex3_add(b->x, f->rotation, ct_ex3_scale(b->x, by, axis));
}

// Gives the member the rotation of a cluster; S: axes of the node at which the joint starts.
static void add_turn(struct ct_member_build *w, int member, int cluster, const ct_ex33 *S)
{
    struct ct_build *b = w->b;
    struct ct_member *m = ct_member_take_cluster(w, member, cluster);
    for (int i = 0; i < b->kinematics->cluster[cluster].naxis; i++) {
        const struct ct_rotation_axis *s
            = &b->kinematics->rotation_axis[b->kinematics->cluster[cluster].first_axis + i];
        const ct_ex3 axis = ct_member_rotation_axis(w, m, S, i);
        for (int k = 0; k < s->nterm; k++)
            if (s->term[k].speed >= 0)
                ct_member_screw_turn(b, m, s->term[k].speed, s->term[k].coef, axis);
    }
}

// Adds the translation axes of joint e to the member; r is in axes of the parent's cluster.
static void add_translations(struct ct_member_build *w, int member,
                             const struct ct_edge_info *e)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    struct ct_member *m = &w->s->member[member];
    m->translates = true;
    m->drift = ct_build_rate3(b, m->r);
    m->drift_bias = ct_build_rate3(b, m->drift);
    for (int k = 0; k < e->ncoordinate; k++) {
        const struct ct_coordinate *c = &b->kinematics->coordinate[e->first_coordinate + k];
        ct_ex3 p;
        if (c->u < 0 || c->q < 0)
            continue;
        for (int i = 0; i < 3; i++)
            p.e[i] = ct_ex_diff(x, m->r.e[i], b->eqs->q[c->q].symbol);
        if (!ct_ex3_is_zero(p))
            ct_member_screw(b, m, c->u)->translation = p;
    }
}

// ---- joints ------------------------------------------------------------------------------------

static bool is_moving(const struct ct_build *b, ct_ex3 v)
{
    const unsigned moving = 1u << CT_SYM_Q | 1u << CT_SYM_TIME;
    return (ct_ex_kinds(b->x, v.e[0]) | ct_ex_kinds(b->x, v.e[1]) | ct_ex_kinds(b->x, v.e[2]))
         & moving;
}

static bool moves_slide(const struct ct_build *b, const struct ct_edge_info *e,
                        const struct ct_term *t)
{
    for (int k = 0; k < e->ncoordinate; k++) {
        const struct ct_coordinate *c = &b->kinematics->coordinate[e->first_coordinate + k];
        if (t->speed >= 0 && c->u == t->speed)
            return c->in_translation;
    }
    return false;
}

// Does one coordinate rotate and translate?
static bool is_coupled(const struct ct_build *b, const struct ct_passage *p)
{
    for (int i = 0; i < p->ncluster; i++) {
        const struct ct_cluster *c = &b->kinematics->cluster[p->cluster[i]];
        for (int k = 0; k < c->naxis; k++) {
            const struct ct_rotation_axis *s = &b->kinematics->rotation_axis[c->first_axis + k];
            for (int j = 0; j < s->nterm; j++)
                if (moves_slide(b, p->e, &s->term[j]))
                    return true;
        }
    }
    return false;
}

// Do two rotations of the joint depend on the same coordinate?
static bool turns_share(const struct ct_build *b, const struct ct_passage *p)
{
    for (int i = 0; i < p->ncluster; i++)
        for (int j = 0; j < i; j++) {
            const struct ct_rotation_axis *s
                = &b->kinematics
                       ->rotation_axis[b->kinematics->cluster[p->cluster[i]].first_axis],
                *t = &b->kinematics
                          ->rotation_axis[b->kinematics->cluster[p->cluster[j]].first_axis];
            for (int k = 0; k < s->nterm; k++)
                for (int l = 0; l < t->nterm; l++)
                    if (s->term[k].speed >= 0 && s->term[k].speed == t->term[l].speed)
                        return true;
        }
    return false;
}

static int pass_translations(struct ct_member_build *w, int member, const struct ct_passage *p,
                             ct_ex3 *offset)
{
    *offset = ct_ex3_add(w->b->x, *offset, p->vector);
    if (!is_moving(w->b, p->vector))
        return member;
    const int m = ct_member_add(w, member, w->s->member[member].cluster, *offset);
    add_translations(w, m, p->e);
    *offset = zero3;
    return m;
}

static int pass_rotations(struct ct_member_build *w, int member, const struct ct_passage *p,
                          ct_ex3 *offset)
{
    for (int i = 0; i < p->ncluster; i++) {
        member = ct_member_add(w, member, -1, *offset);
        add_turn(w, member, p->cluster[i], p->S);
        w->s->member[member].is_absolute = p->is_absolute && i == 0;
        *offset = zero3;
    }
    return member;
}

// Adds one member that translates and rotates.
static int pass_coupled(struct ct_member_build *w, int member, const struct ct_passage *p,
                        ct_ex3 *offset)
{
    struct ct_exs *x = w->b->x;
    const int m = ct_member_add(w, member, -1, *offset);
    struct ct_member *self = &w->s->member[m];
    const ct_ex33 A = ct_cluster_relative(w->b, p->cluster[0]);
    const ct_ex3 v = p->vector_last ? ct_ex33_apply(x, &A, p->vector) : p->vector;
    self->r = ct_ex3_add(x, self->r, v);
    add_translations(w, m, p->e);
    add_turn(w, m, p->cluster[0], p->S);
    *offset = zero3;
    return m;
}

static bool pass(struct ct_member_build *w, const struct ct_passage *p, int *member,
                 ct_ex3 *offset)
{
    if (turns_share(w->b, p))
        return false;
    if (is_coupled(w->b, p)) {
        if (p->ncluster != 1 || p->is_absolute)
            return false;
        *member = pass_coupled(w, *member, p, offset);
        return true;
    }
    if (!p->vector_last)
        *member = pass_translations(w, *member, p, offset);
    *member = pass_rotations(w, *member, p, offset);
    if (p->vector_last)
        *member = pass_translations(w, *member, p, offset);
    return true;
}

// ---- nodes -------------------------------------------------------------------------------------

// Finds the clusters between the axes of a node and those of its parent (of ground in a plane).
// False if the parent of its cluster is another one.
static bool find_clusters(struct ct_member_build *w, int from, int to, struct ct_passage *p)
{
    const struct ct_build *b = w->b;
    int list[CT_MAX_COORD], n = 0;
    for (; to != from && to != 0 && w->of_cluster[to] < 0;
         to = b->kinematics->cluster[to].parent) {
        if (n == CT_MAX_COORD)
            return false;
        list[n++] = to;
    }
    p->is_absolute = to != from;
    if (to != from && (to != 0 || !b->topology->is_planar || n != 1))
        return false;
    for (p->ncluster = 0; p->ncluster < n; p->ncluster++)
        p->cluster[p->ncluster] = list[n - 1 - p->ncluster];
    return true;
}

// A particle has no axes: it is a point of its parent or of a translating member there.
static bool place_particle(struct ct_member_build *w, struct ct_passage *p, int parent,
                           int *member, ct_ex3 *offset)
{
    if (w->b->topology->node[parent].is_particle
        || (p->vector_last && !ct_ex3_is_zero(p->vector)))
        return false;
    *member = pass_translations(w, *member, p, offset);
    return true;
}

static bool place_node(struct ct_member_build *w, int node)
{
    struct ct_build *b = w->b;
    const int parent = b->T.parent[node], sign = b->T.sign[node];
    const struct ct_edge_info *e = &b->topology->edge[b->T.parent_edge[node]];
    const struct ct_node_placement *tail = &b->kinematics->placement[sign > 0 ? parent : node];
    const ct_ex3 d = ct_edge_kinematics(b, e)->d;
    struct ct_passage p
        = {.e = e, .vector_last = sign < 0, .S = &b->kinematics->placement[parent].S};
    int member = w->of_node[parent];
    ct_ex3 offset = w->offset[parent];
    p.vector = ct_ex33_apply(b->x, &tail->S, d);
    if (sign < 0)
        p.vector = ct_ex3_neg(b->x, p.vector);
    if (b->topology->node[node].is_particle) {
        if (!place_particle(w, &p, parent, &member, &offset))
            return false;
    } else if (b->topology->node[parent].is_particle
               || !find_clusters(w, b->kinematics->placement[parent].frame,
                                 b->kinematics->placement[node].frame, &p)
               || !(e->beam >= 0 ? ct_member_pass_section(w, &p, sign, &member, &offset)
                                 : pass(w, &p, &member, &offset))) {
        return false;
    }
    w->of_node[node] = member;
    w->offset[node] = offset;
    const struct ct_flexible *f = ct_flexible_of(b, b->topology->node[node].body);
    if (f && f->base == node)
        ct_member_attach_base(w, f, member, offset);
    return true;
}

static bool place_nodes(struct ct_member_build *w)
{
    const struct ct_build *b = w->b;
    w->of_node = CT_NEWN(b->arena, int, b->topology->nnode);
    w->offset = CT_NEWN(b->arena, ct_ex3, b->topology->nnode);
    w->of_cluster = CT_NEWN(b->arena, int, b->kinematics->ncluster);
    for (size_t c = 1; c < b->kinematics->ncluster; c++)
        w->of_cluster[c] = -1;
    ct_member_add(w, -1, 0, zero3);
    for (size_t i = 1; i < b->topology->nnode; i++)
        if (!place_node(w, b->T.order[i]))
            return false;
    return true;
}

// Does each speed move exactly one member?
static bool own_speeds(struct ct_member_build *w)
{
    const size_t nu = w->b->eqs->nu;
    w->of_speed = CT_NEWN(w->b->arena, int, nu + 1);
    for (size_t m = 1; m < w->s->n; m++)
        for (int k = 0; k < w->s->member[m].nfree && !w->s->member[m].beam; k++) {
            int *of = &w->of_speed[w->s->member[m].screw[k].speed];
            if (*of)
                return false;
            *of = (int)m;
        }
    for (size_t k = 0; k < w->b->eqs->nmotion; k++)
        if (!w->of_speed[k] && !w->b->eqs->u[k].beam)
            return false;
    w->s->of_speed = w->of_speed;
    return true;
}

// ---- axes of the members -----------------------------------------------------------------------

static void find_axes(struct ct_member_build *w, struct ct_member *m)
{
    const int cluster = w->s->member[m->parent].cluster;
    struct ct_build *b = w->b;
    if (m->is_ready)
        return;
    m->r = ct_member_express(b, cluster, m->r);
    m->drift = ct_member_express(b, cluster, m->drift);
    m->drift_bias = ct_member_express(b, cluster, m->drift_bias);
    m->moment = ct_member_express(b, m->cluster, m->moment);
    if (b->topology->is_planar) {
        const ct_ex3 n = b->topology->plane[2];
        const ct_ex about = ct_ex3_dot(b->x, n, ct_ex33_apply(b->x, &m->J, n));
        m->J = (ct_ex33){{{0}}};
        m->J.e[8] = about;
    }
    for (int k = 0; k < m->nfree; k++) {
        struct ct_screw *f = &m->screw[k];
        f->translation = ct_member_in(b, m, ct_member_express(b, cluster, f->translation));
        const bool turns = !ct_ex3_is_zero(f->rotation),
                   slides = !ct_ex3_is_zero(f->translation);
        if (turns != slides)
            f->axis
                = turns ? coordinate_axis(b, f->rotation) : coordinate_axis(b, f->translation);
        if (f->axis >= 0 && slides)
            f->axis += 3;
    }
}

// In a plane only the in-plane components are needed.
static void flatten(struct ct_member_build *w)
{
    struct ct_build *b = w->b;
    for (size_t i = 0; i < b->topology->nnode; i++)
        w->offset[i] = ct_build_in_plane(b, w->offset[i]);
    for (size_t i = 1; i < w->s->n; i++)
        if (!w->s->member[i].is_ready)
            w->s->member[i].r = ct_build_in_plane(b, w->s->member[i].r);
}

ct_ex3 ct_members_gravity_acceleration(struct ct_build *b)
{
    return ct_member_express_ground(b, 0,
                                    ct_build_in_plane(b, ct_ex3_neg(b->x, b->model->gravity)));
}

const struct ct_members *ct_members_derive(struct ct_build *b)
{
    struct ct_members *s = CT_NEW(b->arena, struct ct_members);
    struct ct_member_build w = {.b = b, .s = s};
    if (b->eqs->nrow || !ct_flexible_may_be_articulated(b))
        return NULL;
    s->nbeam = b->nflexible;
    s->beam = CT_NEWN(b->arena, struct ct_member_beam, s->nbeam + 1);
    if (!place_nodes(&w) || !own_speeds(&w))
        return NULL;
    for (size_t i = 0; i < s->nbeam; i++)
        if (!s->beam[i].base)
            return NULL;
    flatten(&w);
    ct_members_add_bodies(&w);
    ct_members_lump(&w);
    for (size_t i = 1; i < s->n; i++)
        find_axes(&w, &s->member[i]);
    ct_members_add_beams(&w);
    ct_members_turn(b, s);
    ct_members_load(&w);
    return s;
}
