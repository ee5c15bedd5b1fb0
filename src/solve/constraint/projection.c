// Constraint projection by Newton's method: q and u become solutions of Phi = 0 and v = 0. Only
// dependent coordinates change, or all by the minimum-norm step where J_d is nearly singular.
// See partition_internal.h.
#include "solve/constraint/partition_internal.h"

#include "integrate/stepper.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

// d (nu) = -J^+ r: the minimum-norm step for all rows.
static void minimum_norm_step(struct ct_partition *s, const double *r, double *d)
{
    const int n = (int)s->m->nu, m = (int)s->m->nrow, ld = n > m ? n : m;
    memcpy(s->A, s->m->J, (size_t)(n * m) * sizeof *s->A);
    memset(s->d, 0, (size_t)ld * sizeof *s->d);
    for (int i = 0; i < m; i++)
        s->d[i] = -r[i];
    ct_lstsq_of_rank(s->d, s->A, m, n, m, ct_rank_tolerance, s->rank, s->iwork, s->work);
    memcpy(d, s->d, (size_t)n * sizeof *d);
}

// d (nu) = correction of the dependent coordinates, with J_d as factored last.
static void partitioned_step(struct ct_partition *s, const double *r, double *d)
{
    const int k = s->rank;
    memset(d, 0, s->m->nu * sizeof *d);
    for (int i = 0; i < k; i++)
        s->c[i] = -r[s->row[i]];
    ct_lu_solve(s->c, s->Jd, s->pivot, k, k, 1, k, false);
    for (int i = 0; i < k; i++)
        d[s->dependent[i]] = s->c[i];
}

// Factor J_d; false if it is too close to singular for partitioned steps.
static bool is_partitioned(struct ct_partition *s)
{
    return ct_partition_factor(s) && s->kappa <= ct_kappa_largest;
}

// r (nrow) += J d.
static void add_change(const struct ct_partition *s, double *r, const double *d)
{
    for (size_t j = 0; j < s->m->nu; j++)
        for (size_t i = 0; i < s->m->nrow && d[j] != 0; i++)
            r[i] += s->m->J[i + s->m->nrow * j] * d[j];
}

// Is a new choice of rows and columns needed?
static bool is_degraded(const struct ct_partition *s)
{
    if (!s->rank)
        return false;
    return ct_partition_is_degraded(s->kappa, s->kappa_chosen, s->sigma, s->sigma_chosen,
                                    s->sigma_best, s->rank < (int)s->m->nrow);
}

// The factor sigma of the tolerance of a projection. The rank monitor's nearness is included,
// as sigma is 1 everywhere with a single row. While a singular configuration is crossed the
// residual is divided twice by a decreasing pivot: 0, so that the iteration continues to
// round-off.
static double nearness(const struct ct_partition *s)
{
    return s->is_crossing ? 0 : ct_smaller(s->sigma, s->nearness);
}

static enum ct_eval project_by_matrices(struct ct_partition *s, double t, double *y)
{
    struct ct_evaluator *m = s->m;
    double before = INFINITY;
    for (int i = 0;; i++) {
        ct_evaluator_set(m, t, y);
        ct_evaluator_constraint(m);
        const double size = ct_vector_max_norm(m->phi, m->nrow) / s->scale;
        if (ct_is_projected(nearness(s), size, before))
            break;
        if (ct_is_diverging(i, size, before))
            return CT_EVAL_RETRY;
        before = size;
        (is_partitioned(s) ? partitioned_step : minimum_norm_step)(s, m->phi, s->r);
        ct_evaluator_retract(m, y, s->r);
    }
    const bool is_regular = is_partitioned(s);
    for (int i = 0; i < 2; i++) { // v is linear in u; the second step removes round-off
        (is_regular ? partitioned_step : minimum_norm_step)(s, m->v, s->r);
        for (size_t k = 0; k < m->nu; k++)
            y[m->nq + k] += s->r[k];
        add_change(s, m->v, s->r);
    }
    ct_evaluator_set(m, t, y);
    return CT_EVAL_OK;
}

bool ct_partition_close_loops(struct ct_partition *s, double t, double *y)
{
    const double kappa = s->kappa, sigma = s->sigma, largest = s->largest, near = s->nearness;
    if (ct_partition_is_large(s))
        return false;
    ct_evaluator_normalise(s->m, y);
    s->nearness = 1; // the monitored value belongs to the last step, not to this state
    const bool is_closed = project_by_matrices(s, t, y) == CT_EVAL_OK;
    s->nearness = near;
    s->kappa = kappa;
    s->sigma = sigma;
    s->largest = largest;
    return is_closed;
}

static bool evaluate_closing(struct ct_partition *s, double t, const double *y)
{
    ct_evaluator_set(s->m, t, y);
    s->strength.now = ct_solver_close(s->solver[0], s->m);
    if (!ct_partition_is_sound(s))
        return false;
    ct_partition_update_sigma(s);
    return true;
}

static double sum_of_sizes(const double *d, size_t n)
{
    double sum = 0;
    for (size_t k = 0; k < n; k++)
        sum += fabs(d[k]);
    return sum;
}

