// The matrices of a beam with the names and equation numbers of liang2017: (3.41), (3.75),
// (3.87), (3.92), appendix A.1.
//
//     [ m_rr  m_rtheta      m_rf     ] [ R''  ]
//     [       m_thetatheta  m_thetaf ] [ w'   ] = Q_g + Q_v - [0, 0, K_f q_f] + Q   (4.11)
//     [ sym                 m_ff     ] [ q_f'']
//
// R: position of the beam's frame, ground axes; w: its angular velocity, its own axes; A: its
// rotation; Q: joints and loads. The matrices are those of the program (beam_dynamics.h) and
// include what liang2017 neglects: rotary inertia of the sections and lumped masses. Signs are
// those of a right side. Errors of the printed formulas are corrected and listed in
// docs/liang2017.md.
#include "report/stage_beam.h"

#include "expr/collect.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "report/beam_parts.h"

#include <string.h>

static ct_ex collect(struct ct_derivation *d, ct_ex v)
{
    if (ct_ex_is_const(d->e->x, v, NULL) || ct_ex_symbol(d->e->x, v))
        return v;
    struct ct_arena *work = ct_arena_create_under(d->a);
    const struct ct_collect_options o = {.scratch = work};
    v = ct_ex_collect(d->e->x, v, &o);
    ct_arena_destroy(work);
    return v;
}

static const char *collected(struct ct_derivation *d, ct_ex v)
{
    return ct_derivation_text(d, collect(d, v));
}

static const char *pick(const struct ct_derivation *d, const char *text, const char *latex)
{
    return ct_derivation_is_latex(d) ? latex : text;
}

static void put(struct ct_derivation *d, const char *left, const char *latex_left,
                const char *text, const char *latex, const char *note)
{
    ct_page_equation(&d->page, NULL, pick(d, left, latex_left), pick(d, text, latex), note);
}

// ---- matrices with names of rows and columns -----------------------------------------------

struct matrix {
    const char *name, *latex; // prefix of its entries
    const char *says;         // in the heading
    const char *number;       // of the equation
    const char *const *row, *const *column;
    size_t nrow, ncolumn;
    const ct_ex *value; // (nrow, ncolumn), row by row
    bool is_symmetric;  // the lower triangle is shown
};

// A matrix wider than a page: the nonzero entries, one by one.
static void put_entries(struct ct_derivation *d, const struct matrix *m)
{
    const char *name = pick(d, m->name, m->latex);
    ct_page_equations(&d->page);
    for (size_t i = 0; i < m->nrow; i++)
        for (size_t j = 0; j < m->ncolumn && (!m->is_symmetric || j <= i); j++) {
            const ct_ex v = m->value[i * m->ncolumn + j];
            if (!ct_ex_is_zero(v))
                ct_page_equation(
                    &d->page, NULL,
                    ct_arena_printf(d->a, "%s[%s, %s]", name, m->row[i], m->column[j]),
                    collected(d, v), NULL);
        }
}

static void put_matrix(struct ct_derivation *d, const struct matrix *m)
{
    ct_page_heading(&d->page, ct_arena_printf(d->a, "%s %s", m->says, m->number));
    ct_page_matrix(&d->page, m->ncolumn + 1);
    ct_page_cell(&d->page, "");
    for (size_t j = 0; j < m->ncolumn; j++)
        ct_page_cell(&d->page, m->column[j]);
    for (size_t i = 0; i < m->nrow; i++) {
        ct_page_cell(&d->page, m->row[i]);
        for (size_t j = 0; j < m->ncolumn; j++)
            ct_page_cell(&d->page, m->is_symmetric && j > i
                                       ? ""
                                       : collected(d, m->value[i * m->ncolumn + j]));
    }
    if (!ct_page_matrix_end(&d->page))
        put_entries(d, m);
}

static const char *const xyz[] = {"x", "y", "z"};

// ---- shape integrals of an element ---------------------------------------------------------

// An element of length h with the sections of the beam.
struct element {
    struct ct_flexible one;
    struct ct_beam beam;
    struct ct_element self;
    int dof[CT_DOF]; // those it has
    int ndof;
};

