// See stiffness.h. The power method for the fastest mode: Golub and Van Loan (2013), key golub2013,
// 7.3; the product of step and rate as a test of stiffness: Hairer and Wanner (1996), key
// hairer1996, IV.2.
#include "integrate/stiffness.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Steps between tests. Default: four evaluations a test against stiffness found late. Test:
// integrate.
static const long test_every = 100;
// Positive tests in a row before a trial. Default: trials in vain against stiffness found late.
// Test: integrate.
static const int tests_in_a_row = 3;
// Rates that differ by a smaller factor count as the same.
// Default: modes that change with the motion against other modes. Test: integrate.
static const double same_rate = 2;
// From this h fast on the fastest mode may limit the step.
// Default: trials in vain against stiffness not seen. Test: stiffness_detection_bushing.
static const double least_limited_step = 0.5;
// From this h fast on no method resolves the fastest mode. The changes from step to step are then
// errors at the limit of stability, and `slow` is not known.
// Derived: a vibration needs two points in a period, a step of pi/omega.
static const double unresolved_step = 3;
// The least fast/slow of a stiff problem: an implicit step takes the work of some ten explicit
// ones, so with modes that are closer it gains nothing. Default: trials in vain against stiffness
// not seen. Test: integrate.
static const double least_separation = 10;
// The part of J^2 x outside the plane of x and J x up to which x counts as a single mode. Otherwise
// the decay rate is not known. Default: the error of the decay rate against modes without one.
// Test: integrate.
static const double single_mode = 0.1;
// A motion with h slow below this does not limit the step. Then round-off of positions, which the
// forces amplify, may limit it far from the limit of stability.
// Derived: (1e-3)^5, the error of a method of order 5, is a few round-off errors. Test: bushing.
static const double undemanding_step = 1e-3;
// Fewer steps to come are worth neither a trial nor the preparation of an implicit method: a trial
// takes about two hundred of them. The same least number of steps, of some 1/fast each, separates
// the motion from vibrations whose speeds no output depends on (8.10).
// Default: the work of a trial against that of the rest of the run. Test: integrate.
static const double least_steps = 1000;
// The work of the explicit steps until the next trial, over that of the trial; at least the number
// of steps doubles. Default: trials in vain against stiffness found late. Test: integrate.
static const double postponed_work = 10;

// Steps of a trial: the first ones, in which the step may grow by orders of magnitude, are not
// counted; over the others the work of derivatives is averaged.
// Default: the work of a trial against the error of its result. Test: integrate.
static const int uncounted_steps = 6, counted_steps = 12;
// Steps that do not count where vibrations must be damped first. Derived: Radau IIA has |R(3 i)| =
// 0.947, so that 40 steps of h omega = 3 leave 0.012 of the energy of a vibration.
static const int damping_steps = 40;

// ---- the test -----------------------------------------------------------------------------------

struct ct_stiffness *ct_stiffness_create(struct ct_arena *a, const struct ct_problem *p,
                                         const struct ct_integrate_stats *stats, double rtol,
                                         int first, int last)
{
    struct ct_stiffness *s = CT_NEW(a, struct ct_stiffness);
    *s = (struct ct_stiffness){
        .p = p, .stats = stats, .rtol = rtol, .first = first, .last = last};
    double **const vectors[]
        = {&s->v, &s->w, &s->f, &s->f0, &s->point, &s->y0, &s->quarter, &s->Jx};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, p->ny);
    for (int i = first; i < last; i++) // all speeds, with unequal parts
        s->v[i] = 1 + 0.5 * sin(i + 1.);
    return s;
}

static double length(const double *x, int first, int last)
{
    double sum = 0;
    for (int i = first; i < last; i++)
        sum += x[i] * x[i];
    return sqrt(sum);
}

