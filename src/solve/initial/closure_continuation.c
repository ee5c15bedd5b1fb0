// See closure_continuation.h.
#include "solve/initial/closure_continuation.h"
#include "formulate/kinematics/constraint_offset.h"
#include "numeric/dense.h"
#include "solve/constraint/partition_conditioning.h"

#include <float.h>
#include <math.h>
#include <string.h>

void ct_closure_continuation_begin(struct ct_static_residual *s)
{
    const double *memory = s->m->input + s->m->at_memory;
    for (size_t i = 0; i < s->e->noffset; i++) {
        const struct ct_constraint_offset *g = &s->e->offset[i];
        if (g->is_rotation)
            ct_quaternion_of(memory + g->first, s->offset + 4 * i);
        else
            s->offset[4 * i] = memory[g->first];
    }
}

void ct_closure_continuation_set(struct ct_static_residual *s, double part)
{
    double *memory = s->m->input + s->m->at_memory;
    for (size_t i = 0; i < s->e->noffset; i++) {
        const struct ct_constraint_offset *g = &s->e->offset[i];
        const double *q = s->offset + 4 * i;
        if (!g->is_rotation) {
            memory[g->first] = part * q[0];
            continue;
        }
        const double sine = sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]),
                     half = part * atan2(sine, q[0]), size = sine > 0 ? sin(half) / sine : 0;
        const double p[4] = {cos(half), size * q[1], size * q[2], size * q[3]};
        for (int k = 0; k < 3; k++) { // column k of the rotation matrix of p
            const int l = (k + 1) % 3, n = (k + 2) % 3;
            double *R = memory + g->first;
            R[4 * k] = 2 * (p[0] * p[0] + p[1 + k] * p[1 + k]) - 1;
            R[l + 3 * k] = 2 * (p[1 + k] * p[1 + l] + p[0] * p[1 + n]);
            R[k + 3 * l] = 2 * (p[1 + k] * p[1 + l] - p[0] * p[1 + n]);
        }
    }
}

double ct_closure_continuation_remaining(struct ct_static_residual *s, size_t *row)
{
    double worst = 0;
    ct_static_residual_evaluate(s);
    for (size_t i = 0; i < s->e->nrow; i++) {
        const double phi = fabs(s->values.out[s->n + i]);
        if (!(phi <= worst)) {
            worst = phi;
            *row = i;
        }
    }
    return worst;
}

// Tangent stiffness at s->y: n unknown coordinates, m independent rows.
struct tangent_stiffness {
    size_t nB;             // m without nearly dependent rows
    double *B;             // (n x nB) orthonormal basis of the rows
    double *J;             // (m x n) the rows
    double *force;         // (n) Q + J' lam
    size_t ntangent;       // dimension of the tangent space
    double *value, *shape; // eigenvalues, ascending, and eigenvectors (n x ntangent) of Z' K Z
};

static void orthonormal_rows(struct ct_static_residual *s, struct ct_arena *a,
                             struct tangent_stiffness *l)
{
    const size_t n = s->n, m = s->nlam;
    struct ct_basis basis = {n, 0, CT_NEWN(a, double, n *n + 1)};
    double *v = CT_NEWN(a, double, n + 1);
    l->J = CT_NEWN(a, double, m *n + 1);
    for (size_t i = 0; i < m; i++) {
        for (size_t k = 0; k < n; k++)
            v[k] = l->J[i + m * k] = s->m->J[(size_t)s->row[i] + s->e->nrow * (size_t)s->u[k]];
        ct_basis_extend(&basis, v);
    }
    l->B = basis.v;
    l->nB = basis.count;
}

