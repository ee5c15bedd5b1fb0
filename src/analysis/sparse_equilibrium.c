// Equilibrium of large systems; see equilibrium.h.
//
// Newton's method on positions and multipliers with sparse factors of [K, J'; J, 0]. A step that would do negative work, past a
// saddle or along what nothing holds, is replaced by that of K + s M with a larger and larger s, which goes down the forces.
#include "analysis/equilibrium.h"
#include "analysis/sparse_linearization.h"
#include "formulate/build.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double longest_turn = 0.2, first_length = 0.2; // [rad], [m] in one step
static const double arrived = 1e-13, nearly = 1e-8;         // as for small systems
enum { MOST_STEPS = 200, MOST_HALVINGS = 30, MOST_SHIFTS = 12 };

struct search {
    struct ct_linear *l;
    struct ct_point *p;
    size_t nu, nrow;
    double *b, *x; // nu + nrow: right-hand side; step of places, then less that of multipliers
    double *kept_y, *kept_lam, *dq;
    bool *turns;
    double length; // limit of lengths now [m]; doubled after steps that went well
};

static struct search search_create(struct ct_linear *l)
{
    struct ct_arena *a = l->arena;
    const struct ct_equations *e = l->m->e;
    const size_t nu = l->m->nu, n = nu + l->m->nrow + 1;
    struct search s = {
        .l = l, .p = ct_point_create(l), .nu = nu, .nrow = l->m->nrow, .length = first_length};
    double **const vectors[] = {&s.b, &s.x, &s.kept_lam, &s.dq};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    s.kept_y = CT_NEWN(a, double, l->m->nq + nu + 1);
    s.turns = CT_NEWN(a, bool, nu + 1);
    for (size_t k = 0; k < nu; k++)
        s.turns[k] = e->u[k].q < 0;
    for (size_t i = 0; i < e->ncoordinate; i++)
        if (e->coordinate[i].u >= 0 && e->coordinate[i].in_rotation
            && !e->coordinate[i].in_translation)
            s.turns[e->coordinate[i].u] = true;
    return s;
}

// Work of the forces here along dq.
static double work(const struct search *s, const double *dq)
{
    double sum = 0;
    for (size_t i = 0; i < s->nu; i++)
        sum -= s->p->r[i] * dq[i];
    return sum;
}

// x = step of K + shift M; false where that is singular.
static bool solve(struct search *s, double shift)
{
    struct ct_sparse *matrix = ct_point_factor(s->p, 1, shift);
    if (!matrix)
        return false;
    for (size_t i = 0; i < s->nu; i++)
        s->b[i] = -s->p->r[i];
    for (size_t i = 0; i < s->nrow; i++)
        s->b[s->nu + i] = -s->p->phi[i];
    ct_sparse_solve_extended(matrix, s->x, s->b);
    for (size_t i = 0; i < s->nu + s->nrow; i++)
        if (!isfinite(s->x[i]))
            return false;
    return true;
}

static bool find_step(struct search *s)
{
    const double ratio = ct_point_largest(s->p->K, s->p->nK)
                       / fmax(ct_point_largest(s->p->M, s->p->nM), DBL_MIN);
    double shift = 1e-12 * fmax(ratio, 1);
    if (solve(s, 0) && (work(s, s->x) > 0 || ct_vector_largest(s->x, s->nu) < nearly))
        return true;
    for (int i = 0; i < MOST_SHIFTS; i++, shift *= 30)
        if (solve(s, shift) && work(s, s->x) >= 0)
            return true;
    return false;
}

static double allowed(const struct search *s)
{
    double part = 1;
    for (size_t k = 0; k < s->nu; k++) {
        const double most = s->turns[k] ? longest_turn : s->length;
        if (fabs(s->x[k]) * part > most)
            part = most / fabs(s->x[k]);
    }
    return part;
}

