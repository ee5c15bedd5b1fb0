// See coordinate.h.
#include "formulate/kinematics/coordinate.h"

#include <string.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

static const struct ct_measure *measure_of(const struct ct_build *b,
                                           const struct ct_coordinate *c)
{
    const struct ct_motion *m = b->kinematics->edge[c->edge].motion;
    const int k = m->quaternion >= 0 && c->index >= m->quaternion ? m->quaternion : c->index;
    return &m->measure[k];
}

ct_ex ct_memory_new(struct ct_build *b, enum ct_memory_kind kind, const char *name, int joint,
                    int place)
{
    struct ct_equations *s = b->eqs;
    struct ct_memory m = {.kind = kind, .joint = joint, .index = place};
    m.symbol
        = ct_ex_sym(b->x, CT_SYM_MEMORY,
                    kind == CT_MEMORY_TURNS ? name : ct_arena_printf(b->arena, "%s.last", name),
                    (uint32_t)s->nmemory);
    CT_PUSH(b->arena, s->memory, s->nmemory, s->memory_cap, m);
    return m.symbol;
}

ct_ex ct_memory_keep(struct ct_build *b, const char *name, int joint, ct_ex at_start)
{
    const size_t i = b->eqs->nmemory;
    const ct_ex s = ct_memory_new(b, CT_MEMORY_OFFSET, name, joint, 0);
    b->eqs->memory[i].update = at_start;
    return s;
}

// Continuous angle about a from V to W: its last value r plus the remaining angle. This stays small
// within a step, so that atan2 does not reach its branch cut.
static ct_ex angle_from(struct ct_build *b, const char *name, int joint, int place, ct_ex sine,
                        ct_ex cosine)
{
    struct ct_exs *x = b->x;
    const size_t i = b->eqs->nmemory;
    const ct_ex r = ct_memory_new(b, CT_MEMORY_ANGLE, name, joint, place);
    const ct_ex sr = ct_ex_fun(x, CT_OP_SIN, r), cr = ct_ex_fun(x, CT_OP_COS, r);
    const ct_ex s = ct_ex_sub(x, ct_ex_mul(x, sine, cr), ct_ex_mul(x, cosine, sr));
    const ct_ex c = ct_ex_add(x, ct_ex_mul(x, cosine, cr), ct_ex_mul(x, sine, sr));
    const ct_ex angle = ct_ex_add(x, r, ct_ex_fun2(x, CT_OP_ATAN2, s, c));
    b->eqs->memory[i].update = angle;
    return angle;
}

// Angle about the normal of an in-plane vector, relative to the axes of its frame. v: in axes of
// the node.
static ct_ex angle_in_frame(struct ct_build *b, int node, ct_ex3 v)
{
    struct ct_exs *x = b->x;
    const ct_ex3 e1 = b->topology->plane[0],
                 s = ct_ex33_apply(x, &b->kinematics->placement[node].S, v);
    const ct_ex sine = ct_ex3_dot(x, b->topology->plane[2], ct_ex3_cross(x, e1, s));
    return ct_ex_fun2(x, CT_OP_ATAN2, sine, ct_ex3_dot(x, e1, s));
}

// Does a direction parallel to the normal have the sense of the normal?
static bool is_upward(const struct ct_build *b, const ct_ex3 *direction)
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += ct_ex_value(b->x, direction->e[i], b->value)
             * ct_ex_value(b->x, b->topology->plane[2].e[i], b->value);
    return sum > 0;
}

ct_ex ct_angle_in_plane(struct ct_build *b, int node, ct_ex3 v)
{
    struct ct_exs *x = b->x;
    const struct ct_cluster *c = &b->kinematics->cluster[b->kinematics->placement[node].frame];
    const ct_ex own = angle_in_frame(b, node, v);
    if (!c->has_angle)
        return own;
    return is_upward(b, &c->axis) ? ct_ex_add(x, own, c->angle) : ct_ex_sub(x, own, c->angle);
}

