// Measured coordinates and constraint rows of chords.  (formulation 1.3, 4.2)
#include "formulate/row.h"
#include "formulate/dynamics.h"
#include "formulate/gap.h"

#include <string.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- measuring --------------------------------------------------------------------------------------

struct pair {
    int tail, head; // nodes
};

static struct pair ends(const struct ct_build *b, int edge)
{
    return (struct pair){b->wiring[edge].tail, b->wiring[edge].head};
}

static const struct ct_measure *measure_of(const struct ct_build *b,
                                           const struct ct_coordinate *c)
{
    const struct ct_motion *m = &b->edge[c->edge].motion;
    const int k = m->quaternion >= 0 && c->place >= m->quaternion ? m->quaternion : c->place;
    return &m->measure[k];
}

static ct_ex new_memory(struct ct_build *b, enum ct_memory_kind kind, const char *name,
                        int joint, int place)
{
    struct ct_equations *s = b->eqs;
    struct ct_memory m = {.kind = kind, .joint = joint, .place = place};
    m.symbol
        = ct_ex_sym(b->x, CT_SYM_MEMORY,
                    kind == CT_MEMORY_TURNS ? name : ct_arena_printf(b->arena, "%s.last", name),
                    (uint32_t)s->nmemory);
    CT_PUSH(b->arena, s->memory, s->nmemory, s->memory_cap, m);
    return m.symbol;
}

// Angle about a from V to W, followed from its last value r: r + the angle that is left, which stays
// small, so that no branch cut is met within a step.
static ct_ex angle_from(struct ct_build *b, const char *name, int joint, int place, ct_ex sine,
                        ct_ex cosine)
{
    struct ct_exs *x = b->x;
    const size_t i = b->eqs->nmemory;
    const ct_ex r = new_memory(b, CT_MEMORY_ANGLE, name, joint, place);
    const ct_ex sr = ct_ex_fun(x, CT_OP_SIN, r), cr = ct_ex_fun(x, CT_OP_COS, r);
    const ct_ex s = ct_ex_sub(x, ct_ex_mul(x, sine, cr), ct_ex_mul(x, cosine, sr));
    const ct_ex c = ct_ex_add(x, ct_ex_mul(x, cosine, cr), ct_ex_mul(x, sine, sr));
    const ct_ex angle = ct_ex_add(x, r, ct_ex_fun2(x, CT_OP_ATAN2, s, c));
    b->eqs->memory[i].update = angle;
    return angle;
}

// Angle about the normal of the plane, of a vector of the plane given in the node's axes, from the axes of its frame.
static ct_ex angle_in_frame(struct ct_build *b, int node, ct_ex3 v)
{
    struct ct_exs *x = b->x;
    const ct_ex3 e1 = b->plane[0], s = ct_ex33_apply(x, &b->place[node].S, v);
    const ct_ex sine = ct_ex3_dot(x, b->plane[2], ct_ex3_cross(x, e1, s));
    return ct_ex_fun2(x, CT_OP_ATAN2, sine, ct_ex3_dot(x, e1, s));
}

// Does a direction point along the normal of the plane, or against it?
static bool is_upward(const struct ct_build *b, const ct_ex3 *direction)
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += ct_ex_value(b->x, direction->e[i], b->value)
             * ct_ex_value(b->x, b->plane[2].e[i], b->value);
    return sum > 0;
}

// The same from ground.
static ct_ex planar_angle(struct ct_build *b, int node, ct_ex3 v)
{
    struct ct_exs *x = b->x;
    const struct ct_cluster *c = &b->cluster[b->place[node].frame];
    const ct_ex own = angle_in_frame(b, node, v);
    if (!c->has_angle)
        return own;
    return is_upward(b, &c->axis) ? ct_ex_add(x, own, c->angle) : ct_ex_sub(x, own, c->angle);
}

// In a plane angles add: the angle about a from V to W is the difference of two sums, and whole turns that stay. False where
// V or W turns in its frame.
static bool add_angles(struct ct_build *b, const struct ct_measure *m, struct pair p, ct_ex3 a,
                       ct_ex *sum)
{
    struct ct_exs *x = b->x;
    const unsigned known = 1u << CT_SYM_PARAM;
    if (!b->is_planar
        || (ct_ex_kinds(x, angle_in_frame(b, p.tail, m->v))
            | ct_ex_kinds(x, angle_in_frame(b, p.head, m->w)))
               & ~known)
        return false;
    const ct_ex V = planar_angle(b, p.tail, m->v), W = planar_angle(b, p.head, m->w);
    *sum = is_upward(b, &a) ? ct_ex_sub(x, W, V) : ct_ex_sub(x, V, W);
    return true;
}

