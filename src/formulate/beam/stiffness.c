// Stiffness and damping of beams; see stiffness.h.
#include "formulate/beam/stiffness.h"
#include "expr/quadrature.h"
#include "formulate/beam/static_condensation.h"

#include <math.h>
#include <string.h>

// ---- stiffness and damping ----------------------------------------------------------------------

// Constant matrices of an element for its four dofs of a plane.
struct plane_matrices {
    ct_ex K[4][4], M[4][4], E[4][4];
};

// Shear angle: slope of the axis minus rotation of the section.
static struct ct_shape shear_of(const struct ct_bending *s, int j)
{
    struct ct_shape shear = s->slope[j];
    if (ct_shape_is_zero(&shear))
        shear.power = s->rotation[j].power;
    // both have the same power of the length, or one of them is zero
    for (int i = 0; i < CT_SHAPE_SIZE; i++)
        shear.c[i] -= s->rotation[j].c[i];
    return shear;
}

static struct plane_matrices plane_matrices(struct ct_build *b, const struct ct_flexible *f,
                                            int e, int plane)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = f->beam;
    const enum ct_rule rule = ct_flexible_stiffness_rule(beam),
                       mass = ct_flexible_mass_rule(beam);
    const ct_ex second = plane ? beam->Iy : beam->Iz, EI = ct_ex_mul(x, beam->E, second);
    const ct_ex GA = ct_flexible_shear(b, f, plane);
    const ct_ex radius = beam->higher_order ? ct_ex_div(x, second, beam->area) : CT_EX_ZERO;
    const ct_ex J = ct_flexible_rotary(f, plane ? 1 : 2).value;
    struct plane_matrices s = {0};
    struct ct_shape bend[4], shear[4];
    for (int j = 0; j < 4; j++) {
        bend[j] = ct_shape_slope(&f->shape.rotation[j]);
        shear[j] = shear_of(&f->shape, j);
    }
    for (int j = 0; j < 4; j++)
        for (int k = 0; k < 4; k++) {
            s.K[j][k]
                = ct_ex_add(x, ct_flexible_integral(b, f, e, EI, &bend[j], &bend[k], rule),
                            ct_flexible_integral(b, f, e, GA, &shear[j], &shear[k], rule));
            s.M[j][k] = ct_ex_add(x,
                                  ct_flexible_integral(b, f, e, beam->mass_per_length,
                                                       &f->shape.deflection[j],
                                                       &f->shape.deflection[k], mass),
                                  ct_flexible_integral(b, f, e, J, &f->shape.rotation[j],
                                                       &f->shape.rotation[k], mass));
            s.E[j][k]
                = ct_ex_add(x,
                            ct_flexible_integral(b, f, e, CT_EX_ONE, &f->shape.slope[j],
                                                 &f->shape.slope[k], rule),
                            ct_flexible_integral(b, f, e, radius, &bend[j], &bend[k], rule));
        }
    return s;
}

// Stretch and twist: matrices of stiffness k (slopes) and mass m per length.
struct line_matrices {
    ct_ex K[CT_LINE_DOF][CT_LINE_DOF], M[CT_LINE_DOF][CT_LINE_DOF];
};

static struct line_matrices line_matrices(struct ct_build *b, const struct ct_flexible *f,
                                          int e, ct_ex k, ct_ex m)
{
    struct line_matrices s;
    for (int i = 0; i < CT_LINE_DOF; i++)
        for (int j = 0; j < CT_LINE_DOF; j++) {
            const struct ct_shape di = ct_shape_slope(&f->line[i]),
                                  dj = ct_shape_slope(&f->line[j]);
            s.K[i][j] = ct_flexible_integral(b, f, e, k, &di, &dj,
                                             ct_flexible_stiffness_rule(f->beam));
            s.M[i][j] = ct_flexible_integral(b, f, e, m, &f->line[i], &f->line[j],
                                             ct_flexible_mass_rule(f->beam));
        }
    return s;
}

static struct line_matrices stretch_matrices(struct ct_build *b, const struct ct_flexible *f,
                                             int e)
{
    return line_matrices(b, f, e, ct_ex_mul(b->x, f->beam->E, f->beam->area),
                         f->beam->mass_per_length);
}

