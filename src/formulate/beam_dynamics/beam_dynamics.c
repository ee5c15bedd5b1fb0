// Dynamics of flexible bodies; see flexible_body.h. Integrals of inertia: inertia_*.c. Stiffness:
// beam/stiffness.c.
//
// All vectors are in axes of the beam; the motion of the base is transformed once.
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/mass_sums.h"

#include <string.h>

static const ct_ex3 zero3 = {{{0}, {0}, {0}}};

// ---- lumping -----------------------------------------------------------------------------------

void ct_flexible_inertia_derive(struct ct_build *b, struct ct_flexible *f)
{
    if (f->inertia)
        return;
    f->inertia = CT_NEW(b->arena, struct ct_inertia);
    f->inertia->mass = b->model->body[f->body].mass;
    f->inertia->method = f->axial == CT_AXIAL_LINEAR   ? &ct_inertia_exact
                       : ct_inertia_has_legendre(b, f) ? &ct_inertia_legendre
                                                       : &ct_inertia_points;
    f->inertia->method->derive(b, f);
}

void ct_flexible_lump(struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++) {
        struct ct_flexible *f = &b->flexible[i];
        const struct ct_node_placement *p = &b->kinematics->placement[f->base];
        ct_flexible_inertia_derive(b, f);
        const struct ct_inertia *I = f->inertia;
        const ct_ex33 t = ct_ex33_transpose(&p->S), half = ct_ex33_mul(b->x, &I->inertia, &t);
        const ct_ex33 turned = ct_ex33_mul(b->x, &p->S, &half);
        ct_augmented_bodies_add(b, p->anchor, p->frame, I->mass,
                                ct_ex33_apply(b->x, &p->S, I->moment), &turned);
    }
}

// ---- forces on elastic coordinates ----------------------------------------------------------

// Adds forces on the nodal freedoms to the rows of the elastic coordinates.
static void hand_over(struct ct_build *b, const struct ct_flexible *f, ct_ex *force, ct_ex *row)
{
    if (f->condensation)
        ct_condensation_forces(b->x, f->condensation, force);
    for (int i = 0; i < CT_NODE_FREEDOM * (f->beam->nelement + 1); i++)
        for (int p = 0; p < f->freedom[i].npart; p++) {
            ct_ex *r = &row[f->elastic[f->freedom[i].part[p].k].u];
            *r = ct_ex_add(b->x, *r, ct_ex_mul(b->x, f->freedom[i].part[p].coef, force[i]));
        }
}

static ct_ex *forces_of_inertia(struct ct_build *b, const struct ct_flexible *f,
                                const struct ct_base *m, enum ct_level level)
{
    ct_ex *force = CT_NEWN(b->ctx->scratch, ct_ex, CT_NODE_FREEDOM * (f->beam->nelement + 1));
    f->inertia->method->rows(b, f, m, level, force);
    return force;
}

// Rows in terms of the named integrals: m_rf' a + m_thetaf' al - Q_vf + V_q, and m_ff q_f''.
static void named_rows(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                       enum ct_level level, ct_ex *row)
{
    struct ct_exs *x = b->x;
    const struct ct_named_inertia *n = f->inertia->named;
    for (int k = 0; k < f->nelastic; k++) {
        ct_ex *r = &row[f->elastic[k].u];
        *r = ct_ex_add(x, *r, ct_ex3_dot(x, n->columns.m_rf[k], m->a));
        *r = ct_ex_add(x, *r, ct_ex3_dot(x, n->columns.m_thetaf[k], m->al));
        for (int l = 0; l < f->nelastic && level == CT_FULL; l++)
            *r = ct_ex_add(
                x, *r,
                ct_ex_mul(x, n->M[k * f->nelastic + l], b->eqs->u[f->elastic[l].u].derivative));
        *r = ct_ex_sub(x, *r, n->velocity[k]);
        *r = ct_ex_add(x, *r, n->elastic[k]);
    }
}

void ct_flexible_rows(struct ct_build *b, const struct ct_flexible *f, const struct ct_base *m,
                      enum ct_level level, ct_ex *row)
{
    if (f->inertia->named) {
        named_rows(b, f, m, level, row);
        return;
    }
    ct_ex *force = forces_of_inertia(b, f, m, level);
    ct_stiffness_rows(b, f, force);
    hand_over(b, f, force, row);
}

