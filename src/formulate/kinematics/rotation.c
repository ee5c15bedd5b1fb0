// Rotations along the rotational tree. A cluster is a set of frames without relative rotation.
//
// A branch adds one cluster for each of its axes. Rotations about parallel axes are accumulated: R
// = R_base Rot(axis, angle). A chain of parallel revolute joints then needs one sine and cosine per
// body.
#include "formulate/beam/flexible_body.h"
#include "formulate/beam/section_rotation.h"
#include "formulate/topology/linear_graph.h"
#include "formulate/kinematics/kinematics.h"
#include "formulate/kinematics/switch.h"

#include <assert.h>
#include <string.h>

// ---- unknowns -----------------------------------------------------------------------------------

static bool is_branch_coordinate(const struct ct_build *b, const struct ct_coordinate *c)
{
    return (c->in_translation && b->T.is_branch[c->edge])
        || (c->in_rotation && b->R.is_branch[c->edge]);
}

static int new_speed(struct ct_build *b, const struct ct_edge_info *e, const char *suffix,
                     int q, bool is_turn)
{
    struct ct_equations *s = b->eqs;
    struct ct_u u = {.name = ct_arena_printf(b->arena, "%s.u%s", e->name, suffix),
                     .q = q,
                     .is_rotation = is_turn};
    u.joint = e->kind == CT_EDGE_JOINT ? e->index : -1;
    u.body = e->kind == CT_EDGE_BODY ? e->index : -1;
    u.symbol = ct_ex_sym(b->x, CT_SYM_U, u.name, (uint32_t)s->nu);
    u.derivative = ct_ex_sym(
        b->x, CT_SYM_A, ct_arena_printf(b->arena, "%s.a%s", e->name, suffix), (uint32_t)s->nu);
    CT_PUSH(b->arena, s->u, s->nu, s->u_cap, u);
    return (int)s->nu - 1;
}

static int new_coordinate(struct ct_build *b, const char *name, int quaternion)
{
    struct ct_equations *s = b->eqs;
    struct ct_q q = {.name = name, .quaternion = quaternion};
    q.symbol = ct_ex_sym(b->x, CT_SYM_Q, name, (uint32_t)s->nq);
    CT_PUSH(b->arena, s->q, s->nq, s->q_cap, q);
    return (int)s->nq - 1;
}

// Rates of a unit quaternion from the angular velocity w in body axes.  (7.1)
static void quaternion_rates(struct ct_build *b, int first, const ct_ex w[3])
{
    struct ct_exs *x = b->x;
    struct ct_q *q = &b->eqs->q[first];
    const ct_ex p0 = q[0].symbol;
    const ct_ex3 p = {{q[1].symbol, q[2].symbol, q[3].symbol}}, W = {{w[0], w[1], w[2]}};
    const ct_ex3 c = ct_ex3_cross(x, p, W);
    q[0].rate = ct_ex_scale(x, -0.5, ct_ex3_dot(x, p, W));
    for (int i = 0; i < 3; i++)
        q[1 + i].rate = ct_ex_scale(x, 0.5, ct_ex_add(x, ct_ex_mul(x, p0, W.e[i]), c.e[i]));
}

// Adds the four parameters c[0..3] of a quaternion and its three speeds.
static void choose_quaternion(struct ct_build *b, const struct ct_edge_info *e,
                              struct ct_coordinate *c)
{
    ct_ex w[3];
    const int first = (int)b->eqs->nq;
    for (int i = 0; i < 4; i++) {
        c[i].q = new_coordinate(b, c[i].name, i);
        c[i].value = b->eqs->q[c[i].q].symbol;
    }
    for (int i = 0; i < 3; i++) {
        c[i].u = new_speed(b, e, ct_arena_printf(b->arena, "%d", c[i].index + 1), -1, true);
        w[i] = b->eqs->u[c[i].u].symbol;
    }
    quaternion_rates(b, first, w);
    for (int i = 0; i < 4; i++)
        c[i].rate = b->eqs->q[c[i].q].rate;
}

