// See settle.h.
#include "solve/settle.h"
#include "formulate/flexible.h"
#include "formulate/residual.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

static const double met = 1e-13;     // last correction against the largest coordinate
static const double rounding = 1e-9; // corrections that no longer fall are rounding below this
static const double nothing
    = 1e-6; // [m or rad] coordinates smaller than this count as of this size
enum { MOST_STEPS = 50, MOST_HALVINGS = 30 };

struct settle {
    struct ct_machine *m;
    const struct ct_equations *e;
    size_t n, nlam, nslope; // speeds along which places move; rows that count; derivatives
    int *u, *place;         // those speeds; by speed: its place among them, or -1
    int *row, *lam_place;   // kept rows; by row: its place among them, or -1
    struct ct_slope *slope; // of the forces by places and multipliers
    double *y, *lam;        // state; multipliers (nrow)
    double *A, *step;       // factors of the derivative, (n + nlam) square; a motion (nu)
    int *pivot;
    double stiffness;         // unit of the multipliers
    struct ct_program values; // forces (n), phi (nrow), slopes
};

bool ct_settle_wanted(const struct ct_model *model)
{
    for (size_t i = 1; i < model->nbody; i++)
        if (model->body[i].beam && model->body[i].beam->starts_in_equilibrium)
            return true;
    return false;
}

bool *ct_settle_first(struct ct_arena *a, const struct ct_model *model)
{
    bool *first = CT_NEWN(a, bool, model->njoint + 1);
    for (size_t i = 0; i < model->njoint; i++) {
        const struct ct_initial *initial = &model->joint[i].initial;
        first[i] = (initial->q.given || initial->rotate.given) && !initial->guess;
    }
    return first;
}

// ---- what moves -----------------------------------------------------------------------------------------

// Orthonormal vectors (n each), one after the other.
struct basis {
    size_t n, count;
    double *v;
};

// Add the part of v that is new. False if there is none.
static bool extend(struct basis *s, double *v)
{
    const double dependent = 1e-6; // of its length: far above rounding, far below what moves
    double before = 0, after = 0;
    for (size_t i = 0; i < s->n; i++)
        before += v[i] * v[i];
    for (size_t twice = 0; twice < 2; twice++)
        for (size_t k = 0; k < s->count; k++) {
            const double *w = s->v + s->n * k;
            double along = 0;
            for (size_t i = 0; i < s->n; i++)
                along += w[i] * v[i];
            for (size_t i = 0; i < s->n; i++)
                v[i] -= along * w[i];
        }
    for (size_t i = 0; i < s->n; i++)
        after += v[i] * v[i];
    if (!(after > dependent * dependent * before) || s->count == s->n)
        return false;
    double *out = s->v + s->n * s->count++;
    for (size_t i = 0; i < s->n; i++)
        out[i] = v[i] / sqrt(after);
    return true;
}

// Is the joint coordinate that moves at speed k given?
static bool is_given(const struct ct_equations *e, const struct ct_start *start, size_t k)
{
    for (size_t i = 0; i < start->n; i++)
        if (e->coordinate[i].u == (int)k && start->is_given[i])
            return true;
    return false;
}

// Speeds of joints and bodies that stay: those given, then others, as far as the loops leave them free; beams that
// keep their shape stay, too. still (nu, out); the start is in the machine.
static void find_still(struct ct_machine *m, struct ct_arena *a, const struct ct_start *start,
                       const bool *settles, bool *still)
{
    const struct ct_equations *e = m->e;
    size_t n = 0;
    int *rigid = CT_NEWN(a, int, e->nu + 1);
    for (size_t k = 0; k < e->nu; k++) {
        still[k] = e->u[k].beam && !settles[k];
        if (!e->u[k].beam)
            rigid[n++] = (int)k;
    }
    struct basis s = {n, 0, CT_NEWN(a, double, n *n + 1)};
    double *v = CT_NEWN(a, double, n + 1);
    ct_machine_constraint(m);
    for (size_t i = 0; i < e->nrow; i++) {
        for (size_t k = 0; k < n; k++)
            v[k] = m->J[i + e->nrow * (size_t)rigid[k]];
        extend(&s, v);
    }
    for (int given = 1; given >= 0; given--)
        for (size_t k = 0; k < n; k++)
            if (is_given(e, start, (size_t)rigid[k]) == given) {
                memset(v, 0, n * sizeof *v);
                v[k] = 1;
                still[rigid[k]] = extend(&s, v);
            }
}

