// The global error of a run, estimated by a second one that is better or at least different.
//
//     tighter tolerance     its error is a small part of the first one's: the difference is the error
//     half the fixed step   the same with 2^-order of it (Richardson)
//     another method        where double precision leaves no room: the difference is of the size of both errors
//
// What always holds: the estimate of an output is the largest difference over samples times a factor that makes up for
// the error of the second run; both runs use the same equations, so it says nothing about the model.
#include "api.h"

#include "base/guard.h"

#include <math.h>
#include <string.h>

// The second run is held to this part of the tolerance: a tenth would often not shrink the error
// visibly, a hundredth costs more and is not better.
static const double tightening = 1. / 30;
// With less to gain than this a tighter run says less than another method.
static const double least_gain = 5;
// Errors follow tolerances only roughly: the second run may have a third of the first one's left.
static const double tolerance_margin = 1.5;
// Two runs of equal error: now and then they err to the same side.
static const double twin_margin = 3;
// An output holds as long as its error stays within so many tolerances.
static const double held_tolerances = 10;

struct companion {
    const struct ct_method *method;
    double rtol, step, margin;
};

// A column this small against the largest one is rounding: sums of terms of order 1 leave some hundred eps; without
// a single digit that agrees, some more.
bool ct_is_rounding(double scale, double deviation, double largest)
{
    const double with_digits = 1e-13, without_digits = 1e-9;
    return scale <= (deviation < 0.5 * scale ? with_digits : without_digits) * largest;
}

static struct companion choose(const struct ct_sim *sim)
{
    const struct ct_run_options *o = &sim->run_options;
    const struct ct_method *m = sim->report.method;
    if (o->step > 0) {
        const double gain = ldexp(1, m->order);
        return (struct companion){m, o->rtol, o->step / 2, gain / (gain - 1)};
    }
    const double rtol = fmax(o->rtol * tightening, sim->least_rtol);
    if (m->is_implicit && m->order < 3)
        return (struct companion){ct_method_find("radau5"), rtol, 0, tolerance_margin};
    if (o->rtol >= least_gain * rtol)
        return (struct companion){m, rtol, 0, tolerance_margin};
    const bool is_dopri5 = strcmp(m->name, "dopri5") == 0;
    return (struct companion){ct_method_find(is_dopri5 ? "dop853" : "dopri5"), rtol, 0,
                              twin_margin};
}

// ---- comparing -----------------------------------------------------------------------------------------

struct comparison {
    const struct ct_sim *sim;
    double *row; // of the first run; each becomes its difference to the second  (nkept x nresult)
    double *time; // (nkept)
    size_t nrow;
    struct ct_output_error *output;
};

static bool compare_row(void *user, double t, const double *value, size_t n)
{
    struct comparison *c = user;
    double *row = c->row + c->nrow * n;
    if (c->nrow == c->sim->nkept)
        return false;
    c->time[c->nrow++] = t;
    for (size_t i = 0; i < n; i++) {
        struct ct_output_error *o = &c->output[i];
        o->scale = fmax(o->scale, fabs(row[i]));
        row[i] = fabs(value[i] - row[i]);
        o->absolute = fmax(o->absolute, row[i]);
    }
    return true;
}

// Relative errors, the largest of them, and since when it has been more than is wanted.
static void judge(const struct ct_sim *sim, const struct comparison *c, double margin,
                  struct ct_estimate *e)
{
    const size_t n = sim->system->equations.nresult;
    double largest = 0, wanted = held_tolerances * sim->tolerance;
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, c->output[i].scale);
    for (size_t i = 0; i < n; i++) {
        struct ct_output_error *o = &c->output[i];
        const bool is_rounding = ct_is_rounding(o->scale, o->absolute, largest);
        o->absolute *= margin;
        o->relative = is_rounding ? NAN : o->absolute / o->scale;
        if (o->relative > e->worst || e->which == n) {
            e->worst = is_rounding ? e->worst : o->relative;
            e->which = is_rounding ? e->which : i;
        }
    }
    e->holds_until = sim->time;
    for (size_t k = c->nrow; k-- > 0;)
        for (size_t i = 0; i < n; i++)
            if (margin * c->row[k * n + i] > wanted * c->output[i].scale
                && !isnan(c->output[i].relative))
                e->holds_until = k ? c->time[k - 1] : 0;
}

// ---- the second run --------------------------------------------------------------------------------------

static const char *describe(struct ct_arena *a, const struct companion *c)
{
    if (c->step > 0)
        return ct_arena_printf(a, "%s with steps of %.3g s", c->method->name, c->step);
    return ct_arena_printf(a, "%s with steps held to %.2g", c->method->name, c->rtol);
}

// False: the run failed, and why is in `said`.
static bool run_companion(const struct ct_sim *sim, struct ct_ctx *said,
                          const struct companion *c, struct comparison *comparison)
{
    const struct ct_run_options *o = &sim->run_options;
    const struct ct_sim_options options
        = {.method = c->method->name,
           .tolerance = sim->tolerance,
           .step = c->step,
           .until = o->duration,
           .samples = (long)o->nsample,
           .backend = strcmp(ct_run_machine(sim->run)->backend, "tape") == 0 ? "tape" : NULL};
    struct ct_sim *second = ct_sim_create(said, sim->system, &options);
    bool ok = second != NULL;
    if (ok) {
        second->run_options.step = c->step; // not the one of the model
        second->run_options.rtol = c->rtol;
        second->run_options.atol = fmin(o->atol, o->atol * c->rtol / o->rtol);
        ok = ct_sim_run(said, second,
                        &(struct ct_sim_results){.row = compare_row, .user = comparison});
        ok = ok && comparison->nrow == sim->nkept;
    }
    ct_sim_destroy(second);
    if (said->no_memory)
        ct_guard_raise();
    return ok;
}

void ct_sim_verify(struct ct_sim *sim)
{
    struct ct_arena *a = sim->own.model;
    struct ct_ctx said = {.model = a, .scratch = sim->own.scratch};
    const size_t n = sim->system->equations.nresult;
    const struct companion c = choose(sim);
    struct ct_estimate *e = &sim->estimate;
    const double start = ct_clock();
    struct comparison comparison = {.sim = sim,
                                    .row = sim->kept,
                                    .time = CT_NEWN(a, double, sim->nkept + 1),
                                    .output = CT_NEWN(a, struct ct_output_error, n + 1)};
    *e = (struct ct_estimate){.which = n, .worst = NAN, .how = describe(a, &c)};
    if (run_companion(sim, &said, &c, &comparison)) {
        e->worst = 0;
        e->output = comparison.output;
        judge(sim, &comparison, c.margin, e);
    } else {
        e->why_not = said.ndiagnostic ? said.diagnostic[0].text : "it was stopped";
    }
    sim->verify_seconds = ct_clock() - start;
}