void ct_flexible_inertia_rows(struct ct_build *b, const struct ct_flexible *f,
                              const struct ct_base *m, enum ct_level level, ct_ex *row)
{
    hand_over(b, f, forces_of_inertia(b, f, m, level), row);
}

void ct_flexible_stiffness_rows(struct ct_build *b, const struct ct_flexible *f, ct_ex *row)
{
    ct_ex *force = CT_NEWN(b->ctx->scratch, ct_ex, CT_NODE_FREEDOM * (f->beam->nelement + 1));
    ct_stiffness_rows(b, f, force);
    hand_over(b, f, force, row);
}

void ct_flexible_relative_wrench(struct ct_build *b, const struct ct_flexible *f,
                                 const struct ct_base *m, enum ct_level level, ct_ex3 *force,
                                 ct_ex3 *torque)
{
    const struct ct_named_inertia *n = f->inertia->named;
    if (!n) {
        f->inertia->method->wrench(b, f, m, level, force, torque);
        return;
    }
    *force = n->force;
    *torque = n->torque;
    const bool is_vector = !ct_ex_is_zero(n->acceleration);
    for (int k = 0; k < (is_vector ? 1 : f->nelastic) && level == CT_FULL; k++) {
        const ct_ex u = is_vector ? n->acceleration : b->eqs->u[f->elastic[k].u].derivative;
        *force = ct_ex3_add(b->x, *force, ct_ex3_scale(b->x, u, n->columns.m_rf[k]));
        *torque = ct_ex3_add(b->x, *torque, ct_ex3_scale(b->x, u, n->columns.m_thetaf[k]));
    }
}

// ---- sweep -------------------------------------------------------------------------------------

void ct_flexible_sweep(struct ct_build *b, enum ct_level level, const ct_ex3 *apparent,
                       ct_ex3 *rest, ct_ex3 *torque, ct_ex *row)
{
    struct ct_exs *x = b->x;
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        const struct ct_node_placement *p = &b->kinematics->placement[f->base];
        const struct ct_base m = ct_base_motion(b, f, level, apparent[p->anchor]);
        ct_ex3 F, T, lessF, lessT;
        const struct ct_base effective = ct_flexible_effective_base(b, f, &m, &lessF, &lessT);
        ct_flexible_relative_wrench(b, f, &effective, level, &F, &T);
        F = ct_ex3_sub(x, F, lessF);
        T = ct_ex3_sub(x, T, lessT);
        rest[p->anchor] = ct_ex3_add(x, rest[p->anchor], ct_base_out_of(b, f, F));
        torque[p->frame] = ct_ex3_add(x, torque[p->frame], ct_base_out_of(b, f, T));
        ct_flexible_rows(b, f, &effective, level, row);
    }
}

void ct_flexible_wrench(struct ct_build *b, const struct ct_flexible *f, ct_ex3 *force,
                        ct_ex3 *torque)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const ct_ex3 a
        = ct_ex3_sub(x, ct_node_acceleration(b, f->base, CT_FULL), b->model->gravity);
    const struct ct_base motion = ct_base_motion(b, f, CT_FULL, a);
    ct_ex3 F, T;
    const struct ct_base m = ct_flexible_effective_base(b, f, &motion, &F, &T);
    ct_flexible_relative_wrench(b, f, &m, CT_FULL, &F, &T);
    F = ct_ex3_add(x, F, ct_ex3_scale(x, I->mass, m.a));
    F = ct_ex3_add(x, F, ct_ex3_cross(x, m.al, I->moment));
    F = ct_ex3_add(x, F, ct_ex3_cross(x, m.w, ct_ex3_cross(x, m.w, I->moment)));
    T = ct_ex3_add(x, T, ct_ex3_cross(x, I->moment, m.a));
    T = ct_ex3_add(x, T, ct_ex33_apply(x, &I->inertia, m.al));
    T = ct_ex3_add(x, T, ct_ex3_cross(x, m.w, ct_ex33_apply(x, &I->inertia, m.w)));
    *force = ct_base_out_of(b, f, F);
    *torque = ct_base_out_of(b, f, T);
}

// ---- motion ------------------------------------------------------------------------------------

