// See equilibrium.h.
//
// The search takes its steps from dense or from sparse matrices (equilibrium_step.h). The limit
// of step lengths and the criteria of convergence are the same for both.
#include "analysis/equilibrium.h"
#include "analysis/equilibrium_step.h"
#include "formulate/build.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Longest translation in one step [m] at first. It is doubled after each successful step.
// Limit: of the first steps.
static const double first_length = 0.2;
// Limit: with a message.
enum { MOST_STEPS = 1000, MOST_HALVINGS = 40 };

bool *ct_equilibrium_turns(const struct ct_linear *l)
{
    const struct ct_equations *e = l->m->e;
    bool *turns = CT_NEWN(l->arena, bool, e->nu + 1);
    for (size_t k = 0; k < e->nmotion; k++)
        turns[k] = e->u[k].q < 0;
    for (size_t i = 0; i < e->ncoordinate; i++)
        if (e->coordinate[i].u >= 0 && e->coordinate[i].in_rotation
            && !e->coordinate[i].in_translation)
            turns[e->coordinate[i].u] = true;
    return turns;
}

static struct ct_equilibrium_search search_create(struct ct_linear *l,
                                                  const struct ct_equilibrium_method *method)
{
    struct ct_arena *a = l->arena;
    const size_t nu = (size_t)l->nu + 1, nrow = (size_t)l->nrow + 1;
    struct ct_equilibrium_search s = {.l = l, .method = method, .length = first_length};
    s.dq = CT_NEWN(a, double, nu);
    s.dlam = CT_NEWN(a, double, nrow);
    s.turns = ct_equilibrium_turns(l);
    s.before = ct_kept_state_create(l);
    method->reserve(&s);
    return s;
}

// The fraction of dq that the limits of step length allow.
static double allowed(const struct ct_equilibrium_search *s)
{
    double part = 1;
    for (int k = 0; k < s->l->nu; k++) {
        const double most = s->turns[k] ? ct_largest_rotation_step : s->length;
        if (fabs(s->dq[k]) * part > most)
            part = most / fabs(s->dq[k]);
    }
    return part;
}

static void scale_step(struct ct_equilibrium_search *s, double part)
{
    for (int k = 0; k < s->l->nu; k++)
        s->dq[k] *= part;
    for (int k = 0; k < s->l->nrow; k++)
        s->dlam[k] *= part;
}

// Takes the step. False if the loops do not close or a value is not finite.
static bool take_step(struct ct_equilibrium_search *s)
{
    struct ct_linear *l = s->l;
    ct_evaluator_retract(l->m, l->y, s->dq);
    for (int k = 0; k < l->nrow; k++)
        l->lam[k] += s->dlam[k];
    return ct_linear_close(l) && s->method->evaluate(s);
}

// Halves the step until the forces at its end do not point back too strongly. False if no
// fraction of the step is accepted; then there is usually no diagnostic.
static bool go(struct ct_equilibrium_search *s)
{
    struct ct_linear *l = s->l;
    // Definition: the curvature condition of Wolfe, Nocedal and Wright (2006), 3.1.
    const double turned_back = 0.9, before = s->method->slope(s), part = allowed(s);
    const size_t nu = (size_t)l->nu;
    scale_step(s, part);
    const bool is_fine = s->is_newton
                      // below this length the slope is round-off
                      && ct_vector_largest(s->dq, nu) < CT_EQUILIBRIUM_FINE;
    ct_linear_keep(l, &s->before);
    for (int i = 0; i < MOST_HALVINGS; i++) {
        if (take_step(s)
            && (is_fine
                || s->method->slope(s) <= turned_back * fabs(before) * ldexp(1, -i) * part)) {
            if (i == 0 && part < 1)
                s->length *= 2;
            else if (i)
                // Limit: of the halvings that carry over to the next step.
                s->length = fmax(ct_vector_largest(s->dq, nu), first_length * 1e-6);
            return true;
        }
        if (l->ctx->nerror)
            return false;
        ct_linear_go_back(l, &s->before);
        scale_step(s, 0.5);
    }
    return false;
}

// Size of the step relative to the coordinates.
static double step_size(const struct ct_equilibrium_search *s)
{
    const struct ct_linear *l = s->l;
    return ct_vector_largest(s->dq, (size_t)l->nu) / (1 + ct_vector_largest(l->y, l->m->nq));
}

// Is the remaining error round-off of the coordinates? `last`: size of the step before.
static bool has_arrived(double size, double last)
{
    return size <= DBL_EPSILON || (size <= CT_EQUILIBRIUM_FINE && size > last / 2);
}

// ---- along a path of equilibria ------------------------------------------------------------

