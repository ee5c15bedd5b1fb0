// Diagnosis of runs that end before their time: which constraints, and where.
#include "solve/run/run_internal.h"

#include "numeric/dense.h"

#include <float.h>
#include <string.h>

// Source position of the first marked row.
static struct ct_mark mark_of_row(const struct ct_run *r, size_t row)
{
    const int joint = r->e->row[row].joint;
    if (joint < 0)
        return (struct ct_mark){.file = r->model->file};
    return r->model->joint[joint].mark;
}

// Add a note if steps became too short near a singular configuration.
static void note_singular(struct ct_run *r, const char *advice)
{
    enum { MOST_NAMES = 5 }; // Limit: of a message; dots stand for the others
    bool *row = CT_NEWN(r->arena, bool, r->m->nrow + 1);
    const double t = r->stats.last_time;
    if (!ct_rank_monitor_is_near_singular(r->singular, ct_run_time_before_event(r, t), r->y,
                                          r->o->step, row))
        return;
    const char *names = "";
    int first = -1, n = 0;
    for (size_t i = 0; i < r->m->nrow; i++) {
        if (!row[i] || n++ >= MOST_NAMES)
            continue;
        first = first < 0 ? (int)i : first;
        names
            = ct_arena_printf(r->arena, "%s%s%s", names, *names ? ", " : "", r->e->row[i].name);
    }
    ct_note(
        r->ctx, mark_of_row(r, first < 0 ? 0 : (size_t)first),
        "the constraints come to depend on each other there%s%s%s%s: the mechanism is at the "
        "end of its reach or in a singular configuration%s",
        n ? " (" : "", names, n > MOST_NAMES ? ", ..." : "", n ? ")" : "", advice);
}

// If steps ended as the constraints could not be closed: name the row that is open most a little
// later.
static void note_open_row(struct ct_run *r)
{
    const double small_part = 1e-3; // Definition: of the run, docs/messages.md, E312
    if (ct_run_rhs(r, r->stats.last_time, r->y, r->dy))
        return;
    const double dt = small_part * r->o->duration, t = r->stats.last_time + dt;
    for (size_t i = 0; i < r->m->nu; i++)
        r->scratch[i] = dt * r->y[r->m->nq + i];
    memcpy(r->stage, r->y, r->ny * sizeof *r->y);
    ct_evaluator_retract(r->m, r->stage, r->scratch);
    if (ct_partition_project(r->s, t, r->stage) == CT_EVAL_OK)
        return;
    ct_evaluator_constraint(r->m);
    size_t worst = 0;
    for (size_t i = 1; i < r->m->nrow; i++)
        if (fabs(r->m->phi[i]) > fabs(r->m->phi[worst]))
            worst = i;
    ct_note(r->ctx, mark_of_row(r, worst), "'%s' stays open at t = %.9g", r->e->row[worst].name,
            t);
}

// inertia (nu, out): effective inertia of each speed at the evaluator's input, with all other
// speeds free.
static bool find_inertias(struct ct_run *r, double *inertia)
{
    ct_evaluator_constraint(r->m);
    ct_evaluator_dynamics(r->m);
    return ct_partition_inertias(r->s, r->e->is_small, inertia);
}

// The speed whose effective inertia has decreased most from its value with all small coordinates at
// zero. *part (out): the remaining fraction. -1: none has decreased to less than a tenth.
static int find_lost_inertia(struct ct_run *r, double *part)
{
    const size_t nu = r->m->nu;
    double *now = CT_NEWN(r->arena, double, nu + 1),
           *straight = CT_NEWN(r->arena, double, nu + 1);
    int speed = -1;
    // above this fraction a run does not end: steps decrease with the square root of the inertia
    *part = 0.1;
    ct_evaluator_set(r->m, r->stats.last_time, r->y);
    if (!find_inertias(r, now))
        return -1;
    for (size_t k = 0; k < nu; k++)
        if (r->e->is_small[k] && r->e->u[k].q >= 0)
            r->m->input[r->m->at_q + (size_t)r->e->u[k].q] = 0;
    if (!find_inertias(r, straight))
        return -1;
    for (size_t k = 0; k < nu; k++)
        if (straight[k] > 0 && now[k] < *part * straight[k]) {
            *part = now[k] / straight[k];
            speed = (int)k;
        }
    return speed;
}

// Adds a note if equations that are truncated to first order have lost the inertia of a speed, so
// that steps become too short: the speed, and the cure.
static bool note_lost_inertia(struct ct_run *r)
{
    double part;
    const int speed = find_lost_inertia(r, &part);
    if (speed < 0)
        return false;
    const struct ct_u *u = &r->e->u[speed];
    const struct ct_mark mark
        = u->joint >= 0 ? r->model->joint[u->joint].mark
        : u->beam > 0 || u->body > 0
            ? r->model->body[u->beam > 0 ? u->beam : u->body].instance.mark
            : (struct ct_mark){0};
    ct_note(
        r->ctx, mark,
        "at t = %.9g the effective inertia of '%s' is %.2g of its undeformed value: equations "
        "truncated to first order, by 'stretch-linear' or 'small', lose inertia as deflections "
        "grow; 'foreshortening', or no 'small', keeps all terms",
        r->stats.last_time, u->q >= 0 ? r->e->q[u->q].name : u->name, part);
    return true;
}

void ct_run_note_singular_start(struct ct_run *r, const char *joints)
{
    r->singular_joints = joints;
}

