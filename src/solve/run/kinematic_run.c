// Kinematic analysis, runs in which everything is driven: positions, speeds and accelerations
// follow from the rows, sample by sample, and only the work is integrated. See ct_run_kinematic in
// run.h.
#include "solve/run/run_internal.h"

#include "integrate/crossing.h"

#include <string.h>

static bool check_driven(struct ct_run *r)
{
    if (r->e->nstate)
        return ct_error(
            r->ctx, r->model->state[0].mark, CT_E_OF_STATES,
            "what follows from driven motions alone is found sample by sample, and the "
            "state '%s' would have to be integrated: take 'simulate'",
            r->model->state[0].name);
    if (r->s->rank == (int)r->m->nu)
        return true;
    const struct ct_u *u = &r->e->u[r->s->independent[0]];
    const struct ct_mark mark = u->joint >= 0 ? r->model->joint[u->joint].mark
                              : u->body >= 0  ? r->model->body[u->body].instance.mark
                                              : (struct ct_mark){.file = r->model->file};
    if (u->beam > 0)
        return ct_error(r->ctx, r->model->body[u->beam].instance.mark, CT_E_NOT_DRIVEN,
                        "not all freedoms are driven: %d left, such as '%s' of the beam '%s'; "
                        "'deformation: []' makes it rigid",
                        (int)r->m->nu - r->s->rank, r->e->q[u->q].name,
                        r->model->body[u->beam].instance.name);
    return ct_error(r->ctx, mark, CT_E_NOT_DRIVEN,
                    "not all freedoms are driven: %d left, such as '%s'; give each a 'motion'",
                    (int)r->m->nu - r->s->rank, u->q >= 0 ? r->e->q[u->q].name : u->name);
}

// The tangent basis at y.
static void find_basis(struct ct_run *r, double t, const double *y, struct ct_tangent_basis *v)
{
    ct_evaluator_set(r->m, ct_run_time_before_event(r, t), y);
    ct_evaluator_constraint(r->m);
    ct_partition_pivot(r->s);
    ct_tangent_basis_find(r->s, v);
}

// Has a step of this length [rad or m] led to another assembly mode? The test function of singular
// configurations has different signs in two modes. If it changes its sign over a shorter step, the
// mechanism moves through a singular configuration, which is allowed.
static bool has_jumped(struct ct_run *r, double t1, const double *y1, double length)
{
    find_basis(r, t1, y1, r->basis[1]);
    return ct_singularity_test_sign_changed(r->s, r->basis[0], r->basis[1])
        && length > sqrt(ct_crossing_mismatch_limit);
}

// One step of kinematic analysis, from y at t to t1: extrapolation to second order, then projection
// onto the constraints. False if the step is too long, the correction too large, or the end belongs
// to another assembly mode.
static bool advance_step(struct ct_run *r, double t, double t1, const double *y, double *out)
{
    // Largest change of a coordinate [rad or m]. Default: number of steps against a jump to another
    // assembly mode. Test: kinematic_steps
    const double longest = 0.3;
    // Part of the step that the projection may correct. Default: as above. Test: rate_jumps
    const double part = 0.25;
    const size_t nq = r->m->nq, nu = r->m->nu;
    const double h = t1 - t;
    double most = 0, worst = 0, *d = r->scratch;
    memcpy(out, y, r->ny * sizeof *y);
    if (!nu) // constraints between driven coordinates only: they can be checked, not satisfied
        return ct_partition_project(r->s, ct_run_time_before_event(r, t1), out) == CT_EVAL_OK;
    if (ct_partition_accelerate_at(r->s, ct_run_time_before_event(r, t), y) != CT_EVAL_OK)
        return false;
    for (size_t k = 0; k < nu; k++) {
        d[k] = h * (y[nq + k] + h / 2 * r->s->a[k]);
        out[nq + k] += h * r->s->a[k];
        most = fmax(most, fabs(d[k]));
    }
    if (!(most <= longest))
        return false;
    ct_evaluator_retract(r->m, out, d);
    memcpy(r->stage, out, nq * sizeof *out);
    if (ct_partition_project(r->s, ct_run_time_before_event(r, t1), out) != CT_EVAL_OK)
        return false;
    for (size_t i = 0; i < nq; i++)
        worst = fmax(worst, fabs(out[i] - r->stage[i]));
    // corrections of round-off where nothing moves
    return worst <= part * most + CT_HALF_DIGITS && !has_jumped(r, t1, out, most);
}

