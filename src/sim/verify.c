// The global error of a run, estimated by a second one that is better or at least different, and a
// third where the second was not.
//
//     tighter tolerance     its error is a small part of the first one's: the difference is the error
//     half the fixed step   the same with 2^-order of it (Richardson)
//     looser tolerance      where double precision leaves no room for a tighter one: its error is larger, and so is the difference
//
// A second run of nearly the same steps has nearly the same errors, those of round-off included,
// and the difference says nothing of them: see is_other, (8.31).
//
// What always holds: the estimate of an output is the largest difference over samples times a
// factor that makes up for the error of the second run; both runs use the same equations, so it
// says nothing about the model.
#include "sim/sim.h"

#include "base/guard.h"
#include "solve/singular/singular.h"

#include <float.h>
#include <math.h>
#include <string.h>

// The second run is held to this part of the tolerance: a tenth would often not shrink the error
// visibly, a hundredth costs more and is not better.
// Derived: from those measurements.
static const double tightening = 1. / 30;
// With less to gain than this, the second run is looser by as much: then it has the larger error.
// Chosen: errors that differ by less are hard to tell apart by a difference.
static const double least_gain = 5;
// A run that is compared with may be held to this part of what double precision leaves to the steps
// of one that is wanted: of motions with many turns errors of truncation go on falling to there. An
// explicit step errs by round-off errors of h f alone, as those of y are carried over, and by as
// much less as it is shorter. Not past singular configurations.
// Derived: for steps ten times as short
static const double beyond = 0.1;
// Limit: one more try, and a message then.
static const double second_try = 3; // looser, where the second run failed
// Errors follow tolerances only roughly, and where they are round-off not at all: two runs that err
// by as much differ by root 2 of it.
// Derived: root 2, and a little for rough estimates.
static const double tolerance_margin = 1.5;
// An output holds as long as its error stays within so many tolerances.
// Definition: what the documentation promises, docs/accuracy.md
static const double held_tolerances = 10;

struct companion {
    const char *method;
    double rtol, step, margin;
    double least_rtol; // of steps of motions with many turns
    long nstep;        // out
};

// A column this small against the largest one is round-off: sums of terms of order 1 leave some
// hundred eps; without a single digit that agrees, some more.
bool ct_is_rounding(double scale, double deviation, double largest)
{
    // Derived: some hundred, and some million, units of round-off
    const double with_digits = 1e-13, without_digits = 1e-9;
    return scale <= (deviation < 0.5 * scale ? with_digits : without_digits) * largest;
}

// Better than with a tighter tolerance, the error of such a method is found with another one.
static bool is_low(const struct ct_method *m)
{
    return m->is_implicit && m->order < 3;
}

// Where the method was chosen while the run went on, the second one chooses anew: only so do its
// steps follow what the tolerance asks for besides their own errors.
static const char *name_method(const struct ct_sim *sim)
{
    if (is_low(sim->report.method))
        return "radau5";
    return sim->run_options.stiff_method ? "auto" : sim->report.method->name;
}

static struct companion choose_looser(const struct ct_sim *sim)
{
    return (struct companion){.method = name_method(sim),
                              .rtol = least_gain * sim->run_options.rtol,
                              .least_rtol
                              = least_gain * fmax(sim->report.stats.last_rtol, sim->least_rtol),
                              .margin = tolerance_margin};
}