// Independent rows in the directions that move.
static void choose_rows(struct settle *s, struct ct_arena *a)
{
    const double dependent = 1e-9; // as in embed.c
    const size_t m = s->e->nrow, n = s->n;
    double *A = CT_NEWN(a, double, m *n + 1), *tau = CT_NEWN(a, double, m + n);
    double *work = CT_NEWN(a, double, ct_qr_pivot_work((int)n, (int)m));
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < n; k++)
            A[k + n * i] = s->m->J[i + m * (size_t)s->u[k]];
    s->nlam = m && n
                ? (size_t)ct_qr_pivot(A, s->row, tau, (int)n, (int)m, (int)n, dependent, work)
                : 0;
    for (size_t i = 0; i < m; i++)
        s->lam_place[i] = -1;
    for (size_t i = 0; i < s->nlam; i++)
        s->lam_place[s->row[i]] = (int)i;
}

// ---- equations ------------------------------------------------------------------------------------------

// Forces Q + J' lam of what moves, all speeds zero, and their derivatives; phi.
static void derive(struct settle *s, struct ct_arena *a)
{
    const struct ct_equations *e = s->e;
    struct ct_exs *x = e->x;
    ct_ex *f = CT_NEWN(a, ct_ex, s->n + 1);
    ct_ex *from = CT_NEWN(a, ct_ex, e->nu + 1), *zero = CT_NEWN(a, ct_ex, e->nu + 1);
    for (size_t k = 0; k < e->nu; k++)
        from[k] = e->u[k].symbol;
    for (size_t i = 0; i < s->n; i++)
        f[i] = e->Q[s->u[i]];
    for (size_t i = 0; i < e->nJ; i++) {
        const int k = s->place[e->J[i].column];
        if (k >= 0)
            f[k] = ct_ex_add(x, f[k], ct_ex_mul(x, e->J[i].value, e->row[e->J[i].row].lam));
    }
    ct_ex_subst_list(x, f, s->n, from, zero, e->nu);
    s->nslope = ct_slopes_derive(e->build, a, f, s->n, NULL, 0, &s->slope);
    const size_t nout = s->n + e->nrow + s->nslope;
    ct_ex *out = CT_NEWN(a, ct_ex, nout + 1);
    for (size_t i = 0; i < s->n; i++)
        out[i] = f[i];
    for (size_t i = 0; i < e->nrow; i++)
        out[s->n + i] = e->row[i].phi;
    for (size_t i = 0; i < s->nslope; i++)
        out[s->n + e->nrow + i] = s->slope[i].value;
    ct_machine_compile(a, s->m, x, out, nout, &s->values);
}

static void evaluate(struct settle *s)
{
    ct_machine_set(s->m, 0, s->y);
    memcpy(s->m->input + s->m->at_lam, s->lam, s->e->nrow * sizeof *s->lam);
    ct_program_run(&s->values, s->m->input);
}

// A = [K  c J'; c J  0] with K = d(force)/d(place), c its size: multipliers are counted in units of c.
static bool factor(struct settle *s)
{
    const size_t n = s->n, size = n + s->nlam, nu = s->e->nu;
    const double *value = s->values.out + n + s->e->nrow;
    memset(s->A, 0, size * size * sizeof *s->A);
    s->stiffness = 0;
    for (size_t i = 0; i < s->nslope; i++)
        if (s->slope[i].direction < nu && s->place[s->slope[i].direction] >= 0) {
            s->A[s->slope[i].row + size * (size_t)s->place[s->slope[i].direction]] = value[i];
            s->stiffness = fmax(s->stiffness, fabs(value[i]));
        }
    s->stiffness = s->stiffness > 0 ? s->stiffness : 1;
    for (size_t i = 0; i < s->nslope; i++) {
        const size_t first = 3 * nu; // after places, speeds, accelerations
        if (s->slope[i].direction < first)
            continue;
        const int lam = s->lam_place[s->slope[i].direction - first];
        if (lam < 0)
            continue;
        const size_t k = n + (size_t)lam;
        s->A[s->slope[i].row + size * k] = s->A[k + size * s->slope[i].row]
            = s->stiffness * value[i];
    }
    return ct_lu(s->A, s->pivot, (int)size, (int)size);
}

