// Forward sweep of accelerations, reverse sweep of forces, loads, generalised forces. (formulation
// 5.2)
//
// A link transmits F = m a plus the inertia forces due to rotation and translation of its outboard
// augmented bodies. A cluster transmits the torque of its augmented bodies about their anchors. The
// sums from the leaves are the cutset equations of the branches. Their projection on the motion of
// a branch is a row of M u' - Q - J' lam.
#include "formulate/beam/flexible_body.h"
#include "formulate/kinematics/constraint_row.h"
#include "formulate/signals/signal.h"
#include "formulate/dynamics/small_motion.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/mass_sums.h"
#include "formulate/dynamics/dynamics.h"

#include <string.h>

// ---- loads -------------------------------------------------------------------------------------

void ct_load_add(struct ct_build *b, const struct ct_load *load)
{
    struct ct_loads *loads = b->open_loads;
    CT_PUSH(b->arena, loads->load, loads->nload, loads->load_cap, *load);
}

ct_ex3 ct_load_vector(struct ct_build *b, const struct ct_instance *self)
{
    const struct ct_value *value = ct_instance_value(self, "value");
    const struct ct_value *in = ct_instance_value(self, "in");
    ct_ex3 v;
    for (int i = 0; i < 3; i++)
        v.e[i] = ct_build_value(b, value->e[i]);
    return in->given ? ct_node_turn(b, b->topology->node_of_frame[in->frame], v) : v;
}

bool ct_vector_signal(const char *name, const char *property, ct_ex3 v, ct_ex *out)
{
    const size_t n = strlen(property);
    if (strncmp(name, property, n) != 0 || name[n] != '.' || strlen(name) != n + 2
        || name[n + 1] < 'x' || name[n + 1] > 'z')
        return false;
    *out = v.e[name[n + 1] - 'x'];
    return true;
}

// ---- the sweep ---------------------------------------------------------------------------------

struct work {
    struct ct_build *b;
    enum ct_level level;
    ct_ex3 *rest;     // by anchor: outboard force beyond mass * acceleration of the anchor
    ct_ex3 *torque;   // by cluster
    ct_ex3 *apparent; // by anchor: acceleration minus gravity
};

// Subtracts an applied force and torque at a node from what the tree must supply.
static void apply_at(struct work *w, int node, ct_ex3 force, ct_ex3 torque)
{
    struct ct_exs *x = w->b->x;
    const struct ct_node_placement *p = &w->b->kinematics->placement[node];
    ct_ex3 *rest = &w->rest[p->anchor], *arm = &w->torque[p->cluster],
           *own = &w->torque[p->frame];
    *rest = ct_ex3_sub(x, *rest, force);
    *arm = ct_ex3_sub(x, *arm,
                      ct_ex3_cross(x, ct_cluster_turn(w->b, p->cluster, p->local), force));
    *own = ct_ex3_sub(x, *own, torque);
}

// Applies a wrench at head and its opposite on tail, along the line through head.  (0.2)
static void apply_pair(struct work *w, int tail, int head, ct_ex3 force, ct_ex3 torque,
                       bool carried)
{
    struct ct_exs *x = w->b->x;
    apply_at(w, head, force, torque);
    if (tail == 0)
        return;
    ct_ex3 back = torque;
    if (carried)
        back = ct_ex3_add(x, back, ct_ex3_cross(x, ct_path_position(w->b, tail, head), force));
    apply_at(w, tail, ct_ex3_neg(x, force), ct_ex3_neg(x, back));
}

static void apply_loads(struct work *w)
{
    struct ct_build *b = w->b;
    for (size_t i = 0; i < b->loads->nload; i++) {
        const struct ct_load *l = &b->loads->load[i];
        apply_pair(w, l->tail, l->head, l->force, l->torque, !l->is_central);
    }
    if (w->level == CT_BIAS)
        return;
    for (size_t i = 0; i < b->rows->nmultiplier_wrench; i++) {
        const struct ct_multiplier_wrench *p = &b->rows->multiplier_wrench[i];
        const ct_ex lam = b->eqs->row[p->row].lam;
        apply_pair(w, p->tail, p->head, ct_ex3_scale(b->x, lam, p->force),
                   ct_ex3_scale(b->x, lam, p->torque), p->carried);
    }
}

static void find_apparent(struct work *w)
{
    struct ct_build *b = w->b;
    w->apparent[0] = ct_ex3_neg(b->x, b->model->gravity);
    for (size_t a = 1; a < b->kinematics->nanchor; a++)
        w->apparent[a] = ct_ex3_add(b->x, w->apparent[b->kinematics->anchor[a].parent],
                                    ct_link_acceleration(b, (int)a, w->level));
}

