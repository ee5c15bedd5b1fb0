// Reactions by cutset sums over nodes; see reaction.h.
//
// A branch of T_T transmits the forces of its outboard nodes (5.8). A branch of T_R transmits the
// torques of its outboard nodes and the moments of the translational branches with tails there
// (5.9), (5.3).
#include "formulate/dynamics/reaction.h"
#include "formulate/beam/flexible_body.h"
#include "formulate/kinematics/constraint_row.h"
#include "formulate/beam_dynamics/beam_dynamics.h"

#include <math.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

static void add(struct ct_build *b, ct_ex3 *sum, ct_ex3 v)
{
    *sum = ct_ex3_add(b->x, *sum, v);
}

static void take(struct ct_build *b, ct_ex3 *sum, ct_ex3 v)
{
    *sum = ct_ex3_sub(b->x, *sum, v);
}

// ---- what acts at a node ------------------------------------------------------------------------

static ct_ex3 pair_moment(struct ct_build *b, int tail, int head, ct_ex3 force)
{
    return ct_ex3_cross(b->x, ct_path_position(b, tail, head), force);
}

// Net force on a node: m (a - g) minus applied forces.
static ct_ex3 own_force(struct ct_build *b, int node)
{
    struct ct_exs *x = b->x;
    ct_ex3 sum = zero3;
    for (size_t i = 1; i < b->model->nbody; i++)
        if (b->topology->node_of_com[i] == node && b->model->body[i].beam) {
            ct_ex3 force, torque;
            ct_flexible_wrench(b, ct_flexible_of(b, (int)i), &force, &torque);
            add(b, &sum, force);
        } else if (b->topology->node_of_com[i] == node) {
            const ct_ex3 a = ct_node_acceleration(b, node, CT_FULL);
            add(b, &sum,
                ct_ex3_scale(x, b->model->body[i].mass, ct_ex3_sub(x, a, b->model->gravity)));
        }
    for (size_t i = 0; i < b->loads->nload; i++) {
        if (b->loads->load[i].head == node)
            take(b, &sum, b->loads->load[i].force);
        if (b->loads->load[i].tail == node)
            add(b, &sum, b->loads->load[i].force);
    }
    for (size_t i = 0; i < b->rows->nmultiplier_wrench; i++) {
        const ct_ex3 f = ct_ex3_scale(x, b->eqs->row[b->rows->multiplier_wrench[i].row].lam,
                                      b->rows->multiplier_wrench[i].force);
        if (b->rows->multiplier_wrench[i].head == node)
            take(b, &sum, f);
        if (b->rows->multiplier_wrench[i].tail == node)
            add(b, &sum, f);
    }
    return sum;
}

static ct_ex3 body_torque(struct ct_build *b, int body, int node)
{
    struct ct_exs *x = b->x;
    if (b->model->body[body].beam) {
        ct_ex3 force, torque;
        ct_flexible_wrench(b, ct_flexible_of(b, body), &force, &torque);
        return torque;
    }
    const ct_ex *I = b->model->body[body].inertia;
    const ct_ex33 own = {{I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2]}};
    const int c = b->kinematics->placement[node].frame;
    const ct_ex3 w = ct_node_unturn(b, node, ct_cluster_velocity(b, c));
    const ct_ex3 al = ct_node_unturn(b, node, ct_cluster_acceleration(b, c, CT_FULL));
    const ct_ex3 T = ct_ex3_add(x, ct_ex33_apply(x, &own, al),
                                ct_ex3_cross(x, w, ct_ex33_apply(x, &own, w)));
    return ct_node_turn(b, node, T);
}

static ct_ex3 own_torque(struct ct_build *b, int node)
{
    struct ct_exs *x = b->x;
    ct_ex3 sum = zero3;
    for (size_t i = 1; i < b->model->nbody; i++)
        if (b->topology->node_of_com[i] == node && !b->model->body[i].is_particle)
            add(b, &sum, body_torque(b, (int)i, node));
    for (size_t i = 0; i < b->loads->nload; i++) {
        const struct ct_load *l = &b->loads->load[i];
        if (l->head == node)
            take(b, &sum, l->torque);
        if (l->tail == node) {
            add(b, &sum, l->torque);
            if (!l->is_central)
                add(b, &sum, pair_moment(b, l->tail, l->head, l->force));
        }
    }
    for (size_t i = 0; i < b->rows->nmultiplier_wrench; i++) {
        const struct ct_multiplier_wrench *p = &b->rows->multiplier_wrench[i];
        const ct_ex lam = b->eqs->row[p->row].lam;
        const ct_ex3 T = ct_ex3_scale(x, lam, p->torque), F = ct_ex3_scale(x, lam, p->force);
        if (p->head == node)
            take(b, &sum, T);
        if (p->tail == node) {
            add(b, &sum, T);
            if (p->carried && !ct_ex3_is_zero(F))
                add(b, &sum, pair_moment(b, p->tail, p->head, F));
        }
    }
    return sum;
}

// ---- cutset sums --------------------------------------------------------------------------------

