// See simulate.h.
#include "solve/simulate.h"
#include "formulate/flexible.h"
#include "integrate/stiffness.h"
#include "solve/dae.h"
#include "expr/print.h"
#include "solve/mode.h"
#include "solve/fidelity.h"

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
    double *y, *dy, *stage, *scratch, *value, *next;
    double *sign;  // of each state mode's root function at the last event
    double *event; // times
    size_t nevent;
    int *root_of; // state modes, in order
    int nroot;
    bool needs_lam, has_power;
    struct ct_fidelity *fidelity; // of outputs; NULL: none is controlled
    const struct ct_run_options *o;
    struct ct_run_report *report;
    double energy0, energy_scale;
    double pivot_most, last_part, time_last, singular_in, singular_reach,
        kept_far;       // see foresee_singular
    long last_switches; // of the embedding
    double pending;     // time of the event ahead; INFINITY if there is none
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

static double largest(const double *v, size_t n)
{
    double max = 0;
    for (size_t i = 0; i < n; i++)
        max = fmax(max, fabs(v[i]));
    return max;
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

static enum ct_eval rhs(void *user, double time, const double *y, double *dy)
{
    struct ct_run *r = user;
    const double t = before_event(r, time);
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
    return ct_embed_project(r->s, before_event(r, t), y);
}

// The smallest pivot of J_d against its largest, s seconds after y along q' and q'' as they are there.
static double pivot_after(struct ct_run *r, double t, const double *y, const double *dy,
                          double s)
{
    const size_t nq = r->m->nq, nu = r->m->nu;
    memcpy(r->stage, y, r->ny * sizeof *y);
    for (size_t i = 0; i < nu; i++)
        r->scratch[i] = s * (y[nq + i] + s / 2 * dy[nq + i]);
    ct_machine_retract(r->m, r->stage, r->scratch);
    ct_machine_set(r->m, before_event(r, t + s), r->stage);
    ct_machine_constraint(r->m);
    return ct_embed_pivot(r->s);
}

// A position counts as singular ahead when the smallest pivot has fallen to the first part of its largest value so far
// and goes on falling; where it has fallen to the second part pivots are sought at every evaluation, at the third f is
// better not computed.
static const double foreseen_pivot = 0.8, near_pivot = 0.5, singular_pivot = 0.25;

// The smallest pivot falls about linearly towards a singular position. Time to where it will vanish, by secants along
// the motion as the accelerations of now continue it. INFINITY if it rises.
static double time_to_singular(struct ct_run *r, double t, const double *y, const double *dy,
                               double now, double dt)
{
    enum { SECANTS = 3 };
    const double glance = 1e-3, part = 0.8; // of the last step; of the way, not to step across
    const double far = 4 * dt;
    double s = glance * dt, pivot = pivot_after(r, t, y, dy, s), slope = (pivot - now) / s;
    if (!(slope < 0))
        return INFINITY;
    for (int i = 0; i < SECANTS && s - pivot / slope < far; i++) {
        const double next = s - part * pivot / slope;
        double there = pivot_after(r, t, y, dy, next);
        if (there > fabs(pivot)) // it has changed its sign, which is not seen
            there = -there;
        if (there == pivot)
            break;
        slope = (there - pivot) / (next - s);
        s = next;
        pivot = there;
    }
    return s - pivot / slope;
}

// With redundant rows what tells of all of them costs as much as some evaluations. As long as the kept rows have not come
// nearer to losing rank than when nothing was ahead, nothing is.
static bool is_far_still(struct ct_run *r, double t, const double *y)
{
    if (r->s->rank == (int)r->m->nrow || r->singular_in < INFINITY
        || r->s->switches != r->last_switches)
        return false;
    ct_machine_set(r->m, before_event(r, t), y);
    ct_machine_constraint(r->m);
    return ct_embed_kept_pivot(r->s) >= r->kept_far;
}

// What is ahead of an accepted state. False if the step to it has come beside a singular position, or past it, before
// that was foreseen.
static bool foresee_singular(struct ct_run *r, double t, const double *y, const double *dy)
{
    const double dt = t - r->time_last;
    if (!r->s->rank || !(dt > 0))
        return true;
    if (is_far_still(r, t, y)) {
        r->time_last = t;
        return true;
    }
    const double now = pivot_after(r, t, y, dy, 0), part = now / fmax(r->pivot_most, now);
    // after another choice of rows and columns the pivot is not to be compared with the last one
    const bool is_comparable = r->s->switches == r->last_switches;
    const bool was_unforeseen
        = is_comparable && isinf(r->singular_in) && r->last_part > near_pivot;
    if (r->o->step == 0 && part < near_pivot && was_unforeseen)
        return false;
    r->time_last = t;
    r->last_part = part;
    r->last_switches = r->s->switches;
    r->pivot_most = fmax(r->pivot_most, now);
    r->singular_in = INFINITY;
    r->s->is_delicate = part < near_pivot;
    r->kept_far = INFINITY;
    if (part > foreseen_pivot) {
        if (r->s->rank < (int)r->m->nrow)
            r->kept_far = foreseen_pivot * ct_embed_kept_pivot(r->s);
        return true;
    }
    r->singular_in = time_to_singular(r, t, y, dy, now, dt);
    r->singular_reach = r->singular_in * fmin(1, singular_pivot / part);
    return true;
}

static double singular_in(void *user, double *reach)
{
    const struct ct_run *r = user;
    *reach = r->singular_reach;
    return r->singular_in;
}

// The stages of a crossing keep away from the position and are put onto the constraints: an order of pivots that holds
// where it begins holds for all of them.
static void set_crossing(void *user, bool is_crossing)
{
    struct ct_run *r = user;
    r->s->is_crossing = is_crossing;
    r->s->is_delicate = !is_crossing && r->last_part < near_pivot;
}

static double output_error(void *user, double t, const double *y, const double *e,
                           const struct ct_tolerance *tolerance, double states)
{
    struct ct_run *r = user;
    return ct_fidelity_error(r->fidelity, before_event(r, t), y, e, tolerance, states);
}

static double residual(void *user, double t, const double *y)
{
    struct ct_run *r = user;
    ct_machine_set(r->m, before_event(r, t), y);
    ct_machine_constraint(r->m);
    return largest(r->m->phi, r->m->nrow);
}

static enum ct_eval accepted(void *user, double t, double *y, const double *dy)
{
    struct ct_run *r = user;
    if (!r->method->is_implicit && !foresee_singular(r, t, y, dy))
        return CT_EVAL_RETRY;
    if (r->fidelity)
        ct_fidelity_accept(r->fidelity);
    ct_machine_set(r->m, before_event(r, t), y);
    ct_memory_follow(r->m);
    if (r->method->is_implicit) { // its steps may pass without a projection
        ct_machine_constraint(r->m);
        ct_embed_renew(r->s);
    }
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
    // p = momentum before - momentum after, both with the old unknown speeds; these are kept where p = 0, but for the
    // impulses that close loops
    const double *after = m->momentum.out;
    const bool is_kept = r->o && r->o->rate_jumps == CT_RATE_CONTINUOUS;
    double *p = r->scratch, *u = y + m->nq;
    ct_program_run(&m->momentum, m->input);
    for (size_t i = 0; i < m->nu; i++)
        p[i] = is_kept ? 0 : momentum[i] - after[i];
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

// To the start, assembled; rows and columns chosen there.
static bool begin(struct ct_run *r, const struct ct_start *start)
{
    ct_start_apply(start, r->m, r->y);
    ct_machine_constraint(r->m);
    if (!ct_embed_choose(r->s))
        return false;
    // measured on other trees, the loops close to rounding; the rest is taken off here
    if (ct_embed_project(r->s, 0, r->y) != CT_EVAL_OK) {
        ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_ASSEMBLY,
                 "the assembled start is singular: the loops cannot be held there");
        return false;
    }
    if (rhs(r, 0, r->y, r->dy) != CT_EVAL_OK) {
        ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SINGULAR,
                 "the accelerations at t = 0 cannot be found");
        return false;
    }
    ct_modes_start(r->m, 0, r->y, r->dy);
    return true;
}