static int direction(int dof)
{
    return dof < 2 || dof == CT_MIDDLE_DOF ? 0 : dof < 6 ? 1 : dof < CT_BENT_DOF ? 2 : -1;
}

static const struct ct_shape *shape_of(const struct element *e, int dof)
{
    return dof == CT_MIDDLE_DOF ? &e->one.line[2]
         : dof < 2              ? &e->one.line[dof]
         : direction(dof) >= 0  ? &e->one.shape.deflection[(dof - 2) % 4]
                                : &e->one.line[dof - CT_AXIS_DOF];
}

static void make_element(struct ct_build *b, const struct ct_flexible *f, struct element *e)
{
    const unsigned family[] = {CT_BEAM_AXIAL, CT_BEAM_BENDING_Z, CT_BEAM_BENDING_Y};
    *e = (struct element){.one = *f, .beam = *f->beam};
    e->beam.nelement = 1;
    e->one.beam = &e->beam;
    e->one.element = &e->self;
    e->self.span = (struct ct_span){CT_EX_ZERO, ct_ex_sym(b->x, CT_SYM_LOCAL, "h", 0)};
    for (int j = 0; j < CT_DOF; j++) {
        const bool is_there = direction(j) >= 0 ? f->deformation & family[direction(j)]
                                                : f->deformation & CT_BEAM_TORSION;
        const bool is_extra = (j == CT_MIDDLE_DOF && !f->beam->has_quadratic_stretch)
                           || (j == CT_DOF - 1 && !f->beam->has_quadratic_twist);
        if (is_there && !is_extra)
            e->dof[e->ndof++] = j;
    }
}

static ct_ex mass_integral(struct ct_build *b, const struct element *e,
                           const struct ct_shape *p, const struct ct_shape *q)
{
    return ct_flexible_integral(b, &e->one, 0, e->beam.mass_per_length, p, q,
                                ct_flexible_mass_rule(&e->beam));
}

// The dofs along an axis, and their names.
static size_t dofs_along(const struct element *e, int axis, int *dof, const char **name)
{
    size_t n = 0;
    for (int i = 0; i < e->ndof; i++)
        if (direction(e->dof[i]) == axis) {
            dof[n] = e->dof[i];
            name[n++] = ct_beam_dof_name(e->dof[i]);
        }
    return n;
}

// (A.4), transposed: int mu N, N the shapes of the dofs along x, y, z.
static void put_first_integral(struct ct_derivation *d, const struct element *e)
{
    static const struct ct_shape one = {.c = {1}};
    ct_ex value[3 * CT_DOF] = {{0}};
    const char *name[CT_DOF];
    size_t n = 0;
    for (int axis = 0; axis < 3; axis++) {
        int dof[CT_DOF];
        const size_t first = n;
        n += dofs_along(e, axis, dof, name + n);
        for (size_t i = first; i < n; i++)
            value[3 * i + (size_t)axis]
                = mass_integral(d->e->build, e, shape_of(e, dof[i - first]), &one);
    }
    put_matrix(d, &(struct matrix){"S'", "\\bar{\\boldsymbol{S}}^{T}", "S' = int(mu*N')",
                                   "(A.4)", name, xyz, n, 3, value, false});
}

// (A.11): S_jk = int mu N_j' N_k; the sum of S_11, S_22, S_33 is S_SS (A.18).
static void put_second_integrals(struct ct_derivation *d, const struct element *e)
{
    for (int j = 0; j < 3; j++)
        for (int k = j; k < 3; k++) {
            int row[CT_DOF], column[CT_DOF];
            const char *row_name[CT_DOF], *column_name[CT_DOF];
            ct_ex value[CT_DOF * CT_DOF];
            const size_t m = dofs_along(e, j, row, row_name),
                         n = dofs_along(e, k, column, column_name);
            for (size_t i = 0; i < m; i++)
                for (size_t l = 0; l < n; l++)
                    value[i * n + l] = mass_integral(d->e->build, e, shape_of(e, row[i]),
                                                     shape_of(e, column[l]));
            if (m && n)
                put_matrix(
                    d, &(struct matrix){ct_arena_printf(d->a, "S_%d%d", j + 1, k + 1),
                                        ct_arena_printf(d->a, "\\bar{\\boldsymbol{S}}_{%d,%d}",
                                                        j + 1, k + 1),
                                        ct_arena_printf(d->a, "S_%d%d = int(mu*N_%d'*N_%d)",
                                                        j + 1, k + 1, j + 1, k + 1),
                                        j == k ? "(A.11), part of S_SS (A.18)" : "(A.11)",
                                        row_name, column_name, m, n, value, j == k});
        }
}