static void choose_driven(struct ct_build *b, const struct ct_edge_info *e,
                          struct ct_coordinate *c)
{
    struct ct_driver d = {.name = c->name, .joint = e->index, .index = c->index};
    const struct ct_value *motion = ct_instance_value(e->self, "motion");
    d.mark = b->signals.holding = motion->at[c->index];
    d.value = ct_switch_hold(b, motion->e[c->index]);
    if (!b->options->drivers_are_held) {
        d.rate = ct_build_rate(b, d.value);
        d.acceleration = ct_build_rate(b, d.rate);
    }
    c->value = d.value;
    c->rate = d.rate;
    c->driver = (int)b->eqs->ndriver;
    CT_PUSH(b->arena, b->eqs->driver, b->eqs->ndriver, b->eqs->driver_cap, d);
}

static void choose_plain(struct ct_build *b, const struct ct_edge_info *e,
                         struct ct_coordinate *c)
{
    const bool one = e->trial->nfree == 1;
    const char *suffix = one ? "" : ct_arena_printf(b->arena, "%d", c->index + 1);
    c->q = new_coordinate(b, c->name, -1);
    c->u = new_speed(b, e, suffix, c->q, c->in_rotation);
    c->value = b->eqs->q[c->q].symbol;
    c->rate = b->eqs->q[c->q].rate = b->eqs->u[c->u].symbol;
}

// Station of a beam arm: position and rotation of its section and their derivatives by the elastic
// coordinates.
static void find_station(struct ct_build *b, struct ct_kinematics *kinematics,
                         const struct ct_edge_info *e)
{
    const struct ct_flexible *f = ct_flexible_of_edge(b, e);
    struct ct_edge_kinematics *k = &kinematics->edge[e - b->topology->edge];
    struct ct_station *s = CT_NEW(b->arena, struct ct_station);
    ct_flexible_station(b, f, e->along, f->kinematics, s);
    k->translation = CT_NEWN(b->arena, ct_ex3, f->nelastic + 1);
    k->rotation = CT_NEWN(b->arena, ct_ex3, f->nelastic + 1);
    ct_station_partials(b, f, s, k->translation, k->rotation);
    k->station = s;
    if (f->kinematics != f->axial) {
        struct ct_station forces;
        k->foreshortened = CT_NEWN(b->arena, ct_ex3, f->nelastic + 1);
        ct_flexible_station(b, f, e->along, f->axial, &forces);
        ct_station_partials(b, f, &forces, k->foreshortened,
                            CT_NEWN(b->arena, ct_ex3, f->nelastic + 1));
    }
    k->d = s->position;
    struct ct_motion m = {.quaternion = -1};
    struct ct_section_turn turn[4];
    const int n = ct_section_turns(s->angle, turn);
    for (int i = 0; i < n; i++) {
        double axis[3] = {0};
        axis[turn[i].axis] = 1;
        ct_motion_add_rotation(&m, ct_ex3_const(b->x, axis),
                               ct_ex_scale(b->x, turn[i].share, s->angle[turn[i].axis]));
    }
    k->motion = ct_motion_keep(b->arena, &m);
}

// Adds a state of the model as a speed that moves nothing.
static void add_state(struct ct_build *b, const char *name)
{
    struct ct_equations *s = b->eqs;
    const uint32_t k = (uint32_t)s->nu;
    const struct ct_u z
        = {.name = name,
           .symbol = ct_ex_sym(b->x, CT_SYM_U, name, k),
           .derivative = ct_ex_sym(b->x, CT_SYM_A, ct_arena_printf(b->arena, "%s'", name), k),
           .q = -1,
           .joint = -1,
           .body = -1};
    CT_PUSH(b->arena, s->u, s->nu, s->u_cap, z);
    s->nstate++;
}