// Multipliers by least squares: |Q + J' lam| is least.
static void find_multipliers(struct ct_static_residual *s, struct ct_arena *a,
                             const struct tangent_stiffness *l)
{
    const size_t n = s->n, m = s->nlam;
    double *A = CT_NEWN(a, double, m *n + 1), *b = CT_NEWN(a, double, n + m + 1);
    int *iwork = CT_NEWN(a, int, m + 1);
    double *work = CT_NEWN(a, double, ct_lstsq_work((int)n, (int)m + 1));
    memset(s->lam, 0, s->e->nrow * sizeof *s->lam);
    ct_static_residual_evaluate(s);
    for (size_t k = 0; k < n; k++) {
        b[k] = -s->values.out[k];
        for (size_t i = 0; i < m; i++)
            A[k + n * i] = l->J[i + m * k];
    }
    if (m && n)
        ct_lstsq(b, A, (int)n, (int)m, (int)n, ct_rank_tolerance, iwork, work);
    for (size_t i = 0; i < m; i++)
        s->lam[s->row[i]] = b[i];
}

// Forces, and eigenvalues and eigenvectors of the stiffness Z' K Z in the tangent space. False
// if the eigenvalue iteration fails.
static bool find_tangent_stiffness(struct ct_static_residual *s, struct ct_arena *a,
                                   struct tangent_stiffness *l)
{
    const size_t n = s->n;
    ct_static_residual_choose_rows(s, a);
    orthonormal_rows(s, a, l);
    find_multipliers(s, a, l);
    ct_static_residual_evaluate(s);
    ct_static_residual_fill(s);
    l->force = CT_NEWN(a, double, n + 1);
    memcpy(l->force, s->values.out, n * sizeof *l->force);
    // Z completes the basis of the rows to one of all unknowns
    struct ct_basis basis = {n, l->nB, l->B};
    double *v = CT_NEWN(a, double, n + 1);
    for (size_t k = 0; k < n; k++) {
        memset(v, 0, n * sizeof *v);
        v[k] = 1;
        ct_basis_extend(&basis, v);
    }
    const size_t size = n + s->nlam, nt = basis.count - l->nB;
    const double *Z = l->B + n * l->nB;
    l->ntangent = nt;
    if (!nt)
        return true;
    double *K = CT_NEWN(a, double, n *n + 1), *KZ = CT_NEWN(a, double, n *n + 1),
           *direction = CT_NEWN(a, double, n *n + 1);
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < n; i++)
            K[i + n * k] = -0.5 * (s->A[i + size * k] + s->A[k + size * i]);
    ct_matrix_multiply(KZ, K, Z, (int)n, (int)n, (int)nt);
    ct_matrix_multiply_transposed(direction, Z, KZ, (int)nt, (int)n, (int)nt);
    l->value = CT_NEWN(a, double, nt + 1);
    l->shape = CT_NEWN(a, double, n *n + 1);
    if (!ct_symmetric_eigen(l->value, direction, (int)nt, (int)nt,
                            CT_NEWN(a, double, ct_symmetric_eigenvalues_work((int)nt))))
        return false;
    ct_matrix_multiply(l->shape, Z, direction, (int)n, (int)nt, (int)nt);
    return true;
}

static void step_by(struct ct_static_residual *s, const double *d, double part)
{
    memset(s->step, 0, s->e->nu * sizeof *s->step);
    for (size_t k = 0; k < s->n; k++)
        s->step[s->u[k]] = part * d[k];
    ct_evaluator_retract(s->m, s->y, s->step);
}

// Scale d so that no entry exceeds 1 m or rad, where linearised rotations become invalid.
static void limit_step(double *d, size_t n)
{
    double size = 0;
    for (size_t k = 0; k < n; k++)
        size = fmax(size, fabs(d[k]));
    for (size_t k = 0; k < n && size > 1; k++)
        d[k] /= size;
}