// w (ny, out) = J v at y, where f is s->f; v has the length one.
static bool apply_jacobian(struct ct_stiffness *s, double t, const double *y, const double *v,
                           double *w)
{
    const int n = s->p->ny;
    const double e = sqrt(DBL_EPSILON) * fmax(1, length(y, 0, s->last));
    for (int i = 0; i < n; i++)
        s->point[i] = y[i] + e * v[i];
    if (s->p->rhs(s->p->user, t, s->point, w) != CT_EVAL_OK)
        return false;
    for (int i = 0; i < n; i++)
        w[i] = i < s->last ? (w[i] - s->f[i]) / e : 0; // f does not depend on quadratures
    return true;
}

// v <- x / |x|. Returns |x|.
static double normalize(struct ct_stiffness *s, const double *x)
{
    const double size = length(x, 0, s->last);
    if (size > 0 && isfinite(size))
        for (int i = 0; i < s->p->ny; i++)
            s->v[i] = x[i] / size;
    return size;
}

// Scalar product of a and b with positions scaled by `fast`.
static double dot(const struct ct_stiffness *s, const double *a, const double *b)
{
    double places = 0, speeds = 0;
    for (int i = 0; i < s->last; i++)
        *(i < s->first ? &places : &speeds) += a[i] * b[i];
    return s->fast * s->fast * places + speeds;
}

// The decay rate of the fastest mode, by least squares: J^2 x = -2 decay J x - rate^2 x for a
// vibration, J x = -decay x for a mode that does not oscillate. J x = gain s->Jx, and s->v is the
// vector after both applications of J. Negative where the mode grows, zero where x is not a single
// mode. (8.32)
static double find_decay(const struct ct_stiffness *s, const double *x, double gain)
{
    const double *Jx = s->Jx, *JJx = s->v, size = s->fast * s->fast;
    const double xx = dot(s, x, x), xy = dot(s, x, Jx), yy = dot(s, Jx, Jx);
    const double xz = dot(s, x, JJx), yz = dot(s, Jx, JJx), zz = dot(s, JJx, JJx);
    const double det = xx * yy - xy * xy;
    if (!(det > sqrt(DBL_EPSILON) * xx * yy))
        return -gain * xy / xx;
    const double b = (xx * yz - xy * xz) / det, a = (yy * xz - xy * yz) / det;
    if (!(zz - a * xz - b * yz < single_mode * single_mode * zz))
        return 0;
    const double half = -b * size / (2 * gain);
    return half + sqrt(fmax(0, half * half + a * size));
}

// Estimates `fast` and `decay`. J maps the positions of a vibration to speeds, and speeds to
// positions, so its rate is the square root of the product of the gains of two applications. The
// first estimate is repeated while it grows.
static bool find_fast(struct ct_stiffness *s, double t, const double *y)
{
    if (s->p->rhs(s->p->user, t, y, s->f) != CT_EVAL_OK)
        return false;
    normalize(s, memcpy(s->w, s->v, (size_t)s->p->ny * sizeof *s->w));
    const bool is_first = s->fast == 0;
    double before;
    do {
        double gain[2];
        before = s->fast;
        memcpy(s->quarter, s->v, (size_t)s->p->ny * sizeof *s->v);
        for (int i = 0; i < 2; i++) {
            if (!apply_jacobian(s, t, y, s->v, s->w))
                return false;
            gain[i] = normalize(s, s->w);
            if (i == 0)
                memcpy(s->Jx, s->v, (size_t)s->p->ny * sizeof *s->v);
        }
        s->fast = sqrt(gain[0] * gain[1]);
        s->decay = find_decay(s, s->quarter, gain[0]);
    } while (is_first && s->fast > same_rate * before);
    return isfinite(s->fast);
}

int ct_stiffness_fastest(struct ct_stiffness *s, double t, const double *y)
{
    int most = s->first;
    s->fast = 0;
    if (s->first == s->last || !find_fast(s, t, y))
        return -1;
    for (int i = s->first; i < s->last; i++)
        if (fabs(s->v[i]) > fabs(s->v[most]))
            most = i;
    return most;
}

