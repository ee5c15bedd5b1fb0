// Diagnosis of a planar mechanism that does not close because the `axis` of one joint is
// missing or wrong.
//
// The normal of the plane is propagated from body to body: revolute joints about it, prismatic
// joints at right angles to it, and welds keep it. If all joints but one keep it, that one is
// most likely wrong. A mechanism with other joints is taken to be spatial.
#include "solve/initial/assembly.h"

#include <math.h>
#include <string.h>

struct plane {
    const struct ct_model *m;
    const struct ct_measure **measure; // (njoint) NULL: a weld
    double (*normal)[3];               // (nbody) in axes of the body
    bool *known;                       // (nbody)
};

// v = R v with the rotation by `angle` about the unit vector u.
static void rotate(const double u[3], double angle, double v[3])
{
    const double c = cos(angle), s = sin(angle),
                 along = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    const double w[3]
        = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    for (int i = 0; i < 3; i++)
        v[i] = c * v[i] + s * w[i] + (1 - c) * along * u[i];
}

static void numbers(const struct ct_model *m, ct_ex3 e, double v[3])
{
    for (int i = 0; i < 3; i++)
        v[i] = ct_model_number(m, e.e[i]);
}

// Transform components in a frame's axes into those in its body's axes; `back`: the reverse.
static void to_body(const struct ct_model *m, int frame, bool back, double v[3])
{
    const struct ct_frame *f = &m->frame[frame];
    for (int k = 0; k < f->nturn; k++) {
        double u[3];
        const struct ct_turn *t = &f->turn[back ? k : f->nturn - 1 - k];
        numbers(m, t->axis, u);
        rotate(u, (back ? -1 : 1) * ct_model_number(m, t->angle), v);
    }
}

// Does the joint keep motion in the plane with normal n, in axes of its frames, within the
// tolerance of the data?
static bool keeps_plane(const struct plane *p, size_t joint, const double n[3])
{
    const struct ct_measure *q = p->measure[joint];
    double a[3], along = 0;
    if (!q)
        return true;
    numbers(p->m, q->kind == CT_MEASURE_ANGLE ? q->about : q->along, a);
    for (int i = 0; i < 3; i++)
        along += a[i] * n[i];
    return q->kind == CT_MEASURE_ANGLE ? fabs(along) > 1 - ct_data_tolerance * ct_data_tolerance
                                       : fabs(along) < ct_data_tolerance;
}

// If the normal is known on one body of the joint, propagate it to the other, if the joint
// keeps it.
static bool propagate_normal(struct plane *p, size_t joint)
{
    const struct ct_instance *j = &p->m->joint[joint];
    const int frame[2] = {j->from, j->to};
    for (int end = 0; end < 2; end++) {
        const int here = p->m->frame[frame[end]].body, there = p->m->frame[frame[1 - end]].body;
        double n[3];
        if (!p->known[here] || p->known[there])
            continue;
        memcpy(n, p->normal[here], sizeof n);
        to_body(p->m, frame[end], true, n);
        if (!keeps_plane(p, joint, n))
            return false;
        to_body(p->m, frame[1 - end], false, n);
        memcpy(p->normal[there], n, sizeof n);
        p->known[there] = true;
        return true;
    }
    return false;
}

static bool is_misaligned(const struct plane *p, size_t joint)
{
    const struct ct_instance *j = &p->m->joint[joint];
    double n[3];
    memcpy(n, p->normal[p->m->frame[j->from].body], sizeof n);
    to_body(p->m, j->from, true, n);
    return !keeps_plane(p, joint, n);
}

// The only joint that does not keep the plane normal to the revolute joint `joint`. -1: there
// is none, there are several, or no other revolute joint shares that plane.
static int find_misaligned(struct plane *p, size_t joint)
{
    const struct ct_model *m = p->m;
    int misaligned = -1, nmisaligned = 0, naligned = 0;
    memset(p->known, 0, m->nbody * sizeof *p->known);
    const int body = m->frame[m->joint[joint].from].body;
    numbers(m, p->measure[joint]->about, p->normal[body]);
    to_body(m, m->joint[joint].from, false, p->normal[body]);
    p->known[body] = true;
    for (bool more = true; more;) {
        more = false;
        for (size_t i = 0; i < m->njoint; i++)
            more |= propagate_normal(p, i);
    }
    for (size_t i = 0; i < m->njoint; i++) {
        const struct ct_instance *j = &m->joint[i];
        if (!p->known[m->frame[j->from].body] || !p->known[m->frame[j->to].body])
            return -1;
        if (is_misaligned(p, i)) {
            misaligned = (int)i;
            nmisaligned++;
        } else {
            naligned += p->measure[i] && p->measure[i]->kind == CT_MEASURE_ANGLE;
        }
    }
    return nmisaligned == 1 && naligned > 1 ? misaligned : -1;
}

// The measure of each joint; false if one is not revolute, prismatic or weld.
static bool find_measures(struct ct_arena *a, struct plane *p)
{
    const struct ct_model *m = p->m;
    for (size_t i = 0; i < m->njoint; i++) {
        const struct ct_instance *j = &m->joint[i];
        struct ct_motion motion
            = {.ncoord = j->ncoord, .nfree = j->nfree, .quaternion = -1, .value = m->value};
        if (!j->cls->motion || j->local || m->body[m->frame[j->from].body].is_particle
            || m->body[m->frame[j->to].body].is_particle)
            return false;
        j->cls->motion(m->x, j, &motion);
        if (motion.nmeasure > 1 || motion.quaternion >= 0)
            return false;
        if (motion.nmeasure) {
            struct ct_measure *own = CT_NEW(a, struct ct_measure);
            *own = motion.measure[0];
            p->measure[i] = own;
        }
    }
    return true;
}

void ct_note_misaligned_joint(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *m)
{
    struct plane p = {.m = m,
                      .measure = CT_NEWN(a, const struct ct_measure *, m->njoint + 1),
                      .normal = (double(*)[3])CT_NEWN(a, double, 3 * m->nbody),
                      .known = CT_NEWN(a, bool, m->nbody)};
    if (!find_measures(a, &p))
        return;
    for (size_t i = 0; i < m->njoint; i++) {
        if (!p.measure[i] || p.measure[i]->kind != CT_MEASURE_ANGLE)
            continue;
        const int misaligned = find_misaligned(&p, i);
        if (misaligned < 0)
            continue;
        const bool is_hinge = p.measure[misaligned]->kind == CT_MEASURE_ANGLE;
        ct_note(ctx, m->joint[misaligned].mark, "joint '%s' %s: is its 'axis' right?",
                m->joint[misaligned].name,
                is_hinge ? "turns about another axis than all other hinges"
                         : "slides out of the plane in which all other joints move");
        return;
    }
}