// Angle in a plane: the angle about a from V to W is a difference of two angle sums plus a constant
// number of whole turns. False if V or W is not fixed in its frame.
static bool add_angles(struct ct_build *b, const struct ct_measure *m, struct ct_ends p,
                       ct_ex3 a, ct_ex *sum)
{
    struct ct_exs *x = b->x;
    const unsigned known = 1u << CT_SYM_PARAM;
    if (!b->topology->is_planar
        || (ct_ex_kinds(x, angle_in_frame(b, p.tail, m->v))
            | ct_ex_kinds(x, angle_in_frame(b, p.head, m->w)))
               & ~known)
        return false;
    const ct_ex V = ct_angle_in_plane(b, p.tail, m->v), W = ct_angle_in_plane(b, p.head, m->w);
    *sum = is_upward(b, &a) ? ct_ex_sub(x, W, V) : ct_ex_sub(x, V, W);
    return true;
}

static ct_ex measure_angle(struct ct_build *b, const struct ct_coordinate *c,
                           const struct ct_measure *m)
{
    struct ct_exs *x = b->x;
    const struct ct_ends p = ct_edge_ends(b, c->edge);
    const ct_ex3 a = ct_node_turn(b, m->reversed ? p.head : p.tail, m->about);
    const ct_ex3 V = ct_node_turn(b, p.tail, m->v), W = ct_node_turn(b, p.head, m->w);
    // the components of V and W along a are constant; they are computed in the frame in which a is
    // fixed
    const ct_ex along = ct_ex3_dot(x, m->about, m->reversed ? m->w : m->v);
    const ct_ex cosine = ct_ex_sub(x, ct_ex3_dot(x, V, W), ct_ex_mul(x, along, along));
    const ct_ex sine = ct_ex3_dot(x, a, ct_ex3_cross(x, V, W));
    const struct ct_edge_info *e = &b->topology->edge[c->edge];
    const int joint = e->kind == CT_EDGE_JOINT ? e->index : -1;
    const size_t r = b->eqs->nmemory;
    const ct_ex followed = angle_from(b, c->name, joint, c->index, sine, cosine);
    ct_ex sum;
    if (!add_angles(b, m, p, a, &sum))
        return followed;
    const ct_ex turns = ct_memory_new(
        b, CT_MEMORY_TURNS, ct_arena_printf(b->arena, "%s.turns", c->name), joint, c->index);
    const ct_ex angle = ct_ex_add(b->x, sum, turns);
    b->eqs->memory[r + 1].update = ct_ex_sub(b->x, followed, sum);
    b->eqs->memory[r].update = angle;
    b->eqs->memory[r].is_sum = true;
    return angle;
}

void ct_quaternion_follow(struct ct_build *b, const char *name, const ct_ex33 *R, ct_ex out[4])
{
    struct ct_exs *x = b->x;
    const size_t first = b->eqs->nmemory;
    ct_ex r[4];
    for (int i = 0; i < 4; i++)
        r[i] = ct_memory_new(b, CT_MEMORY_QUATERNION, name, -1, i);
    b->eqs->memory[first].R = *R;
    // D = S(r)' R is a small rotation with quaternion w = sqrt(1 + trace)/2, v = axial part/(4 w)
    const ct_ex two = ct_ex_const(x, 2);
    ct_ex33 S;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const ct_ex square
            = ct_ex_add(x, ct_ex_mul(x, r[0], r[0]), ct_ex_mul(x, r[1 + i], r[1 + i]));
        const ct_ex both = ct_ex_mul(x, r[1 + i], r[1 + j]),
                    turn = ct_ex_mul(x, r[0], r[1 + k]);
        S.e[4 * i] = ct_ex_sub(x, ct_ex_mul(x, two, square), CT_EX_ONE);
        S.e[j + 3 * i] = ct_ex_mul(x, two, ct_ex_add(x, both, turn));
        S.e[i + 3 * j] = ct_ex_mul(x, two, ct_ex_sub(x, both, turn));
    }
    const ct_ex33 T = ct_ex33_transpose(&S), D = ct_ex33_mul(x, &T, R);
    const ct_ex trace = ct_ex_add(x, D.e[0], ct_ex_add(x, D.e[4], D.e[8]));
    const ct_ex root = ct_ex_fun(x, CT_OP_SQRT, ct_ex_add(x, CT_EX_ONE, trace));
    const ct_ex w = ct_ex_scale(x, 0.5, root), four_w = ct_ex_scale(x, 2, root);
    const ct_ex3 v = {{ct_ex_div(x, ct_ex_sub(x, D.e[5], D.e[7]), four_w),
                       ct_ex_div(x, ct_ex_sub(x, D.e[6], D.e[2]), four_w),
                       ct_ex_div(x, ct_ex_sub(x, D.e[1], D.e[3]), four_w)}};
    const ct_ex3 rv = {{r[1], r[2], r[3]}}, c = ct_ex3_cross(x, rv, v);
    out[0] = ct_ex_sub(x, ct_ex_mul(x, r[0], w), ct_ex3_dot(x, rv, v));
    for (int i = 0; i < 3; i++)
        out[1 + i] = ct_ex_add(
            x, ct_ex_add(x, ct_ex_mul(x, r[0], v.e[i]), ct_ex_mul(x, w, rv.e[i])), c.e[i]);
    for (int i = 0; i < 4; i++)
        b->eqs->memory[first + (size_t)i].update = out[i];
}

