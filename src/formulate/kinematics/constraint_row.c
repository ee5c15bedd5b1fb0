// Constraint rows of chords.  (formulation 4.2)
#include "formulate/kinematics/constraint_row.h"
#include "formulate/kinematics/constraint_offset.h"
#include "formulate/topology/linear_graph.h"
#include "graph/disjoint_sets.h"

#include <string.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- linear parts -------------------------------------------------------------------------------

static void add_term(struct ct_build *b, struct ct_linear *l, int speed, int driver, ct_ex v)
{
    struct ct_exs *x = b->x;
    if (speed >= 0)
        l->coef[speed] = ct_ex_add(x, l->coef[speed], v);
    else
        l->driven = ct_ex_add(x, l->driven, ct_ex_mul(x, v, b->eqs->driver[driver].rate));
}

// Zero coefficients; the buffer is shared, so that only one row exists at a time.
static struct ct_linear linear_zero(struct ct_build *b)
{
    if (!b->cache.coefficient)
        b->cache.coefficient = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1);
    memset(b->cache.coefficient, 0, (b->eqs->nu + 1) * sizeof *b->cache.coefficient);
    return (struct ct_linear){b->cache.coefficient, CT_EX_ZERO};
}

// p . (dv_head - dv_tail [- dw_tail x d]) + h . (dw_head - dw_tail) in terms of the speeds.
// (4.2)-(4.4)
static void wrench_terms(struct ct_build *b, struct ct_ends n, const struct ct_wrench *w,
                         bool carried, struct ct_linear *l)
{
    struct ct_exs *x = b->x;
    const int from = b->kinematics->placement[n.tail].frame,
              to = b->kinematics->placement[n.head].frame;
    if (!b->cache.marked)
        b->cache.marked = CT_NEWN(b->arena, bool, b->kinematics->ncluster + 1);
    ct_path_mark(b, n.tail, n.head, b->cache.marked);
    for (size_t r = 0; r < b->kinematics->nrotation_axis; r++) {
        const struct ct_rotation_axis *s = &b->kinematics->rotation_axis[r];
        ct_ex3 velocity;
        ct_ex v = CT_EX_ZERO;
        if (!b->cache.marked[s->cluster])
            continue;
        if (!ct_ex3_is_zero(w->force)
            && ct_path_partial_velocity(b, n.tail, n.head, r, carried, &velocity))
            v = ct_ex3_dot(x, w->force, velocity);
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
    for (size_t a = 1; a < b->kinematics->nanchor && !ct_ex3_is_zero(w->force); a++) {
        const int side = b->kinematics->anchor[a].ntranslation_axis
                           ? ct_path_translation_side(b, n.tail, n.head, (int)a)
                           : 0;
        for (int k = 0; side && k < b->kinematics->anchor[a].ntranslation_axis; k++) {
            const struct ct_translation_axis *s = &b->kinematics->anchor[a].translation_axis[k];
            const ct_ex v = ct_ex3_dot(
                x, w->force, ct_cluster_turn(b, b->kinematics->anchor[a].cluster, s->p));
            add_term(b, l, s->speed, s->driver, side > 0 ? v : ct_ex_neg(x, v));
        }
    }
}

static void coordinate_terms(struct ct_build *b, int coordinate, ct_ex factor,
                             struct ct_linear *l)
{
    const struct ct_coordinate *c = &b->kinematics->coordinate[coordinate];
    struct ct_wrench w;
    if (ct_coordinate_is_known(c)) {
        add_term(b, l, c->u, c->driver, factor);
    } else if (ct_coordinate_wrench(b, coordinate, &w)) {
        w.force = ct_ex3_scale(b->x, factor, w.force);
        w.torque = ct_ex3_scale(b->x, factor, w.torque);
        wrench_terms(b, ct_edge_ends(b, c->edge), &w, true, l);
    }
}

// ---- rows ---------------------------------------------------------------------------------------

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

static void push_wrench(struct ct_build *b, const struct ct_multiplier_wrench *p)
{
    struct ct_row_wrenches *rows = b->open_rows;
    CT_PUSH(b->arena, rows->multiplier_wrench, rows->nmultiplier_wrench,
            rows->multiplier_wrench_cap, *p);
}

static void add_row(struct ct_build *b, int joint, const char *name, struct ct_ends n,
                    const struct ct_wrench *w, bool carried, ct_ex phi, ct_ex gam)
{
    struct ct_linear l = linear_zero(b);
    wrench_terms(b, n, w, carried, &l);
    const int index = push_row(b, name, joint, &l, phi, gam);
    struct ct_row *row = &b->eqs->row[index];
    row->is_length = !ct_ex3_is_zero(w->force);
    if (row->is_length)
        row->lever = ct_path_levers(b, n.tail, n.head, carried, &row->nlever);
    const struct ct_multiplier_wrench p
        = {index, n.tail, n.head, joint, w->force, w->torque, carried};
    push_wrench(b, &p);
}

const ct_ex *ct_row_coefficients(struct ct_build *b, int row)
{
    struct ct_linear l = linear_zero(b);
    for (size_t i = 0; i < b->rows->nmultiplier_wrench; i++) {
        const struct ct_multiplier_wrench *p = &b->rows->multiplier_wrench[i];
        const struct ct_wrench w = {p->force, p->torque};
        if (p->row == row)
            wrench_terms(b, (struct ct_ends){p->tail, p->head}, &w, p->carried, &l);
    }
    return l.coef;
}

static int joint_index(const struct ct_build *b, const struct ct_instance *self)
{
    return (int)(self - b->model->joint);
}

void ct_row_add(struct ct_build *b, const struct ct_instance *self, const char *what, int tail,
                int head, const struct ct_wrench *w, bool carried, ct_ex phi, ct_ex gam)
{
    const char *name = ct_arena_printf(b->arena, "%s.%s", self->name, what);
    add_row(b, joint_index(b, self), name, (struct ct_ends){tail, head}, w, carried, phi, gam);
}

ct_ex ct_row_offset(struct ct_build *b, const struct ct_instance *self, ct_ex at_start)
{
    return ct_memory_keep(b, self->name, joint_index(b, self), at_start);
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
        // on a measured coordinate the multiplier is a wrench pair; on a branch coordinate it is a
        // generalised force
        struct ct_wrench w;
        const struct ct_coordinate *c = &b->kinematics->coordinate[coupled[i]];
        const struct ct_ends n = ct_edge_ends(b, c->edge);
        const ct_ex f = i ? ct_ex_neg(x, ratio) : CT_EX_ONE;
        if (ct_coordinate_is_known(c)) {
            const struct ct_coupling own = {row, coupled[i], f};
            struct ct_row_wrenches *rows = b->open_rows;
            CT_PUSH(b->arena, rows->coupling, rows->ncoupling, rows->coupling_cap, own);
            continue;
        }
        if (!ct_coordinate_wrench(b, coupled[i], &w))
            continue;
        const struct ct_multiplier_wrench p = {row,
                                               n.tail,
                                               n.head,
                                               b->topology->edge[c->edge].index,
                                               ct_ex3_scale(x, f, w.force),
                                               ct_ex3_scale(x, f, w.torque),
                                               true};
        push_wrench(b, &p);
    }
}

