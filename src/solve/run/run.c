// See run.h; run_internal.h says where the rest is.
#include "solve/run/run_internal.h"

#include "formulate/beam/flexible_body.h"
#include "numeric/dense.h"
#include "numeric/roundoff.h"
#include "solve/constraint/dae.h"

#include <float.h>
#include <string.h>

// ---- evaluation ----------------------------------------

void ct_run_find_multipliers(struct ct_run *r)
{
    ct_partition_multipliers(r->s);
    memcpy(r->m->input + r->m->at_lam, r->s->lam, r->m->nrow * sizeof *r->s->lam);
}

static enum ct_eval rhs(void *user, double time, const double *y, double *dy)
{
    struct ct_run *r = user;
    const double t = ct_run_time_before_event(r, time);
    const enum ct_eval e = ct_partition_accelerate_at(r->s, t, y);
    if (e != CT_EVAL_OK)
        return e;
    ct_evaluator_copy(dy, r->m->rate, r->m->nq);
    ct_evaluator_copy(dy + r->m->nq, r->s->a, r->m->nu);
    dy[r->ny - 1] = 0;
    if (r->has_power) {
        if (r->needs_lam)
            ct_run_find_multipliers(r);
        ct_program_run(&r->m->power, r->m->input);
        dy[r->ny - 1] = r->m->power.out[0];
    }
    return CT_EVAL_OK;
}

static enum ct_eval project(void *user, double t, double *y)
{
    struct ct_run *r = user;
    return ct_partition_project(r->s, ct_run_time_before_event(r, t), y);
}

// Rows, or quaternions of unit length.
static bool has_constraints(const struct ct_run *r)
{
    bool has = r->m->nrow > 0;
    for (size_t i = 0; i < r->e->nq; i++)
        has |= r->e->q[i].quaternion == 0;
    return has;
}

static double output_error(void *user, double t, const double *y, const double *e,
                           const struct ct_tolerance *tolerance, double states)
{
    struct ct_run *r = user;
    return ct_output_error_of_step(r->output_error, ct_run_time_before_event(r, t), y, e,
                                   tolerance, states, r->method->is_implicit);
}

static double output_change(void *user, double t, const double *y, const double *e,
                            double least)
{
    struct ct_run *r = user;
    return ct_output_error_of_change(r->output_error, ct_run_time_before_event(r, t), y, e,
                                     least);
}

static void predict_output(void *user, double t, const double *y, const double *way,
                           double times)
{
    struct ct_run *r = user;
    ct_output_error_expect_size(r->output_error, ct_run_time_before_event(r, t), y, way, times);
}

static double sensitive_output_error(void *user, double t, const double *y, const double *e,
                                     const struct ct_tolerance *tolerance, double states)
{
    struct ct_run *r = user;
    if (!r->method->is_implicit)
        return 0;
    return ct_output_error_of_sensitive(r->output_error, ct_run_time_before_event(r, t), y, e,
                                        tolerance, states);
}

// A followed angle that turns faster at the end of a step than at its start must still stay within
// half a turn. Derived: steps aim at two thirds of what is accepted, and that is below pi.
static const double aimed_turn = 2, most_turn = 3; // [rad]

static double angle_rate(struct ct_run *r, double t, const double *y)
{
    // time over which angles are compared: a part of the run, or [s]
    const double dt = CT_HALF_DIGITS * (r->o ? fmin(1, r->o->duration) : 1);
    return ct_memory_angle_rate(r->m, ct_run_time_before_event(r, t), y,
                                dt > 0 ? dt : CT_HALF_DIGITS);
}

void ct_run_store_angle_rate(struct ct_run *r, double t, const double *y)
{
    r->angle_rate = angle_rate(r, t, y);
    r->t_angle_rate = t;
}

double ct_run_longest_step(void *user)
{
    const struct ct_run *r = user;
    return r->angle_rate > 0 ? aimed_turn / r->angle_rate : INFINITY;
}

