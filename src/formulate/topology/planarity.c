// Planar mechanisms, class K: do all bodies move parallel to one plane?  (formulation 5.6 d)
#include "formulate/topology/linear_graph.h"

#include "formulate/beam/deformation_selection.h"
#include "formulate/beam/flexible_body.h"
#include "graph/reach.h"

#include <math.h>

static void value3(const struct ct_build *b, ct_ex3 v, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = ct_ex_value(b->x, v.e[i], b->value);
}

static bool is_parallel(const double a[3], const double n[3])
{
    const double c = a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
    double d = 0;
    for (int i = 0; i < 3; i++)
        d = fmax(d, fabs(a[i] - c * n[i]));
    return d < CT_DATA_ROUNDOFF;
}

static bool is_same(const double a[3], const double n[3])
{
    return is_parallel(a, n) && a[0] * n[0] + a[1] * n[1] + a[2] * n[2] > 0;
}

static bool is_across(const double a[3], const double n[3])
{
    return fabs(a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) < CT_DATA_ROUNDOFF;
}

// Is the motion of joint e parallel to the plane with normal n (in axes of `from`)?
static bool joint_is_planar(struct ct_build *b, const struct ct_edge_info *e, const double n[3])
{
    const struct ct_motion *m = e->trial;
    double v[3];
    if (m->quaternion >= 0 && e->has_rotation)
        return false;
    for (int i = 0; i < m->nturn && e->has_rotation; i++) {
        value3(b, m->turn[i].axis, v);
        if (!is_parallel(v, n))
            return false;
    }
    for (int k = 0; k < m->ncoord; k++) {
        ct_ex3 p;
        for (int i = 0; i < 3; i++)
            p.e[i] = ct_ex_diff(b->x, m->d.e[i], m->coord[k]);
        if (ct_ex3_is_zero(p))
            continue;
        for (int i = 0; i < 3; i++) // a direction that depends on q is not accepted
            if (ct_ex_kinds(b->x, p.e[i]) & 1u << CT_SYM_LOCAL)
                return false;
        value3(b, p, v);
        if (!is_across(v, n))
            return false;
    }
    return true;
}

// Does the edge define the relative orientation of its frames? Arms and joints with motion do.
static bool holds_axes(const struct ct_edge_info *e)
{
    return e->kind != CT_EDGE_BODY && e->kind != CT_EDGE_FORCE && !e->never_branch;
}

// Edges that define orientations, in an order that propagates them from known nodes to others.
// with_rotation: only edges with rotation.
static int *spread_axes(struct ct_build *b, bool with_rotation, bool *known, int *n)
{
    const struct ct_graph g
        = {(int)b->topology->nnode, (int)b->topology->nedge, b->topology->wiring};
    bool *usable = CT_NEWN(b->arena, bool, b->topology->nedge + 1);
    for (size_t i = 0; i < b->topology->nedge; i++)
        usable[i] = holds_axes(&b->topology->edge[i])
                 && (!with_rotation || b->topology->edge[i].has_rotation);
    int *order = CT_NEWN(b->arena, int, b->topology->nnode);
    *n = ct_graph_spread(b->arena, &g, usable, known, order);
    return order;
}

// Rotation from the axes of each node to ground axes with all joint coordinates at zero. Rotations
// about the normal do not change its components. NULL: no joint connects the node to ground.
static ct_ex33 **axes_at_rest(struct ct_build *b)
{
    ct_ex33 **U = CT_NEWN(b->arena, ct_ex33 *, b->topology->nnode);
    bool *known = CT_NEWN(b->arena, bool, b->topology->nnode);
    for (size_t i = 0; i < b->topology->nnode; i++)
        if (i == 0
            || b->topology->node[i].is_particle) { // axes of particles are parallel to ground
            U[i] = CT_NEW(b->arena, ct_ex33);
            *U[i] = ct_ex33_identity();
            known[i] = true;
        }
    int n;
    const int *order = spread_axes(b, true, known, &n);
    for (int k = 0; k < n; k++) {
        const struct ct_edge_info *e = &b->topology->edge[order[k]];
        const struct ct_edge ends = b->topology->wiring[order[k]];
        const int from = U[ends.tail] ? ends.tail : ends.head,
                  to = from == ends.tail ? ends.head : ends.tail;
        const ct_ex33 S = from == ends.tail ? e->S : ct_ex33_transpose(&e->S);
        U[to] = CT_NEW(b->arena, ct_ex33);
        *U[to] = ct_ex33_mul(b->x, U[from], &S);
    }
    return U;
}