static bool advance_to(struct ct_run *r, double t, double t1, double *y)
{
    const double least = 1e-9; // Limit: part of the interval; shorter steps are an error
    double h = t1 - t, *next = r->next;
    ct_run_store_angle_rate(r, t, y);
    find_basis(r, t, y, r->basis[0]);
    while (t < t1) {
        h = fmin(h, ct_run_longest_step(r));
        const double end = h >= t1 - t ? t1 : t + h;
        if (!advance_step(r, t, end, y, next) || !ct_run_turns_are_followed(r, end, next)) {
            h = (end - t) / 2;
            if (h > least * (t1 - t) && t + h > t)
                continue;
            r->stats.last_time = t;
            return ct_error(
                r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SAMPLE_REFUSED,
                "the mechanism cannot follow its motions beyond t = %.9g: it is at the end of "
                "its "
                "reach, its motions contradict each other, or links stand in one line; change "
                "the motions or the lengths",
                t);
        }
        struct ct_tangent_basis *before = r->basis[0];
        r->basis[0] = r->basis[1];
        r->basis[1] = before;
        memcpy(y, next, r->ny * sizeof *y);
        ct_evaluator_set(r->m, ct_run_time_before_event(r, end), y);
        ct_memory_update(r->m);
        h = 2 * (end - t);
        t = end;
    }
    return true;
}

// Work over an interval without events: Gauss's formula with three nodes.
static bool advance_with_work(struct ct_run *r, double t, double t1, double *y)
{
    static const double node[] = {0.1127016653792583, 0.5, 0.8872983346207417},
                        weight[] = {5. / 18, 8. / 18, 5. / 18};
    double work = 0, now = t;
    for (int i = 0; i < 3 && r->has_power; i++) {
        const double at = t + node[i] * (t1 - t);
        if (!advance_to(r, now, at, y))
            return false;
        now = at;
        if (ct_partition_accelerate_at(r->s, ct_run_time_before_event(r, at), y) != CT_EVAL_OK)
            return ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SINGULAR,
                            "the equations are singular at t = %.9g", at);
        ct_run_find_multipliers(r);
        ct_program_run(&r->m->power, r->m->input);
        work += weight[i] * (t1 - t) * r->m->power.out[0];
    }
    if (!advance_to(r, now, t1, y))
        return false;
    y[r->ny - 1] += work;
    return true;
}

// Sides after an event. The driven coordinates must not jump there. Their rates may: that is an
// impulse, whose work is added.
static bool pass_event(struct ct_run *r, double t, double *y)
{
    struct ct_evaluator *m = r->m;
    double *before = r->scratch + m->nu;
    ct_evaluator_set(m, ct_run_time_before_event(r, t), y);
    ct_program_run(&m->driver, m->input);
    memcpy(before, m->driver.out, m->driver.nout * sizeof *before);
    const double kinetic = ct_run_kinetic_energy(r, ct_run_time_before_event(r, t), y);
    r->pending = ct_run_next_event(r, t);
    if (!ct_run_tables_reach(r, t))
        return false;
    ct_switches_start(m, t, y, NULL, NULL);
    ct_evaluator_set(m, t, y);
    ct_program_run(&m->driver, m->input);
    for (size_t i = 0; i < r->e->ndriver; i++) {
        const double jump = m->driver.out[2 * i] - before[2 * i];
        if (ct_run_is_coordinate_jump(jump, before[2 * i]))
            return ct_run_report_jump(r, r->e->driver[i].name, r->e->driver[i].mark, jump, t);
    }
    ct_evaluator_constraint(m);
    if (!ct_run_chords_are_closed(r, t))
        return false;
    if (ct_partition_project(r->s, t, y) != CT_EVAL_OK) {
        r->stats.last_time = t;
        return ct_error(r->ctx, (struct ct_mark){.file = r->model->file}, CT_E_SAMPLE_REFUSED,
                        "the mechanism cannot follow its motions at t = %.9g", t);
    }
    y[r->ny - 1] += ct_run_kinetic_energy(r, t, y) - kinetic;
    return true;
}

static bool run_kinematic(struct ct_run *r, const struct ct_run_options *o,
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
    for (size_t i = 0; i < COUNT(r->basis); i++) {
        r->basis[i] = ct_tangent_basis_create(r->arena);
        ct_tangent_basis_reserve(r->s, r->basis[i]);
    }
    r->nevent = ct_time_events(r->arena, r->m, 0, 0, o->duration, &r->event);
    r->pending = ct_run_next_event(r, 0);
    if (!ct_run_tables_reach(r, 0))
        return false;
    ct_switches_start(r->m, 0, r->y, NULL, NULL);
    if (!check_driven(r))
        return false;
    double t = 0;
    for (size_t i = 0; i < o->nsample; i++) {
        const double end = ct_run_sample_time(o, i);
        while (r->pending <= end) {
            const double event = r->pending;
            if (!advance_with_work(r, t, event, r->y) || !pass_event(r, event, r->y))
                return false;
            t = event;
        }
        if (!advance_with_work(r, t, end, r->y))
            return false;
        t = end;
        ct_switches_start(r->m, t, r->y, NULL, NULL);
        if (!ct_run_at_sample(r, t, r->y) || !ct_run_at_step(r, t, r->y))
            return false;
    }
    report->switches = r->s->switches;
    report->factorizations = r->s->factorizations;
    report->stats.evaluations = r->m->evaluations;
    if (r->energy_scale > 0)
        report->energy_drift /= r->energy_scale;
    return true;
}

bool ct_run_kinematic(struct ct_run *r, const struct ct_run_options *o,
                      struct ct_run_report *report)
{
    const bool ok = run_kinematic(r, o, report);
    if (!ok)
        ct_run_explain_end(r);
    return ok;
}