// Adds the inertia forces and torques of an augmented body. Outboard anchors are done already.
static void sweep_augmented_body(struct work *w, const struct ct_augmented_body *s)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    const ct_ex3 moment = ct_cluster_turn(b, s->cluster, s->moment);
    const ct_ex3 turning = ct_ex3_add(
        x, ct_ex3_cross(x, ct_cluster_acceleration(b, s->cluster, w->level), moment),
        ct_cluster_centripetal(b, s->cluster, moment));
    ct_ex3 rest = turning;
    ct_ex3 torque = ct_ex3_cross(x, moment, w->apparent[s->anchor]);
    for (int k = 0; k < s->nchild; k++) {
        const int child = b->dynamics.masses.child[s->first_child + k];
        const ct_ex3 slide = ct_ex3_scale(x, b->dynamics.masses.mass[child],
                                          ct_link_sliding_acceleration(b, child, w->level));
        const ct_ex3 force = ct_ex3_add(x, w->rest[child], slide);
        rest = ct_ex3_add(x, rest, force);
        torque = ct_ex3_add(x, torque, ct_ex3_cross(x, ct_link_vector(b, child), force));
    }
    w->rest[s->anchor] = ct_ex3_add(x, w->rest[s->anchor], rest);
    w->torque[s->cluster] = ct_ex3_add(x, w->torque[s->cluster], torque);
}

// I al + w x I w for the augmented inertia of a cluster.
static ct_ex3 inertia_torque(struct work *w, int c)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    const ct_ex33 I = ct_cluster_inertia(b, c);
    const ct_ex3 al = ct_cluster_acceleration(b, c, w->level);
    if (b->topology->is_planar)
        return ct_ex3_scale(x, I.e[8], al);
    const ct_ex3 omega = ct_cluster_velocity(b, c);
    return ct_ex3_add(x, ct_ex33_apply(x, &I, al),
                      ct_ex3_cross(x, omega, ct_ex33_apply(x, &I, omega)));
}

// The same in axes of the cluster, where I is constant. Only for clusters whose parent is ground:
// their rates are short, and no inboard cluster needs the torque. False if an axis is not fixed in
// the cluster.
static bool local_inertia_torque(struct work *w, int c, ct_ex3 *torque)
{
    struct ct_build *b = w->b;
    struct ct_exs *x = b->x;
    const ct_ex33 *L = &b->dynamics.masses.inertia[c];
    ct_ex3 omega, al;
    if (b->topology->is_planar || !ct_cluster_own_rates(b, c, w->level, &omega, &al))
        return false;
    *torque = ct_ex3_add(x, ct_ex33_apply(x, L, al),
                         ct_ex3_cross(x, omega, ct_ex33_apply(x, L, omega)));
    return true;
}

static void sweep_anchors(struct work *w)
{
    struct ct_build *b = w->b;
    int *first = CT_NEWN(b->arena, int, b->kinematics->nanchor),
        *next = CT_NEWN(b->arena, int, b->dynamics.masses.naugmented_body + 1);
    for (size_t i = 0; i < b->dynamics.masses.naugmented_body;
         i++) { // lists end at 0: indices are stored plus one
        next[i] = first[b->dynamics.masses.augmented_body[i].anchor];
        first[b->dynamics.masses.augmented_body[i].anchor] = (int)i + 1;
    }
    for (size_t a = b->kinematics->nanchor; a-- > 0;)
        for (int i = first[a]; i; i = next[i - 1])
            sweep_augmented_body(w, &b->dynamics.masses.augmented_body[i - 1]);
}

