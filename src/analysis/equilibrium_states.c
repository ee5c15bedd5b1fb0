// Equilibrium of a model with states; see equilibrium.h.
//
// Forces of controllers have no potential to descend. Newton's method finds where forces and
// rates of states vanish. Its step has least norm if the equations do not determine all
// coordinates and states. A step is halved until the next step, computed with the same
// derivatives, is shorter. Source: Deuflhard (2011), 3.2, key deuflhard2011.
#include "analysis/equilibrium_step.h"
#include "formulate/build.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Limit: with a message.
enum { MOST_STEPS = 200, MOST_HALVINGS = 30 };

struct search {
    struct ct_linear *l;
    bool *turns;               // nu: is the coordinate an angle?
    double *K, *A, *x, *scale; // nfree x nfree, twice; nfree, twice
    double *dq, *part, *next;  // steps: nu
    struct ct_kept_state before;
};

static struct search search_create(struct ct_linear *l)
{
    struct ct_arena *a = l->arena;
    const struct ct_equations *e = l->m->e;
    const size_t n = e->nu + 1;
    struct search s = {.l = l};
    s.turns = ct_equilibrium_turns(l);
    s.K = CT_NEWN(a, double, n *n);
    s.A = CT_NEWN(a, double, n *n);
    double **const vectors[] = {&s.x, &s.scale, &s.dq, &s.part, &s.next};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    s.before = ct_kept_state_create(l);
    return s;
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
        if (s->turns[k] && fabs(s->dq[k]) * part > ct_largest_rotation_step)
            part = ct_largest_rotation_step / fabs(s->dq[k]);
    return part;
}

// Halves the step s->dq of the given size until the next step is shorter. False if it never is.
static bool go(struct search *s, double size)
{
    struct ct_linear *l = s->l;
    double part = allowed(s);
    ct_linear_keep(l, &s->before);
    for (int i = 0; i < MOST_HALVINGS; i++, part /= 2) {
        for (int k = 0; k < l->nu; k++)
            s->part[k] = part * s->dq[k];
        ct_linear_retract(l, s->part);
        if (ct_linear_close(l) && ct_linear_rest(l)) {
            find_step(s, s->next);
            if (size <= CT_EQUILIBRIUM_FINE
                || step_size(l, s->before.y, s->next) <= (1 - part / 4) * size)
                return true;
        }
        if (l->ctx->nerror)
            return false;
        ct_linear_go_back(l, &s->before);
    }
    return false;
}

// An independent speed along which a force or a rate remains that no step removes; -1 if there
// is none.
static int find_unbalanced(const struct search *s)
{
    const struct ct_linear *l = s->l;
    for (int i = 0; i < l->nfree; i++) {
        double magnitude = 0; // of the terms; multipliers and weights are part of l->scale
        for (int j = 0; j < l->nu; j++) {
            double row = l->scale[j];
            for (int k = 0; k < l->nu; k++)
                row += fabs(l->K[j + l->nu * k]);
            magnitude += fabs(l->Z[j + l->nu * i]) * row;
        }
        if (fabs(l->force[i]) > ct_roundoff(l->nu) * magnitude)
            return l->independent[i];
    }
    return -1;
}

static bool report_missing(const struct search *s)
{
    const int k = find_unbalanced(s);
    return ct_equilibrium_report_missing(
        s->l, k < 0 ? ct_linear_largest_entry(s->dq, NULL, s->l->nu) : k);
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
        if (size <= DBL_EPSILON || (size <= CT_EQUILIBRIUM_FINE && size > last / 2))
            break;
        last = size;
        if (out->iterations == MOST_STEPS || !go(&s, size))
            return l->ctx->nerror ? false : report_missing(&s);
    }
    return find_unbalanced(&s) < 0 || report_missing(&s);
}
