// See deformation_selection.h.
#include "formulate/beam/deformation_selection.h"
#include "formulate/beam/beam_field.h"

#include <math.h>

static ct_ex3 normal_at(struct ct_build *b, const ct_ex33 *U)
{
    return ct_ex33_apply_t(b->x, U, b->topology->plane[2]);
}

// Is v normal to n for any time and state?
static bool is_perpendicular(struct ct_build *b, ct_ex3 v, ct_ex3 n)
{
    const ct_ex along = ct_ex3_dot(b->x, v, n);
    const unsigned constant = 1u << CT_SYM_PARAM;
    double size = 0;
    if (ct_ex_kinds(b->x, along) & ~constant)
        return false;
    for (int i = 0; i < 3; i++)
        if (!(ct_ex_kinds(b->x, v.e[i]) & ~constant))
            size = fmax(size, fabs(ct_ex_value(b->x, v.e[i], b->value)));
    return fabs(ct_ex_value(b->x, along, b->value)) <= CT_DATA_ROUNDOFF * size;
}

static bool is_parallel(struct ct_build *b, ct_ex3 v, ct_ex3 n)
{
    double most = 0;
    for (int i = 0; i < 3; i++)
        most = fmax(most, fabs(ct_ex_value(b->x, n.e[i], b->value)));
    // if n is along a coordinate axis, the other two components decide; else the cross product
    if (most < 1 - CT_DATA_ROUNDOFF) {
        const ct_ex3 c = ct_ex3_cross(b->x, v, n);
        for (int i = 0; i < 3; i++)
            if (ct_ex_kinds(b->x, c.e[i]) & ~(1u << CT_SYM_PARAM)
                || ct_ex_value(b->x, c.e[i], b->value) != 0)
                return false;
        return true;
    }
    for (int i = 0; i < 3; i++)
        if (fabs(ct_ex_value(b->x, n.e[i], b->value)) < 0.5 && !ct_ex_is_zero(v.e[i])
            && (ct_ex_kinds(b->x, v.e[i]) & ~(1u << CT_SYM_PARAM)
                || ct_ex_value(b->x, v.e[i], b->value) != 0))
            return false;
    return true;
}

static bool is_axis(struct ct_build *b, ct_ex3 n)
{
    double most = 0;
    for (int i = 0; i < 3; i++)
        most = fmax(most, fabs(ct_ex_value(b->x, n.e[i], b->value)));
    return most > 1 - CT_DATA_ROUNDOFF;
}

static bool loads_keep_plane(struct ct_build *b, ct_ex33 *const *U)
{
    const struct ct_model *m = b->model;
    for (size_t i = 0; i < m->nforce; i++) {
        const struct ct_instance *self = &m->force[i];
        const bool is_torque = self->cls->applied == CT_APPLIED_TORQUE;
        if (self->cls->applied) {
            const struct ct_value *v = ct_instance_value(self, "value");
            const struct ct_value *in = ct_instance_value(self, "in");
            const ct_ex3 value = {{v->e[0], v->e[1], v->e[2]}};
            const ct_ex3 n = in->given ? normal_at(b, U[b->topology->node_of_frame[in->frame]])
                                       : b->topology->plane[2];
            if (is_torque ? !is_parallel(b, value, n) : !is_perpendicular(b, value, n))
                return false;
        } else if (self->from >= 0
                   && !is_axis(b, normal_at(b, U[b->topology->node_of_frame[self->from]]))) {
            return false; // a bushing with oblique axes gives out-of-plane forces
        }
    }
    return true;
}

// Is the normal a principal axis of each rigid body, and is everything in one layer?
static bool masses_keep_plane(struct ct_build *b, ct_ex33 *const *U, double allowed)
{
    const struct ct_model *m = b->model;
    for (size_t i = 1; i < b->topology->nnode; i++)
        if (fabs(ct_ex_value(
                b->x, ct_ex_sub(b->x, b->topology->layer[i], b->topology->layer[0]), b->value))
            > allowed)
            return false;
    for (size_t i = 1; i < m->nbody; i++) {
        const ct_ex *I = m->body[i].inertia;
        const ct_ex33 own = {{I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2]}};
        const ct_ex3 n = normal_at(b, U[b->topology->node_of_com[i]]);
        if (!m->body[i].is_particle && !m->body[i].beam
            && !is_parallel(b, ct_ex33_apply(b->x, &own, n), n))
            return false;
    }
    return true;
}