void ct_unknowns_choose(struct ct_build *b, struct ct_kinematics *kinematics)
{
    static const struct ct_motion none = {.quaternion = -1};
    const size_t ncoordinate = b->topology->ncoordinate;
    kinematics->edge = CT_NEWN(b->arena, struct ct_edge_kinematics, b->topology->nedge + 1);
    kinematics->coordinate = CT_NEWN(b->arena, struct ct_coordinate, ncoordinate + 1);
    if (ncoordinate)
        memcpy(kinematics->coordinate, b->topology->coordinate,
               ncoordinate * sizeof *kinematics->coordinate);
    b->cache.measured = CT_NEWN(b->arena, struct ct_measured, ncoordinate + 1);
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_edge_info *e = &b->topology->edge[i];
        for (int k = 0; k < e->ncoordinate; k++) {
            struct ct_coordinate *c = &kinematics->coordinate[e->first_coordinate + k];
            if (!is_branch_coordinate(b, c))
                continue;
            if (c->is_driven) {
                choose_driven(b, e, c);
            } else if (e->trial->quaternion == k) {
                choose_quaternion(b, e, c);
                break;
            } else {
                choose_plain(b, e, c);
            }
        }
        struct ct_edge_kinematics *kept = &kinematics->edge[i];
        struct ct_motion m = {.ncoord = e->trial->ncoord, .nfree = e->trial->nfree};
        for (int k = 0; k < e->ncoordinate; k++)
            m.coord[k] = b->kinematics->coordinate[e->first_coordinate + k].value;
        ct_linear_graph_edge_motion(b, e, &m);
        const bool is_fixed = e->kind == CT_EDGE_ARM || e->kind == CT_EDGE_FORCE;
        *kept = (struct ct_edge_kinematics){
            .d = m.d, .motion = is_fixed ? &none : ct_motion_keep(b->arena, &m)};
    }
    for (size_t i = 0; i < b->nflexible; i++)
        ct_flexible_unknowns(b, &b->flexible[i]);
    for (size_t i = 0; i < b->topology->nedge; i++)
        if (b->topology->edge[i].beam >= 0)
            find_station(b, kinematics, &b->topology->edge[i]);
    b->eqs->nmotion = b->eqs->nu;
    for (size_t i = 0; i < b->model->nstate; i++)
        add_state(b, b->model->state[i].name);
}

// ---- rates -------------------------------------------------------------------------------------

static bool is_moving(const struct ct_exs *x, ct_ex e, unsigned moving)
{
    const struct ct_sym *sym = ct_ex_symbol(x, e);
    return sym && (moving & 1u << sym->kind);
}

ct_ex ct_build_rate(struct ct_build *b, ct_ex e)
{
    const struct ct_equations *s = b->eqs;
    const unsigned moving
        = 1u << CT_SYM_Q | (b->options->drivers_are_held ? 0 : 1u << CT_SYM_TIME);
    if (!(ct_ex_kinds(b->x, e) & moving))
        return CT_EX_ZERO;
    // only the symbols in e matter; joints have few
    const size_t nwalk = ct_ex_walk(b->x, &e, 1);
    size_t n = 0;
    for (size_t i = 0; i < nwalk; i++)
        n += is_moving(b->x, (ct_ex){b->x->stack[i]}, moving);
    ct_ex *from = CT_NEWN(b->arena, ct_ex, n + 1), *to = CT_NEWN(b->arena, ct_ex, n + 1);
    n = 0;
    for (size_t i = 0; i < nwalk; i++) {
        const ct_ex leaf = {b->x->stack[i]};
        if (!is_moving(b->x, leaf, moving))
            continue;
        const struct ct_sym *sym = ct_ex_symbol(b->x, leaf);
        from[n] = leaf;
        to[n++] = sym->kind == CT_SYM_TIME ? CT_EX_ONE : s->q[sym->index].rate;
    }
    return ct_ex_diff_along(b->x, e, from, to, n);
}

ct_ex3 ct_build_rate3(struct ct_build *b, ct_ex3 e)
{
    for (int i = 0; i < 3; i++)
        e.e[i] = ct_build_rate(b, e.e[i]);
    return e;
}

// ---- clusters ----------------------------------------------------------------------------------