struct ct_run *ct_run_prepare(struct ct_ctx *ctx, struct ct_arena *a,
                              const struct ct_model *model, const struct ct_equations *e)
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
    r->scratch = CT_NEWN(a, double, 2 * r->m->nu + 2 * e->ndriver + r->m->nrow + 1);
    r->value = CT_NEWN(a, double, e->nresult + 1);
    find_needs(r);
    r->fidelity = ct_fidelity_create(a, r->m);
    return r;
}

struct ct_run *ct_run_create(struct ct_ctx *ctx, struct ct_arena *a,
                             const struct ct_model *model, const struct ct_equations *e,
                             const struct ct_start *start)
{
    struct ct_run *r = ct_run_prepare(ctx, a, model, e);
    return begin(r, start) ? r : NULL;
}

bool ct_run_restart(struct ct_run *r, const struct ct_start *start)
{
    ct_machine_reset(r->m);
    r->s->kappa = r->s->sigma = 0;
    r->pending = INFINITY;
    r->energy0 = r->energy_scale = r->pivot_most = 0;
    r->kept_far = INFINITY;
    r->started = false;
    return begin(r, start);
}

enum ct_eval ct_run_rhs(struct ct_run *r, double t, const double *y, double *dy)
{
    return rhs(r, t, y, dy);
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

static bool give_row(struct ct_run *r, double t, const double *y)
{
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

static bool singular_at(struct ct_run *r, double t)
{
    return ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SINGULAR,
                    "the equations are singular at t = %.9g", t);
}

static bool at_sample(void *user, double t, const double *y)
{
    struct ct_run *r = user;
    return ct_run_results(r, t, y, r->value) == CT_EVAL_OK ? give_row(r, t, y)
                                                           : singular_at(r, t);
}

// Where accelerations and multipliers cannot be computed they are those at other times, interpolated.
static bool at_singular_sample(void *user, double t, const double *y, const struct ct_bridge *b)
{
    struct ct_run *r = user;
    struct ct_machine *m = r->m;
    double *a = r->scratch, *lam = a + m->nu;
    memset(a, 0, (m->nu + m->nrow) * sizeof *a);
    for (int k = 0; k < b->n; k++) {
        memcpy(r->stage, b->y + (size_t)k * r->ny, r->ny * sizeof *y);
        if (ct_embed_project(r->s, b->t[k], r->stage) != CT_EVAL_OK
            || accelerate(r, b->t[k], r->stage) != CT_EVAL_OK)
            return singular_at(r, t);
        ct_embed_multipliers(r->s);
        for (size_t i = 0; i < m->nu; i++)
            a[i] += b->weight[k] * r->s->a[i];
        for (size_t i = 0; i < m->nrow; i++)
            lam[i] += b->weight[k] * r->s->lam[i];
    }
    ct_machine_set(m, t, y);
    memcpy(m->input + m->at_a, a, m->nu * sizeof *a);
    memcpy(m->input + m->at_lam, lam, m->nrow * sizeof *lam);
    ct_program_run(&m->result, m->input);
    memcpy(r->value, m->result.out, r->e->nresult * sizeof *r->value);
    return give_row(r, t, y);
}

// After an event, and next to a singular position, steps had better go on.
static bool is_to_be_reconsidered(struct ct_run *r, double t, const double *y)
{
    const bool may_stop = t > r->last_event && !(r->singular_in < INFINITY);
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

static double sample_time(const struct ct_run_options *o, size_t i)
{
    if (o->nsample == 1)
        return 0;
    return i + 1 == o->nsample ? o->duration
                               : o->duration * (double)i / (double)(o->nsample - 1);
}

// ---- driven all through ----------------------------------------------------------------------------------------

static bool check_driven(struct ct_run *r)
{
    if (r->s->rank == (int)r->m->nu)
        return true;
    const struct ct_u *u = &r->e->u[r->s->independent[0]];
    const struct ct_mark mark = u->joint >= 0 ? r->model->joint[u->joint].mark
                              : u->body >= 0  ? r->model->body[u->body].instance.mark
                                              : (struct ct_mark){.file = r->model->file};
    return ct_error(r->ctx, mark, CT_E_NOT_DRIVEN,
                    "not all freedoms are driven: %d left, such as '%s'; give each a 'motion'",
                    (int)r->m->nu - r->s->rank, u->q >= 0 ? r->e->q[u->q].name : u->name);
}

// From y at t to t1 in one go: along the motion to second order, then onto the rows. False if that leads too far.
static bool follow_step(struct ct_run *r, double t, double t1, const double *y, double *out)
{
    const double longest = 0.3; // [rad or m]: more could lead to another assembly
    const double part = 0.25;   // of the step: what the rows may correct
    const size_t nq = r->m->nq, nu = r->m->nu;
    const double h = t1 - t;
    double most = 0, worst = 0, *d = r->scratch;
    memcpy(out, y, r->ny * sizeof *y);
    if (!nu)
        return true;
    if (accelerate(r, before_event(r, t), y) != CT_EVAL_OK)
        return false;
    for (size_t k = 0; k < nu; k++) {
        d[k] = h * (y[nq + k] + h / 2 * r->s->a[k]);
        out[nq + k] += h * r->s->a[k];
        most = fmax(most, fabs(d[k]));
    }
    if (!(most <= longest))
        return false;
    ct_machine_retract(r->m, out, d);
    memcpy(r->stage, out, nq * sizeof *out);
    if (ct_embed_project(r->s, before_event(r, t1), out) != CT_EVAL_OK)
        return false;
    for (size_t i = 0; i < nq; i++)
        worst = fmax(worst, fabs(out[i] - r->stage[i]));
    return worst <= part * most + 1e-9;
}

static bool follow_to(struct ct_run *r, double t, double t1, double *y)
{
    const double least = 1e-9; // of the way: it does not go on
    double h = t1 - t, *next = r->next;
    while (t < t1) {
        const double end = h >= t1 - t ? t1 : t + h;
        if (!follow_step(r, t, end, y, next)) {
            h = (end - t) / 2;
            if (h > least * (t1 - t) && t + h > t)
                continue;
            return ct_error(
                r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SAMPLE_REFUSED,
                "the mechanism cannot follow its motions beyond t = %.9g: it locks, "
                "or passes a singular position",
                t);
        }
        memcpy(y, next, r->ny * sizeof *y);
        ct_machine_set(r->m, before_event(r, end), y);
        ct_memory_follow(r->m);
        h = 2 * (end - t);
        t = end;
    }
    return true;
}

// Work over an interval without events: Gauss's formula with three nodes.
static bool follow_and_work(struct ct_run *r, double t, double t1, double *y)
{
    static const double node[] = {0.1127016653792583, 0.5, 0.8872983346207417},
                        weight[] = {5. / 18, 8. / 18, 5. / 18};
    double work = 0, now = t;
    for (int i = 0; i < 3 && r->has_power; i++) {
        const double at = t + node[i] * (t1 - t);
        if (!follow_to(r, now, at, y))
            return false;
        now = at;
        if (accelerate(r, before_event(r, at), y) != CT_EVAL_OK)
            return ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SINGULAR,
                            "the equations are singular at t = %.9g", at);
        multipliers(r);
        ct_program_run(&r->m->power, r->m->input);
        work += weight[i] * (t1 - t) * r->m->power.out[0];
    }
    if (!follow_to(r, now, t1, y))
        return false;
    y[r->ny - 1] += work;
    return true;
}

// Sides after an event; the motions must not jump there. Their rates may: an impulse, whose work is booked.
static bool pass_event(struct ct_run *r, double t, double *y)
{
    struct ct_machine *m = r->m;
    double *before = r->scratch + m->nu;
    ct_machine_set(m, before_event(r, t), y);
    ct_program_run(&m->driver, m->input);
    memcpy(before, m->driver.out, m->driver.nout * sizeof *before);
    const double kinetic = kinetic_energy(r, before_event(r, t), y);
    r->pending = next_time_event(r, t);
    ct_modes_start(m, t, y, NULL);
    ct_machine_set(m, t, y);
    ct_program_run(&m->driver, m->input);
    for (size_t i = 0; i < r->e->ndriver; i++) {
        const double jump = m->driver.out[2 * i] - before[2 * i];
        if (fabs(jump) > jump_tolerance * fmax(1, fabs(before[2 * i])))
            return report_jump(r, r->e->driver[i].name, r->e->driver[i].mark, jump, t);
    }
    ct_machine_constraint(m);
    if (!chords_are_closed(r, t))
        return false;
    if (ct_embed_project(r->s, t, y) != CT_EVAL_OK)
        return ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SAMPLE_REFUSED,
                        "the mechanism cannot follow its motions at t = %.9g", t);
    y[r->ny - 1] += kinetic_energy(r, t, y) - kinetic;
    return true;
}

