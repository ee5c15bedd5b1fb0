// See equilibrium.h.
#include "analysis/equilibrium.h"
#include "formulate/build.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double longest_turn
    = 0.2; // [rad] in one step, against jumping to another equilibrium
static const double first_length = 0.2; // [m] at first; doubled after steps that went well
static const double arrived = 1e-13;    // of a step against the coordinates: their round-off
static const double nearly
    = 1e-8; // from here on a step that is not shorter than half the last ends the search
static const double flat = 1e-11;    // of the stiffest direction: no stiffness
static const double balanced = 1e-9; // of the forces that meet: a flat direction without force
enum { MOST_STEPS = 1000, MOST_HALVINGS = 40 };

struct search {
    struct ct_linear *l;
    const bool *held;
    bool *turns;           // speeds that are angular
    int n;                 // directions that may move
    double *S;             // nfree x n: these directions
    double *p, *scale;     // forces along them (n), and the sizes of what meets there
    double *gross;         // the same of each row (nu)
    double *H, *V, *value; // stiffness; its directions against the masses and their values
    double *g, *dq, *work, *A, *B, *kept_y, *kept_memory;
    int *pivot;
    double length;  // limit of lengths now [m]
    bool is_newton; // nothing is unstable: the step is that of Newton's method
};

static void find_turns(struct search *s)
{
    const struct ct_equations *e = s->l->m->e;
    for (size_t k = 0; k < e->nmotion; k++)
        s->turns[k] = e->u[k].q < 0;
    for (size_t i = 0; i < e->ncoordinate; i++)
        if (e->coordinate[i].u >= 0 && e->coordinate[i].in_rotation
            && !e->coordinate[i].in_translation)
            s->turns[e->coordinate[i].u] = true;
}

static struct search search_create(struct ct_linear *l, const bool *held)
{
    struct ct_arena *a = l->arena;
    const size_t n = (size_t)l->nu + 1;
    struct search s = {.l = l, .held = held, .length = first_length};
    double **const squares[] = {&s.S, &s.H, &s.V, &s.A, &s.B};
    for (size_t i = 0; i < COUNT(squares); i++)
        *squares[i] = CT_NEWN(a, double, n *n);
    double **const vectors[] = {&s.p, &s.scale, &s.gross, &s.value, &s.g, &s.dq};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, n);
    s.work = CT_NEWN(a, double, n + ct_symmetric_eigenvalues_work((int)n));
    s.pivot = CT_NEWN(a, int, n);
    s.turns = CT_NEWN(a, bool, n);
    s.kept_y = CT_NEWN(a, double, l->m->nq + n + 1);
    s.kept_memory = CT_NEWN(a, double, l->m->e->nmemory + 1);
    find_turns(&s);
    return s;
}

static void keep(struct search *s, bool back)
{
    const struct ct_linear *l = s->l;
    double *memory = l->m->input + l->m->at_memory;
    const size_t ny = l->m->nq + l->m->nu + 1, nm = l->m->e->nmemory;
    memcpy(back ? l->y : s->kept_y, back ? s->kept_y : l->y, ny * sizeof *l->y);
    memcpy(back ? memory : s->kept_memory, back ? s->kept_memory : memory, nm * sizeof *memory);
}

// ---- one step --------------------------------------------------------------------------------------------

// S: all directions, or those that leave the held coordinates alone.
static void find_directions(struct search *s)
{
    const struct ct_linear *l = s->l;
    const int f = l->nfree;
    const double still = 1e-12; // of a unit vector, squared: round-off
    memset(s->S, 0, (size_t)f * (size_t)f * sizeof *s->S);
    s->n = 0;
    if (!s->held) {
        for (s->n = 0; s->n < f; s->n++)
            s->S[s->n + f * s->n] = 1;
        return;
    }
    memset(s->A, 0, (size_t)f * (size_t)f * sizeof *s->A);
    for (int k = 0; k < l->nu; k++)
        for (int j = 0; j < f && s->held[k]; j++)
            for (int i = 0; i < f; i++)
                s->A[i + f * j] += l->Z[k + l->nu * i] * l->Z[k + l->nu * j];
    ct_symmetric_eigen(s->value, s->A, f, f, s->work);
    for (int k = 0; k < f && s->value[k] <= still; k++, s->n++)
        memcpy(s->S + f * k, s->A + f * k, (size_t)f * sizeof *s->S);
}