static int add_cluster(struct ct_build *b, struct ct_kinematics *kinematics, int parent,
                       int nspin)
{
    const struct ct_cluster c
        = {.parent = parent, .first_axis = (int)kinematics->nrotation_axis, .naxis = nspin};
    CT_PUSH(b->arena, kinematics->cluster, kinematics->ncluster, kinematics->cluster_cap, c);
    return (int)kinematics->ncluster - 1;
}

static bool same3(ct_ex3 a, ct_ex3 b)
{
    return ct_ex_same(a.e[0], b.e[0]) && ct_ex_same(a.e[1], b.e[1])
        && ct_ex_same(a.e[2], b.e[2]);
}

ct_ex ct_edge_partial(struct ct_build *b, const struct ct_edge_info *e, ct_ex trial, int k)
{
    const ct_ex c = ct_ex_diff(b->x, trial, e->trial->coord[k]);
    return ct_ex_subst(b->x, c, e->trial->coord, ct_edge_motion(b, e)->coord,
                       (size_t)e->ncoordinate);
}

static void add_term(struct ct_build *b, struct ct_rotation_axis *s, int speed, int driver,
                     int sign, ct_ex coef)
{
    if (!ct_ex_is_zero(coef))
        s->term[s->nterm++]
            = (struct ct_term){speed, driver, sign > 0 ? coef : ct_ex_neg(b->x, coef)};
}

// Terms of the i-th rotation of a beam section: derivatives of its angle by the elastic
// coordinates.
static void section_terms(struct ct_build *b, const struct ct_edge_info *e, int i, int sign,
                          struct ct_rotation_axis *s)
{
    const struct ct_flexible *f = ct_flexible_of_edge(b, e);
    const struct ct_edge_kinematics *kin = ct_edge_kinematics(b, e);
    struct ct_section_turn turn[4];
    ct_section_turns(kin->station->angle, turn);
    s->term = CT_NEWN(b->arena, struct ct_term, f->nelastic + 1);
    for (int k = 0; k < f->nelastic; k++)
        add_term(b, s, f->elastic[k].u, -1, sign,
                 ct_ex_scale(b->x, turn[i].share, kin->rotation[k].e[turn[i].axis]));
}

void ct_rotation_turn_sections(struct ct_build *b, struct ct_kinematics *kinematics)
{
    for (size_t i = 0; i < kinematics->nrotation_axis; i++) {
        struct ct_rotation_axis *s = &kinematics->rotation_axis[i];
        s->nterm = s->section ? 0 : s->nterm;
        if (s->section)
            section_terms(b, &b->topology->edge[s->section - 1], s->turn, s->sign, s);
    }
}

// Adds the rotation axis of the i-th rotation of branch e, which is fixed in the parent. The
// coefficients of its rate are sign * d angle / d q_k.
static void add_rotation_axis(struct ct_build *b, struct ct_kinematics *kinematics, int cluster,
                              const struct ct_edge_info *e, int i, int sign, ct_ex3 local,
                              ct_ex angle)
{
    // the axis is fixed in the parent and in the child
    struct ct_rotation_axis s
        = {.cluster = cluster,
           .axis = ct_cluster_turn(b, kinematics->cluster[cluster].base, local)};
    if (e->beam >= 0) {
        s.section = (int)(e - b->topology->edge) + 1;
        s.turn = i;
        s.sign = sign;
        section_terms(b, e, i, sign, &s);
    } else {
        s.term = CT_NEWN(b->arena, struct ct_term, e->ncoordinate + 1);
        for (int k = 0; k < e->ncoordinate; k++) {
            const struct ct_coordinate *c = &b->kinematics->coordinate[e->first_coordinate + k];
            add_term(b, &s, c->u, c->driver, sign,
                     ct_edge_partial(b, e, e->trial->turn[i].angle, k));
        }
    }
    s.local = local;
    s.rate = ct_build_rate(b, angle);
    s.bias = ct_build_rate(b, s.rate);
    CT_PUSH(b->arena, kinematics->rotation_axis, kinematics->nrotation_axis,
            kinematics->rotation_axis_cap, s);
}

