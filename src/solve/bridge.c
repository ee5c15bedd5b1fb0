// See bridge.h.
#include "solve/bridge.h"

#include "integrate/crossing.h"

#include <float.h>
#include <math.h>
#include <string.h>

// What a position makes of the multipliers at the stages.
struct pole {
    double residue[CT_CROSSING_STAGES]; // weights: R_k
    double factor; // what there is of it at t, less what weights make of it
};

// Numbers at t from what they are at the stages.
struct sum {
    size_t n;
    double *value;    // (n) as interpolated
    double *R, *size; // (n x CT_MOST_POLES) R_k, and of what it is a sum
};

struct ct_bridging {
    int n; // poles
    struct pole pole[CT_MOST_POLES];
    struct sum a, lam, result;
    bool *is_linear; // (nresult) in multipliers
    bool any_linear;
};

static struct sum create_sum(struct ct_arena *a, size_t n)
{
    return (struct sum){.n = n,
                        .value = CT_NEWN(a, double, n + 1),
                        .R = CT_NEWN(a, double, n *CT_MOST_POLES + 1),
                        .size = CT_NEWN(a, double, n *CT_MOST_POLES + 1)};
}

// Is g, which has multipliers in it, linear in them, and smooth but for them? ds (nrow): in no simple relation.
static bool is_linear(const struct ct_equations *e, ct_ex g, const ct_ex *lam, const ct_ex *ds)
{
    const unsigned has_lam = 1u << CT_SYM_LAM, kinds = ct_ex_kinds(e->x, g);
    if (!(kinds & has_lam) || kinds & 1u << CT_SYM_MODE)
        return false;
    const ct_ex slope = ct_ex_diff_along(e->x, g, lam, ds, e->nrow);
    return !ct_ex_is_zero(slope) && !(ct_ex_kinds(e->x, slope) & has_lam);
}

static void find_linear(struct ct_bridging *s, struct ct_arena *a, const struct ct_equations *e)
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

struct ct_bridging *ct_bridging_create(struct ct_arena *a, const struct ct_machine *m)
{
    struct ct_bridging *s = CT_NEW(a, struct ct_bridging);
    s->a = create_sum(a, m->nu);
    s->lam = create_sum(a, m->nrow);
    s->result = create_sum(a, m->e->nresult);
    s->is_linear = CT_NEWN(a, bool, m->e->nresult + 1);
    if (m->nrow)
        find_linear(s, a, m->e);
    return s;
}

// (t - t_k), but for t_k itself, where there is no value: as near as times differ.
static double way_from(double t, double pole)
{
    const double least = DBL_EPSILON * fmax(fabs(t), DBL_MIN / DBL_EPSILON);
    return fabs(t - pole) > least ? t - pole : least;
}

// The weight of stage j in what is interpolated at t.
static double lagrange(const struct ct_bridge *b, int j, double t)
{
    double weight = 1;
    for (int i = 0; i < b->n; i++)
        weight *= i == j ? 1 : (t - b->t[i]) / (b->t[j] - b->t[i]);
    return weight;
}

static void find_pole(const struct ct_bridge *b, double t, const double *at, int n, int k,
                      struct pole *p)
{
    p->factor = 1 / way_from(t, at[k]);
    for (int j = 0; j < b->n; j++) {
        p->residue[j] = lagrange(b, j, at[k]) * (b->t[j] - at[k]);
        for (int l = 0; l < n; l++)
            p->residue[j] *= l == k ? 1 : (b->t[j] - at[l]) / (at[k] - at[l]);
        p->factor -= b->weight[j] / (b->t[j] - at[k]);
    }
}

// Positions that are next to each other are one.
static void find_poles(struct ct_bridging *s, const struct ct_singular *w, double t,
                       const struct ct_bridge *b)
{
    const double apart = 1e-6 * (b->t[b->n - 1] - b->t[0]);
    double at[CT_MOST_POLES];
    s->n = 0;
    for (int k = 0; k < w->npole; k++)
        if (!s->n || w->pole[k] - at[s->n - 1] > apart)
            at[s->n++] = w->pole[k];
    for (int k = 0; k < s->n; k++)
        find_pole(b, t, at, s->n, k, &s->pole[k]);
}

static void clear(struct sum *x)
{
    memset(x->value, 0, x->n * sizeof *x->value);
    memset(x->R, 0, x->n * CT_MOST_POLES * sizeof *x->R);
    memset(x->size, 0, x->n * CT_MOST_POLES * sizeof *x->size);
}

// What x is at stage j, of this weight; npole: 0 where it has none.
static void add_stage(const struct ct_bridging *s, struct sum *x, const double *at, int j,
                      double weight, int npole)
{
    for (size_t i = 0; i < x->n; i++) {
        x->value[i] += weight * at[i];
        for (int k = 0; k < npole; k++) {
            const double part = s->pole[k].residue[j] * at[i];
            x->R[i * CT_MOST_POLES + (size_t)k] += part;
            x->size[i * CT_MOST_POLES + (size_t)k] += fabs(part);
        }
    }
}

static void add_poles(const struct ct_bridging *s, struct sum *x)
{
    const double rounding = 1e-11; // of what sums that vanish are made of
    for (size_t i = 0; i < x->n; i++)
        for (int k = 0; k < s->n; k++) {
            const double R = x->R[i * CT_MOST_POLES + (size_t)k];
            if (fabs(R) > rounding * x->size[i * CT_MOST_POLES + (size_t)k])
                x->value[i] += s->pole[k].factor * R;
        }
}

// Results where the machine is, with these accelerations and multipliers.
static const double *results(struct ct_machine *m, const double *a, const double *lam)
{
    memcpy(m->input + m->at_a, a, m->nu * sizeof *a);
    memcpy(m->input + m->at_lam, lam, m->nrow * sizeof *lam);
    ct_program_run(&m->result, m->input);
    return m->result.out;
}

static bool add_all_of_stage(struct ct_run *r, const struct ct_bridge *b, int j)
{
    struct ct_bridging *s = r->bridging;
    const double weight = b->weight[j];
    memcpy(r->stage, b->y + (size_t)j * r->ny, r->ny * sizeof *r->stage);
    if (ct_embed_project(r->s, b->t[j], r->stage) != CT_EVAL_OK
        || ct_run_accelerate(r, b->t[j], r->stage) != CT_EVAL_OK)
        return false;
    ct_embed_multipliers(r->s);
    add_stage(s, &s->a, r->s->a, j, weight, 0);
    add_stage(s, &s->lam, r->s->lam, j, weight, s->n);
    if (s->any_linear)
        add_stage(s, &s->result, results(r->m, r->s->a, r->s->lam), j, weight, s->n);
    return true;
}

bool ct_run_bridge(struct ct_run *r, double t, const double *y, const struct ct_bridge *b,
                   double *value)
{
    struct ct_bridging *s = r->bridging;
    struct sum *const sums[] = {&s->a, &s->lam, &s->result};
    for (size_t i = 0; i < COUNT(sums); i++)
        clear(sums[i]);
    find_poles(s, r->singular, t, b);
    for (int j = 0; j < b->n; j++)
        if (!add_all_of_stage(r, b, j))
            return false;
    add_poles(s, &s->lam);
    add_poles(s, &s->result);
    ct_machine_set(r->m, t, y);
    memcpy(value, results(r->m, s->a.value, s->lam.value), r->e->nresult * sizeof *value);
    for (size_t i = 0; i < r->e->nresult; i++)
        if (s->is_linear[i])
            value[i] = s->result.value[i];
    return true;
}
