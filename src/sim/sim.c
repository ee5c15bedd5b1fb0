// Runs: options are resolved, the start is assembled, the motion is integrated and written.
#include "sim/sim.h"

#include "base/guard.h"
#include "component/roundoff.h"
#include "formulate/beam/flexible_body.h"
#include "solve/constraint/partition_conditioning.h"
#include "solve/batch/batch.h"
#include "solve/singular/singular.h"

#include <math.h>
#include <stdlib.h>
#include <float.h>
#include <string.h>

// The error of a solution is larger than that of its steps. The tolerance of the steps is
// therefore smaller than the wanted accuracy of the outputs, as far as double precision allows.
// Over the reference cases the output error is up to 3000 times the tolerance of the steps with
// dopri5 and past singular configurations, and up to 1300 times with dop853 without loops.
// Derived: from those measurements; a few cases are left to output error control.
static const double step_tolerance_part = 2e-3, high_order_tolerance_part = 5e-3;
// A step of order p has an error of order h^(p+1), the solution one of order h^p: T = c
// tol^(p/(p+1)). For order 2, c is 10 to 50 in most cases.
// Derived: from those measurements.
static const double order2_factor = 30;
// Radau's steps are controlled by an error estimate of order 3, which is relaxed to
// tol^(2/3)/10. With this power of T the estimate is controlled to T/10.
// Derived: (T^1.5)^(2/3) = T.
static const double radau_power = 1.5;
// Derived: the square root of 1e-4; for T above 1e-4 the power would be the looser one.
static const double radau_tolerance_part = 1e-2; // for loose tolerances
// Smallest relative tolerance of steps without loops, some ninety round-off errors. With loops
// it is ct_position_tolerance, to which projection satisfies the constraints. Steps with
// smaller tolerances, down to 1e-14, do not improve outputs past singular configurations.
// Elsewhere they improve outputs below 1e-12 a few times. Derived: by these measurements.
static const double least_rtol = 2e-14;
// Above this tolerance dop853 does not pay for its twelve evaluations a step: over the
// reference cases both explicit methods then cost the same.
// Derived: from those measurements.
static const double high_order_up_to = 1e-2;
// Limit: of the time to read the clock.
static const long steps_between_clock_reads = 32; // reading the clock, for runs with a deadline

// ---- options -------------------------------------------------------------------------------

static bool wrong_option(struct ct_sim *sim, const char *name, double value)
{
    return ct_error(&sim->own, (struct ct_mark){0}, CT_E_USAGE,
                    "%s is %g; it must be greater than 0", name, value);
}

static bool check_numbers(struct ct_sim *sim, const struct ct_sim_options *o)
{
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"the tolerance", o->tolerance},
                   {"the absolute tolerance", o->absolute},
                   {"the step", o->step},
                   {"the end time", o->until},
                   {"the number of samples", (double)o->samples}};
    bool ok = true;
    for (size_t i = 0; i < COUNT(numbers); i++)
        if (!(numbers[i].value >= 0 && isfinite(numbers[i].value)))
            ok = wrong_option(sim, numbers[i].name, numbers[i].value);
    return ok;
}

static bool no_method(struct ct_sim *sim, const char *name, bool is_option)
{
    const char **names = CT_NEWN(sim->own.model, const char *, ct_nmethod + 1);
    names[0] = "auto";
    for (int i = 0; i < ct_nmethod; i++)
        names[i + 1] = ct_methods[i]->name;
    const struct ct_mark none = {0};
    return ct_error(&sim->own, is_option ? none : sim->system->model.simulation.method_mark,
                    is_option ? CT_E_USAGE : CT_E_WORD, "this version has no method '%s'%s",
                    name,
                    ct_suggest_or_list(sim->own.model, name, names, (size_t)ct_nmethod + 1));
}

// The tolerance of steps that gives outputs an error of about `tolerance`.
static double tolerance_of_steps(const struct ct_sim *sim, const struct ct_method *m)
{
    const double t = sim->tolerance;
    if (m->is_implicit)
        return m->order < 3 ? pow(t / order2_factor, 1.5)
                            : fmin(radau_tolerance_part * t, pow(t, radau_power));
    const bool is_open = sim->system->equations.nrow == 0;
    return t * (m->order > 5 && is_open ? high_order_tolerance_part : step_tolerance_part);
}

