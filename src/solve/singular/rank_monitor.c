// Rank monitor: predicts the next singular configuration ahead of a motion. See singular.h.
//
// For the chosen rows and columns, the smallest pivot of J vanishes at a singular
// configuration, about linearly in time. Its zero is extrapolated by secants along the motion.
// A change of sign of the test function (singularity_test_function.c) shows that a step has
// passed a singular configuration.
#include "solve/singular/rank_monitor_internal.h"

#include "integrate/crossing.h"
#include "numeric/dense.h"
#include "solve/evaluator/switch_state.h"

#include <float.h>
#include <math.h>
#include <string.h>

struct ct_rank_monitor *ct_rank_monitor_create(struct ct_arena *arena, struct ct_evaluator *m,
                                               struct ct_partition *s, const double *pending)
{
    struct ct_rank_monitor *w = CT_NEW(arena, struct ct_rank_monitor);
    const size_t kept = m->nrow ? CT_MOST_SINGULAR : 0;
    *w = (struct ct_rank_monitor){.m = m, .s = s, .pending = pending};
    w->y = CT_NEWN(arena, double, m->nq + m->nu + 1);
    w->d = CT_NEWN(arena, double, m->nu + 1);
    w->x = CT_NEWN(arena, double, m->nrow + 1);
    w->there = ct_tangent_basis_create(arena);
    w->here = ct_tangent_basis_create(arena);
    w->last = CT_NEWN(arena, double, m->nq + m->nu + 1);
    w->passed = CT_NEWN(arena, struct ct_singular_configuration, kept + 1);
    for (size_t i = 0; i < kept; i++)
        w->passed[i].row = CT_NEWN(arena, bool, m->nrow + 1);
    ct_rank_monitor_start(w);
    return w;
}

void ct_rank_monitor_start(struct ct_rank_monitor *w)
{
    w->time_to_singular = INFINITY;
    w->solver_unchanged = false;
    w->reach = w->largest_pivot = w->relative_pivot = w->pivot = w->pivot_rate = w->t = w->dt
        = 0;
    w->switches = -1;
    w->npassed = w->ncrossed = 0;
    w->pole = NAN;
    w->closest = INFINITY;
    ct_tangent_basis_reserve(w->s, w->there);
    ct_tangent_basis_reserve(w->s, w->here);
    w->s->nearness = 1;
    w->output_rtol = 0;
    w->rank = 0;
}

// ---- prediction ---------------------------------------------------------------------------------

static void evaluate_constraints(struct ct_rank_monitor *w, double t, const double *y)
{
    ct_evaluator_set(w->m, t, y);
    ct_evaluator_constraint(w->m);
}

double ct_rank_monitor_pivot(struct ct_rank_monitor *w, double t, const double *y)
{
    evaluate_constraints(w, t, y);
    return ct_partition_pivot(w->s);
}

double ct_rank_monitor_pivot_after(struct ct_rank_monitor *w, const struct ct_rank_test *a,
                                   double s)
{
    const size_t nq = w->m->nq, nu = w->m->nu;
    memcpy(w->y, a->y, (nq + nu + 1) * sizeof *w->y);
    for (size_t i = 0; i < nu; i++)
        w->d[i] = s * (a->y[nq + i] + s / 2 * a->dy[nq + i]);
    ct_evaluator_retract(w->m, w->y, w->d);
    return ct_rank_monitor_pivot(w, ct_time_just_before(a->t + s, a->pending), w->y);
}

// A singular configuration is predicted when the smallest pivot is below `predicted_pivot`
// times its largest value so far and decreases. Below near_pivot new pivots are chosen at every
// evaluation. Below CT_SINGULAR_PIVOT accelerations are not computed if that can be avoided.
// Default: shorter steps near small pivots against the accuracy of accelerations.
// Test: singular_approach.
static const double predicted_pivot = 0.8, near_pivot = 0.5;
// No step ends where the pivot is below this fraction of its largest value. Derived: round-off,
// divided by its square, is 0.01 there. That is the largest tolerance which is compared
// (docs/cli.md), and less distinguishes the motions through the singular configuration.
static const double smallest_pivot = 1.5e-7;

// Round-off of accelerations is eps over the square of the relative pivot. Accelerations are
// too inaccurate if that exceeds this fraction of the tolerance. Derived: a hundredth of it.
static const double roundoff_part = 0.01;

static bool is_roundoff_limited(const struct ct_rank_monitor *w, double pivot)
{
    const double part = pivot / w->largest_pivot;
    return w->output_rtol > 0 && part < CT_SINGULAR_PIVOT / 2
        && part * part * roundoff_part * w->output_rtol < DBL_EPSILON;
}

bool ct_rank_monitor_is_roundoff_limited(struct ct_rank_monitor *w, double t, const double *y)
{
    return is_roundoff_limited(w, ct_rank_monitor_pivot(w, t, y));
}