// (3.53), (3.62), (3.64), (3.74): the parts of K_f, as the program integrates them.
static void put_stiffness(struct ct_derivation *d, const struct element *e)
{
    static const struct {
        const char *name, *latex, *number;
        int from, to;
    } part[] = {{"K_fa", "\\boldsymbol{K}_{fa}", "(3.53)", 0, 2},
                {"K_fbz", "\\boldsymbol{K}_{fb,z}", "(3.62)", 2, 6},
                {"K_fby", "\\boldsymbol{K}_{fb,y}", "(3.64)", 6, CT_BENT_DOF},
                {"K_phi", "\\boldsymbol{K}_{\\phi}", "(3.74)", CT_AXIS_DOF, CT_DOF}};
    ct_ex K[CT_DOF][CT_DOF], M[CT_DOF][CT_DOF];
    ct_element_matrices(d->e->build, &e->one, 0, K, M);
    for (size_t p = 0; p < COUNT(part); p++) {
        const char *name[CT_DOF];
        ct_ex value[CT_DOF * CT_DOF];
        int dof[CT_DOF];
        size_t n = 0;
        for (int i = 0; i < e->ndof; i++) {
            const int j = e->dof[i];
            if ((j >= part[p].from && j < part[p].to) || (p == 0 && j == CT_MIDDLE_DOF)) {
                dof[n] = j;
                name[n++] = ct_beam_dof_name(j);
            }
        }
        for (size_t i = 0; i < n * n; i++)
            value[i] = K[dof[i / n]][dof[i % n]];
        if (n)
            put_matrix(d, &(struct matrix){part[p].name, part[p].latex, part[p].name,
                                           part[p].number, name, name, n, n, value, true});
    }
}

// Foreshortening: H, B_s and the integrals with them.
static void put_foreshortening(struct ct_derivation *d, const struct element *e)
{
    if (e->one.axial == CT_AXIAL_LINEAR)
        return;
    struct ct_build *b = d->e->build;
    static const struct ct_shape one = {.c = {1}};
    int dof[CT_DOF];
    const char *name[CT_DOF];
    ct_ex value[CT_DOF * CT_DOF];
    size_t n = 0;
    for (int axis = 1; axis < 3; axis++)
        n += dofs_along(e, axis, dof + n, name + n);
    for (size_t i = 0; i < n * n; i++) {
        const int j = dof[i / n], k = dof[i % n];
        const struct ct_shape *E = &e->one.shortening[(j - 2) % 4][(k - 2) % 4];
        value[i] = direction(j) != direction(k)
                     ? CT_EX_ZERO
                     : ct_ex_scale(b->x, -0.5, mass_integral(b, e, E, &one));
    }
    put_matrix(d, &(struct matrix){"int(mu*H)", "\\int \\mu \\, \\boldsymbol{H} \\, dx",
                                   "int(mu*H), H = -1/2*int(N_2,x'*N_2,x + N_3,x'*N_3,x)",
                                   "(3.108)", name, name, n, n, value, true});
    ct_page_heading(&d->page, "foreshortening (3.105) to (3.110)");
    ct_page_equations(&d->page);
    put(d, "B_s", "\\boldsymbol{B}_s", "q_f'*H", "\\boldsymbol{q}_f^{T} \\, \\boldsymbol{H}",
        "3.106: u_s = B_s q_f, plus the foreshortening of the elements before it");
    put(d, "B_H", "\\boldsymbol{B}_H", "[B_s, 0, 0]'", "(\\boldsymbol{B}_s,\\; 0,\\; 0)",
        "3.110; A.5 is int(mu*B_H): along x the row q_f' times the matrix above");
    put(d, "S_jBs", "\\boldsymbol{S}_{j,B_s}", "int(mu*N_j'*B_s)",
        "\\int \\mu \\, \\boldsymbol{N}_{j}^{T} \\, \\boldsymbol{B}_s \\, dx",
        "A.12, linear in q_f");
    put(d, "S_BsBs", "\\boldsymbol{S}_{B_s,B_s}", "int(mu*B_s'*B_s)",
        "\\int \\mu \\, \\boldsymbol{B}_s^{T} \\, \\boldsymbol{B}_s \\, dx",
        "A.13, and S_BHBH A.20, quadratic in q_f");
    put(d, "S_SBH", "\\boldsymbol{S}_{S,B_H}", "S_1Bs", "\\boldsymbol{S}_{1,B_s}", "A.19");
}

