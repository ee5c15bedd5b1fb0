// See simulate.h.
#include "solve/simulate.h"
#include "formulate/flexible.h"
#include "integrate/stiffness.h"
#include "solve/dae.h"
#include "expr/print.h"
#include "solve/mode.h"

#include <math.h>
#include <string.h>

struct ct_run {
    struct ct_ctx *ctx;
    struct ct_arena *arena;
    const struct ct_model *model;
    const struct ct_equations *e;
    struct ct_machine *m;
    struct ct_embed *s;
    size_t ny;
    double *y, *dy, *stage, *scratch, *value;
    double *sign;  // of each state mode's root function at the last event
    double *event; // times
    size_t nevent;
    int *root_of; // state modes, in order
    int nroot;
    bool needs_lam, has_power;
    const struct ct_run_options *o;
    struct ct_run_report *report;
    double energy0, energy_scale;
    double pivot_last, pivot_most, pivot_time, singular_in; // see foresee_singular
    double pending; // time of the event ahead; INFINITY if there is none
    bool started;
    // the choice of the method
    const struct ct_method *method;  // that steps now
    struct ct_integrate_stats stats; // of it
    struct ct_stiffness *stiffness;  // watched for; NULL: not
    struct ct_trial *trial;          // under way
    struct ct_trial implicit;        // what the implicit method gains since it took over
    double explicit_pace;            // what was gained before
    bool is_suspect;                 // steps ended to think of another method
    double t_before, last_event;     // times
    size_t ngiven;                   // samples
    double t_sample;                 // the last one
};

// ---- time ------------------------------------------------------------------------------------------------

// Until an event is done what holds before it counts, also at its very instant: the knots of linear tables have
// no modes that could hold their slopes.
static double before_event(const struct ct_run *r, double t)
{
    return t < r->pending ? t : nextafter(r->pending, -INFINITY);
}

// ---- evaluation -------------------------------------------------------------------------------------------

static enum ct_eval accelerate(struct ct_run *r, double t, const double *y)
{
    ct_machine_set(r->m, t, y);
    const enum ct_eval e = ct_embed_solve(r->s);
    if (e != CT_EVAL_OK)
        return e;
    for (size_t i = 0; i < r->m->nu; i++)
        if (!isfinite(r->s->a[i]))
            return CT_EVAL_RETRY;
    memcpy(r->m->input + r->m->at_a, r->s->a, r->m->nu * sizeof *r->s->a);
    return CT_EVAL_OK;
}

static void multipliers(struct ct_run *r)
{
    ct_embed_multipliers(r->s);
    memcpy(r->m->input + r->m->at_lam, r->s->lam, r->m->nrow * sizeof *r->s->lam);
}

// Stages of a step lie off the manifold by more than its steps do. Beside a singular position that
// little is divided by a small pivot, so there the stage is put onto the manifold first.
// A position counts as near to singular when the smallest pivot has fallen to this part of its largest
// value so far.
static const double singular_pivot = 0.25;

static bool is_near_singular(const struct ct_run *r)
{
    return r->s->rank && r->s->sigma < singular_pivot * r->pivot_most;
}

static enum ct_eval rhs(void *user, double time, const double *y, double *dy)
{
    struct ct_run *r = user;
    const double t = before_event(r, time);
    r->s->is_delicate = is_near_singular(r);
    if (r->s->is_delicate) {
        memcpy(r->stage, y, r->ny * sizeof *y);
        const enum ct_eval p = ct_embed_project(r->s, t, r->stage);
        if (p != CT_EVAL_OK)
            return p;
        y = r->stage;
    }
    const enum ct_eval e = accelerate(r, t, y);
    if (e != CT_EVAL_OK)
        return e;
    memcpy(dy, r->m->rate, r->m->nq * sizeof *dy);
    memcpy(dy + r->m->nq, r->s->a, r->m->nu * sizeof *dy);
    dy[r->ny - 1] = 0;
    if (r->has_power) {
        if (r->needs_lam)
            multipliers(r);
        ct_program_run(&r->m->power, r->m->input);
        dy[r->ny - 1] = r->m->power.out[0];
    }
    return CT_EVAL_OK;
}

static enum ct_eval project(void *user, double t, double *y)
{
    struct ct_run *r = user;
    r->s->is_delicate = is_near_singular(r);
    return ct_embed_project(r->s, before_event(r, t), y);
}

