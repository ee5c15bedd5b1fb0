// The global error of a run, estimated by a second one that is better or at least different.
//
//     tighter tolerance     its error is a small part of the first one's: the difference is the error
//     half the fixed step   the same with 2^-order of it (Richardson)
//     looser tolerance      where double precision leaves no room for a tighter one, so that one took the same steps
//
// What always holds: the estimate of an output is the largest difference over samples times a factor that makes up for
// the error of the second run; both runs use the same equations, so it says nothing about the model.
#include "sim/sim.h"

#include "base/guard.h"

#include <math.h>
#include <string.h>

// The second run is held to this part of the tolerance: a tenth would often not shrink the error
// visibly, a hundredth costs more and is not better.
static const double tightening = 1. / 30;
// With less to gain than this, the second run is looser by as much: then it has the larger error.
static const double least_gain = 5;
static const double second_try = 3; // looser, where the second run failed
// Errors follow tolerances only roughly, and where they are rounding not at all.
static const double tolerance_margin = 1.5;
// An output holds as long as its error stays within so many tolerances.
static const double held_tolerances = 10;

struct companion {
    const char *method;
    double rtol, step, margin;
};

// A column this small against the largest one is rounding: sums of terms of order 1 leave some hundred eps; without
// a single digit that agrees, some more.
bool ct_is_rounding(double scale, double deviation, double largest)
{
    const double with_digits = 1e-13, without_digits = 1e-9;
    return scale <= (deviation < 0.5 * scale ? with_digits : without_digits) * largest;
}

// Where the method was chosen while the run went on, the second one chooses anew: only so do its steps follow what the tolerance
// asks for besides their own errors.
static struct companion choose(const struct ct_sim *sim)
{
    const struct ct_run_options *o = &sim->run_options;
    const struct ct_method *m = sim->report.method;
    if (o->step > 0) {
        const double gain = ldexp(1, m->order);
        return (struct companion){m->name, o->rtol, o->step / 2, gain / (gain - 1)};
    }
    const double rtol = fmax(o->rtol * tightening, sim->least_rtol);
    if (m->is_implicit && m->order < 3)
        return (struct companion){"radau5", rtol, 0, tolerance_margin};
    const char *name = o->stiff_method ? "auto" : m->name;
    if (o->rtol >= least_gain * rtol)
        return (struct companion){name, rtol, 0, tolerance_margin};
    return (struct companion){name, o->rtol * least_gain, 0, tolerance_margin};
}

// ---- comparing -----------------------------------------------------------------------------------------

struct comparison {
    const struct ct_sim *sim;
    double *difference; // between the runs  (nkept x nresult)
    double *time;       // (nkept)
    size_t nrow;
    struct ct_output_error *output;
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
        struct ct_output_error *o = &c->output[i];
        difference[i] = fabs(value[i] - first[i]);
        o->scale = fmax(o->scale, fabs(first[i]));
        o->absolute = fmax(o->absolute, difference[i]);
    }
    return true;
}

static bool has_digits(const struct ct_output_error *o)
{
    return o->absolute < 0.5 * o->scale;
}

// Outputs without a digit that agrees, and not larger than the errors of others make them, are zero as far as can be
// seen: the sum of energies that cancel, the momentum of a motion that has none.
static void find_relative(struct ct_output_error *o, size_t n)
{
    const double spread = 100; // sums of outputs add up their errors
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
    const struct ct_equations *q = &sim->system->equations;
    for (size_t i = 0; i < n; i++) // the total energy is a sum that may cancel
        if (q->result[i].value.id == q->total.id)
            c->output[i].scale = fmax(c->output[i].scale, sim->report.energy_scale);
    find_relative(c->output, n);
    for (size_t i = 0; i < n; i++) {
        struct ct_output_error *o = &c->output[i];
        o->absolute *= margin;
        o->relative *= margin;
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

// ---- the second run --------------------------------------------------------------------------------------

static const char *describe(struct ct_arena *a, const struct companion *c)
{
    if (c->step > 0)
        return ct_arena_printf(a, "%s with steps of %.3g s", c->method, c->step);
    return ct_arena_printf(a, "%s with steps held to %.2g", c->method, c->rtol);
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
           .backend = strcmp(ct_run_machine(sim->run)->backend, "tape") == 0 ? "tape" : NULL,
           .solver = sim->solver};
    comparison->nrow = 0;
    said->ndiagnostic = said->nerror = 0;
    memset(comparison->output, 0, sim->system->equations.nresult * sizeof *comparison->output);
    struct ct_sim *second = ct_sim_create(said, sim->system, &options);
    bool ok = second != NULL;
    if (ok) {
        second->run_options.step = c->step; // not the one of the model
        second->run_options.rtol = c->rtol;
        second->run_options.atol = o->atol * tighter;
        if (tighter
            > 1) { // also where both tolerances of the other method are what double precision leaves
            second->run_options.stiff_rtol = o->stiff_rtol * tighter;
            second->run_options.stiff_atol = o->stiff_atol * tighter;
        }
        ok = ct_sim_run(said, second,
                        &(struct ct_sim_results){.row = compare_row, .user = comparison});
        if (second->report.method)
            c->method = second->report.method->name;
        ok = ok && comparison->nrow == sim->nkept;
    }
    ct_sim_destroy(second);
    if (said->no_memory)
        ct_guard_raise();
    return ok;
}

// Two runs that are the same to the bit took the same steps, both held to what double precision leaves: they say nothing of
// the error.
static bool is_same(const struct comparison *c)
{
    for (size_t i = 0; i < c->nrow * c->sim->system->equations.nresult; i++)
        if (c->difference[i] > 0)
            return false;
    return true;
}

void ct_sim_verify(struct ct_sim *sim)
{
    struct ct_arena *a = sim->own.model;
    struct ct_ctx said = {.model = a, .scratch = sim->own.scratch};
    const size_t n = sim->system->equations.nresult;
    struct companion c = choose(sim);
    struct ct_estimate *e = &sim->estimate;
    const double start = ct_clock();
    struct comparison comparison = {.sim = sim,
                                    .difference = CT_NEWN(a, double, sim->nkept *n + 1),
                                    .time = CT_NEWN(a, double, sim->nkept + 1),
                                    .output = CT_NEWN(a, struct ct_output_error, n + 1)};
    const char *const method = c.method;
    *e = (struct ct_estimate){.which = n, .worst = NAN};
    bool ok = run_companion(sim, &said, &c, &comparison);
    if (!ok && c.step == 0) { // a little looser, what did not pass a singular position may pass
        c.rtol *= second_try;
        c.method = method;
        ok = run_companion(sim, &said, &c, &comparison);
    }
    if (ok && c.step == 0 && c.rtol < sim->run_options.rtol && is_same(&comparison)) {
        c.rtol = sim->run_options.rtol * least_gain;
        c.method = method;
        ok = run_companion(sim, &said, &c, &comparison);
    }
    e->how = describe(a, &c);
    if (ok) {
        e->worst = 0;
        e->output = comparison.output;
        judge(sim, &comparison, c.margin, e);
    } else {
        e->why_not = said.ndiagnostic ? said.diagnostic[0].text : "it was stopped";
    }
    sim->verify_seconds = ct_clock() - start;
}
