// First step of a run that starts in a singular configuration with speeds, or near one: backward
// collocation.
//
// At a singular configuration rows of J are dependent and accelerations cannot be computed.
// Speeds of one of the motions through it satisfy
//
//     J u = -Phi_t,   w' (J' u + ...) = 0  for w' J = 0                              (8.23)
//
// and select that motion. Near a singular configuration accelerations exist, but are too
// inaccurate for steps. Collocation centred on the singular configuration finds the state half
// a step before it. The run begins there and crosses the configuration like any other run.
// Collocation: crossing.h.
#include "solve/singular/rank_monitor_internal.h"

#include "integrate/crossing.h"
#include "numeric/dense.h"
#include "numeric/roundoff.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Limit: halvings of the step, which at first moves the fastest coordinate by a radian or metre to
// either side; a motion that stays near the singular configuration for long
// later leaves faster than its initial accelerations predict
enum { MOST_HALVINGS = 12 };

// Initial states up to this distance [rad, m] from a singular configuration begin with a step
// across it.
// Default: refusal for lack of accuracy against errors of steps.
// Test: near_singular_slow
static const double crossing_distance = 0.2;

// Accepted error of the step, relative to the largest state: the first, or the second times the
// tolerance if that is larger.  (8.35)
// Derived: 4500 units of round-off; a fiftieth of the tolerance has no visible effect.
static const double smallest_error = 1e-12, error_part = 0.02;

// Start of a run: norms of speeds and accelerations, where known.
struct initial_step {
    void *work;
    double u, a, ua;         // |u|, |u'|, u . u'
    double time_to_singular; // time to the singular configuration, negative after it
    double largest_error;    // of the step, relative to the largest state
    double *before;          // (ny, out)
    double *end, *dend;      // (ny)
};

// A step of length h across the singular configuration, centred `middle` seconds after the
// start, and its error relative to the largest state.
struct crossing_step {
    double middle, h, error;
};

static double begin_of(const struct crossing_step *c)
{
    return c->middle - c->h / 2;
}

// Time to move by `distance` from the speed u.
static double time_for(const struct initial_step *l, double u, double distance)
{
    return 2 * distance / (u + sqrt(u * u + 2 * l->a * distance));
}

static double speed_at(const struct initial_step *l, double t)
{
    return sqrt(fmax(0, l->u * l->u + t * (2 * l->ua + t * l->a * l->a)));
}

// Choose rows and columns of the coordinate partitioning at the state extrapolated by the time
// h with the speeds of y.
static bool choose_partition(struct ct_singular_start *r, double h, const double *y)
{
    const size_t n = r->ctx->ndiagnostic, nerror = r->ctx->nerror;
    memcpy(r->stage, y, (size_t)r->p->ny * sizeof *y);
    for (size_t k = 0; k < r->m->nu; k++)
        r->scratch[k] = h * y[r->m->nq + k];
    ct_evaluator_retract(r->m, r->stage, r->scratch);
    ct_evaluator_set(r->m, h, r->stage);
    ct_evaluator_constraint(r->m);
    r->s->sigma_best = 0;
    r->s->prefers_independent
        // dependent speeds lose accuracy towards the singular configuration
        = r->is_given;
    const bool is_chosen = ct_partition_choose(r->s);
    r->s->prefers_independent = NULL;
    if (is_chosen)
        return true;
    r->ctx->ndiagnostic = n; // another configuration may succeed
    r->ctx->nerror = nerror;
    return false;
}

// Largest distance of y from the initial state, relative to the largest state, on the intended
// motion: speeds near a singular configuration are not more accurate; other motions differ by
// the speeds themselves. Default: between both. Test: near_singular
static const double same_motion_tolerance = 1e-4;

// Largest difference between y (ny) and the start, without the work, relative to the largest state.
static double relative_distance(const double *assembled, const double *y, size_t ny)
{
    double largest = 0;
    for (size_t i = 0; i + 1 < ny; i++)
        largest = fmax(largest, fabs(y[i] - assembled[i]));
    return largest / ct_vector_largest(assembled, ny);
}

bool ct_singular_meets_start(const double *assembled, const double *y, size_t ny)
{
    return relative_distance(assembled, y, ny) <= same_motion_tolerance;
}

// Does the step from l->before succeed and pass through the initial state? r->stage (out): its
// state there.
static bool leads_across(struct ct_singular_start *r, const struct initial_step *l,
                         const struct crossing_step *c)
{
    const double t = begin_of(c), largest = ct_vector_largest(l->before, (size_t)r->p->ny),
                 roundoff = fmax(ct_crossing_roundoff, error_part * r->output_rtol);
    const struct ct_tolerance tolerance = {r->rtol, fmax(r->atol, roundoff * largest)};
    double error;
    if (r->p->rhs(r->p->user, t, l->before, r->dy) != CT_EVAL_OK
        || ct_crossing.step(r->p, t, c->h, l->before, r->dy, &tolerance, l->end, l->dend,
                            &error, l->work, r->stats)
               != CT_EVAL_OK
        || !(error <= 1))
        return false;
    ct_crossing.dense(r->p, c->h, -t / c->h, l->before, l->end, l->work, r->stage);
    return ct_singular_meets_start(r->assembled, r->stage, (size_t)r->p->ny);
}