static struct line_matrices twist_matrices(struct ct_build *b, const struct ct_flexible *f,
                                           int e)
{
    return line_matrices(b, f, e, ct_ex_mul(b->x, f->beam->G, f->beam->J),
                         ct_flexible_rotary(f, 0).value);
}

void ct_element_matrices(struct ct_build *b, const struct ct_flexible *f, int e,
                         ct_ex K[CT_DOF][CT_DOF], ct_ex M[CT_DOF][CT_DOF])
{
    memset(K, 0, sizeof(ct_ex[CT_DOF][CT_DOF]));
    memset(M, 0, sizeof(ct_ex[CT_DOF][CT_DOF]));
    const struct line_matrices u = stretch_matrices(b, f, e), p = twist_matrices(b, f, e);
    for (int i = 0; i < CT_LINE_DOF; i++)
        for (int j = 0; j < CT_LINE_DOF; j++) {
            const int si = ct_stretch_dof(i), sj = ct_stretch_dof(j);
            K[si][sj] = u.K[i][j];
            M[si][sj] = u.M[i][j];
            K[CT_AXIS_DOF + i][CT_AXIS_DOF + j] = p.K[i][j];
            M[CT_AXIS_DOF + i][CT_AXIS_DOF + j] = p.M[i][j];
        }
    for (int plane = 0; plane < 2; plane++) {
        const int first = plane ? 6 : 2;
        const struct plane_matrices s = plane_matrices(b, f, e, plane);
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) {
                K[first + i][first + j] = s.K[i][j];
                M[first + i][first + j] = s.M[i][j];
            }
    }
}

static ct_ex product(struct ct_build *b, const ct_ex row[4], const ct_ex *v)
{
    ct_ex sum = CT_EX_ZERO;
    for (int i = 0; i < 4; i++)
        sum = ct_ex_add(b->x, sum, ct_ex_mul(b->x, row[i], v[i]));
    return sum;
}

static void bend_element(struct ct_build *b, const struct ct_flexible *f, int e, int plane,
                         const struct plane_matrices *s, struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = f->beam;
    const int first = plane ? 6 : 2;
    const ct_ex *a = f->element[e].value + first, *r = f->element[e].rate + first;
    for (int j = 0; j < 4; j++) {
        const ct_ex elastic = product(b, s->K[j], a);
        ct_ex drag = ct_ex_mul(x, beam->damping_stiffness, product(b, s->K[j], r));
        drag = ct_ex_add(x, drag, ct_ex_mul(x, beam->damping_mass, product(b, s->M[j], r)));
        out->row[first + j] = ct_ex_add(x, out->row[first + j], ct_ex_add(x, elastic, drag));
        out->energy
            = ct_ex_add(x, out->energy, ct_ex_scale(x, 0.5, ct_ex_mul(x, a[j], elastic)));
        out->drag = ct_ex_add(x, out->drag, ct_ex_mul(x, r[j], drag));
    }
}

// Stretch of the element: difference of s at its nodes; in LOCAL coordinates from positions and
// slopes.
struct stretch {
    ct_ex value, rate;
    ct_ex slope[CT_BENT_DOF];
};

static struct stretch stretch_of(struct ct_build *b, const struct ct_flexible *f, int e,
                                 const struct plane_matrices plane[2])
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[e];
    struct stretch s = {.value = ct_ex_sub(x, self->value[1], self->value[0]),
                        .rate = ct_ex_sub(x, self->rate[1], self->rate[0])};
    s.slope[0] = ct_ex_const(x, -1);
    s.slope[1] = CT_EX_ONE;
    for (int k = 0; k < 2 && f->axial == CT_AXIAL_LOCAL; k++)
        for (int j = 0; j < 4; j++) {
            const int dof = (k ? 6 : 2) + j;
            const ct_ex Ea = product(b, plane[k].E[j], self->value + (k ? 6 : 2));
            s.slope[dof] = Ea;
            s.value = ct_ex_add(x, s.value,
                                ct_ex_scale(x, 0.5, ct_ex_mul(x, Ea, self->value[dof])));
            s.rate = ct_ex_add(x, s.rate, ct_ex_mul(x, Ea, self->rate[dof]));
        }
    return s;
}