static void measure_quaternion(struct ct_build *b, const struct ct_coordinate *c)
{
    const struct ct_ends p = ct_edge_ends(b, c->edge);
    const ct_ex33 A = ct_node_rotation(b, p.tail), B = ct_node_rotation(b, p.head);
    const ct_ex33 T = ct_ex33_transpose(&A), R = ct_ex33_mul(b->x, &T, &B);
    const int first = b->topology->edge[c->edge].first_coordinate
                    + b->kinematics->edge[c->edge].motion->quaternion;
    ct_ex q[4];
    ct_quaternion_follow(b, c->name, &R, q);
    for (int i = 0; i < 4; i++) {
        b->cache.measured[first + i] = (struct ct_measured){true, q[i]};
    }
}

bool ct_coordinate_is_known(const struct ct_coordinate *c)
{
    return c->q >= 0 || c->driver >= 0;
}

ct_ex ct_coordinate_value(struct ct_build *b, int coordinate)
{
    const struct ct_coordinate *c = &b->kinematics->coordinate[coordinate];
    struct ct_measured *measured = &b->cache.measured[coordinate];
    if (ct_coordinate_is_known(c))
        return c->value;
    if (!measured->made && (c->in_translation || c->in_rotation)) {
        const struct ct_measure *m = measure_of(b, c);
        const struct ct_ends p = ct_edge_ends(b, c->edge);
        measured->made = true;
        switch (m->kind) {
        case CT_MEASURE_LENGTH:
            measured->value = ct_ex3_dot(b->x, ct_node_turn(b, p.tail, m->along),
                                         ct_path_position(b, p.tail, p.head));
            break;
        case CT_MEASURE_ANGLE:
            measured->value = measure_angle(b, c, m);
            break;
        case CT_MEASURE_QUATERNION:
            measure_quaternion(b, c);
            break;
        }
    }
    return measured->value;
}

bool ct_coordinate_wrench(struct ct_build *b, int coordinate, struct ct_wrench *w)
{
    const struct ct_coordinate *c = &b->kinematics->coordinate[coordinate];
    const struct ct_measure *m = measure_of(b, c);
    const struct ct_ends p = ct_edge_ends(b, c->edge);
    *w = (struct ct_wrench){zero3, zero3};
    if (!c->in_translation && !c->in_rotation)
        return false;
    switch (m->kind) {
    case CT_MEASURE_LENGTH:
        w->force = ct_node_turn(b, p.tail, m->along);
        break;
    case CT_MEASURE_ANGLE:
        w->torque = ct_ex3_add(b->x, ct_node_turn(b, p.tail, m->from),
                               ct_node_turn(b, p.head, m->to));
        break;
    case CT_MEASURE_QUATERNION: {
        ct_ex3 axis = zero3;
        const int i = c->index - b->kinematics->edge[c->edge].motion->quaternion;
        if (i >= 3) // four parameters, three speeds
            return false;
        axis.e[i] = CT_EX_ONE;
        w->torque = ct_node_turn(b, p.head, axis);
        break;
    }
    }
    return true;
}

