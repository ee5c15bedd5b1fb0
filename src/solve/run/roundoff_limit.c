// Round-off limit: at the end of a run, find outputs that cannot reach the wanted accuracy, however
// small the steps are.
//
// Some outputs are functions that amplify the round-off of states (output_sensitivity.h). Others
// are inaccurate as the states are: with stiff forces the round-off of coordinates, eps q, gives
// accelerations eps |f'(q) q|. Vibration and damping limit the resulting error of a speed to
//
//     eps |f'(q) q| / max(omega, |f'(u)|),   omega^2 = |f'(q) q|/|q|     (8.15)
//
// The speed of a body that creeps on a stiff damped spring has as few digits as the force of the
// spring. Round-off errors of the n steps of an explicit method add up if nothing damps them, to
//
//     (omega/max omega) root(min(n, n/(f'(u) (t1 - t0))))  times a round-off     (8.18)
//
// Inertias may cancel, as those of a light beam section in free flight. The remaining inertia has a
// relative error of eps times the ratio of the terms to it, which is nearly constant during the
// run. The motion that it governs gets out of phase: the error of its speed is half of that
// relative error times acceleration times time.
#include "numeric/roundoff.h"
#include "solve/run/run_internal.h"

#include <float.h>
#include <string.h>

struct roundoff {
    double *speed;           // (nu) in units of CT_PERTURBATION_UNITS, after damping
    double *frequency_share; // (nu) omega/(the largest omega)
    // (nu) factor of the accumulation: n errors of random sign add up to sqrt(n); n is the number
    // of steps whose errors are not damped yet
    double *sum;
    double position; // largest one of positions, in the same units
};

// Round-off of speeds at r->y. omega^2 is the change of an acceleration over that of positions. The
// round-off of a speed is omega times that of positions, and less if its damping exceeds omega.
static bool find_roundoff(struct ct_run *r, double t, struct roundoff *e)
{
    const size_t nq = r->m->nq, nu = r->m->nu;
    const double *f = r->dy + nq;
    double *f0 = r->scratch, most = 0;
    if (ct_run_rhs(r, t, r->y, r->dy) != CT_EVAL_OK)
        return false;
    memcpy(f0, f, nu * sizeof *f);
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    e->position = 0;
    for (size_t i = 0; i < nq; i++) {
        const double change = CT_PERTURBATION / 2 * ct_perturbation_part(i) * fabs(r->y[i]);
        e->position = fmax(e->position, change);
        r->stage[i] += change;
    }
    if (!(e->position > 0) || ct_run_rhs(r, t, r->stage, r->dy) != CT_EVAL_OK)
        return false;
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    for (size_t k = 0; k < nu; k++) {
        e->speed[k] = sqrt(fabs(f[k] - f0[k]) * e->position);
        e->frequency_share[k] = e->speed[k] / e->position;
        most = fmax(most, e->frequency_share[k]);
        r->stage[nq + k] += e->speed[k];
    }
    if (ct_run_rhs(r, t, r->stage, r->dy) != CT_EVAL_OK)
        return false;
    for (size_t k = 0; k < nu; k++) {
        const double omega = e->frequency_share[k], damping = fabs(f[k] - f0[k]) / e->speed[k];
        e->frequency_share[k] = most > 0 ? omega / most : 0;
        e->speed[k] *= damping > omega ? omega / damping : 1;
    }
    return true;
}

// Damping removes the round-off errors of steps before the last time 1/damping. Each speed is
// changed alone, since a rotating motion couples it with others without damping it. f (nu) at r->y
// is in r->scratch.
static bool find_accumulation(struct ct_run *r, double t, struct roundoff *e)
{
    const size_t nq = r->m->nq, nu = r->m->nu;
    const double steps = (double)r->report->explicit_steps;
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    for (size_t k = 0; k < nu; k++) {
        double undamped_steps = steps;
        if (e->speed[k] > 0) {
            r->stage[nq + k] += e->speed[k];
            if (ct_run_rhs(r, t, r->stage, r->dy) != CT_EVAL_OK)
                return false;
            r->stage[nq + k] = r->y[nq + k];
            const double damping = (r->scratch[k] - r->dy[nq + k]) / e->speed[k];
            undamped_steps /= fmax(1, damping * t);
        }
        e->sum[k] = sqrt(fmax(undamped_steps, 1));
    }
    return true;
}