const struct ct_sweep *ct_sweep_run(struct ct_build *b, enum ct_level level)
{
    if (b->dynamics.sweep[level])
        return b->dynamics.sweep[level];
    struct work w = {.b = b, .level = level};
    ct_augmented_bodies_lump(b);
    struct ct_sweep *s = CT_NEW(b->arena, struct ct_sweep);
    w.rest = s->rest = CT_NEWN(b->arena, ct_ex3, b->kinematics->nanchor);
    w.torque = s->torque = CT_NEWN(b->arena, ct_ex3, b->kinematics->ncluster);
    s->local = CT_NEWN(b->arena, ct_ex3, b->kinematics->ncluster);
    w.apparent = s->apparent = CT_NEWN(b->arena, ct_ex3, b->kinematics->nanchor);
    s->force = CT_NEWN(b->arena, ct_ex3, b->kinematics->nanchor);
    s->row = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1);
    find_apparent(&w);
    apply_loads(&w);
    ct_flexible_sweep(b, level, w.apparent, w.rest, w.torque, s->row);
    sweep_anchors(&w);
    for (size_t c = b->kinematics->ncluster; c-- > 1;) {
        if (!local_inertia_torque(&w, (int)c, &s->local[c]))
            w.torque[c] = ct_ex3_add(b->x, w.torque[c], inertia_torque(&w, (int)c));
        const int parent = b->kinematics->cluster[c].parent;
        w.torque[parent] = ct_ex3_add(b->x, w.torque[parent], w.torque[c]);
    }
    for (size_t a = 1; a < b->kinematics->nanchor; a++) {
        const ct_ex3 inertia = ct_ex3_scale(b->x, b->dynamics.masses.mass[a], w.apparent[a]);
        s->force[a] = ct_ex3_add(b->x, w.rest[a], inertia);
    }
    b->dynamics.sweep[level] = s;
    return s;
}

// ---- rows --------------------------------------------------------------------------------------

// Adds s . torque or p . force for the motion of a speed or a driver.
static ct_ex add_rotation_axis(struct ct_build *b, const struct ct_sweep *s, ct_ex sum,
                               size_t r, const struct ct_term *t)
{
    struct ct_exs *x = b->x;
    const int c = b->kinematics->rotation_axis[r].cluster;
    const ct_ex moment
        = ct_ex_add(x, ct_ex3_dot(x, b->kinematics->rotation_axis[r].axis, s->torque[c]),
                    ct_ex3_dot(x, b->kinematics->rotation_axis[r].local, s->local[c]));
    return ct_ex_add(x, sum, ct_ex_mul(x, t->coef, moment));
}

static ct_ex add_translation_axis(struct ct_build *b, const struct ct_sweep *s, ct_ex sum,
                                  size_t a, const struct ct_translation_axis *t)
{
    struct ct_exs *x = b->x;
    const ct_ex3 p = ct_cluster_turn(b, b->kinematics->anchor[a].cluster, t->p);
    sum = ct_ex_add(x, sum, ct_ex3_dot(x, p, s->force[a]));
    if (ct_ex3_is_zero(t->extra))
        return sum;
    const ct_ex3 extra = ct_cluster_turn(b, b->kinematics->anchor[a].cluster, t->extra);
    return ct_ex_add(x, sum, ct_ex3_dot(x, extra, ct_sweep_run(b, CT_BIAS)->force[a]));
}

static void list_speed_axis(struct ct_build *b, int speed, bool slides, size_t at, int k,
                            size_t *last)
{
    if (speed < 0)
        return;
    const struct ct_speed_axis user = {.is_translation = slides, .at = at, .k = k};
    CT_PUSH(b->arena, b->dynamics.speed_axis, b->dynamics.nspeed_axis,
            b->dynamics.speed_axis_cap, user);
    if (b->dynamics.first_speed_axis[speed])
        b->dynamics.speed_axis[last[speed] - 1].next = b->dynamics.nspeed_axis;
    else
        b->dynamics.first_speed_axis[speed] = b->dynamics.nspeed_axis;
    last[speed] = b->dynamics.nspeed_axis;
}

// Lists the axes that each speed moves: rotation axes first, then anchors.
static void list_speed_axes(struct ct_build *b)
{
    size_t *last = CT_NEWN(b->ctx->scratch, size_t, b->eqs->nu + 1);
    b->dynamics.first_speed_axis = CT_NEWN(b->arena, size_t, b->eqs->nu + 1);
    for (size_t r = 0; r < b->kinematics->nrotation_axis; r++)
        for (int k = 0; k < b->kinematics->rotation_axis[r].nterm; k++)
            list_speed_axis(b, b->kinematics->rotation_axis[r].term[k].speed, false, r, k,
                            last);
    for (size_t a = 1; a < b->kinematics->nanchor; a++)
        for (int k = 0; k < b->kinematics->anchor[a].ntranslation_axis; k++)
            list_speed_axis(b, b->kinematics->anchor[a].translation_axis[k].speed, true, a, k,
                            last);
}

static ct_ex sweep_row(struct ct_build *b, const struct ct_sweep *s, int speed)
{
    ct_ex sum = s->row[speed];
    if (!b->dynamics.first_speed_axis)
        list_speed_axes(b);
    for (size_t i = b->dynamics.first_speed_axis[speed]; i > 0;
         i = b->dynamics.speed_axis[i - 1].next) {
        const struct ct_speed_axis *m = &b->dynamics.speed_axis[i - 1];
        sum = m->is_translation
                ? add_translation_axis(b, s, sum, m->at,
                                       &b->kinematics->anchor[m->at].translation_axis[m->k])
                : add_rotation_axis(b, s, sum, m->at,
                                    &b->kinematics->rotation_axis[m->at].term[m->k]);
    }
    return sum;
}