static double find_slow(const struct ct_stiffness *s, double h)
{
    double change = 0;
    for (int i = s->first; i < s->last; i++)
        change += (s->f[i] - s->f0[i]) * (s->f[i] - s->f0[i]);
    const double size = length(s->f, s->first, s->last);
    return size > 0 ? sqrt(change) / (h * size) : 0;
}

// Does round-off eps |q| of positions, amplified to accelerations by fast^2, exceed the tolerance?
static bool is_roundoff_visible(const struct ct_stiffness *s, const double *y)
{
    double place = 0;
    for (int i = 0; i < s->first; i++)
        place = fmax(place, fabs(y[i]));
    return DBL_EPSILON * s->fast * s->fast * place > s->rtol * length(s->f, s->first, s->last);
}

// The rate of change of positions: the largest speed over the largest position, or over 1 if that
// is less.
static double find_motion_rate(const struct ct_stiffness *s, const double *y)
{
    double place = 0, speed = 0;
    for (int i = 0; i < s->first; i++)
        place = fmax(place, fabs(y[i]));
    for (int i = s->first; i < s->last; i++)
        speed = fmax(speed, fabs(y[i]));
    return speed / fmin(place, 1);
}

// The same for a motion that starts at rest, from accelerations s->f.
static double find_rate_from_rest(const struct ct_stiffness *s, const double *y)
{
    double place = 0, change = 0;
    for (int i = 0; i < s->first; i++)
        place = fmax(place, fabs(y[i]));
    for (int i = s->first; i < s->last; i++)
        change = fmax(change, fabs(s->f[i]));
    return sqrt(change / fmin(place, 1));
}

// Has the rate of the fastest mode been about the same for several tests? Near singular
// configurations it is large for a moment only.
static bool is_persistent(const struct ct_stiffness *s)
{
    return s->similar_rates >= tests_in_a_row;
}

static void compare_rates(struct ct_stiffness *s, double before)
{
    const bool is_same = s->fast < same_rate * before && before < same_rate * s->fast;
    s->similar_rates = is_same ? s->similar_rates + 1 : 1;
}

// Integrates the decay rate of the fastest mode since the last event; each test gives its value for
// the steps before it. Without damping amplitudes change, too, because mass and stiffness change
// along the motion, at the rate `motion_rate`, which is subtracted.  (8.33)
static void note_decay(struct ct_stiffness *s, bool is_known, double motion_rate, double start,
                       double t)
{
    if (s->excited > start)
        s->integrated_decay = 0;
    if (is_known)
        s->integrated_decay = fmax(
            0, s->integrated_decay + (s->decay - motion_rate) * (t - fmax(start, s->excited)));
    s->has_decayed = s->integrated_decay > -log(s->rtol);
}

static bool test(struct ct_stiffness *s, double t, const double *y)
{
    const double fast_before = s->fast;
    const double steps = (double)(s->count - s->window_steps), start = s->window_t;
    s->step = (t - s->window_t) / steps;
    s->evaluations = (double)(s->stats->evaluations - s->window_evaluations) / steps;
    s->window_t = t;
    s->window_steps = s->count;
    s->window_evaluations = s->stats->evaluations;
    if (s->p->rhs(s->p->user, s->t0, s->y0, s->f0) != CT_EVAL_OK || !find_fast(s, t, y))
        return false;
    s->slow = find_slow(s, t - s->t0);
    const double reach = s->step * s->fast, motion_rate = find_motion_rate(s, y);
    s->is_far = s->p->requested_speeds && s->fast > least_steps * motion_rate;
    compare_rates(s, fast_before);
    s->is_resolved = reach < unresolved_step && is_persistent(s);
    s->is_unstable = fmax(reach, (t - s->t0) * s->fast) >= unresolved_step && is_persistent(s);
    const bool is_apart = s->is_far || s->fast > least_separation * s->slow;
    note_decay(s, is_apart && is_persistent(s), motion_rate, start, t);
    const bool is_undemanding = s->is_far || s->step * s->slow < undemanding_step;
    const bool is_step_limited
        = reach > least_limited_step || (is_undemanding && is_roundoff_visible(s, y));
    return reach > unresolved_step || (is_step_limited && is_apart);
}

