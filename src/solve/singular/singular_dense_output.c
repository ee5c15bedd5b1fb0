// Dense output across a singular configuration: accelerations and multipliers in the gap of a
// crossing, interpolated from its stages.
//
// Accelerations are smooth across a singular configuration. Multipliers are not: a load on the
// motion that is free only in that configuration is carried by rows that become dependent. Their
// multipliers grow like 1/(t - t_s) towards a configuration at t_s. The rest of them is smooth:
//
//     lam(t) = P(t) + R/(t - t_s),   R = [lam (t - t_s)](t_s)                             (8.43)
//
// with P and the product in brackets interpolated between stages. The pole is used only if it
// improves the interpolation of the stages. Results that are linear in multipliers are interpolated
// in the same way. Computed from interpolated multipliers, they would contain errors of y in the gap
// times unbounded loads, even where they do not depend on these loads.
#include "solve/singular/singular.h"

#include "integrate/crossing.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Definition: stages on both sides of the gap
enum { N = CT_CROSSING_STAGES, CHECKED = 2 };

// An interpolant with or without the pole: weights of the stages at t, and weights of the other
// stages in the prediction of the two stages next to the gap, for the error.
struct interpolant {
    double weight[N], check[CHECKED][N];
};

// Values at the stages and at t.
struct numbers {
    size_t n;
    double *at, *value; // (n x N), (n)
};

struct ct_singular_dense_output {
    const struct ct_rank_monitor *w;
    double *stage;                       // (ny)
    struct interpolant smooth, singular; // without the pole, with it
    struct numbers a, lam, result;
    bool *is_linear; // (nresult) in multipliers
    bool any_linear;
};

static struct numbers create_numbers(struct ct_arena *a, size_t n)
{
    return (struct numbers){
        .n = n, .at = CT_NEWN(a, double, n *N + 1), .value = CT_NEWN(a, double, n + 1)};
}

// Is g, which depends on multipliers, linear in them and otherwise smooth? ds (nrow): arbitrary
// numbers.
static bool is_linear(const struct ct_equations *e, ct_ex g, const ct_ex *lam, const ct_ex *ds)
{
    const unsigned has_lam = 1u << CT_SYM_LAM, kinds = ct_ex_kinds(e->x, g);
    if (!(kinds & has_lam) || kinds & 1u << CT_SYM_SWITCH)
        return false;
    const ct_ex slope = ct_ex_diff_along(e->x, g, lam, ds, e->nrow);
    return !ct_ex_is_zero(slope) && !(ct_ex_kinds(e->x, slope) & has_lam);
}

static void find_linear(struct ct_singular_dense_output *s, struct ct_arena *a,
                        const struct ct_equations *e)
{
    ct_ex *lam = CT_NEWN(a, ct_ex, 2 * e->nrow + 1), *ds = lam + e->nrow;
    for (size_t i = 0; i < e->nrow; i++) {
        lam[i] = e->row[i].lam;
        ds[i] = ct_ex_const(e->x, 1 + fmod((double)i * 0.6180339887498949, 1));
    }
    for (size_t i = 0; i < e->nresult; i++) {
        s->is_linear[i] = is_linear(e, e->result[i].value, lam, ds);
        s->any_linear |= s->is_linear[i];
    }
}

struct ct_singular_dense_output *ct_singular_dense_output_create(struct ct_arena *a,
                                                                 struct ct_rank_monitor *w)
{
    const struct ct_evaluator *m = w->m;
    struct ct_singular_dense_output *s = CT_NEW(a, struct ct_singular_dense_output);
    s->w = w;
    s->stage = CT_NEWN(a, double, m->nq + m->nu + 1);
    s->a = create_numbers(a, m->nu);
    s->lam = create_numbers(a, m->nrow);
    s->result = create_numbers(a, m->e->nresult);
    s->is_linear = CT_NEWN(a, bool, m->e->nresult + 1);
    if (m->nrow)
        find_linear(s, a, m->e);
    return s;
}

// t - t_k, at least the resolution of times.
static double distance_to_pole(double t, double pole)
{
    const double least = DBL_EPSILON * fmax(fabs(t), DBL_MIN / DBL_EPSILON);
    return fabs(t - pole) > least ? t - pole : least;
}