// Close the independent rows by minimum-norm steps.
static void close_rows(struct ct_static_residual *s, struct ct_arena *a)
{
    enum { MOST_CLOSINGS = 20 }; // Limit: of iterations; is_stable_equilibrium finds open rows
    const size_t n = s->n;
    for (int i = 0; i < MOST_CLOSINGS; i++) {
        struct tangent_stiffness l = {0};
        size_t row = 0;
        ct_static_residual_choose_rows(s, a);
        orthonormal_rows(s, a, &l);
        if (ct_closure_continuation_remaining(s, &row) < ct_rank_tolerance || !s->nlam)
            return;
        const size_t m = s->nlam;
        double *b = CT_NEWN(a, double, n + m + 1);
        int *iwork = CT_NEWN(a, int, n + m + 1);
        double *work = CT_NEWN(a, double, ct_lstsq_work((int)m, (int)n + 1));
        for (size_t r = 0; r < m; r++)
            b[r] = -s->values.out[n + (size_t)s->row[r]];
        ct_lstsq(b, l.J, (int)m, (int)n, (int)m, ct_rank_tolerance, iwork, work);
        limit_step(b, n);
        step_by(s, b, 1);
    }
}

struct saved_state {
    double *y, *lam;
};

static struct saved_state saved_state(struct ct_static_residual *s, struct ct_arena *a)
{
    return (struct saved_state){CT_NEWN(a, double, s->m->nq + 1),
                                CT_NEWN(a, double, s->e->nrow + 1)};
}

static void keep(struct ct_static_residual *s, struct saved_state *k, bool back)
{
    memcpy(back ? s->y : k->y, back ? k->y : s->y, s->m->nq * sizeof *s->y);
    memcpy(back ? s->lam : k->lam, back ? k->lam : s->lam, s->e->nrow * sizeof *s->lam);
}

// One minimisation step of the potential energy in the tangent space (9.2): Newton's step in
// eigenvectors of positive stiffness; in others the absolute value of the stiffness is used,
// which leads away from a saddle. The step is halved while the energy's slope at its end is
// positive and more than half of that at its beginning. Returns its size.
static double descend(struct ct_static_residual *s, struct ct_arena *a,
                      const struct tangent_stiffness *l)
{
    const size_t n = s->n;
    struct saved_state from = saved_state(s, a);
    double *d = CT_NEWN(a, double, n + 1), push = 0, part = 1, size = 0;
    for (size_t i = 0; i < l->ntangent; i++) {
        double along = 0;
        for (size_t k = 0; k < n; k++)
            along += l->shape[k + n * i] * l->force[k];
        for (size_t k = 0; k < n; k++)
            d[k] += l->shape[k + n * i] * along
                  / fmax(fabs(l->value[i]), DBL_EPSILON * s->stiffness);
    }
    limit_step(d, n);
    for (size_t k = 0; k < n; k++) {
        push += d[k] * l->force[k];
        size = fmax(size, fabs(d[k]));
    }
    keep(s, &from, false);
    for (; part > DBL_EPSILON; part /= 2) {
        struct tangent_stiffness end = {0};
        keep(s, &from, true);
        step_by(s, d, part);
        close_rows(s, a);
        ct_static_residual_choose_rows(s, a);
        orthonormal_rows(s, a, &end);
        find_multipliers(s, a, &end);
        ct_static_residual_evaluate(s);
        double back = 0;
        for (size_t k = 0; k < n; k++)
            back += d[k] * s->values.out[k];
        if (back > -push / 2)
            break;
    }
    return size * part;
}

// Are all rows closed and the equilibrium stable?
static bool is_stable_equilibrium(struct ct_static_residual *s, struct ct_arena *a)
{
    struct tangent_stiffness l = {0};
    size_t row = 0;
    if (ct_closure_continuation_remaining(s, &row) > ct_rank_tolerance
        || !find_tangent_stiffness(s, a, &l))
        return false;
    return l.ntangent == 0 || l.value[0] > -ct_rank_tolerance * s->stiffness;
}

// Newton's method from s->y.
static bool find_equilibrium_here(struct ct_static_residual *s, struct ct_arena *a)
{
    ct_static_residual_choose_rows(s, a);
    return ct_static_residual_iterate(s, a) && is_stable_equilibrium(s, a);
}