// Solve the collocation equations into l->before. Returns the error, or INFINITY.
static double collocate_backwards(struct ct_singular_start *r, const struct initial_step *l,
                                  const struct crossing_step *c)
{
    const double *y = r->assembled, t = begin_of(c),
                 largest = ct_vector_largest(y, (size_t)r->p->ny);
    const struct ct_tolerance tolerance = {l->largest_error, l->largest_error * largest};
    double error;
    return ct_crossing_initial_step(r->p, 0, c->h, -t / c->h, y, r->dy, &tolerance, l->before,
                                    &error, l->work, r->stats)
                == CT_EVAL_OK
             ? error * l->largest_error
             : INFINITY;
}

// Project the state at the beginning of the step as accurately as its stages.
static bool project_state(struct ct_singular_start *r, const struct initial_step *l, double t)
{
    r->p->singular->set_crossing(r->p->singular->user, true);
    const enum ct_eval e = r->p->project(r->p->user, t, l->before);
    r->p->singular->set_crossing(r->p->singular->user, false);
    return e == CT_EVAL_OK;
}

// Find the state at the beginning of a crossing step, l->before, and its error; INFINITY if the
// step does not cross the singular configuration.
static void find_state_before(struct ct_singular_start *r, const struct initial_step *l,
                              struct crossing_step *c)
{
    const double t = begin_of(c);
    c->error = INFINITY;
    if (!choose_partition(r, t + c->h, r->assembled))
        return;
    ct_evaluator_set(r->m, 0, r->assembled);
    ct_evaluator_dynamics(r->m);
    memset(r->dy, 0, (size_t)r->p->ny * sizeof *r->dy);
    ct_evaluator_copy(r->dy, r->m->rate, r->m->nq);
    const double error = collocate_backwards(r, l, c);
    if (error <= l->largest_error && project_state(r, l, t) && leads_across(r, l, c))
        c->error = error;
}

// Do root functions keep their signs? A switch within the step would change the motion.
static bool keeps_root_signs(struct ct_singular_start *r, const struct initial_step *l,
                             double t)
{
    double *now = CT_NEWN(r->arena, double, 2 * (size_t)r->p->nroot + 1),
           *then = now + r->p->nroot;
    r->p->root(r->p->user, 0, r->assembled, now);
    r->p->root(r->p->user, t, l->before, then);
    for (int i = 0; i < r->p->nroot; i++)
        if (!(now[i] * then[i] > 0))
            return false;
    return true;
}

// Find the longest step centred at `middle` that is accurate enough and reaches the initial
// state, by halving. It replaces best (in and out) if it is longer, since its ends are farther
// from the singular configuration.
static void find_step(struct ct_singular_start *r, const struct initial_step *l, double middle,
                      struct crossing_step *best)
{
    struct crossing_step c = {middle, 2 * time_for(l, speed_at(l, middle), 1), INFINITY};
    for (int i = 0; i < MOST_HALVINGS && c.h > best->h && c.h / 2 > fabs(middle);
         i++, c.h /= 2) {
        find_state_before(r, l, &c);
        if (c.error < INFINITY && keeps_root_signs(r, l, begin_of(&c))) {
            *best = c;
            return;
        }
    }
}

// misfit: of (8.23), relative to the squares of the speeds.
static bool refuse_speeds(struct ct_singular_start *r, double misfit, int freedoms)
{
    ct_error(r->ctx, (struct ct_mark){0}, CT_E_STEP_OPEN,
             "the constraints cannot be met beyond t = 0: the run starts in a singular "
             "configuration, where constraints of %s are dependent and several motions are "
             "possible, and %s",
             r->joints,
             misfit > CT_HALF_DIGITS ? "the speeds belong to none of them"
                                     : "none that has these speeds is found to this tolerance");
    if (misfit > CT_HALF_DIGITS)
        ct_note(r->ctx, (struct ct_mark){0},
                "give the rates of %d joints there, as they belong to one motion through the "
                "configuration: the present ones violate its condition by "
                "%.2g of their squares; or start near the configuration, with a joint off by "
                "1e-3, on the wanted motion",
                freedoms, misfit);
    else
        ct_note(r->ctx, (struct ct_mark){0},
                "a larger tolerance may help; or start near the configuration, with a joint "
                "off by 1e-3, on the wanted motion");
    return false;
}

// Restores the choice of rows and columns at the start.
static void return_to_start(struct ct_singular_start *r)
{
    ct_evaluator_set(r->m, 0, r->y);
    ct_evaluator_constraint(r->m);
    r->s->sigma_best = 0;
    ct_partition_choose(r->s);
}

