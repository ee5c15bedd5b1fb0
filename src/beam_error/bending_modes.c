// See bending_modes.h.
#include "beam_error/bending_modes.h"
#include "expr/quadrature.h"
#include "formulate/beam_dynamics/beam_dynamics.h"
#include "formulate/beam/beam_field.h"
#include "formulate/beam/attached_bodies.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

// Definition: as CT_ELEMENT_POINTS. Limit: of inverse iteration, after which a mode is omitted
enum { POINTS = 8, MOST_ITERATIONS = 200 };
// Derived: the error of a frequency is the square of that of the shape (Rayleigh quotient), which
// is then 1e-6
static const double frequency_tolerance = 1e-12; // relative change of a frequency
// Derived: 50^2 at 50 times the first frequency: the dynamic part of such a shape is 1/2500 of
// its static part
static const double farthest
    = 2500; // omega^2 relative to the first: faster shapes respond statically

// ---- numbers along the beam ---------------------------------------------------------------------

struct lump { // a body that a weld connects to a point of the beam
    double mass, x;
};

struct line {
    struct ct_build *b;
    const struct ct_flexible *f;
    int plane; // 0: along y, 1: along z
    int n,
        band;      // number of freedoms in this plane; half bandwidth of its matrices
    int *number;   // by freedom; -1: fixed, or not in this plane
    double *K, *M; // lower triangles, A(i, j) at i - j + (band + 1) j
    double *Kg[2]; // geometric stiffness with P1, P2
    double *base_coupling[2]; // int shape m dx, int shape m x dx
    // by element and one more: int m x and int m from its start to the end of the beam (2 x)
    double *beyond;
    double *value; // of symbols
    struct lump *lump;
    size_t nlump;
    double xi[POINTS], weight[POINTS];
};

static double number(const struct line *s, ct_ex e)
{
    return ct_ex_value(s->b->x, e, s->value);
}

static double profile(const struct line *s, ct_ex g, int e, double xi)
{
    const struct ct_span *span = &s->f->element[e].span;
    const ct_ex x = s->f->beam->x;
    if (ct_ex_kinds(s->b->x, g) & 1u << CT_SYM_LOCAL)
        s->value[ct_ex_node(s->b->x, x)->a]
            = number(s, span->start) + xi * number(s, span->length);
    return number(s, g);
}

static void list_lumps(struct line *s)
{
    const struct ct_model *m = s->b->model;
    const double *place = ct_attached_bodies_find(s->b, s->f);
    s->lump = CT_NEWN(s->b->ctx->scratch, struct lump, m->nbody);
    for (size_t i = 1; i < m->nbody; i++)
        if (!isnan(place[i]))
            s->lump[s->nlump++] = (struct lump){
                .x = place[i], .mass = ct_ex_value(s->b->x, m->body[i].mass, s->b->value)};
}

// P (2, out) = int m x and int m over element e, from xi to its end.
static void mass_within(const struct line *s, int e, double xi, double P[2])
{
    const double start = number(s, s->f->element[e].span.start),
                 h = number(s, s->f->element[e].span.length);
    P[0] = P[1] = 0;
    for (int k = 0; k < POINTS; k++) {
        const double at = xi + (1 - xi) * s->xi[k];
        const double dm
            = s->weight[k] * (1 - xi) * h * profile(s, s->f->beam->mass_per_length, e, at);
        P[0] += dm * (start + at * h);
        P[1] += dm;
    }
}

static void sum_masses(struct line *s)
{
    const int n = s->f->beam->nelement;
    s->beyond = CT_NEWN(s->b->ctx->scratch, double, 2 * (n + 1));
    for (int e = n; e-- > 0;) {
        double P[2];
        mass_within(s, e, 0, P);
        for (int i = 0; i < 2; i++)
            s->beyond[2 * e + i] = s->beyond[2 * e + 2 + i] + P[i];
    }
}

// int_x^L of m x and of m, where x is at xi of element e, welded masses included.
static void mass_beyond(const struct line *s, int e, double xi, double P[2])
{
    const double here
        = number(s, s->f->element[e].span.start) + xi * number(s, s->f->element[e].span.length);
    mass_within(s, e, xi, P);
    for (int i = 0; i < 2; i++)
        P[i] += s->beyond[2 * e + 2 + i];
    for (size_t j = 0; j < s->nlump; j++)
        if (s->lump[j].x > here) {
            P[0] += s->lump[j].mass * s->lump[j].x;
            P[1] += s->lump[j].mass;
        }
}