struct ct_flexible_state ct_flexible_momentum(struct ct_build *b, const struct ct_flexible *f)
{
    struct ct_exs *x = b->x;
    const struct ct_inertia *I = f->inertia;
    const struct ct_base m = ct_base_motion(b, f, CT_BIAS, zero3);
    const ct_ex3 v = ct_base_into(b, f, ct_node_velocity(b, f->base));
    struct ct_relative r = {zero3, zero3, CT_EX_ZERO};
    I->method->relative_momentum(b, f, &r);
    const ct_ex3 momentum = ct_ex3_add(x, ct_ex3_cross(x, m.w, I->moment), r.momentum);
    const ct_ex3 Iw = ct_ex33_apply(x, &I->inertia, m.w);
    ct_ex twice = ct_ex_add(x, r.twice_kinetic, ct_ex_mul(x, I->mass, ct_ex3_dot(x, v, v)));
    twice = ct_ex_add(x, twice, ct_ex_scale(x, 2, ct_ex3_dot(x, v, momentum)));
    twice = ct_ex_add(x, twice, ct_ex3_dot(x, m.w, Iw));
    twice = ct_ex_add(x, twice, ct_ex_scale(x, 2, ct_ex3_dot(x, m.w, r.angular_momentum)));
    const ct_ex3 spin
        = ct_ex3_add(x, ct_ex3_add(x, r.angular_momentum, Iw), ct_ex3_cross(x, I->moment, v));
    const ct_ex3 whole = ct_ex3_add(x, momentum, ct_ex3_scale(x, I->mass, v));
    return (struct ct_flexible_state){.mass = I->mass,
                                      .moment = ct_base_out_of(b, f, I->moment),
                                      .momentum = ct_base_out_of(b, f, whole),
                                      .angular_momentum = ct_base_out_of(b, f, spin),
                                      .twice_kinetic = twice};
}

// ---- mass matrix -------------------------------------------------------------------------------

// Entries of the start of element e, elastic coordinate k, which moves the whole element.
static void mass_of_start(struct ct_build *b, const struct ct_flexible *f,
                          const struct ct_element_sums *s, int e,
                          struct ct_elastic_columns *out, struct ct_symmetric *M)
{
    struct ct_exs *x = b->x;
    const int k = ct_flexible_start(f, e);
    const struct ct_term own = {f->elastic[k].u, -1, CT_EX_ONE};
    out->m_rf[k] = (ct_ex3){{s->m, CT_EX_ZERO, CT_EX_ZERO}};
    out->m_thetaf[k] = (ct_ex3){{CT_EX_ZERO, s->moment.e[2], ct_ex_neg(x, s->moment.e[1])}};
    ct_symmetric_add(x, M, (size_t)own.speed, (size_t)own.speed, s->m);
    for (int j = 0; j < CT_DOF; j++) {
        int sign;
        const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
        for (int p = 0; d && p < d->npart; p++) {
            const struct ct_term dof = {f->elastic[d->part[p].k].u, -1, d->part[p].coef};
            ct_mass_spread(b, M, &own, 1, &dof, 1, ct_ex_scale(x, sign, s->m_rf[j].e[0]));
        }
    }
}

// ---- where all coordinates are small -----------------------------------------------------------

// Adds the mass m beyond an element, with this first moment, which moves axially by g per unit of a
// dof.
static void add_beyond(struct ct_exs *x, ct_ex g, ct_ex m, ct_ex3 moment, ct_ex3 *m_rf,
                       ct_ex3 *m_thetaf)
{
    m_rf->e[0] = ct_ex_add(x, m_rf->e[0], ct_ex_mul(x, g, m));
    m_thetaf->e[1] = ct_ex_add(x, m_thetaf->e[1], ct_ex_mul(x, g, moment.e[2]));
    m_thetaf->e[2] = ct_ex_sub(x, m_thetaf->e[2], ct_ex_mul(x, g, moment.e[1]));
}