// out (n x n) = S' A S, made symmetric if asked for
static void restrict_to(struct search *s, double *out, const double *A, bool symmetric)
{
    const int f = s->l->nfree, n = s->n;
    ct_matrix_multiply(s->B, A, s->S, f, f, n);
    ct_matrix_multiply_transposed(out, s->S, s->B, n, f, n);
    for (int j = 0; j < n && symmetric; j++)
        for (int i = 0; i < j; i++)
            out[i + n * j] = out[j + n * i] = (out[i + n * j] + out[j + n * i]) / 2;
}

// V' H V = diag(value), V' W V = 1: W are the masses, and a little where there are none.
static void find_stiffness(struct search *s)
{
    const int n = s->n;
    const double little = 1e-6;
    double *W = s->A, mean = 0;
    restrict_to(s, W, s->l->Mr, true);
    for (int i = 0; i < n; i++)
        mean += W[i + n * i] / n;
    for (int i = 0; i < n; i++)
        W[i + n * i] += little * fmax(W[i + n * i], mean > 0 ? mean : 1 / little);
    restrict_to(s, s->H, s->l->Kr, true);
    ct_cholesky(W, n, n);
    ct_cholesky_congruence(s->H, W, n, n);
    ct_symmetric_eigen(s->value, s->H, n, n, s->work);
    memcpy(s->V, s->H, (size_t)n * (size_t)n * sizeof *s->V);
    for (int j = 0; j < n; j++)
        ct_cholesky_solve_transposed(s->V + (size_t)n * (size_t)j, W, n, n);
}

// Forces p along S, and the sizes of what they are the sum of: constraints, weights, and stiffness over one unit.
static void find_forces(struct search *s)
{
    const struct ct_linear *l = s->l;
    const int f = l->nfree, nu = l->nu;
    double weight = 0;
    for (int k = 0; k < 3; k++)
        weight = fmax(weight, fabs(ct_model_number(l->m->model, l->m->model->gravity.e[k])));
    for (int j = 0; j < nu; j++) {
        s->gross[j] = l->scale[j];
        for (int i = 0; i < nu; i++)
            s->gross[j] += fabs(l->M[j + nu * i]) * weight + fabs(l->K[j + nu * i]);
    }
    ct_matrix_multiply_transposed(s->p, s->S, l->force, s->n, f, 1);
    for (int k = 0; k < s->n; k++) {
        s->scale[k] = 0;
        for (int i = 0; i < f; i++)
            for (int j = 0; j < nu && s->S[i + f * k] != 0; j++)
                s->scale[k] += fabs(s->S[i + f * k] * l->Z[j + nu * i]) * s->gross[j];
    }
}

// Is the stiffness positive beyond its round-off? Its pivots are compared each with its own diagonal, so that a structure of
// many elements, whose soft directions are far below its stiff ones, is not taken for a mechanism.
static bool is_positive(struct search *s)
{
    const int n = s->n;
    double *L = s->A, *diagonal = s->dq;
    restrict_to(s, L, s->l->Kr, true);
    for (int i = 0; i < n; i++)
        diagonal[i] = L[i + n * i];
    if (!ct_cholesky(L, n, n))
        return false;
    for (int i = 0; i < n; i++)
        if (!(L[i + n * i] * L[i + n * i] > 16 * n * DBL_EPSILON * diagonal[i]))
            return false;
    return true;
}