static void set_tolerances(const struct ct_sim *sim, const struct ct_method *m, double absolute,
                           double *rtol, double *atol)
{
    *rtol = fmax(tolerance_of_steps(sim, m), sim->least_rtol);
    *atol = absolute / sim->tolerance * *rtol;
}

// Is there a cubic table? Its third derivative is discontinuous at the points of the table, and
// the error estimate of a step of order 8 does not see that.
static bool has_cubic_table(const struct ct_exs *x)
{
    for (size_t k = 0; k < x->ntable; k++)
        if (x->table[k].m)
            return true;
    return false;
}

static void choose_automatically(struct ct_sim *sim)
{
    struct ct_run_options *o = &sim->run_options;
    const bool is_tight = o->step == 0 && sim->tolerance <= high_order_up_to;
    const bool high = is_tight && !has_cubic_table(sim->system->equations.x);
    o->method = ct_method_find(high ? "dop853" : "dopri5");
    sim->method_why = o->step > 0 ? "automatic: a fixed step"
                    : high        ? "automatic: high order"
                    : is_tight ? "automatic: cubic tables are smooth only between their points"
                               : "automatic: a loose tolerance";
    if (o->step == 0)
        o->stiff_method = ct_method_find("radau5");
}

static bool choose_method(struct ct_sim *sim, const char *option)
{
    const char *name = option ? option : sim->system->model.simulation.method;
    struct ct_run_options *o = &sim->run_options;
    sim->method_why = option ? "as requested" : "as the model says";
    o->method = ct_method_find(name);
    if (!o->method && strcmp(name, "auto") != 0)
        return no_method(sim, name, option != NULL);
    if (!o->method)
        choose_automatically(sim);
    return true;
}

// The number of samples until a given end time; keeps the model's spacing of samples as nearly
// as both ends allow.
static size_t samples_until(const struct ct_simulation *m, double until)
{
    double spacing = m->interval;
    if (spacing == 0 && m->has_duration && m->samples > 1)
        spacing = m->duration / (double)(m->samples - 1);
    if (!(spacing > 0))
        return m->samples > 1 ? (size_t)m->samples : 2;
    // a quotient such as 10/0.01 may be rounded up
    return (size_t)ceil(until / spacing * (1 - CT_DATA_ROUNDOFF)) + 1;
}

bool ct_sim_resolve(struct ct_sim *sim, const struct ct_sim_options *o)
{
    const struct ct_simulation *m = &sim->system->model.simulation;
    if (!check_numbers(sim, o))
        return false;
    sim->tolerance = o->tolerance > 0 ? o->tolerance : m->rtol;
    const double absolute = o->absolute > 0  ? o->absolute
                          : o->tolerance > 0 ? o->tolerance / 100
                                             : m->atol;
    sim->least_rtol = sim->system->equations.nrow ? ct_position_tolerance : least_rtol;
    sim->is_verified = o->verify;
    struct ct_run_options *run = &sim->run_options;
    *run = (struct ct_run_options){
        .duration = o->until > 0 ? o->until : m->duration,
        .step = o->step > 0 ? o->step : m->step,
        .nsample = o->samples > 0 ? (size_t)o->samples
                 : o->until > 0   ? samples_until(m, o->until)
                                  : (size_t)m->samples,
        .rate_jumps = m->rate_jumps,
        .output_rtol = sim->tolerance,
        .least_rtol = sim->least_rtol,
        .take = sim->take,
        .ntake = sim->ntake,
    };
    if (!choose_method(sim, o->method))
        return false;
    set_tolerances(sim, run->method, absolute, &run->rtol, &run->atol);
    if (run->stiff_method)
        set_tolerances(sim, run->stiff_method, absolute, &run->stiff_rtol, &run->stiff_atol);
    return true;
}

const char *ct_sim_refuses_batch(const struct ct_sim *sim)
{
    return sim->system->held_equations.build ? "beams start in equilibrium"
                                             : ct_batch_obstacle(&sim->run_options);
}

