// See member.h.
//
// Built node by node along the translational tree. A joint is taken apart into what slides and into turns, each
// with a member of its own; those in between have no mass. Where one coordinate does both, as in a screw, one
// member has both.
#include "formulate/member_work.h"

#include "formulate/elastic.h"

#include <math.h>
#include <string.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- components -------------------------------------------------------------------------------------

ct_ex3 ct_member_express(struct ct_build *b, int cluster, ct_ex3 local)
{
    if (!b->is_planar)
        return local;
    const ct_ex3 v = ct_cluster_turn(b, cluster, local);
    ct_ex3 out = zero3;
    for (int i = 0; i < 2; i++)
        out.e[i] = ct_ex3_dot(b->x, b->plane[i], v);
    return out;
}

ct_ex3 ct_member_express_ground(struct ct_build *b, int cluster, ct_ex3 v)
{
    if (!b->is_planar)
        return ct_ex33_apply_t(b->x, &b->cluster[cluster].R, v);
    ct_ex3 out;
    for (int i = 0; i < 3; i++)
        out.e[i] = ct_ex3_dot(b->x, b->plane[i], v);
    return out;
}

// ---- adding members -----------------------------------------------------------------------------------

static int add_member(struct ct_member_work *w, int parent, int cluster, ct_ex3 r)
{
    struct ct_member m = {.parent = parent, .cluster = cluster, .axis = -1, .r = r};
    m.R = ct_ex33_identity();
    CT_PUSH(w->b->arena, w->s->member, w->s->n, w->s->cap, m);
    return (int)w->s->n - 1;
}

static struct ct_screw *screw_of(struct ct_build *b, struct ct_member *m, int speed)
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

// Axis of a spin in the member's axes. That of a quaternion seen backwards is fixed in the parent, as column i
// of S there.
static ct_ex3 spin_axis(struct ct_member_work *w, const struct ct_member *m,
                        const struct ct_spin *s, const ct_ex33 *S, int i)
{
    struct ct_build *b = w->b;
    if (b->is_planar) {
        const bool positive = ct_spin_is_positive(b, (size_t)(s - b->spin));
        return (ct_ex3){
            {CT_EX_ZERO, CT_EX_ZERO, positive ? CT_EX_ONE : ct_ex_neg(b->x, CT_EX_ONE)}};
    }
    if (!ct_ex3_is_zero(s->local))
        return s->local;
    const ct_ex3 fixed = {{S->e[3 * i], S->e[3 * i + 1], S->e[3 * i + 2]}};
    return ct_ex33_apply_t(b->x, &m->R, ct_ex3_neg(b->x, fixed));
}

// The member turns as a cluster does; S: axes of the node the joint starts from.
static void add_turn(struct ct_member_work *w, int member, int cluster, const ct_ex33 *S)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    struct ct_member *m = &w->s->member[member];
    const struct ct_cluster *c = &b->cluster[cluster];
    m->turns = true;
    m->has_axes = !b->is_planar;
    if (!b->is_planar)
        m->R = ct_cluster_relative(b, cluster);
    m->cluster = cluster;
    w->of_cluster[cluster] = member;
    for (int i = 0; i < c->nspin; i++) {
        const struct ct_spin *s = &b->spin[c->first_spin + i];
        const ct_ex3 axis = spin_axis(w, m, s, S, i);
        if (c->nspin == 1)
            m->axis = coordinate_axis(b, axis);
        m->w_relative = ct_ex3_add(x, m->w_relative, ct_ex3_scale(x, s->rate, axis));
        m->al_relative = ct_ex3_add(x, m->al_relative, ct_ex3_scale(x, s->bias, axis));
        for (int k = 0; k < s->nterm; k++)
            if (s->term[k].speed >= 0) {
                struct ct_screw *f = screw_of(b, m, s->term[k].speed);
                f->turn = ct_ex3_add(x, f->turn, ct_ex3_scale(x, s->term[k].coef, axis));
            }
    }
}

// The member's place moves with coordinates of joint e; r is in axes of the parent's cluster.
static void add_slides(struct ct_member_work *w, int member, const struct ct_edge_info *e)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    struct ct_member *m = &w->s->member[member];
    m->slides = true;
    m->drift = ct_build_rate3(b, m->r);
    m->drift_bias = ct_build_rate3(b, m->drift);
    for (int k = 0; k < e->ncoordinate; k++) {
        const struct ct_coordinate *c = &b->coordinate[e->first_coordinate + k];
        ct_ex3 p;
        if (c->u < 0 || c->q < 0)
            continue;
        for (int i = 0; i < 3; i++)
            p.e[i] = ct_ex_diff(x, m->r.e[i], b->eqs->q[c->q].symbol);
        if (!ct_ex3_is_zero(p))
            screw_of(b, m, c->u)->slide = p;
    }
}