// ---- translational rows of a joint --------------------------------------------------------------

// Rows for coincident origins: one along each ground axis, two in a plane.  (4.2)
static void place_rows(struct ct_build *b, const struct ct_edge_info *e, struct ct_ends n)
{
    struct ct_exs *x = b->x;
    const ct_ex3 d = ct_path_position(b, n.tail, n.head);
    const ct_ex3 a = ct_path_acceleration(b, n.tail, n.head, CT_BIAS);
    for (int i = 0; i < (b->topology->is_planar ? 2 : 3); i++) {
        const struct ct_wrench w = {b->topology->plane[i], zero3};
        add_row(b, e->index,
                ct_arena_printf(b->arena, "%s.%s", e->name, ct_plane_axis_name(b, i)), n, &w,
                false,
                ct_constraint_offset_subtract(b, e, ct_ex3_dot(x, b->topology->plane[i], d)),
                ct_ex3_dot(x, b->topology->plane[i], a));
    }
}

static void across_row(struct ct_build *b, const struct ct_edge_info *e, const char *name,
                       struct ct_ends n, ct_ex3 p)
{
    const struct ct_wrench w = {p, zero3};
    add_row(b, e->index, name, n, &w, true,
            ct_constraint_offset_subtract(
                b, e, ct_ex3_dot(b->x, p, ct_path_position(b, n.tail, n.head))),
            ct_along_acceleration(b, n, p, CT_BIAS));
}

// Directions of sliding in axes of `from`; returns their number.
static int slide_directions(struct ct_build *b, const struct ct_edge_info *e, ct_ex3 dir[3])
{
    int n = 0;
    for (int k = 0; k < e->ncoordinate && n < 3; k++) {
        ct_ex3 p;
        for (int i = 0; i < 3; i++)
            p.e[i] = ct_edge_partial(b, e, e->trial->d.e[i], k);
        if (!ct_ex3_is_zero(p))
            dir[n++] = p;
    }
    return n;
}

