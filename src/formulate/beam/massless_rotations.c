// Rotations of a beam's nodes that move no mass; see massless_rotations.h.
//
// Lumped masses without rotary inertia, and sections of Timoshenko's theory without it, leave
// rotations without inertia. If no moment acts on them either, static condensation gives them from
// the other freedoms, K_rr r + K_rt t = 0, and they are not coordinates. A moment arises from a
// joint that constrains the rotation of the section, a torque, an arm off the axis, or a force
// between nodes. Rotations with a moment stay coordinates.
#include "formulate/beam/massless_rotations.h"
#include "formulate/beam/section_properties.h"

#include <math.h>
#include <string.h>

enum { RX = CT_FREEDOM_RX, RZ = CT_FREEDOM_RZ, NKIND = CT_NODE_FREEDOM };
enum { NAXIS = 3, ALL = 7 }; // Definition: axes of the beam, and a bit for each

struct node_moments {
    struct ct_build *b;
    const struct ct_flexible *f;
    unsigned *about; // by node: axes about which moments can act
};

// ---- what acts on a point -----------------------------------------------------------------------

// The axis of the beam that v, in axes of the frame, points along; -1: none.
static int axis_along(struct ct_build *b, const struct ct_frame *frame, ct_ex3 v)
{
    for (int i = frame->nturn; i-- > 0;) {
        const ct_ex33 R = ct_ex33_axis_angle(b->x, frame->turn[i].axis, frame->turn[i].angle);
        v = ct_ex33_apply(b->x, &R, v);
    }
    for (int i = 0; i < NAXIS; i++)
        if (fabs(ct_ex_value(b->x, v.e[i], b->value)) > 1 - CT_DATA_ROUNDOFF)
            return i;
    return -1;
}

static unsigned about_normal(const struct node_moments *w)
{
    const struct ct_build *b = w->b;
    const ct_ex3 n = ct_ex33_apply_t(b->x, &b->topology->reference_axes[w->f->base],
                                     b->topology->plane[2]);
    unsigned bits = 0;
    for (int i = 0; i < NAXIS; i++)
        if (fabs(ct_ex_value(b->x, n.e[i], b->value)) > 0.5)
            bits |= 1u << i;
    return bits;
}

// Moments that joint j can transmit to the section at the frame.
static unsigned joint_moments(const struct node_moments *w, size_t j, const struct ct_frame *at)
{
    struct ct_build *b = w->b;
    const struct ct_instance *self = &b->model->joint[j];
    const int other
        = b->model->frame[&b->model->frame[self->from] == at ? self->to : self->from].body;
    if (b->model->body[other].is_particle
        || (self->cls->is_moment_free && !ct_joint_is_active(self)))
        return 0;
    if (b->topology->edge_of_joint[j] < 0 || ct_joint_is_active(self))
        return ALL;
    const struct ct_edge_info *e = &b->topology->edge[b->topology->edge_of_joint[j]];
    if (e->must_be_branch)
        return ALL;
    if (e->weight_r == (b->topology->is_planar ? 1 : NAXIS))
        return b->topology->is_planar ? ALL & ~about_normal(w) : 0;
    if (e->weight_r != 1 || e->trial->nturn != 1)
        return ALL;
    const int axis = axis_along(b, at, e->trial->turn[0].axis);
    return axis < 0 ? ALL : ALL & ~(1u << axis);
}

// Moments at a frame; false if nothing acts there.
static bool moments_at(const struct node_moments *w, size_t frame, unsigned *about)
{
    const struct ct_model *m = w->b->model;
    bool any = false;
    *about = 0;
    for (size_t j = 0; j < m->njoint; j++)
        if (m->joint[j].from == (int)frame || m->joint[j].to == (int)frame) {
            *about |= joint_moments(w, j, &m->frame[frame]);
            any = true;
        }
    for (size_t i = 0; i < m->nforce; i++)
        if (m->force[i].from == (int)frame || m->force[i].to == (int)frame) {
            *about |= m->force[i].cls->is_moment_free ? 0 : ALL;
            any = true;
        }
    return any;
}

// ---- nodes --------------------------------------------------------------------------------------

static void mark_frame(struct node_moments *w, size_t frame)
{
    struct ct_station s;
    const struct ct_frame *p = &w->b->model->frame[frame];
    unsigned about;
    if (!moments_at(w, frame, &about))
        return;
    ct_flexible_station(w->b, w->f, p->at.e[0], CT_AXIAL_LINEAR, &s);
    const bool at_start = ct_ex_is_zero(s.xi), at_end = ct_ex_same(s.xi, CT_EX_ONE);
    if (!ct_ex_is_zero(p->at.e[1]) || !ct_ex_is_zero(p->at.e[2]))
        about = ALL;
    if (!at_start && !at_end && w->f->beam->theory == CT_BEAM_EULER_BERNOULLI)
        about = ALL; // forces between nodes give moments
    w->about[s.element] |= at_end ? 0 : about;
    w->about[s.element + 1] |= at_start ? 0 : about;
}