// ---- joints -------------------------------------------------------------------------------------------

static bool is_moving(const struct ct_build *b, ct_ex3 v)
{
    const unsigned moving = 1u << CT_SYM_Q | 1u << CT_SYM_TIME;
    return (ct_ex_kinds(b->x, v.e[0]) | ct_ex_kinds(b->x, v.e[1]) | ct_ex_kinds(b->x, v.e[2]))
         & moving;
}

// What a joint does between a node of member `from` and the next node.
struct passage {
    const struct ct_edge_info *e;
    int cluster[CT_MAX_COORD], ncluster; // new ones, in order
    bool is_absolute;
    ct_ex3 vector;    // that of the joint, in axes of the cluster where it is fixed
    bool vector_last; // in the axes behind the turns
    const ct_ex33 *S;
};

static bool moves_slide(const struct ct_build *b, const struct ct_edge_info *e,
                        const struct ct_term *t)
{
    for (int k = 0; k < e->ncoordinate; k++) {
        const struct ct_coordinate *c = &b->coordinate[e->first_coordinate + k];
        if (t->speed >= 0 && c->u == t->speed)
            return c->in_translation;
    }
    return false;
}

// Does a coordinate that turns also slide?
static bool is_coupled(const struct ct_build *b, const struct passage *p)
{
    for (int i = 0; i < p->ncluster; i++) {
        const struct ct_cluster *c = &b->cluster[p->cluster[i]];
        for (int k = 0; k < c->nspin; k++) {
            const struct ct_spin *s = &b->spin[c->first_spin + k];
            for (int j = 0; j < s->nterm; j++)
                if (moves_slide(b, p->e, &s->term[j]))
                    return true;
        }
    }
    return false;
}

// Do two turns of the joint share a coordinate?
static bool turns_share(const struct ct_build *b, const struct passage *p)
{
    for (int i = 0; i < p->ncluster; i++)
        for (int j = 0; j < i; j++) {
            const struct ct_spin *s = &b->spin[b->cluster[p->cluster[i]].first_spin],
                                 *t = &b->spin[b->cluster[p->cluster[j]].first_spin];
            for (int k = 0; k < s->nterm; k++)
                for (int l = 0; l < t->nterm; l++)
                    if (s->term[k].speed >= 0 && s->term[k].speed == t->term[l].speed)
                        return true;
        }
    return false;
}

static int pass_slides(struct ct_member_work *w, int member, const struct passage *p,
                       ct_ex3 *offset)
{
    *offset = ct_ex3_add(w->b->x, *offset, p->vector);
    if (!is_moving(w->b, p->vector))
        return member;
    const int m = add_member(w, member, w->s->member[member].cluster, *offset);
    add_slides(w, m, p->e);
    *offset = zero3;
    return m;
}

static int pass_turns(struct ct_member_work *w, int member, const struct passage *p,
                      ct_ex3 *offset)
{
    for (int i = 0; i < p->ncluster; i++) {
        member = add_member(w, member, -1, *offset);
        add_turn(w, member, p->cluster[i], p->S);
        w->s->member[member].is_absolute = p->is_absolute && i == 0;
        *offset = zero3;
    }
    return member;
}

// One member that slides and turns.
static int pass_coupled(struct ct_member_work *w, int member, const struct passage *p,
                        ct_ex3 *offset)
{
    struct ct_exs *x = w->b->x;
    const int m = add_member(w, member, -1, *offset);
    struct ct_member *self = &w->s->member[m];
    const ct_ex33 A = ct_cluster_relative(w->b, p->cluster[0]);
    const ct_ex3 v = p->vector_last ? ct_ex33_apply(x, &A, p->vector) : p->vector;
    self->r = ct_ex3_add(x, self->r, v);
    add_slides(w, m, p->e);
    add_turn(w, m, p->cluster[0], p->S);
    *offset = zero3;
    return m;
}

static bool pass(struct ct_member_work *w, const struct passage *p, int *member, ct_ex3 *offset)
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
        *member = pass_slides(w, *member, p, offset);
    *member = pass_turns(w, *member, p, offset);
    if (p->vector_last)
        *member = pass_slides(w, *member, p, offset);
    return true;
}