// Element and its xi at position x.
static int element_at(const struct line *s, double x, double *xi)
{
    int e = 0;
    while (e + 1 < s->f->beam->nelement && x > number(s, s->f->beam->end[e]))
        e++;
    *xi = (x - number(s, s->f->element[e].span.start))
        / number(s, s->f->element[e].span.length);
    return e;
}

// ---- matrices of a plane ------------------------------------------------------------------------

static void add(struct line *s, double *A, int e, int j, int k, double v)
{
    const int first = s->plane ? 6 : 2;
    const int p = s->f->element[e].freedom[first + j], q = s->f->element[e].freedom[first + k];
    if (p < 0 || q < 0 || s->number[p] < s->number[q])
        return;
    const bool opposed = s->plane && (j % 2) != (k % 2); // dw/dx = -ry
    A[s->number[p] - s->number[q] + (s->band + 1) * s->number[q]] += opposed ? -v : v;
}

// Add the coupling of a mass at x in element e to the motion of the base; place: shape functions
// there.
static void add_base_coupling(struct line *s, int e, double mass, double x,
                              const double place[4])
{
    for (int j = 0; j < 4; j++) {
        const int p = s->f->element[e].freedom[(s->plane ? 6 : 2) + j];
        if (p < 0)
            continue;
        const double share = (s->plane && j % 2 ? -mass : mass) * place[j]; // dw/dx = -ry
        s->base_coupling[0][s->number[p]] += share;
        s->base_coupling[1][s->number[p]] += share * x;
    }
}

// Bending and shear stiffness at the integration points of the beam itself; one in the middle
// prevents locking of linear shapes.
static void add_stiffness(struct line *s, int e)
{
    const struct ct_beam *beam = s->f->beam;
    const double h = number(s, s->f->element[e].span.length);
    const ct_ex EI = ct_ex_mul(s->b->x, beam->E, s->plane ? beam->Iy : beam->Iz);
    const ct_ex GA = ct_flexible_shear(s->b, s->f, s->plane);
    const bool in_middle = ct_flexible_stiffness_rule(beam) == CT_RULE_MIDDLE;
    for (int i = 0; i < (in_middle ? 1 : POINTS); i++) {
        const double xi = in_middle ? 0.5 : s->xi[i], w = (in_middle ? 1 : s->weight[i]) * h,
                     stiffness = w * profile(s, EI, e, xi), shear = w * profile(s, GA, e, xi);
        double bend[4], lean[4];
        for (int j = 0; j < 4; j++) {
            const struct ct_shape d = ct_shape_slope(&s->f->shape.rotation[j]);
            bend[j] = ct_shape_value(&d, xi, h);
            lean[j] = ct_shape_value(&s->f->shape.slope[j], xi, h)
                    - ct_shape_value(&s->f->shape.rotation[j], xi, h);
        }
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                add(s, s->K, e, j, k,
                    stiffness * bend[j] * bend[k] + shear * lean[j] * lean[k]);
    }
}

// Mass and rotary inertia at the integration points of the beam itself.
static void add_mass(struct line *s, int e)
{
    const struct ct_beam *beam = s->f->beam;
    const struct ct_span *span = &s->f->element[e].span;
    const struct ct_profile mass = {beam->x, beam->mass_per_length},
                            rotary = ct_flexible_rotary(s->f, s->plane ? 1 : 2);
    const enum ct_rule rule = ct_flexible_mass_rule(beam);
    const double h = number(s, span->length);
    double xi[CT_MAX_GAUSS];
    ct_ex m_of[CT_MAX_GAUSS], J_of[CT_MAX_GAUSS];
    const int n = ct_shape_points(s->b->x, &mass, span, rule, POINTS, xi, m_of);
    ct_shape_points(s->b->x, &rotary, span, rule, POINTS, xi, J_of);
    for (int i = 0; i < n; i++) {
        const double m = number(s, m_of[i]), J = number(s, J_of[i]);
        double place[4], turn[4];
        for (int j = 0; j < 4; j++) {
            place[j] = ct_shape_value(&s->f->shape.deflection[j], xi[i], h);
            turn[j] = ct_shape_value(&s->f->shape.rotation[j], xi[i], h);
        }
        add_base_coupling(s, e, m, number(s, span->start) + xi[i] * h, place);
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                add(s, s->M, e, j, k, m * place[j] * place[k] + J * turn[j] * turn[k]);
    }
}

