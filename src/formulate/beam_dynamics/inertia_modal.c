// Mass matrix of a beam with shapes of the whole beam as coordinates; see beam_dynamics.h.
//
// With C (dofs x shapes) of an element, M its matrix between dofs, and a CHAIN: mass m beyond it, g
// = dc/d dof, so that gamma = C' g is the foreshortening of the element by the shapes,
//
//     M_shapes = sum_e C' M C + m gamma gamma' + gamma beta' + beta gamma',
//     beta = sum_beyond C' int mu dr_x + m gamma
//
// summed from the tip inwards. Sums over pairs of dofs would cost (elements)^2 (shapes)^2.
#include "formulate/beam_dynamics/beam_dynamics.h"

// An element in terms of shapes: C, the sums of its dofs by shape, and beta of everything beyond
// it.
struct reduced {
    ct_ex *C;            // CT_DOF x n, by rows
    ct_ex *gamma, *beta; // gamma, beta
    ct_ex3 *m_rf, *m_thetaf;
};

static void find_shares(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex *C)
{
    const int n = f->nelastic;
    for (int j = 0; j < CT_DOF; j++) {
        int sign;
        const struct ct_freedom *d = ct_dof_freedom(f, e, j, &sign);
        for (int k = 0; k < n; k++)
            C[j * n + k] = CT_EX_ZERO;
        for (int p = 0; d && p < d->npart; p++)
            C[j * n + d->part[p].k]
                = sign > 0 ? d->part[p].coef : ct_ex_neg(b->x, d->part[p].coef);
    }
}

static bool is_fixed(const struct ct_exs *x, ct_ex e)
{
    return !(ct_ex_kinds(x, e) & ~(1u << CT_SYM_PARAM));
}

// Adds C' M C to the lower triangle, M C first: of the constant part or of the variable part.
static void add_element(struct ct_build *b, const struct ct_flexible *f, const ct_ex *C,
                        const struct ct_element_sums *s, bool fixed, ct_ex *M)
{
    struct ct_exs *x = b->x;
    const int n = f->nelastic;
    for (int k = 0; k < n; k++) {
        ct_ex MC[CT_DOF] = {{0}};
        for (int j = 0; j < CT_DOF; j++)
            for (int l = 0; l < CT_DOF; l++)
                if (is_fixed(x, s->M[j][l]) == fixed)
                    MC[j] = ct_ex_add(x, MC[j], ct_ex_mul(x, s->M[j][l], C[l * n + k]));
        for (int i = k; i < n; i++)
            for (int j = 0; j < CT_DOF; j++)
                M[i + n * k] = ct_ex_add(x, M[i + n * k], ct_ex_mul(x, C[j * n + i], MC[j]));
    }
}

// Adds the terms that the sums hold as squares. p: n
static void add_squares(struct ct_build *b, const struct ct_flexible *f, const ct_ex *C,
                        const struct ct_element_sums *s, ct_ex *p, ct_ex *M)
{
    struct ct_exs *x = b->x;
    const int n = f->nelastic;
    for (int q = 0; q < s->nsquare; q++) {
        for (int k = 0; k < n; k++) {
            p[k] = CT_EX_ZERO;
            for (int j = 2; j < CT_BENT_DOF; j++)
                p[k] = ct_ex_add(x, p[k], ct_ex_mul(x, C[j * n + k], s->square[q][j]));
        }
        for (int k = 0; k < n; k++) {
            const ct_ex heavy = ct_ex_mul(x, s->weight[q], p[k]);
            for (int i = k; i < n; i++)
                M[i + n * k] = ct_ex_add(x, M[i + n * k], ct_ex_mul(x, heavy, p[i]));
        }
    }
}