static struct companion choose_tighter(const struct ct_sim *sim, double least)
{
    const double rtol = sim->run_options.rtol;
    return (struct companion){.method = name_method(sim),
                              .rtol = fmax(rtol * tightening, least),
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
    return held < least_gain * least ? choose_looser(sim) : choose_tighter(sim, least);
}

// ---- comparing ----------------------------------------------------------------------------------

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

// Outputs without a digit that agrees, and not larger than the errors of others make them, are zero
// as far as can be seen: the sum of energies that cancel, the momentum of a motion that has none.
static void find_relative(struct ct_output_error_estimate *o, size_t n)
{
    // Chosen: sums of up to a hundred outputs
    const double spread = 100; // sums of outputs add up their errors
    // Chosen: three digits
    const double small = 1e-3; // against others that have lost all digits
    double largest = 0, worst = 0, largest_lost = 0;
    for (size_t i = 0; i < n; i++) {
        largest = fmax(largest, o[i].scale);
        if (has_digits(&o[i]))
            worst = fmax(worst, o[i].absolute / o[i].scale);
        else
            largest_lost = fmax(largest_lost, o[i].scale);
    }
    for (size_t i = 0; i < n; i++) {
        const bool is_zero = ct_is_rounding(o[i].scale, o[i].absolute, largest)
                          || (!has_digits(&o[i])
                              && (o[i].scale <= spread * worst * largest
                                  || o[i].scale <= small * largest_lost));
        o[i].relative = is_zero ? NAN : o[i].absolute / o[i].scale;
    }
}

// The largest relative error, and since when errors have been more than is wanted.
static void judge(const struct ct_sim *sim, const struct comparison *c, double margin,
                  struct ct_estimate *e)
{
    const size_t n = sim->system->equations.nresult;
    const double wanted = held_tolerances * sim->tolerance;
    // steps err by round-off errors of either sign, which no run tells that has the same ones
    const double roundoff = DBL_EPSILON * sqrt(fmax(1, (double)sim->report.stats.steps));
    const struct ct_equations *q = &sim->system->equations;
    for (size_t i = 0; i < n; i++) // the total energy is a sum that may cancel
        if (q->result[i].value.id == q->total.id)
            c->output[i].scale = fmax(c->output[i].scale, sim->report.energy_scale);
    for (size_t i = 0; i < n; i++)
        c->output[i].absolute
            = fmax(c->output[i].absolute * margin, roundoff * c->output[i].scale);
    find_relative(c->output, n);
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

// ---- the second run -----------------------------------------------------------------------------

static const char *describe(struct ct_arena *a, const struct companion *c)
{
    if (c->step > 0)
        return ct_arena_printf(a, "%s with steps of %.3g s", c->method, c->step);
    return ct_arena_printf(a, "%s with steps held to %.2g", c->method, c->rtol);
}

// The other method of `auto` as well, also where both its tolerances are what double precision
// leaves.
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

// False: the run failed, and why is in `said`. c->method (out) is that which it ended with.
static bool run_companion(const struct ct_sim *sim, struct ct_ctx *said, struct companion *c,
                          struct comparison *comparison)
{
    const struct ct_run_options *o = &sim->run_options;
    const double tighter = c->rtol / o->rtol;
    const struct ct_sim_options options
        = {.method = c->method,
           // what (8.14), 8.1 and the other method of `auto` go by
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
        second->run_options.step = c->step; // not the one of the model
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

// Are its errors others than those of the first run, by (8.31)? If not, steps are held up by
// something that both runs have in common.
static bool is_other(const struct ct_sim *sim, const struct companion *c)
{
    const struct ct_method *m = sim->report.method;
    const double least = c->margin / (c->margin - 1);
    const double more = (double)c->nstep / fmax(1, (double)sim->report.stats.steps);
    return c->step > 0 || strcmp(c->method, m->name) != 0
        || pow(c->rtol < sim->run_options.rtol ? more : 1 / more, m->order) >= least;
}

// After a second run of nearly the same steps: a third one. Tighter by as much again while there is
// room, as what holds steps up may be a longest step, or a singular configuration to be crossed;
// else looser.
static struct companion choose_third(const struct ct_sim *sim, const struct companion *second)
{
    struct companion c = *second;
    c.method = name_method(sim);
    if (second->rtol >= sim->run_options.rtol) {
        c.rtol *= least_gain;
        c.least_rtol *= least_gain;
        return c;
    }
    c.rtol *= tightening;
    return c.rtol >= c.least_rtol ? c : choose_looser(sim);
}

// To the bit: what is told is round-off of so many steps.
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

// One that does not fail: what did not pass a singular configuration may pass a little looser.
static bool find_companion(const struct ct_sim *sim, struct ct_ctx *said, struct companion *c,
                           struct comparison *comparison)
{
    const bool is_tighter = c->step == 0 && c->rtol < sim->run_options.rtol;
    if (run_companion(sim, said, c, comparison))
        return true;
    if (c->step > 0)
        return false;
    c->rtol *= second_try;
    c->least_rtol *= second_try;
    c->method = name_method(sim);
    if (run_companion(sim, said, c, comparison))
        return true;
    if (!is_tighter)
        return false;
    *c = choose_looser(sim);
    return run_companion(sim, said, c, comparison);
}

// True: it was made, and is in the comparison. A looser one of the same steps as well may err by
// much more, as where stability holds them up: it tells only where the second one told nothing.
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
                                     is_same(&comparison) ? ", alike to the bit" : "");
        e->worst = 0;
        e->output = comparison.output;
        judge(sim, &comparison, c.margin, e);
    }
    sim->verify_seconds = ct_monotonic_time() - start;
}