// Step c (n) along the directions of S.
static void find_step(struct search *s, double *c)
{
    const int n = s->n;
    const double stiffest = fmax(fabs(s->value[0]), fabs(s->value[n - 1]));
    s->is_newton = s->value[0] > flat * stiffest || is_positive(s);
    memset(c, 0, (size_t)n * sizeof *c);
    if (s->is_newton) { // exact, with forces that have no potential
        restrict_to(s, s->A, s->l->Kr, false);
        if (ct_lu(s->A, s->pivot, n, n)) {
            for (int i = 0; i < n; i++)
                c[i] = -s->p[i];
            ct_lu_solve(c, s->A, s->pivot, n, n, 1, n, false);
            return;
        }
    }
    for (int k = 0; k < n; k++) {
        const double *v = s->V + (size_t)n * (size_t)k, far = 1e30;
        double g = 0, size = 0;
        for (int i = 0; i < n; i++) {
            g += v[i] * s->p[i];
            size += fabs(v[i]) * s->scale[i];
        }
        const bool is_flat = fabs(s->value[k]) <= flat * stiffest;
        const double along = !is_flat                   ? -g / fabs(s->value[k])
                           : fabs(g) <= balanced * size ? 0
                                                        : copysign(far, -g);
        for (int i = 0; i < n; i++)
            c[i] += along * v[i];
    }
}

// The part of dq that the limits allow.
static double allowed(const struct search *s)
{
    double part = 1;
    for (size_t k = 0; k < s->l->m->e->nmotion; k++) {
        const double most = s->turns[k] ? longest_turn : s->length;
        if (fabs(s->dq[k]) * part > most)
            part = most / fabs(s->dq[k]);
    }
    return part;
}

// Work of the forces along dq at the place in l: they are known along independent speeds.
static double slope(const struct search *s)
{
    double sum = 0;
    for (int i = 0; i < s->l->nfree; i++)
        sum += s->l->force[i] * s->dq[s->l->independent[i]];
    return sum;
}

// Go along dq as far as the forces still push on: the place is in l, linearised. False without a diagnostic if no
// part of the step can be taken.
static bool go(struct search *s)
{
    struct ct_linear *l = s->l;
    const double before = slope(s), part = allowed(s), turned_back = 0.5;
    const size_t nu = (size_t)l->nu;
    for (size_t k = 0; k < nu; k++)
        s->dq[k] *= part;
    const bool is_fine
        = s->is_newton && ct_vector_largest(s->dq, nu) < nearly; // slopes are round-off here
    keep(s, false);
    for (int i = 0; i < MOST_HALVINGS; i++) {
        ct_evaluator_retract(l->m, l->y, s->dq);
        if (ct_linear_close(l) && ct_linear_rest(l)
            && (is_fine || slope(s) <= turned_back * fabs(before) * ldexp(1, -i) * part)) {
            if (i == 0 && part < 1)
                s->length *= 2;
            else if (i)
                s->length = fmax(ct_vector_largest(s->dq, nu), first_length * 1e-6);
            return true;
        }
        if (l->ctx->nerror)
            return false;
        keep(s, true);
        for (size_t k = 0; k < nu; k++)
            s->dq[k] /= 2;
    }
    return false;
}

// ---- the search ---------------------------------------------------------------------------------------------

bool ct_equilibrium_missing(const struct ct_linear *l, int k)
{
    const struct ct_u *u = &l->m->e->u[k];
    if (ct_speed_is_state(l->m->e, (size_t)k))
        return ct_error(l->ctx, l->m->model->state[(size_t)k - l->m->e->nmotion].rate_mark,
                        CT_E_EQUILIBRIUM,
                        "no equilibrium is found: the state '%s' goes on to change; its rate, or "
                        "what it acts on, must come to rest somewhere near the start",
                        u->name);
    const struct ct_mark mark = u->joint >= 0 ? l->m->model->joint[u->joint].mark
                              : u->body >= 0  ? l->m->model->body[u->body].instance.mark
                                              : (struct ct_mark){.file = l->m->model->file};
    return ct_error(l->ctx, mark, CT_E_EQUILIBRIUM,
                    "no equilibrium is found: '%s' goes on to move; hold it by a stiffness, or "
                    "start nearer to an equilibrium",
                    ct_linear_coordinate(l->m->e, l->arena, k));
}