// Changes of outputs, relative to their largest values, by one unit of CT_PERTURBATION_UNITS: for a
// change of positions d (nu) and of speeds u (nu).
static bool evaluate_change(struct ct_run *r, double t, const double *d, const double *u,
                            const double *at, double *part)
{
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    if (d)
        ct_evaluator_retract(r->m, r->stage, d);
    for (size_t k = 0; u && k < r->m->nu; k++)
        r->stage[r->m->nq + k] += u[k];
    if (ct_run_results(r, t, r->stage, r->value) != CT_EVAL_OK)
        return false;
    for (size_t i = 0; i < r->e->nresult; i++)
        part[i] = fabs(r->value[i] - at[i]) / CT_PERTURBATION_UNITS / r->largest[i];
    return true;
}

// Changes of results by the accumulated round-off errors (8.18), relative to their largest values
// (nresult, out).
static bool find_output_changes(struct ct_run *r, double t, const struct roundoff *e,
                                const double *at, double *output_change)
{
    const size_t nu = r->m->nu, n = r->e->nresult;
    double *d = CT_NEWN(r->arena, double, nu + 1), *u = CT_NEWN(r->arena, double, nu + 1),
           *speeds = CT_NEWN(r->arena, double, n + 1);
    for (size_t k = 0; k < nu; k++) {
        d[k] = e->position * e->frequency_share[k] * e->sum[k];
        u[k] = e->speed[k] * e->frequency_share[k] * e->sum[k];
    }
    if (!evaluate_change(r, t, d, NULL, at, output_change)
        || !evaluate_change(r, t, NULL, u, at, speeds))
        return false;
    for (size_t i = 0; i < n; i++)
        output_change[i] = hypot(output_change[i], speeds[i]);
    return true;
}

// An output below this at all samples counts as zero, for example one that a loop keeps at zero.
static double small_output(const struct ct_run *r)
{
    return r->o->rtol > 0 ? r->o->output_rtol * (r->o->atol / r->o->rtol) : 0;
}

// The result with the largest change, if it is above *most (in, out); -1: none. A result that
// consists of round-off only does not count.
static int find_largest_change(const struct ct_run *r, const double *output_change,
                               double *most)
{
    int worst = -1;
    for (size_t i = 0; i < r->e->nresult; i++)
        if (output_change[i] > *most && output_change[i] < 1 && r->largest[i] > small_output(r)
            && !ct_controlled_outputs_is_check(r->e, r->e->result[i].value)) {
            *most = output_change[i];
            worst = (int)i;
        }
    return worst;
}

// If no single round-off error is too large, the sum over all steps may be. The sum without damping
// is tested first, since it costs little.
static void find_accumulated_roundoff(struct ct_run *r, double t, struct roundoff *e,
                                      const double *at, double wanted,
                                      struct ct_roundoff_limit *b)
{
    const double steps = (double)r->report->explicit_steps;
    double *output_change = CT_NEWN(r->arena, double, r->e->nresult + 1), most = wanted;
    for (size_t k = 0; k < r->m->nu; k++)
        e->sum[k] = sqrt(steps);
    if (!find_output_changes(r, t, e, at, output_change)
        || (b->output < 0 && find_largest_change(r, output_change, &most) < 0)
        || !find_accumulation(r, r->report->stats.last_time, e)
        || !find_output_changes(r, t, e, at, output_change))
        return;
    most = wanted;
    if (b->output < 0) {
        b->output = find_largest_change(r, output_change, &most);
        b->one = most / sqrt(steps);
    }
    if (b->output >= 0 && output_change[b->output] > b->one)
        b->sum = output_change[b->output];
}

// out (nu, nq, nu; out): u', q' and the pivots (inertias) of the solution in closed form, with
// positions changed by `side` times CT_PERTURBATION_UNITS round-off errors.
static void solve_perturbed(struct ct_run *r, double t, int side, size_t sample, double *out)
{
    const struct ct_evaluator *m = r->m;
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    for (size_t i = 0; i < m->nq; i++)
        r->stage[i]
            += side * CT_PERTURBATION / 2 * ct_perturbation_part(i + sample) * fabs(r->y[i]);
    ct_evaluator_set(r->m, t, r->stage);
    ct_program_run(&r->m->solved, m->input);
    memcpy(out, m->solved.out, (2 * m->nu + m->nq) * sizeof *out);
}

struct cancellation {
    double *part; // (nu) round-off of each of these inertias, as a part of it
    // (nu) errors of all u' in the sample in which that of `worst` was largest
    double *noise;
    size_t worst; // the speed whose acceleration errs most
};