// Minimise the potential energy from s->y. The first step, of `side` = 1 or -1 m or rad in the
// softest eigenvector, leaves a symmetric configuration. Newton's method is tried after each step
// that was not limited.
static bool minimise_energy(struct ct_static_residual *s, struct ct_arena *a, double side)
{
    enum { MOST = 500 }; // Limit: of steps; Newton's method fails then, with a message
    double size = INFINITY;
    struct saved_state at = saved_state(s, a);
    for (int i = 0; i < MOST && size > sqrt(DBL_EPSILON); i++) {
        struct ct_arena *own = ct_arena_create_under(a);
        struct tangent_stiffness l = {0};
        if (!find_tangent_stiffness(s, own, &l) || !l.ntangent) {
            ct_arena_destroy(own);
            return false;
        }
        if (i == 0) {
            double most = 0;
            for (size_t k = 0; k < s->n; k++)
                most = fabs(l.shape[k]) > fabs(most) ? l.shape[k] : most;
            step_by(s, l.shape, side / most);
        } else {
            size = descend(s, own, &l);
        }
        close_rows(s, own);
        keep(s, &at, false);
        const bool is_found = size < 1 && find_equilibrium_here(s, own);
        ct_arena_destroy(own);
        if (is_found)
            return true;
        keep(s, &at, true);
    }
    return false;
}

// Reduce the offsets to zero. buckles (out): the energy was minimised, so `side` mattered.
static bool close_gaps(struct ct_static_residual *s, struct ct_arena *a, double side,
                       bool *buckles)
{
    // Smallest fraction of the offsets that one step removes; below it the energy is minimised.
    // Default: small steps of continuation against the slower minimisation.
    // Test: closure_by_bending_elastica
    const double least = 1.0 / 16;
    struct saved_state at = saved_state(s, a);
    double open = 1, step = 1;
    keep(s, &at, false);
    while (open > 0) {
        struct ct_arena *own = ct_arena_create_under(a);
        const double part = fmax(0, open - step);
        ct_closure_continuation_set(s, part);
        bool ok = find_equilibrium_here(s, own);
        if (!ok)
            keep(s, &at, true);
        if (!ok && step <= least) {
            *buckles = true;
            ok = minimise_energy(s, own, side);
        }
        ct_arena_destroy(own);
        if (!ok && step <= least)
            return false;
        step = ok ? 2 * step : step / 2;
        if (!ok)
            continue;
        open = part;
        ct_memory_update(s->m);
        keep(s, &at, false);
    }
    return true;
}

// Square of the distance of s->y to the guesses.
static double square_distance(struct ct_static_residual *s,
                              const struct ct_initial_state *start)
{
    double sum = 0;
    ct_evaluator_set(s->m, 0, s->y);
    ct_program_run(&s->m->result, s->m->input);
    for (size_t i = 0; i < start->n; i++) {
        const struct ct_target *t = &start->q_target[i];
        const double away = t->weight * (s->m->result.out[2 * i] - t->value);
        sum += t->is_guessed && !t->in_quaternion ? away * away : 0;
    }
    return sum;
}

bool ct_closure_continuation_run(struct ct_static_residual *s, struct ct_arena *a,
                                 const struct ct_initial_state *start)
{
    double *memory = s->m->input + s->m->at_memory;
    double *kept = CT_NEWN(a, double, 2 * s->e->nmemory + 1), *closed = kept + s->e->nmemory;
    struct saved_state begin = saved_state(s, a), end = saved_state(s, a);
    const size_t size = s->e->nmemory * sizeof *memory;
    bool buckles = false;
    keep(s, &begin, false);
    memcpy(kept, memory, size);
    const bool is_closed = close_gaps(s, a, 1, &buckles);
    if (!buckles)
        return is_closed;
    // beams that buckle may do so to either side
    const double distance = is_closed ? square_distance(s, start) : INFINITY;
    keep(s, &end, false);
    memcpy(closed, memory, size);
    keep(s, &begin, true);
    memcpy(memory, kept, size);
    if (close_gaps(s, a, -1, &buckles)
        && square_distance(s, start) < distance - ct_rank_tolerance)
        return true;
    keep(s, &end, true);
    memcpy(memory, closed, size);
    return is_closed;
}
