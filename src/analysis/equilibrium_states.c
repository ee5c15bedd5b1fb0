// Equilibrium of a model with states; see equilibrium.h.
//
// Forces of controllers have no potential to descend. Newton's method finds where forces and
// rates of states vanish. Its step has least norm if the equations do not determine all
// coordinates and states. A step is halved until the next step, computed with the same
// derivatives, is shorter. Source: Deuflhard (2011), 3.2, key deuflhard2011.
#include "analysis/equilibrium.h"
#include "formulate/build.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

// Longest rotation in one step [rad].
// Definition: as in equilibrium.c.
static const double longest_turn = 0.2;
// Size of a step, relative to the coordinates, at which the search has converged.
// Chosen: 450 eps, above the round-off of the coordinates, as in equilibrium.c.
static const double arrived = 1e-13;
// Relative to the sum of force magnitudes: a smaller remaining force is zero.
// Derived: round-off of sums of some hundred forces, relative to the largest.
static const double balanced = 1e-9;
// Limit: with a message.
enum { MOST_STEPS = 200, MOST_HALVINGS = 30 };

struct search {
    struct ct_linear *l;
    bool *turns;               // nu: is the coordinate an angle?
    double *K, *A, *x, *scale; // nfree x nfree, twice; nfree, twice
    double *dq, *part, *next;  // steps: nu
    double *kept_y, *kept_memory;
};

static struct search search_create(struct ct_linear *l)
{
    struct ct_arena *a = l->arena;
    const struct ct_equations *e = l->m->e;
    const size_t n = e->nu + 1;
    struct search s = {.l = l};
    s.turns = CT_NEWN(a, bool, n);
    s.K = CT_NEWN(a, double, n *n);
    s.A = CT_NEWN(a, double, n *n);
    double **const vectors[] = {&s.x, &s.scale, &s.dq, &s.part, &s.next};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    s.kept_y = CT_NEWN(a, double, e->nq + n);
    s.kept_memory = CT_NEWN(a, double, e->nmemory + 1);
    for (size_t k = 0; k < e->nmotion; k++)
        s.turns[k] = e->u[k].q < 0;
    for (size_t i = 0; i < e->ncoordinate; i++)
        if (e->coordinate[i].u >= 0 && e->coordinate[i].in_rotation
            && !e->coordinate[i].in_translation)
            s.turns[e->coordinate[i].u] = true;
    return s;
}

static void keep(struct search *s)
{
    const struct ct_evaluator *m = s->l->m;
    memcpy(s->kept_y, s->l->y, (m->nq + m->nu + 1) * sizeof *s->kept_y);
    memcpy(s->kept_memory, m->input + m->at_memory, m->e->nmemory * sizeof *s->kept_memory);
}

static void go_back(const struct search *s)
{
    const struct ct_evaluator *m = s->l->m;
    memcpy(s->l->y, s->kept_y, (m->nq + m->nu + 1) * sizeof *s->kept_y);
    memcpy(m->input + m->at_memory, s->kept_memory, m->e->nmemory * sizeof *s->kept_memory);
}

// The larger of two ratios: the largest change of a coordinate over the largest coordinate in
// y, and the largest change of a state over that state.
static double step_size(const struct ct_linear *l, const double *y, const double *dq)
{
    const struct ct_equations *e = l->m->e;
    double size = ct_vector_largest(dq, e->nmotion) / (1 + ct_vector_largest(y, e->nq));
    for (size_t k = e->nmotion; k < e->nu; k++)
        size = fmax(size, fabs(dq[k]) / (1 + fabs(y[e->nq + k])));
    return size;
}

// Divides the rows and then the columns of A (n x n) by their largest entries, and the rows of
// x (n) alike; scale (n, out) are the column factors. Coordinates and states have different
// units; equilibrated rows and columns let one tolerance decide about the rank.
static void equilibrate(double *A, double *x, double *scale, int n)
{
    for (int by_columns = 0; by_columns < 2; by_columns++)
        for (int i = 0; i < n; i++) {
            const int start = by_columns ? n * i : i, step = by_columns ? 1 : n;
            double most = 0;
            for (int k = 0; k < n; k++)
                most = fmax(most, fabs(A[start + step * k]));
            const double by = most > 0 ? 1 / most : 1;
            for (int k = 0; k < n; k++)
                A[start + step * k] *= by;
            if (by_columns)
                scale[i] = by;
            else
                x[i] *= by;
        }
}