// Cluster rotated about a local axis of `parent`; rotations about parallel axes are accumulated.
static int turn_cluster(struct ct_build *b, struct ct_kinematics *kinematics, int parent,
                        const struct ct_edge_info *e, int i, int sign, ct_ex3 axis)
{
    struct ct_exs *x = b->x;
    ct_ex angle = ct_edge_motion(b, e)->turn[i].angle;
    if (sign < 0)
        angle = ct_ex_neg(x, angle);
    const int c = add_cluster(b, kinematics, parent, 1);
    struct ct_cluster *self = &kinematics->cluster[c];
    const struct ct_cluster *p = &kinematics->cluster[parent];
    const ct_ex3 opposite = ct_ex3_neg(x, axis);
    self->has_angle = true;
    self->own_angle = angle;
    if (p->has_angle && (same3(p->axis, axis) || same3(p->axis, opposite))) {
        self->base = p->base;
        self->axis = p->axis;
        self->angle = same3(p->axis, axis) ? ct_ex_add(x, p->angle, angle)
                                           : ct_ex_sub(x, p->angle, angle);
    } else {
        self->base = parent;
        self->axis = axis;
        self->angle = angle;
    }
    const ct_ex33 *B = &kinematics->cluster[self->base].R;
    const ct_ex33 A = ct_ex33_axis_angle(x, self->axis, self->angle);
    self->R = ct_ex33_mul(x, B, &A);
    add_rotation_axis(b, kinematics, c, e, i, sign, axis, angle);
    return c;
}

// S(p) of a unit quaternion: 1 + 2 (p0 v~ + v~ v~), 12 products.  (7.2)
static ct_ex33 quaternion_matrix(struct ct_exs *x, const ct_ex p[4])
{
    ct_ex33 R;
    ct_ex twice[3], square[3];
    for (int i = 0; i < 3; i++) {
        twice[i] = ct_ex_scale(x, 2, p[1 + i]);
        square[i] = ct_ex_mul(x, twice[i], p[1 + i]);
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        R.e[i + 3 * i] = ct_ex_sub(x, CT_EX_ONE, ct_ex_add(x, square[j], square[k]));
        const ct_ex both = ct_ex_mul(x, twice[i], p[1 + j]),
                    turn = ct_ex_mul(x, twice[k], p[0]);
        R.e[j + 3 * i] = ct_ex_add(x, both, turn);
        R.e[i + 3 * j] = ct_ex_sub(x, both, turn);
    }
    return R;
}

// Cluster of a spherical rotation. The axes of `to` belong to the child (sign +1) or to the parent.
static int quaternion_cluster(struct ct_build *b, struct ct_kinematics *kinematics, int parent,
                              const ct_ex33 *S, const struct ct_edge_info *e, int sign)
{
    struct ct_exs *x = b->x;
    const int c = add_cluster(b, kinematics, parent, 3);
    const ct_ex33 P = ct_ex33_mul(x, &kinematics->cluster[parent].R, S);
    const int k = ct_edge_motion(b, e)->quaternion;
    const ct_ex33 forward = quaternion_matrix(x, &ct_edge_motion(b, e)->coord[k]);
    const ct_ex33 A = sign > 0 ? forward : ct_ex33_transpose(&forward);
    kinematics->cluster[c].R = ct_ex33_mul(x, &P, &A);
    kinematics->cluster[c].S = ct_ex33_mul(x, S, &A);
    const ct_ex33 *to = sign > 0 ? &kinematics->cluster[c].R : &P;
    for (int i = 0; i < 3; i++) {
        const struct ct_coordinate *coordinate
            = &b->kinematics->coordinate[e->first_coordinate + k + i];
        struct ct_rotation_axis s = {.cluster = c, .nterm = 1};
        s.axis = (ct_ex3){{to->e[3 * i], to->e[3 * i + 1], to->e[3 * i + 2]}};
        if (sign < 0)
            s.axis = ct_ex3_neg(x, s.axis);
        else
            s.local.e[i] = CT_EX_ONE;
        s.term = CT_NEW(b->arena, struct ct_term);
        s.term[0] = (struct ct_term){coordinate->u, -1, CT_EX_ONE};
        s.rate = b->eqs->u[coordinate->u].symbol;
        CT_PUSH(b->arena, kinematics->rotation_axis, kinematics->nrotation_axis,
                kinematics->rotation_axis_cap, s);
    }
    return c;
}