// Columns as forces on nodal freedoms. Forces on condensed rotations are distributed from node to
// node. The cost is proportional to the number of nodes; separate sums for each coordinate would
// cost its square.
static void columns_by_freedom(struct ct_build *b, const struct ct_flexible *f,
                               const struct ct_element_sums *s, struct ct_elastic_columns *out)
{
    struct ct_exs *x = b->x;
    const int n = CT_NODE_FREEDOM * (f->beam->nelement + 1);
    ct_ex *force[6], m = CT_EX_ZERO;
    ct_ex3 moment = zero3;
    for (int i = 0; i < 6; i++)
        force[i] = CT_NEWN(b->ctx->scratch, ct_ex, n);
    for (int e = f->beam->nelement; e-- > 0;) {
        for (int j = 0; j < CT_DOF; j++) {
            ct_ex3 m_rf = s[e].m_rf[j], m_thetaf = s[e].m_thetaf[j];
            if (f->kinematics == CT_AXIAL_CHAIN && j < CT_AXIS_DOF)
                add_beyond(x, f->element[e].g[j], m, moment, &m_rf, &m_thetaf);
            for (int i = 0; i < 6; i++)
                ct_dof_push(b, f, e, j, i < 3 ? m_rf.e[i] : m_thetaf.e[i - 3], force[i]);
        }
        m = ct_ex_add(x, m, s[e].m);
        moment = ct_ex3_add(x, moment, s[e].moment);
    }
    for (int i = 0; i < 6; i++) {
        if (f->condensation)
            ct_condensation_forces(x, f->condensation, force[i]);
        for (int k = 0; k < n; k++)
            for (int p = 0; p < f->freedom[k].npart && !ct_ex_is_zero(force[i][k]); p++) {
                const struct ct_part *part = &f->freedom[k].part[p];
                ct_ex *sum
                    = i < 3 ? &out->m_rf[part->k].e[i] : &out->m_thetaf[part->k].e[i - 3];
                *sum = ct_ex_add_product(x, *sum, part->coef, force[i][k]);
            }
    }
}

// Mass entries between elastic coordinates of the straight beam, where condensed rotations have no
// inertia.
static void mass_at_rest(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_element_sums *s, struct ct_symmetric *M)
{
    const size_t n = (size_t)f->nelastic, nelement = (size_t)f->beam->nelement;
    ct_ex *symbol = CT_NEWN(b->ctx->scratch, ct_ex, n + 1),
          *zero = CT_NEWN(b->ctx->scratch, ct_ex, n + 1),
          *all = CT_NEWN(b->ctx->scratch, ct_ex, nelement * CT_DOF * CT_DOF + 1);
    for (size_t k = 0; k < n; k++)
        symbol[k] = b->eqs->q[f->elastic[k].q].symbol;
    for (size_t e = 0; e < nelement; e++)
        memcpy(all + e * CT_DOF * CT_DOF, s[e].M, sizeof s[e].M);
    ct_ex_subst_list(b->x, all, nelement * CT_DOF * CT_DOF, symbol, zero, n);
    for (int e = 0; e < f->beam->nelement; e++)
        for (int j = 0; j < CT_DOF; j++)
            for (int k = 0; k < CT_DOF; k++)
                ct_dof_push_pair(b, f, e, j, e, k, all[(e * CT_DOF + j) * CT_DOF + k], M);
}

// Mass of a beam with small coordinates: entries between them are those of the straight beam.
// (small_motion.h)
static void small_mass(struct ct_build *b, const struct ct_flexible *f,
                       struct ct_elastic_columns *out, struct ct_symmetric *M)
{
    struct ct_element_sums *s = f->inertia->method->sums(b, f);
    columns_by_freedom(b, f, s, out);
    for (int e = 0; e < f->beam->nelement; e++)
        ct_element_close(b->x, &s[e]);
    mass_at_rest(b, f, s, M);
}

// ---- of any size -------------------------------------------------------------------------------

