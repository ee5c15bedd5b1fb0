// Builds the linear graph of a model: nodes are frames, edges are components.  (formulation 1)
//
//   node 0       ground
//   node         one per frame; one per centre of mass that is not at its body's origin;
//                one between a joint that must be a branch and the weld that closes the loop
//   edge         body  0 -> centre of mass     arm  body -> point or centre of mass
//                joint from -> to              force, rod  from -> to (always chords)
#include "formulate/topology/linear_graph.h"
#include "formulate/beam/flexible_body.h"

#include <string.h>

static int add_node(struct ct_build *b, struct ct_topology *t, const char *name,
                    struct ct_mark mark, int body)
{
    const struct ct_node_info n = {.name = name,
                                   .mark = mark,
                                   .body = body,
                                   .is_particle = b->model->body[body].is_particle};
    CT_PUSH(b->arena, t->node, t->nnode, t->node_cap, n);
    return (int)t->nnode - 1;
}

static struct ct_edge_info *add_edge(struct ct_build *b, struct ct_topology *t,
                                     enum ct_edge_kind kind, const char *name,
                                     struct ct_mark mark, int tail, int head)
{
    static const struct ct_motion none;
    const struct ct_edge_info e = {.kind = kind,
                                   .name = name,
                                   .mark = mark,
                                   .S = ct_ex33_identity(),
                                   .trial = &none,
                                   .beam = -1};
    const struct ct_edge w = {tail, head};
    size_t nwiring = t->nedge;
    CT_PUSH(b->arena, t->wiring, nwiring, t->wiring_cap, w);
    CT_PUSH(b->arena, t->edge, t->nedge, t->edge_cap, e);
    return &t->edge[t->nedge - 1];
}

// ---- frames and bodies ------------------------------------------------------------------------

static ct_ex33 turns_to_matrix(struct ct_exs *x, const struct ct_turn *turn, int nturn)
{
    ct_ex33 R = ct_ex33_identity();
    for (int i = 0; i < nturn; i++) {
        const ct_ex33 A = ct_ex33_axis_angle(x, turn[i].axis, turn[i].angle);
        R = ct_ex33_mul(x, &R, &A);
    }
    return R;
}

// Adds the arm of a beam: the edge from its base to the section at x.
static struct ct_edge_info *add_section(struct ct_build *b, struct ct_topology *t,
                                        struct ct_flexible *f, const char *name,
                                        struct ct_mark mark, int node, ct_ex x)
{
    struct ct_edge_info *e = add_edge(b, t, CT_EDGE_ARM, name, mark, f->base, node);
    e->index = -1;
    e->beam = (int)(f - b->flexible);
    e->along = x;
    e->at = (ct_ex3){{x, CT_EX_ZERO, CT_EX_ZERO}};
    e->has_rotation = e->must_be_branch = true;
    return e;
}

// Adds a point of a beam. It rotates with its section. A rigid arm connects a point off the axis.
static void add_beam_point(struct ct_build *b, struct ct_topology *t, struct ct_flexible *f,
                           size_t frame)
{
    const struct ct_frame *p = &b->model->frame[frame];
    const ct_ex3 across = {{CT_EX_ZERO, p->at.e[1], p->at.e[2]}};
    const ct_ex33 S = turns_to_matrix(b->x, p->turn, p->nturn);
    const int node = t->node_of_frame[frame];
    if (ct_ex3_is_zero(across)) {
        struct ct_edge_info *e = add_section(b, t, f, p->name, p->mark, node, p->at.e[0]);
        e->index = (int)frame;
        e->S = S;
        return;
    }
    const char *name = ct_arena_printf(b->arena, "%s.section", p->name);
    const int section = add_node(b, t, name, p->mark, p->body);
    add_section(b, t, f, name, p->mark, section, p->at.e[0]);
    struct ct_edge_info *e = add_edge(b, t, CT_EDGE_ARM, p->name, p->mark, section, node);
    e->index = (int)frame;
    e->at = across;
    e->S = S;
    e->has_rotation = e->must_be_branch = true;
}

// Adds the base of a beam, which is its frame. If the frame lies on the chord, the section at x = 0
// rotates relative to it.
static void add_base(struct ct_build *b, struct ct_topology *t, struct ct_flexible *f)
{
    const struct ct_body *body = &b->model->body[f->body];
    const int own = t->node_of_frame[body->frame];
    f->base = own;
    if (!f->beam->is_chord)
        return;
    const char *name = body->instance.name;
    f->base = add_node(b, t, ct_arena_printf(b->arena, "%s.chord", name), body->instance.mark,
                       f->body);
    add_section(b, t, f, ct_arena_printf(b->arena, "%s.start", name), body->instance.mark, own,
                CT_EX_ZERO);
}