// The smallest pivot of J_d falls about linearly towards a singular position: where it will vanish
// is foreseen from two accepted states.
static void foresee_singular(struct ct_run *r, double t)
{
    const double before = r->pivot_last, dt = t - r->pivot_time;
    r->singular_in = INFINITY;
    r->pivot_last = INFINITY;
    r->pivot_most = fmax(r->pivot_most, r->s->sigma);
    if (!is_near_singular(r))
        return;
    ct_machine_constraint(r->m);
    r->pivot_last = ct_embed_pivot(r->s);
    r->pivot_time = t;
    if (isfinite(before) && before > r->pivot_last && dt > 0)
        r->singular_in = dt * r->pivot_last / (before - r->pivot_last);
}

static double singular_in(void *user)
{
    return ((const struct ct_run *)user)->singular_in;
}

static enum ct_eval accepted(void *user, double t, double *y)
{
    struct ct_run *r = user;
    ct_machine_set(r->m, before_event(r, t), y);
    ct_memory_follow(r->m);
    if (r->method->is_implicit) { // its steps may pass without a projection
        ct_machine_constraint(r->m);
        ct_embed_renew(r->s);
    }
    foresee_singular(r, t);
    return CT_EVAL_OK;
}

// ---- events -------------------------------------------------------------------------------------------------

static enum ct_eval root(void *user, double t, const double *y, double *g)
{
    struct ct_run *r = user;
    ct_machine_set(r->m, before_event(r, t), y);
    ct_program_run(&r->m->root, r->m->input);
    for (int i = 0; i < r->nroot; i++)
        g[i] = r->m->root.out[r->root_of[i]];
    return CT_EVAL_OK;
}

static double next_time_event(void *user, double t)
{
    const struct ct_run *r = user;
    size_t low = 0, high = r->nevent;
    while (low < high) { // first event after t
        const size_t middle = (low + high) / 2;
        if (r->event[middle] > t)
            high = middle;
        else
            low = middle + 1;
    }
    return low < r->nevent ? r->event[low] : INFINITY;
}

static double kinetic_energy(struct ct_run *r, double t, const double *y)
{
    ct_machine_set(r->m, t, y);
    ct_program_run(&r->m->energy, r->m->input);
    return r->m->energy.out[0];
}

// Largest change of driver values and rates between two records (value, rate alternating).
static double largest_jump(const struct ct_run *r, const double *before, int which)
{
    double jump = 0;
    for (size_t i = 0; i < r->e->ndriver; i++)
        jump = fmax(jump, fabs(r->m->driver.out[2 * i + (size_t)which]
                               - before[2 * i + (size_t)which]));
    return jump;
}

static const double jump_tolerance
    = 1e-9; // of a driver's value or rate, beside rounding [rad, m, 1/s]

static bool report_jump(struct ct_run *r, const char *name, struct ct_mark mark, double jump,
                        double t)
{
    return ct_error(
        r->ctx, mark, CT_E_DRIVER_JUMP,
        "the motion '%s' jumps by %.6g at t = %.9g: a place cannot change in no time", name,
        jump, t);
}

// Rows were met before; one that is not any more belongs to a driver on a chord.
static bool chords_are_closed(struct ct_run *r, double t)
{
    const struct ct_row *row = r->e->row;
    for (size_t i = 0; i < r->m->nrow; i++)
        if (fabs(r->m->phi[i]) > jump_tolerance) {
            const struct ct_instance *joint
                = row[i].joint < 0 ? NULL : &r->model->joint[row[i].joint];
            const bool is_driven = joint && joint->cls->motion;
            return report_jump(r, is_driven ? joint->name : row[i].name,
                               is_driven ? ct_instance_value(joint, "motion")->mark
                                         : (struct ct_mark){.file = r->model->file},
                               -r->m->phi[i], t);
        }
    return true;
}