static void add_element(struct line *s, int e)
{
    const double h = number(s, s->f->element[e].span.length);
    add_stiffness(s, e);
    add_mass(s, e);
    for (int i = 0; i < POINTS; i++) {
        const double xi = s->xi[i], w = s->weight[i] * h;
        double slope[4], P[2];
        for (int j = 0; j < 4; j++)
            slope[j] = ct_shape_value(&s->f->shape.slope[j], xi, h);
        mass_beyond(s, e, xi, P);
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++) {
                add(s, s->Kg[0], e, j, k, w * P[0] * slope[j] * slope[k]);
                add(s, s->Kg[1], e, j, k, w * P[1] * slope[j] * slope[k]);
            }
    }
}

// Add the welded masses, which move with the shape at their point.
static void add_lumps(struct line *s)
{
    for (size_t i = 0; i < s->nlump; i++) {
        double xi, place[4];
        const int e = element_at(s, s->lump[i].x, &xi);
        const double h = number(s, s->f->element[e].span.length);
        for (int j = 0; j < 4; j++)
            place[j] = ct_shape_value(&s->f->shape.deflection[j], xi, h);
        add_base_coupling(s, e, s->lump[i].mass, s->lump[i].x, place);
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                add(s, s->M, e, j, k, s->lump[i].mass * place[j] * place[k]);
    }
}

static void number_freedoms(struct line *s)
{
    const int nfreedom = CT_NODE_FREEDOM * (s->f->beam->nelement + 1), first = s->plane ? 6 : 2;
    s->number = CT_NEWN(s->b->ctx->scratch, int, nfreedom);
    for (int i = 0; i < nfreedom; i++)
        s->number[i] = -1;
    for (int e = 0; e < s->f->beam->nelement; e++)
        for (int j = 0; j < 4; j++) {
            const int i = s->f->element[e].freedom[first + j];
            if (i >= 0 && s->number[i] < 0)
                s->number[i] = s->n++;
        }
    for (int e = 0; e < s->f->beam->nelement; e++)
        for (int j = 0; j < 16; j++) {
            const int p = s->f->element[e].freedom[first + j % 4],
                      q = s->f->element[e].freedom[first + j / 4];
            if (p >= 0 && q >= 0 && s->number[p] - s->number[q] > s->band)
                s->band = s->number[p] - s->number[q];
        }
}

// ---- bending shapes -----------------------------------------------------------------------------

// y (n, out) = A v; returns v' A v.
static double apply(const struct line *s, double *y, const double *A, const double *v)
{
    double sum = 0;
    memset(y, 0, (size_t)s->n * sizeof *y);
    for (int j = 0; j < s->n; j++)
        for (int i = j; i < s->n && i <= j + s->band; i++) {
            const double a = A[i - j + (s->band + 1) * j];
            y[i] += a * v[j];
            y[j] += i > j ? a * v[i] : 0;
        }
    for (int i = 0; i < s->n; i++)
        sum += v[i] * y[i];
    return sum;
}

static double dot(const double *x, const double *y, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += x[i] * y[i];
    return sum;
}

// The shapes found so far: v and M v, n numbers each.
struct found {
    int n;
    double *v[CT_PLANE_SHAPES], *Mv[CT_PLANE_SHAPES];
};

// Inverse iteration, K v = M v, orthogonal to the shapes found before. The next shape is written to
// v[n] but not counted. Returns omega^2, 0 if it does not converge. L: Cholesky factor of K.
static double next_shape(const struct line *s, const double *L, struct found *all)
{
    const int n = s->n;
    double *const v = all->v[all->n], *const y = all->Mv[all->n], last = 0;
    for (int i = 0; i < n; i++)
        v[i] = all->n == 0 || i % 2 == 0 ? 1 : -i;
    for (int k = 0; k < MOST_ITERATIONS; k++) {
        apply(s, y, s->M, v);
        memcpy(v, y, (size_t)n * sizeof *v);
        ct_band_cholesky_solve(v, L, n, s->band);
        for (int j = 0; j < all->n; j++) {
            const double share = dot(v, all->Mv[j], n);
            for (int i = 0; i < n; i++)
                v[i] -= share * all->v[j][i];
        }
        const double moved = sqrt(apply(s, y, s->M, v));
        if (!(moved > 0))
            return 0;
        for (int i = 0; i < n; i++)
            v[i] /= moved;
        const double omega2 = apply(s, y, s->K, v);
        if (fabs(omega2 - last) <= frequency_tolerance * omega2) {
            apply(s, y, s->M, v);
            return omega2;
        }
        last = omega2;
    }
    return 0;
}