// The weight of stage j in the Lagrange interpolation at t between the stages that `some`
// marks.
static double lagrange(const struct ct_gap_interpolation *b, const bool *some, int j, double t)
{
    double weight = some[j];
    for (int i = 0; i < N; i++)
        if (some[i] && i != j)
            weight *= (t - b->t[i]) / (b->t[j] - b->t[i]);
    return weight;
}

// Weights of the stages for t; pole: NULL for none.
static void find_weights(const struct ct_gap_interpolation *b, const bool *some,
                         const double *pole, double t, double *weight)
{
    for (int j = 0; j < N; j++)
        weight[j] = lagrange(b, some, j, t);
    if (!pole)
        return;
    double factor = 1 / distance_to_pole(t, *pole);
    for (int j = 0; j < N; j++)
        factor -= some[j] ? weight[j] / distance_to_pole(b->t[j], *pole) : 0;
    for (int j = 0; j < N; j++)
        weight[j] += factor * lagrange(b, some, j, *pole) * (b->t[j] - *pole);
}

// m (out): the interpolant for t.
static void find_model(const struct ct_gap_interpolation *b, const double *pole, double t,
                       struct interpolant *m)
{
    bool all[N], others[N];
    for (int j = 0; j < N; j++) {
        all[j] = true;
        others[j] = j != N / 2 - 1 && j != N / 2;
    }
    find_weights(b, all, pole, t, m->weight);
    for (int c = 0; c < CHECKED; c++) {
        const int j = N / 2 - 1 + c;
        find_weights(b, others, pole, b->t[j], m->check[c]);
        m->check[c][j] -= 1;
    }
}

static void store_value(struct numbers *x, const double *at, int j)
{
    for (size_t i = 0; i < x->n; i++)
        x->at[i * N + (size_t)j] = at[i];
}

static double error_of(const struct interpolant *m, const double *at)
{
    double error = 0;
    for (int c = 0; c < CHECKED; c++)
        error += fabs(ct_vector_dot(m->check[c], at, N));
    return error;
}

// A value has the pole if that reduces the error of predicting the two stages next to the gap from
// the others.
static void interpolate(const struct ct_singular_dense_output *s, struct numbers *x,
                        bool may_have_pole)
{
    for (size_t i = 0; i < x->n; i++) {
        const double *at = x->at + i * N;
        const bool has_pole
            = may_have_pole && error_of(&s->singular, at) < error_of(&s->smooth, at);
        x->value[i] = ct_vector_dot((has_pole ? &s->singular : &s->smooth)->weight, at, N);
    }
}

// Results at the evaluator's input, with these accelerations and multipliers.
static const double *results(struct ct_evaluator *m, const double *a, const double *lam)
{
    memcpy(m->input + m->at_a, a, m->nu * sizeof *a);
    memcpy(m->input + m->at_lam, lam, m->nrow * sizeof *lam);
    ct_program_run(&m->result, m->input);
    return m->result.out;
}

static bool store_stage(struct ct_singular_dense_output *s,
                        const struct ct_gap_interpolation *b, int j)
{
    struct ct_partition *p = s->w->s;
    const size_t ny = p->m->nq + p->m->nu + 1;
    memcpy(s->stage, b->y + (size_t)j * ny, ny * sizeof *s->stage);
    if (ct_partition_project(p, b->t[j], s->stage) != CT_EVAL_OK
        || ct_partition_accelerate_at(p, b->t[j], s->stage) != CT_EVAL_OK)
        return false;
    ct_partition_multipliers(p);
    store_value(&s->a, p->a, j);
    store_value(&s->lam, p->lam, j);
    if (s->any_linear)
        store_value(&s->result, results(p->m, p->a, p->lam), j);
    return true;
}

bool ct_singular_dense_output(struct ct_singular_dense_output *s, double t, const double *y,
                              const struct ct_gap_interpolation *b, double *value)
{
    struct ct_evaluator *m = s->w->m;
    const double pole = s->w->pole;
    find_model(b, NULL, t, &s->smooth);
    find_model(b, &pole, t, &s->singular);
    for (int j = 0; j < N; j++)
        if (!store_stage(s, b, j))
            return false;
    interpolate(s, &s->a, false);
    interpolate(s, &s->lam, !isnan(pole));
    interpolate(s, &s->result, !isnan(pole));
    ct_evaluator_set(m, t, y);
    memcpy(value, results(m, s->a.value, s->lam.value), m->e->nresult * sizeof *value);
    for (size_t i = 0; i < m->e->nresult; i++)
        if (s->is_linear[i])
            value[i] = s->result.value[i];
    return true;
}