// Round-off of the inertias from their second difference over changed coordinates, in which linear
// changes cancel: a sum with weights 1, 1 and -2 has root 6 times one error.
static void find_cancellation(struct ct_run *r, double t, struct cancellation *g)
{
    enum { SAMPLES = 8 }; // Derived: the root of a mean of eight squares errs by a quarter
    const size_t nu = r->m->nu, n = 2 * nu + r->m->nq, pivots = nu + r->m->nq;
    double *here = CT_NEWN(r->arena, double, n), *ahead = CT_NEWN(r->arena, double, n *SAMPLES),
           *behind = CT_NEWN(r->arena, double, n);
    solve_perturbed(r, t, 0, 0, here);
    for (size_t sample = 0; sample < SAMPLES; sample++) {
        double *sum = ahead + sample * n;
        solve_perturbed(r, t, 1, sample, sum);
        solve_perturbed(r, t, -1, sample, behind);
        for (size_t i = 0; i < n; i++)
            sum[i] += behind[i] - 2 * here[i];
        for (size_t k = 0; k < nu; k++)
            g->part[k]
                = hypot(g->part[k], sum[pivots + k] / here[pivots + k] / sqrt(6 * SAMPLES));
    }
    for (size_t k = 0; k < nu; k++)
        if (g->part[k] * fabs(here[k]) > g->part[g->worst] * fabs(here[g->worst]))
            g->worst = k;
    g->noise = ahead;
    for (size_t sample = 1; sample < SAMPLES; sample++)
        if (fabs(ahead[sample * n + g->worst]) > fabs(g->noise[g->worst]))
            g->noise = ahead + sample * n;
}

// The time for which an error of speed k lasts until damping removes it, at most t. f (nu) at r->y
// is in r->scratch.
static double decay_time(struct ct_run *r, double t, size_t k)
{
    const size_t nq = r->m->nq;
    const double change = CT_PERTURBATION * fabs(r->y[nq + k]);
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    r->stage[nq + k] += change;
    if (!(change > 0) || ct_run_rhs(r, t, r->stage, r->dy) != CT_EVAL_OK)
        return t;
    return t / fmax(1, (r->scratch[k] - r->dy[nq + k]) / change * t);
}

// Does the phase error of a cancelling inertia make the error of an output larger than is wanted?
static void find_phase_error(struct ct_run *r, double t, const double *at, double wanted,
                             struct ct_roundoff_limit *b)
{
    const size_t nu = r->m->nu;
    struct cancellation g = {.part = CT_NEWN(r->arena, double, nu + 1)};
    double *u = CT_NEWN(r->arena, double, nu + 1),
           *output_change = CT_NEWN(r->arena, double, r->e->nresult + 1), most = wanted;
    if (!r->e->solution || ct_run_rhs(r, t, r->y, r->dy) != CT_EVAL_OK)
        return;
    memcpy(r->scratch, r->dy + r->m->nq, nu * sizeof *r->scratch);
    find_cancellation(r, t, &g);
    const size_t k = g.worst;
    if (!(g.part[k] > 0 && g.part[k] < 1) || g.noise[k] == 0)
        return;
    const double error = g.part[k] * fabs(r->scratch[k]) * decay_time(r, t, k) / 2;
    for (size_t i = 0; i < nu; i++)
        u[i] = CT_PERTURBATION_UNITS * error * g.noise[i] / g.noise[k];
    if (!evaluate_change(r, t, NULL, u, at, output_change))
        return;
    b->output = find_largest_change(r, output_change, &most);
    b->one = NAN;
    b->sum = b->output < 0 ? NAN : most;
}

struct ct_roundoff_limit ct_run_find_roundoff_limit(struct ct_run *r, double wanted)
{
    // What one round-off of states may change. Derived: those of a hundred steps, of random sign,
    // then add up to what is wanted. For explicit steps the sum is found as well.
    const double allowed = wanted / 10;
    const double time = r->report->stats.last_time, t = ct_run_time_before_event(r, time);
    const size_t nu = r->m->nu, n = r->e->nresult;
    struct roundoff e = {CT_NEWN(r->arena, double, nu + 1), CT_NEWN(r->arena, double, nu + 1),
                         CT_NEWN(r->arena, double, nu + 1), 0};
    double *at = CT_NEWN(r->arena, double, n + 1),
           *output_change = CT_NEWN(r->arena, double, n + 1);
    struct ct_roundoff_limit b
        = {.output = -1, .one = allowed / CT_FEWEST_ROUNDOFF_ERRORS, .sum = NAN};
    if (r->output_error)
        b.output = ct_output_error_roundoff_limit(r->output_error, t, r->y, allowed,
                                                  small_output(r), &b.one);
    if (!find_roundoff(r, time, &e) || ct_run_results(r, t, r->y, at) != CT_EVAL_OK
        || !evaluate_change(r, t, NULL, e.speed, at, output_change))
        return b;
    const int slow = find_largest_change(r, output_change, &b.one);
    b.output = slow >= 0 ? slow : b.output;
    if (r->report->explicit_steps > 0)
        find_accumulated_roundoff(r, t, &e, at, wanted, &b);
    if (b.output < 0)
        find_phase_error(r, t, at, wanted, &b);
    return b;
}