// Derives the axes of a node from those of its parent in the rotational tree.
static void place_axes(struct ct_build *b, struct ct_kinematics *kinematics, int node)
{
    const struct ct_edge_info *e = &b->topology->edge[b->R.parent_edge[node]];
    const struct ct_node_placement *p = &kinematics->placement[b->R.parent[node]];
    struct ct_node_placement *self = &kinematics->placement[node];
    const int sign = b->R.sign[node];
    self->frame = p->frame;
    ct_ex33 S = p->S; // of the axes in which the rotation axes are given
    if (e->kind == CT_EDGE_ARM) {
        const ct_ex33 own = sign > 0 ? e->S : ct_ex33_transpose(&e->S);
        S = ct_ex33_mul(b->x, &p->S, &own);
    }
    self->S = S;
    for (int i = 0; i < ct_edge_motion(b, e)->nturn; i++) {
        const int k = sign > 0
                        ? i
                        : ct_edge_motion(b, e)->nturn - 1 - i; // backwards from `to` to `from`
        const ct_ex3 axis
            = ct_ex33_apply(b->x, sign > 0 ? &p->S : &S, ct_edge_motion(b, e)->turn[k].axis);
        self->frame = turn_cluster(b, kinematics, self->frame, e, k, sign, axis);
    }
    if (e->kind == CT_EDGE_ARM)
        return;
    if (e->kind == CT_EDGE_BODY) // always from ground outwards
        self->S = e->S;
    if (ct_edge_motion(b, e)->quaternion >= 0) {
        self->frame = quaternion_cluster(b, kinematics, self->frame, &p->S, e, sign);
        self->S = ct_ex33_identity();
    }
}

// Sets the preorder intervals. Parents have smaller numbers than children.
static void number_clusters(struct ct_build *b, struct ct_kinematics *kinematics)
{
    int *size = CT_NEWN(b->arena, int, kinematics->ncluster),
        *next = CT_NEWN(b->arena, int, kinematics->ncluster);
    for (size_t c = kinematics->ncluster; c-- > 1;)
        size[kinematics->cluster[c].parent] += ++size[c];
    kinematics->cluster[0].enter = 0;
    kinematics->cluster[0].leave = size[0];
    next[0] = 1;
    for (size_t c = 1; c < kinematics->ncluster; c++) {
        struct ct_cluster *self = &kinematics->cluster[c];
        self->enter = next[self->parent];
        self->leave = self->enter + size[c] - 1;
        next[self->parent] += size[c];
        next[c] = self->enter + 1;
    }
}

static ct_ex3 relative_velocity(struct ct_build *b, int c)
{
    const struct ct_cluster *self = &b->kinematics->cluster[c];
    ct_ex3 w = {{{0}, {0}, {0}}};
    for (int i = 0; i < self->naxis; i++) {
        const struct ct_rotation_axis *s = &b->kinematics->rotation_axis[self->first_axis + i];
        w = ct_ex3_add(b->x, w, ct_ex3_scale(b->x, s->rate, s->axis));
    }
    return w;
}

