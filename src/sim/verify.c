// Estimates the global error of a run by a second run that is more accurate or at least
// different, and by a third run if the second was not different.
//
//     tighter tolerance     its error is small, so that the difference is the error of the first
//     half the fixed step   its error is 2^-order times that of the first (Richardson)
//     looser tolerance      if double precision does not allow a tighter one: its error is larger,
//                           and so is the difference
//
// A second run with nearly the same steps has nearly the same errors, round-off included, and
// the difference says nothing about them: see is_other, (8.31).
//
// What always holds: the estimate for an output is the largest difference over the samples,
// times a factor that accounts for the error of the second run. Both runs use the same
// equations, so the estimate does not include errors of the model.
#include "sim/sim.h"

#include "base/guard.h"
#include "component/roundoff.h"
#include "solve/singular/singular.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Tolerance of the second run relative to the first. Derived: the geometric mean of a tenth, with
// which the error often does not decrease enough, and a hundredth, which costs more and is not
// better.
static const double tolerance_reduction = 1. / 30;
// Tolerance of a looser run, and least ratio of a tighter one, as errors follow tolerances roughly.
// Default: errors that a difference shows against errors of another kind. Test: error_estimates
static const double least_tolerance_ratio = 5;
// A second run may have a tolerance this much below the smallest one of an ordinary run. In
// motions with many turns truncation errors decrease until there. An explicit step has
// round-off of h f only, since that of y is carried over, and a shorter step has proportionally
// less. Not past singular configurations.
// Derived: the steps are ten times as short.
static const double beyond = 0.1;
// Limit: one more try, and a message then.
// factor by which the tolerance is looser if the second run failed
static const double retry_tolerance_ratio = 3;
// Errors follow tolerances only roughly, and not at all if they are round-off: two runs with
// independent errors of equal size differ by sqrt(2) times the error.
// Derived: sqrt(2), and a little for rough estimates.
static const double tolerance_margin = 1.5;
// An output is accurate as long as its error is within this many tolerances.
// Definition: the promise of docs/accuracy.md.
static const double promised_tolerances = 10;

struct companion {
    const char *method;
    double rtol, step, margin;
    double least_rtol; // for motions with many turns
    long nstep;        // number of steps of the run
};

// Is the method of low order? Then its error is estimated by another method, not by a tighter
// tolerance.
static bool is_low(const struct ct_method *m)
{
    return m->is_implicit && m->order < 3;
}

// If the method was chosen during the first run, the second run chooses again. Only then do its
// steps follow the tolerance in everything that depends on it.
static const char *name_method(const struct ct_sim *sim)
{
    if (is_low(sim->report.method))
        return "radau5";
    return sim->run_options.stiff_method ? "auto" : sim->report.method->name;
}

static struct companion choose_looser(const struct ct_sim *sim)
{
    return (struct companion){.method = name_method(sim),
                              .rtol = least_tolerance_ratio * sim->run_options.rtol,
                              .least_rtol = least_tolerance_ratio
                                          * fmax(sim->report.stats.last_rtol, sim->least_rtol),
                              .margin = tolerance_margin};
}

static struct companion choose_tighter(const struct ct_sim *sim, double least)
{
    const double rtol = sim->run_options.rtol;
    return (struct companion){.method = name_method(sim),
                              .rtol = fmax(rtol * tolerance_reduction, least),
                              .least_rtol = least,
                              .margin = tolerance_margin};
}

static struct companion choose(const struct ct_sim *sim)
{
    const struct ct_run_options *o = &sim->run_options;
    const struct ct_method *m = sim->report.method;
    const struct ct_rank_monitor *w = sim->report.singular;
    if (o->step > 0) {
        const double gain = ldexp(1, m->order);
        return (struct companion){.method = m->name,
                                  .rtol = o->rtol,
                                  .step = o->step / 2,
                                  .margin = gain / (gain - 1)};
    }
    if (is_low(m))
        return choose_tighter(sim, sim->least_rtol);
    const double least = (w && w->npassed > 0 ? 1 : beyond) * sim->least_rtol;
    const double held = fmin(o->rtol, sim->report.stats.last_rtol);
    return held < least_tolerance_ratio * least ? choose_looser(sim)
                                                : choose_tighter(sim, least);
}

// ---- comparing -----------------------------------------------------------------------------

struct comparison {
    const struct ct_sim *sim;
    double *difference; // between the runs  (nkept x nresult)
    double *time;       // (nkept)
    size_t nrow;
    struct ct_output_error_estimate *output;
};

static bool compare_row(void *user, double t, const double *value, size_t n)
{
    struct comparison *c = user;
    const double *first = c->sim->kept + c->nrow * n;
    double *difference = c->difference + c->nrow * n;
    if (c->nrow == c->sim->nkept)
        return false;
    c->time[c->nrow++] = t;
    for (size_t i = 0; i < n; i++) {
        struct ct_output_error_estimate *o = &c->output[i];
        difference[i] = fabs(value[i] - first[i]);
        o->scale = fmax(o->scale, fabs(first[i]));
        o->absolute = fmax(o->absolute, difference[i]);
    }
    return true;
}