// Two coefficients of the strain: s.value/h, constant, and that of the mid-element freedom.
static void stretch_element(struct ct_build *b, const struct ct_flexible *f, int e,
                            const struct plane_matrices plane[2], struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = f->beam;
    const struct ct_element *self = &f->element[e];
    const struct stretch s = stretch_of(b, f, e, plane);
    const struct line_matrices line = stretch_matrices(b, f, e);
    const ct_ex value[2] = {s.value, self->value[CT_MIDDLE_DOF]},
                rate[2] = {s.rate, self->rate[CT_MIDDLE_DOF]};
    ct_ex N[2];
    for (int i = 0; i < 2; i++) {
        const ct_ex *K = line.K[1 + i];
        const ct_ex elastic
            = ct_ex_add(x, ct_ex_mul(x, K[1], value[0]), ct_ex_mul(x, K[2], value[1]));
        const ct_ex drag
            = ct_ex_mul(x, beam->damping_stiffness,
                        ct_ex_add(x, ct_ex_mul(x, K[1], rate[0]), ct_ex_mul(x, K[2], rate[1])));
        N[i] = ct_ex_add(x, elastic, drag);
        out->energy
            = ct_ex_add(x, out->energy, ct_ex_scale(x, 0.5, ct_ex_mul(x, elastic, value[i])));
        out->drag = ct_ex_add(x, out->drag, ct_ex_mul(x, drag, rate[i]));
    }
    for (int j = 0; j < CT_BENT_DOF; j++)
        out->row[j] = ct_ex_add(x, out->row[j], ct_ex_mul(x, N[0], s.slope[j]));
    out->row[CT_MIDDLE_DOF] = ct_ex_add(x, out->row[CT_MIDDLE_DOF], N[1]);
    for (int j = 0; j < CT_LINE_DOF && !ct_ex_is_zero(beam->damping_mass); j++)
        for (int i = 0; i < CT_LINE_DOF; i++) {
            const int p = ct_stretch_dof(j), q = ct_stretch_dof(i);
            const ct_ex v
                = ct_ex_mul(x, beam->damping_mass, ct_ex_mul(x, line.M[j][i], self->rate[q]));
            out->row[p] = ct_ex_add(x, out->row[p], v);
            out->drag = ct_ex_add(x, out->drag, ct_ex_mul(x, v, self->rate[p]));
        }
}

static void twist_element(struct ct_build *b, const struct ct_flexible *f, int e,
                          struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = f->beam;
    const ct_ex *value = f->element[e].value + CT_AXIS_DOF;
    const ct_ex *rate = f->element[e].rate + CT_AXIS_DOF;
    const struct line_matrices line = twist_matrices(b, f, e);
    for (int j = 0; j < CT_LINE_DOF; j++) {
        ct_ex elastic = CT_EX_ZERO, drag = CT_EX_ZERO;
        for (int k = 0; k < CT_LINE_DOF; k++) {
            const ct_ex C = ct_ex_add(x, ct_ex_mul(x, beam->damping_stiffness, line.K[j][k]),
                                      ct_ex_mul(x, beam->damping_mass, line.M[j][k]));
            elastic = ct_ex_add(x, elastic, ct_ex_mul(x, line.K[j][k], value[k]));
            drag = ct_ex_add(x, drag, ct_ex_mul(x, C, rate[k]));
        }
        ct_ex *row = &out->row[CT_AXIS_DOF + j];
        *row = ct_ex_add(x, *row, ct_ex_add(x, elastic, drag));
        out->energy
            = ct_ex_add(x, out->energy, ct_ex_scale(x, 0.5, ct_ex_mul(x, elastic, value[j])));
        out->drag = ct_ex_add(x, out->drag, ct_ex_mul(x, drag, rate[j]));
    }
}

// ---- twist with bending -------------------------------------------------------------------------

static bool couples(const struct ct_flexible *f)
{
    const unsigned all = CT_BEAM_TORSION | CT_BEAM_BENDING_Y | CT_BEAM_BENDING_Z;
    return f->formulation == CT_BEAM_FORESHORTENING && (f->deformation & all) == all;
}

// An angle of the section and its slope at a point, by n dofs of an element.
struct angle {
    ct_ex value, slope;
    ct_ex shape[4], shape_slope[4];
};