// Evaluates by machine code if it is available, unless the tape is requested.
bool ct_sim_choose_backend(struct ct_sim *sim, const char *name)
{
    static const char *const words[] = {"auto", "tape", "native"};
    static const enum ct_backend backends[]
        = {CT_BACKEND_BEST, CT_BACKEND_TAPE, CT_BACKEND_NATIVE};
    for (size_t i = 0; i < COUNT(words); i++) {
        if (name && strcmp(name, words[i]) != 0)
            continue;
        return ct_evaluator_use(sim->own.model, ct_run_evaluator(sim->run), backends[i])
            || ct_error(&sim->own, (struct ct_mark){0}, CT_E_USAGE,
                        "native code is not available on this computer; there is tape");
    }
    return ct_error(&sim->own, (struct ct_mark){0}, CT_E_USAGE,
                    "there is no back end '%s'; there are auto, native, tape", name);
}

// ---- the start -----------------------------------------------------------------------------

struct create {
    struct ct_sim *sim;
    const struct ct_sim_options *options;
};

// Does the run need the mass matrix? Impulses at events do.
static bool needs_dynamics(const struct ct_equations *e)
{
    return !e->solution || e->nswitch || e->x->ntable;
}

// Names of the joints of the marked rows, each once: "a, b".
static const char *joints_of(const struct ct_sim *sim, const bool *row, int *first)
{
    const struct ct_equations *e = &sim->system->equations;
    const char *names = "";
    *first = -1;
    for (size_t j = 0; j < sim->system->model.njoint; j++) {
        bool is_there = false;
        for (size_t i = 0; i < e->nrow; i++)
            is_there |= row[i] && e->row[i].joint == (int)j;
        if (!is_there)
            continue;
        names = ct_arena_printf(sim->own.model, "%s%s'%s'", names, *first < 0 ? "" : ", ",
                                sim->system->model.joint[j].name);
        *first = *first < 0 ? (int)j : *first;
    }
    return names;
}

// If the start is singular, reports that freedoms and redundant rows hold for that
// configuration only.
void ct_sim_warn_of_singular_start(struct ct_sim *sim)
{
    bool *row = CT_NEWN(sim->own.model, bool, sim->system->equations.nrow + 1);
    int first;
    if (!ct_singular_start_test(sim->own.scratch, ct_run_partition(sim->run), 0,
                                ct_run_assembled(sim->run), row))
        return;
    const char *names = joints_of(sim, row, &first);
    if (first < 0)
        return;
    ct_run_note_singular_start(sim->run, names);
    ct_warning(
        &sim->own, sim->system->model.joint[first].mark, 0,
        "the mechanism starts in a singular configuration: constraints of %s depend on others "
        "there and not elsewhere; near it there are fewer freedoms, and several motions may "
        "begin in it",
        names);
}

static bool prepare(struct ct_sim *sim, const struct ct_sim_options *o)
{
    struct ct_system *s = sim->system;
    if (!ct_sim_resolve(sim, o))
        return false;
    const double start = ct_monotonic_time();
    if (sim->run_options.method->is_implicit) // created once, when the first run needs it
        ct_formulate_residual(&s->equations);
    if (needs_dynamics(&s->equations))
        ct_formulate_dynamics(&s->equations);
    if (!ct_system_assemble(&sim->own, s, &sim->start))
        return false;
    sim->run = ct_run_prepare(&sim->own, sim->own.model, &s->model, &s->equations);
    if (!ct_sim_choose_solver(sim, o->solver) || !ct_run_begin(sim->run, &sim->start)
        || !ct_sim_has_solver(sim))
        return false;
    sim->compile = ct_monotonic_time() - start;
    if (!ct_sim_choose_backend(sim, o->backend))
        return false;
    sim->open.row = CT_NEWN(sim->own.model, bool, s->equations.nrow + 1);
    sim->open.result = CT_NEWN(sim->own.model, bool, s->equations.nresult + 1);
    sim->report.final = CT_NEWN(sim->own.model, double, s->equations.nresult + 1);
    sim->report.rank = ct_run_partition(sim->run)->rank;
    ct_sim_warn_of_start(sim);
    ct_sim_warn_of_singular_start(sim);
    if (ct_run_results(sim->run, 0, ct_run_state(sim->run), sim->report.final) != CT_EVAL_OK)
        return ct_error(&sim->own, (struct ct_mark){.file = s->model.file}, CT_E_SINGULAR,
                        "the equations are singular at the start");
    ct_run_find_undetermined(sim->run, 0, ct_run_state(sim->run), sim->open.row,
                             sim->open.result);
    return true;
}