static void add_frames(struct ct_build *b, struct ct_topology *t)
{
    const struct ct_model *m = b->model;
    t->node_of_frame = CT_NEWN(b->arena, int, m->nframe);
    for (size_t i = 0; i < m->nframe; i++)
        t->node_of_frame[i]
            = add_node(b, t, m->frame[i].name, m->frame[i].mark, m->frame[i].body);
    for (size_t i = 0; i < b->nflexible; i++)
        add_base(b, t, &b->flexible[i]);
    for (size_t i = 0; i < m->nframe; i++) {
        const struct ct_frame *f = &m->frame[i];
        const int own = m->body[f->body].frame;
        if ((int)i == own)
            continue;
        struct ct_flexible *beam = ct_flexible_of(b, f->body);
        if (beam) {
            add_beam_point(b, t, beam, i);
            continue;
        }
        struct ct_edge_info *e = add_edge(b, t, CT_EDGE_ARM, f->name, f->mark,
                                          t->node_of_frame[own], t->node_of_frame[i]);
        e->index = (int)i;
        e->at = f->at;
        e->S = turns_to_matrix(b->x, f->turn, f->nturn);
        e->has_rotation = e->must_be_branch = true;
    }
}

// Adds the body edges, from ground to the centre of mass. In absolute coordinates they are
// branches.
static void add_bodies(struct ct_build *b, struct ct_topology *t)
{
    const struct ct_model *m = b->model;
    t->node_of_com = CT_NEWN(b->arena, int, m->nbody);
    for (size_t i = 1; i < m->nbody; i++) {
        const struct ct_body *body = &m->body[i];
        const struct ct_flexible *f = ct_flexible_of(b, (int)i);
        const int own = f ? f->base : t->node_of_frame[body->frame];
        t->node_of_com[i] = own;
        if (!ct_ex3_is_zero(body->com)) {
            const char *name = ct_arena_printf(b->arena, "%s.com", body->instance.name);
            const int com = add_node(b, t, name, body->instance.mark, (int)i);
            struct ct_edge_info *arm
                = add_edge(b, t, CT_EDGE_ARM, name, body->instance.mark, own, com);
            arm->index = -1;
            arm->at = body->com;
            arm->has_rotation = arm->must_be_branch = true;
            t->node_of_com[i] = com;
        }
        struct ct_edge_info *e = add_edge(b, t, CT_EDGE_BODY, body->instance.name,
                                          body->instance.mark, 0, t->node_of_com[i]);
        e->index = (int)i;
        e->self = &body->instance;
        e->has_rotation = true;
    }
}

// ---- joints and forces ------------------------------------------------------------------------

// Union-find over the edges that must be branches.
static int find(int *set, int i)
{
    while (set[i] != i)
        i = set[i] = set[set[i]];
    return i;
}

static bool is_motionless(const struct ct_instance *joint)
{
    return !joint->cls->motion;
}

static void add_joints(struct ct_build *b, struct ct_topology *t)
{
    const struct ct_model *m = b->model;
    t->edge_of_joint = CT_NEWN(b->arena, int, m->njoint + 1);
    int *set = CT_NEWN(b->arena, int, t->nnode + m->njoint);
    for (size_t i = 0; i < t->nnode + m->njoint; i++)
        set[i] = (int)i;
    for (size_t e = 0; e < t->nedge; e++)
        if (t->edge[e].must_be_branch)
            set[find(set, t->wiring[e].tail)] = find(set, t->wiring[e].head);
    for (size_t j = 0; j < m->njoint; j++) {
        const struct ct_instance *joint = &m->joint[j];
        t->edge_of_joint[j] = -1;
        if (joint->from < 0)
            continue; // a gear couples coordinates and connects no frames
        const int from = t->node_of_frame[joint->from];
        int to = t->node_of_frame[joint->to], closure = -1;
        if (joint->cls->always_branch) {
            if (find(set, from) == find(set, to)) {
                // a weld after the joint closes the loop
                closure = to;
                to = add_node(b, t, ct_arena_printf(b->arena, "%s.end", joint->name),
                              joint->mark, t->node[to].body);
            }
            set[find(set, from)] = find(set, to);
        }
        struct ct_edge_info *e
            = add_edge(b, t, CT_EDGE_JOINT, joint->name, joint->mark, from, to);
        e->index = (int)j;
        e->self = joint;
        e->has_rotation = !t->node[from].is_particle && !t->node[to].is_particle;
        e->must_be_branch = joint->cls->always_branch;
        e->never_branch = is_motionless(joint);
        t->edge_of_joint[j] = (int)t->nedge - 1;
        if (closure >= 0) {
            e = add_edge(b, t, CT_EDGE_CLOSURE,
                         ct_arena_printf(b->arena, "%s.closure", joint->name), joint->mark, to,
                         closure);
            e->index = (int)j;
            e->has_rotation = !t->node[closure].is_particle;
        }
    }
}

