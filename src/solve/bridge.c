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

struct ct_bridging {
    int n; // poles
    struct pole pole[CT_MOST_POLES];
    double *R, *size; // (nrow x CT_MOST_POLES) R_k, and of what it is a sum
};

struct ct_bridging *ct_bridging_create(struct ct_arena *a, const struct ct_machine *m)
{
    struct ct_bridging *s = CT_NEW(a, struct ct_bridging);
    s->R = CT_NEWN(a, double, m->nrow *CT_MOST_POLES + 1);
    s->size = CT_NEWN(a, double, m->nrow *CT_MOST_POLES + 1);
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

static void add_stage(struct ct_bridging *s, const double *lam, size_t nrow, int j)
{
    for (size_t i = 0; i < nrow; i++)
        for (int k = 0; k < s->n; k++) {
            const double part = s->pole[k].residue[j] * lam[i];
            s->R[i * CT_MOST_POLES + (size_t)k] += part;
            s->size[i * CT_MOST_POLES + (size_t)k] += fabs(part);
        }
}

static void add_poles(const struct ct_bridging *s, double *lam, size_t nrow)
{
    const double rounding = 1e-11; // of what sums that vanish are made of
    for (size_t i = 0; i < nrow; i++)
        for (int k = 0; k < s->n; k++) {
            const double R = s->R[i * CT_MOST_POLES + (size_t)k];
            if (fabs(R) > rounding * s->size[i * CT_MOST_POLES + (size_t)k])
                lam[i] += s->pole[k].factor * R;
        }
}

bool ct_run_bridge(struct ct_run *r, double t, const struct ct_bridge *b, double *a,
                   double *lam)
{
    struct ct_machine *m = r->m;
    struct ct_bridging *s = r->bridging;
    const size_t nlam = m->nrow * CT_MOST_POLES;
    memset(a, 0, m->nu * sizeof *a);
    memset(lam, 0, m->nrow * sizeof *lam);
    memset(s->R, 0, nlam * sizeof *s->R);
    memset(s->size, 0, nlam * sizeof *s->size);
    find_poles(s, r->singular, t, b);
    for (int j = 0; j < b->n; j++) {
        memcpy(r->stage, b->y + (size_t)j * r->ny, r->ny * sizeof *r->stage);
        if (ct_embed_project(r->s, b->t[j], r->stage) != CT_EVAL_OK
            || ct_run_accelerate(r, b->t[j], r->stage) != CT_EVAL_OK)
            return false;
        ct_embed_multipliers(r->s);
        for (size_t i = 0; i < m->nu; i++)
            a[i] += b->weight[j] * r->s->a[i];
        for (size_t i = 0; i < m->nrow; i++)
            lam[i] += b->weight[j] * r->s->lam[i];
        add_stage(s, r->s->lam, m->nrow, j);
    }
    add_poles(s, lam, m->nrow);
    return true;
}