static bool varies(const struct ct_build *b, ct_ex v)
{
    return ct_ex_kinds(b->x, v) & 1u << CT_SYM_LOCAL;
}

void ct_beam_matrices_put_element(struct ct_derivation *d, const struct ct_flexible *f)
{
    struct ct_build *b = d->e->build;
    struct element e;
    if (varies(b, f->beam->mass_per_length) || varies(b, f->beam->area)
        || varies(b, f->beam->Iy) || varies(b, f->beam->Iz) || varies(b, f->beam->J)
        || varies(b, f->beam->E) || varies(b, f->beam->G))
        return;
    make_element(b, f, &e);
    ct_page_heading(&d->page,
                    ct_arena_printf(d->a,
                                    "shape integrals and stiffness of an element of %s, "
                                    "numbered as in Liang (2017)",
                                    f->name));
    ct_page_sentence(&d->page, "mu: mass per length; N_1, N_2, N_3: rows of the shape "
                               "functions of u, v, w by the dofs");
    put_first_integral(d, &e);
    put_second_integrals(d, &e);
    put_stiffness(d, &e);
    put_foreshortening(d, &e);
}

// ---- the beam ------------------------------------------------------------------------------

// Of a planar mechanism: is axis i of the beam the normal of the plane?
static bool turns_about(struct ct_build *b, const struct ct_flexible *f, int i)
{
    double v;
    const ct_ex n = ct_base_into(b, f, b->topology->normal).e[i];
    return !b->topology->is_planar || !ct_ex_is_const(b->x, n, &v) || v != 0;
}

// (4.15), (4.16), (4.19): the terminal equations in these matrices.
static void put_terminal(struct ct_derivation *d, const struct ct_flexible *f)
{
    const char *frame = d->e->build->topology->node[f->base].name;
    const char *a = ct_derivation_of(d, "a", frame), *al = ct_derivation_of(d, "al", frame);
    const bool latex = ct_derivation_is_latex(d);
    ct_page_equations(&d->page);
    ct_page_equation(
        &d->page, NULL, ct_derivation_of(d, "F", f->name),
        ct_arena_printf(
            d->a,
            latex ? "-\\boldsymbol{m}_{rr} \\, %s - \\boldsymbol{m}_{r\\theta} \\, %s - "
                    "\\boldsymbol{m}_{rf} \\, \\ddot{\\boldsymbol{q}}_f + "
                    "\\boldsymbol{Q}_{gr} + \\boldsymbol{Q}_{vr}"
                  : "-m_rr*%s - m_rtheta*%s - m_rf*q_f'' + Q_gr + Q_vr",
            a, al),
        "4.15");
    ct_page_equation(
        &d->page, NULL, ct_derivation_of(d, "T", f->name),
        ct_arena_printf(
            d->a,
            latex ? "-\\boldsymbol{m}_{r\\theta}^{T} \\, %s - "
                    "\\boldsymbol{m}_{\\theta\\theta} \\, %s - "
                    "\\boldsymbol{m}_{\\theta f} \\, \\ddot{\\boldsymbol{q}}_f + "
                    "\\boldsymbol{Q}_{g\\theta} + \\boldsymbol{Q}_{v\\theta}"
                  : "-m_rtheta'*%s - m_thetatheta*%s - m_thetaf*q_f'' + Q_gtheta + Q_vtheta",
            a, al),
        "4.16");
    ct_page_equation(
        &d->page, NULL, ct_derivation_effort(d, "q_f"),
        ct_arena_printf(d->a,
                        latex ? "-\\boldsymbol{m}_{rf}^{T} \\, %s - "
                                "\\boldsymbol{m}_{\\theta f}^{T} \\, %s - "
                                "\\boldsymbol{m}_{ff} \\, \\ddot{\\boldsymbol{q}}_f - "
                                "\\boldsymbol{K}_f \\, \\boldsymbol{q}_f + "
                                "\\boldsymbol{Q}_{gf} + \\boldsymbol{Q}_{vf}"
                              : "-m_rf'*%s - m_thetaf'*%s - m_ff*q_f'' - K_f*q_f + Q_gf + Q_vf",
                        a, al),
        f->axial == CT_AXIAL_LINEAR
            ? "4.19, F_fb"
            : "4.19, F_fb; with V_q for K_f q_f where it is not linear");
}

