// See validity.h.
#include "formulate/validity.h"
#include "expr/quadrature.h"
#include "formulate/elastic.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

enum { POINTS = 8, MOST_ITERATIONS = 200, INSTANTS = 400 };
static const double arrived = 1e-12; // relative change of the first frequency

// ---- numbers along the beam -----------------------------------------------------------------------------

struct lump { // a body that a weld holds to a point of the beam
    double mass, x;
};

struct line {
    struct ct_build *b;
    const struct ct_flexible *f;
    int plane; // 0: along y, 1: along z
    int n,
        band; // freedoms of this plane; the most by which the numbers of two that meet differ
    int *number;   // by freedom, -1: fixed or of another kind
    double *K, *M; // lower triangles, A(i, j) at i - j + (band + 1) j
    double *Kg[2]; // with P1, P2
    double *
        beyond; // by element and one more: int m x and int m from its start to the end of the beam  (2 x)
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

// A frame of the beam beyond its base. The section at the start of one on its chord turns against the base.
static bool is_beyond(const struct ct_build *b, const struct ct_flexible *f, int frame)
{
    const int own = f->beam->is_chord ? -1 : b->model->body[f->body].frame;
    return frame >= 0 && frame != own && b->model->frame[frame].body == f->body;
}

static bool is_weld(const struct ct_instance *joint)
{
    return joint->from >= 0 && !strcmp(joint->cls->name, "weld");
}

// By body: where along the beam it is held by welds, beyond the base, directly or by other bodies; NaN: it is not.
static double *find_riders(const struct ct_build *b, const struct ct_flexible *f)
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

static void list_lumps(struct line *s)
{
    const struct ct_model *m = s->b->model;
    const double *place = find_riders(s->b, s->f);
    s->lump = CT_NEWN(s->b->ctx->scratch, struct lump, m->nbody);
    for (size_t i = 1; i < m->nbody; i++)
        if (!isnan(place[i]))
            s->lump[s->nlump++] = (struct lump){
                .x = place[i], .mass = ct_ex_value(s->b->x, m->body[i].mass, s->b->value)};
}

// P (2, out) = int m x and int m over element e from xi on.
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

// int_x^L of m x and of m from a place xi of element e, welded masses included.
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

// ---- matrices of a plane -----------------------------------------------------------------------------------

static void add(struct line *s, double *A, int e, int j, int k, double v)
{
    const int first = s->plane ? 6 : 2;
    const int p = s->f->element[e].freedom[first + j], q = s->f->element[e].freedom[first + k];
    if (p < 0 || q < 0 || s->number[p] < s->number[q])
        return;
    const bool opposed = s->plane && (j % 2) != (k % 2); // dw/dx = -ry
    A[s->number[p] - s->number[q] + (s->band + 1) * s->number[q]] += opposed ? -v : v;
}

// Bending and shear, at the points that the beam itself takes: one in the middle keeps linear shapes from locking.
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

static void add_element(struct line *s, int e)
{
    const struct ct_beam *beam = s->f->beam;
    const double h = number(s, s->f->element[e].span.length);
    add_stiffness(s, e);
    for (int i = 0; i < POINTS; i++) {
        const double xi = s->xi[i], w = s->weight[i] * h,
                     m = profile(s, beam->mass_per_length, e, xi);
        double place[4], slope[4], P[2];
        for (int j = 0; j < 4; j++) {
            place[j] = ct_shape_value(&s->f->shape.place[j], xi, h);
            slope[j] = ct_shape_value(&s->f->shape.slope[j], xi, h);
        }
        mass_beyond(s, e, xi, P);
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++) {
                add(s, s->M, e, j, k, w * m * place[j] * place[k]);
                add(s, s->Kg[0], e, j, k, w * P[0] * slope[j] * slope[k]);
                add(s, s->Kg[1], e, j, k, w * P[1] * slope[j] * slope[k]);
            }
    }
}