static ct_ex measure_angle(struct ct_build *b, const struct ct_coordinate *c,
                           const struct ct_measure *m)
{
    struct ct_exs *x = b->x;
    const struct pair p = ends(b, c->edge);
    const ct_ex3 a = ct_node_turn(b, m->reversed ? p.head : p.tail, m->about);
    const ct_ex3 V = ct_node_turn(b, p.tail, m->v), W = ct_node_turn(b, p.head, m->w);
    // the parts of V and W along a do not turn; the one whose frame holds a is known there
    const ct_ex along = ct_ex3_dot(x, m->about, m->reversed ? m->w : m->v);
    const ct_ex cosine = ct_ex_sub(x, ct_ex3_dot(x, V, W), ct_ex_mul(x, along, along));
    const ct_ex sine = ct_ex3_dot(x, a, ct_ex3_cross(x, V, W));
    const struct ct_edge_info *e = &b->edge[c->edge];
    const int joint = e->kind == CT_EDGE_JOINT ? e->index : -1;
    const size_t r = b->eqs->nmemory;
    const ct_ex followed = angle_from(b, c->name, joint, c->place, sine, cosine);
    ct_ex sum;
    if (!add_angles(b, m, p, a, &sum))
        return followed;
    const ct_ex turns = new_memory(
        b, CT_MEMORY_TURNS, ct_arena_printf(b->arena, "%s.turns", c->name), joint, c->place);
    const ct_ex angle = ct_ex_add(b->x, sum, turns);
    b->eqs->memory[r + 1].update = ct_ex_sub(b->x, followed, sum);
    b->eqs->memory[r].update = angle;
    return angle;
}

void ct_quaternion_follow(struct ct_build *b, const char *name, const ct_ex33 *R, ct_ex out[4])
{
    struct ct_exs *x = b->x;
    const size_t first = b->eqs->nmemory;
    ct_ex r[4];
    for (int i = 0; i < 4; i++)
        r[i] = new_memory(b, CT_MEMORY_QUATERNION, name, -1, i);
    b->eqs->memory[first].R = *R;
    // D = S(r)' R is a small rotation; its quaternion w = sqrt(1 + trace)/2, v = axial part/(4 w)
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
    const struct pair p = ends(b, c->edge);
    const ct_ex33 A = ct_node_rotation(b, p.tail), B = ct_node_rotation(b, p.head);
    const ct_ex33 T = ct_ex33_transpose(&A), R = ct_ex33_mul(b->x, &T, &B);
    const int first = b->edge[c->edge].first_coordinate + b->edge[c->edge].motion.quaternion;
    ct_ex q[4];
    ct_quaternion_follow(b, c->name, &R, q);
    for (int i = 0; i < 4; i++) {
        b->coordinate[first + i].measured = q[i];
        b->coordinate[first + i].has_measured = true;
    }
}

static bool is_known(const struct ct_coordinate *c)
{
    return c->q >= 0 || c->driver >= 0;
}

ct_ex ct_coordinate_value(struct ct_build *b, int coordinate)
{
    struct ct_coordinate *c = &b->coordinate[coordinate];
    if (is_known(c))
        return c->value;
    if (!c->has_measured && (c->in_translation || c->in_rotation)) {
        const struct ct_measure *m = measure_of(b, c);
        const struct pair p = ends(b, c->edge);
        c->has_measured = true;
        switch (m->kind) {
        case CT_MEASURE_LENGTH:
            c->measured = ct_ex3_dot(b->x, ct_node_turn(b, p.tail, m->along),
                                     ct_path_position(b, p.tail, p.head));
            break;
        case CT_MEASURE_ANGLE:
            c->measured = measure_angle(b, c, m);
            break;
        case CT_MEASURE_QUATERNION:
            measure_quaternion(b, c);
            break;
        }
    }
    return c->measured;
}