// Assemble the matrices of the plane. False if the beam does not bend in it.
static bool build_plane(struct line *s)
{
    struct ct_build *b = s->b;
    struct ct_arena *a = b->ctx->scratch;
    ct_gauss(POINTS, s->xi, s->weight);
    number_freedoms(s);
    if (!s->n)
        return false;
    double **const matrix[] = {&s->K, &s->M, &s->Kg[0], &s->Kg[1]};
    for (size_t i = 0; i < COUNT(matrix); i++)
        *matrix[i] = CT_NEWN(a, double, (s->band + 1) * s->n);
    for (int i = 0; i < 2; i++)
        s->base_coupling[i] = CT_NEWN(a, double, s->n);
    s->value = CT_NEWN(a, double, b->model->x->nsym + 1);
    memcpy(s->value, b->value, b->model->x->nsym * sizeof *s->value);
    list_lumps(s);
    sum_masses(s);
    for (int e = 0; e < s->f->beam->nelement; e++)
        add_element(s, e);
    add_lumps(s);
    return true;
}

// Freedom i of the plane, two per node, in the numbering of its element.
static int position_of(int i, int plane, int *element)
{
    *element = i < 2 ? 0 : i / 2 - 1;
    return (plane ? 6 : 2) + (i < 2 ? i : 2 + i % 2);
}

// x and x' as expressions of the state: projection phi' M of the beam's deflection. y: M phi.
static void project(struct ct_build *b, const struct line *s, const double *y, ct_ex state[2])
{
    struct ct_exs *x = b->x;
    for (int i = 0; i < 2 * (s->f->beam->nelement + 1); i++) {
        int e;
        const int j = position_of(i, s->plane, &e), p = s->f->element[e].freedom[j];
        if (p < 0)
            continue;
        const double share = y[s->number[p]];
        state[0] = ct_ex_add(x, state[0], ct_ex_scale(x, share, s->f->element[e].value[j]));
        state[1] = ct_ex_add(x, state[1], ct_ex_scale(x, share, s->f->element[e].rate[j]));
    }
}

// x and x' at the start given by the model.
static void project_start(struct ct_build *b, const struct line *s, const double *y,
                          double start[2])
{
    const struct ct_beam *beam = s->f->beam;
    for (int k = 0; k < beam->nstart; k++)
        for (int i = 0; i < 2 * (beam->nelement + 1); i++) {
            int e;
            const int j = position_of(i, s->plane, &e), p = s->f->element[e].freedom[j];
            if (p >= 0)
                start[beam->start[k].is_rate]
                    += y[s->number[p]]
                     * number(s, ct_field_freedom(b, s->f, beam->start[k].kind,
                                                  beam->start[k].value, p / CT_NODE_FREEDOM,
                                                  p % CT_NODE_FREEDOM));
        }
}

// Sum of the shape functions of element e at xi, with the coefficients v.
static double along(const struct line *s, int e, double xi, const struct ct_shape shape[4],
                    const double *v)
{
    const double h = number(s, s->f->element[e].span.length);
    double sum = 0;
    for (int j = 0; j < 4; j++) {
        const int p = s->f->element[e].freedom[(s->plane ? 6 : 2) + j];
        const double part = p < 0 ? 0 : v[s->number[p]] * ct_shape_value(&shape[j], xi, h);
        sum += s->plane && j % 2 ? -part : part; // dw/dx = -ry
    }
    return sum;
}

// Integral of the squared slope over element e up to xi.
static double foreshortening(const struct line *s, int e, double xi, const double *v)
{
    const double h = number(s, s->f->element[e].span.length);
    double sum = 0;
    for (int k = 0; k < POINTS; k++) {
        const double slope = along(s, e, xi * s->xi[k], s->f->shape.slope, v);
        sum += s->weight[k] * xi * h * slope * slope;
    }
    return sum;
}

// Coefficients of large deflections: the mass that moves along the beam (b), and the curvature (g).
// See beam_error_modal.h.
static void find_amplitudes(const struct line *s, const double *v, struct ct_beam_mode *out)
{
    const struct ct_beam *beam = s->f->beam;
    const ct_ex EI = ct_ex_mul(s->b->x, beam->E, s->plane ? beam->Iy : beam->Iz);
    double *const before = CT_NEWN(s->b->ctx->scratch, double, beam->nelement + 1);
    struct ct_shape turn[4];
    for (int j = 0; j < 4; j++)
        turn[j] = ct_shape_slope(&s->f->shape.rotation[j]);
    for (int e = 0; e < beam->nelement; e++) {
        const double h = number(s, s->f->element[e].span.length);
        before[e + 1] = before[e] + foreshortening(s, e, 1, v);
        for (int i = 0; i < POINTS; i++) {
            const double S = before[e] + foreshortening(s, e, s->xi[i], v),
                         w = s->weight[i] * h,
                         bend = along(s, e, s->xi[i], turn, v)
                              * along(s, e, s->xi[i], s->f->shape.slope, v);
            out->shortening += w * profile(s, beam->mass_per_length, e, s->xi[i]) * S * S;
            out->curvature += w * profile(s, EI, e, s->xi[i]) * bend * bend;
        }
    }
    for (size_t i = 0; i < s->nlump; i++) {
        double xi;
        const int e = element_at(s, s->lump[i].x, &xi);
        const double S = before[e] + foreshortening(s, e, xi, v);
        out->shortening += s->lump[i].mass * S * S;
    }
}