// ---- beams --------------------------------------------------------------------------------------------

static int beam_of(const struct ct_build *b, const struct ct_flexible *f)
{
    return (int)(f - b->flexible);
}

// Axes of the beam -> those of its base: its cluster's, in a plane (x, n x x, n).
static ct_ex33 base_axes(struct ct_build *b, const struct ct_flexible *f)
{
    if (!b->is_planar)
        return b->place[f->base].S;
    const ct_ex3 n = ct_ex33_apply_t(b->x, &b->upright[f->base], b->plane[2]);
    ct_ex33 A = {{{0}}};
    double v[3]; // one of the beam's axes, but for rounding
    for (int i = 0; i < 3; i++) {
        v[i] = rint(ct_ex_value(b->x, n.e[i], b->value)) + 0.0; // no negative zero
        A.e[2 + 3 * i] = ct_ex_const(b->x, v[i]);
    }
    A.e[0] = CT_EX_ONE;
    A.e[1 + 3 * 1] = ct_ex_const(b->x, v[2]);
    A.e[1 + 3 * 2] = ct_ex_const(b->x, 0 - v[1]);
    return A;
}

// In a plane: axes of the beam's base -> those of the plane.
static ct_ex33 beam_turn(struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_place *p = &b->place[f->base];
    const ct_ex3 x = {{CT_EX_ONE, CT_EX_ZERO, CT_EX_ZERO}};
    const ct_ex3 v = ct_member_express(b, p->frame, ct_ex33_apply(b->x, &p->S, x));
    return (ct_ex33){{v.e[0], v.e[1], CT_EX_ZERO, ct_ex_neg(b->x, v.e[1]), v.e[0], CT_EX_ZERO,
                      CT_EX_ZERO, CT_EX_ZERO, CT_EX_ONE}};
}

// In a plane: member m has the axes of the beam, its parent those of the plane, or the other way round.
static void change_axes(struct ct_member_work *w, int m, const struct ct_flexible *f,
                        bool into_beam)
{
    struct ct_member *self = &w->s->member[m];
    const ct_ex33 R = beam_turn(w->b, f);
    self->R = into_beam ? R : ct_ex33_transpose(&R);
    self->has_axes = true;
    self->axis = 2;
}

static int rigid_member(struct ct_member_work *w, int parent, const struct ct_flexible *f,
                        ct_ex3 r)
{
    const int m = add_member(w, parent, w->s->member[parent].cluster, r);
    w->s->member[m].beam = beam_of(w->b, f) + 1;
    return m;
}

// The base of a beam that a node carries which is not one of its own sections.
static void hang_base(struct ct_member_work *w, const struct ct_flexible *f, int member,
                      ct_ex3 offset)
{
    struct ct_member_beam *beam = &w->s->beam[beam_of(w->b, f)];
    beam->A = base_axes(w->b, f);
    beam->base = beam->root = rigid_member(w, member, f, offset);
    if (w->b->is_planar)
        change_axes(w, beam->base, f, true);
}

// What slides between the base and a section, from the member at whose origin r begins; in axes of the base.
static int slide_section(struct ct_member_work *w, int from, ct_ex3 r,
                         const struct ct_edge_info *e, int sign)
{
    struct ct_build *b = w->b;
    const struct ct_flexible *f = e->flexible;
    const ct_ex33 *A = &w->s->beam[beam_of(b, f)].A;
    ct_ex3 place = ct_ex33_apply(b->x, A, e->at);
    place = sign > 0 ? place : ct_ex3_neg(b->x, place);
    const int i = add_member(w, from, b->place[f->base].frame, ct_ex3_add(b->x, r, place));
    struct ct_member *m = &w->s->member[i];
    m->beam = beam_of(b, f) + 1;
    m->slides = m->is_ready = true;
    m->drift = ct_build_rate3(b, place);
    m->drift_bias = ct_build_rate3(b, m->drift);
    const ct_ex3 *slide = e->slide;
    if (ct_flexible_is_carried(f)) {
        const int n = f->nelastic + ct_follow_count(f);
        ct_ex3 *own = CT_NEWN(b->arena, ct_ex3, n + 1),
               *unused = CT_NEWN(b->arena, ct_ex3, n + 1);
        ct_station_own_partials(b, f, e->station, own, unused);
        slide = own;
        const ct_ex3 along = {{A->e[0], A->e[1], A->e[2]}};
        if (e->station->element)
            screw_of(b, m, -e->station->element)->slide
                = sign > 0 ? along : ct_ex3_neg(b->x, along);
        for (int k = 0; k < ct_follow_count(f); k++) {
            const ct_ex3 p = ct_ex33_apply(b->x, A, own[f->nelastic + k]);
            if (!ct_ex3_is_zero(p))
                screw_of(b, m, -f->beam->nelement - k)->slide
                    = sign > 0 ? p : ct_ex3_neg(b->x, p);
        }
    }
    for (int k = 0; k < f->nelastic; k++) {
        const ct_ex3 p = ct_ex33_apply(b->x, A, slide[k]);
        if (!ct_ex3_is_zero(p))
            screw_of(b, m, f->elastic[k].u)->slide = sign > 0 ? p : ct_ex3_neg(b->x, p);
    }
    return i;
}