// Force that the branch above a node must supply.  (5.8)
static ct_ex3 cut_force(struct ct_build *b, int node)
{
    ct_ex3 sum = own_force(b, node);
    for (int i = 1; i < b->T.nnode; i++) // children; equal sums are one expression
        if (b->T.parent[b->T.order[i]] == node)
            add(b, &sum, cut_force(b, b->T.order[i]));
    return sum;
}

// Vector of a translational branch in ground components.
static ct_ex3 branch_vector(struct ct_build *b, int edge)
{
    const struct ct_edge_info *e = &b->topology->edge[edge];
    const ct_ex3 d = ct_edge_kinematics(b, e)->d;
    return ct_node_turn(b, b->topology->wiring[edge].tail, d);
}

// Torque that the branch above a node of T_R must supply.  (5.9)
static ct_ex3 cut_torque(struct ct_build *b, int node)
{
    struct ct_exs *x = b->x;
    ct_ex3 sum = own_torque(b, node);
    for (int i = 1; i < b->T.nnode; i++) {
        const int child = b->T.order[i], edge = b->T.parent_edge[child];
        if (b->topology->wiring[edge].tail != node)
            continue;
        const ct_ex3 d = branch_vector(b, edge);
        if (ct_ex3_is_zero(d))
            continue;
        const ct_ex3 moment = ct_ex3_cross(x, d, cut_force(b, child));
        if (b->T.sign[child] > 0)
            add(b, &sum, moment);
        else
            take(b, &sum, moment);
    }
    for (int i = 1; i < b->R.nnode; i++)
        if (b->R.parent[b->R.order[i]] == node)
            add(b, &sum, cut_torque(b, b->R.order[i]));
    return sum;
}

// ---- branches -----------------------------------------------------------------------------------

static int outboard_node(const struct ct_build *b, const struct ct_tree *t, int edge)
{
    const int head = b->topology->wiring[edge].head;
    return t->parent_edge[head] == edge ? head : b->topology->wiring[edge].tail;
}

static void sum_over_trees(struct ct_build *b, int edge, ct_ex3 *force, ct_ex3 *torque)
{
    *force = *torque = zero3;
    if (b->T.is_branch[edge]) {
        const int node = outboard_node(b, &b->T, edge);
        *force = cut_force(b, node);
        if (b->T.sign[node] < 0)
            *force = ct_ex3_neg(b->x, *force);
    }
    if (b->R.is_branch[edge]) {
        const int node = outboard_node(b, &b->R, edge);
        *torque = cut_torque(b, node);
        if (b->R.sign[node] < 0)
            *torque = ct_ex3_neg(b->x, *torque);
    }
}

// ---- planar mechanisms --------------------------------------------------------------------------

// Is component i of a force in the plane, or of a torque along the normal?
static bool is_of_plane(const struct ct_build *b, int node, bool is_force, int i)
{
    const ct_ex3 n
        = ct_ex33_apply_t(b->x, &b->topology->reference_axes[node], b->topology->plane[2]);
    const double along = fabs(ct_ex_value(b->x, n.e[i], b->value));
    return is_force ? along < CT_DATA_ROUNDOFF : along > 1 - CT_DATA_ROUNDOFF;
}

// Marks the nodes that are cut off from ground if branch e is removed.
static void mark_outboard(const struct ct_tree *t, int edge, bool *outboard)
{
    for (int i = 1; i < t->nnode; i++) { // parents come first
        const int node = t->order[i];
        outboard[node] = t->parent_edge[node] == edge || outboard[t->parent[node]];
    }
}

static bool is_chord(const struct ct_build *b, int edge)
{
    return !b->T.is_branch[edge]
        || (b->topology->edge[edge].has_rotation && !b->R.is_branch[edge]);
}

static bool is_link(const struct ct_build *b, size_t edge)
{
    const enum ct_edge_kind kind = b->topology->edge[edge].kind;
    return kind != CT_EDGE_BODY && kind != CT_EDGE_FORCE
        && !b->topology->edge[edge].never_branch;
}

// Nodes connected with the head of an edge after it is removed; NULL if its tail is one of them, as
// the edge is then in a loop.
static const bool *head_side(const struct ct_build *b, int edge)
{
    bool *is_head_side = CT_NEWN(b->arena, bool, b->topology->nnode), grows = true;
    is_head_side[b->topology->wiring[edge].head] = true;
    while (grows) {
        grows = false;
        for (size_t e = 0; e < b->topology->nedge; e++) {
            const int tail = b->topology->wiring[e].tail, head = b->topology->wiring[e].head;
            if ((int)e == edge || !is_link(b, e) || is_head_side[tail] == is_head_side[head])
                continue;
            is_head_side[tail] = is_head_side[head] = grows = true;
        }
    }
    return is_head_side[b->topology->wiring[edge].tail] ? NULL : is_head_side;
}