// Time to the zero of the smallest pivot, by secants along the motion with its present
// accelerations. INFINITY if the pivot rises.
static double time_to_singular(struct ct_rank_monitor *w, const struct ct_rank_test *a,
                               double now, double dt)
{
    enum { SECANTS = 3 }; // Limit: evaluations of one prediction, repeated at each rank test
    // Derived: fraction of the last step, for a difference quotient with ten digits; fraction
    // of the predicted time, so that a secant does not pass the zero of a pivot that falls a
    // quarter faster
    const double small_part = 1e-3, part = 0.8;
    const double far = CT_STEPS_NEAR_SINGULAR * dt;
    double s = small_part * dt, pivot = ct_rank_monitor_pivot_after(w, a, s),
           slope = (pivot - now) / s;
    if (!(slope < 0))
        return INFINITY;
    for (int i = 0; i < SECANTS && s - pivot / slope < far; i++) {
        const double next = s - part * pivot / slope;
        double there = ct_rank_monitor_pivot_after(w, a, next);
        // the pivot has changed its sign; its absolute value is computed
        if (there > fabs(pivot))
            there = -there;
        if (there == pivot)
            break;
        slope = (there - pivot) / (next - s);
        s = next;
        pivot = there;
    }
    return s - pivot / slope;
}

double ct_rank_monitor_distance(struct ct_rank_monitor *w, double t, const double *y,
                                const double *dy, double s)
{
    const struct ct_rank_test a = {t, *w->pending, y, dy};
    if (!ct_partition_has_pivot(w->s))
        return INFINITY;
    const double now = ct_rank_monitor_pivot(w, ct_time_just_before(t, a.pending), y);
    const double behind = ct_rank_monitor_pivot_after(w, &a, -s),
                 ahead = ct_rank_monitor_pivot_after(w, &a, s);
    const double distance = ct_vector_max_norm(w->d, w->m->nu);
    if (behind > now
        && behind > ahead) // the pivot rises again after the singular configuration
        return now * distance / (behind - now);
    return ahead > now ? -now * distance / (ahead - now) : now * distance / (now - ahead);
}

// Predict the next singular configuration from a state with a decreasing pivot.
static void predict_next(struct ct_rank_monitor *w, const struct ct_rank_test *ahead,
                         double now)
{
    const double part = now / fmax(w->largest_pivot, now);
    w->time_to_singular = time_to_singular(w, ahead, now, w->dt);
    w->reach = w->time_to_singular * CT_SINGULAR_PIVOT / part;
}

// Is the last rank test still valid, as the solver's pivots have not changed? Where J loses
// rank its retained rows do, and a pivot of the solver vanishes. The product of the pivots
// changes its sign at a singular configuration, however far apart the tests are. With step
// control the product itself must be nearly unchanged, and no configuration may be predicted
// nearby. Fixed steps cross nothing: for them the test only decides whether new pivots are
// found at every evaluation.
static bool is_unchanged_by_solver(const struct ct_rank_monitor *w, double dt, bool is_fixed)
{
    // Default: rank tests against what changes on a step. Test: singular
    const double unchanged_ratio = 1.05;
    const struct ct_partition *s = w->s;
    if (!s->has_solver || s->nweak || s->switches != w->switches || s->nmade != w->nmade)
        return false;
    const struct ct_solver *f = s->solver[0];
    if (f->volume / w->volume < 0)
        return false;
    if (w->relative_pivot > predicted_pivot && is_fixed)
        return ct_is_within(f->weakest / w->weakest, ct_same_strength)
            && !(s->has_units && !ct_is_within(f->volume / w->volume, ct_same_strength));
    const bool is_away = is_fixed || w->relative_pivot > predicted_pivot
                      || w->time_to_singular > CT_STEPS_NEAR_SINGULAR * dt;
    return w->relative_pivot > near_pivot && is_away
        && ct_is_within(f->weakest / w->weakest, unchanged_ratio)
        && ct_is_within(f->volume / w->volume, unchanged_ratio);
}

static void store_tangent_basis(struct ct_rank_monitor *w)
{
    struct ct_tangent_basis *v = w->there;
    w->there = w->here;
    w->here = v;
}

// Find the tangent basis at the last state, where the solver's pivots replaced the rank test:
// the rank may change on the step from there.
static void test_last_state(struct ct_rank_monitor *w, double pending)
{
    ct_rank_monitor_pivot(w, ct_time_just_before(w->t, pending), w->last);
    ct_tangent_basis_find(w->s, w->there);
}

// Result of the rank test at an accepted state.
struct rank_test_result {
    double now, part; // the pivot, and the relative pivot
    bool is_crossed;  // a singular configuration was crossed since the last test
};

static struct rank_test_result test_accepted_state(struct ct_rank_monitor *w,
                                                   const struct ct_rank_test *at)
{
    struct rank_test_result l = {.is_crossed = false};
    if (w->solver_unchanged)
        test_last_state(w, at->pending);
    evaluate_constraints(w, ct_time_just_before(at->t, at->pending), at->y);
    l.now = ct_partition_pivot(w->s);
    l.part = l.now / fmax(w->largest_pivot, l.now);
    ct_tangent_basis_find(w->s, w->here);
    if (w->here->rank && w->there->rank)
        l.is_crossed = ct_singularity_test_sign_changed(w->s, w->there, w->here);
    return l;
}