bool ct_coordinate_wrench(struct ct_build *b, int coordinate, struct ct_wrench *w)
{
    const struct ct_coordinate *c = &b->coordinate[coordinate];
    const struct ct_measure *m = measure_of(b, c);
    const struct pair p = ends(b, c->edge);
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
        const int i = c->place - b->edge[c->edge].motion.quaternion;
        if (i >= 3) // four numbers, three speeds
            return false;
        axis.e[i] = CT_EX_ONE;
        w->torque = ct_node_turn(b, p.head, axis);
        break;
    }
    }
    return true;
}

ct_ex ct_coordinate_speed(struct ct_build *b, int coordinate)
{
    const struct ct_coordinate *c = &b->coordinate[coordinate];
    const struct pair p = ends(b, c->edge);
    struct ct_wrench w;
    if (c->u >= 0)
        return b->eqs->u[c->u].symbol;
    if (c->driver >= 0)
        return b->eqs->driver[c->driver].rate;
    if (!ct_coordinate_wrench(b, coordinate, &w))
        return CT_EX_ZERO;
    return ct_load_power(b, p.tail, p.head, w.force, w.torque);
}

// d/dt of p . (d' - w_a x d) with p fixed in the tail's axes.  (4.3)
static ct_ex along_acceleration(struct ct_build *b, struct pair n, ct_ex3 p,
                                enum ct_level level)
{
    struct ct_exs *x = b->x;
    const int a = b->place[n.tail].frame;
    ct_ex3 sum = ct_path_acceleration(b, n.tail, n.head, level);
    if (a) {
        const ct_ex3 d = ct_path_position(b, n.tail, n.head);
        const ct_ex3 seen
            = ct_ex3_sub(x, ct_path_velocity(b, n.tail, n.head), ct_cluster_swing(b, a, d));
        sum = ct_ex3_sub(x, sum, ct_ex3_cross(x, ct_cluster_acceleration(b, a, level), d));
        sum = ct_ex3_sub(x, sum, ct_cluster_centripetal(b, a, d));
        sum = ct_ex3_sub(x, sum,
                         ct_ex3_scale(x, ct_ex_const(x, 2), ct_cluster_swing(b, a, seen)));
    }
    return ct_ex3_dot(x, p, sum);
}

ct_ex ct_coordinate_acceleration(struct ct_build *b, int coordinate, enum ct_level level)
{
    struct ct_exs *x = b->x;
    const struct ct_coordinate *c = &b->coordinate[coordinate];
    const struct ct_measure *m = measure_of(b, c);
    const struct pair p = ends(b, c->edge);
    struct ct_wrench w;
    if (c->u >= 0)
        return level == CT_FULL ? b->eqs->u[c->u].derivative : CT_EX_ZERO;
    if (c->driver >= 0)
        return b->eqs->driver[c->driver].acceleration;
    if (!ct_coordinate_wrench(b, coordinate, &w))
        return CT_EX_ZERO;
    if (m->kind == CT_MEASURE_LENGTH)
        return along_acceleration(b, p, w.force, level);
    // h . al_rel + h' . w_rel, h = parts fixed in the tail's and in the head's axes
    const int from = b->place[p.tail].frame, to = b->place[p.head].frame;
    ct_ex3 turning = ct_cluster_swing(b, to, w.torque);
    if (m->kind == CT_MEASURE_ANGLE)
        turning = ct_ex3_add(x, ct_cluster_swing(b, from, ct_node_turn(b, p.tail, m->from)),
                             ct_cluster_swing(b, to, ct_node_turn(b, p.head, m->to)));
    return ct_ex_add(x,
                     ct_ex3_dot(x, w.torque, ct_cluster_path_acceleration(b, from, to, level)),
                     ct_ex3_dot(x, turning, ct_cluster_path_velocity(b, from, to)));
}

int ct_coordinate_find(const struct ct_build *b, const char *name)
{
    const char *const plain = ct_arena_printf(b->arena, "%s.q", name);
    for (size_t i = 0; i < b->ncoordinate; i++) {
        if (!strcmp(b->coordinate[i].name, name) || !strcmp(b->coordinate[i].name, plain))
            return (int)i;
    }
    return -1;
}

// ---- linear parts -------------------------------------------------------------------------------------