static ct_ex sweep_driver_row(struct ct_build *b, const struct ct_sweep *s, int driver)
{
    ct_ex sum = CT_EX_ZERO;
    for (size_t r = 0; r < b->kinematics->nrotation_axis; r++)
        for (int k = 0; k < b->kinematics->rotation_axis[r].nterm; k++)
            if (b->kinematics->rotation_axis[r].term[k].speed == -1
                && b->kinematics->rotation_axis[r].term[k].driver == driver)
                sum = add_rotation_axis(b, s, sum, r, &b->kinematics->rotation_axis[r].term[k]);
    for (size_t a = 1; a < b->kinematics->nanchor; a++)
        for (int k = 0; k < b->kinematics->anchor[a].ntranslation_axis; k++)
            if (b->kinematics->anchor[a].translation_axis[k].speed == -1
                && b->kinematics->anchor[a].translation_axis[k].driver == driver)
                sum = add_translation_axis(b, s, sum, a,
                                           &b->kinematics->anchor[a].translation_axis[k]);
    return sum;
}

void ct_forces_derive(struct ct_build *b)
{
    const struct ct_sweep *s = ct_sweep_run(b, CT_BIAS);
    struct ct_equations *e = b->eqs;
    for (size_t k = 0; k < e->nu; k++)
        e->Q[k] = ct_ex_sub(b->x, b->loads->effort[k], sweep_row(b, s, (int)k));
}

void ct_dynamics_derive(struct ct_build *b)
{
    if (b->eqs->has_dynamics)
        return;
    ct_augmented_bodies_lump(b);
    ct_mass_matrix_derive(b);
    ct_forces_derive(b);
    ct_small_motion_derive(b);
    b->eqs->has_dynamics = true;
}

ct_ex ct_sweep_row(struct ct_build *b, int speed)
{
    return ct_speed_is_state(b->eqs, (size_t)speed)
             ? b->eqs->u[speed].derivative
             : sweep_row(b, ct_sweep_run(b, CT_FULL), speed);
}

ct_ex ct_sweep_residual(struct ct_build *b, int speed)
{
    return ct_ex_sub(b->x, ct_sweep_row(b, speed), b->loads->effort[speed]);
}

// ---- efforts of joints -------------------------------------------------------------------------

static ct_ex element(const struct ct_value *v, int k)
{
    return v->given && (size_t)k < v->n && !v->hole[k] ? v->e[k] : CT_EX_ZERO;
}

// Adds the generalised force `effort` along a coordinate: to its row or, for a measured coordinate,
// as a wrench pair.
static void push_coordinate(struct ct_build *b, int coordinate, ct_ex effort, ct_ex potential,
                            ct_ex power)
{
    const struct ct_coordinate *c = &b->kinematics->coordinate[coordinate];
    const struct ct_edge_info *e = &b->topology->edge[c->edge];
    struct ct_equations *s = b->eqs;
    if (c->u >= 0)
        s->Q[c->u] = ct_ex_add(b->x, s->Q[c->u], effort);
    if (c->u >= 0 || c->driver >= 0) {
        s->potential = ct_ex_add(b->x, s->potential, potential);
        s->power = ct_ex_add(b->x, s->power, power);
        return;
    }
    struct ct_wrench w;
    if (ct_coordinate_wrench(b, coordinate, &w))
        ct_load_add(b, &(struct ct_load){.self = e->self,
                                         .tail = b->topology->wiring[c->edge].tail,
                                         .head = b->topology->wiring[c->edge].head,
                                         .force = ct_ex3_scale(b->x, effort, w.force),
                                         .torque = ct_ex3_scale(b->x, effort, w.torque),
                                         .potential = potential,
                                         .power = power});
}

// Efforts of a joint along its coordinate k: spring, damper, applied effort.
struct effort {
    ct_ex total, potential, power;
};