// Driven values after a change of modes; impulse or not, the speeds must fit the new rates.  (8.5)
static enum ct_eval apply_jump(struct ct_run *r, double t, double *y, const double *before,
                               const double *momentum)
{
    struct ct_machine *m = r->m;
    ct_machine_set(m, t, y);
    ct_program_run(&m->driver, m->input);
    for (size_t i = 0; i < r->e->ndriver; i++)
        if (fabs(m->driver.out[2 * i] - before[2 * i])
            > jump_tolerance * fmax(1, fabs(before[2 * i]))) {
            report_jump(r, r->e->driver[i].name, r->e->driver[i].mark,
                        m->driver.out[2 * i] - before[2 * i], t);
            return CT_EVAL_FATAL;
        }
    ct_machine_constraint(m);
    if (!chords_are_closed(r, t))
        return CT_EVAL_FATAL;
    double worst = largest_jump(r, before, 1);
    for (size_t i = 0; i < m->nrow; i++)
        worst = fmax(worst, fabs(m->v[i]));
    if (worst <= jump_tolerance)
        return CT_EVAL_OK;
    if (r->o && r->o->rate_jumps == CT_RATE_CONTINUOUS)
        return ct_embed_project(r->s, t, y);
    // p = momentum before - momentum after, both with the old unknown speeds
    const double *after = m->momentum.out;
    double *p = r->scratch, *u = y + m->nq;
    ct_program_run(&m->momentum, m->input);
    for (size_t i = 0; i < m->nu; i++)
        p[i] = momentum[i] - after[i];
    return ct_embed_impulse(r->s, p, u);
}

// With the modes set: a force that on both sides of its switch leads back to it (dry friction at rest) has no
// motion that f describes.
static enum ct_eval refuse_stuck(struct ct_run *r, double t, const double *y)
{
    if (!r->nroot)
        return CT_EVAL_OK;
    const enum ct_eval e = rhs(r, t, y, r->dy);
    if (e != CT_EVAL_OK)
        return e;
    const int i = ct_modes_find_stuck(r->m, t, y, r->dy);
    if (i < 0)
        return CT_EVAL_OK;
    const struct ct_mode *mode = &r->e->mode[i];
    ct_error(
        r->ctx, mode->mark.file ? mode->mark : (struct ct_mark){.file = r->model->file},
        CT_E_STUCK,
        "at t = %.9g the motion is held where '%s' changes sign: on both sides the forces lead "
        "back; let the force change over a small range, as tanh(u/0.001) does for sign(u)",
        t, ct_ex_text(r->arena, r->e->x, mode->g, NULL));
    return CT_EVAL_FATAL;
}

static enum ct_eval event(void *user, double t, double *y, const signed char *crossed,
                          bool is_time)
{
    struct ct_run *r = user;
    struct ct_machine *m = r->m;
    (void)is_time;
    r->last_event = t;
    double *before = r->scratch + m->nu, *momentum = before + 2 * r->e->ndriver;
    ct_machine_set(m, before_event(r, t), y);
    ct_program_run(&m->driver, m->input);
    memcpy(before, m->driver.out, m->driver.nout * sizeof *before);
    ct_program_run(&m->momentum, m->input);
    memcpy(momentum, m->momentum.out, m->momentum.nout * sizeof *momentum);
    const double kinetic = kinetic_energy(r, before_event(r, t), y);

    // sides: a crossed root tells its own; the rest follow from where the motion leads
    double *mode = m->input + m->at_mode;
    enum ct_eval e = rhs(r, t, y, r->dy);
    if (e != CT_EVAL_OK)
        return e;
    r->pending = next_time_event(r, t);
    ct_modes_start(m, t, y, r->dy);
    for (int i = 0; i < r->nroot; i++)
        if (crossed[i])
            mode[r->root_of[i]] = ct_op_apply(r->e->mode[r->root_of[i]].op, crossed[i], 0, 0);
    e = apply_jump(r, t, y, before, momentum);
    if (e != CT_EVAL_OK)
        return e;
    y[r->ny - 1] += kinetic_energy(r, t, y) - kinetic;
    return refuse_stuck(r, t, y);
}

// ---- creation -------------------------------------------------------------------------------------------------

static bool uses(const struct ct_equations *e, ct_ex v, enum ct_sym_kind kind)
{
    return ct_ex_kinds(e->x, v) & 1u << kind;
}

static void find_needs(struct ct_run *r)
{
    const struct ct_equations *e = r->e;
    r->has_power = !ct_ex_is_zero(e->power);
    r->needs_lam = uses(e, e->power, CT_SYM_LAM);
    r->root_of = CT_NEWN(r->arena, int, e->nmode + 1);
    for (size_t i = 0; i < e->nmode; i++)
        if (!e->mode[i].is_time)
            r->root_of[r->nroot++] = (int)i;
}