static void add_forces(struct ct_build *b, struct ct_topology *t)
{
    const struct ct_model *m = b->model;
    for (size_t i = 0; i < m->nforce; i++) {
        const struct ct_instance *f = &m->force[i];
        const int from = f->from < 0 ? 0 : t->node_of_frame[f->from];
        struct ct_edge_info *e
            = add_edge(b, t, CT_EDGE_FORCE, f->name, f->mark, from, t->node_of_frame[f->to]);
        e->index = (int)i;
        e->self = f;
        e->never_branch = true;
    }
}

// ---- motions and coordinates --------------------------------------------------------------------

// Motion of a body edge: position of the centre of mass in ground axes, and orientation. In a
// planar mechanism it has two lengths and an angle, after a constant rotation into the plane. A
// particle has a position only.
static void body_motion(struct ct_build *b, const struct ct_edge_info *e, struct ct_motion *m)
{
    struct ct_exs *x = b->x;
    if (b->topology->is_planar) {
        m->d
            = ct_ex3_add(x,
                         ct_ex3_scale(x, b->topology->layer[b->topology->node_of_com[e->index]],
                                      b->topology->plane[2]),
                         ct_ex3_add(x, ct_ex3_scale(x, m->coord[0], b->topology->plane[0]),
                                    ct_ex3_scale(x, m->coord[1], b->topology->plane[1])));
        ct_motion_measure_length(m, b->topology->plane[0]);
        ct_motion_measure_length(m, b->topology->plane[1]);
    } else {
        m->d = (ct_ex3){{m->coord[0], m->coord[1], m->coord[2]}};
        for (int i = 0; i < 3; i++) {
            double axis[3] = {0};
            axis[i] = 1;
            ct_motion_measure_length(m, ct_ex3_const(x, axis));
        }
    }
    if (b->model->body[e->index].is_particle)
        return;
    if (b->topology->is_planar) {
        ct_motion_add_rotation(m, b->topology->plane[2], m->coord[2]);
        ct_motion_measure_angle(m, b->topology->plane[2], b->topology->plane[0]);
        m->measure[2].w = ct_ex33_apply_t(x, &e->S, b->topology->plane[0]);
    } else {
        m->quaternion = 3;
        m->measure[m->nmeasure++].kind = CT_MEASURE_QUATERNION;
    }
}

static void count_coordinates(const struct ct_build *b, const struct ct_edge_info *e,
                              int *ncoord, int *nfree)
{
    const bool is_particle = e->kind == CT_EDGE_BODY && b->model->body[e->index].is_particle;
    *ncoord = *nfree = 0;
    if (e->kind == CT_EDGE_BODY) {
        *ncoord = b->topology->is_planar ? 3 - is_particle : is_particle ? 3 : 7;
        *nfree = b->topology->is_planar ? *ncoord : is_particle ? 3 : 6;
    } else if (e->kind == CT_EDGE_JOINT) {
        *ncoord = e->self->ncoord;
        *nfree = e->self->nfree;
    }
}

static bool depends(struct ct_exs *x, ct_ex3 v, ct_ex symbol)
{
    for (int i = 0; i < 3; i++)
        if (!ct_ex_is_zero(ct_ex_diff(x, v.e[i], symbol)))
            return true;
    return false;
}

static bool turns_depend(struct ct_exs *x, const struct ct_motion *m, int k, ct_ex symbol)
{
    if (m->quaternion >= 0 && k >= m->quaternion)
        return true;
    for (int i = 0; i < m->nturn; i++)
        if (!ct_ex_is_zero(ct_ex_diff(x, m->turn[i].angle, symbol)))
            return true;
    return false;
}