void ct_rotation_derive(struct ct_build *b, struct ct_kinematics *kinematics)
{
    kinematics->placement = CT_NEWN(b->arena, struct ct_node_placement, b->topology->nnode);
    add_cluster(b, kinematics, -1, 0);
    kinematics->cluster[0].R = ct_ex33_identity();
    kinematics->placement[0].S = ct_ex33_identity();
    for (size_t i = 1; i < b->topology->nnode; i++)
        place_axes(b, kinematics, b->R.order[i]);
    number_clusters(b, kinematics);
    b->cache.cluster = CT_NEWN(b->arena, struct ct_cluster_cache, kinematics->ncluster);
    for (size_t c = 1; c < kinematics->ncluster; c++) {
        struct ct_cluster *self = &kinematics->cluster[c];
        self->w = ct_ex3_add(b->x, kinematics->cluster[self->parent].w,
                             relative_velocity(b, (int)c));
        if (b->topology->is_planar) { // a single axis: the normal or its opposite
            const struct ct_rotation_axis *s = &kinematics->rotation_axis[self->first_axis];
            const ct_ex inner = kinematics->cluster[self->parent].omega;
            self->omega = ct_rotation_axis_is_positive(b, (size_t)self->first_axis)
                            ? ct_ex_add(b->x, inner, s->rate)
                            : ct_ex_sub(b->x, inner, s->rate);
        }
    }
}

bool ct_rotation_axis_is_positive(const struct ct_build *b, size_t r)
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += ct_ex_value(b->x, b->kinematics->rotation_axis[r].axis.e[i], b->value)
             * ct_ex_value(b->x, b->topology->plane[2].e[i], b->value);
    return sum > 0;
}

ct_ex3 ct_cluster_velocity(const struct ct_build *b, int c)
{
    return b->kinematics->cluster[c].w;
}

// bias + coef u': the angular acceleration about one axis.
static ct_ex axis_acceleration(struct ct_build *b, const struct ct_rotation_axis *s,
                               enum ct_level level)
{
    ct_ex rate = s->bias;
    for (int k = 0; level == CT_FULL && k < s->nterm; k++)
        if (s->term[k].speed >= 0)
            rate = ct_ex_add(
                b->x, rate,
                ct_ex_mul(b->x, s->term[k].coef, b->eqs->u[s->term[k].speed].derivative));
    return rate;
}

bool ct_cluster_own_rates(struct ct_build *b, int c, enum ct_level level, ct_ex3 *w, ct_ex3 *al)
{
    const struct ct_cluster *self = &b->kinematics->cluster[c];
    *w = *al = (ct_ex3){{{0}, {0}, {0}}};
    if (c && self->parent != 0)
        return false;
    for (int i = 0; i < self->naxis; i++) {
        const struct ct_rotation_axis *s = &b->kinematics->rotation_axis[self->first_axis + i];
        if (ct_ex3_is_zero(s->local))
            return false;
        const ct_ex rate = axis_acceleration(b, s, level);
        *w = ct_ex3_add(b->x, *w, ct_ex3_scale(b->x, s->rate, s->local));
        *al = ct_ex3_add(b->x, *al, ct_ex3_scale(b->x, rate, s->local));
    }
    return true;
}

// al - al_p = sum s (bias + coef u') + w_p x w_rel: The axis of a single rotation is fixed in both
// frames, the axes of a quaternion in one of them; the formula is the same.  (4.1), (1.8)
static ct_ex3 relative_acceleration(struct ct_build *b, int c, enum ct_level level)
{
    const struct ct_cluster *self = &b->kinematics->cluster[c];
    struct ct_exs *x = b->x;
    ct_ex3 w = {{{0}, {0}, {0}}}, al = w;
    for (int i = 0; i < self->naxis; i++) {
        const struct ct_rotation_axis *s = &b->kinematics->rotation_axis[self->first_axis + i];
        const ct_ex rate = axis_acceleration(b, s, level);
        al = ct_ex3_add(x, al, ct_ex3_scale(x, rate, s->axis));
        w = ct_ex3_add(x, w, ct_ex3_scale(x, s->rate, s->axis));
    }
    if (b->topology->is_planar)
        return al; // all axes are parallel
    return ct_ex3_add(x, al, ct_ex3_cross(x, b->kinematics->cluster[self->parent].w, w));
}