// phi sqrt(m) at the integration points and at welded masses, so that integrals of products of two
// shapes are sums.
static void sample(const struct line *s, const double *v, struct ct_bending_shape *out)
{
    const struct ct_beam *beam = s->f->beam;
    const int n = beam->nelement * POINTS;
    double *const moved = CT_NEWN(s->b->arena, double, (size_t)n + s->nlump + 1);
    for (int i = 0; i < n; i++) {
        const int e = i / POINTS, k = i % POINTS;
        const double m = s->weight[k] * number(s, s->f->element[e].span.length)
                       * profile(s, beam->mass_per_length, e, s->xi[k]);
        moved[i] = sqrt(m) * along(s, e, s->xi[k], s->f->shape.deflection, v);
    }
    for (size_t i = 0; i < s->nlump; i++) {
        double xi;
        const int e = element_at(s, s->lump[i].x, &xi);
        moved[n + (int)i] = sqrt(s->lump[i].mass) * along(s, e, xi, s->f->shape.deflection, v);
    }
    out->moved = moved;
    out->nmoved = n + (int)s->nlump;
}

static void fill_shape(struct line *s, const struct found *all, int k, double omega2,
                       struct ct_bending_shape *out)
{
    const struct ct_beam *beam = s->f->beam;
    const double *v = all->v[k], length = number(s, beam->end[beam->nelement - 1]);
    double *const y = CT_NEWN(s->b->ctx->scratch, double, s->n);
    const double elastic = apply(s, y, s->K, v);
    *out = (struct ct_bending_shape){
        .mode
        = {.is_z = s->plane,
           .omega2 = omega2,
           .damping
           = number(s, beam->damping_mass) + number(s, beam->damping_stiffness) * omega2,
           .eta_by_rate = apply(s, y, s->Kg[0], v) / elastic,
           .eta_by_acceleration = apply(s, y, s->Kg[1], v) / elastic,
           .mass = {dot(s->base_coupling[0], v, s->n), dot(s->base_coupling[1], v, s->n)}}};
    for (int i = 0; i < CT_BEAM_MODE_STATIONS; i++) {
        double xi;
        const int e = element_at(s, length * (i + 1) / CT_BEAM_MODE_STATIONS, &xi);
        out->mode.deflection[i] = along(s, e, xi, s->f->shape.deflection, v);
    }
    find_amplitudes(s, v, &out->mode);
    sample(s, v, out);
    project(s->b, s, all->Mv[k], out->state);
    project_start(s->b, s, all->Mv[k], out->start);
}

void ct_bending_modes_couple(struct ct_bending_shape *shape, int n)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            if (shape[i].mode.is_z != shape[j].mode.is_z)
                shape[i].mode.coupling[j]
                    = dot(shape[i].moved, shape[j].moved, shape[i].nmoved);
}

int ct_bending_modes_find(struct ct_build *b, const struct ct_flexible *f, int plane,
                          struct ct_bending_shape *out)
{
    struct line s = {.b = b, .f = f, .plane = plane};
    struct found all = {0};
    if (!build_plane(&s))
        return 0;
    const int size = (s.band + 1) * s.n;
    double *const L = CT_NEWN(b->ctx->scratch, double, size);
    memcpy(L, s.K, (size_t)size * sizeof *L);
    if (!ct_band_cholesky(L, s.n, s.band))
        return 0;
    while (all.n < CT_PLANE_SHAPES && all.n < s.n) {
        all.v[all.n] = CT_NEWN(b->ctx->scratch, double, s.n);
        all.Mv[all.n] = CT_NEWN(b->ctx->scratch, double, s.n);
        const double omega2 = next_shape(&s, L, &all);
        if (!(omega2 > 0) || (all.n && omega2 > farthest * out[0].mode.omega2))
            break;
        fill_shape(&s, &all, all.n, omega2, &out[all.n]);
        all.n++;
    }
    return all.n;
}