bool ct_run_turns_are_followed(struct ct_run *r, double t, const double *y)
{
    if (!r->has_turns)
        return true;
    const double now = angle_rate(r, t, y);
    if ((t - r->t_angle_rate) * fmax(now, r->angle_rate) > most_turn)
        return false;
    r->angle_rate = now;
    r->t_angle_rate = t;
    return true;
}

static enum ct_eval accepted(void *user, double t, const double *y, const double *dy,
                             bool is_across)
{
    struct ct_run *r = user;
    const double angle_rate_before = r->angle_rate, t_before = r->t_angle_rate;
    if (!r->m->nrow && !r->has_turns) { // most often
        if (r->output_error)
            ct_output_error_accept(r->output_error);
        return CT_EVAL_OK;
    }
    if (!ct_run_turns_are_followed(r, t, y))
        return CT_EVAL_RETRY;
    const struct ct_rank_monitor_step step = {r->o->step > 0, is_across};
    if (!ct_rank_monitor_predict(r->singular, t, y, dy, &step)) {
        r->angle_rate = angle_rate_before;
        r->t_angle_rate = t_before;
        return CT_EVAL_RETRY;
    }
    if (r->output_error)
        ct_output_error_accept(r->output_error);
    if (r->has_turns) { // sums of angles are found when they are asked for
        ct_evaluator_set(r->m, ct_run_time_before_event(r, t), y);
        ct_memory_update(r->m);
    }
    if (r->method->is_implicit && r->m->nrow) // its steps may pass without a projection
        ct_partition_renew_after_step(r->s, ct_run_time_before_event(r, t), y);
    return CT_EVAL_OK;
}

// ---- creation ----------------------------------------

static bool uses(const struct ct_equations *e, ct_ex v, enum ct_sym_kind kind)
{
    return ct_ex_kinds(e->x, v) & 1u << kind;
}

static void find_needs(struct ct_run *r)
{
    const struct ct_equations *e = r->e;
    r->has_power = !ct_ex_is_zero(e->power);
    r->has_turns = ct_memory_limits(e);
    r->needs_lam = uses(e, e->power, CT_SYM_LAM);
    for (size_t i = 0; i < e->nresult; i++)
        r->has_lam_results |= uses(e, e->result[i].value, CT_SYM_LAM);
    for (size_t i = 0; i < e->nvalidity; i++)
        r->has_lam_results |= uses(e, e->validity[i].eta, CT_SYM_LAM);
    r->root_of = CT_NEWN(r->arena, int, e->nswitch + 1);
    r->visits = CT_NEWN(r->arena, int, e->nswitch + 1);
    r->crossed = CT_NEWN(r->arena, signed char, e->nswitch + 1);
    for (size_t i = 0; i < e->nswitch; i++)
        if (!e->switches[i].is_time)
            r->root_of[r->nroot++] = (int)i;
}

static void note_given(struct ct_run *r, const struct ct_initial_state *start)
{
    memset(r->is_given, 0, r->m->nu * sizeof *r->is_given);
    for (size_t i = 0; i < start->n; i++)
        if (r->e->coordinate[i].u >= 0)
            r->is_given[r->e->coordinate[i].u] = start->is_given[i];
}

// Unit of the residuals of rows: 1, or the largest length of a body over small_length if that is
// less. So loops of small mechanisms are closed more accurately, in proportion to their lengths.
// (6.3c)
static double find_scale(const struct ct_model *model)
{
    // Derived: the tolerance of projections is then at most ct_largest_residual of lengths [m]
    const double small_length = ct_position_tolerance / ct_largest_residual;
    double largest = 0;
    for (size_t i = 0; i < model->nframe; i++)
        for (int k = 0; k < 3; k++)
            largest = fmax(largest, fabs(ct_model_number(model, model->frame[i].at.e[k])));
    return largest > 0 ? fmin(1, largest / small_length) : 1;
}

