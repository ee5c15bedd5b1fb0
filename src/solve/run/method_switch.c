// Method switching on stiffness during a run. When the motion becomes stiff, explicit steps end and
// an implicit method is tried from there. The method that advances more for its work goes on.
// (section 8.1)
#include "solve/run/run_internal.h"

#include "integrate/implicit/newton_sparse.h"
#include "numeric/dense.h"
#include "solve/constraint/dae.h"

#include <float.h>
#include <math.h>
#include <string.h>

// A vibration with a smaller part in all outputs does not limit the steps.
// Derived: measured steps lose 50 T of a vibration over 2e5 rad; with this part that is half of T in
// outputs.
static const double noticed = 0.01;

// The step with which an explicit method has an error of T in outputs at the end, from the phase of
// the fast vibrations that it resolves.  (8.14)
static double wanted_step(const struct ct_run *r)
{
    const double fast = r->method->is_implicit ? 0 : r->stiffness->fast;
    return fast > 0 && r->vibration_effect > noticed ? ct_stiffness_accurate_step(
               r->method, fast, r->o->duration, r->o->output_rtol / r->vibration_effect)
                                                     : INFINITY;
}

static double accurate_step(void *user)
{
    const struct ct_run *r = user;
    const double stable
        = r->method->is_implicit ? INFINITY : ct_stiffness_stable_step(r->stiffness, r->method);
    return fmin(r->has_turns ? ct_run_longest_step(user) : INFINITY,
                fmin(stable, wanted_step(r)));
}

// The largest relative change of outputs for a change e (ny) of y. Outputs that are hardly more
// than round-off do not count.
static double change_of_outputs(struct ct_run *r, double t, const double *y, const double *e)
{
    const double place = DBL_EPSILON * ct_vector_largest(y, r->m->nq),
                 speed = r->stiffness->fast * place;
    double most = r->output_error ? ct_output_error_of_change(r->output_error, t, y, e, 0) : 0;
    for (size_t i = 0; i < r->e->nresult; i++)
        for (size_t k = 0; k + 1 < r->ny; k++) {
            const bool is_place = k < r->m->nq;
            const ct_ex state = is_place ? r->e->q[k].symbol : r->e->u[k - r->m->nq].symbol;
            const double size = fmax(fabs(y[k]), r->largest[i]);
            if (r->e->result[i].value.id == state.id && e[k] != 0
                && size >= ct_output_error_least_size * (is_place ? place : speed))
                most = fmax(most, fabs(e[k]) / size);
        }
    return most;
}

// The part of an output that is due to vibrations much faster than the motion, which the explicit
// method resolves; at most 1, which is assumed for sensitive outputs. Vibrations that are damped
// out by the end do not count.
static double find_vibration_effect(struct ct_run *r, double t, const double *y)
{
    const double before = ct_run_time_before_event(r, t), *e, *later;
    if (r->stiffness->has_decayed)
        return 0;
    if (r->has_sensitive_outputs)
        return 1;
    if (!ct_stiffness_find_vibration(r->stiffness, t, y, r->method->order, &e, &later))
        return 0;
    const double change
        = hypot(change_of_outputs(r, before, y, e), change_of_outputs(r, before, y, later));
    ct_evaluator_set(r->m, before, y);
    return fmin(change, 1);
}

// No change of the method right after an event or near a singular configuration.
bool ct_run_suspects_stiffness(struct ct_run *r, double t, const double *y)
{
    const bool may_stop = t > r->last_event && !(r->singular->time_to_singular < INFINITY);
    struct ct_stiffness *s = r->stiffness;
    if (r->method->is_implicit) {
        const bool is_slower
            = ct_trial_is_slower(&r->implicit, t, r->last_event, r->explicit_time_per_work);
        return (is_slower || r->has_jumped) && may_stop;
    }
    s->excited = r->last_event;
    const bool is_suspect = ct_stiffness_detect(s, t, y, r->o->duration);
    if (ct_stiffness_has_tested(s))
        r->vibration_effect = find_vibration_effect(r, t, y);
    // steps after a positive test are those that the trial is compared with
    r->resolves_vibrations
        = (s->step > wanted_step(r) || (ct_stiffness_is_unstable(s) && !is_suspect))
       && r->problem->longest_step != accurate_step;
    return (is_suspect || r->resolves_vibrations) && may_stop;
}