bool ct_sim_prepare(struct ct_sim *sim, struct ct_system *sys, const struct ct_sim_options *o)
{
    sim->system = sys;
    if (!ct_sim_resolve(sim, o))
        return false;
    if (needs_dynamics(&sys->equations))
        ct_formulate_dynamics(&sys->equations);
    sim->run = ct_run_prepare(&sim->own, sim->own.model, &sys->model, &sys->equations);
    return ct_sim_choose_backend(sim, o->backend);
}

static bool create(void *task)
{
    const struct create *c = task;
    c->sim->system = ct_system_borrow(&c->sim->own, c->sim->system);
    return prepare(c->sim, c->options);
}

struct ct_sim *ct_sim_create(struct ct_ctx *ctx, struct ct_system *sys,
                             const struct ct_sim_options *options)
{
    struct ct_sim_options o;
    ct_options_take(&o, options, sizeof o);
    if (!ctx || !sys)
        return NULL;
    struct create c = {ct_own_alloc(ctx, sizeof *c.sim), &o};
    if (!c.sim)
        return NULL;
    c.sim->system = sys;
    if (ct_own_enter(ctx, &c.sim->own, create, &c))
        return c.sim;
    ct_sim_destroy(c.sim);
    return NULL;
}

void ct_sim_destroy(struct ct_sim *sim)
{
    if (sim)
        ct_own_finish(&sim->own);
    free(sim);
}

// ---- the run -------------------------------------------------------------------------------

static bool at_row(void *user, double t, const double *value, size_t n)
{
    struct ct_sim *sim = user;
    const double start = ct_monotonic_time();
    sim->time = t;
    if (sim->kept)
        memcpy(sim->kept + sim->nkept++ * n, value, n * sizeof *value);
    bool go_on = !sim->file || ct_sim_write_row(sim, t, value);
    if (go_on && sim->results->row)
        go_on = sim->results->row(sim->results->user, t, value, n);
    sim->write += ct_monotonic_time() - start;
    return go_on;
}

// Is the deadline past? Or has an eighth of the allowed time passed, and would the run at its
// present pace need more than four times the allowed time?
static bool will_miss_deadline(const struct ct_sim *sim, double t, double end)
{
    const double now = ct_monotonic_time(), all = sim->deadline - sim->begun,
                 gone = now - sim->begun;
    return now > sim->deadline || (gone > all / 8 && t / end < gone / all / 4);
}

static bool at_progress(void *user, double t, double end)
{
    struct ct_sim *sim = user;
    sim->reached = t;
    if (sim->progress)
        ct_progress_update(sim->progress, end > 0 ? t / end : 1);
    if (sim->results->progress && !sim->results->progress(sim->results->user, t, end))
        return false;
    if (ct_guard_is_interrupted())
        sim->is_interrupted = true;
    // reading the clock costs as much as a step of a small system
    if (sim->deadline > 0 && sim->nstep++ % steps_between_clock_reads == 0)
        sim->is_late = will_miss_deadline(sim, t, end);
    return !sim->is_late && !sim->is_interrupted;
}

static void print_forecast(void *user, const struct ct_step_forecast *f)
{
    struct ct_sim *sim = user;
    if (!sim->progress)
        return;
    ct_progress_finish(sim->progress);
    FILE *out = sim->progress->out;
    fprintf(out, "t = %.3g s: steps of %.2g s; some %.1g more are to come", f->t, f->step,
            f->to_come);
    if (f->fastest)
        fprintf(out, "; the fastest motion that is possible, of %.2g 1/s, is one of '%s'",
                f->rate, f->fastest);
    if (f->demanding)
        fprintf(out, "; every vibration is followed for the output '%s'", f->demanding);
    fputc('\n', out);
    fflush(out);
}

static void want_residual(void *user)
{
    struct ct_sim *sim = user;
    ct_formulate_residual(&sim->system->equations);
}