// Turns of a section, in a plane with the change of axes.
static int turn_section(struct ct_member_work *w, int from, ct_ex3 r, const struct passage *p,
                        int sign)
{
    const struct ct_flexible *f = p->e->flexible;
    int m = from;
    for (int i = 0; i < p->ncluster; i++, r = zero3) {
        m = add_member(w, m, -1, r);
        w->s->member[m].beam = beam_of(w->b, f) + 1;
        add_turn(w, m, p->cluster[i], p->S);
    }
    if (!w->b->is_planar)
        return m;
    if (!p->ncluster)
        m = rigid_member(w, m, f, r);
    change_axes(w, m, f, sign < 0);
    return m;
}

// From the base of a beam to a section (sign +1) or back.
static bool pass_section(struct ct_member_work *w, const struct passage *p, int sign,
                         int *member, ct_ex3 *offset)
{
    struct ct_build *b = w->b;
    const struct ct_flexible *f = p->e->flexible;
    struct ct_member_beam *beam = &w->s->beam[beam_of(b, f)];
    if (p->is_absolute || (sign < 0 && beam->base))
        return false;
    if (sign > 0) {
        *member = slide_section(w, beam->base, zero3, p->e, sign);
        *member = turn_section(w, *member, zero3, p, sign);
    } else {
        const size_t first = w->s->n;
        beam->A = base_axes(b, f);
        const int turned = turn_section(w, *member, *offset, p, sign);
        const bool is_new = turned != *member;
        *member = slide_section(w, turned, is_new ? zero3 : *offset, p->e, sign);
        beam->root = (int)first;
        beam->base = *member;
        if (b->is_planar) { // what else the base carries
            *member = rigid_member(w, *member, f, zero3);
            change_axes(w, *member, f, false);
        }
    }
    *offset = zero3;
    return true;
}

// ---- nodes --------------------------------------------------------------------------------------------

// The clusters between the axes of a node and those of its parent, or of ground in a plane. False where the node
// turns with something else.
static bool find_clusters(struct ct_member_work *w, int from, int to, struct passage *p)
{
    const struct ct_build *b = w->b;
    int list[CT_MAX_COORD], n = 0;
    for (; to != from && to != 0 && w->of_cluster[to] < 0; to = b->cluster[to].parent) {
        if (n == CT_MAX_COORD)
            return false;
        list[n++] = to;
    }
    p->is_absolute = to != from;
    if (to != from && (to != 0 || !b->is_planar || n != 1))
        return false;
    for (p->ncluster = 0; p->ncluster < n; p->ncluster++)
        p->cluster[p->ncluster] = list[n - 1 - p->ncluster];
    return true;
}

// A particle has no axes: it is a point of its parent, or of what slides there.
static bool place_particle(struct ct_member_work *w, struct passage *p, int parent, int *member,
                           ct_ex3 *offset)
{
    if (w->b->node[parent].is_particle || (p->vector_last && !ct_ex3_is_zero(p->vector)))
        return false;
    *member = pass_slides(w, *member, p, offset);
    return true;
}