static bool at_trial_step(void *user, double t, const double *y)
{
    struct ct_run *r = user;
    (void)y;
    return ct_trial_step(r->trial, t);
}

static double operations(const struct ct_program *p)
{
    const struct ct_tape_counts c = p->listing->counts;
    return (double)(c.multiplications + c.additions + c.divisions + c.functions);
}

static double operations_of_accelerations(const struct ct_run *r)
{
    if (r->m->solved.nout)
        return operations(&r->m->solved);
    if (r->s->has_solver)
        return r->s->solver[0]->operations;
    return operations(&r->m->motion) + ct_partition_operations(r->s);
}

// Cost of the methods in arithmetic operations, with an overhead for calls, copies and vectors.
static struct ct_cost find_cost(const struct ct_run *r)
{
    const struct ct_evaluator *m = r->m;
    // Derived: measured on systems with few operations
    const double explicit_overhead = 150, implicit_overhead = 400;
    const struct ct_newton_work w
        = ct_newton_work(r->problem->dae->plan[1], (int)m->nu + 2 * r->s->rank);
    const double complex_also
        = 5; // Derived: one real system, and a complex one of four times the work
    return (struct ct_cost){
        .evaluation = operations_of_accelerations(r) + explicit_overhead,
        // three residuals make a correction
        .residual
        = operations(&m->residual) + complex_also * w.solution / 3 + implicit_overhead,
        .tangent = ct_evaluator_tangent_operations(m) + w.assembly + implicit_overhead,
        .factorization
        = complex_also * w.factorization / 2 + implicit_overhead, // one of the two
    };
}

// Trial of the implicit method from the present state, with a first step of `first_step`: returns
// the time that it advances per work. The state of the run is the same afterwards.
static double try_implicit(struct ct_run *r, const struct ct_problem *p,
                           const struct ct_integrate_options *io, double first_step)
{
    struct ct_evaluator *m = r->m;
    struct ct_integrate_options trial_io = *io;
    struct ct_trial trial = {.cost = r->implicit.cost,
                             .stats = &r->stats,
                             .start = io->t0,
                             .end = io->t1,
                             .must_damp = r->stiffness->is_far && !r->stiffness->has_decayed};
    const size_t ndiagnostic = r->ctx->ndiagnostic, nerror = r->ctx->nerror;
    const double pending = r->pending, angle_rate = r->angle_rate,
                 t_angle_rate = r->t_angle_rate;
    const struct ct_rank_monitor singular = *r->singular; // no configuration is near
    double *y = CT_NEWN(r->arena, double, r->ny), *input = CT_NEWN(r->arena, double, m->ninput);
    memcpy(y, r->y, r->ny * sizeof *y);
    memcpy(input, m->input, m->ninput * sizeof *input);
    trial_io.nsample = 0;
    trial_io.over_step = NULL;
    trial_io.first_step = first_step;
    trial_io.at_step = at_trial_step;
    r->trial = &trial;
    ct_integrate(r->ctx, r->o->stiff_method, p, &trial_io, y, &r->stats);
    r->trial = NULL;
    // a trial may fail or meet events: restore what it has changed
    r->ctx->ndiagnostic = ndiagnostic;
    r->ctx->nerror = nerror;
    r->pending = pending;
    r->angle_rate = angle_rate;
    r->t_angle_rate = t_angle_rate;
    *r->singular = singular;
    ct_rank_monitor_set_crossing(r->singular, false);
    memcpy(m->input, input, m->ninput * sizeof *input);
    ct_evaluator_set(m, io->t0, r->y);
    ct_evaluator_constraint(m);
    ct_partition_renew(r->s);
    r->spent = ct_trial_work(&trial);
    return ct_trial_time_per_work(&trial);
}