// Is one evaluation enough, with simultaneous corrections of coordinates and speeds? Not with
// redundant rows, whose residual must be evaluated, nor near a singular configuration, where
// the round-off of coordinates is amplified in the speeds.
static bool is_one_enough(const struct ct_partition *s, const double *y)
{
    const struct ct_evaluator *m = s->m;
    const struct ct_solver *f = s->solver[0];
    if (!f->shift || s->nearness < ct_small_pivot)
        return false;
    const double near = nearness(s), dq = sum_of_sizes(f->dq, m->nu);
    // cheap test of the coordinates first
    return ct_is_remainder_below_roundoff(near, dq, 0, 0)
        && ct_is_remainder_below_roundoff(
               near, dq, sum_of_sizes(f->du, m->nu) + sum_of_sizes(f->shift, m->nu),
               ct_vector_max_norm(y + m->nq, m->nu));
}

static void add_speeds(const struct ct_partition *s, double *y, const double *du)
{
    ct_vector_add(y + s->m->nq, 1, du, s->m->nu);
}

// Correct coordinates and, if their change along dq is known, speeds.
static void correct_both(const struct ct_partition *s, double *y)
{
    const struct ct_solver *f = s->solver[0];
    ct_evaluator_retract(s->m, y, f->dq);
    if (!f->shift)
        return;
    add_speeds(s, y, f->du);
    add_speeds(s, y, f->shift);
}

// Correct speeds after the coordinates; twice if the round-off of the first correction matters.
// False if pivots are too small.
static bool correct_speeds(struct ct_partition *s, double t, double *y)
{
    const double *du = s->solver[0]->du;
    const bool is_rough = ct_vector_max_norm(du, s->m->nu) > ct_small_change;
    add_speeds(s, y, du);
    const bool is_sound = !is_rough || evaluate_closing(s, t, y);
    if (is_rough)
        add_speeds(s, y, du);
    return is_sound;
}

// Projection by the present solver; *is_done is false if its pivots are too small.
static enum ct_eval project_by_solver(struct ct_partition *s, double t, double *y,
                                      bool *is_done)
{
    struct ct_evaluator *m = s->m;
    const struct ct_solver *f = s->solver[0];
    double before = INFINITY;
    *is_done = false;
    if (s->kappa > ct_kappa_largest)
        return CT_EVAL_OK;
    for (int i = 0; evaluate_closing(s, t, y); i++) {
        const double size = ct_vector_max_norm(f->phi, m->nrow) / s->scale;
        const bool is_closed = ct_is_projected(nearness(s), size, before);
        if (!is_closed && ct_is_diverging(i, size, before))
            return CT_EVAL_RETRY;
        if (i == 0)
            s->correction = is_closed ? 0 : ct_vector_max_norm(f->dq, m->nu) / size;
        *is_done = is_closed ? correct_speeds(s, t, y) : is_one_enough(s, y);
        if (!is_closed)
            correct_both(s, y);
        if (is_closed || *is_done) {
            ct_evaluator_set(m, t, y);
            return CT_EVAL_OK;
        }
        before = size;
    }
    return CT_EVAL_OK;
}

// Projection with the present rows and columns.
static enum ct_eval project(struct ct_partition *s, double t, double *y)
{
    bool is_done = false;
    enum ct_eval e
        = ct_partition_is_solver_due(s) ? project_by_solver(s, t, y, &is_done) : CT_EVAL_OK;
    if (e == CT_EVAL_OK && !is_done) {
        e = project_by_matrices(s, t, y);
        if (s->has_solver) { // sigma has just been found
            s->strength.now = ct_solver_close(s->solver[0], s->m);
            ct_strength_compare(&s->strength, s->sigma);
        }
    }
    return e;
}

enum ct_eval ct_partition_project(struct ct_partition *s, double t, double *y)
{
    const size_t ny = s->m->nq + s->m->nu;
    ct_evaluator_normalise(s->m, y);
    if (!s->m->nrow)
        return CT_EVAL_OK;
    ct_evaluator_copy(s->before, y, ny);
    const enum ct_eval e = project(s, t, y);
    if (e != CT_EVAL_OK || s->is_crossing)
        return e;
    ct_partition_check_solver(s);
    s->is_renewed = true;
    if (!is_degraded(s))
        return CT_EVAL_OK;
    // With a degraded choice the correction was kappa times the residual or more: make a new
    // choice and project again from the state before.
    ct_evaluator_constraint(s->m); // solvers do not update J
    ct_partition_choose(s);
    ct_evaluator_copy(y, s->before, ny);
    return project(s, t, y);
}

static void choose_if_degraded(struct ct_partition *s)
{
    if (!s->rank || !is_degraded(s))
        return;
    ct_evaluator_constraint(s->m); // solvers do not update J
    ct_partition_choose(s);
}

void ct_partition_renew(struct ct_partition *s)
{
    s->is_renewed = false;
    if (ct_partition_is_solver_due(s)) {
        s->strength.now = ct_solver_close(s->solver[0], s->m);
        ct_partition_check_solver(s);
    }
    choose_if_degraded(s);
}

void ct_partition_renew_after_step(struct ct_partition *s, double t, const double *y)
{
    const bool is_renewed = s->is_renewed;
    s->is_renewed = false;
    if (is_renewed)
        return;
    ct_evaluator_set(s->m, t, y);
    if (ct_partition_is_solver_due(s))
        ct_partition_check_solver(s);
    choose_if_degraded(s);
}