struct ct_run *ct_run_create(struct ct_ctx *ctx, struct ct_arena *a,
                             const struct ct_model *model, const struct ct_equations *e,
                             const struct ct_start *start)
{
    struct ct_run *r = CT_NEW(a, struct ct_run);
    *r = (struct ct_run){.ctx = ctx, .arena = a, .model = model, .e = e};
    r->pending = INFINITY;
    r->m = ct_machine_create(a, model, e);
    r->s = ct_embed_create(a, ctx, r->m);
    r->ny = r->m->nq + r->m->nu + 1;
    r->y = CT_NEWN(a, double, r->ny);
    r->dy = CT_NEWN(a, double, r->ny);
    r->stage = CT_NEWN(a, double, r->ny);
    r->scratch = CT_NEWN(a, double, 2 * r->m->nu + 2 * e->ndriver + 1);
    r->value = CT_NEWN(a, double, e->nresult + 1);
    find_needs(r);
    ct_start_apply(start, r->m, r->y);
    ct_machine_constraint(r->m);
    if (!ct_embed_choose(r->s))
        return NULL;
    // measured on other trees, the loops close to rounding; the rest is taken off here
    if (ct_embed_project(r->s, 0, r->y) != CT_EVAL_OK) {
        ct_error(ctx, (struct ct_mark){.file = model->file}, CT_E_ASSEMBLY,
                 "the assembled start is singular: the loops cannot be held there");
        return NULL;
    }
    if (rhs(r, 0, r->y, r->dy) != CT_EVAL_OK) {
        ct_error(ctx, (struct ct_mark){.file = model->file}, CT_E_SINGULAR,
                 "the accelerations at t = 0 cannot be found");
        return NULL;
    }
    ct_modes_start(r->m, 0, r->y, r->dy);
    return r;
}

struct ct_machine *ct_run_machine(struct ct_run *r)
{
    return r->m;
}

struct ct_embed *ct_run_embed(struct ct_run *r)
{
    return r->s;
}

const double *ct_run_state(const struct ct_run *r)
{
    return r->y;
}

enum ct_eval ct_run_results(struct ct_run *r, double t, const double *y, double *out)
{
    const enum ct_eval e = accelerate(r, t, y);
    if (e != CT_EVAL_OK)
        return e;
    multipliers(r);
    ct_program_run(&r->m->result, r->m->input);
    memcpy(out, r->m->result.out, r->e->nresult * sizeof *out);
    return CT_EVAL_OK;
}

// ---- the run ------------------------------------------------------------------------------------------------------

static double largest(const double *v, size_t n)
{
    double max = 0;
    for (size_t i = 0; i < n; i++)
        max = fmax(max, fabs(v[i]));
    return max;
}

// Energy, constraints: the ledger of a sample.
static void keep_ledger(struct ct_run *r, const double *y)
{
    ct_program_run(&r->m->energy, r->m->input);
    const double kinetic = r->m->energy.out[0], potential = r->m->energy.out[1];
    const double total = kinetic + potential - y[r->ny - 1];
    if (!r->started)
        r->energy0 = total;
    r->started = true;
    r->energy_scale = fmax(r->energy_scale, fmax(fabs(kinetic), fabs(potential)));
    if (r->energy_scale > 0)
        r->report->energy_drift = fmax(r->report->energy_drift, fabs(total - r->energy0));
    ct_machine_constraint(r->m);
    r->report->position_constraint
        = fmax(r->report->position_constraint, largest(r->m->phi, r->m->nrow));
    r->report->velocity_constraint
        = fmax(r->report->velocity_constraint, largest(r->m->v, r->m->nrow));
}

// Indicators of linear beams, averaged over a period of the beam: what rings faster than it can follow does not count.
static void watch_validity(struct ct_run *r, double t)
{
    if (!r->e->nvalidity)
        return;
    ct_program_run(&r->m->validity, r->m->input);
    for (size_t i = 0; i < r->e->nvalidity; i++) {
        struct ct_validity_report *v = &r->report->validity[i];
        const double period = 6.283185307179586 / r->e->validity[i].omega;
        const double share = r->ngiven ? -expm1(-(t - r->t_sample) / period) : 1;
        v->mean += share * (r->m->validity.out[i] - v->mean);
        v->largest = fmax(v->largest, fabs(v->mean));
        if (v->largest > CT_VALIDITY_LIMIT && v->left_at < 0)
            v->left_at = t;
    }
    r->t_sample = t;
}