bool ct_run_follow(struct ct_run *r, const struct ct_run_options *o,
                   struct ct_run_report *report)
{
    *report = (struct ct_run_report){.y = r->y,
                                     .rank = r->s->rank,
                                     .method = o->method,
                                     .changed_at = NAN,
                                     .returned_at = NAN};
    report->final = CT_NEWN(r->arena, double, r->e->nresult + 1);
    r->o = o;
    r->report = report;
    r->next = CT_NEWN(r->arena, double, r->ny);
    r->nevent = ct_time_events(r->arena, r->m, 0, o->duration, &r->event);
    r->pending = next_time_event(r, 0);
    ct_modes_start(r->m, 0, r->y, NULL);
    if (!check_driven(r))
        return false;
    double t = 0;
    for (size_t i = 0; i < o->nsample; i++) {
        const double end = sample_time(o, i);
        while (r->pending <= end) {
            const double event = r->pending;
            if (!follow_and_work(r, t, event, r->y) || !pass_event(r, event, r->y))
                return false;
            t = event;
        }
        if (!follow_and_work(r, t, end, r->y))
            return false;
        t = end;
        ct_modes_start(r->m, t, r->y, NULL);
        if (!at_sample(r, t, r->y) || !at_step(r, t, r->y))
            return false;
    }
    report->switches = r->s->switches;
    report->factorizations = r->s->factorizations;
    report->stats.evaluations = r->m->evaluations;
    if (r->energy_scale > 0)
        report->energy_drift /= r->energy_scale;
    return true;
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
        return r->s->form[0]->operations;
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
        sample[i] = sample_time(o, i);
    for (size_t i = 0; i < r->ny; i++)
        watched[i] = i + 1 < r->ny || r->has_power; // the work is as good as the states
    *report
        = (struct ct_run_report){.method = o->method, .changed_at = NAN, .returned_at = NAN};
    report->final = CT_NEWN(r->arena, double, r->e->nresult + 1);
    report->validity = CT_NEWN(r->arena, struct ct_validity_report, r->e->nvalidity + 1);
    for (size_t i = 0; i < r->e->nvalidity; i++)
        report->validity[i].left_at = -1;
    r->singular_in = r->kept_far = INFINITY;
    if (r->fidelity)
        ct_fidelity_start(r->fidelity);
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
                           .output_error = r->fidelity ? output_error : NULL,
                           .rhs = rhs,
                           .project = project,
                           .accepted = accepted,
                           .singular_in = singular_in,
                           .set_crossing = set_crossing,
                           .residual = residual,
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
                                            .at_singular_sample = at_singular_sample,
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