// A run that starts in a singular configuration begins with the assembled speeds, which rows chosen
// there need not keep (singular_initial_step.c).
static bool keeps_demands(struct ct_run *r, const struct ct_initial_state *start)
{
    if (!ct_start_has_moved(r->e, start, r->assembled, r->y))
        return true;
    struct ct_arena *own = ct_arena_create_under(r->arena);
    bool *row = CT_NEWN(own, bool, r->m->nrow + 1);
    const bool ok
        = ct_singular_start_test(own, r->s, 0, r->assembled, row)
       || ct_start_is_kept(r->ctx, own, r->model, r->e, start, r->assembled, r->y, true);
    ct_arena_destroy(own);
    ct_evaluator_set(r->m, 0, r->y);
    ct_evaluator_constraint(r->m);
    return ok;
}

// The accelerations at the start cannot be found: name a state whose derivative is not finite, if
// any.
static void no_start(struct ct_run *r)
{
    if (r->e->has_dynamics)
        ct_evaluator_dynamics(r->m);
    // without M and Q it is an output of the symbolic solution
    const double *rate = r->e->has_dynamics ? r->m->Q : r->m->input + r->m->at_a;
    for (size_t i = 0; i < r->e->nstate; i++) {
        if (!isfinite(rate[r->e->nmotion + i])) {
            ct_error(r->ctx, r->model->state[i].mark, CT_E_SINGULAR,
                     "the rate of the state '%s' is not finite at t = 0",
                     r->model->state[i].name);
            return;
        }
    }
    ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SINGULAR,
             "the accelerations at t = 0 cannot be found");
}

// Set the assembled start, and choose rows and columns there.
bool ct_run_begin(struct ct_run *r, const struct ct_initial_state *start)
{
    ct_initial_state_apply(start, r->m, r->y);
    note_given(r, start);
    memcpy(r->assembled, r->y, r->ny * sizeof *r->y);
    r->t0 = 0;
    ct_evaluator_constraint(r->m);
    r->s->sigma_best = 0;
    r->s->scale = find_scale(r->model);
    ct_evaluator_measure_rows(r->m);
    if (r->m->is_inexact) // symbolic solvers do not support initial residuals of inexact data
        ct_partition_use_solver(
            r->s, r->m->nu + r->m->nrow < CT_FEWEST_SPARSE_UNKNOWNS ? NULL : &ct_solver_sparse);
    ct_partition_find_units(r->s);
    if (!ct_partition_choose(r->s))
        return false;
    // the assembly used other trees: remove the round-off that this leaves in the loops
    if (ct_partition_project(r->s, 0, r->y) != CT_EVAL_OK) {
        ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_ASSEMBLY,
                 "the assembled start is singular: the loops cannot be held there");
        return false;
    }
    if (!keeps_demands(r, start))
        return false;
    if (rhs(r, 0, r->y, r->dy) != CT_EVAL_OK) {
        no_start(r);
        return false;
    }
    ct_switches_start(r->m, 0, r->y, r->dy, NULL);
    return true;
}

struct ct_run *ct_run_prepare(struct ct_ctx *ctx, struct ct_arena *a,
                              const struct ct_model *model, const struct ct_equations *e)
{
    struct ct_run *r = CT_NEW(a, struct ct_run);
    *r = (struct ct_run){.ctx = ctx, .arena = a, .model = model, .e = e};
    r->pending = INFINITY;
    r->m = ct_evaluator_create(a, model, e);
    r->s = ct_partition_create(a, ctx, r->m);
    r->s->pending = &r->pending;
    r->singular = ct_rank_monitor_create(a, r->m, r->s, &r->pending);
    r->singularities = ct_singular_hooks(r->singular);
    r->singular_dense_output = ct_singular_dense_output_create(a, r->singular);
    r->ny = r->m->nq + r->m->nu + 1;
    r->y = CT_NEWN(a, double, r->ny);
    r->dy = CT_NEWN(a, double, r->ny);
    r->assembled = CT_NEWN(a, double, r->ny);
    r->stage = CT_NEWN(a, double, r->ny);
    r->is_given = CT_NEWN(a, bool, r->m->nu + 1);
    r->scratch = CT_NEWN(a, double, 3 * r->m->nu + 2 * (e->ndriver + r->m->nrow) + 1);
    r->impulse = ct_impulse_create(a, r->m);
    r->value = CT_NEWN(a, double, e->nresult + 1);
    r->largest = CT_NEWN(a, double, e->nresult + 1);
    find_needs(r);
    r->output_error = ct_output_error_create(a, r->s, r->largest, &r->stats.evaluations);
    return r;
}