// Writes the reason for the method of integration, which is known after the run.
static void explain_change(struct ct_sim *sim)
{
    const struct ct_run_report *r = &sim->report;
    if (isnan(r->changed_at))
        return;
    const char *until = isnan(r->returned_at)
                          ? ""
                          : ct_arena_printf(sim->own.model, " to t = %.3g s", r->returned_at);
    if (isnan(r->gain)) {
        sim->method_why = ct_arena_printf(sim->own.model,
                                          "automatic, but %s from the start%s: outputs are "
                                          "sensitive to errors of motions of %.2g 1/s that "
                                          "are possible",
                                          sim->run_options.stiff_method->name, until, r->fast);
        return;
    }
    sim->method_why = ct_arena_printf(sim->own.model,
                                      "automatic, but %s from t = %.3g s%s: stiff, motions of "
                                      "%.2g 1/s are possible where there "
                                      "are %.2g 1/s; %.2g times as far for the work",
                                      sim->run_options.stiff_method->name, r->changed_at, until,
                                      r->fast, r->slow, r->gain);
}

static bool integrate(struct ct_sim *sim)
{
    struct ct_run_options *o = &sim->run_options;
    if (sim->results->bar) {
        ct_progress_init(&sim->bar, sim->results->bar,
                         sim->is_followed ? "follow" : "simulate");
        sim->progress = &sim->bar;
    }
    o->progress = at_progress;
    o->forecast = print_forecast;
    o->row = at_row;
    o->want_residual = want_residual;
    o->user = sim;
    const double start = sim->begun = ct_monotonic_time();
    const bool ok = sim->is_followed ? ct_run_kinematic(sim->run, o, &sim->report)
                                     : ct_run_simulate(sim->run, o, &sim->report);
    sim->integrate = ct_monotonic_time() - start - sim->write;
    if (sim->progress)
        ct_progress_finish(sim->progress);
    sim->progress = NULL;
    explain_change(sim);
    return ok;
}

// Warns of near-singular configurations that steps met outside the crossing procedure.
static void warn_of_positions(struct ct_sim *sim)
{
    const struct ct_rank_monitor *w = sim->report.singular;
    // Default: warnings that are missing against warnings of motions that are right.
    // Test: nearly_stopping_guide.
    const double roundoff = 0.1 * DBL_EPSILON;
    const struct ct_mark mark = {.file = sim->system->model.file};
    if (!w)
        return;
    if (w->ncrossed)
        ct_warning(
            &sim->own, mark, 0,
            "steps of fixed size have crossed a singular configuration, or passed near one, at "
            "t = %.9g%s, without detecting it: the motion after it may be another one; without "
            "'step' it is crossed",
            w->t_crossed, w->ncrossed > 1 ? " and more often later" : "");
    // two divisions by a pivot, which is as small as the distance, amplify round-off
    if (w->closest * w->closest * fmax(sim->tolerance, sim->least_rtol) < roundoff)
        ct_warning(
            &sim->own, mark, 0,
            "the motion has come near to a singular configuration at t = %.9g without crossing "
            "it, "
            "within %.1g "
            "of the largest distance: round-off exceeds the tolerance there, and may have led "
            "to another motion",
            w->t_closest, w->closest);
}

// Runs the integration. A run that a callback stopped ends without a diagnostic and counts as
// complete.
static bool run(struct ct_sim *sim)
{
    const struct ct_simulation *m = &sim->system->model.simulation;
    if (sim->has_run)
        return ct_error(&sim->own, (struct ct_mark){0}, CT_E_USAGE, "the run is over already");
    if (!m->has_duration && !(sim->run_options.duration > 0))
        return ct_error(&sim->own, m->mark, CT_E_KEY_MISSING,
                        "there is no end time: 'simulation' needs a 'duration'");
    if (sim->results->path && !sim->system->equations.nresult)
        ct_warning(&sim->own, (struct ct_mark){.file = sim->system->model.file}, 0,
                   "the model lists no 'outputs': only t is written");
    if (sim->results->path && !ct_sim_open_results(sim, sim->results->path))
        return false;
    sim->has_run = true;
    if (sim->is_verified)
        sim->kept = CT_NEWN(sim->own.model, double,
                            sim->run_options.nsample * sim->system->equations.nresult + 1);
    bool ok = integrate(sim) || (sim->own.nerror == 0 && !sim->is_interrupted);
    if (sim->is_interrupted)
        return false;
    const double start = ct_monotonic_time();
    if (ok)
        ct_run_find_undetermined(sim->run, sim->time, sim->report.y, sim->open.row,
                                 sim->open.result);
    if (sim->file)
        ok = ct_sim_close_results(sim, ok);
    sim->write += ct_monotonic_time() - start;
    if (ok) {
        ct_sim_warn_of_beams(sim);
        warn_of_positions(sim);
    }
    if (ok && sim->kept)
        ct_sim_verify(sim);
    sim->is_done = ok;
    return ok;
}

