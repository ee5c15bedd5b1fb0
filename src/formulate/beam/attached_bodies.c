// See attached_bodies.h.
#include "formulate/beam/attached_bodies.h"

#include <math.h>

// Is it a frame of the beam beyond its base? With a frame on the chord the first section counts, as
// it rotates relative to the base.
static bool is_beyond(const struct ct_build *b, const struct ct_flexible *f, int frame)
{
    const int own = f->beam->is_chord ? -1 : b->model->body[f->body].frame;
    return frame >= 0 && frame != own && b->model->frame[frame].body == f->body;
}

static bool is_weld(const struct ct_instance *joint)
{
    return joint->from >= 0 && joint->cls->motion && joint->cls->nfree == 0;
}

double *ct_attached_bodies_find(const struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_model *m = b->model;
    double *place = CT_NEWN(b->ctx->scratch, double, m->nbody);
    for (size_t i = 0; i < m->nbody; i++)
        place[i] = NAN;
    for (bool grew = true; grew;) {
        grew = false;
        for (size_t i = 0; i < 2 * m->njoint; i++) {
            const struct ct_instance *j = &m->joint[i / 2];
            const int at = i % 2 ? j->from : j->to, to = i % 2 ? j->to : j->from;
            if (!is_weld(j))
                continue;
            const int body = m->frame[to].body;
            const double x = is_beyond(b, f, at)
                               ? ct_ex_value(b->x, m->frame[at].at.e[0], b->value)
                               : place[m->frame[at].body];
            if (isnan(x) || body == 0 || m->body[body].beam || !isnan(place[body]))
                continue;
            place[body] = x;
            grew = true;
        }
    }
    return place;
}

bool ct_attached_bodies_are_loaded(const struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_model *m = b->model;
    const double *place = ct_attached_bodies_find(b, f);
    for (size_t i = 0; i < m->njoint + m->nforce; i++) {
        const bool is_joint = i < m->njoint;
        const struct ct_instance *j = is_joint ? &m->joint[i] : &m->force[i - m->njoint];
        const int ends[2] = {j->from, j->to};
        for (int k = 0; k < 2; k++) {
            if (ends[k] < 0
                || !(is_beyond(b, f, ends[k]) || !isnan(place[m->frame[ends[k]].body])))
                continue;
            const int other = ends[1 - k];
            const bool holds_rider
                = is_joint && is_weld(j)
               && (is_beyond(b, f, other) || !isnan(place[m->frame[other].body]));
            if (!holds_rider)
                return true;
        }
    }
    return false;
}