bool ct_equilibrium_rates(struct ct_linear *l, struct ct_equilibrium_result *out)
{
    // Limit: number of iterations, after which another method is tried.
    enum { MOST = 25 };
    struct ct_equilibrium_search s
        = search_create(l, l->M ? &ct_equilibrium_dense : &ct_equilibrium_sparse);
    double last = INFINITY;
    const size_t before = l->ctx->nerror;
    s.length
        // no limit: an iteration that jumps to another path converges irregularly and is
        // rejected
        = INFINITY;
    *out = (struct ct_equilibrium_result){0};
    if (!s.method->evaluate(&s))
        return false;
    for (; !s.method->is_balanced(&s); out->iterations++) {
        if (!s.method->find_newton_step(&s))
            return false;
        const double size = out->last_step = step_size(&s);
        if (has_arrived(size, last)) {
            for (int k = 0; k < l->nrow; k++)
                l->lam[k] += s.dlam[k];
            break;
        }
        if (!isfinite(size) || out->iterations == MOST || allowed(&s) < 1 || size > last / 2)
            return false;
        last = size;
        if (!take_step(&s) || l->ctx->nerror != before)
            return false;
    }
    return l->ctx->nerror == before;
}

// ---- the search -----------------------------------------------------------------------------

bool ct_equilibrium_report_missing(const struct ct_linear *l, int k)
{
    const struct ct_equations *e = l->m->e;
    const struct ct_model *model = l->m->model;
    const struct ct_u *u = &e->u[k];
    if (ct_speed_is_state(e, (size_t)k))
        return ct_error(l->ctx, model->state[(size_t)k - e->nmotion].rate_mark,
                        CT_E_EQUILIBRIUM,
                        "no equilibrium is found: the state '%s' goes on to change; its rate, "
                        "or what it acts on, must come to rest somewhere near the start",
                        u->name);
    const struct ct_mark mark = u->joint >= 0 ? model->joint[u->joint].mark
                              : u->body >= 0  ? model->body[u->body].instance.mark
                                              : (struct ct_mark){.file = model->file};
    return ct_error(l->ctx, mark, CT_E_EQUILIBRIUM,
                    "no equilibrium is found: '%s' goes on to move; hold it by a stiffness, or "
                    "start nearer to an equilibrium",
                    ct_linear_coordinate(e, l->arena, k));
}

static bool report_missing(const struct ct_equilibrium_search *s)
{
    return ct_equilibrium_report_missing(s->l, ct_linear_largest_entry(s->dq, NULL, s->l->nu));
}

// Descends the potential from a position that is evaluated. False, without a diagnostic of its
// own, if no equilibrium is reached; then s->dq is the last step that was computed.
static bool descend(struct ct_equilibrium_search *s, struct ct_equilibrium_result *out)
{
    struct ct_linear *l = s->l;
    double last = INFINITY;
    *out = (struct ct_equilibrium_result){0};
    for (;; out->iterations++) {
        if (!s->method->find_step(s))
            return false;
        const double size = out->last_step = step_size(s);
        if (has_arrived(size, last)) {
            for (int k = 0; k < l->nrow; k++)
                l->lam[k] += s->dlam[k];
            return true;
        }
        last = size;
        if (out->iterations == MOST_STEPS || !go(s))
            return false;
    }
}

bool ct_equilibrium_find(struct ct_linear *l, struct ct_equilibrium_result *out)
{
    if (l->m->e->nstate)
        return ct_equilibrium_find_with_states(l, out);
    if (!ct_linear_rest(l)) // also allocates the matrices
        return false;
    struct ct_equilibrium_search s = search_create(l, &ct_equilibrium_dense);
    struct ct_kept_state start = ct_kept_state_create(l);
    ct_linear_keep(l, &start);
    // forces that turn with a body have no potential, for example
    if (!ct_linear_is_symmetric(l->arena, l->Kr, l->nfree)) {
        if (ct_equilibrium_rates(l, out))
            return true;
        ct_linear_go_back(l, &start);
    }
    if (ct_linear_rest(l) && descend(&s, out))
        return true;
    return l->ctx->nerror ? false : report_missing(&s);
}

bool ct_equilibrium_find_sparse(struct ct_linear *l, struct ct_equilibrium_result *out,
                                bool *applies)
{
    struct ct_equilibrium_search s = search_create(l, &ct_equilibrium_sparse);
    const size_t nu = (size_t)l->nu, nrow = (size_t)l->nrow;
    memset(l->a, 0, nu * sizeof *l->a);
    memset(l->lam, 0, nrow * sizeof *l->lam);
    *applies = ct_vector_largest(l->y + l->m->nq, nu) == 0 && s.method->evaluate(&s)
            && ct_vector_largest(s.p->v, nrow) == 0;
    if (!*applies)
        return true;
    if (!descend(&s, out)) {
        // if the first step failed, the sparse factors cannot tell whether an equilibrium
        // exists
        *applies = out->iterations > 0 || l->ctx->nerror;
        return *applies && !l->ctx->nerror ? report_missing(&s) : !*applies;
    }
    l->acceleration = 0;
    l->is_resting = true;
    return true;
}