static void add_term(struct ct_build *b, struct ct_linear *l, int speed, int driver, ct_ex v)
{
    struct ct_exs *x = b->x;
    if (speed >= 0)
        l->coef[speed] = ct_ex_add(x, l->coef[speed], v);
    else
        l->driven = ct_ex_add(x, l->driven, ct_ex_mul(x, v, b->eqs->driver[driver].rate));
}

// One at a time.
static struct ct_linear linear_zero(struct ct_build *b)
{
    if (!b->coefficient)
        b->coefficient = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1);
    memset(b->coefficient, 0, (b->eqs->nu + 1) * sizeof *b->coefficient);
    return (struct ct_linear){b->coefficient, CT_EX_ZERO};
}

// p . (dv_head - dv_tail [- dw_tail x d]) + h . (dw_head - dw_tail) in terms of the speeds.  (4.2)-(4.4)
static void wrench_terms(struct ct_build *b, struct pair n, const struct ct_wrench *w,
                         bool carried, struct ct_linear *l)
{
    struct ct_exs *x = b->x;
    const int from = b->place[n.tail].frame, to = b->place[n.head].frame;
    if (!b->marked)
        b->marked = CT_NEWN(b->arena, bool, b->ncluster + 1);
    ct_path_mark(b, n.tail, n.head, b->marked);
    for (size_t r = 0; r < b->nspin; r++) {
        const struct ct_spin *s = &b->spin[r];
        ct_ex3 sweep;
        ct_ex v = CT_EX_ZERO;
        if (!b->marked[s->cluster])
            continue;
        if (!ct_ex3_is_zero(w->force) && ct_path_sweep(b, n.tail, n.head, r, carried, &sweep))
            v = ct_ex3_dot(x, w->force, sweep);
        const int turns = (int)ct_cluster_is_outboard(b, s->cluster, to)
                        - (int)ct_cluster_is_outboard(b, s->cluster, from);
        if (turns && !ct_ex3_is_zero(w->torque)) {
            const ct_ex h = ct_ex3_dot(x, w->torque, s->axis);
            v = turns > 0 ? ct_ex_add(x, v, h) : ct_ex_sub(x, v, h);
        }
        for (int k = 0; k < s->nterm && !ct_ex_is_zero(v); k++)
            add_term(b, l, s->term[k].speed, s->term[k].driver,
                     ct_ex_mul(x, s->term[k].coef, v));
    }
    for (size_t a = 1; a < b->nanchor && !ct_ex3_is_zero(w->force); a++) {
        const int side = b->anchor[a].nslide ? ct_path_slide(b, n.tail, n.head, (int)a) : 0;
        for (int k = 0; side && k < b->anchor[a].nslide; k++) {
            const struct ct_slide *s = &b->anchor[a].slide[k];
            const ct_ex v
                = ct_ex3_dot(x, w->force, ct_cluster_turn(b, b->anchor[a].cluster, s->p));
            add_term(b, l, s->speed, s->driver, side > 0 ? v : ct_ex_neg(x, v));
        }
    }
}

static void coordinate_terms(struct ct_build *b, int coordinate, ct_ex factor,
                             struct ct_linear *l)
{
    const struct ct_coordinate *c = &b->coordinate[coordinate];
    struct ct_wrench w;
    if (is_known(c)) {
        add_term(b, l, c->u, c->driver, factor);
    } else if (ct_coordinate_wrench(b, coordinate, &w)) {
        w.force = ct_ex3_scale(b->x, factor, w.force);
        w.torque = ct_ex3_scale(b->x, factor, w.torque);
        wrench_terms(b, ends(b, c->edge), &w, true, l);
    }
}

// ---- rows ---------------------------------------------------------------------------------------------

static int push_row(struct ct_build *b, const char *name, int joint, const struct ct_linear *l,
                    ct_ex phi, ct_ex gam)
{
    struct ct_equations *s = b->eqs;
    struct ct_row row = {.name = name, .joint = joint, .phi = phi, .gam = gam, .v = l->driven};
    const int index = (int)s->nrow;
    for (size_t k = 0; k < s->nu; k++) {
        const struct ct_entry e = {index, (int)k, l->coef[k]};
        if (ct_ex_is_zero(e.value))
            continue;
        CT_PUSH(b->arena, s->J, s->nJ, s->J_cap, e);
        row.v = ct_ex_add(b->x, row.v, ct_ex_mul(b->x, e.value, s->u[k].symbol));
    }
    row.lam = ct_ex_sym(b->x, CT_SYM_LAM, ct_arena_printf(b->arena, "lambda(%s)", name),
                        (uint32_t)index);
    CT_PUSH(b->arena, s->row, s->nrow, s->row_cap, row);
    return index;
}