// m_rr ... m_thetatheta, of the undivided beam.
static void put_rigid(struct ct_derivation *d, const struct ct_flexible *f,
                      const struct ct_beam_parts *p)
{
    const struct ct_inertia *I = f->inertia;
    ct_ex3 s;
    ct_ex value[9];
    for (int i = 0; i < 3; i++)
        s.e[i] = ct_beam_parts_name(p, I->moment.e[i]);
    for (int i = 0; i < 9; i++)
        value[i] = ct_beam_parts_name(p, I->inertia.e[i % 3 * 3 + i / 3]); // by rows
    ct_page_equations(&d->page);
    put(d, "m_rr", "\\boldsymbol{m}_{rr}",
        ct_arena_printf(d->a, "%s*1", ct_derivation_text(d, I->mass)),
        ct_arena_printf(d->a, "%s \\, \\boldsymbol{1}", ct_derivation_text(d, I->mass)), "A.1");
    put(d, "m_rtheta", "\\boldsymbol{m}_{r\\theta}", "-A*skew(s)",
        "-\\boldsymbol{A} \\, \\tilde{\\boldsymbol{s}}", "A.2; skew(s) v = s x v");
    ct_page_equation(&d->page, NULL, pick(d, "s", "\\boldsymbol{s}"),
                     ct_derivation_vector(d, s), "A.3: first moment, axes of the beam");
    if (!d->e->build->topology->is_planar) {
        put_matrix(d, &(struct matrix){"m_thetatheta", "\\boldsymbol{m}_{\\theta\\theta}",
                                       "m_thetatheta", "(A.8), (A.9), (A.10)", xyz, xyz, 3, 3,
                                       value, true});
        return;
    }
    for (int i = 0; i < 3; i++)
        if (turns_about(d->e->build, f, i))
            ct_page_equation(
                &d->page, NULL, pick(d, "m_thetatheta", "\\boldsymbol{m}_{\\theta\\theta}"),
                ct_derivation_text(d, value[4 * i]), "A.8 to A.10, about the normal");
}

// (3.87), (3.92), (3.120): to the right side.
static void put_loads(struct ct_derivation *d)
{
    ct_page_heading(&d->page,
                    "weight Q_g (3.92) and quadratic velocity forces Q_v (3.87), (3.120)");
    ct_page_equations(&d->page);
    put(d, "Q_gr", "\\boldsymbol{Q}_{gr}", "m_rr*g", "\\boldsymbol{m}_{rr} \\, \\boldsymbol{g}",
        NULL);
    put(d, "Q_gtheta", "\\boldsymbol{Q}_{g\\theta}", "m_rtheta'*g",
        "\\boldsymbol{m}_{r\\theta}^{T} \\, \\boldsymbol{g}", NULL);
    put(d, "Q_gf", "\\boldsymbol{Q}_{gf}", "m_rf'*g",
        "\\boldsymbol{m}_{rf}^{T} \\, \\boldsymbol{g}", NULL);
    put(d, "Q_vr", "\\boldsymbol{Q}_{vr}", "-A*(w x (w x s) + F_v)",
        "-\\boldsymbol{A} \\, (\\boldsymbol{\\omega} \\times (\\boldsymbol{\\omega} \\times "
        "\\boldsymbol{s}) + \\boldsymbol{F}_{v})",
        "w: angular velocity of the frame");
    put(d, "Q_vtheta", "\\boldsymbol{Q}_{v\\theta}", "-(w x m_thetatheta*w + T_v)",
        "-(\\boldsymbol{\\omega} \\times \\boldsymbol{m}_{\\theta\\theta} \\, "
        "\\boldsymbol{\\omega} + \\boldsymbol{T}_{v})",
        NULL);
}