static struct angle angle_at(struct ct_build *b, const struct ct_shape *shape, int n,
                             const ct_ex *dof, ct_ex xi, ct_ex h)
{
    struct ct_exs *x = b->x;
    struct angle a = {.value = CT_EX_ZERO};
    for (int i = 0; i < n; i++) {
        const struct ct_shape d = ct_shape_slope(&shape[i]);
        a.shape[i] = ct_shape_at(x, &shape[i], xi, h);
        a.shape_slope[i] = ct_shape_at(x, &d, xi, h);
        a.value = ct_ex_add(x, a.value, ct_ex_mul(x, a.shape[i], dof[i]));
        a.slope = ct_ex_add(x, a.slope, ct_ex_mul(x, a.shape_slope[i], dof[i]));
    }
    return a;
}

static void push_angle(struct ct_build *b, const struct angle *a, int n, ct_ex by_value,
                       ct_ex by_slope, ct_ex *row)
{
    struct ct_exs *x = b->x;
    for (int i = 0; i < n; i++) {
        const ct_ex v = ct_ex_add(x, ct_ex_mul(x, a->shape[i], by_value),
                                  ct_ex_mul(x, a->shape_slope[i], by_slope));
        row[i] = ct_ex_add(x, row[i], v);
    }
}

// Squares of curvatures, evaluated at n points and interpolated between them. With constant
// sections these are Gauss points, exact for linear functions in an element. Definition: two.
enum { MOST_POINTS = 2 };

struct squares {
    int n;
    double xi[MOST_POINTS];
    ct_ex W[MOST_POINTS]
           [MOST_POINTS]; // int stiffness L_i L_j dx, L_i: 1 at point i, 0 at the other
};