struct ct_run *ct_run_create(struct ct_ctx *ctx, struct ct_arena *a,
                             const struct ct_model *model, const struct ct_equations *e,
                             const struct ct_initial_state *start)
{
    struct ct_run *r = ct_run_prepare(ctx, a, model, e);
    return ct_run_begin(r, start) ? r : NULL;
}

bool ct_run_restart(struct ct_run *r, const struct ct_initial_state *start)
{
    r->singular_joints = NULL;
    ct_evaluator_reset(r->m);
    r->s->kappa = r->s->sigma = 0;
    r->pending = INFINITY;
    r->energy0 = r->energy_scale = 0;
    r->started = false;
    return ct_run_begin(r, start);
}

const struct ct_output_error *ct_run_output_error(const struct ct_run *r)
{
    return r->output_error;
}

const double *ct_run_assembled(const struct ct_run *r)
{
    return r->assembled;
}

enum ct_eval ct_run_rhs(struct ct_run *r, double t, const double *y, double *dy)
{
    return rhs(r, t, y, dy);
}

struct ct_evaluator *ct_run_evaluator(struct ct_run *r)
{
    return r->m;
}

struct ct_partition *ct_run_partition(struct ct_run *r)
{
    return r->s;
}

const double *ct_run_state(const struct ct_run *r)
{
    return r->y;
}

enum ct_eval ct_run_results(struct ct_run *r, double t, const double *y, double *out)
{
    const enum ct_eval e = ct_partition_accelerate_at(r->s, t, y);
    if (e != CT_EVAL_OK)
        return e;
    if (r->has_lam_results)
        ct_run_find_multipliers(r);
    ct_program_run(&r->m->result, r->m->input);
    memcpy(out, r->m->result.out, r->e->nresult * sizeof *out);
    return CT_EVAL_OK;
}

// ---- the run ----------------------------------------

// Checks at a sample: energy balance and residuals of the constraints.
static void update_energy_balance(struct ct_run *r, const double *y)
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
    ct_evaluator_constraint(r->m);
    r->report->position_constraint
        = fmax(r->report->position_constraint, ct_vector_largest(r->m->phi, r->m->nrow));
    r->report->velocity_constraint
        = fmax(r->report->velocity_constraint, ct_vector_largest(r->m->v, r->m->nrow));
}

// If steps began before the start, they must pass through it.
static bool has_come_to_start(struct ct_run *r, const double *y)
{
    return r->started || !(r->t0 < 0) || ct_singular_meets_start(r->assembled, y, r->ny)
        || ct_error(
               r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_STEP_SINGULAR,
               "the run starts near a singular configuration, and the motion that comes from "
               "before it does not lead there: start farther from it, or in it");
}

// Fixed steps that are too long for the motion make it grow until products of states overflow.
static bool has_blown_up(const struct ct_run *r, const double *y)
{
    const double largest = sqrt(sqrt(DBL_MAX)); // products of four are finite below
    return r->o->step > 0 && !(ct_vector_largest(y, r->ny) < largest);
}