// Prepare the implicit method, and measure the time per work of the explicit one to compare with.
static void prepare_implicit(struct ct_run *r, struct ct_problem *p)
{
    if (!p->dae) {
        r->o->want_residual(r->o->user);
        ct_evaluator_add_residual(r->arena, r->m);
        p->dae = ct_dae_create(r->arena, r->s);
    }
    r->method = r->o->stiff_method; // the functions called after a step depend on the method
    r->s->nearness = 1;
    r->implicit.cost = find_cost(r);
    r->explicit_time_per_work = ct_stiffness_time_per_work(r->stiffness, &r->implicit.cost);
}

// The implicit method takes over. gain: NAN if there was no trial.
static void take_implicit(struct ct_run *r, struct ct_integrate_options *io, double gain)
{
    struct ct_run_report *report = r->report;
    io->first_step = 0;
    io->rtol = r->o->stiff_rtol;
    io->atol = r->o->stiff_atol;
    r->implicit = (struct ct_trial){
        .cost = r->implicit.cost, .stats = &r->stats, .t0 = io->t0, .window.t = io->t0};
    if (isnan(report->changed_at)) {
        report->changed_at = io->t0;
        report->fast = r->stiffness->fast;
        report->slow = r->stiffness->slow;
        report->gain = gain;
    }
    report->returned_at = NAN;
    report->method = r->method;
}

// The first step of a trial. If fast vibrations have died out it is the step with which the
// implicit method would win. From the step of the explicit method it would grow for most of the
// trial, or not at all if errors are round-off.
static double first_of_trial(const struct ct_run *r, const struct ct_integrate_options *io,
                             double least_gain)
{
    const double winning
        = least_gain * r->explicit_time_per_work * ct_cost_step(&r->implicit.cost);
    return r->stiffness->has_decayed ? fmax(io->first_step, winning) : io->first_step;
}

// Change to the implicit method if it advances more for its work; true if it does. After a jump of
// speeds, which excites vibrations, the trial says nothing and the explicit method goes on.
static bool switch_to_implicit(struct ct_run *r, struct ct_problem *p,
                               struct ct_integrate_options *io)
{
    // The gain must be clearly above 1: operations are not exactly time, and errors of the implicit
    // method are larger, more so if it does not resolve vibrations. A slider-crank with flexible
    // rods gained no time with a gain of 2.8, and its error was the tolerance instead of a
    // thousandth of it. Explicit steps at the limit of stability do not resolve the vibrations
    // either.
    const bool gives_up = r->stiffness->is_far && !r->stiffness->has_decayed
                       && !ct_stiffness_is_unstable(r->stiffness);
    const double least_gain = gives_up ? 5 : 2;
    prepare_implicit(r, p);
    const double gain
        = try_implicit(r, p, io, first_of_trial(r, io, least_gain)) / r->explicit_time_per_work;
    if (gain < least_gain) {
        r->method = r->o->method;
        return false;
    }
    take_implicit(r, io, gain);
    return true;
}

// Steps have ended at io->t0: choose the method to go on with.
static void consider_explicit(struct ct_run *r, struct ct_problem *p,
                              struct ct_integrate_options *io)
{
    io->rtol = r->o->stiff_rtol;
    io->atol = r->o->stiff_atol;
    const bool was_implicit = r->method->is_implicit;
    io->first_step = was_implicit ? 0 : io->t0 - r->t_before;
    if (was_implicit || !switch_to_implicit(r, p, io)) {
        if (was_implicit)
            r->report->returned_at = io->t0;
        r->method = r->o->method;
        io->rtol = r->o->rtol;
        io->atol = r->o->atol;
        ct_stiffness_postpone(r->stiffness, io->t0, was_implicit ? 0 : r->spent,
                              &r->implicit.cost);
        if (was_implicit && !r->has_jumped)
            ct_stiffness_compare_with(r->stiffness, r->implicit.time_per_work,
                                      &r->implicit.cost);
    }
    r->has_jumped = false;
    r->report->method = r->method;
}