static bool at_sample(void *user, double t, const double *y)
{
    struct ct_run *r = user;
    if (ct_run_results(r, t, y, r->value) != CT_EVAL_OK)
        return ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SINGULAR,
                        "the equations are singular at t = %.9g", t);
    for (size_t i = 0; i < r->e->nresult; i++)
        if (!isfinite(r->value[i]))
            return ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SINGULAR,
                            "the output '%s' has no finite value at t = %.9g",
                            r->e->result[i].name, t);
    keep_ledger(r, y);
    watch_validity(r, t);
    r->ngiven++;
    memcpy(r->report->final, r->value, r->e->nresult * sizeof *r->value);
    return !r->o->row || r->o->row(r->o->user, t, r->value, r->e->nresult);
}

// After an event, and next to a singular position, steps had better go on.
static bool is_to_be_reconsidered(struct ct_run *r, double t, const double *y)
{
    const bool may_stop = t > r->last_event && !is_near_singular(r);
    if (r->method->is_implicit)
        return ct_trial_has_lost(&r->implicit, t, r->explicit_pace) && may_stop;
    return ct_stiffness_watch(r->stiffness, t, y, r->o->duration) && may_stop;
}

static bool at_step(void *user, double t, const double *y)
{
    struct ct_run *r = user;
    if (r->o->progress && !r->o->progress(r->o->user, t, r->o->duration))
        return false;
    r->is_suspect = r->stiffness && is_to_be_reconsidered(r, t, y);
    if (!r->is_suspect)
        r->t_before = t;
    return !r->is_suspect;
}

// Results along one vector z of null(J'): those that change depend on the choice of multipliers.
static void compare_results(struct ct_run *r, const double *z, double *value, bool *result)
{
    const double change_tolerance = 1e-9; // of a result against its size; z is of order one
    double *lam = r->m->input + r->m->at_lam, largest_lam = 1;
    for (size_t i = 0; i < r->m->nrow; i++)
        largest_lam = fmax(largest_lam, fabs(lam[i]));
    ct_program_run(&r->m->result, r->m->input);
    memcpy(value, r->m->result.out, r->e->nresult * sizeof *value);
    for (size_t i = 0; i < r->m->nrow; i++)
        lam[i] += largest_lam * z[i];
    ct_program_run(&r->m->result, r->m->input);
    for (size_t i = 0; i < r->e->nresult; i++)
        result[i] |= fabs(r->m->result.out[i] - value[i])
                   > change_tolerance * fmax(largest_lam, fabs(value[i]));
    for (size_t i = 0; i < r->m->nrow; i++)
        lam[i] = r->s->lam[i];
}

void ct_run_find_open(struct ct_run *r, double t, const double *y, bool *row, bool *result)
{
    for (size_t i = 0; i < r->e->nresult; i++)
        result[i] |= r->e->result[i].undetermined;
    if (r->s->rank == (int)r->m->nrow || accelerate(r, t, y) != CT_EVAL_OK)
        return;
    multipliers(r);
    ct_machine_constraint(r->m);
    ct_embed_uniqueness(r->s);
    double *z = CT_NEWN(r->arena, double, r->m->nrow);
    for (size_t i = 0; i < r->m->nrow; i++) {
        if (r->s->is_unique[i])
            continue;
        row[i] = true;
        ct_embed_null_vector(r->s, (int)i, z);
        compare_results(r, z, r->value, result);
    }
}

// ---- the choice of the method ---------------------------------------------------------------------------------

static bool at_trial_step(void *user, double t, const double *y)
{
    struct ct_run *r = user;
    (void)y;
    return ct_trial_step(r->trial, t);
}

static double operations(const struct ct_program *p)
{
    const struct ct_tape_counts c = ct_tape_counts(p->tape);
    return (double)(c.multiplications + c.additions + c.divisions + c.functions);
}

static double operations_of_accelerations(const struct ct_run *r)
{
    if (r->m->solved.nout)
        return operations(&r->m->solved);
    if (r->s->has_form)
        return operations(&r->s->form[0]->solved);
    return operations(&r->m->motion) + ct_embed_operations(r->s);
}