ct_ex3 ct_cluster_acceleration(struct ct_build *b, int c, enum ct_level level)
{
    struct ct_cluster_cache *self = &b->cache.cluster[c];
    if (c && !self->has_al[level]) {
        const int parent = b->kinematics->cluster[c].parent;
        self->al[level] = ct_ex3_add(b->x, ct_cluster_acceleration(b, parent, level),
                                     relative_acceleration(b, c, level));
        self->has_al[level] = true;
    }
    return self->al[level];
}

ct_ex3 ct_cluster_path_velocity(struct ct_build *b, int from, int to)
{
    ct_ex3 sum = {{{0}, {0}, {0}}};
    int n = 0;
    for (int c = to; c > 0 && n <= CT_LONG_PATH; c = b->kinematics->cluster[c].parent)
        n++;
    if (from == 0 && n > CT_LONG_PATH)
        return ct_cluster_velocity(b, to);
    while (from != to) // parents have smaller numbers: replace the larger one by its parent
        if (to > from) {
            sum = ct_ex3_add(b->x, sum, relative_velocity(b, to));
            to = b->kinematics->cluster[to].parent;
        } else {
            sum = ct_ex3_sub(b->x, sum, relative_velocity(b, from));
            from = b->kinematics->cluster[from].parent;
        }
    return sum;
}

ct_ex3 ct_cluster_path_acceleration(struct ct_build *b, int from, int to, enum ct_level level)
{
    ct_ex3 sum = {{{0}, {0}, {0}}};
    while (from != to)
        if (to > from) {
            sum = ct_ex3_add(b->x, sum, relative_acceleration(b, to, level));
            to = b->kinematics->cluster[to].parent;
        } else {
            sum = ct_ex3_sub(b->x, sum, relative_acceleration(b, from, level));
            from = b->kinematics->cluster[from].parent;
        }
    return sum;
}

ct_ex33 ct_cluster_relative(struct ct_build *b, int c)
{
    const struct ct_cluster *self = &b->kinematics->cluster[c];
    return self->has_angle ? ct_ex33_axis_angle(
               b->x, b->kinematics->rotation_axis[self->first_axis].local, self->own_angle)
                           : self->S;
}

ct_ex3 ct_cluster_turn(struct ct_build *b, int c, ct_ex3 local)
{
    return ct_ex33_apply(b->x, &b->kinematics->cluster[c].R, local);
}

ct_ex3 ct_cluster_cross_velocity(struct ct_build *b, int c, ct_ex3 v)
{
    return ct_ex3_cross(b->x, b->kinematics->cluster[c].w, v);
}

ct_ex3 ct_cluster_centripetal(struct ct_build *b, int c, ct_ex3 v)
{
    struct ct_exs *x = b->x;
    const ct_ex3 w = b->kinematics->cluster[c].w;
    if (!b->topology->is_planar)
        return ct_ex3_cross(x, w, ct_ex3_cross(x, w, v));
    const ct_ex omega = b->kinematics->cluster[c].omega;
    return ct_ex3_neg(x, ct_ex3_scale(x, ct_ex_mul(x, omega, omega), ct_build_in_plane(b, v)));
}

// ---- axes of nodes -----------------------------------------------------------------------------

ct_ex33 ct_node_rotation(struct ct_build *b, int node)
{
    const struct ct_node_placement *p = &b->kinematics->placement[node];
    return ct_ex33_mul(b->x, &b->kinematics->cluster[p->frame].R, &p->S);
}

ct_ex3 ct_node_turn(struct ct_build *b, int node, ct_ex3 v)
{
    const struct ct_node_placement *p = &b->kinematics->placement[node];
    return ct_cluster_turn(b, p->frame, ct_ex33_apply(b->x, &p->S, v));
}

ct_ex3 ct_node_unturn(struct ct_build *b, int node, ct_ex3 v)
{
    const struct ct_node_placement *p = &b->kinematics->placement[node];
    return ct_ex33_apply_t(b->x, &p->S,
                           ct_ex33_apply_t(b->x, &b->kinematics->cluster[p->frame].R, v));
}