static bool report_not_finite(const struct ct_run *r, const char *output, double t,
                              const double *y)
{
    const struct ct_mark mark = {.file = r->model->file};
    if (has_blown_up(r, y))
        return ct_error(
            r->ctx, mark, CT_E_STEP_REFUSED,
            "the motion has grown beyond all numbers at t = %.9g (the output '%s' has "
            "no finite value): the fixed step of %.3g s is too long for it; take a "
            "shorter one, or leave 'step' out",
            t, output, r->o->step);
    return ct_error(r->ctx, mark, CT_E_SINGULAR,
                    "the output '%s' has no finite value at t = %.9g", output, t);
}

static bool give_row(struct ct_run *r, double t, const double *y)
{
    if (!has_come_to_start(r, y))
        return false;
    for (size_t i = 0; i < r->e->nresult; i++)
        if (!isfinite(r->value[i]))
            return report_not_finite(r, r->e->result[i].name, t, y);
    for (size_t i = 0; i < r->e->nresult; i++)
        r->largest[i] = fmax(r->largest[i], fabs(r->value[i]));
    update_energy_balance(r, y);
    ct_run_monitor_sample(r, t);
    r->ngiven++;
    memcpy(r->report->final, r->value, r->e->nresult * sizeof *r->value);
    return !r->o->row || r->o->row(r->o->user, t, r->value, r->e->nresult);
}

static bool singular_at(struct ct_run *r, double t)
{
    return ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SINGULAR,
                    "the equations are singular at t = %.9g", t);
}

bool ct_run_at_sample(void *user, double t, const double *y)
{
    struct ct_run *r = user;
    return ct_run_results(r, t, y, r->value) == CT_EVAL_OK ? give_row(r, t, y)
                                                           : singular_at(r, t);
}

// The error if accelerations and multipliers cannot be computed.
static bool at_singular_sample(void *user, double t, const double *y,
                               const struct ct_gap_interpolation *b)
{
    struct ct_run *r = user;
    return ct_singular_dense_output(r->singular_dense_output, t, y, b, r->value)
             ? give_row(r, t, y)
             : singular_at(r, t);
}

bool ct_run_at_step(void *user, double t, const double *y)
{
    struct ct_run *r = user;
    ct_run_monitor_base(r, t, y, CT_MONITOR_STEP);
    if (r->o->progress && !r->o->progress(r->o->user, t, r->o->duration))
        return false;
    r->is_suspect = r->stiffness && ct_run_suspects_stiffness(r, t, y);
    if (!r->is_suspect)
        r->t_before = t;
    return !r->is_suspect;
}

// ---- what is taken over the run ----------------------------------------

struct ct_take_scan *ct_run_take_create(struct ct_arena *a, const struct ct_run_options *o)
{
    return o->ntake ? ct_take_scan_create(a, o->take, o->ntake) : NULL;
}

void ct_run_take_begin(struct ct_take_scan *s, const struct ct_run_options *o)
{
    ct_take_scan_begin(s, o->output_rtol, o->rtol > 0 ? o->atol / o->rtol * o->output_rtol : 0);
}

static bool results_inside(struct ct_run *r, const struct ct_step_view *step, double t)
{
    struct ct_gap_interpolation gap;
    if (!ct_step_state(step, t, r->inside, &gap))
        return false;
    const double before = ct_run_time_before_event(r, t);
    const bool ok = gap.n ? ct_singular_dense_output(r->singular_dense_output, t, r->inside,
                                                     &gap, r->taken)
                          : ct_run_results(r, before, r->inside, r->taken) == CT_EVAL_OK;
    if (!ok)
        return singular_at(r, t);
    for (size_t i = r->e->nresult - r->o->ntake; i < r->e->nresult; i++)
        if (!isfinite(r->taken[i]))
            return report_not_finite(r, r->e->result[i].name, t, r->inside);
    return true;
}

static bool over_step(void *user, const struct ct_step_view *step)
{
    struct ct_run *r = user;
    const double t0 = fmax(step->t0, 0);
    double t;
    if (!(step->t1 > t0)) // before the start
        return true;
    ct_take_scan_step(r->take, t0, step->t1);
    while (ct_take_scan_wants(r->take, &t)) {
        if (!results_inside(r, step, t))
            return false;
        ct_take_scan_give(r->take, r->taken + r->e->nresult - r->o->ntake);
    }
    return true;
}