// Newton correction of places and multipliers now, with the factors of an earlier derivative; the size of the places'.
static double correction(struct settle *s, double *d)
{
    const size_t all = s->n + s->nlam;
    double size = 0;
    memcpy(d, s->values.out, s->n * sizeof *d);
    for (size_t i = 0; i < s->nlam; i++)
        d[s->n + i] = s->stiffness * s->values.out[s->n + (size_t)s->row[i]];
    ct_lu_solve(d, s->A, s->pivot, (int)all, (int)all, 1, (int)all, false);
    for (size_t i = 0; i < s->n; i++)
        size = !(fabs(d[i]) <= size) ? fabs(d[i]) : size;
    return size;
}

static void move(struct settle *s, const double *d, double factor)
{
    memset(s->step, 0, s->e->nu * sizeof *s->step);
    for (size_t i = 0; i < s->n; i++)
        s->step[s->u[i]] = -factor * d[i];
    ct_machine_retract(s->m, s->y, s->step);
    for (size_t i = 0; i < s->nlam; i++)
        s->lam[s->row[i]] -= factor * s->stiffness * d[s->n + i];
}

static double largest(const struct settle *s)
{
    double size = 0;
    for (size_t i = 0; i < s->n; i++)
        if (s->e->u[s->u[i]].q >= 0)
            size = fmax(size, fabs(s->y[s->e->u[s->u[i]].q]));
    return fmax(size, nothing);
}

// Newton steps, halved until the next correction with the same derivative is smaller: that test does not care how rows
// are scaled. Source: Deuflhard (2011), key deuflhard2011.
static bool iterate(struct settle *s, struct ct_arena *a)
{
    const size_t all = s->n + s->nlam, nq = s->m->nq, nrow = s->e->nrow;
    double *d = CT_NEWN(a, double, all + 1), *next = CT_NEWN(a, double, all + 1),
           *kept = CT_NEWN(a, double, nq + nrow + 1);
    evaluate(s);
    for (int step = 0; step < MOST_STEPS; step++) {
        if (!factor(s))
            return false;
        const double size = correction(s, d);
        if (size <= met * largest(s))
            return true;
        memcpy(kept, s->y, nq * sizeof *kept);
        memcpy(kept + nq, s->lam, nrow * sizeof *kept);
        double part = 1, left = INFINITY;
        for (int half = 0; half < MOST_HALVINGS && !(left < size); half++, part /= 2) {
            memcpy(s->y, kept, nq * sizeof *kept);
            memcpy(s->lam, kept + nq, nrow * sizeof *kept);
            move(s, d, part);
            evaluate(s);
            left = correction(s, next);
        }
        if (!(left < size)) // only rounding is left, or there is nothing to find
            return size <= rounding * largest(s);
    }
    return false;
}

static struct settle create(struct ct_arena *a, struct ct_machine *m)
{
    const size_t nu = m->nu, nrow = m->nrow, all = nu + nrow;
    return (struct settle){.m = m,
                           .e = m->e,
                           .u = CT_NEWN(a, int, nu + 1),
                           .place = CT_NEWN(a, int, nu + 1),
                           .row = CT_NEWN(a, int, nrow + 1),
                           .lam_place = CT_NEWN(a, int, nrow + 1),
                           .y = CT_NEWN(a, double, m->nq + nu + 1),
                           .lam = CT_NEWN(a, double, nrow + 1),
                           .A = CT_NEWN(a, double, all *all + 1),
                           .step = CT_NEWN(a, double, nu + 1),
                           .pivot = CT_NEWN(a, int, all + 1)};
}

// ---- the start ------------------------------------------------------------------------------------------