void ct_linear_graph_edge_motion(struct ct_build *b, const struct ct_edge_info *e,
                                 struct ct_motion *m)
{
    m->quaternion = -1;
    m->value = b->value;
    switch (e->kind) {
    case CT_EDGE_BODY:
        body_motion(b, e, m);
        break;
    case CT_EDGE_JOINT:
        if (e->self->cls->motion)
            e->self->cls->motion(b->x, e->self, m);
        break;
    case CT_EDGE_CLOSURE:
        ct_motion_lock_translation(b->x, m);
        ct_motion_lock_rotation(b->x, m);
        break;
    case CT_EDGE_ARM:
        m->d = e->at;
        break;
    case CT_EDGE_FORCE:
        break;
    }
}

// Name of a coordinate. Joints: as in signals. Bodies: position of the centre of mass, angle or
// quaternion.
static const char *coordinate_name(struct ct_build *b, const struct ct_edge_info *e,
                                   const struct ct_motion *m, int k)
{
    static const char *const orientation[] = {"p0", "p1", "p2", "p3"};
    const int nplace = b->topology->is_planar ? 2 : 3;
    if (e->kind == CT_EDGE_BODY)
        return ct_arena_printf(b->arena, "%s.%s", e->name,
                               k < nplace               ? ct_plane_axis_name(b, k)
                               : b->topology->is_planar ? "angle"
                                                        : orientation[k - nplace]);
    return m->ncoord == 1 ? ct_arena_printf(b->arena, "%s.q", e->name)
                          : ct_arena_printf(b->arena, "%s.q%d", e->name, k + 1);
}

// Adds the coordinates of an edge. Trial symbols show whether each enters the translation or the
// rotation.
static void add_coordinates(struct ct_build *b, struct ct_topology *t, int edge)
{
    struct ct_edge_info *e = &t->edge[edge];
    struct ct_motion m = {0};
    count_coordinates(b, e, &m.ncoord, &m.nfree);
    for (int k = 0; k < m.ncoord; k++)
        m.coord[k] = ct_ex_sym(b->x, CT_SYM_LOCAL, "trial", (uint32_t)k);
    ct_linear_graph_edge_motion(b, e, &m);
    e->first_coordinate = (int)t->ncoordinate;
    e->ncoordinate = m.ncoord;
    const struct ct_value *driver = NULL;
    if (e->kind == CT_EDGE_JOINT)
        driver = ct_instance_value(e->self, "motion");
    for (int k = 0; k < m.ncoord; k++) {
        const char *name = coordinate_name(b, e, &m, k);
        struct ct_coordinate c = {.name = name, .edge = edge, .index = k};
        c.q = c.u = c.driver = -1;
        c.in_translation = depends(b->x, m.d, m.coord[k]);
        c.in_rotation = e->has_rotation && turns_depend(b->x, &m, k, m.coord[k]);
        c.is_driven = driver && driver->given && (size_t)k < driver->n && !driver->hole[k];
        CT_PUSH(b->arena, t->coordinate, t->ncoordinate, t->coordinate_cap, c);
        const bool in_quaternion = m.quaternion >= 0 && k >= m.quaternion;
        if (!c.is_driven
            && !(in_quaternion
                 && k == m.quaternion)) { // four parameters, three degrees of freedom
            e->weight_t += c.in_translation;
            e->weight_r += c.in_rotation;
        }
    }
    e->trial = ct_motion_keep(b->arena, &m);
}

// ---- the stage ----------------------------------------------------------------------------------

void ct_linear_graph_derive(struct ct_build *b, bool planar_allowed)
{
    struct ct_topology *t = CT_NEW(b->arena, struct ct_topology);
    b->topology = t;
    ct_flexible_create(b);
    add_frames(b, t);
    add_bodies(b, t);
    add_joints(b, t);
    add_forces(b, t);
    for (size_t e = 0; e < t->nedge; e++) // joints first: planarity depends on them
        if (t->edge[e].kind == CT_EDGE_JOINT || t->edge[e].kind == CT_EDGE_CLOSURE)
            add_coordinates(b, t, (int)e);
    ct_planarity_detect(b, t, planar_allowed);
    ct_flexible_choose_deformation(b);
    for (size_t e = 0; e < t->nedge; e++)
        if (t->edge[e].kind == CT_EDGE_BODY) {
            if (t->is_planar && !t->node[t->wiring[e].head].is_particle)
                t->edge[e].S = t->reference_axes[t->wiring[e].head];
            add_coordinates(b, t, (int)e);
        }
    t->graph = (struct ct_graph){(int)t->nnode, (int)t->nedge, t->wiring};
}