bool ct_stiffness_detect(struct ct_stiffness *s, double t, const double *y, double end)
{
    s->count++;
    if ((s->count + 1) % test_every == 0) {
        memcpy(s->y0, y, (size_t)s->p->ny * sizeof *y);
        s->t0 = t;
    }
    if (s->count % test_every != 0)
        return false;
    s->in_a_row = test(s, t, y) ? s->in_a_row + 1 : 0;
    const bool is_due = s->in_a_row >= tests_in_a_row && s->count >= s->next_trial;
    const bool is_overtaken = s->step < s->other_time_per_work * s->evaluations;
    return (is_due || is_overtaken) && end - t > least_steps * s->step;
}

bool ct_stiffness_is_unstable(const struct ct_stiffness *s)
{
    return s->is_unstable;
}

double ct_stiffness_stable_step(const struct ct_stiffness *s, const struct ct_method *m)
{
    return m->stability_limit > 0 && is_persistent(s) ? m->stability_limit / s->fast : INFINITY;
}

bool ct_stiffness_has_tested(const struct ct_stiffness *s)
{
    return s->count % test_every == 0;
}

// x (ny) <- J x/fast at y, where f is s->f.
static bool apply_scaled_jacobian(struct ct_stiffness *s, double t, const double *y, double *x)
{
    const double size = length(x, 0, s->last);
    if (!(size > 0))
        return false;
    for (int i = 0; i < s->p->ny; i++)
        x[i] = i < s->last ? x[i] / size : 0;
    if (!apply_jacobian(s, t, y, x, s->w))
        return false;
    for (int i = 0; i < s->p->ny; i++)
        x[i] = s->w[i] * (size / s->fast);
    return true;
}

// y'' (ny, out) = J f + df/dt. The second term is needed where coordinates follow a prescribed
// motion: its rate is a part of f, which J f alone would take for a vibration.
static bool find_second_derivative(struct ct_stiffness *s, double t, const double *y,
                                   double *out)
{
    // Backwards in time, where tabulated inputs are defined. Derived: the difference errs by dt
    // fast/2, that is 5e-4, and by a round-off of 1e3 eps.
    const double dt = 1e-3 / s->fast;
    if (s->p->rhs(s->p->user, t - dt, y, out) != CT_EVAL_OK)
        return false;
    double *along = s->quarter;
    memcpy(along, s->f, (size_t)s->p->ny * sizeof *along);
    if (!apply_scaled_jacobian(s, t, y, along))
        return false;
    for (int i = 0; i < s->p->ny; i++)
        out[i] = i < s->last ? along[i] * s->fast + (s->f[i] - out[i]) / dt : 0;
    return true;
}

bool ct_stiffness_find_vibration(struct ct_stiffness *s, double t, const double *y, int order,
                                 const double **e, const double **later)
{
    if (!s->is_resolved)
        return false;
    double *x = s->f0;
    if (!find_second_derivative(s, t, y, x))
        return false;
    for (int i = 0; i < s->p->ny; i++)
        x[i] /= s->fast * s->fast;
    for (int quarter = 1; quarter < order; quarter++)
        if (!apply_scaled_jacobian(s, t, y, x))
            return false;
    memcpy(s->quarter, x, (size_t)s->p->ny * sizeof *x);
    *e = s->quarter;
    *later = x;
    return apply_scaled_jacobian(s, t, y, x);
}

bool ct_stiffness_predict(struct ct_stiffness *s, double t, const double *y, double end,
                          const struct ct_method *method, double rtol)
{
    if (s->first == s->last || !find_fast(s, t, y))
        return false;
    const bool is_far
        = s->fast > least_steps * fmax(find_motion_rate(s, y), find_rate_from_rest(s, y));
    s->step = unresolved_step * pow(rtol, 1. / method->order) / s->fast;
    s->evaluations = method->tableau->stages - 1;
    return is_far && end - t > least_steps * s->step;
}