// Speeds at the place found: those of what stays as before, beams at rest in their frames, the others as the loops ask.
static void find_speeds(struct ct_arena *a, const struct ct_model *model,
                        const struct ct_equations *e, const bool *still, struct ct_start *start)
{
    struct ct_machine *m = ct_machine_create(a, model, e);
    const size_t nrow = e->nrow, nu = e->nu;
    const double dependent = 1e-9;
    double *y = CT_NEWN(a, double, m->nq + nu + 1), *A = CT_NEWN(a, double, nrow *nu + 1),
           *b = CT_NEWN(a, double, nrow + nu + 1);
    int *iwork = CT_NEWN(a, int, nu + 1), *free = CT_NEWN(a, int, nu + 1);
    double *work = CT_NEWN(a, double, ct_lstsq_work((int)nrow, (int)nu + 1));
    int n = 0;
    ct_start_apply(start, m, y);
    ct_machine_constraint(m);
    for (size_t k = 0; k < nu; k++) {
        if (still[k] || e->u[k].beam)
            continue;
        memcpy(A + nrow * (size_t)n, m->J + nrow * k, nrow * sizeof *A);
        free[n++] = (int)k;
    }
    for (size_t i = 0; i < nrow; i++)
        b[i] = -m->v[i];
    if (n)
        ct_lstsq(b, A, (int)nrow, n, (int)nrow, dependent, iwork, work);
    for (int k = 0; k < n; k++)
        y[m->nq + (size_t)free[k]] += b[k];
    ct_machine_set(m, 0, y);
    ct_program_run(&m->result, m->input);
    for (size_t i = 0; i < start->n; i++)
        start->u[i] = m->result.out[2 * i + 1];
}

static void take(const struct settle *s, struct ct_arena *a, struct ct_start *start)
{
    const struct ct_build *b = s->e->build;
    size_t n = 0;
    start->elastic = CT_NEWN(a, double, start->nelastic + 1);
    for (size_t i = 0; i < b->nflexible; i++)
        for (int j = 0; j < b->flexible[i].nelastic; j++)
            start->elastic[n++] = s->y[b->flexible[i].elastic[j].q];
    if (!s->e->nrow)
        return;
    ct_machine_set(s->m, 0, s->y);
    ct_program_run(&s->m->result, s->m->input);
    for (size_t i = 0; i < start->n; i++)
        start->q[i] = s->m->result.out[2 * i];
}

// Which elastic coordinates settle, by speed; the first beam of them, NULL: none.
static const struct ct_body *find_settling(const struct ct_model *model,
                                           const struct ct_equations *e, bool *settles,
                                           struct ct_start *start)
{
    const struct ct_build *b = e->build;
    const struct ct_body *first = NULL;
    for (size_t i = 0; i < b->nflexible; i++) {
        const struct ct_flexible *f = &b->flexible[i];
        start->nelastic += (size_t)f->nelastic;
        for (int j = 0; j < f->nelastic && f->beam->starts_in_equilibrium; j++) {
            first = first ? first : &model->body[f->body];
            settles[f->elastic[j].u] = true;
        }
    }
    return first;
}

bool ct_settle(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_model *model,
               const struct ct_equations *e, const struct ct_equations *moving,
               struct ct_start *start)
{
    bool *settles = CT_NEWN(a, bool, e->nu + 1), *still = CT_NEWN(a, bool, e->nu + 1);
    const struct ct_body *first = find_settling(model, e, settles, start);
    if (!first)
        return true;
    struct settle s = create(a, ct_machine_create(a, model, e));
    ct_start_apply(start, s.m, s.y);
    memset(s.y + s.m->nq, 0, s.m->nu * sizeof *s.y);
    ct_machine_set(s.m, 0, s.y);
    find_still(s.m, a, start, settles, still);
    for (size_t k = 0; k < e->nu; k++) {
        s.place[k] = still[k] ? -1 : (int)s.n;
        if (!still[k])
            s.u[s.n++] = (int)k;
    }
    choose_rows(&s, a);
    derive(&s, a);
    if (!iterate(&s, a))
        return ct_error(
            ctx, first->instance.mark, CT_E_SETTLE,
            "no equilibrium was found near the undeformed shape of beam '%s'; the loads "
            "at t = 0 may be too large for it",
            first->instance.name);
    take(&s, a, start);
    if (e->nrow)
        find_speeds(a, model, moving, still, start);
    return true;
}
