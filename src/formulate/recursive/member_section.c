// Members of beams: the base, and the translation and rotation from it to a section; see member.h.
#include "formulate/recursive/member_internal.h"

#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/beam/section_rotation.h"

#include <math.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

static int beam_of(const struct ct_build *b, const struct ct_flexible *f)
{
    return (int)(f - b->flexible);
}

// Rotation from axes of the beam to axes of its base: those of the cluster; in a plane (x, n x x,
// n).
static ct_ex33 base_axes(struct ct_build *b, const struct ct_flexible *f)
{
    if (!b->topology->is_planar)
        return b->kinematics->placement[f->base].S;
    const ct_ex3 n
        = ct_ex33_apply_t(b->x, &b->topology->reference_axes[f->base], b->topology->plane[2]);
    ct_ex33 A = {{{0}}};
    double v[3]; // one of the axes of the beam, up to round-off
    for (int i = 0; i < 3; i++) {
        v[i] = rint(ct_ex_value(b->x, n.e[i], b->value)) + 0.0; // no negative zero
        A.e[2 + 3 * i] = ct_ex_const(b->x, v[i]);
    }
    A.e[0] = CT_EX_ONE;
    A.e[1 + 3 * 1] = ct_ex_const(b->x, v[2]);
    A.e[1 + 3 * 2] = ct_ex_const(b->x, 0 - v[1]);
    return A;
}

// In a plane: rotation from axes of the beam base to axes of the plane.
static ct_ex33 beam_turn(struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_node_placement *p = &b->kinematics->placement[f->base];
    const ct_ex3 x = {{CT_EX_ONE, CT_EX_ZERO, CT_EX_ZERO}};
    const ct_ex3 v = ct_member_express(b, p->frame, ct_ex33_apply(b->x, &p->S, x));
    return (ct_ex33){{v.e[0], v.e[1], CT_EX_ZERO, ct_ex_neg(b->x, v.e[1]), v.e[0], CT_EX_ZERO,
                      CT_EX_ZERO, CT_EX_ZERO, CT_EX_ONE}};
}

// In a plane: changes the axes at member m, from axes of the plane to axes of the beam or back.
static void change_axes(struct ct_member_build *w, int m, const struct ct_flexible *f,
                        bool into_beam)
{
    struct ct_member *self = &w->s->member[m];
    const ct_ex33 R = beam_turn(w->b, f);
    self->R = into_beam ? R : ct_ex33_transpose(&R);
    self->has_axes = true;
    self->axis = 2;
}

static int rigid_member(struct ct_member_build *w, int parent, const struct ct_flexible *f,
                        ct_ex3 r)
{
    const int m = ct_member_add(w, parent, w->s->member[parent].cluster, r);
    w->s->member[m].beam = beam_of(w->b, f) + 1;
    return m;
}

void ct_member_attach_base(struct ct_member_build *w, const struct ct_flexible *f, int member,
                           ct_ex3 offset)
{
    struct ct_member_beam *beam = &w->s->beam[beam_of(w->b, f)];
    if (beam->base)
        return;
    beam->A = base_axes(w->b, f);
    beam->base = beam->root = rigid_member(w, member, f, offset);
    if (w->b->topology->is_planar)
        change_axes(w, beam->base, f, true);
}

// Partial derivatives of translation and rotation of a section, in axes of the beam: by elastic
// coordinate and, for nodal coordinates, separately by condensed rotation.
struct section_partials {
    int n;
    const ct_ex3 *slide, *turn;
};

static struct section_partials section_partials(struct ct_build *b,
                                                const struct ct_edge_info *e)
{
    const struct ct_flexible *f = ct_flexible_of_edge(b, e);
    const struct ct_edge_kinematics *k = ct_edge_kinematics(b, e);
    if (!ct_flexible_is_nodal(f))
        return (struct section_partials){f->nelastic, k->translation, k->rotation};
    const int n = f->nelastic + ct_condensation_count(f);
    ct_ex3 *slide = CT_NEWN(b->arena, ct_ex3, n + 1), *turn = CT_NEWN(b->arena, ct_ex3, n + 1);
    ct_station_own_partials(b, f, k->station, slide, turn);
    return (struct section_partials){n, slide, turn};
}

// Speed of derivative k, or the negative number that stands for one (struct ct_screw).
static int section_speed(const struct ct_flexible *f, int k)
{
    return k < f->nelastic ? f->elastic[k].u : f->nelastic - k - f->beam->nelement;
}