// Go along the step as far as the forces still push on, more or less.
static bool go(struct search *s)
{
    struct ct_linear *l = s->l;
    const size_t ny = l->m->nq + s->nu + 1;
    const double before = work(s, s->x), turned_back = 0.5;
    double part = allowed(s);
    const bool is_fine
        = part == 1 && ct_vector_largest(s->x, s->nu) < nearly; // forces are round-off here
    memcpy(s->kept_y, l->y, ny * sizeof *l->y);
    memcpy(s->kept_lam, l->lam, s->nrow * sizeof *l->lam);
    const bool is_cut = part < 1;
    for (int i = 0; i < MOST_HALVINGS; i++, part /= 2) {
        for (size_t k = 0; k < s->nu; k++)
            s->dq[k] = part * s->x[k];
        ct_evaluator_retract(l->m, l->y, s->dq);
        for (size_t k = 0; k < s->nrow; k++) // the matrix has +J'
            l->lam[k] = s->kept_lam[k] - part * s->x[s->nu + k];
        if (ct_linear_close(l) && ct_point_evaluate(s->p)
            && (is_fine || work(s, s->x) >= -turned_back * fabs(before))) {
            s->length *= i == 0 && is_cut ? 2 : 1;
            return true;
        }
        memcpy(l->y, s->kept_y, ny * sizeof *l->y);
    }
    return false;
}

static bool not_found(const struct search *s)
{
    const struct ct_linear *l = s->l;
    size_t most = 0;
    for (size_t k = 0; k < s->nu; k++)
        if (fabs(s->x[k]) > fabs(s->x[most]))
            most = k;
    return ct_equilibrium_missing(l, (int)most);
}

bool ct_equilibrium_find_sparse(struct ct_linear *l, struct ct_equilibrium_result *out,
                                bool *applies)
{
    struct search s = search_create(l);
    double last = INFINITY;
    *out = (struct ct_equilibrium_result){0};
    memset(l->a, 0, s.nu * sizeof *l->a);
    memset(l->lam, 0, s.nrow * sizeof *l->lam);
    *applies = ct_vector_largest(l->y + l->m->nq, s.nu) == 0 && ct_point_evaluate(s.p)
            && ct_vector_largest(s.p->v, s.nrow) == 0;
    if (!*applies)
        return true;
    for (;; out->iterations++) {
        if (!find_step(&s)) {
            *applies
                = out->iterations > 0; // else nothing can be said about it with these factors
            return *applies ? not_found(&s) : true;
        }
        const double size
            = ct_vector_largest(s.x, s.nu) / (1 + ct_vector_largest(l->y, l->m->nq));
        out->last_step = size;
        if (size <= arrived || (size <= nearly && size > last / 2))
            break;
        last = size;
        if (out->iterations == MOST_STEPS || !go(&s))
            return not_found(&s);
    }
    for (size_t k = 0; k < s.nrow; k++)
        l->lam[k] -= s.x[s.nu + k];
    l->acceleration = 0;
    l->is_resting = true;
    return true;
}

// ---- along a path of loads -----------------------------------------------------------------------------------

// Nothing but round-off is left of the forces that meet.
static bool is_balanced(const struct search *s)
{
    const struct ct_linear *l = s->l;
    double *meet = s->b;
    memset(meet, 0, s->nu * sizeof *meet);
    for (size_t i = 0; i < s->p->nK; i++) {
        const int q = l->m->e->u[s->p->K[i].direction].q;
        if (q >= 0)
            meet[s->p->K[i].row] += fabs(s->p->K[i].value * l->y[q]);
    }
    return ct_vector_largest(s->p->r, s->nu)
        <= 8 * DBL_EPSILON * ct_vector_largest(meet, s->nu);
}

static bool follow(struct search *s, struct ct_equilibrium_result *out)
{
    enum { MOST = 25 };
    struct ct_linear *l = s->l;
    double last = INFINITY;
    if (!ct_point_evaluate(s->p))
        return false;
    for (; !is_balanced(s); out->iterations++) {
        if (!solve(s, 0))
            return false;
        const double size
            = ct_vector_largest(s->x, s->nu) / (1 + ct_vector_largest(l->y, l->m->nq));
        out->last_step = size;
        for (size_t k = 0; k < s->nrow; k++)
            l->lam[k] -= s->x[s->nu + k];
        if (size <= arrived || (size <= nearly && size > last / 2))
            return true;
        if (out->iterations == MOST || allowed(s) < 1 || size > last / 2)
            return false;
        last = size;
        ct_evaluator_retract(l->m, l->y, s->x);
        if (!ct_linear_close(l) || !ct_point_evaluate(s->p))
            return false;
    }
    return true;
}

bool ct_equilibrium_rates_sparse(struct ct_linear *l, struct ct_equilibrium_result *out)
{
    struct search s = search_create(l);
    const size_t before = l->ctx->nerror;
    s.length = INFINITY; // as for small systems
    *out = (struct ct_equilibrium_result){0};
    const bool ok = follow(&s, out) && l->ctx->nerror == before;
    ct_arena_destroy(s.p->a);
    return ok;
}