// Adds the elements from the tip inwards. In a CHAIN the bending of an element moves everything
// beyond it, unless element starts are coordinates.
static void mass_of_sums(struct ct_build *b, const struct ct_flexible *f,
                         struct ct_elastic_columns *out, struct ct_symmetric *M)
{
    struct ct_exs *x = b->x;
    const bool chain = f->kinematics == CT_AXIAL_CHAIN && !f->nstart;
    const int n = f->beam->nelement;
    struct ct_element_sums *s = f->inertia->method->sums(b, f);
    ct_ex m = CT_EX_ZERO;
    ct_ex3 moment = zero3;
    for (int e = n; e-- > 0;) {
        const struct ct_element *self = &f->element[e];
        ct_element_close(x, &s[e]);
        for (int j = 0; j < CT_DOF; j++) {
            const ct_ex g = chain && j < CT_AXIS_DOF ? self->g[j] : CT_EX_ZERO;
            ct_ex3 m_rf = s[e].m_rf[j], m_thetaf = s[e].m_thetaf[j];
            add_beyond(x, g, m, moment, &m_rf, &m_thetaf);
            ct_dof_push_column(b, f, e, j, m_rf, m_thetaf, out);
            for (int k = 0; k < CT_DOF; k++) {
                const ct_ex gk = chain && k < CT_AXIS_DOF ? self->g[k] : CT_EX_ZERO;
                const ct_ex v
                    = ct_ex_add(x, s[e].M[j][k], ct_ex_mul(x, ct_ex_mul(x, g, gk), m));
                ct_dof_push_pair(b, f, e, j, e, k, v, M);
            }
            for (int inner = 0; inner < e && chain && !ct_ex_is_zero(m_rf.e[0]); inner++)
                for (int k = 2; k < CT_BENT_DOF; k++) {
                    const ct_ex v = ct_ex_mul(x, f->element[inner].g[k], m_rf.e[0]);
                    ct_dof_push_pair(b, f, e, j, inner, k, v, M);
                    ct_dof_push_pair(b, f, inner, k, e, j, v, M);
                }
        }
        if (f->nstart && e > 0)
            mass_of_start(b, f, &s[e], e, out, M);
        m = ct_ex_add(x, m, s[e].m);
        moment = ct_ex3_add(x, moment, s[e].moment);
    }
}

// Rows of the elastic coordinates in the column of a speed that moves the base: coef (p . m_rf + s
// . m_thetaf).
static void base_column(struct ct_build *b, const struct ct_flexible *f,
                        const struct ct_elastic_columns *c, ct_ex3 p, ct_ex3 s,
                        const struct ct_term *term, int nterm, struct ct_symmetric *M)
{
    for (int k = 0; k < f->nelastic; k++) {
        const ct_ex m = ct_ex_add(b->x, ct_ex3_dot(b->x, p, c->m_rf[k]),
                                  ct_ex3_dot(b->x, s, c->m_thetaf[k]));
        if (ct_ex_is_zero(m))
            continue;
        const struct ct_term own = {f->elastic[k].u, -1, CT_EX_ONE};
        ct_mass_spread(b, M, &own, 1, term, nterm, m);
    }
}

static bool has_unknown(const struct ct_term *p, int np)
{
    for (int i = 0; i < np; i++)
        if (p[i].speed >= 0)
            return true;
    return false;
}

// s x r in axes of the beam, if the axis s and all links r are fixed in the cluster of the beam.
// This avoids the longer expression R'(R s x R r).
static bool local_lever(struct ct_build *b, const struct ct_flexible *f,
                        const struct ct_rotation_axis *spin, ct_ex3 *lever)
{
    const struct ct_node_placement *at = &b->kinematics->placement[f->base];
    ct_ex3 reach = zero3;
    if (b->topology->is_planar || spin->cluster != at->frame || ct_ex3_is_zero(spin->local))
        return false;
    for (int a = at->anchor; a > 0; a = b->kinematics->anchor[a].parent) {
        const struct ct_anchor *link = &b->kinematics->anchor[a];
        if (!ct_cluster_is_outboard(b, spin->cluster, link->cluster))
            continue;
        if (link->cluster != at->frame)
            return false;
        reach = ct_ex3_add(b->x, reach, link->local);
    }
    *lever = ct_ex33_apply_t(b->x, &at->S, ct_ex3_cross(b->x, spin->local, reach));
    return true;
}

