// Selection of a solver with a fixed order of pivots (solver.h) for a coordinate partitioning,
// and checks that its order of pivots is still good. See partition_internal.h.
#include "solve/constraint/partition_internal.h"

#include <math.h>
#include <string.h>

// If no refinement was needed, the next projections, up to this number, are not checked while
// strength and corrections are unchanged. Chosen: a check takes the time of some two evaluations, a
// step at least six, so that checks take at most a twentieth of the time.
enum { UNCHECKED_PROJECTIONS = 7 };

static struct ct_partition_sets partition(const struct ct_partition *s)
{
    return (struct ct_partition_sets){s->row, s->dependent, s->independent, (size_t)s->rank,
                                      s->m->nu - (size_t)s->rank};
}

// Operations of (6.2) by dense matrices, for n speeds, r retained rows and f = n - r freedoms:
// LU of J_d, its solutions, the products M B and B' M B, Cholesky of the reduced mass matrix.
double ct_partition_operations(const struct ct_partition *s)
{
    const double n = (double)s->m->nu, r = s->rank, f = n - r;
    const double lu = 2 * r * r * r / 3 + 2 * r * r * (f + 1);
    const double right = 2 * n * r + 2 * r * f;
    const double reduced = r > 0 ? 2 * n * r * f + r * f * (f + 1) : 0;
    return lu + right + reduced + f * f * f / 3 + 2 * f * f + 2 * r * f;
}

// Move solver[i] to the front of the list.
static void put_first(struct ct_partition *s, size_t i)
{
    struct ct_solver *f = s->solver[i];
    memmove(s->solver + 1, s->solver, i * sizeof *s->solver);
    s->solver[0] = f;
}

// Make a solver for the present rows and columns. It replaces solver[0] if that is for the same
// ones, or the last one if the list is full. Its order of pivots is found at the evaluator's
// input.
static void make_solver(struct ct_partition *s)
{
    const struct ct_partition_sets p = partition(s);
    if (s->has_solver || s->nsolver == CT_MOST_SOLVERS) {
        put_first(s, s->has_solver ? 0 : s->nsolver - 1);
        ct_solver_destroy(s->m, s->solver[0]);
        memmove(s->solver, s->solver + 1, --s->nsolver * sizeof *s->solver);
    }
    ct_evaluator_dynamics(s->m);
    struct ct_solver_costs costs = {0};
    struct ct_solver *f
        = s->is_requested
            ? ct_solver_create_any_length(s->arena, s->m, &p, s->kind)
            : ct_solver_create(s->arena, s->m, &p, ct_partition_operations(s), s->kind, &costs);
    if (s->nmade == 0 && !s->is_requested)
        s->costs = costs;
    s->solves.reordered += s->nmade++ > 0;
    s->has_solver = f != NULL;
    if (f) {
        s->kind = f->kind;
        s->solver[s->nsolver] = f;
        put_first(s, s->nsolver++);
    }
}

// Number of projections with failed checks, or without a solver, after which a solver is made.
// It doubles with every CT_MOST_SOLVERS solvers: a motion that often changes its rows and
// columns would otherwise spend its time making solvers.
static long checks_before_retry(const struct ct_partition *s)
{
    const long doublings = s->nmade / CT_MOST_SOLVERS;
    return 1L << (doublings < 16 ? doublings : 16);
}

static void forget_strength(struct ct_partition *s)
{
    s->nweak = s->nunchecked = 0;
    s->strength.at_sigma = 0;
    s->strength.is_alike = false;
}

void ct_partition_select_solver(struct ct_partition *s)
{
    const struct ct_partition_sets p = partition(s);
    size_t i = 0;
    s->has_solver = s->needs_refinement = false;
    forget_strength(s);
    if (!s->m->nrow || s->is_expensive)
        return;
    while (i < s->nsolver && !ct_solver_matches(s->solver[i], &p))
        i++;
    if (i < s->nsolver) {
        s->has_solver = true;
        put_first(s, i);
    } else if (checks_before_retry(s) == 1) {
        make_solver(s);
        s->is_expensive = s->nmade == 1 && !s->has_solver;
    }
}

void ct_partition_use_dense_only(struct ct_partition *s)
{
    s->is_expensive = true;
    s->has_solver = false;
}

void ct_partition_use_solver(struct ct_partition *s, const struct ct_solver_kind *kind)
{
    s->kind = kind;
    s->is_requested = kind != NULL;
    if (!kind)
        ct_partition_use_dense_only(s);
}

bool ct_partition_is_sound(const struct ct_partition *s)
{
    double low, high;
    ct_strength_range(&s->strength, &low, &high);
    return s->strength.now > low && s->strength.now < high;
}