struct work {
    struct ct_ctx *ctx;
    struct ct_sim *sim;
};

static bool run_and_report(void *task)
{
    struct work *w = task;
    const bool ok = run(w->sim);
    ct_ctx_hand_over(w->ctx, &w->sim->own);
    return ok;
}

static bool run_again(void *task)
{
    struct work *w = task;
    struct ct_sim *sim = w->sim;
    sim->has_run = sim->is_done = sim->is_late = sim->is_interrupted = false;
    sim->write = 0;
    sim->nstep = 0;
    const char *singular_joints = ct_run_singular_joints(sim->run);
    if (ct_run_restart(sim->run, &sim->start)) {
        ct_run_note_singular_start(sim->run, singular_joints);
        return run_and_report(task);
    }
    ct_ctx_hand_over(w->ctx, &sim->own);
    return false;
}

bool ct_sim_run_again(struct ct_ctx *ctx, struct ct_sim *sim,
                      const struct ct_sim_results *results)
{
    struct work w = {ctx, sim};
    sim->results = results;
    const bool ok = ct_enter(ctx, run_again, &w);
    sim->results = NULL;
    return ok;
}

bool ct_sim_follow(struct ct_ctx *ctx, struct ct_sim *sim, const struct ct_sim_results *results)
{
    if (sim)
        sim->is_followed = true;
    return ct_sim_run(ctx, sim, results);
}

// Reports the time reached and the files that remain.
static bool report_interrupt(void *task)
{
    struct work *w = task;
    struct ct_sim *sim = w->sim;
    const double end = sim->run_options.duration > 0 ? sim->run_options.duration
                                                     : sim->system->model.simulation.duration;
    if (sim->file)
        ct_sim_interrupt_results(sim);
    const char *partial = ct_sim_results_path(sim, true);
    const char *rows
        = partial && sim->nwritten ? ct_arena_printf(
              sim->own.model, ": the first %ld samples are in '%s'", sim->nwritten, partial)
        : sim->file ? ": nothing is written, as only .csv files keep the samples so far"
                    : "";
    ct_error(
        &sim->own, (struct ct_mark){0}, CT_E_INTERRUPTED,
        "interrupted at t = %.6g s of %.6g s%s; the same command begins anew, with --until "
        "T it ends earlier",
        sim->reached, end, rows);
    ct_ctx_hand_over(w->ctx, &sim->own);
    return false;
}

bool ct_sim_run(struct ct_ctx *ctx, struct ct_sim *sim, const struct ct_sim_results *results)
{
    struct ct_sim_results all;
    struct work w = {ctx, sim};
    if (!ctx || !sim)
        return false;
    ct_options_take(&all, results, sizeof all);
    sim->results = &all;
    const bool ok = ct_enter(ctx, run_and_report, &w);
    if (!ok && ctx->was_interrupted && sim->results->path) {
        if (sim->progress) // the run stepped to this time at an event
            ct_progress_finish(sim->progress);
        sim->progress = NULL;
        ct_enter_uninterrupted(ctx, report_interrupt, &w);
    }
    if (!ok && sim->file) // out of memory: the file is still open
        ct_sim_abandon_results(sim);
    sim->results = NULL;
    return ok;
}

double ct_sim_time(const struct ct_sim *sim)
{
    if (!sim)
        return NAN;
    return sim->time;
}

double ct_sim_value(const struct ct_sim *sim, const char *column)
{
    if (!sim || !column)
        return NAN;
    const struct ct_equations *e = &sim->system->equations;
    for (size_t i = 0; i < e->nresult; i++)
        if (strcmp(e->result[i].name, column) == 0)
            return sim->report.final[i];
    return NAN;
}

double ct_sim_error(const struct ct_sim *sim, const char *column)
{
    if (!sim || !column)
        return NAN;
    const struct ct_equations *e = &sim->system->equations;
    for (size_t i = 0; i < e->nresult && sim->estimate.output; i++)
        if (strcmp(e->result[i].name, column) == 0)
            return sim->estimate.output[i].relative;
    return NAN;
}