static void add_row(struct ct_build *b, int joint, const char *name, struct pair n,
                    const struct ct_wrench *w, bool carried, ct_ex phi, ct_ex gam)
{
    struct ct_linear l = linear_zero(b);
    wrench_terms(b, n, w, carried, &l);
    const int index = push_row(b, name, joint, &l, phi, gam);
    const struct ct_pull p = {index, n.tail, n.head, joint, w->force, w->torque, carried};
    CT_PUSH(b->arena, b->pull, b->npull, b->pull_cap, p);
}

static int joint_index(const struct ct_build *b, const struct ct_instance *self)
{
    return (int)(self - b->model->joint);
}

void ct_row_add(struct ct_build *b, const struct ct_instance *self, const char *what, int tail,
                int head, const struct ct_wrench *w, bool carried, ct_ex phi, ct_ex gam)
{
    const char *name = ct_arena_printf(b->arena, "%s.%s", self->name, what);
    add_row(b, joint_index(b, self), name, (struct pair){tail, head}, w, carried, phi, gam);
}

ct_ex ct_row_keep(struct ct_build *b, const char *name, int joint, ct_ex at_start)
{
    const size_t i = b->eqs->nmemory;
    const ct_ex s = new_memory(b, CT_MEMORY_OFFSET, name, joint, 0);
    b->eqs->memory[i].update = at_start;
    return s;
}

ct_ex ct_row_offset(struct ct_build *b, const struct ct_instance *self, ct_ex at_start)
{
    return ct_row_keep(b, self->name, joint_index(b, self), at_start);
}

void ct_row_couple(struct ct_build *b, const struct ct_instance *self, int coordinate_a,
                   int coordinate_b, ct_ex ratio)
{
    struct ct_exs *x = b->x;
    struct ct_linear l = linear_zero(b);
    coordinate_terms(b, coordinate_a, CT_EX_ONE, &l);
    coordinate_terms(b, coordinate_b, ct_ex_neg(x, ratio), &l);
    const ct_ex value = ct_ex_sub(x, ct_coordinate_value(b, coordinate_a),
                                  ct_ex_mul(x, ratio, ct_coordinate_value(b, coordinate_b)));
    const ct_ex gam
        = ct_ex_sub(x, ct_coordinate_acceleration(b, coordinate_a, CT_BIAS),
                    ct_ex_mul(x, ratio, ct_coordinate_acceleration(b, coordinate_b, CT_BIAS)));
    const ct_ex phi = ct_ex_sub(x, value, ct_row_offset(b, self, value));
    const int row = push_row(b, self->name, joint_index(b, self), &l, phi, gam);
    const int coupled[2] = {coordinate_a, coordinate_b};
    for (int i = 0; i < 2; i++) {
        // a multiplier on a measured coordinate is a wrench pair; on a branch it is a force on its row
        struct ct_wrench w;
        const struct ct_coordinate *c = &b->coordinate[coupled[i]];
        const struct pair n = ends(b, c->edge);
        if (is_known(c) || !ct_coordinate_wrench(b, coupled[i], &w))
            continue;
        const ct_ex f = i ? ct_ex_neg(x, ratio) : CT_EX_ONE;
        const struct ct_pull p = {row,
                                  n.tail,
                                  n.head,
                                  b->edge[c->edge].index,
                                  ct_ex3_scale(x, f, w.force),
                                  ct_ex3_scale(x, f, w.torque),
                                  true};
        CT_PUSH(b->arena, b->pull, b->npull, b->pull_cap, p);
    }
}

// ---- translational rows of a joint ----------------------------------------------------------------------

// Origins coincide: one row along each ground direction, in the plane two.  (4.2)
static void place_rows(struct ct_build *b, const struct ct_edge_info *e, struct pair n)
{
    struct ct_exs *x = b->x;
    static const char *const letter[] = {"x", "y", "z"};
    const ct_ex3 d = ct_path_position(b, n.tail, n.head);
    const ct_ex3 a = ct_path_acceleration(b, n.tail, n.head, CT_BIAS);
    for (int i = 0; i < (b->is_planar ? 2 : 3); i++) {
        const struct ct_wrench w = {b->plane[i], zero3};
        add_row(b, e->index, ct_arena_printf(b->arena, "%s.%s", e->name, letter[i]), n, &w,
                false, ct_gap_number(b, e, ct_ex3_dot(x, b->plane[i], d)),
                ct_ex3_dot(x, b->plane[i], a));
    }
}