static void base_columns(struct ct_build *b, const struct ct_flexible *f,
                         const struct ct_elastic_columns *c, struct ct_symmetric *M)
{
    struct ct_exs *x = b->x;
    const struct ct_node_placement *at = &b->kinematics->placement[f->base];
    for (size_t r = 0; r < b->kinematics->nrotation_axis; r++) {
        const struct ct_rotation_axis *spin = &b->kinematics->rotation_axis[r];
        ct_ex3 reach = zero3, s = zero3;
        if (!has_unknown(spin->term, spin->nterm))
            continue;
        for (int a = at->anchor; a > 0; a = b->kinematics->anchor[a].parent)
            if (ct_cluster_is_outboard(b, spin->cluster, b->kinematics->anchor[a].cluster))
                reach = ct_ex3_add(x, reach, ct_link_vector(b, a));
        ct_ex3 p = zero3;
        const bool is_local = f->inertia->named && local_lever(b, f, spin, &p);
        if (!is_local && !ct_ex3_is_zero(reach))
            p = ct_base_into(b, f, ct_ex3_cross(x, spin->axis, ct_build_in_plane(b, reach)));
        if (ct_cluster_is_outboard(b, spin->cluster, at->frame)) {
            if (spin->cluster == at->frame && !ct_ex3_is_zero(spin->local))
                s = ct_ex33_apply_t(x, &at->S, spin->local);
            else if (b->topology->is_planar)
                s = ct_ex33_apply_t(x, &at->S, spin->axis);
            else
                s = ct_base_into(b, f, spin->axis);
        }
        base_column(b, f, c, p, s, spin->term, spin->nterm, M);
    }
    for (int a = at->anchor; a > 0; a = b->kinematics->anchor[a].parent)
        for (int k = 0; k < b->kinematics->anchor[a].ntranslation_axis; k++) {
            const struct ct_translation_axis *slide
                = &b->kinematics->anchor[a].translation_axis[k];
            const struct ct_term term = {slide->speed, slide->driver, CT_EX_ONE};
            if (slide->speed < 0)
                continue;
            const ct_ex3 p
                = b->kinematics->anchor[a].cluster == at->frame
                    ? ct_ex33_apply_t(x, &at->S, slide->p)
                    : ct_base_into(
                        b, f, ct_cluster_turn(b, b->kinematics->anchor[a].cluster, slide->p));
            base_column(b, f, c, p, zero3, &term, 1, M);
        }
}

// Does each coordinate foreshorten every element, because slopes are condensed?
static bool is_foreshortened_by_shapes(const struct ct_flexible *f)
{
    return f->condensation && f->kinematics == CT_AXIAL_CHAIN
        && (f->beam->theory == CT_BEAM_EULER_BERNOULLI || f->beam->higher_order);
}

static void named_columns(struct ct_build *b, const struct ct_flexible *f,
                          struct ct_elastic_columns *out, struct ct_symmetric *M)
{
    const struct ct_named_inertia *n = f->inertia->named;
    for (int k = 0; k < f->nelastic; k++) {
        out->m_rf[k] = n->columns.m_rf[k];
        out->m_thetaf[k] = n->columns.m_thetaf[k];
        for (int l = 0; l <= k; l++)
            ct_symmetric_add(b->x, M, (size_t)f->elastic[k].u, (size_t)f->elastic[l].u,
                             n->M[k * f->nelastic + l]);
    }
}

void ct_flexible_columns(struct ct_build *b, const struct ct_flexible *f,
                         struct ct_elastic_columns *out, struct ct_symmetric *M)
{
    const struct ct_inertia_method *form = f->inertia->method;
    if (f->inertia->named)
        named_columns(b, f, out, M);
    else if (form->mass)
        form->mass(b, f, out, M);
    else if (ct_flexible_is_small(b, f) && ct_flexible_is_nodal(f))
        small_mass(b, f, out, M);
    else if (f->beam->modes || f->beam->nshape || is_foreshortened_by_shapes(f))
        ct_flexible_modal_mass(b, f, out, M);
    else
        mass_of_sums(b, f, out, M);
}

void ct_flexible_mass(struct ct_build *b, struct ct_symmetric *M)
{
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        struct ct_elastic_columns c = {CT_NEWN(b->arena, ct_ex3, f->nelastic + 1),
                                       CT_NEWN(b->arena, ct_ex3, f->nelastic + 1)};
        ct_flexible_columns(b, f, &c, M);
        base_columns(b, f, &c, M);
    }
}

// Adds the terms c p p' of the bending dofs.
void ct_element_close(struct ct_exs *x, struct ct_element_sums *s)
{
    for (int k = 0; k < s->nsquare; k++)
        for (int i = 2; i < CT_BENT_DOF; i++)
            for (int j = 2; j <= i; j++)
                s->M[i][j] = s->M[j][i]
                    = ct_ex_add(x, s->M[i][j], ct_ex_mul(x, s->heavy[k][i], s->square[k][j]));
    s->nsquare = 0;
}