bool ct_deformation_keeps_plane(struct ct_build *b, ct_ex33 *const *U, bool *is_spatial)
{
    const unsigned both = CT_BEAM_BENDING_Y | CT_BEAM_BENDING_Z;
    bool asked = false; // does any beam have an automatic choice?
    bool frees = false; // can such a beam deform out of the plane?
    double longest = 0;
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        const ct_ex3 n = normal_at(b, U[f->base]);
        const bool about_z = fabs(ct_ex_value(b->x, n.e[2], b->value)) > 1 - CT_DATA_ROUNDOFF;
        const bool about_y = fabs(ct_ex_value(b->x, n.e[1], b->value)) > 1 - CT_DATA_ROUNDOFF;
        const unsigned within
            = CT_BEAM_AXIAL | (about_z ? CT_BEAM_BENDING_Z : CT_BEAM_BENDING_Y);
        const bool leaves = f->beam->deformation_given && f->beam->deformation & ~within;
        if ((!about_z && !about_y) || leaves || ct_fields_leave_plane(f->beam, about_z))
            return false;
        frees = frees || (!f->beam->deformation_given && (f->beam->known & both) == both);
        longest = fmax(longest, ct_ex_value(b->x, f->beam->length, b->value));
        asked = asked || !f->beam->deformation_given;
    }
    const bool keeps
        = !asked
       || (is_perpendicular(b, b->model->gravity, b->topology->plane[2])
           && loads_keep_plane(b, U) && masses_keep_plane(b, U, CT_SAME_PLACE * longest));
    *is_spatial = *is_spatial || (keeps && frees && b->options->keeps_all_deformations);
    return keeps && !*is_spatial;
}

// Does the joint transmit a torque about the axis to its section?
static bool turns_section(const struct ct_build *b, int frame, const struct ct_flexible *f)
{
    const struct ct_model *m = b->model;
    if (frame < 0 || m->frame[frame].body != f->body)
        return false;
    const bool is_base = frame == m->body[f->body].frame;
    return !is_base || f->beam->is_chord;
}

// Is the stiffness of the section equal in all transverse directions?
static bool is_isotropic(const struct ct_build *b, const struct ct_beam *beam)
{
    const bool shears = beam->theory == CT_BEAM_TIMOSHENKO;
    return ct_ex_is_zero(ct_ex_sub(b->x, beam->Iy, beam->Iz))
        && !(shears
             && !ct_ex_is_zero(ct_ex_sub(b->x, beam->shear_factor[0], beam->shear_factor[1])));
}

static bool bends_about_both(const struct ct_flexible *f)
{
    const unsigned both = CT_BEAM_BENDING_Y | CT_BEAM_BENDING_Z;
    return (f->deformation & f->beam->known & both) == both;
}

// Bending about both axes twists a beam by (5.6b), if it is stiffer about one of them; in an
// analysis the smallest motion counts.
static bool bending_twists(const struct ct_build *b, const struct ct_flexible *f)
{
    return bends_about_both(f)
        && (b->options->keeps_all_deformations
            || (f->formulation == CT_BEAM_FORESHORTENING && !is_isotropic(b, f->beam)));
}

// Does a joint, a torque or an arm off the axis twist the beam beyond its base?
static bool is_twisted(const struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_model *m = b->model;
    if (f->beam->has_rotary && !ct_ex_is_zero(f->beam->rotary[0]))
        return true;
    for (int i = 0; i < f->beam->nstart; i++)
        if (f->beam->start[i].kind == CT_BEAM_FIELD_RX)
            return true;
    for (size_t i = 0; i < m->nframe; i++)
        if (m->frame[i].body == f->body
            && (!ct_ex_is_zero(m->frame[i].at.e[1]) || !ct_ex_is_zero(m->frame[i].at.e[2])))
            return true;
    for (size_t i = 0; i < m->njoint; i++) {
        const struct ct_instance *j = &m->joint[i];
        if (j->from < 0 || (j->cls->is_moment_free && !ct_joint_is_active(j))
            || m->body[m->frame[j->from].body].is_particle
            || m->body[m->frame[j->to].body].is_particle)
            continue;
        if (turns_section(b, j->from, f) || turns_section(b, j->to, f))
            return true;
    }
    for (size_t i = 0; i < m->nforce; i++) {
        if (!m->force[i].cls->is_moment_free
            && (turns_section(b, m->force[i].from, f) || turns_section(b, m->force[i].to, f)))
            return true;
    }
    return false;
}

const char *ct_deformation_no_twist(const struct ct_build *b, const struct ct_flexible *f)
{
    if (is_twisted(b, f))
        return NULL;
    if (!bending_twists(b, f)) {
        if (bends_about_both(f) && f->formulation == CT_BEAM_FORESHORTENING)
            return "only bending about both axes twists it, and sections that are alike in all "
                   "directions follow without a torque";
        return "nothing beyond its base can twist it";
    }
    if (!(f->beam->known & CT_BEAM_TORSION))
        return "only bending about both axes twists it, and G or nu, or J, is not given";
    return ct_ex_is_zero(f->beam->twist_inertia) && !b->options->keeps_all_deformations
             ? "only bending about both axes twists it, and its sections have no inertia"
             : NULL;
}