// Do both trees, cut at branch e, separate everything on its head side? Otherwise chords across the
// cut transmit part of the load.
static bool is_cut_by_trees(const struct ct_build *b, int edge)
{
    if (is_chord(b, edge))
        return false;
    bool *cut[2];
    for (int k = 0; k < 2; k++) {
        const struct ct_tree *t = k ? &b->R : &b->T;
        cut[k] = CT_NEWN(b->arena, bool, b->topology->nnode);
        if (t->is_branch[edge])
            mark_outboard(t, edge, cut[k]);
    }
    for (size_t e = 0; e < b->topology->nedge; e++) {
        const int tail = b->topology->wiring[e].tail, head = b->topology->wiring[e].head;
        const bool is_open
            = b->topology->edge[e].kind != CT_EDGE_ARM && is_link(b, e) && is_chord(b, (int)e);
        // the force of a chord is internal if both trees cut off both of its ends
        if (is_open && (cut[0][tail] || cut[1][tail] || cut[0][head] || cut[1][head])
            && !(cut[0][tail] && cut[1][tail] && cut[0][head] && cut[1][head]))
            return false;
    }
    return true;
}

// Force and torque of an edge in no loop, by the equilibrium of all nodes on its head side,
// independent of the trees. About the origin P of its head they are sum f and sum (r - P) x f + t,
// with f and t the net force and torque of a node.
static void sum_over_side(struct ct_build *b, int edge, const bool *is_head_side, ct_ex3 *force,
                          ct_ex3 *torque)
{
    const int head = b->topology->wiring[edge].head;
    const bool is_inboard = is_head_side[0]; // ground is on the head side: take the other side
    *force = *torque = zero3;
    for (int node = 1; node < (int)b->topology->nnode; node++) {
        if (is_head_side[node] == is_inboard)
            continue;
        const ct_ex3 f = own_force(b, node);
        add(b, force, f);
        add(b, torque, own_torque(b, node));
        if (!ct_ex3_is_zero(f) && node != head)
            add(b, torque, ct_ex3_cross(b->x, ct_path_position(b, head, node), f));
    }
    if (is_inboard) {
        *force = ct_ex3_neg(b->x, *force);
        *torque = ct_ex3_neg(b->x, *torque);
    }
}

static ct_ex3 part_along(struct ct_build *b, ct_ex3 v, ct_ex3 n)
{
    return ct_ex3_scale(b->x, ct_ex3_dot(b->x, v, n), n);
}

// Adds the out-of-plane components. The rows of chords are in the plane, so that these components
// come from the equilibrium of one side.
static void complete(struct ct_build *b, int edge, ct_ex3 *force, ct_ex3 *torque)
{
    const bool *is_head_side = head_side(b, edge);
    ct_ex3 f, t;
    if (!is_head_side)
        return;
    sum_over_side(b, edge, is_head_side, &f, &t);
    const ct_ex3 n = b->topology->plane[2];
    take(b, force, part_along(b, *force, n));
    add(b, force, part_along(b, f, n));
    *torque = part_along(b, *torque, n);
    if (b->topology->edge[edge].has_rotation) {
        add(b, torque, t);
        take(b, torque, part_along(b, t, n));
    }
}

void ct_reaction_of_edge(struct ct_build *b, int edge, ct_ex3 *force, ct_ex3 *torque)
{
    sum_over_trees(b, edge, force, torque);
    if (b->topology->is_planar && !is_cut_by_trees(b, edge))
        complete(b, edge, force, torque);
}

// ---- the joint ----------------------------------------------------------------------------------

void ct_reaction_derive(struct ct_build *b, int joint, ct_ex3 *force, ct_ex3 *torque)
{
    const int edge = b->topology->edge_of_joint[joint];
    const bool in_T = b->T.is_branch[edge], in_R = b->R.is_branch[edge];
    ct_reaction_of_edge(b, edge, force, torque);
    for (size_t i = 0; i < b->loads->nload; i++)
        if (b->loads->load[i].self == b->topology->edge[edge].self) {
            if (!in_T)
                add(b, force, b->loads->load[i].force);
            if (!in_R)
                add(b, torque, b->loads->load[i].torque);
        }
    for (size_t i = 0; i < b->rows->nmultiplier_wrench; i++) {
        const struct ct_multiplier_wrench *p = &b->rows->multiplier_wrench[i];
        if (p->joint != joint || p->head != b->topology->wiring[edge].head
            || p->tail != b->topology->wiring[edge].tail)
            continue; // rows of the weld after a joint have its number, too
        const ct_ex lam = b->eqs->row[p->row].lam;
        add(b, force, ct_ex3_scale(b->x, lam, p->force));
        add(b, torque, ct_ex3_scale(b->x, lam, p->torque));
    }
}

bool ct_reaction_is_known(const struct ct_build *b, int joint, bool is_force, int i)
{
    const int edge = b->topology->edge_of_joint[joint];
    return !b->topology->edge[edge].self->cls->motion
        || ct_reaction_of_edge_is_known(b, edge, is_force, i);
}

bool ct_reaction_of_edge_is_known(const struct ct_build *b, int edge, bool is_force, int i)
{
    return !b->topology->is_planar
        || is_of_plane(b, b->topology->wiring[edge].tail, is_force, i)
        || is_cut_by_trees(b, edge) || head_side(b, edge);
}