// Out-of-plane component of the vector of an arm or a joint [m]. Coordinates do not change it.
static ct_ex normal_component(struct ct_build *b, int edge, const ct_ex33 *U)
{
    const struct ct_edge_info *e = &b->topology->edge[edge];
    const ct_ex zero[CT_MAX_COORD] = {{0}};
    ct_ex3 d = e->at;
    for (int i = 0; i < 3 && e->kind != CT_EDGE_ARM; i++)
        d.e[i] = ct_ex_subst(b->x, e->trial->d.e[i], e->trial->coord, zero,
                             (size_t)e->ncoordinate);
    return ct_ex3_dot(b->x, ct_ex33_apply_t(b->x, U, b->topology->plane[2]), d);
}

static double longest_arm(const struct ct_build *b)
{
    double longest = 0, at[3];
    unsigned char *decided = b->x->decided;
    b->x->decided = NULL; // a scale of round-off only: the equations do not depend on it
    for (size_t i = 0; i < b->topology->nedge; i++) {
        value3(b, b->topology->edge[i].at, at);
        longest = fmax(longest, sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]));
    }
    b->x->decided = decided;
    return longest;
}

// Positions of the nodes along the normal, if all joints are planar.
static void find_layers(struct ct_build *b, struct ct_topology *t, ct_ex33 *const *U)
{
    bool *known = CT_NEWN(b->arena, bool, t->nnode),
         *placed = CT_NEWN(b->arena, bool, t->nnode);
    t->layer = CT_NEWN(b->arena, ct_ex, t->nnode);
    known[0] = placed[0] = true;
    int n;
    const int *order = spread_axes(b, false, known, &n);
    for (int k = 0; k < n; k++) {
        const int tail = t->wiring[order[k]].tail, head = t->wiring[order[k]].head;
        const ct_ex up = normal_component(b, order[k], U[tail]);
        if (placed[tail])
            t->layer[head] = ct_ex_add(b->x, t->layer[tail], up);
        else
            t->layer[tail] = ct_ex_sub(b->x, t->layer[head], up);
        placed[tail] = placed[head] = true;
    }
}

// Is every joint planar, and do the loops close in the direction of the normal? Every body must be
// connected by joints.
static bool is_plane(struct ct_build *b, struct ct_topology *t, ct_ex33 *const *U)
{
    double(*n)[3] = ct_arena_calloc(b->arena, t->nnode, sizeof *n);
    const double allowed = CT_SAME_PLACE * longest_arm(b);
    for (size_t i = 0; i < t->nnode; i++) {
        if (!U[i])
            return false;
        value3(b, ct_ex33_apply_t(b->x, U[i], t->plane[2]), n[i]);
    }
    find_layers(b, t, U);
    for (size_t i = 0; i < t->nedge; i++) {
        const struct ct_edge_info *e = &t->edge[i];
        const int tail = t->wiring[i].tail, head = t->wiring[i].head;
        if (!holds_axes(e))
            continue;
        const ct_ex end = ct_ex_add(b->x, t->layer[tail], normal_component(b, (int)i, U[tail]));
        if (fabs(ct_ex_value(b->x, end, b->value) - ct_ex_value(b->x, t->layer[head], b->value))
            > allowed)
            return false;
        if (e->kind != CT_EDGE_ARM && e->has_rotation && !is_same(n[tail], n[head]))
            return false;
        if (e->kind == CT_EDGE_JOINT && !joint_is_planar(b, e, n[tail]))
            return false;
    }
    return true;
}