static void translation_rows(struct ct_build *b, int edge)
{
    const struct ct_edge_info *e = &b->topology->edge[edge];
    const struct ct_ends n = ct_edge_ends(b, edge);
    ct_ex3 dir[3];
    const int nslide = slide_directions(b, e, dir);
    if (nslide == 0) {
        place_rows(b, e, n);
    } else if (b->topology->is_planar) {
        if (nslide == 1) {
            const ct_ex3 p
                = ct_ex3_cross(b->x, b->topology->plane[2], ct_node_turn(b, n.tail, dir[0]));
            across_row(b, e, ct_arena_printf(b->arena, "%s.across", e->name), n, p);
        }
    } else {
        for (int i = 0; i < ct_edge_motion(b, e)->ntrans; i++)
            across_row(b, e, ct_arena_printf(b->arena, "%s.across%d", e->name, i + 1), n,
                       ct_node_turn(b, n.tail, ct_edge_motion(b, e)->trans[i]));
    }
}

// ---- rotational rows of a joint -----------------------------------------------------------------

static void planar_angle_row(struct ct_build *b, int edge)
{
    struct ct_exs *x = b->x;
    const struct ct_edge_info *e = &b->topology->edge[edge];
    const struct ct_ends n = ct_edge_ends(b, edge);
    const struct ct_wrench w = {zero3, b->topology->plane[2]};
    const ct_ex3 v
        = ct_ex33_apply_t(x, &b->topology->reference_axes[n.tail], b->topology->plane[0]);
    // the offset of an angle is not reduced to one turn: its sign gives the direction of rotation
    const ct_ex diff = ct_constraint_offset_subtract(
        b, e, ct_ex_sub(x, ct_angle_in_plane(b, n.head, v), ct_angle_in_plane(b, n.tail, v)));
    // reduced to (-pi, pi]: whole turns do not matter
    const ct_ex phi = ct_ex_fun2(x, CT_OP_ATAN2, ct_ex_fun(x, CT_OP_SIN, diff),
                                 ct_ex_fun(x, CT_OP_COS, diff));
    const ct_ex3 al
        = ct_cluster_path_acceleration(b, b->kinematics->placement[n.tail].frame,
                                       b->kinematics->placement[n.head].frame, CT_BIAS);
    add_row(b, e->index, ct_arena_printf(b->arena, "%s.angle", e->name), n, &w, true, phi,
            ct_ex3_dot(x, b->topology->plane[2], al));
}

// Row s . t = 0 (4.4): s is fixed in the tail, t in the head. s_local: s in axes of the tail.
// (4.4)
static void pair_row(struct ct_build *b, int edge, int i, ct_ex3 s_local)
{
    struct ct_exs *x = b->x;
    const struct ct_edge_info *e = &b->topology->edge[edge];
    const struct ct_ends n = ct_edge_ends(b, edge);
    const int from = b->kinematics->placement[n.tail].frame,
              to = b->kinematics->placement[n.head].frame;
    const ct_ex3 s = ct_node_turn(b, n.tail, s_local);
    const ct_ex3 t = ct_node_turn(b, n.head, ct_edge_motion(b, e)->rot_to[i]);
    const struct ct_wrench w = {zero3, ct_ex3_cross(x, t, s)};
    const ct_ex wanted
        = ct_ex3_dot(x, ct_edge_motion(b, e)->rot_from[i], ct_edge_motion(b, e)->rot_to[i]);
    const ct_ex phi = ct_ex_sub(x, ct_ex3_dot(x, s, t), wanted);
    const ct_ex3 turning
        = ct_ex3_add(x, ct_ex3_cross(x, ct_cluster_cross_velocity(b, to, t), s),
                     ct_ex3_cross(x, t, ct_cluster_cross_velocity(b, from, s)));
    const ct_ex gam = ct_ex_add(
        x, ct_ex3_dot(x, w.torque, ct_cluster_path_acceleration(b, from, to, CT_BIAS)),
        ct_ex3_dot(x, turning, ct_cluster_path_velocity(b, from, to)));
    add_row(b, e->index, ct_arena_printf(b->arena, "%s.turn%d", e->name, i + 1), n, &w, true,
            phi, gam);
    // the rows also hold after half a turn: the sign of the cosine between equal axes tells them
    // apart
    const ct_ex3 axis = ct_node_turn(b, n.tail, ct_edge_motion(b, e)->rot_to[i]);
    if (ct_edge_motion(b, e)->nrot > 1)
        b->eqs->row[b->eqs->nrow - 1].assembly_sign = ct_ex3_dot(x, axis, t);
}