const char *ct_run_singular_joints(const struct ct_run *r)
{
    return r->singular_joints;
}

// Add a note if the run began in a bifurcation: J has a lower rank there than on each of the
// possible motions, and none of them was taken.
static void note_singular_start(struct ct_run *r)
{
    // a run that has moved by more than a unit, 1 rad or 1 m, has another cause
    const double way = r->stats.last_time * ct_vector_max_norm(r->y + r->m->nq, r->m->nu);
    if (r->singular_joints && way < 1)
        ct_note(r->ctx, (struct ct_mark){0},
                "the run began in a singular configuration, where constraints of %s are "
                "dependent and several motions are possible: start near it, with a joint off "
                "by 1e-3, on the wanted motion",
                r->singular_joints);
}

void ct_run_note_drivers(struct ct_run *r, double t, const double *y)
{
    enum { MOST = 3 }; // Limit: notes of a message
    int n = 0;
    ct_evaluator_set(r->m, ct_run_time_before_event(r, t), y);
    ct_program_run(&r->m->driver, r->m->input);
    for (size_t i = 0; i < r->e->ndriver && n < MOST; i++) {
        const struct ct_driver *d = &r->e->driver[i];
        if (r->m->driver.out[2 * i + 1] == 0)
            continue; // it does not move
        ct_note(r->ctx, d->mark, "'%s' is driven here, to %.6g at t = %.6g",
                r->model->joint[d->joint].name, r->m->driver.out[2 * i], t);
        n++;
    }
    // drivers of joints that are chords are rows
    for (size_t i = 0; i < r->model->njoint && n < MOST; i++) {
        const struct ct_instance *joint = &r->model->joint[i];
        bool is_known = !joint->cls->motion || !ct_instance_value(joint, "motion")->given;
        for (size_t k = 0; k < r->e->ndriver; k++)
            is_known |= r->e->driver[k].joint == (int)i;
        if (is_known)
            continue;
        ct_note(r->ctx, ct_instance_value(joint, "motion")->mark, "'%s' is driven here",
                joint->name);
        n++;
    }
}

// Steps of a method of order 2 are so short that round-off ends them long before those of others,
// near singular configurations first.
static void note_order(struct ct_run *r)
{
    if (r->method->order == 2)
        ct_note(
            r->ctx, (struct ct_mark){0},
            "steps of '%s', of order %d, are many times shorter than those of 'radau5' or "
            "'dop853' at this tolerance, and end in round-off before these do: if the motion "
            "goes on there, 'method: auto' may follow it",
            r->method->name, r->method->order);
}

static bool is_driven(const struct ct_run *r)
{
    for (size_t i = 0; i < r->model->njoint; i++) {
        const struct ct_instance *joint = &r->model->joint[i];
        if (joint->cls->motion && ct_instance_value(joint, "motion")->given)
            return true;
    }
    return false;
}

// Advice for a run that ended near a singular configuration. The motion of drivers that rest there,
// or whose acceleration jumps there, is not determined. If round-off ended the run a tolerance
// which is larger than the round-off there helps.
static const char *singular_advice(struct ct_run *r)
{
    // Definition: the largest tolerance that 'accuracy' compares, docs/cli.md; no advice above it
    const double most = 1e-2;
    const double part = r->singular->closest, enough = DBL_EPSILON / (part * part);
    const char *first = is_driven(r)
                          ? "; drivers may not rest there, nor jump in rate or "
                            "acceleration: let them do so a little before or after it"
                          : "";
    if (enough > r->o->output_rtol && enough < most)
        return ct_arena_printf(r->arena,
                               "%s; round-off has an effect there of %.0e: with a tolerance of "
                               "that, or a start farther from it, the run may go on",
                               first, enough);
    return ct_arena_printf(
        r->arena, "%s; with a larger tolerance, or a start farther from it, the run may go on",
        first);
}

void ct_run_explain_end(struct ct_run *r)
{
    const size_t n = r->ctx->ndiagnostic;
    const enum ct_code code = n ? r->ctx->diagnostic[n - 1].code : 0;
    const bool is_stuck
        = code == CT_E_STEP_COUNT || code == CT_E_STEP_SMALL || code == CT_E_STEP_SINGULAR;
    if (is_stuck && r->e->is_small && note_lost_inertia(r))
        return;
    if (code == CT_E_STEP_COUNT)
        ct_run_explain_count(r);
    if (code == CT_E_STEP_SMALL || code == CT_E_STEP_SINGULAR)
        note_order(r);
    if (!r->m->nrow)
        return;
    if (code == CT_E_LOCKED) {
        ct_run_note_drivers(r, r->stats.last_time, r->y);
        note_singular(r, "");
    } else if (code == CT_E_STEP_OPEN) {
        note_open_row(r);
        note_singular(r, singular_advice(r));
    } else if (code == CT_E_SAMPLE_REFUSED) {
        note_open_row(r);
        if (r->ctx->ndiagnostic == n)
            note_singular(r, "");
        ct_run_note_drivers(r, r->stats.last_time, r->y);
    } else if (code == CT_E_STEP_SMALL || code == CT_E_STEP_SINGULAR)
        note_singular(r, singular_advice(r));
    else if (code == CT_E_STEP_REFUSED)
        note_singular(r, ", which steps are not fitted to: leave out 'step'");
    if (is_stuck || code == CT_E_STEP_OPEN)
        note_singular_start(r);
}