static bool has_digits(const struct ct_output_error_estimate *o)
{
    return o->absolute < 0.5 * o->scale;
}

void ct_output_errors_relate(struct ct_output_error_estimate *o, size_t n)
{
    double largest = 0, worst = 0;
    for (size_t i = 0; i < n; i++) {
        largest = fmax(largest, o[i].scale);
        if (has_digits(&o[i]))
            worst = fmax(worst, o[i].absolute / o[i].scale);
    }
    for (size_t i = 0; i < n; i++) {
        const double most
            = has_digits(&o[i]) ? CT_DATA_ROUNDOFF : fmax(CT_DATA_ROUNDOFF, worst);
        o[i].relative = o[i].scale <= most * largest ? NAN : o[i].absolute / o[i].scale;
    }
}

// Finds the largest relative error, and the time from which errors exceed the limit.
static void judge(const struct ct_sim *sim, const struct comparison *c, double margin,
                  struct ct_estimate *e)
{
    const size_t n = sim->system->equations.nresult;
    const double wanted = promised_tolerances * sim->tolerance;
    // round-off of the steps has random signs; a run with the same round-off does not show it
    const double roundoff = DBL_EPSILON * sqrt(fmax(1, (double)sim->report.stats.steps));
    const struct ct_equations *q = &sim->system->equations;
    for (size_t i = 0; i < n; i++) // the total energy is a sum that may cancel
        if (q->result[i].value.id == q->total.id)
            c->output[i].scale = fmax(c->output[i].scale, sim->report.energy_scale);
    for (size_t i = 0; i < n; i++)
        c->output[i].absolute
            = fmax(c->output[i].absolute * margin, roundoff * c->output[i].scale);
    ct_output_errors_relate(c->output, n);
    for (size_t i = 0; i < n; i++) {
        const struct ct_output_error_estimate *o = &c->output[i];
        if (o->relative > e->worst) {
            e->worst = o->relative;
            e->which = i;
        }
    }
    e->holds_until = sim->time;
    for (size_t k = c->nrow; k-- > 0;)
        for (size_t i = 0; i < n; i++)
            if (margin * c->difference[k * n + i] > wanted * c->output[i].scale
                && !isnan(c->output[i].relative))
                e->holds_until = k ? c->time[k - 1] : 0;
}

// ---- the second run ------------------------------------------------------------------------

static const char *describe(struct ct_arena *a, const struct companion *c)
{
    if (c->step > 0)
        return ct_arena_printf(a, "%s with steps of %.3g s", c->method, c->step);
    return ct_arena_printf(a, "%s with steps held to %.2g", c->method, c->rtol);
}

// Sets the tolerance of the other method of `auto`, which may be at the limit of double
// precision.
static void hold_stiff(const struct ct_sim *sim, const struct companion *c,
                       struct ct_run_options *second)
{
    const struct ct_run_options *o = &sim->run_options;
    const double ratio = c->rtol / o->rtol;
    if (!(o->stiff_rtol > 0))
        return;
    const double held = fmax(o->stiff_rtol * ratio, c->least_rtol);
    second->stiff_rtol = ratio > 1 ? held : fmin(second->stiff_rtol, held);
    second->stiff_atol = o->stiff_atol * second->stiff_rtol / o->stiff_rtol;
}

// Makes the second run. False: it failed, and `said` has the reason. c->method (out) is its
// last method.
static bool run_companion(const struct ct_sim *sim, struct ct_ctx *said, struct companion *c,
                          struct comparison *comparison)
{
    const struct ct_run_options *o = &sim->run_options;
    const double tighter = c->rtol / o->rtol;
    const struct ct_sim_options options
        = {.method = c->method,
           // the tolerance that (8.14), section 8.1 and the other method of `auto` use
           .tolerance = sim->tolerance * tighter,
           .absolute = o->atol / o->rtol * sim->tolerance * tighter,
           .step = c->step,
           .until = o->duration,
           .samples = (long)o->nsample,
           .backend = strcmp(ct_run_evaluator(sim->run)->backend, "tape") == 0 ? "tape" : NULL,
           .solver = sim->solver};
    comparison->nrow = 0;
    said->ndiagnostic = said->nerror = 0;
    memset(comparison->output, 0, sim->system->equations.nresult * sizeof *comparison->output);
    struct ct_sim *second = ct_sim_create(said, sim->system, &options);
    bool ok = second != NULL;
    if (ok) {
        second->run_options.step = c->step; // not the step of the model
        second->run_options.rtol = c->rtol;
        second->run_options.least_rtol = c->least_rtol;
        second->run_options.atol = o->atol * tighter;
        hold_stiff(sim, c, &second->run_options);
        ok = ct_sim_run(said, second,
                        &(struct ct_sim_results){.row = compare_row, .user = comparison});
        if (second->report.method)
            c->method = second->report.method->name;
        c->nstep = second->report.stats.steps;
        ok = ok && comparison->nrow == sim->nkept;
    }
    ct_sim_destroy(second);
    if (said->no_memory)
        ct_guard_raise();
    return ok;
}