static void rotation_rows(struct ct_build *b, int edge)
{
    const struct ct_edge_info *e = &b->topology->edge[edge];
    if (!b->topology->is_planar) {
        ct_ex3 s[COUNT(ct_edge_motion(b, e)->rot_from)];
        for (int i = 0; i < ct_edge_motion(b, e)->nrot; i++)
            s[i] = ct_edge_motion(b, e)->rot_from[i];
        ct_constraint_offset_rotate(b, e, b->topology->wiring[edge].tail,
                                    b->topology->wiring[edge].head, s,
                                    ct_edge_motion(b, e)->nrot);
        for (int i = 0; i < ct_edge_motion(b, e)->nrot; i++)
            pair_row(b, edge, i, s[i]);
        return;
    }
    for (int k = 0; k < e->ncoordinate; k++)
        if (b->kinematics->coordinate[e->first_coordinate + k].in_rotation)
            return;
    planar_angle_row(b, edge);
}

// ---- drivers of chords --------------------------------------------------------------------------

static void driven_row(struct ct_build *b, int coordinate)
{
    struct ct_exs *x = b->x;
    const struct ct_coordinate *c = &b->kinematics->coordinate[coordinate];
    const struct ct_edge_info *e = &b->topology->edge[c->edge];
    const struct ct_value *motion = ct_instance_value(e->self, "motion");
    struct ct_wrench w;
    if (!ct_coordinate_wrench(b, coordinate, &w))
        return;
    const ct_ex s = ct_switch_hold(b, motion->e[c->index]);
    const ct_ex rate = ct_build_rate(b, s);
    const ct_ex phi = ct_ex_sub(x, ct_coordinate_value(b, coordinate), s);
    const ct_ex gam = ct_ex_sub(x, ct_coordinate_acceleration(b, coordinate, CT_BIAS),
                                ct_build_rate(b, rate));
    add_row(b, e->index, ct_arena_printf(b->arena, "%s.motion", c->name),
            ct_edge_ends(b, c->edge), &w, true, phi, gam);
    struct ct_row *row = &b->eqs->row[b->eqs->nrow - 1];
    row->v = ct_ex_sub(x, row->v, rate);
    b->eqs->power = ct_ex_add(x, b->eqs->power, ct_ex_mul(x, row->lam, rate));
    b->open_rows->motion_row[coordinate] = (int)b->eqs->nrow; // row number plus one; 0: none
}

// Is there no loop of joints? A gear counts as a loop, because it couples coordinates of different
// bodies.
static bool is_open(const struct ct_build *b)
{
    const struct ct_model *m = b->model;
    struct ct_disjoint_sets p;
    ct_disjoint_sets_init(b->arena, (int)m->nbody, &p);
    for (size_t j = 0; j < m->njoint; j++) {
        const struct ct_instance *joint = &m->joint[j];
        if (joint->from < 0 || joint->to < 0)
            return false;
        const struct ct_edge between = {m->frame[joint->from].body, m->frame[joint->to].body};
        if (!ct_disjoint_sets_union(&p, between))
            return false;
    }
    return true;
}

bool ct_rows_derive(struct ct_build *b)
{
    b->eqs->is_open = is_open(b);
    b->rows = b->open_rows = CT_NEW(b->arena, struct ct_row_wrenches);
    b->open_rows->motion_row = CT_NEWN(b->arena, int, b->topology->ncoordinate + 1);
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_edge_info *e = &b->topology->edge[i];
        const bool moves
            = e->kind == CT_EDGE_CLOSURE || (e->kind == CT_EDGE_JOINT && e->self->cls->motion);
        if (!moves)
            continue;
        if (!b->T.is_branch[i] && !(e->trial->quaternion == 3))
            translation_rows(b, (int)i);
        if (!b->R.is_branch[i] && e->has_rotation && e->trial->quaternion < 0)
            rotation_rows(b, (int)i);
        for (int k = 0; k < e->ncoordinate; k++) {
            const struct ct_coordinate *c = &b->kinematics->coordinate[e->first_coordinate + k];
            if (c->is_driven && c->driver < 0)
                driven_row(b, e->first_coordinate + k);
        }
    }
    for (size_t j = 0; j < b->model->njoint; j++)
        if (b->model->joint[j].cls->apply)
            b->model->joint[j].cls->apply(b, &b->model->joint[j]);
    b->open_rows = NULL;
    return true;
}