bool ct_partition_is_solver_due(const struct ct_partition *s)
{
    return s->has_solver && s->nweak == 0 && (s->strength.is_alike || !s->is_near_singular);
}

void ct_partition_update_sigma(struct ct_partition *s)
{
    if (s->strength.is_alike)
        s->sigma = ct_strength_sigma(&s->strength);
}

static bool has_one_freedom(const struct ct_partition *s)
{
    return s->least_cancellation > 0 && (size_t)s->rank + 1 == s->m->nu;
}

// u' by the present solver; false if its pivots are too small here.
static bool use_solver(struct ct_partition *s)
{
    struct ct_solver *f = s->solver[0];
    // the solver does not know the terms that cancel in an inertia, but its largest value so far
    f->least_part = has_one_freedom(s) ? s->least_cancellation : 0;
    s->strength.now = ct_solver_solve(f, s->m, s->a);
    if (!ct_partition_is_sound(s) || f->has_fallen)
        return false;
    ct_partition_update_sigma(s);
    s->solves.fixed++;
    if (!s->needs_refinement)
        return true;
    ct_solver_check(f, s->m);
    s->solves.refined++;
    memcpy(s->a, f->a, s->m->nu * sizeof *s->a);
    return f->refined_remainder <= ct_largest_residual;
}

enum ct_eval ct_partition_solve(struct ct_partition *s)
{
    struct ct_evaluator *m = s->m;
    if (ct_evaluator_solved(m, s->a))
        return CT_EVAL_OK;
    const bool is_tried = ct_partition_is_solver_due(s);
    if (is_tried && use_solver(s))
        return CT_EVAL_OK;
    ct_evaluator_dynamics(m);
    s->solves.pivoted++;
    const enum ct_eval e = ct_partition_accelerate(s);
    if (e == CT_EVAL_OK && has_one_freedom(s))
        s->smallest_cancellation = fmin(s->smallest_cancellation, ct_partition_cancellation(s));
    if (s->has_solver && !is_tried)
        s->strength.now = ct_solver_close(s->solver[0], m);
    if (s->has_solver)
        ct_strength_compare(&s->strength, s->sigma);
    return e;
}

// Are strength and corrections those of the last check, which found the solution accurate? Near
// a singular configuration corrections grow with any choice, and say nothing.
static bool is_still_checked(const struct ct_partition *s)
{
    return s->nunchecked > 0 && ct_is_within(s->strength.now / s->checked_at, ct_same_strength)
        && (s->correction <= ct_correction_growth * s->correction_checked
            || s->nearness < ct_small_pivot);
}

// Is the order of pivots still good?
static void check_solver(struct ct_partition *s)
{
    struct ct_solver *f = s->solver[0];
    if (is_still_checked(s)) {
        s->nunchecked--;
        return;
    }
    s->correction_checked = s->correction > 0 ? s->correction : s->correction_checked;
    ct_solver_check(f, s->m);
    s->needs_refinement = f->remainder > ct_refinement_residual;
    s->nunchecked = s->needs_refinement ? 0 : UNCHECKED_PROJECTIONS;
    s->checked_at = s->strength.now;
    if (s->strength.now > CT_LEAST_STRENGTH && f->refined_remainder <= ct_largest_residual) {
        s->kappa = isnan(f->kappa) ? s->kappa : f->kappa;
        s->nweak = 0;
    } else if (++s->nweak >= checks_before_retry(s)) {
        make_solver(s);
        forget_strength(s);
    }
}

void ct_partition_check_solver(struct ct_partition *s)
{
    if (!s->m->nrow || s->is_expensive || (s->is_near_singular && !s->strength.is_alike))
        return;
    if (s->has_solver)
        check_solver(s);
    else if (++s->nweak >= checks_before_retry(s)) {
        make_solver(s);
        forget_strength(s);
    }
}

bool ct_partition_solver_multipliers(struct ct_partition *s)
{
    struct ct_solver *f = s->solver[0];
    if (!ct_partition_is_solver_due(s) || s->rank < (int)s->m->nrow
        || !ct_partition_is_sound(s))
        return false;
    ct_solver_check(f, s->m);
    memcpy(s->lam, f->lam,
           s->m->nrow * sizeof *s->lam); // no row is redundant, and rows are in ascending order
    return f->refined_remainder <= ct_largest_residual;
}

enum ct_eval ct_partition_accelerate_at(struct ct_partition *s, double t, const double *y)
{
    ct_evaluator_set(s->m, t, y);
    const enum ct_eval e = ct_partition_solve(s);
    if (e != CT_EVAL_OK)
        return e;
    double *a = s->m->input + s->m->at_a;
    for (size_t i = 0; i < s->m->nu; i++) {
        a[i] = s->a[i];
        if (!isfinite(a[i]))
            return CT_EVAL_RETRY;
    }
    return CT_EVAL_OK;
}