// ---- the section at the start -------------------------------------------------------------------

// Axes of the beam, as bits, about which joint j leaves the section at the frame free to rotate.
static unsigned turns_freely(const struct node_moments *w, size_t j, const struct ct_frame *at)
{
    struct ct_build *b = w->b;
    const struct ct_instance *self = &b->model->joint[j];
    const bool is_custom = self->cls->ncoord < 0;
    if (b->topology->edge_of_joint[j] < 0 || is_custom
        || ct_instance_value(self, "motion")->given)
        return 0;
    const struct ct_edge_info *e = &b->topology->edge[b->topology->edge_of_joint[j]];
    if (e->weight_r == (b->topology->is_planar ? 1 : NAXIS))
        return b->topology->is_planar ? about_normal(w) : ALL;
    unsigned about = 0; // two of a universal joint, as the frames coincide
    for (int i = 0; i < e->trial->nturn && e->weight_r == e->trial->nturn; i++) {
        const int axis = axis_along(b, at, e->trial->turn[i].axis);
        about |= axis < 0 ? 0 : 1u << axis;
    }
    return about;
}

// Does the frame move with the section at the start?
static bool is_at_start(const struct node_moments *w, size_t frame)
{
    struct ct_station s;
    ct_flexible_station(w->b, w->f, w->b->model->frame[frame].at.e[0], CT_AXIAL_LINEAR, &s);
    return s.element == 0 && !ct_ex_same(s.xi, CT_EX_ONE);
}

int ct_flexible_bare_joint(struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_model *m = b->model;
    const struct node_moments w = {.b = b, .f = f};
    const unsigned bends = (f->deformation & CT_BEAM_BENDING_Y ? 2 : 0)
                         | (f->deformation & CT_BEAM_BENDING_Z ? 4 : 0);
    unsigned about = 0;
    int only = -1;
    if (!bends || f->beam->modes || f->beam->nshape || f->beam->is_chord
        || (!f->beam->is_lumped && f->beam->theory != CT_BEAM_TIMOSHENKO))
        return -1;
    for (size_t j = 0; j < m->njoint; j++) {
        const int end[2] = {m->joint[j].from, m->joint[j].to};
        for (int i = 0; i < 2; i++) {
            if (m->frame[end[i]].body != f->body || !is_at_start(&w, (size_t)end[i]))
                continue;
            if (only >= 0 || end[i] != m->body[f->body].frame)
                return -1;
            only = (int)j;
            about = turns_freely(&w, j, &m->frame[end[i]]);
        }
    }
    for (int axis = 1; axis < NAXIS; axis++)
        if (about & bends & 1u << axis && ct_ex_is_zero(ct_flexible_rotary(f, axis).value))
            return only;
    return -1;
}

// ---- all ----------------------------------------------------------------------------------------

bool ct_flexible_find_massless_rotations(struct ct_build *b, const struct ct_flexible *f,
                                         bool *is_condensed)
{
    const int nnode = f->beam->nelement + 1;
    struct node_moments w = {b, f, CT_NEWN(b->ctx->scratch, unsigned, nnode)};
    const bool turns_apart = f->beam->is_lumped || f->beam->theory == CT_BEAM_TIMOSHENKO;
    bool any = false, marked = false;
    memset(is_condensed, 0, (size_t)(NKIND * nnode) * sizeof *is_condensed);
    if (b->options->keeps_all_deformations && f->formulation != CT_BEAM_LINEAR)
        return false; // analyses may omit masses, and then further loads matter
    for (int axis = 0; axis < NAXIS && f->deformation; axis++) {
        const bool is_massless
            = ct_ex_is_zero(ct_flexible_rotary(f, axis).value) && (axis == 0 || turns_apart);
        if (!is_massless)
            continue;
        for (size_t i = 0; i < b->model->nframe && !marked; i++)
            if (b->model->frame[i].body == f->body)
                mark_frame(&w, i);
        marked = true;
        for (int node = 0; node < nnode; node++)
            any |= is_condensed[NKIND * node + RX + axis] = !(w.about[node] & 1u << axis);
        for (int node = 0; node < nnode && axis == 0; node++)
            any |= is_condensed[NKIND * node + CT_FREEDOM_RM] = f->beam->has_quadratic_twist;
    }
    return any;
}