// Rows and columns of the elastic coordinates.
static void put_elastic(struct ct_derivation *d, const struct ct_flexible *f,
                        const struct ct_beam_parts *p)
{
    struct ct_build *b = d->e->build;
    struct ct_exs *x = b->x;
    const size_t n = (size_t)f->nelastic;
    const char **name = CT_NEWN(d->a, const char *, n + 1);
    struct ct_symmetric M = ct_symmetric_create(d->a, b->eqs->nu);
    ct_ex *m_rf = CT_NEWN(d->a, ct_ex, 3 * n + 1), *m_thetaf = CT_NEWN(d->a, ct_ex, 3 * n + 1),
          *mff = CT_NEWN(d->a, ct_ex, n * n + 1), *K = CT_NEWN(d->a, ct_ex, n * n + 1),
          *q = CT_NEWN(d->a, ct_ex, n + 1), *zero = CT_NEWN(d->a, ct_ex, n + 1),
          *force = CT_NEWN(d->a, ct_ex, n + 1);
    struct ct_elastic_columns c = {CT_NEWN(d->a, ct_ex3, n + 1), CT_NEWN(d->a, ct_ex3, n + 1)};
    ct_flexible_columns(b, f, &c, &M);
    for (size_t k = 0; k < n; k++) {
        name[k] = ct_derivation_name(d, f->elastic[k].name);
        q[k] = b->eqs->q[f->elastic[k].q].symbol;
        for (size_t i = 0; i < 3; i++) {
            m_rf[3 * k + i] = ct_beam_parts_name(p, c.m_rf[k].e[i]);
            m_thetaf[3 * k + i] = ct_beam_parts_name(p, c.m_thetaf[k].e[i]);
        }
    }
    ct_ex_gradient(x, d->a, ct_flexible_strain(b, f), q, n, force);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k <= i; k++) {
            const size_t row = (size_t)f->elastic[i].u, column = (size_t)f->elastic[k].u;
            mff[i * n + k] = ct_beam_parts_name( // column-major, the lower triangle
                p, ct_symmetric_get(&M, row, column));
            K[i * n + k] = ct_ex_subst(x, ct_ex_diff(x, force[i], q[k]), q, zero, n);
        }
    put_matrix(d, &(struct matrix){"(m_rf'*A)", "(\\boldsymbol{m}_{rf}^{T} \\boldsymbol{A})",
                                   "m_rf'*A", "(A.6), (A.7)", name, xyz, n, 3, m_rf, false});
    put_matrix(d, &(struct matrix){"m_thetaf'", "\\boldsymbol{m}_{\\theta f}^{T}", "m_thetaf'",
                                   "(A.14), (A.15)", name, xyz, n, 3, m_thetaf, false});
    put_matrix(d, &(struct matrix){"m_ff", "\\boldsymbol{m}_{ff}", "m_ff", "(A.16), (A.17)",
                                   name, name, n, n, mff, true});
    put_matrix(d, &(struct matrix){"K_f", "\\boldsymbol{K}_{f}", "K_f",
                                   f->axial == CT_AXIAL_LINEAR ? "(3.75), (3.76)"
                                                               : "(3.75), (3.76), at q_f = 0",
                                   name, name, n, n, K, true});
}