// Are the errors of the second run independent of those of the first, by (8.31)? If not,
// something other than the tolerance limits the steps of both runs.
static bool is_other(const struct ct_sim *sim, const struct companion *c)
{
    const struct ct_method *m = sim->report.method;
    const double least = c->margin / (c->margin - 1);
    const double more = (double)c->nstep / fmax(1, (double)sim->report.stats.steps);
    return c->step > 0 || strcmp(c->method, m->name) != 0
        || pow(c->rtol < sim->run_options.rtol ? more : 1 / more, m->order) >= least;
}

// Chooses a third run after a second one of nearly the same steps. It is tighter by the same
// factor if possible, because a longest step or a singular configuration may limit the steps;
// otherwise it is looser.
static struct companion choose_third(const struct ct_sim *sim, const struct companion *second)
{
    struct companion c = *second;
    c.method = name_method(sim);
    if (second->rtol >= sim->run_options.rtol) {
        c.rtol *= least_tolerance_ratio;
        c.least_rtol *= least_tolerance_ratio;
        return c;
    }
    c.rtol *= tolerance_reduction;
    return c.rtol >= c.least_rtol ? c : choose_looser(sim);
}

// Are the runs equal to the last bit? Then only the round-off of their steps is known.
static bool is_same(const struct comparison *c)
{
    for (size_t i = 0; i < c->nrow * c->sim->system->equations.nresult; i++)
        if (c->difference[i] > 0)
            return false;
    return true;
}

static void add_differences(struct comparison *c, const struct comparison *other)
{
    const size_t n = c->sim->system->equations.nresult;
    for (size_t i = 0; i < c->nrow * n; i++)
        c->difference[i] = fmax(c->difference[i], other->difference[i]);
    for (size_t i = 0; i < n; i++)
        c->output[i].absolute = fmax(c->output[i].absolute, other->output[i].absolute);
}

static struct comparison start_comparison(const struct ct_sim *sim)
{
    struct ct_arena *a = sim->own.model;
    const size_t n = sim->system->equations.nresult;
    return (struct comparison){.sim = sim,
                               .difference = CT_NEWN(a, double, sim->nkept *n + 1),
                               .time = CT_NEWN(a, double, sim->nkept + 1),
                               .output = CT_NEWN(a, struct ct_output_error_estimate, n + 1)};
}

// Finds a second run that does not fail. A run that cannot pass a singular configuration may
// pass with a looser tolerance.
static bool find_companion(const struct ct_sim *sim, struct ct_ctx *said, struct companion *c,
                           struct comparison *comparison)
{
    const bool is_tighter = c->step == 0 && c->rtol < sim->run_options.rtol;
    if (run_companion(sim, said, c, comparison))
        return true;
    if (c->step > 0)
        return false;
    c->rtol *= retry_tolerance_ratio;
    c->least_rtol *= retry_tolerance_ratio;
    c->method = name_method(sim);
    if (run_companion(sim, said, c, comparison))
        return true;
    if (!is_tighter)
        return false;
    *c = choose_looser(sim);
    return run_companion(sim, said, c, comparison);
}

// Adds the third run to the comparison. True: it was made. If it is looser with the same steps,
// its error may be much larger, as where stability limits the steps; it then counts only for
// outputs about which the second run says nothing.
static bool add_third(const struct ct_sim *sim, struct ct_ctx *said, struct companion *c,
                      struct comparison *comparison)
{
    struct companion third = choose_third(sim, c);
    struct comparison other = start_comparison(sim);
    if (!run_companion(sim, said, &third, &other))
        return false;
    if (third.rtol > sim->run_options.rtol && !is_other(sim, &third) && !is_same(comparison))
        return false;
    add_differences(comparison, &other);
    *c = third;
    return true;
}

void ct_sim_verify(struct ct_sim *sim)
{
    struct ct_arena *a = sim->own.model;
    struct ct_ctx said = {.model = a, .scratch = sim->own.scratch};
    struct companion c = choose(sim);
    struct ct_estimate *e = &sim->estimate;
    const double start = ct_monotonic_time();
    struct comparison comparison = start_comparison(sim);
    *e = (struct ct_estimate){.which = sim->system->equations.nresult, .worst = NAN};
    const bool ok = find_companion(sim, &said, &c, &comparison);
    e->how = describe(a, &c);
    if (!ok) {
        e->why_not = said.ndiagnostic ? said.diagnostic[0].text : "it was stopped";
    } else {
        if (!is_other(sim, &c) && add_third(sim, &said, &c, &comparison))
            e->how = ct_arena_printf(a, "%s, and %s%s", e->how, describe(a, &c),
                                     is_same(&comparison) ? ", equal to the last bit" : "");
        e->worst = 0;
        e->output = comparison.output;
        judge(sim, &comparison, c.margin, e);
    }
    sim->verify_seconds = ct_monotonic_time() - start;
}