static void across_row(struct ct_build *b, const struct ct_edge_info *e, const char *name,
                       struct pair n, ct_ex3 p)
{
    const struct ct_wrench w = {p, zero3};
    add_row(b, e->index, name, n, &w, true,
            ct_gap_number(b, e, ct_ex3_dot(b->x, p, ct_path_position(b, n.tail, n.head))),
            along_acceleration(b, n, p, CT_BIAS));
}

// Directions of sliding in axes of `from`; returns their number.
static int slide_directions(struct ct_build *b, const struct ct_edge_info *e, ct_ex3 dir[3])
{
    int n = 0;
    for (int k = 0; k < e->ncoordinate && n < 3; k++) {
        ct_ex3 p;
        for (int i = 0; i < 3; i++)
            p.e[i] = ct_edge_partial(b, e, e->trial.d.e[i], k);
        if (!ct_ex3_is_zero(p))
            dir[n++] = p;
    }
    return n;
}

static void translation_rows(struct ct_build *b, int edge)
{
    const struct ct_edge_info *e = &b->edge[edge];
    const struct pair n = ends(b, edge);
    ct_ex3 dir[3];
    const int nslide = slide_directions(b, e, dir);
    if (nslide == 0) {
        place_rows(b, e, n);
    } else if (b->is_planar) {
        if (nslide == 1) {
            const ct_ex3 p = ct_ex3_cross(b->x, b->plane[2], ct_node_turn(b, n.tail, dir[0]));
            across_row(b, e, ct_arena_printf(b->arena, "%s.across", e->name), n, p);
        }
    } else {
        for (int i = 0; i < e->motion.ntrans; i++)
            across_row(b, e, ct_arena_printf(b->arena, "%s.across%d", e->name, i + 1), n,
                       ct_node_turn(b, n.tail, e->motion.trans[i]));
    }
}

// ---- rotational rows of a joint ---------------------------------------------------------------------------

static void planar_angle_row(struct ct_build *b, int edge)
{
    struct ct_exs *x = b->x;
    const struct ct_edge_info *e = &b->edge[edge];
    const struct pair n = ends(b, edge);
    const struct ct_wrench w = {zero3, b->plane[2]};
    const ct_ex3 v = ct_ex33_apply_t(x, &b->upright[n.tail], b->plane[0]);
    // the gap of an angle is not wrapped: it says which way round
    const ct_ex diff = ct_gap_number(
        b, e, ct_ex_sub(x, planar_angle(b, n.head, v), planar_angle(b, n.tail, v)));
    // wrapped, as one whole turn is as good as none
    const ct_ex phi = ct_ex_fun2(x, CT_OP_ATAN2, ct_ex_fun(x, CT_OP_SIN, diff),
                                 ct_ex_fun(x, CT_OP_COS, diff));
    const ct_ex3 al = ct_cluster_path_acceleration(b, b->place[n.tail].frame,
                                                   b->place[n.head].frame, CT_BIAS);
    add_row(b, e->index, ct_arena_printf(b->arena, "%s.angle", e->name), n, &w, true, phi,
            ct_ex3_dot(x, b->plane[2], al));
}