// Prints long ones with definitions for repeated subexpressions.
static void put_definitions(struct ct_derivation *d, const struct ct_definitions *list)
{
    const bool is_long = ct_beam_parts_are_long(d->e->x, list);
    ct_ex *value = CT_NEWN(d->a, ct_ex, list->n + 1),
          **where = CT_NEWN(d->a, ct_ex *, list->n + 1);
    struct ct_definitions shared = {0};
    double size;
    for (size_t i = 0; i < list->n; i++) {
        value[i] = list->at[i].value;
        where[i] = &value[i];
    }
    if (is_long)
        shared = ct_definitions_find(d->a, d->e, where, list->n, false, &size);
    ct_page_equations(&d->page);
    for (size_t i = 0; i < shared.n; i++)
        ct_page_equation(&d->page, NULL, ct_derivation_text(d, shared.at[i].symbol),
                         ct_derivation_text(d, shared.at[i].value), NULL);
    for (size_t i = 0; i < list->n; i++)
        ct_page_equation(&d->page, NULL, ct_derivation_text(d, list->at[i].symbol),
                         is_long ? ct_derivation_text(d, value[i]) : collected(d, value[i]),
                         NULL);
}

// of_frame: only the angular velocity of the frame, which depends on the inboard bodies;
// otherwise all else.
static struct ct_definitions some_parts(struct ct_derivation *d, const struct ct_beam_parts *p,
                                        bool of_frame)
{
    const struct ct_definitions *all = &p->definitions;
    struct ct_definitions list = {CT_NEWN(d->a, struct ct_reduced_definition, all->n + 1), 0};
    for (size_t i = 0; i < all->n; i++)
        if (!strncmp(ct_ex_symbol(d->e->x, all->at[i].symbol)->name, "om_", 3) == of_frame)
            list.at[list.n++] = all->at[i];
    return list;
}

static bool add_parts(struct ct_derivation *d, size_t i, struct ct_beam_parts *p)
{
    const enum ct_long_parts which
        = d->page.look == CT_LOOK_TEXT ? CT_LONG_PARTS_TOO : CT_LONG_PARTS_NONE;
    *p = (struct ct_beam_parts){0};
    return ct_beam_parts_add(d->a, d->e, i, which, p);
}

static void put_parts(struct ct_derivation *d, const struct ct_flexible *f,
                      const struct ct_beam_parts *p)
{
    const struct ct_definitions list = some_parts(d, p, false);
    if (!list.n)
        return;
    ct_page_heading(&d->page, ct_arena_printf(d->a, "entries of the matrices of %s", f->name));
    ct_page_sentence(
        &d->page,
        "Q_vf: quadratic velocity force (3.87), (3.120); F_v, T_v: its force and "
        "torque without those of s and m_thetatheta; V_q: elastic force, K_f q_f where "
        "it is linear");
    put_definitions(d, &list);
}

void ct_beam_matrices_put_angular_velocity(struct ct_derivation *d, size_t i)
{
    struct ct_beam_parts p;
    if (!add_parts(d, i, &p))
        return;
    const struct ct_definitions list = some_parts(d, &p, true);
    if (!list.n)
        return;
    ct_page_heading(
        &d->page, ct_arena_printf(d->a, "angular velocity of the frame of %s, in its own axes",
                                  d->e->build->flexible[i].name));
    put_definitions(d, &list);
}

void ct_beam_matrices_put(struct ct_derivation *d, size_t i)
{
    const struct ct_flexible *f = &d->e->build->flexible[i];
    struct ct_beam_parts p;
    ct_page_heading(
        &d->page,
        ct_arena_printf(d->a, "matrices of %s, numbered as in Liang (2017)", f->name));
    ct_page_sentence(&d->page,
                     "of (4.11): R'' of the frame in ground axes, w' in its own axes, "
                     "elastic coordinates q_f; A: rotation of the frame. Q_v stands on the "
                     "right side, so it is minus (3.87)");
    put_terminal(d, f);
    if (!add_parts(d, i, &p)) {
        ct_page_sentence(&d->page,
                         "m_rf, m_thetaf, m_ff and K_f of %d coordinates are not written out; "
                         "they are sums over the elements of the integrals above",
                         f->nelastic);
        return;
    }
    put_rigid(d, f, &p);
    put_elastic(d, f, &p);
    put_loads(d);
    put_parts(d, f, &p);
}