static void add_stats(struct ct_integrate_stats *sum, const struct ct_integrate_stats *s)
{
    sum->steps += s->steps;
    sum->rejected_steps += s->rejected_steps;
    sum->inaccurate_steps += s->inaccurate_steps;
    sum->evaluations += s->evaluations;
    sum->jacobians += s->jacobians;
    sum->factorizations += s->factorizations;
    sum->events += s->events;
    sum->last_time = s->last_time;
    sum->last_rtol = s->last_rtol;
}

// With sensitive outputs the run begins with the implicit method if no vibrations are excited yet.
// An explicit method does not damp the errors of fast vibrations, and sensitive outputs amplify
// them long before stiffness is detected. The implicit method goes on as long as it is not slower
// than the explicit one, with the steps that such outputs ask for.
static bool begins_implicit(struct ct_run *r, const struct ct_run_options *o,
                            struct ct_stiffness *stiffness)
{
    const struct ct_tolerance tolerance = {o->rtol, o->atol};
    const double *y = ct_run_state(r);
    if (!r->output_error || !o->method->tableau)
        return false;
    const double before = ct_run_time_before_event(r, r->t0);
    const bool is_due
        = ct_output_error_has_sensitive(r->output_error, before, y, &tolerance)
       && ct_stiffness_predict(stiffness, r->t0, y, o->duration, o->method, o->rtol);
    ct_evaluator_set(r->m, before, y);
    ct_evaluator_constraint(r->m);
    ct_partition_renew(r->s);
    return is_due;
}

static enum ct_eval rhs(void *user, double t, const double *y, double *dy)
{
    return ct_run_rhs(user, t, y, dy);
}

bool ct_run_begins_implicit(struct ct_run *r, const struct ct_run_options *o)
{
    const int nq = (int)r->m->nq, last = nq + (int)r->m->nu;
    if (!o->stiff_method || o->step > 0)
        return false;
    if (!r->start_stiffness) {
        struct ct_problem *p = CT_NEW(r->arena, struct ct_problem);
        *p = (struct ct_problem){.user = r, .ny = (int)r->ny, .rhs = rhs};
        r->start_stiffness
            = ct_stiffness_create(r->arena, p, &r->stats, o->output_rtol, nq, last);
    }
    r->start_stiffness->fast = 0; // forget earlier runs
    return begins_implicit(r, o, r->start_stiffness);
}

// Integrate from start to end, and change the method when that pays.
bool ct_run_integrate(struct ct_run *r, struct ct_problem *p, struct ct_integrate_options io)
{
    const double *sample = io.sample;
    r->problem = p;
    if (r->o->stiff_method && io.step == 0)
        r->stiffness = ct_stiffness_create(r->arena, p, &r->stats, r->o->output_rtol,
                                           (int)r->m->nq, (int)(r->m->nq + r->m->nu));
    r->has_sensitive_outputs = r->stiffness && begins_implicit(r, r->o, r->stiffness);
    r->vibration_effect = r->has_sensitive_outputs ? 1 : 0;
    if (r->has_sensitive_outputs) {
        prepare_implicit(r, p);
        take_implicit(r, &io, NAN);
        p->longest_step = accurate_step;
    }
    for (;;) {
        r->is_suspect = false;
        const bool ok = ct_integrate(r->ctx, r->method, p, &io, r->y, &r->stats);
        add_stats(&r->report->stats, &r->stats);
        if (!r->method->is_implicit)
            r->report->explicit_steps += r->stats.steps;
        if (!ok || !r->is_suspect)
            return ok;
        io.t0 = r->stats.last_time;
        io.sample = sample + r->ngiven;
        io.nsample = r->o->nsample - r->ngiven;
        if (r->resolves_vibrations) {
            r->resolves_vibrations = false;
            p->longest_step = accurate_step;
            io.first_step = io.t0 - r->t_before;
            r->stiffness->window_evaluations = 0; // the count restarts at the next step
        } else {
            consider_explicit(r, p, &io);
            add_stats(&r->report->stats, &r->stats);
        }
        r->stats = (struct ct_integrate_stats){0};
        r->t_before = io.t0;
    }
}