// dq (nu, out): the step for the present forces and rates, with the derivatives in s->K.
static void find_step(struct search *s, double *dq)
{
    struct ct_linear *l = s->l;
    const int n = l->nfree;
    memcpy(s->A, s->K, (size_t)n * (size_t)n * sizeof *s->A);
    for (int i = 0; i < n; i++)
        s->x[i] = -l->force[i];
    equilibrate(s->A, s->x, s->scale, n);
    ct_lstsq(s->x, s->A, n, n, n, ct_rank_tolerance, l->iwork, l->work);
    for (int i = 0; i < n; i++)
        s->x[i] *= s->scale[i];
    ct_linear_expand(l, dq, s->x);
}

// The fraction of the step that rotates nothing by more than the limit.
static double allowed(const struct search *s)
{
    double part = 1;
    for (size_t k = 0; k < s->l->m->e->nmotion; k++)
        if (s->turns[k] && fabs(s->dq[k]) * part > longest_turn)
            part = longest_turn / fabs(s->dq[k]);
    return part;
}

// Halves the step s->dq of the given size until the next step is shorter. False if it never is.
static bool go(struct search *s, double size)
{
    struct ct_linear *l = s->l;
    double part = allowed(s);
    keep(s);
    for (int i = 0; i < MOST_HALVINGS; i++, part /= 2) {
        for (int k = 0; k < l->nu; k++)
            s->part[k] = part * s->dq[k];
        ct_linear_retract(l, s->part);
        if (ct_linear_close(l) && ct_linear_rest(l)) {
            find_step(s, s->next);
            if (size <= CT_EQUILIBRIUM_FINE
                || step_size(l, s->kept_y, s->next) <= (1 - part / 4) * size)
                return true;
        }
        if (l->ctx->nerror)
            return false;
        go_back(s);
    }
    return false;
}

// An independent speed along which a force or a rate remains that no step removes; -1 if there
// is none.
static int find_unbalanced(const struct search *s)
{
    const struct ct_linear *l = s->l;
    for (int i = 0; i < l->nfree; i++) {
        double meet = 0; // magnitude of the terms; multipliers and weights are part of l->scale
        for (int j = 0; j < l->nu; j++) {
            double row = l->scale[j];
            for (int k = 0; k < l->nu; k++)
                row += fabs(l->K[j + l->nu * k]);
            meet += fabs(l->Z[j + l->nu * i]) * row;
        }
        if (fabs(l->force[i]) > balanced * meet)
            return l->independent[i];
    }
    return -1;
}

static int moves_most(const struct search *s)
{
    int most = 0;
    for (int k = 0; k < s->l->nu; k++)
        if (fabs(s->dq[k]) > fabs(s->dq[most]))
            most = k;
    return most;
}

static bool report_missing(const struct search *s)
{
    const struct ct_linear *l = s->l;
    const struct ct_equations *e = l->m->e;
    const struct ct_model *model = l->m->model;
    int k = find_unbalanced(s);
    if (k < 0)
        k = moves_most(s);
    const struct ct_u *u = &e->u[k];
    if (ct_speed_is_state(e, (size_t)k))
        return ct_error(l->ctx, model->state[(size_t)k - e->nmotion].rate_mark,
                        CT_E_EQUILIBRIUM,
                        "no equilibrium is found: the state '%s' goes on to change; its rate, "
                        "or what it acts on, must come to rest somewhere near the start",
                        u->name);
    return ct_error(l->ctx,
                    u->joint >= 0  ? model->joint[u->joint].mark
                    : u->body >= 0 ? model->body[u->body].instance.mark
                                   : (struct ct_mark){.file = model->file},
                    CT_E_EQUILIBRIUM,
                    "no equilibrium is found: '%s' goes on to move; hold it by a stiffness, or "
                    "start nearer to an equilibrium",
                    ct_linear_coordinate(e, l->arena, k));
}

bool ct_equilibrium_find_with_states(struct ct_linear *l, struct ct_equilibrium_result *out)
{
    *out = (struct ct_equilibrium_result){0};
    if (!ct_linear_rest(l)) // also allocates the matrices
        return false;
    struct search s = search_create(l);
    for (double last = INFINITY;; out->iterations++) {
        memcpy(s.K, l->Kr, (size_t)l->nfree * (size_t)l->nfree * sizeof *s.K);
        find_step(&s, s.dq);
        const double size = out->last_step = step_size(l, l->y, s.dq);
        if (size <= arrived || (size <= CT_EQUILIBRIUM_FINE && size > last / 2))
            break;
        last = size;
        if (out->iterations == MOST_STEPS || !go(&s, size))
            return l->ctx->nerror ? false : report_missing(&s);
    }
    return find_unbalanced(&s) < 0 || report_missing(&s);
}