static void store_state(struct ct_rank_monitor *w, double t, const double *y)
{
    w->t = t;
    memcpy(w->last, y, (w->m->nq + w->m->nu) * sizeof *y);
}

// A step that ends exactly at a singular configuration, at an event there, chooses fewer rows.
// Restore the rows of the state before, for a shorter step. False if no row was lost.
static bool restore_rows(struct ct_rank_monitor *w, double pending)
{
    if (w->s->rank >= w->rank)
        return false;
    evaluate_constraints(w, ct_time_just_before(w->t, pending), w->last);
    w->s->sigma_best = 0;
    ct_partition_choose(w->s);
    return true;
}

// Must the step to this state be repeated with a shorter one?
static bool must_be_repeated(const struct rank_test_result *l)
{
    return l->is_crossed || l->part < smallest_pivot;
}

// Would the pivot have reached zero, or nearly, at its rate on the step before? Where the rank
// falls by two the test function does not change its sign.
static bool falls_to_zero(const struct ct_rank_monitor *w, double dt)
{
    return w->pivot > 0 && w->pivot < 2 * dt * w->pivot_rate;
}

static void store_test(struct ct_rank_monitor *w, const struct ct_rank_test *at,
                       const struct rank_test_result *l, double dt)
{
    store_tangent_basis(w);
    store_state(w, at->t, at->y);
    w->rank = w->s->rank > w->rank ? w->s->rank : w->rank;
    w->solver_unchanged = false;
    w->relative_pivot = l->part;
    w->switches = w->s->switches;
    w->nmade = w->s->nmade;
    w->weakest = w->s->has_solver ? w->s->solver[0]->weakest : 0;
    w->volume = w->s->has_solver ? w->s->solver[0]->volume : NAN;
    w->largest_pivot = fmax(w->largest_pivot, l->now);
    w->pivot_rate = ((w->pivot > 0 ? w->pivot : w->largest_pivot) - l->now) / dt;
    w->pivot = l->now;
    w->time_to_singular = INFINITY;
    w->s->is_near_singular = l->part < near_pivot;
    w->s->nearness = l->part;
    w->dt = dt;
}

// Record for the report how near a step that is not a crossing has come to a singular
// configuration.
static void record_closest(struct ct_rank_monitor *w, double t,
                           const struct rank_test_result *l)
{
    if (l->is_crossed)
        w->t_crossed = w->ncrossed++ ? w->t_crossed : t;
    if (l->part < w->closest) {
        w->closest = l->part;
        w->t_closest = t;
    }
}

bool ct_rank_monitor_predict(struct ct_rank_monitor *w, double t, const double *y,
                             const double *dy, const struct ct_rank_monitor_step *step)
{
    const struct ct_rank_test at = {t, *w->pending, y, dy};
    const double dt = t - w->t;
    if (!ct_partition_has_pivot(w->s) || !(dt > 0))
        return true;
    if (is_unchanged_by_solver(w, dt, step->is_fixed)) {
        store_state(w, t, y);
        w->solver_unchanged = true;
        w->pivot = 0;
        return true;
    }
    struct rank_test_result l = test_accepted_state(w, &at);
    if (step->is_fixed && !l.is_crossed && falls_to_zero(w, dt))
        l.is_crossed = ct_rank_monitor_is_crossed(w, &at, w->pivot, l.now);
    if (!step->is_across) {
        if (!step->is_fixed && (restore_rows(w, at.pending) || must_be_repeated(&l)))
            return false;
        record_closest(w, t, &l);
    }
    store_test(w, &at, &l, dt);
    if (!(l.part > predicted_pivot || step->is_fixed))
        predict_next(w, &at, l.now);
    return true;
}

void ct_rank_monitor_reset(struct ct_rank_monitor *w, double t, const double *y,
                           const double *dy)
{
    const struct ct_rank_test ahead = {t, *w->pending, y, dy};
    w->there->rank = 0;
    w->pivot = 0;
    if (!(w->largest_pivot > 0) || w->relative_pivot > predicted_pivot || !(w->dt > 0))
        return;
    predict_next(w, &ahead, ct_rank_monitor_pivot(w, ct_time_just_before(t, ahead.pending), y));
}

void ct_rank_monitor_announce(struct ct_rank_monitor *w, double t, const double *y, double in)
{
    w->largest_pivot = ct_rank_monitor_pivot(w, t, y); // pivots farther away are unknown
    w->there->rank = 0;
    w->t = t;
    w->relative_pivot = w->s->nearness = 1;
    w->switches = w->s->switches;
    w->time_to_singular = in;
    w->reach = INFINITY;
}

// The stages of a crossing are at a distance from the singular configuration and are projected
// onto the constraints: the order of pivots at its beginning is valid for all of them.
void ct_rank_monitor_set_crossing(struct ct_rank_monitor *w, bool is_crossing)
{
    w->s->is_crossing = is_crossing;
    w->s->is_near_singular = !is_crossing && w->relative_pivot < near_pivot;
}