static void reduce(struct ct_build *b, const struct ct_flexible *f, int e,
                   const struct ct_element_sums *s, struct reduced *r)
{
    struct ct_exs *x = b->x;
    const int n = f->nelastic;
    find_shares(b, f, e, r->C);
    for (int k = 0; k < n; k++) {
        r->gamma[k] = CT_EX_ZERO;
        r->m_rf[k] = r->m_thetaf[k] = (ct_ex3){{CT_EX_ZERO, CT_EX_ZERO, CT_EX_ZERO}};
        for (int j = 0; j < CT_DOF; j++) {
            const ct_ex c = r->C[j * n + k];
            r->m_rf[k] = ct_ex3_add(x, r->m_rf[k], ct_ex3_scale(x, c, s->m_rf[j]));
            r->m_thetaf[k] = ct_ex3_add(x, r->m_thetaf[k], ct_ex3_scale(x, c, s->m_thetaf[j]));
            if (f->kinematics == CT_AXIAL_CHAIN && j < CT_AXIS_DOF)
                r->gamma[k] = ct_ex_add(x, r->gamma[k], ct_ex_mul(x, c, f->element[e].g[j]));
        }
    }
}

// Adds the mass and first moment beyond the element, which the shapes of the element move axially.
static void add_beyond(struct ct_build *b, const struct ct_flexible *f, struct reduced *r,
                       ct_ex m, ct_ex3 moment, ct_ex *M)
{
    struct ct_exs *x = b->x;
    const int n = f->nelastic;
    for (int k = 0; k < n; k++)
        for (int i = k; i < n; i++) {
            ct_ex v = ct_ex_mul(x, r->gamma[i], ct_ex_mul(x, r->gamma[k], m));
            v = ct_ex_add(x, v, ct_ex_mul(x, r->gamma[i], r->beta[k]));
            v = ct_ex_add(x, v, ct_ex_mul(x, r->beta[i], r->gamma[k]));
            M[i + n * k] = ct_ex_add(x, M[i + n * k], v);
        }
    for (int k = 0; k < n; k++) {
        const ct_ex3 about = {{CT_EX_ZERO, moment.e[2], ct_ex_neg(x, moment.e[1])}};
        r->m_rf[k].e[0] = ct_ex_add(x, r->m_rf[k].e[0], ct_ex_mul(x, r->gamma[k], m));
        r->beta[k] = ct_ex_add(x, r->beta[k], r->m_rf[k].e[0]);
        r->m_thetaf[k] = ct_ex3_add(x, r->m_thetaf[k], ct_ex3_scale(x, r->gamma[k], about));
    }
}

void ct_flexible_modal_mass(struct ct_build *b, const struct ct_flexible *f,
                            struct ct_elastic_columns *out, struct ct_symmetric *M)
{
    struct ct_exs *x = b->x;
    const int n = f->nelastic;
    const struct ct_element_sums *s = f->inertia->method->sums(b, f);
    struct reduced r = {CT_NEWN(b->arena, ct_ex, CT_DOF * n), CT_NEWN(b->arena, ct_ex, n),
                        CT_NEWN(b->arena, ct_ex, n), CT_NEWN(b->arena, ct_ex3, n),
                        CT_NEWN(b->arena, ct_ex3, n)};
    ct_ex *own = CT_NEWN(b->arena, ct_ex, n * n), *fixed = CT_NEWN(b->arena, ct_ex, n * n),
          *p = CT_NEWN(b->arena, ct_ex, n), m = CT_EX_ZERO;
    ct_ex3 moment = {{CT_EX_ZERO, CT_EX_ZERO, CT_EX_ZERO}};
    for (int e = f->beam->nelement; e-- > 0;) {
        reduce(b, f, e, &s[e], &r);
        add_element(b, f, r.C, &s[e], true, fixed);
        add_element(b, f, r.C, &s[e], false, own);
        add_squares(b, f, r.C, &s[e], p, own);
        add_beyond(b, f, &r, m, moment, own);
        for (int k = 0; k < n; k++) {
            out->m_rf[k] = ct_ex3_add(x, out->m_rf[k], r.m_rf[k]);
            out->m_thetaf[k] = ct_ex3_add(x, out->m_thetaf[k], r.m_thetaf[k]);
        }
        m = ct_ex_add(x, m, s[e].m);
        moment = ct_ex3_add(x, moment, s[e].moment);
    }
    for (int k = 0; k < n; k++)
        for (int i = k; i < n; i++) {
            const size_t u = (size_t)f->elastic[i].u, v = (size_t)f->elastic[k].u;
            ct_symmetric_add(x, M, u, v, ct_ex_add(x, fixed[i + n * k], own[i + n * k]));
        }
}