// The error constant of the stability function: b' A^p 1 - 1/(p + 1)!, b the last row of A.
static double error_constant(const struct ct_method *m)
{
    const struct ct_tableau *b = m->tableau;
    double x[CT_MOST_STAGES], next[CT_MOST_STAGES], wanted = 1;
    for (int i = 0; i < b->stages; i++)
        x[i] = 1;
    for (int power = 0; power <= m->order; power++) {
        for (int i = 0; i < b->stages; i++) {
            next[i] = 0;
            for (int j = 0; j < i; j++)
                next[i] += b->A[i * b->stride + j] * x[j];
        }
        memcpy(x, next, sizeof x);
        wanted /= power + 1;
    }
    return fabs(x[b->stages - 1] - wanted);
}

double ct_stiffness_accurate_step(const struct ct_method *method, double fast, double time,
                                  double rtol)
{
    const double each = rtol / (fast * time * error_constant(method));
    return pow(each, 1. / method->order) / fast;
}

void ct_stiffness_postpone(struct ct_stiffness *s, double t, double spent,
                           const struct ct_cost *cost)
{
    const double steps = spent / fmax(1, s->evaluations * cost->evaluation);
    // Limit: a count that a long of 32 bits holds.
    s->next_trial = s->count + (long)fmin(1e9, postponed_work * steps);
    if (s->next_trial < 2 * s->count)
        s->next_trial = 2 * s->count;
    s->window_t = t; // counts begin anew with the next steps
    s->window_evaluations = 0;
    s->in_a_row = 0;
    s->other_time_per_work = 0;
}

void ct_stiffness_compare_with(struct ct_stiffness *s, double time_per_work,
                               const struct ct_cost *cost)
{
    s->other_time_per_work = time_per_work * cost->evaluation;
}

double ct_stiffness_time_per_work(const struct ct_stiffness *s, const struct ct_cost *cost)
{
    return s->step / (s->evaluations * cost->evaluation);
}

double ct_cost_step(const struct ct_cost *cost)
{
    // Derived: two Newton corrections of three stages, the second of which shows that the first was
    // enough
    const double residuals = 6;
    return residuals * cost->residual + cost->tangent + 2 * cost->factorization;
}

// ---- the trial ----------------------------------------------------------------------------------

static double work(const struct ct_trial *r)
{
    return (double)r->stats->evaluations * r->cost.residual
         + (double)r->stats->jacobians * r->cost.tangent
         + (double)r->stats->factorizations * r->cost.factorization;
}

double ct_trial_work(const struct ct_trial *r)
{
    return work(r);
}

static int steps_before_counting(const struct ct_trial *r)
{
    return r->must_damp ? damping_steps : uncounted_steps;
}

bool ct_trial_step(struct ct_trial *r, double t)
{
    const int first = steps_before_counting(r);
    r->t = t;
    if (++r->nstep == first) {
        r->t0 = t;
        r->spent0 = work(r);
    }
    return r->nstep < first + counted_steps;
}

double ct_trial_time_per_work(const struct ct_trial *r)
{
    if (r->nstep <= steps_before_counting(r)
        && r->t >= r->end) // the rest of the run is less than the trial: all of it counts
        return (r->t - r->start) / work(r);
    return r->nstep > steps_before_counting(r) ? (r->t - r->t0) / (work(r) - r->spent0) : 0;
}

bool ct_trial_is_slower(struct ct_trial *r, double t, double event, double time_per_work)
{
    r->t = t;
    if (event > r->t0) { // counting begins behind the first step from there
        r->t0 = r->window.t = t;
        r->spent0 = r->window.spent = work(r);
        r->nstep = 0;
        return false;
    }
    if (++r->nstep % test_every != 0)
        return false;
    const double spent = work(r);
    const double recent = (t - r->window.t) / (spent - r->window.spent);
    r->time_per_work = (t - r->t0) / (spent - r->spent0);
    r->window.t = t;
    r->window.spent = spent;
    return r->time_per_work < time_per_work && recent <= r->time_per_work
        && r->nstep > test_every;
}