// Values that are not demanded follow from demanded ones by division by pivots as small as the
// distance to the singular configuration.
static void warn_of_roundoff(struct ct_singular_start *r, double unknown)
{
    ct_warning(r->ctx, (struct ct_mark){.file = r->file}, 0,
               "the run starts so near to a singular configuration that, because of round-off, "
               "coordinates and speeds which are not given are known only to %.1g: start in "
               "the singular configuration itself, or farther from it",
               unknown);
}

// Begin half a step before the singular configuration, if a step crosses it.
static bool begin_before(struct ct_singular_start *r, struct initial_step *l)
{
    double **const vector[] = {&l->before, &l->end, &l->dend};
    struct crossing_step best = {.error = INFINITY};
    for (size_t i = 0; i < COUNT(vector); i++)
        *vector[i] = CT_NEWN(r->arena, double, (size_t)r->p->ny);
    l->work = ct_crossing.create(r->arena, &ct_crossing, r->p);
    find_step(r, l, l->time_to_singular, &best);
    if (best.error < INFINITY)
        find_state_before(r, l, &best);
    if (!(best.error < INFINITY)) {
        return_to_start(r);
        return false;
    }
    const double unknown = relative_distance(r->assembled, r->stage, (size_t)r->p->ny);
    if (unknown > r->output_rtol)
        warn_of_roundoff(r, unknown);
    r->t0 = begin_of(&best);
    memcpy(r->y, l->before, (size_t)r->p->ny * sizeof *r->y);
    ct_rank_monitor_announce(r->singular, r->t0, r->y, best.h / 2);
    return true;
}

// Set the accepted error of the step for the tolerance `asked`; `effect`: its effect on the
// motion.
static void set_largest_error(struct initial_step *l, double asked, double effect)
{
    l->largest_error = fmax(smallest_error, error_part * asked * effect);
}

static bool begin_in_singular(struct ct_singular_start *r, struct initial_step *l)
{
    int freedoms;
    if (r->is_fixed)
        return ct_error(
            r->ctx, (struct ct_mark){0}, CT_E_STEP_REFUSED,
            "the run starts in a singular configuration, where constraints of %s are "
            "dependent: steps of fixed size do not lead away from it; leave out 'step'",
            r->joints);
    const double misfit = ct_singular_start_misfit(r->arena, r->s, 0, r->assembled, &freedoms);
    set_largest_error(l, r->rtol, 1);
    return (misfit <= CT_HALF_DIGITS && begin_before(r, l))
        || refuse_speeds(r, misfit, freedoms);
}

// Distance to the singular configuration along the motion, negative if it is before the initial
// state.
static double find_singular_distance(struct ct_rank_monitor *w, const double *y,
                                     const double *dy, struct initial_step *l)
{
    // Derived: a difference quotient with ten digits
    const double small_part = 1e-3; // of the time in which the motion covers crossing_distance
    const size_t nq = w->m->nq, nu = w->m->nu;
    const double *a = dy + nq, *u = y + nq;
    l->u = ct_vector_max_norm(u, nu);
    l->a = ct_vector_max_norm(a, nu);
    l->ua = ct_vector_dot(u, a, nu);
    if (!(l->u + l->a > 0))
        return INFINITY;
    return ct_rank_monitor_distance(w, 0, y, dy,
                                    small_part * time_for(l, l->u, crossing_distance));
}

// Initial state near a singular configuration: begin before it. If that fails and the motion leads
// to it, the first step crosses it.
static void begin_near_singular(struct ct_singular_start *r, struct initial_step *l)
{
    const double distance = find_singular_distance(r->singular, r->y, r->dy, l),
                 size = fabs(distance);
    if (!(size > 0 && size < crossing_distance))
        return;
    const double along = fmax(size, l->u * time_for(l, l->u, 1));
    set_largest_error(l, r->output_rtol, fmin(1, along));
    l->time_to_singular = copysign(time_for(l, l->u, size), distance);
    if (!begin_before(r, l) && distance > 0)
        ct_rank_monitor_announce(r->singular, 0, r->y, l->time_to_singular);
}

bool ct_singular_starts_near(struct ct_rank_monitor *w, const double *y, const double *dy)
{
    struct initial_step l = {.time_to_singular = 0};
    return w->m->nrow && fabs(find_singular_distance(w, y, dy, &l)) < crossing_distance;
}

bool ct_singular_initial_step(struct ct_singular_start *r)
{
    struct initial_step l = {.u = ct_vector_max_norm(r->assembled + r->m->nq, r->m->nu)};
    if (r->m->nrow && r->joints && l.u > 0)
        return begin_in_singular(r, &l);
    if (r->m->nrow && !r->joints && !r->is_fixed)
        begin_near_singular(r, &l);
    return true;
}