// n: one more than the degree of the sections' curvatures.
static struct squares squares_of(struct ct_build *b, const struct ct_flexible *f, int e, int n,
                                 ct_ex stiffness)
{
    static const struct ct_shape one = {.c = {1}};
    const enum ct_rule rule = ct_flexible_stiffness_rule(f->beam);
    const bool varies = ct_ex_kinds(b->x, stiffness) & 1u << CT_SYM_LOCAL;
    struct squares s = {.n = n};
    double weight[MOST_POINTS];
    ct_gauss(n, s.xi, weight);
    struct ct_shape L[MOST_POINTS] = {one, one};
    if (n == 2)
        for (int i = 0; i < 2; i++) {
            const double other = s.xi[1 - i], d = s.xi[i] - other;
            L[i] = (struct ct_shape){.c = {-other / d, 1 / d}};
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            if (varies || rule == CT_RULE_MIDDLE)
                s.W[i][j] = ct_flexible_integral(b, f, e, stiffness, &L[i], &L[j], rule);
            else if (i == j)
                s.W[i][i]
                    = ct_ex_scale(b->x, weight[i],
                                  ct_flexible_integral(b, f, e, stiffness, &one, &one, rule));
    return s;
}

// Adds (k + a)' W (k + a)/2 - k' W k/2 to the energy; by_k, by_a (out): its derivatives.
static void add_square(struct ct_exs *x, const struct squares *s, const ct_ex *k,
                       const ct_ex *a, ct_ex *by_k, ct_ex *by_a, ct_ex *energy)
{
    for (int i = 0; i < s->n; i++) {
        ct_ex known = CT_EX_ZERO;
        by_k[i] = CT_EX_ZERO;
        for (int j = 0; j < s->n; j++) {
            known = ct_ex_add_product(x, known, s->W[i][j], k[j]);
            by_k[i] = ct_ex_add_product(x, by_k[i], s->W[i][j], a[j]);
        }
        by_a[i] = ct_ex_add(x, known, by_k[i]);
        const ct_ex twice
            = ct_ex_add(x, ct_ex_mul(x, by_a[i], a[i]), ct_ex_mul(x, by_k[i], k[i]));
        *energy = ct_ex_add(x, *energy, ct_ex_scale(x, 0.5, twice));
    }
}

// Bending rotates the axis of twist, and twist rotates the axes of bending.  (5.6b)
static void couple_curvatures(struct ct_build *b, const struct ct_flexible *f, int e,
                              struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const struct ct_beam *beam = f->beam;
    const struct ct_element *self = &f->element[e];
    const ct_ex h = self->span.length;
    const int n = beam->theory == CT_BEAM_EULER_BERNOULLI ? 2 : 1;
    const ct_ex stiff[2] = {ct_ex_mul(x, beam->E, ct_stiffer(x, beam->Iz, beam->Iy)),
                            ct_ex_mul(x, beam->E, ct_stiffer(x, beam->Iy, beam->Iz))};
    const struct squares torsion = squares_of(b, f, e, n, ct_ex_mul(x, beam->G, beam->J)),
                         z = squares_of(b, f, e, n, stiff[0]),
                         y = squares_of(b, f, e, n, stiff[1]);
    struct angle p[MOST_POINTS], g[MOST_POINTS], w[MOST_POINTS]; // w: -b
    ct_ex turn[MOST_POINTS], along_z[MOST_POINTS], along_y[MOST_POINTS], kp[MOST_POINTS],
        kg[MOST_POINTS], kw[MOST_POINTS];
    for (int i = 0; i < n; i++) {
        const ct_ex xi = ct_ex_const(x, torsion.xi[i]);
        p[i] = angle_at(b, f->line, CT_LINE_DOF, self->value + CT_AXIS_DOF, xi, h);
        g[i] = angle_at(b, f->shape.rotation, 4, self->value + 2, xi, h);
        w[i] = angle_at(b, f->shape.rotation, 4, self->value + 6, xi, h);
        kp[i] = p[i].slope;
        kg[i] = g[i].slope;
        kw[i] = w[i].slope;
        turn[i] = ct_ex_scale(
            x, 0.5,
            ct_ex_sub(x, ct_ex_mul(x, kg[i], w[i].value), ct_ex_mul(x, kw[i], g[i].value)));
        along_z[i] = ct_ex_mul(x, p[i].value, kw[i]);
        along_y[i] = ct_ex_neg(x, ct_ex_mul(x, p[i].value, kg[i]));
    }
    ct_ex Tp[MOST_POINTS], T[MOST_POINTS], Mg[MOST_POINTS], M[MOST_POINTS], Nw[MOST_POINTS],
        N[MOST_POINTS];
    add_square(x, &torsion, kp, turn, Tp, T, &out->energy); // p' + (g' w - w' g)/2
    add_square(x, &z, kg, along_z, Mg, M, &out->energy);    // g' + p w'
    add_square(x, &y, kw, along_y, Nw, N, &out->energy);    // w' - p g'
    for (int i = 0; i < n; i++) {
        const ct_ex half = ct_ex_scale(x, 0.5, T[i]);
        const ct_ex by_p = ct_ex_sub(x, ct_ex_mul(x, M[i], kw[i]), ct_ex_mul(x, N[i], kg[i]));
        const ct_ex by_g = ct_ex_add(
            x, Mg[i],
            ct_ex_sub(x, ct_ex_mul(x, half, w[i].value), ct_ex_mul(x, N[i], p[i].value)));
        const ct_ex by_w = ct_ex_add(
            x, Nw[i],
            ct_ex_sub(x, ct_ex_mul(x, M[i], p[i].value), ct_ex_mul(x, half, g[i].value)));
        push_angle(b, &p[i], CT_LINE_DOF, by_p, Tp[i], out->row + CT_AXIS_DOF);
        push_angle(b, &g[i], 4, ct_ex_neg(x, ct_ex_mul(x, half, kw[i])), by_g, out->row + 2);
        push_angle(b, &w[i], 4, ct_ex_mul(x, half, kg[i]), by_w, out->row + 6);
    }
}

// Twist rotates the axes of shear: (k_y - k_z) G area p gy gz.  (5.6b)
static void couple_shear(struct ct_build *b, const struct ct_flexible *f, int e, ct_ex xi,
                         ct_ex GA, struct ct_element_force *out)
{
    struct ct_exs *x = b->x;
    const struct ct_element *self = &f->element[e];
    const ct_ex h = self->span.length;
    struct ct_shape shear[4];
    for (int j = 0; j < 4; j++)
        shear[j] = shear_of(&f->shape, j);
    const struct angle p = angle_at(b, f->line, CT_LINE_DOF, self->value + CT_AXIS_DOF, xi, h),
                       y = angle_at(b, shear, 4, self->value + 2, xi, h),
                       z = angle_at(b, shear, 4, self->value + 6, xi, h);
    const ct_ex torque = ct_ex_mul(x, GA, ct_ex_mul(x, y.value, z.value)),
                force = ct_ex_mul(x, GA, p.value);
    push_angle(b, &p, CT_LINE_DOF, torque, CT_EX_ZERO, out->row + CT_AXIS_DOF);
    push_angle(b, &y, 4, ct_ex_mul(x, force, z.value), CT_EX_ZERO, out->row + 2);
    push_angle(b, &z, 4, ct_ex_mul(x, force, y.value), CT_EX_ZERO, out->row + 6);
    out->energy = ct_ex_add(x, out->energy, ct_ex_mul(x, p.value, torque));
}

static void couple_element(struct ct_build *b, const struct ct_flexible *f, int e,
                           struct ct_element_force *out)
{
    enum { SHEAR_POINTS = 2 }; // Derived: exact where sections are constant and twist is linear
    struct ct_exs *x = b->x;
    const struct ct_profile shear
        = {f->beam->x, ct_ex_sub(x, ct_flexible_shear(b, f, 0), ct_flexible_shear(b, f, 1))};
    const bool varies = ct_ex_kinds(x, shear.value) & 1u << CT_SYM_LOCAL;
    double xi[CT_MAX_GAUSS];
    ct_ex GA[CT_MAX_GAUSS];
    couple_curvatures(b, f, e, out);
    if (ct_ex_is_zero(shear.value))
        return;
    const int wanted = varies                       ? CT_MAX_GAUSS
                     : f->beam->has_quadratic_twist ? SHEAR_POINTS + 1
                                                    : SHEAR_POINTS;
    const int n = ct_shape_points(x, &shear, &f->element[e].span,
                                  ct_flexible_stiffness_rule(f->beam), wanted, xi, GA);
    for (int i = 0; i < n; i++)
        couple_shear(b, f, e, ct_ex_const(x, xi[i]), GA[i], out);
}

// ---- elements -----------------------------------------------------------------------------------

static struct ct_element_force element_force(struct ct_build *b, const struct ct_flexible *f,
                                             int e)
{
    struct ct_element_force out = {0};
    if (ct_stiffness_has_legendre(b, f))
        return ct_element_force_legendre(b, f, e);
    struct plane_matrices plane[2];
    for (int k = 0; k < 2; k++) {
        const bool bends = f->deformation & (k ? CT_BEAM_BENDING_Y : CT_BEAM_BENDING_Z);
        plane[k] = bends ? plane_matrices(b, f, e, k) : (struct plane_matrices){0};
        if (bends)
            bend_element(b, f, e, k, &plane[k], &out);
    }
    if (f->deformation & CT_BEAM_AXIAL)
        stretch_element(b, f, e, plane, &out);
    if (f->deformation & CT_BEAM_TORSION)
        twist_element(b, f, e, &out);
    if (couples(f))
        couple_element(b, f, e, &out);
    return out;
}

void ct_stiffness_rows(struct ct_build *b, const struct ct_flexible *f, ct_ex *by_freedom)
{
    const bool is_linear = f->axial != CT_AXIAL_LOCAL && !couples(f);
    for (int e = 0; e < f->beam->nelement; e++) {
        const struct ct_element_force s = element_force(b, f, e);
        for (int j = 0; j < CT_DOF; j++) {
            const int i = f->element[e].freedom[j];
            if (i >= 0 && !(is_linear && ct_freedom_is_balanced(f, i)))
                ct_dof_push(b, f, e, j, s.row[j], by_freedom);
        }
    }
}

ct_ex ct_flexible_strain(struct ct_build *b, const struct ct_flexible *f)
{
    ct_ex sum = CT_EX_ZERO;
    for (int e = 0; e < f->beam->nelement; e++)
        sum = ct_ex_add(b->x, sum, element_force(b, f, e).energy);
    return sum;
}

ct_ex ct_flexible_dissipation(struct ct_build *b)
{
    ct_ex sum = CT_EX_ZERO;
    for (size_t i = 0; i < b->nflexible; i++)
        for (int e = 0; e < b->flexible[i].beam->nelement; e++)
            sum = ct_ex_sub(b->x, sum, element_force(b, &b->flexible[i], e).drag);
    return sum;
}