static struct effort own_effort(struct ct_build *b, const struct ct_edge_info *e, int k)
{
    struct ct_exs *x = b->x;
    const int coordinate = e->first_coordinate + k;
    const ct_ex stiffness = element(ct_instance_value(e->self, "stiffness"), k);
    const ct_ex damping = element(ct_instance_value(e->self, "damping"), k);
    const ct_ex applied = ct_build_value(b, element(ct_instance_value(e->self, "effort"), k));
    struct effort f = {applied, CT_EX_ZERO, CT_EX_ZERO};
    if (!ct_ex_is_zero(stiffness)) {
        const ct_ex rest = element(ct_instance_value(e->self, "rest"), k);
        const ct_ex stretch = ct_ex_sub(x, ct_coordinate_value(b, coordinate), rest);
        const ct_ex pull = ct_ex_mul(x, stiffness, stretch);
        f.total = ct_ex_sub(x, f.total, pull);
        f.potential = ct_ex_scale(x, 0.5, ct_ex_mul(x, pull, stretch));
    }
    if (!ct_ex_is_zero(damping) || !ct_ex_is_zero(applied)) {
        const ct_ex u = ct_coordinate_speed(b, coordinate), drag = ct_ex_mul(x, damping, u);
        f.total = ct_ex_sub(x, f.total, drag);
        f.power = ct_ex_mul(x, ct_ex_sub(x, applied, drag), u);
    }
    return f;
}

ct_ex ct_driver_effort(struct ct_build *b, int coordinate)
{
    struct ct_exs *x = b->x;
    const struct ct_coordinate *c = &b->kinematics->coordinate[coordinate];
    const int motion_row = b->rows->motion_row[coordinate];
    if (motion_row)
        return b->eqs->row[motion_row - 1].lam;
    const struct effort own = own_effort(b, &b->topology->edge[c->edge], c->index);
    ct_ex rest
        = ct_ex_sub(x, sweep_driver_row(b, ct_sweep_run(b, CT_FULL), c->driver), own.total);
    for (size_t i = 0; i < b->rows->ncoupling; i++)
        if (b->rows->coupling[i].coordinate == coordinate)
            rest = ct_ex_sub(x, rest,
                             ct_ex_mul(x, b->rows->coupling[i].factor,
                                       b->eqs->row[b->rows->coupling[i].row].lam));
    return rest;
}

static void joint_effort(struct ct_build *b, const struct ct_edge_info *e, int k)
{
    const struct ct_coordinate *c = &b->kinematics->coordinate[e->first_coordinate + k];
    const struct ct_value *stiffness = ct_instance_value(e->self, "stiffness");
    if (!c->in_translation && !c->in_rotation)
        return; // one end is a particle: this degree of freedom does not exist
    if (!ct_ex_is_zero(element(stiffness, k)) && e->trial->quaternion >= 0
        && k >= e->trial->quaternion) {
        ct_error(b->ctx, stiffness->mark, CT_E_STIFFNESS,
                 "joint '%s': a free rotation has no coordinate for a stiffness; use a bushing",
                 e->self->name);
        return;
    }
    const struct effort f = own_effort(b, e, k);
    if (!ct_ex_is_zero(f.total))
        push_coordinate(b, e->first_coordinate + k, f.total, f.potential, f.power);
}

// Sets Q of the states of the model to their rates.
static void derive_rates(struct ct_build *b)
{
    struct ct_equations *e = b->eqs;
    b->signals.is_rate = true;
    for (size_t i = 0; i < e->nstate; i++) {
        b->signals.holding = b->model->state[i].rate_mark;
        e->Q[e->nmotion + i] = ct_build_value(b, b->model->state[i].rate);
    }
    b->signals.is_rate = false;
}

bool ct_loads_derive(struct ct_build *b)
{
    const size_t before = b->ctx->nerror;
    struct ct_loads *loads = CT_NEW(b->arena, struct ct_loads);
    b->loads = b->open_loads = loads;
    for (size_t i = 0; i < b->topology->nedge; i++) {
        const struct ct_edge_info *e = &b->topology->edge[i];
        b->signals.holding = e->mark;
        if (e->kind == CT_EDGE_JOINT && e->self->cls->motion)
            for (int k = 0; k < e->self->nfree; k++)
                joint_effort(b, e, k);
        if (e->kind == CT_EDGE_FORCE)
            e->self->cls->apply(b, e->self);
    }
    for (size_t i = 0; i < loads->nload; i++) {
        b->eqs->potential = ct_ex_add(b->x, b->eqs->potential, loads->load[i].potential);
        b->eqs->power = ct_ex_add(b->x, b->eqs->power, loads->load[i].power);
    }
    derive_rates(b);
    loads->effort = CT_NEWN(b->arena, ct_ex, b->eqs->nu + 1);
    for (size_t k = 0; k < b->eqs->nu; k++)
        loads->effort[k] = b->eqs->Q[k]; // Q contains nothing else yet
    b->open_loads = NULL;
    return b->ctx->nerror == before;
}
