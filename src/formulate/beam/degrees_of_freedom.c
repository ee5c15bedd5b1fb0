// See degrees_of_freedom.h.
#include "formulate/beam/degrees_of_freedom.h"

enum {
    V = CT_FREEDOM_V,
    W = CT_FREEDOM_W,
    RY = CT_FREEDOM_RY,
    RZ = CT_FREEDOM_RZ,
    RM = CT_FREEDOM_RM,
    UM = CT_FREEDOM_UM,
    NKIND = CT_NODE_FREEDOM
};

unsigned ct_freedom_family(int kind)
{
    static const unsigned family[NKIND]
        = {CT_BEAM_AXIAL,     CT_BEAM_BENDING_Z, CT_BEAM_BENDING_Y, CT_BEAM_TORSION,
           CT_BEAM_BENDING_Y, CT_BEAM_BENDING_Z, CT_BEAM_TORSION,   CT_BEAM_AXIAL};
    return family[kind];
}

bool ct_freedom_is_fixed(const struct ct_flexible *f, int node, int kind)
{
    const bool is_end = node == f->beam->nelement;
    if (!(f->deformation & ct_freedom_family(kind)))
        return true;
    if (kind == RM)
        return node == 0 || !f->beam->has_quadratic_twist;
    if (kind == UM)
        return node == 0 || !f->beam->has_quadratic_stretch;
    if (!f->beam->is_chord)
        return node == 0;
    // the chord's frame: origin at the start, x towards the end, not twisted at the start
    const bool turns = kind == RY || kind == RZ;
    return (node == 0 && !turns) || (is_end && (kind == V || kind == W));
}

const struct ct_freedom *ct_dof_freedom(const struct ct_flexible *f, int e, int j, int *sign)
{
    const int i = f->element[e].freedom[j];
    *sign = j == 7 || j == 9 ? -1 : 1; // dw/dx = -ry
    return i < 0 ? NULL : &f->freedom[i];
}

void ct_dof_push(struct ct_build *b, const struct ct_flexible *f, int e, int j, ct_ex value,
                 ct_ex *by_freedom)
{
    int sign;
    if (!ct_dof_freedom(f, e, j, &sign))
        return;
    ct_ex *sum = &by_freedom[f->element[e].freedom[j]];
    *sum = sign > 0 ? ct_ex_add(b->x, *sum, value) : ct_ex_sub(b->x, *sum, value);
}

void ct_dof_push_pair(struct ct_build *b, const struct ct_flexible *f, int e, int j, int g,
                      int k, ct_ex value, struct ct_symmetric *M)
{
    int sj, sk;
    const struct ct_freedom *p = ct_dof_freedom(f, e, j, &sj),
                            *q = ct_dof_freedom(f, g, k, &sk);
    if (!p || !q || ct_ex_is_zero(value))
        return;
    for (int i = 0; i < p->npart; i++)
        for (int l = 0; l < q->npart; l++) {
            const int row = f->elastic[p->part[i].k].u, column = f->elastic[q->part[l].k].u;
            const ct_ex c = ct_ex_mul(b->x, p->part[i].coef, q->part[l].coef);
            ct_ex v = ct_ex_mul(b->x, c, value);
            if (row < column)
                continue; // the transposed pair is added separately
            v = sj == sk ? v : ct_ex_neg(b->x, v);
            ct_symmetric_add(b->x, M, (size_t)row, (size_t)column, v);
        }
}

void ct_dof_push_column(struct ct_build *b, const struct ct_flexible *f, int e, int j,
                        ct_ex3 m_rf, ct_ex3 m_thetaf, struct ct_elastic_columns *out)
{
    int sign;
    const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
    for (int i = 0; d && i < d->npart; i++) {
        const int k = d->part[i].k;
        const ct_ex c = sign > 0 ? d->part[i].coef : ct_ex_neg(b->x, d->part[i].coef);
        out->m_rf[k] = ct_ex3_add(b->x, out->m_rf[k], ct_ex3_scale(b->x, c, m_rf));
        out->m_thetaf[k] = ct_ex3_add(b->x, out->m_thetaf[k], ct_ex3_scale(b->x, c, m_thetaf));
    }
}

ct_ex *ct_chain_accelerations(struct ct_build *b, const struct ct_flexible *f)
{
    if (f->kinematics != CT_AXIAL_CHAIN)
        return NULL;
    ct_ex *c = CT_NEWN(b->arena, ct_ex, f->beam->nelement + 1);
    for (int e = 0; e < f->beam->nelement; e++) {
        c[e + 1] = c[e];
        for (int j = 2; j < CT_BENT_DOF; j++)
            c[e + 1]
                = ct_ex_add(b->x, c[e + 1],
                            ct_ex_mul(b->x, f->element[e].g[j], f->element[e].acceleration[j]));
    }
    return c;
}