static bool place_node(struct ct_member_work *w, int node)
{
    struct ct_build *b = w->b;
    const int parent = b->T.parent[node], sign = b->T.sign[node];
    const struct ct_edge_info *e = &b->edge[b->T.parent_edge[node]];
    const struct ct_place *tail = &b->place[sign > 0 ? parent : node];
    const ct_ex3 d = e->kind == CT_EDGE_ARM ? e->at : e->motion.d;
    struct passage p = {.e = e, .vector_last = sign < 0, .S = &b->place[parent].S};
    int member = w->of_node[parent];
    ct_ex3 offset = w->offset[parent];
    p.vector = ct_ex33_apply(b->x, &tail->S, d);
    if (sign < 0)
        p.vector = ct_ex3_neg(b->x, p.vector);
    if (b->node[node].is_particle) {
        if (!place_particle(w, &p, parent, &member, &offset))
            return false;
    } else if (b->node[parent].is_particle
               || !find_clusters(w, b->place[parent].frame, b->place[node].frame, &p)
               || !(e->flexible ? pass_section(w, &p, sign, &member, &offset)
                                : pass(w, &p, &member, &offset))) {
        return false;
    }
    w->of_node[node] = member;
    w->offset[node] = offset;
    const struct ct_flexible *f = ct_flexible_of(b, b->node[node].body);
    if (f && f->base == node && !w->s->beam[beam_of(b, f)].base)
        hang_base(w, f, member, offset);
    return true;
}

static bool place_nodes(struct ct_member_work *w)
{
    const struct ct_build *b = w->b;
    w->of_node = CT_NEWN(b->arena, int, b->nnode);
    w->offset = CT_NEWN(b->arena, ct_ex3, b->nnode);
    w->of_cluster = CT_NEWN(b->arena, int, b->ncluster);
    for (size_t c = 1; c < b->ncluster; c++)
        w->of_cluster[c] = -1;
    add_member(w, -1, 0, zero3);
    for (size_t i = 1; i < b->nnode; i++)
        if (!place_node(w, b->T.order[i]))
            return false;
    return true;
}

// Each speed must move one member.
static bool own_speeds(struct ct_member_work *w)
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
    for (size_t k = 0; k < nu; k++)
        if (!w->of_speed[k] && !w->b->eqs->u[k].beam)
            return false;
    w->s->of_speed = w->of_speed;
    return true;
}

// ---- into the axes that are used ----------------------------------------------------------------------------

static void find_axes(struct ct_member_work *w, struct ct_member *m)
{
    const int cluster = w->s->member[m->parent].cluster;
    struct ct_build *b = w->b;
    if (m->is_ready)
        return;
    m->r = ct_member_express(b, cluster, m->r);
    m->drift = ct_member_express(b, cluster, m->drift);
    m->drift_bias = ct_member_express(b, cluster, m->drift_bias);
    m->moment = ct_member_express(b, m->cluster, m->moment);
    if (b->is_planar) {
        const ct_ex3 n = b->plane[2];
        const ct_ex about = ct_ex3_dot(b->x, n, ct_ex33_apply(b->x, &m->J, n));
        m->J = (ct_ex33){{{0}}};
        m->J.e[8] = about;
    }
    for (int k = 0; k < m->nfree; k++) {
        struct ct_screw *f = &m->screw[k];
        f->slide = ct_member_in(b, m, ct_member_express(b, cluster, f->slide));
        const bool turns = !ct_ex3_is_zero(f->turn), slides = !ct_ex3_is_zero(f->slide);
        if (turns != slides)
            f->axis = turns ? coordinate_axis(b, f->turn) : coordinate_axis(b, f->slide);
        if (f->axis >= 0 && slides)
            f->axis += 3;
    }
}

// Lumping in a plane keeps to what lies in it.
static void flatten(struct ct_member_work *w)
{
    struct ct_build *b = w->b;
    for (size_t i = 0; i < b->nnode; i++)
        w->offset[i] = ct_build_in_plane(b, w->offset[i]);
    for (size_t i = 1; i < w->s->n; i++)
        if (!w->s->member[i].is_ready)
            w->s->member[i].r = ct_build_in_plane(b, w->s->member[i].r);
}

static bool beams_fit(const struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++)
        if (b->flexible[i].kinematics != b->flexible[i].axial
            || b->flexible[i].formulation == CT_BEAM_STRETCH_LINEAR)
            return false;
    return true;
}

ct_ex3 ct_members_fall(struct ct_build *b)
{
    return ct_member_express_ground(b, 0,
                                    ct_build_in_plane(b, ct_ex3_neg(b->x, b->model->gravity)));
}

const struct ct_members *ct_members_derive(struct ct_build *b)
{
    struct ct_members *s = CT_NEW(b->arena, struct ct_members);
    struct ct_member_work w = {.b = b, .s = s};
    if (b->model->simulation.small.given || b->eqs->nrow || !beams_fit(b))
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