ct_ex ct_load_power(struct ct_build *b, int tail, int head, ct_ex3 force, ct_ex3 torque)
{
    struct ct_exs *x = b->x;
    const int from = b->kinematics->placement[tail].frame,
              to = b->kinematics->placement[head].frame;
    ct_ex3 v = ct_path_velocity(b, tail, head);
    if (from)
        v = ct_ex3_sub(x, v,
                       ct_cluster_cross_velocity(b, from, ct_path_position(b, tail, head)));
    return ct_ex_add(x, ct_ex3_dot(x, force, v),
                     ct_ex3_dot(x, torque, ct_cluster_path_velocity(b, from, to)));
}

ct_ex ct_coordinate_speed(struct ct_build *b, int coordinate)
{
    const struct ct_coordinate *c = &b->kinematics->coordinate[coordinate];
    const struct ct_ends p = ct_edge_ends(b, c->edge);
    struct ct_wrench w;
    if (c->u >= 0)
        return b->eqs->u[c->u].symbol;
    if (c->driver >= 0)
        return b->eqs->driver[c->driver].rate;
    if (!ct_coordinate_wrench(b, coordinate, &w))
        return CT_EX_ZERO;
    return ct_load_power(b, p.tail, p.head, w.force, w.torque);
}

ct_ex ct_along_acceleration(struct ct_build *b, struct ct_ends n, ct_ex3 p, enum ct_level level)
{
    struct ct_exs *x = b->x;
    const int a = b->kinematics->placement[n.tail].frame;
    ct_ex3 sum = ct_path_acceleration(b, n.tail, n.head, level);
    if (a) {
        const ct_ex3 d = ct_path_position(b, n.tail, n.head);
        const ct_ex3 seen = ct_ex3_sub(x, ct_path_velocity(b, n.tail, n.head),
                                       ct_cluster_cross_velocity(b, a, d));
        sum = ct_ex3_sub(x, sum, ct_ex3_cross(x, ct_cluster_acceleration(b, a, level), d));
        sum = ct_ex3_sub(x, sum, ct_cluster_centripetal(b, a, d));
        sum = ct_ex3_sub(
            x, sum, ct_ex3_scale(x, ct_ex_const(x, 2), ct_cluster_cross_velocity(b, a, seen)));
    }
    return ct_ex3_dot(x, p, sum);
}

ct_ex ct_coordinate_acceleration(struct ct_build *b, int coordinate, enum ct_level level)
{
    struct ct_exs *x = b->x;
    const struct ct_coordinate *c = &b->kinematics->coordinate[coordinate];
    const struct ct_measure *m = measure_of(b, c);
    const struct ct_ends p = ct_edge_ends(b, c->edge);
    struct ct_wrench w;
    if (c->u >= 0)
        return level == CT_FULL ? b->eqs->u[c->u].derivative : CT_EX_ZERO;
    if (c->driver >= 0)
        return b->eqs->driver[c->driver].acceleration;
    if (!ct_coordinate_wrench(b, coordinate, &w))
        return CT_EX_ZERO;
    if (m->kind == CT_MEASURE_LENGTH)
        return ct_along_acceleration(b, p, w.force, level);
    // h . al_rel + h' . w_rel, h = sum of a part fixed in the tail and a part fixed in the head
    const int from = b->kinematics->placement[p.tail].frame,
              to = b->kinematics->placement[p.head].frame;
    ct_ex3 relative_rate = ct_cluster_cross_velocity(b, to, w.torque);
    if (m->kind == CT_MEASURE_ANGLE)
        relative_rate = ct_ex3_add(
            x, ct_cluster_cross_velocity(b, from, ct_node_turn(b, p.tail, m->from)),
            ct_cluster_cross_velocity(b, to, ct_node_turn(b, p.head, m->to)));
    return ct_ex_add(x,
                     ct_ex3_dot(x, w.torque, ct_cluster_path_acceleration(b, from, to, level)),
                     ct_ex3_dot(x, relative_rate, ct_cluster_path_velocity(b, from, to)));
}

int ct_coordinate_find(const struct ct_build *b, const char *name)
{
    const char *const plain = ct_arena_printf(b->arena, "%s.q", name);
    for (size_t i = 0; i < b->topology->ncoordinate; i++) {
        if (!strcmp(b->kinematics->coordinate[i].name, name)
            || !strcmp(b->kinematics->coordinate[i].name, plain))
            return (int)i;
    }
    return -1;
}