// Welded masses move with the shape at their point.
static void add_lumps(struct line *s)
{
    int e = 0;
    for (size_t i = 0; i < s->nlump; i++) {
        const double x = s->lump[i].x;
        for (e = 0; e + 1 < s->f->beam->nelement && x > number(s, s->f->beam->end[e]);)
            e++;
        const double h = number(s, s->f->element[e].span.length),
                     xi = (x - number(s, s->f->element[e].span.start)) / h;
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                add(s, s->M, e, j, k,
                    s->lump[i].mass * ct_shape_value(&s->f->shape.place[j], xi, h)
                        * ct_shape_value(&s->f->shape.place[k], xi, h));
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

// ---- first bending shape --------------------------------------------------------------------------------------

// y (n, out) = A v, and v' A v
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

// Inverse iteration: K v = M v; returns omega^2, 0 if it does not settle. y: n
static double first_shape(struct line *s, double *v, double *y)
{
    const int n = s->n, size = (s->band + 1) * n;
    double *L = CT_NEWN(s->b->ctx->scratch, double, size), last = 0;
    memcpy(L, s->K, (size_t)size * sizeof *L);
    if (!ct_band_cholesky(L, n, s->band))
        return 0;
    for (int i = 0; i < n; i++)
        v[i] = 1;
    for (int k = 0; k < MOST_ITERATIONS; k++) {
        apply(s, y, s->M, v);
        memcpy(v, y, (size_t)n * sizeof *v);
        ct_band_cholesky_solve(v, L, n, s->band);
        const double moved = sqrt(apply(s, y, s->M, v));
        if (!(moved > 0))
            return 0;
        for (int i = 0; i < n; i++)
            v[i] /= moved;
        const double omega2 = apply(s, y, s->K, v);
        if (fabs(omega2 - last) <= arrived * omega2)
            return omega2;
        last = omega2;
    }
    return 0;
}

// ka, kb of one plane; false where it does not bend.
static bool coefficients(struct ct_build *b, const struct ct_flexible *f, int plane,
                         double k[2], double *omega)
{
    struct line s = {.b = b, .f = f, .plane = plane};
    struct ct_arena *a = b->ctx->scratch;
    ct_gauss(POINTS, s.xi, s.weight);
    number_freedoms(&s);
    if (!s.n)
        return false;
    const int size = (s.band + 1) * s.n;
    double *const v = CT_NEWN(a, double, s.n), *const y = CT_NEWN(a, double, s.n);
    double **const matrix[] = {&s.K, &s.M, &s.Kg[0], &s.Kg[1]};
    for (size_t i = 0; i < COUNT(matrix); i++)
        *matrix[i] = CT_NEWN(a, double, size);
    s.value = CT_NEWN(a, double, b->model->x->nsym + 1);
    memcpy(s.value, b->value, b->model->x->nsym * sizeof *s.value);
    list_lumps(&s);
    sum_masses(&s);
    for (int e = 0; e < f->beam->nelement; e++)
        add_element(&s, e);
    add_lumps(&s);
    const double omega2 = first_shape(&s, v, y), elastic = apply(&s, y, s.K, v);
    if (!(omega2 > 0))
        return false;
    *omega = sqrt(omega2);
    for (int i = 0; i < 2; i++)
        k[i] = apply(&s, y, s.Kg[i], v) / elastic;
    return true;
}

bool ct_validity_derive(struct ct_build *b, const struct ct_flexible *f,
                        struct ct_validity *out)
{
    struct ct_exs *x = b->x;
    double k[2][2], omega[2];
    int best = -1;
    for (int plane = 0; plane < 2; plane++)
        if (coefficients(b, f, plane, k[plane], &omega[plane])
            && (best < 0 || k[plane][0] > k[best][0]))
            best = plane;
    if (best < 0)
        return false;
    const struct ct_base m = ct_flexible_base(b, f, CT_FULL);
    const ct_ex turning
        = ct_ex_add(x, ct_ex_mul(x, m.w.e[1], m.w.e[1]), ct_ex_mul(x, m.w.e[2], m.w.e[2]));
    *out = (struct ct_validity){.beam = f->name, .omega = omega[best]};
    out->mark = f->beam->formulation_mark.line ? f->beam->formulation_mark
                                               : b->model->body[f->body].instance.mark;
    out->eta = ct_ex_sub(x, ct_ex_scale(x, k[best][0], turning),
                         ct_ex_scale(x, k[best][1], m.a.e[0]));
    return true;
}

// ---- choice -----------------------------------------------------------------------------------------------------

// Does anything but welded bodies hang on the beam beyond its base, or push it or them there?
static bool carries(const struct ct_build *b, const struct ct_flexible *f)
{
    const struct ct_model *m = b->model;
    const double *place = find_riders(b, f);
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

// Modes that depend on time alone, at the time in value.
static bool set_modes(struct ct_build *b, double *value)
{
    for (size_t i = 0; i < b->eqs->nmode; i++) {
        const struct ct_mode *m = &b->eqs->mode[i];
        if (!m->is_time)
            return false;
        value[ct_ex_node(b->x, m->symbol)->a]
            = ct_op_apply(m->op, ct_ex_value(b->x, m->g, value), 0, 0);
    }
    return true;
}

// Largest |eta| from 0 to the end of the run; NaN where it is no function of time alone.
static double largest_over_run(struct ct_build *b, ct_ex eta)
{
    const unsigned known = 1u << CT_SYM_TIME | 1u << CT_SYM_PARAM | 1u << CT_SYM_MODE;
    double most = 0, *value = CT_NEWN(b->ctx->scratch, double, b->x->nsym + 1);
    if (ct_ex_kinds(b->x, eta) & ~known)
        return NAN;
    memcpy(value, b->value, b->model->x->nsym * sizeof *value);
    const uint32_t t = ct_ex_node(b->x, b->model->time)->a;
    for (int i = 0; i <= INSTANTS; i++) {
        value[t] = b->model->simulation.duration * i / INSTANTS;
        if (!set_modes(b, value))
            return NAN;
        const double v = fabs(ct_ex_value(b->x, eta, value));
        most = v > most || isnan(v) ? v : most;
    }
    return most;
}

static bool stays_linear(struct ct_build *b, struct ct_flexible *f)
{
    struct ct_validity v;
    if (carries(b, f)) {
        f->why = "automatic: joints or loads beyond its base can stretch or press it";
        return false;
    }
    if (!ct_validity_derive(b, f, &v)) {
        f->why = "automatic: it does not bend";
        return true;
    }
    const double most = largest_over_run(b, v.eta);
    if (isnan(most))
        f->why = "automatic: its motion is not known beforehand";
    else
        f->why = ct_arena_printf(b->arena, "automatic: validity indicator %.3g, limit %.3g",
                                 most, CT_VALIDITY_LIMIT);
    return most <= CT_VALIDITY_LIMIT;
}

const bool *ct_validity_choose(struct ct_build *b)
{
    bool *linear = NULL;
    for (size_t i = 0; i < b->nflexible; i++) {
        struct ct_flexible *f = &b->flexible[i];
        if (f->beam->formulation != CT_BEAM_AUTO || !f->nelastic)
            continue;
        if (!linear)
            linear = CT_NEWN(b->arena, bool, b->model->nbody);
        linear[f->body] = stays_linear(b, f);
    }
    return linear;
}

static ct_ex squared_slope(struct ct_build *b, const struct ct_element *e, int end)
{
    struct ct_exs *x = b->x;
    const ct_ex v = e->value[3 + 2 * end], w = e->value[7 + 2 * end];
    return ct_ex_add(x, ct_ex_mul(x, v, v), ct_ex_mul(x, w, w));
}

static void watch_bending(struct ct_build *b, const struct ct_flexible *f)
{
    const int n = f->beam->nelement;
    struct ct_bent_beam bend = {.beam = f->name,
                                .mark = b->model->body[f->body].instance.mark,
                                .square = CT_NEWN(b->arena, ct_ex, n + 1)};
    for (int k = 0; k <= n; k++) {
        const ct_ex square = squared_slope(b, &f->element[k ? k - 1 : 0], k > 0);
        if (!ct_ex_is_zero(square))
            bend.square[bend.n++] = square;
    }
    if (bend.n)
        CT_PUSH(b->arena, b->eqs->bend, b->eqs->nbend, b->eqs->bend_cap, bend);
}

void ct_validity_monitor(struct ct_build *b)
{
    for (size_t i = 0; i < b->nflexible; i++)
        watch_bending(b, &b->flexible[i]);
    for (size_t i = 0; i < b->nflexible; i++) {
        struct ct_validity v;
        if (b->flexible[i].formulation == CT_BEAM_LINEAR
            && ct_validity_derive(b, &b->flexible[i], &v))
            CT_PUSH(b->arena, b->eqs->validity, b->eqs->nvalidity, b->eqs->validity_cap, v);
    }
}