static int moves_most(const struct search *s)
{
    int most = 0;
    for (int k = 0; k < s->l->nu; k++)
        if (fabs(s->dq[k]) > fabs(s->dq[most]))
            most = k;
    return most;
}

static double place_size(const struct ct_linear *l)
{
    return 1 + ct_vector_largest(l->y, l->m->nq);
}

// Nothing but round-off is left. Where the stiffness vanishes, steps would follow it off the path.
static bool is_balanced(const struct search *s)
{
    for (int k = 0; k < s->n; k++)
        if (fabs(s->p[k]) > 8 * DBL_EPSILON * s->scale[k])
            return false;
    return true;
}

bool ct_equilibrium_rates(struct ct_linear *l, struct ct_equilibrium_result *out)
{
    enum { MOST = 25 };
    struct search s = search_create(l, NULL);
    double last = INFINITY;
    const size_t before = l->ctx->nerror;
    s.length
        = INFINITY; // a path may lead far; what jumps to another one does not converge steadily
    *out = (struct ct_equilibrium_result){0};
    if (!ct_linear_rest(l))
        return false;
    for (;; out->iterations++) {
        const int f = l->nfree;
        find_directions(&s);
        find_forces(&s);
        if (is_balanced(&s))
            break;
        memcpy(s.A, l->Kr, (size_t)f * (size_t)f * sizeof *s.A);
        for (int i = 0; i < f; i++)
            s.g[i] = -l->force[i];
        if (f && !ct_lu(s.A, s.pivot, f, f))
            return false;
        if (f)
            ct_lu_solve(s.g, s.A, s.pivot, f, f, 1, f, false);
        ct_linear_expand(l, s.dq, s.g);
        const double size = ct_vector_largest(s.dq, (size_t)l->nu) / place_size(l);
        out->last_step = size;
        if (size <= arrived || (size <= nearly && size > last / 2))
            break;
        if (!isfinite(size) || out->iterations == MOST || allowed(&s) < 1 || size > last / 2)
            return false;
        last = size;
        ct_evaluator_retract(l->m, l->y, s.dq);
        if (!ct_linear_close(l) || !ct_linear_rest(l) || l->ctx->nerror != before)
            return false;
    }
    return true;
}

// Down the forces. False, without a diagnostic of its own, if that leads nowhere: s->dq is the last step that was sought.
static bool descend(struct search *s, struct ct_equilibrium_result *out)
{
    struct ct_linear *l = s->l;
    double last = INFINITY, *c = s->g;
    *out = (struct ct_equilibrium_result){0};
    if (!ct_linear_rest(l))
        return false;
    for (;; out->iterations++) {
        find_directions(s);
        find_forces(s);
        if (!s->n)
            return true;
        find_stiffness(s);
        find_step(s, c);
        ct_matrix_multiply(s->B, s->S, c, l->nfree, s->n, 1);
        ct_linear_expand(l, s->dq, s->B);
        const double size = ct_vector_largest(s->dq, (size_t)l->nu) / place_size(l);
        out->last_step = size;
        if (size <= arrived || (size <= nearly && size > last / 2))
            return true;
        last = size;
        if (out->iterations == MOST_STEPS || !go(s))
            return false;
    }
}

// Do forces that have no potential act here, as those that turn with a body?
static bool has_no_potential(const struct ct_linear *l)
{
    const double roundoff = 1e-9; // of the largest stiffness
    double odd = 0, largest = 0;
    for (int j = 0; j < l->nfree; j++)
        for (int i = 0; i < l->nfree; i++) {
            odd = fmax(odd, fabs(l->Kr[i + l->nfree * j] - l->Kr[j + l->nfree * i]));
            largest = fmax(largest, fabs(l->Kr[i + l->nfree * j]));
        }
    return odd > roundoff * largest;
}

// ---- with states of the model ----------------------------------------------------------------------------------
//
// Where z' = 0 as well: what controllers hold has no potential, and nothing goes down. Newton's method with steps of least
// norm, where nothing tells a state or a place, shortened while the next correction by the same derivatives grows.
// Source: Deuflhard (2011), 3.2, key deuflhard2011.