// Pair (s|t): s fixed in the tail's axes, t in the head's; s_local: s there.  (4.4)
static void pair_row(struct ct_build *b, int edge, int i, ct_ex3 s_local)
{
    struct ct_exs *x = b->x;
    const struct ct_edge_info *e = &b->edge[edge];
    const struct pair n = ends(b, edge);
    const int from = b->place[n.tail].frame, to = b->place[n.head].frame;
    const ct_ex3 s = ct_node_turn(b, n.tail, s_local);
    const ct_ex3 t = ct_node_turn(b, n.head, e->motion.rot_to[i]);
    const struct ct_wrench w = {zero3, ct_ex3_cross(x, t, s)};
    const ct_ex wanted = ct_ex3_dot(x, e->motion.rot_from[i], e->motion.rot_to[i]);
    const ct_ex phi = ct_ex_sub(x, ct_ex3_dot(x, s, t), wanted);
    const ct_ex3 turning = ct_ex3_add(x, ct_ex3_cross(x, ct_cluster_swing(b, to, t), s),
                                      ct_ex3_cross(x, t, ct_cluster_swing(b, from, s)));
    const ct_ex gam = ct_ex_add(
        x, ct_ex3_dot(x, w.torque, ct_cluster_path_acceleration(b, from, to, CT_BIAS)),
        ct_ex3_dot(x, turning, ct_cluster_path_velocity(b, from, to)));
    add_row(b, e->index, ct_arena_printf(b->arena, "%s.turn%d", e->name, i + 1), n, &w, true,
            phi, gam);
    // the rows also hold half a turn away: the cosine between like axes tells
    const ct_ex3 axis = ct_node_turn(b, n.tail, e->motion.rot_to[i]);
    if (e->motion.nrot > 1)
        b->eqs->row[b->eqs->nrow - 1].wanted = ct_ex3_dot(x, axis, t);
}

static void rotation_rows(struct ct_build *b, int edge)
{
    const struct ct_edge_info *e = &b->edge[edge];
    if (!b->is_planar) {
        ct_ex3 s[COUNT(e->motion.rot_from)];
        for (int i = 0; i < e->motion.nrot; i++)
            s[i] = e->motion.rot_from[i];
        ct_gap_turn(b, e, b->wiring[edge].tail, b->wiring[edge].head, s, e->motion.nrot);
        for (int i = 0; i < e->motion.nrot; i++)
            pair_row(b, edge, i, s[i]);
        return;
    }
    for (int k = 0; k < e->ncoordinate; k++)
        if (b->coordinate[e->first_coordinate + k].in_rotation)
            return;
    planar_angle_row(b, edge);
}

// ---- drivers of chords ------------------------------------------------------------------------------------

static void driven_row(struct ct_build *b, int coordinate)
{
    struct ct_exs *x = b->x;
    const struct ct_coordinate *c = &b->coordinate[coordinate];
    const struct ct_edge_info *e = &b->edge[c->edge];
    const struct ct_value *motion = ct_instance_value(e->self, "motion");
    struct ct_wrench w;
    if (!ct_coordinate_wrench(b, coordinate, &w))
        return;
    const ct_ex s = ct_mode_hold(b, motion->e[c->place]);
    const ct_ex rate = ct_build_rate(b, s);
    const ct_ex phi = ct_ex_sub(x, ct_coordinate_value(b, coordinate), s);
    const ct_ex gam = ct_ex_sub(x, ct_coordinate_acceleration(b, coordinate, CT_BIAS),
                                ct_build_rate(b, rate));
    add_row(b, e->index, ct_arena_printf(b->arena, "%s.motion", c->name), ends(b, c->edge), &w,
            true, phi, gam);
    struct ct_row *row = &b->eqs->row[b->eqs->nrow - 1];
    row->v = ct_ex_sub(x, row->v, rate);
    b->eqs->power = ct_ex_add(x, b->eqs->power, ct_ex_mul(x, row->lam, rate));
    b->coordinate[coordinate].motion_row = (int)b->eqs->nrow; // one too large: 0 is none
}

bool ct_rows_derive(struct ct_build *b)
{
    for (size_t i = 0; i < b->nedge; i++) {
        const struct ct_edge_info *e = &b->edge[i];
        const bool moves
            = e->kind == CT_EDGE_CLOSURE || (e->kind == CT_EDGE_JOINT && e->self->cls->motion);
        if (!moves)
            continue;
        if (!b->T.is_branch[i] && !(e->trial.quaternion == 3))
            translation_rows(b, (int)i);
        if (!b->R.is_branch[i] && e->has_rotation && e->trial.quaternion < 0)
            rotation_rows(b, (int)i);
        for (int k = 0; k < e->ncoordinate; k++) {
            const struct ct_coordinate *c = &b->coordinate[e->first_coordinate + k];
            if (c->is_driven && c->driver < 0)
                driven_row(b, e->first_coordinate + k);
        }
    }
    for (size_t j = 0; j < b->model->njoint; j++)
        if (b->model->joint[j].cls->apply)
            b->model->joint[j].cls->apply(b, &b->model->joint[j]);
    return true;
}