// Adds the translation between the base and a section; r starts at the origin of member `from`, in
// axes of the base.
static int slide_section(struct ct_member_build *w, int from, ct_ex3 r,
                         const struct ct_edge_info *e, int sign)
{
    struct ct_build *b = w->b;
    const struct ct_flexible *f = ct_flexible_of_edge(b, e);
    const struct ct_station *s = ct_edge_kinematics(b, e)->station;
    const ct_ex33 *A = &w->s->beam[beam_of(b, f)].A;
    ct_ex3 place = ct_ex33_apply(b->x, A, ct_edge_kinematics(b, e)->d);
    place = sign > 0 ? place : ct_ex3_neg(b->x, place);
    const int i = ct_member_add(w, from, b->kinematics->placement[f->base].frame,
                                ct_ex3_add(b->x, r, place));
    struct ct_member *m = &w->s->member[i];
    m->beam = beam_of(b, f) + 1;
    m->translates = m->is_ready = true;
    m->drift = ct_build_rate3(b, place);
    m->drift_bias = ct_build_rate3(b, m->drift);
    if (ct_flexible_is_augmented(f) && s->element) {
        const ct_ex3 along = {{A->e[0], A->e[1], A->e[2]}};
        ct_member_screw(b, m, -s->element)->translation
            = sign > 0 ? along : ct_ex3_neg(b->x, along);
    }
    const struct section_partials by = section_partials(b, e);
    for (int k = 0; k < by.n; k++) {
        const ct_ex3 p = ct_ex33_apply(b->x, A, by.slide[k]);
        if (!ct_ex3_is_zero(p))
            ct_member_screw(b, m, section_speed(f, k))->translation
                = sign > 0 ? p : ct_ex3_neg(b->x, p);
    }
    return i;
}

// Adds rotation i of a section, which is that of cluster c.
static int add_section_turn(struct ct_member_build *w, int from, ct_ex3 r,
                            const struct ct_passage *p, int i, int sign)
{
    struct ct_build *b = w->b;
    const struct ct_flexible *f = ct_flexible_of_edge(b, p->e);
    const struct section_partials by = section_partials(b, p->e);
    struct ct_section_turn turn[4];
    const int nturn = ct_section_turns(ct_edge_kinematics(b, p->e)->station->angle, turn),
              k = sign > 0 ? i : nturn - 1 - i, new = ct_member_add(w, from, -1, r);
    struct ct_member *m = ct_member_take_cluster(w, new, p->cluster[i]);
    const ct_ex3 axis = ct_member_rotation_axis(w, m, p->S, 0);
    m->beam = beam_of(b, f) + 1;
    for (int l = 0; l < by.n; l++) {
        const ct_ex angle = by.turn[l].e[turn[k].axis];
        if (!ct_ex_is_zero(angle))
            ct_member_screw_turn(b, m, section_speed(f, l),
                                 ct_ex_scale(b->x, sign * turn[k].share, angle), axis);
    }
    return new;
}

// Adds the rotations of a section; in a plane also the change of axes.
static int turn_section(struct ct_member_build *w, int from, ct_ex3 r,
                        const struct ct_passage *p, int sign)
{
    const struct ct_flexible *f = ct_flexible_of_edge(w->b, p->e);
    int m = from;
    for (int i = 0; i < p->ncluster; i++, r = zero3)
        m = add_section_turn(w, m, r, p, i, sign);
    if (!w->b->topology->is_planar)
        return m;
    if (!p->ncluster)
        m = rigid_member(w, m, f, r);
    change_axes(w, m, f, sign < 0);
    return m;
}

bool ct_member_pass_section(struct ct_member_build *w, const struct ct_passage *p, int sign,
                            int *member, ct_ex3 *offset)
{
    struct ct_build *b = w->b;
    const struct ct_flexible *f = ct_flexible_of_edge(b, p->e);
    struct ct_member_beam *beam = &w->s->beam[beam_of(b, f)];
    if (p->is_absolute || (sign < 0 && beam->base))
        return false;
    if (sign > 0) {
        *member = slide_section(w, beam->base, zero3, p->e, sign);
        *member = turn_section(w, *member, zero3, p, sign);
    } else {
        const size_t first = w->s->n;
        beam->A = base_axes(b, f);
        const int turned = turn_section(w, *member, *offset, p, sign);
        const bool is_new = turned != *member;
        *member = slide_section(w, turned, is_new ? zero3 : *offset, p->e, sign);
        beam->root = (int)first;
        beam->base = *member;
        if (b->topology->is_planar) { // for other sections at the base
            *member = rigid_member(w, *member, f, zero3);
            change_axes(w, *member, f, false);
        }
    }
    *offset = zero3;
    return true;
}