// Results with multipliers lam and lam + z, with z in null(J') of order one: those that change
// depend on the choice of multipliers.
static void compare_results(struct ct_run *r, const double *z, double *value, bool *result)
{
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
                   > CT_HALF_DIGITS * fmax(largest_lam, fabs(value[i]));
    for (size_t i = 0; i < r->m->nrow; i++)
        lam[i] = r->s->lam[i];
}

void ct_run_find_undetermined(struct ct_run *r, double t, const double *y, bool *row,
                              bool *result)
{
    for (size_t i = 0; i < r->e->nresult; i++)
        result[i] |= r->e->result[i].undetermined;
    if (r->s->rank == (int)r->m->nrow || ct_partition_accelerate_at(r->s, t, y) != CT_EVAL_OK)
        return;
    ct_run_find_multipliers(r);
    ct_evaluator_constraint(r->m);
    struct ct_arena *own = ct_arena_create_under(r->arena);
    struct ct_null_space *null_space = ct_null_space_create(own, r->s);
    ct_partition_uniqueness(r->s, null_space);
    double *z = CT_NEWN(own, double, r->m->nrow);
    for (size_t i = 0; i < r->m->nrow; i++) {
        if (r->s->is_unique[i])
            continue;
        row[i] = true;
        ct_null_space_vector(null_space, (int)i, z);
        compare_results(r, z, r->value, result);
    }
    ct_arena_destroy(own);
}

double ct_run_sample_time(const struct ct_run_options *o, size_t i)
{
    if (o->nsample == 1)
        return 0;
    return i + 1 == o->nsample ? o->duration
                               : o->duration * (double)i / (double)(o->nsample - 1);
}

// Groups of states with a common scale in the error norm: of each beam the axial displacements, the
// transverse ones, the rotations, and the rates of each. Axial displacements have a scale of their
// own: they are much smaller than transverse ones, but axial forces depend on them.
const struct ct_groups *ct_run_groups(struct ct_run *r)
{
    struct ct_groups *g = CT_NEW(r->arena, struct ct_groups);
    int *of = CT_NEWN(r->arena, int, r->ny);
    const struct ct_u *before = NULL;
    for (size_t i = 0; i < r->ny; i++)
        of[i] = -1;
    for (size_t k = 0; k < r->e->nu; k++) {
        const struct ct_u *u = &r->e->u[k];
        if (!u->beam || u->kind == CT_ELASTIC_MODE)
            continue;
        if (!before || before->beam != u->beam) // a beam's coordinates follow each other
            g->n += 2 * CT_ELASTIC_MODE;
        before = u;
        of[u->q] = g->n - 1 - (int)u->kind;
        of[r->e->nq + k] = of[u->q] - CT_ELASTIC_MODE;
    }
    g->of = of;
    g->size = CT_NEWN(r->arena, double, g->n + 1);
    return g->n ? g : NULL;
}

// Does anything have to be evaluated after each step?
static bool looks_at_steps(const struct ct_run *r)
{
    return r->o->progress || r->o->stiff_method || r->m->base_motion.nout;
}

// Tell the integrator which speeds and coordinates are outputs; by default all are. Not with
// switches, nor with states of the model: these are not speeds of vibrations and may have any size,
// so an energy norm of errors has no meaning.
static void find_requested(struct ct_run *r, struct ct_problem *p)
{
    ct_evaluator_set(r->m, 0, r->y);
    if (!r->nroot && !r->e->nstate)
        ct_output_error_find_requested(r->arena, r->e, &p->requested_speeds,
                                       &p->requested_positions);
    for (size_t i = 0; i < r->e->nresult; i++) {
        const bool is_total = ct_output_error_is_check(r->e, i);
        const unsigned kinds = ct_ex_kinds(r->e->x, r->e->result[i].value);
        p->keeps_energy |= is_total;
        p->keeps_work |= !is_total && kinds & 1u << CT_SYM_WORK && !ct_ex_is_zero(r->e->power);
    }
}