// Stores the node rotations; identity for nodes where the normal has the same components as in
// ground.
static void keep_reference_axes(struct ct_build *b, struct ct_topology *t, ct_ex33 **U)
{
    double g[3], n[3];
    value3(b, t->plane[2], g);
    t->reference_axes = CT_NEWN(b->arena, ct_ex33, t->nnode);
    for (size_t i = 0; i < t->nnode; i++) {
        value3(b, ct_ex33_apply_t(b->x, U[i], t->plane[2]), n);
        t->reference_axes[i] = is_same(n, g) ? ct_ex33_identity() : *U[i];
    }
}

// Takes an axis (ground components) as normal if the mechanism is planar about it. Of its two
// senses the one along +z, +y or +x is preferred, the usual convention.
static bool takes_normal(struct ct_build *b, struct ct_topology *t, ct_ex33 **U, ct_ex3 axis)
{
    double n[3];
    value3(b, axis, n);
    const int most = fabs(n[2]) > 0.5 ? 2 : fabs(n[1]) > 0.5 ? 1 : 0;
    t->plane[2] = n[most] < 0 ? ct_ex3_neg(b->x, axis) : axis;
    if (!is_plane(b, t, U) || !ct_deformation_keeps_plane(b, U, &t->is_spatial_for_beams))
        return false;
    keep_reference_axes(b, t, U);
    return true;
}

// Finds the normal. The only candidate is the axis of the first rotating joint, in ground
// components; if there is none, a bending axis of a beam.
static bool find_normal(struct ct_build *b, struct ct_topology *t)
{
    ct_ex33 **U = axes_at_rest(b);
    for (size_t i = 0; i < t->nedge; i++) {
        const struct ct_edge_info *e = &t->edge[i];
        const ct_ex33 *A = U[t->wiring[i].tail];
        if (e->kind == CT_EDGE_JOINT && e->has_rotation && e->trial->nturn)
            return A && takes_normal(b, t, U, ct_ex33_apply(b->x, A, e->trial->turn[0].axis));
    }
    for (int axis = 2; axis > 0 && b->nflexible; axis--) {
        const ct_ex33 *A = U[b->flexible[0].base];
        if (A
            && takes_normal(b, t, U,
                            (ct_ex3){{A->e[3 * axis], A->e[1 + 3 * axis], A->e[2 + 3 * axis]}}))
            return true;
    }
    return false;
}

const char *ct_plane_axis_name(const struct ct_build *b, int i)
{
    static const char *const letter[] = {"x", "y", "z"}, *const own[] = {"e1", "e2", "e3"};
    if (!b->topology->is_planar)
        return letter[i];
    for (int k = 0; k < 3; k++) {
        double axis[3] = {0}, v[3];
        axis[k] = 1;
        value3(b, b->topology->plane[i], v);
        if (is_same(v, axis))
            return letter[k];
    }
    return own[i];
}

void ct_planarity_detect(struct ct_build *b, struct ct_topology *t, bool allowed)
{
    const double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int i = 0; i < 3; i++)
        t->plane[i] = ct_ex3_const(b->x, axes + 3 * i);
    t->keeps_plane = find_normal(b, t);
    t->normal = t->plane[2];
    if (!allowed || !t->keeps_plane) {
        t->plane[2] = ct_ex3_const(b->x, axes + 6);
        return;
    }
    t->is_planar = b->eqs->is_planar = true;
    ct_axes_normal(b->x, t->plane[2], b->value, &t->plane[0], &t->plane[1]);
    double v[3];
    value3(b, t->plane[2], v);
    const char *why = ct_arena_printf(
        b->arena, "every joint turns about (%.6g, %.6g, %.6g) or slides across it", v[0], v[1],
        v[2]);
    ct_build_note_left_out(b, "motion out of the plane and its constraint rows", why);
}