// Arithmetic operations, and some that stand for calls, copies and vectors: as measured on systems of few operations.
static struct ct_cost find_cost(const struct ct_run *r)
{
    const struct ct_machine *m = r->m;
    const double explicit_overhead = 150, implicit_overhead = 400;
    const double n = (double)m->nu + 2. * r->s->rank;
    const double lu = 2. / 3 * n * n * n, solve = 2 * n * n, complex_also = 5;
    return (struct ct_cost){
        .evaluation = operations_of_accelerations(r) + explicit_overhead,
        // three residuals make a correction
        .residual = operations(&m->residual) + complex_also * solve / 3 + implicit_overhead,
        .tangent = operations(&m->tangent) + 4 * n * n + implicit_overhead,
        .factorization = complex_also * lu / 2 + implicit_overhead, // one of the two
    };
}

// Time that the implicit method gains for its work, from here; nothing has changed afterwards.
static double try_implicit(struct ct_run *r, const struct ct_problem *p,
                           const struct ct_integrate_options *io, const struct ct_cost *cost)
{
    struct ct_machine *m = r->m;
    struct ct_integrate_options trial_io = *io;
    struct ct_trial trial = {.cost = *cost, .stats = &r->stats};
    const size_t ndiagnostic = r->ctx->ndiagnostic, nerror = r->ctx->nerror;
    const double pending = r->pending;
    double *y = CT_NEWN(r->arena, double, r->ny), *input = CT_NEWN(r->arena, double, m->ninput);
    memcpy(y, r->y, r->ny * sizeof *y);
    memcpy(input, m->input, m->ninput * sizeof *input);
    trial_io.nsample = 0;
    trial_io.at_step = at_trial_step;
    r->trial = &trial;
    ct_integrate(r->ctx, r->o->stiff_method, p, &trial_io, y, &r->stats);
    r->trial = NULL;
    // a trial may fail, and may have met events: all that is as if it had not been
    r->ctx->ndiagnostic = ndiagnostic;
    r->ctx->nerror = nerror;
    r->pending = pending;
    memcpy(m->input, input, m->ninput * sizeof *input);
    ct_machine_set(m, io->t0, r->y);
    ct_machine_constraint(m);
    ct_embed_renew(r->s);
    return ct_trial_pace(&trial);
}

// Over to the implicit method if it gets farther for its work. True: it does.
static bool go_implicit(struct ct_run *r, struct ct_problem *p,
                        const struct ct_integrate_options *io)
{
    const double least_gain = 1.5; // what is counted is not quite what is spent
    struct ct_run_report *report = r->report;
    if (!p->dae) {
        r->o->want_residual(r->o->user);
        ct_machine_add_residual(r->arena, r->m);
        p->dae = ct_dae_create(r->arena, r->s);
    }
    r->method = r->o->stiff_method; // what follows a step depends on it
    const struct ct_cost cost = find_cost(r);
    r->explicit_pace = ct_stiffness_pace(r->stiffness, &cost);
    const double gain = try_implicit(r, p, io, &cost) / r->explicit_pace;
    if (gain < least_gain) {
        r->method = r->o->method;
        return false;
    }
    r->implicit = (struct ct_trial){.cost = cost, .stats = &r->stats, .t0 = io->t0};
    if (isnan(report->changed_at)) {
        report->changed_at = io->t0;
        report->fast = r->stiffness->fast;
        report->slow = r->stiffness->slow;
        report->gain = gain;
    }
    report->returned_at = NAN;
    return true;
}

// Steps have ended at io->t0: which method is to go on?
static void reconsider(struct ct_run *r, struct ct_problem *p, struct ct_integrate_options *io)
{
    io->rtol = r->o->stiff_rtol;
    io->atol = r->o->stiff_atol;
    io->first_step = r->method->is_implicit ? 0 : io->t0 - r->t_before;
    if (!r->method->is_implicit && go_implicit(r, p, io)) {
        io->first_step = 0;
    } else {
        if (r->method->is_implicit)
            r->report->returned_at = io->t0;
        r->method = r->o->method;
        io->rtol = r->o->rtol;
        io->atol = r->o->atol;
        ct_stiffness_put_off(r->stiffness);
    }
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
}