static double input_limited_step(void *user, double t, double h)
{
    const struct ct_run *r = user;
    return ct_input_sampling_limit_step(&r->input_sampling, r->method, t, h, r->o->rtol);
}

bool ct_run_starts_near_singular(struct ct_run *r)
{
    return ct_singular_starts_near(r->singular, r->y, r->dy);
}

// If the run starts in or near a singular configuration, begin steps a little before it.
bool ct_run_start_steps(struct ct_run *r)
{
    const struct ct_problem p = {.user = r,
                                 .ny = (int)r->ny,
                                 .rhs = rhs,
                                 .project = project,
                                 .singular = &r->singularities,
                                 .accuracy = r->o->output_rtol,
                                 .nq = (int)r->m->nq,
                                 .nu = (int)r->m->nu,
                                 .nroot = r->nroot,
                                 .root = ct_run_root};
    struct ct_singular_start start = {.ctx = r->ctx,
                                      .arena = r->arena,
                                      .file = r->model->file,
                                      .singular = r->singular,
                                      .m = r->m,
                                      .s = r->s,
                                      .p = &p,
                                      .stats = &r->stats,
                                      .assembled = r->assembled,
                                      .is_given = r->is_given,
                                      .joints = r->singular_joints,
                                      .rtol = r->o->rtol,
                                      .atol = r->o->atol,
                                      .output_rtol = r->o->output_rtol,
                                      .is_fixed = r->o->step > 0,
                                      .y = r->y,
                                      .dy = r->dy,
                                      .stage = r->stage,
                                      .scratch = r->scratch};
    const bool ok = ct_singular_initial_step(&start);
    r->t0 = start.t0;
    return ok;
}

// Warn of cancellation: if the inertia of a single degree of freedom is a small part of the terms
// that it is the sum of, accelerations have a relative error of eps over that part.  (8.39)
static void warn_of_cancellation(struct ct_run *r)
{
    if (r->s->smallest_cancellation < r->s->least_cancellation)
        ct_warning(r->ctx, (struct ct_mark){.file = r->model->file}, 0,
                   "the inertias of the mechanism cancel but for %.0e of them in some "
                   "position: round-off of "
                   "results may come to %.0e of them; '--tree absolute' has more digits there",
                   r->s->smallest_cancellation, DBL_EPSILON / r->s->smallest_cancellation);
}