// The largest change of dq against the size of what it changes; a place of a state is measured by itself.
static double relative_size(const struct ct_linear *l, const double *dq)
{
    const struct ct_equations *e = l->m->e;
    double size = ct_vector_largest(dq, e->nmotion) / place_size(l);
    for (size_t k = e->nmotion; k < e->nu; k++)
        size = fmax(size, fabs(dq[k]) / (1 + fabs(l->y[e->nq + k])));
    return size;
}

// dq (nu, out): the correction for the forces of now, by the derivatives in s->H.
static void correct(struct search *s, double *dq)
{
    struct ct_linear *l = s->l;
    const int f = l->nfree;
    memcpy(s->A, s->H, (size_t)f * (size_t)f * sizeof *s->A);
    for (int i = 0; i < f; i++)
        s->g[i] = -l->force[i];
    if (f)
        ct_lstsq(s->g, s->A, f, f, f, ct_rank_tolerance, l->iwork, l->work);
    ct_linear_expand(l, dq, s->g);
}

// Along s->dq to where the next correction is smaller. False if it is nowhere.
static bool go_nearer(struct search *s, double size)
{
    struct ct_linear *l = s->l;
    const size_t nu = (size_t)l->nu;
    double part = allowed(s);
    keep(s, false);
    for (int i = 0; i < MOST_HALVINGS; i++, part /= 2) {
        for (size_t k = 0; k < nu; k++)
            s->p[k] = part * s->dq[k];
        ct_linear_retract(l, s->p);
        if (ct_linear_close(l) && ct_linear_rest(l)) {
            correct(s, s->scale);
            if (size <= nearly || relative_size(l, s->scale) <= (1 - part / 4) * size)
                return true;
        }
        if (l->ctx->nerror)
            return false;
        keep(s, true);
    }
    return false;
}

// The speed along which forces are left that no step takes off; -1: none is.
static int unbalanced(struct search *s)
{
    find_directions(s);
    find_forces(s);
    for (int k = 0; k < s->n; k++)
        if (fabs(s->p[k]) > balanced * s->scale[k])
            return s->l->independent[k];
    return -1;
}

static bool find_with_states(struct search *s, struct ct_equilibrium_result *out)
{
    struct ct_linear *l = s->l;
    double last = INFINITY;
    s->length = INFINITY;
    *out = (struct ct_equilibrium_result){0};
    if (!ct_linear_rest(l))
        return false;
    for (;; out->iterations++) {
        memcpy(s->H, l->Kr, (size_t)l->nfree * (size_t)l->nfree * sizeof *s->H);
        correct(s, s->dq);
        const double size = out->last_step = relative_size(l, s->dq);
        if (size <= arrived || (size <= nearly && size > last / 2))
            break;
        last = size;
        if (out->iterations == MOST_STEPS || !go_nearer(s, size))
            return false;
    }
    return unbalanced(s) < 0;
}

bool ct_equilibrium_find(struct ct_linear *l, const bool *held,
                         struct ct_equilibrium_result *out)
{
    struct search s = search_create(l, held), start = s;
    start.kept_y = CT_NEWN(l->arena, double, l->m->nq + (size_t)l->nu + 1);
    start.kept_memory = CT_NEWN(l->arena, double, l->m->e->nmemory + 1);
    keep(&start, false);
    if (l->m->e->nstate) {
        if (find_with_states(&s, out))
            return true;
        const int left = l->ctx->nerror ? -1 : unbalanced(&s);
        return !l->ctx->nerror && ct_equilibrium_missing(l, left < 0 ? moves_most(&s) : left);
    }
    if (!held) {
        if (!ct_linear_rest(l))
            return false;
        if (has_no_potential(l) && ct_equilibrium_rates(l, out))
            return true;
        keep(&start, true);
    }
    if (descend(&s, out))
        return true;
    return l->ctx->nerror ? false : ct_equilibrium_missing(l, moves_most(&s));
}