// From start to end, with another method from where that pays.
static bool march(struct ct_run *r, struct ct_problem *p, struct ct_integrate_options io)
{
    const double *sample = io.sample;
    if (r->o->stiff_method && io.step == 0)
        r->stiffness = ct_stiffness_create(r->arena, p, &r->stats, (int)r->m->nq,
                                           (int)(r->m->nq + r->m->nu));
    for (;;) {
        r->is_suspect = false;
        const bool ok = ct_integrate(r->ctx, r->method, p, &io, r->y, &r->stats);
        add_stats(&r->report->stats, &r->stats);
        if (!ok || !r->is_suspect)
            return ok;
        io.t0 = r->stats.last_time;
        io.sample = sample + r->ngiven;
        io.nsample = r->o->nsample - r->ngiven;
        reconsider(r, p, &io);
        add_stats(&r->report->stats, &r->stats);
        r->stats = (struct ct_integrate_stats){0};
        r->t_before = io.t0;
    }
}

// Displacements of a beam along its axis, those across, rotations and the rates of each are measured by the largest of
// their kind. Those along are much smaller than those across, but forces come from them.
static const struct ct_groups *group_states(struct ct_run *r)
{
    struct ct_groups *g = CT_NEW(r->arena, struct ct_groups);
    int *of = CT_NEWN(r->arena, int, r->ny);
    const struct ct_u *before = NULL;
    for (size_t i = 0; i < r->ny; i++)
        of[i] = -1;
    for (size_t k = 0; k < r->e->nu; k++) {
        const struct ct_u *u = &r->e->u[k];
        if (!u->beam)
            continue;
        if (!before || before->beam != u->beam) // a beam's coordinates follow each other
            g->n += 2 * CT_NELASTIC;
        before = u;
        of[u->q] = g->n - 1 - (int)u->kind;
        of[r->e->nq + k] = of[u->q] - CT_NELASTIC;
    }
    g->of = of;
    g->size = CT_NEWN(r->arena, double, g->n + 1);
    return g->n ? g : NULL;
}

bool ct_run_simulate(struct ct_run *r, const struct ct_run_options *o,
                     struct ct_run_report *report)
{
    const size_t n = o->nsample;
    if (o->method->is_implicit && !r->e->residual)
        return ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_INTEGRATE_OPTION,
                        "the method '%s' is implicit: it needs equations with their residual",
                        o->method->name);
    double *sample = CT_NEWN(r->arena, double, n + 1);
    bool *watched = CT_NEWN(r->arena, bool, r->ny);
    for (size_t i = 0; i < n; i++)
        sample[i]
            = n == 1 || i + 1 == n ? o->duration : o->duration * (double)i / (double)(n - 1);
    if (n == 1)
        sample[0] = 0;
    for (size_t i = 0; i < r->ny; i++)
        watched[i] = i + 1 < r->ny || r->has_power; // the work is as good as the states
    *report
        = (struct ct_run_report){.method = o->method, .changed_at = NAN, .returned_at = NAN};
    report->final = CT_NEWN(r->arena, double, r->e->nresult + 1);
    report->validity = CT_NEWN(r->arena, struct ct_validity_report, r->e->nvalidity + 1);
    for (size_t i = 0; i < r->e->nvalidity; i++)
        report->validity[i].left_at = -1;
    r->pivot_last = r->singular_in = INFINITY;
    r->o = o;
    r->method = o->method;
    r->last_event = -INFINITY;
    r->report = report;
    r->nevent = ct_time_events(r->arena, r->m, 0, o->duration, &r->event);
    r->pending = next_time_event(r, 0);
    ct_modes_start(r->m, 0, r->y, r->dy);
    if (refuse_stuck(r, 0, r->y) == CT_EVAL_FATAL)
        return false;
    struct ct_problem p = {.user = r,
                           .ny = (int)r->ny,
                           .dae = o->method->is_implicit ? ct_dae_create(r->arena, r->s) : NULL,
                           .watched = watched,
                           .groups = group_states(r),
                           .rhs = rhs,
                           .project = project,
                           .accepted = accepted,
                           .singular_in = singular_in,
                           .nroot = r->nroot,
                           .root = root,
                           .next_time_event = next_time_event,
                           .event = event};
    const struct ct_integrate_options io = {.t1 = o->duration,
                                            .rtol = o->rtol,
                                            .atol = o->atol,
                                            .step = o->step,
                                            .sample = sample,
                                            .nsample = n,
                                            .at_sample = at_sample,
                                            .at_step = at_step};
    const bool ok = march(r, &p, io);
    report->rank = r->s->rank;
    report->switches = r->s->switches;
    report->solves = r->s->solves;
    report->factorizations = r->s->factorizations + report->stats.factorizations;
    report->y = r->y;
    if (r->energy_scale > 0)
        report->energy_drift /= r->energy_scale;
    return ok;
}