// The problem of the run, as r->o asks for it. watched: (ny), in the run's arena.
void ct_run_pose(struct ct_run *r, struct ct_problem *p, const bool *watched)
{
    const struct ct_run_options *o = r->o;
    *p = (struct ct_problem){
        .user = r,
        .ny = (int)r->ny,
        .nq = (int)r->m->nq,
        .nu = (int)r->m->nu,
        .dae = o->method->is_implicit ? ct_dae_create(r->arena, r->s) : NULL,
        .error_controlled = watched,
        .accuracy = o->output_rtol,
        .duration = o->duration,
        .groups = ct_run_groups(r),
        .output_error = r->output_error ? output_error : NULL,
        .output_change = r->output_error ? output_change : NULL,
        .predict_output = r->output_error ? predict_output : NULL,
        .sensitive_output_error = r->output_error ? sensitive_output_error : NULL,
        .rhs = rhs,
        .project = has_constraints(r) ? project : NULL,
        .accepted = accepted,
        .longest_step = r->has_turns ? ct_run_longest_step : NULL,
        .input_limited_step = r->e->ntime_function ? input_limited_step : NULL,
        .singular = r->m->nrow ? &r->singularities : NULL,
        .nroot = r->nroot,
        .root = ct_run_root,
        .sides = ct_run_sides,
        .next_time_event = ct_run_next_event,
        .event = ct_run_event,
        .resumed = ct_run_resumed};
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
        sample[i] = ct_run_sample_time(o, i);
    for (size_t i = 0; i < r->ny; i++)
        watched[i] = i + 1 < r->ny || r->has_power; // the work is as good as the states
    *report = (struct ct_run_report){
        .method = o->method, .changed_at = NAN, .returned_at = NAN, .roundoff_limited = -1};
    report->final = CT_NEWN(r->arena, double, r->e->nresult + 1);
    memset(r->largest, 0, r->e->nresult * sizeof *r->largest);
    ct_rank_monitor_start(r->singular);
    r->singular->output_rtol = o->step == 0 ? o->output_rtol : 0;
    r->s->least_cancellation
        = o->step == 0 ? DBL_EPSILON / fmax(o->output_rtol, ct_position_tolerance) : 0;
    r->s->smallest_cancellation = INFINITY;
    if (r->output_error)
        ct_output_error_start(r->output_error, o->method);
    r->o = o;
    r->take = ct_run_take_create(r->arena, o);
    if (r->take) {
        ct_run_take_begin(r->take, o);
        r->taken = CT_NEWN(r->arena, double, r->e->nresult);
        r->inside = CT_NEWN(r->arena, double, r->ny);
    }
    r->method = o->method;
    r->last_event = -INFINITY;
    r->is_announced = r->has_jumped = false;
    r->report = report;
    r->nevent = ct_time_events(r->arena, r->m, o->method->order, 0, o->duration, &r->event);
    r->pending = ct_run_next_event(r, 0);
    if (o->step == 0)
        ct_input_sampling_sample(r->arena, r->m, o->duration, &r->input_sampling);
    if (!ct_run_tables_reach(r, 0))
        return false;
    ct_switches_start(r->m, 0, r->y, r->dy, NULL);
    ct_run_monitor_start(r, 0, r->y);
    ct_run_store_angle_rate(r, 0, r->y);
    if (ct_run_settle_switches(r, 0, r->y, NULL) == CT_EVAL_FATAL)
        return false;
    if (!ct_run_start_steps(r))
        return false;
    struct ct_problem p;
    ct_run_pose(r, &p, watched);
    find_requested(r, &p);
    const struct ct_integrate_options io
        = {.t0 = r->t0,
           .t1 = o->duration,
           .rtol = o->rtol,
           .atol = o->atol,
           .least_rtol = o->least_rtol,
           .step = o->step,
           .sample = sample,
           .nsample = n,
           .at_sample = ct_run_at_sample,
           .at_singular_sample = at_singular_sample,
           .over_step = r->take ? over_step : NULL,
           .forecast = ct_run_forecast,
           .many_steps = ct_run_many_steps,
           .at_step = looks_at_steps(r) ? ct_run_at_step : NULL};
    const bool ok = ct_run_integrate(r, &p, io);
    ct_evaluator_set(r->m, ct_run_time_before_event(r, report->stats.last_time), r->y);
    ct_memory_update(r->m);
    if (!ok)
        ct_run_explain_end(r);
    else if (r->take)
        ct_take_scan_results(r->take, report->final + r->e->nresult - o->ntake);
    report->rank = r->s->rank;
    report->switches = r->s->switches;
    report->solves = r->s->solves;
    report->factorizations = r->s->factorizations + report->stats.factorizations;
    report->singular = r->singular;
    report->y = r->y;
    if (ok) {
        const struct ct_roundoff_limit b = ct_run_find_roundoff_limit(r, o->output_rtol);
        report->roundoff_limited = b.output;
        report->roundoff = b.one;
        report->roundoff_sum = b.sum;
        warn_of_cancellation(r);
    }
    report->energy_scale = r->energy_scale;
    if (r->energy_scale > 0)
        report->energy_drift /= r->energy_scale;
    return ok;
}
