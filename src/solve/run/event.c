// Events of a run: switches change side, rates of drivers jump, and impulses change speeds. See
// run_internal.h.
#include "solve/run/run_internal.h"

#include "expr/print.h"

#include <string.h>

enum ct_eval ct_run_root(void *user, double t, const double *y, double *g)
{
    struct ct_run *r = user;
    ct_evaluator_set(r->m, ct_run_time_before_event(r, t), y);
    ct_program_run(&r->m->root, r->m->input);
    for (int i = 0; i < r->nroot; i++)
        g[i] = r->m->root.out[r->root_of[i]];
    if (r->m->has_rest) { // g at rest with its round-off
        const double size = ct_switches_size(r->m, y);
        for (int i = 0; i < r->nroot; i++)
            if (fabs(g[i]) <= r->m->at_rest[r->root_of[i]] * size)
                g[i] = 0;
    }
    return CT_EVAL_OK;
}

void ct_run_sides(void *user, signed char *side)
{
    const struct ct_run *r = user;
    const double *value = r->m->input + r->m->at_switch;
    for (int i = 0; i < r->nroot; i++)
        side[i]
            = (signed char)ct_switches_side(r->m, (size_t)r->root_of[i], value[r->root_of[i]]);
}

double ct_run_next_event(void *user, double t)
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

bool ct_run_tables_reach(struct ct_run *r, double t)
{
    const struct ct_exs *x = r->e->x;
    for (size_t k = 0; k < x->ntable; k++) {
        const struct ct_table *b = &x->table[k];
        const double last = b->x[b->n - 1];
        if (t >= last && t < r->o->duration && !b->holds)
            return ct_error(r->ctx, (struct ct_mark){.file = NULL}, CT_E_TABLE_END,
                            "at t = %.9g the run leaves the table '%s', whose column '%s' is "
                            "known from t = %.9g to %.9g",
                            t, b->file, b->column, b->x[0], last);
    }
    return true;
}

double ct_run_kinetic_energy(struct ct_run *r, double t, const double *y)
{
    ct_evaluator_set(r->m, t, y);
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

// A jump of a driven coordinate or its rate, or an open row after an event, that is still none [m,
// rad, 1/s]. Speeds follow the sum of all jumps of a rate, those of a finely sampled table among
// them: a larger value leaves out more of it.
// Default: round-off of tables and functions against jumps that are meant. Test: cubic_table
const double ct_run_jump_tolerance = 1e-9;

bool ct_run_report_jump(struct ct_run *r, const char *name, struct ct_mark mark, double jump,
                        double t)
{
    return ct_error(
        r->ctx, mark, CT_E_DRIVER_JUMP,
        "the motion '%s' jumps by %.6g at t = %.9g: a coordinate cannot change instantaneously",
        name, jump, t);
}

// Are all rows still closed after an event, but for round-off of tables and functions? They were
// before it: an open row belongs to a joint that is a chord and whose driver jumps.
bool ct_run_chords_are_closed(struct ct_run *r, double t)
{
    const struct ct_row *row = r->e->row;
    for (size_t i = 0; i < r->m->nrow; i++)
        if (fabs(r->m->phi[i]) > ct_run_jump_tolerance) {
            const struct ct_instance *joint
                = row[i].joint < 0 ? NULL : &r->model->joint[row[i].joint];
            const bool is_driven = joint && joint->cls->motion;
            return ct_run_report_jump(r, is_driven ? joint->name : row[i].name,
                                      is_driven ? ct_instance_value(joint, "motion")->mark
                                                : (struct ct_mark){.file = r->model->file},
                                      -r->m->phi[i], t);
        }
    return true;
}

// Sides of switches after an impulse: speeds have jumped, possibly over roots of switches.
static enum ct_eval switch_at_new_speeds(struct ct_run *r, double t, const double *y)
{
    const enum ct_eval e = ct_run_rhs(r, t, y, r->dy);
    memset(r->crossed, 0, r->e->nswitch * sizeof *r->crossed);
    if (e == CT_EVAL_OK)
        ct_switches_start(r->m, t, y, r->dy, r->crossed);
    return e;
}

// Driven values after a change of switches. With an impulse or without, the speeds must fit the new
// rates. (8.5)
static enum ct_eval apply_impulse(struct ct_run *r, double t, double *y, const double *before,
                                  const double *momentum)
{
    struct ct_evaluator *m = r->m;
    ct_evaluator_set(m, t, y);
    ct_program_run(&m->driver, m->input);
    for (size_t i = 0; i < r->e->ndriver; i++)
        if (fabs(m->driver.out[2 * i] - before[2 * i])
            > ct_run_jump_tolerance * fmax(1, fabs(before[2 * i]))) {
            ct_run_report_jump(r, r->e->driver[i].name, r->e->driver[i].mark,
                               m->driver.out[2 * i] - before[2 * i], t);
            return CT_EVAL_FATAL;
        }
    ct_evaluator_constraint(m);
    if (!ct_run_chords_are_closed(r, t))
        return CT_EVAL_FATAL;
    double worst = largest_jump(r, before, 1);
    for (size_t i = 0; i < m->nrow; i++)
        worst = fmax(worst, fabs(m->v[i]));
    if (worst <= ct_run_jump_tolerance)
        return CT_EVAL_OK;
    r->has_jumped = true;
    const enum ct_eval e = ct_impulse_apply(r, momentum, y + m->nq);
    return e == CT_EVAL_OK ? switch_at_new_speeds(r, t, y) : e;
}

// Reports that on both sides of switch i the force leads back to it (dry friction at rest): f
// describes no such motion.
static enum ct_eval report_held(struct ct_run *r, double t, int i)
{
    const struct ct_switch *held = &r->e->switches[i];
    ct_error(
        r->ctx, held->mark.file ? held->mark : (struct ct_mark){.file = r->model->file},
        CT_E_STUCK,
        "at t = %.9g the motion is held where '%s' changes sign: on both sides the forces lead "
        "back; let the force change over a small range, as tanh(u/0.001) does for sign(u)",
        t, ct_ex_text(r->arena, r->e->x, held->written, NULL));
    return CT_EVAL_FATAL;
}

// The sides were chosen for the derivative before they changed. A switch that the derivative with
// the new sides contradicts goes to the other side; if it is contradicted there, too, it holds the
// motion. A switch that has just crossed has come from its other side, from where the motion leads
// here.
enum ct_eval ct_run_settle_switches(struct ct_run *r, double t, const double *y,
                                    const signed char *crossed)
{
    // Derived: the first visit goes to the other side, the second comes back; between them other
    // switches with a root here may have changed
    enum { VISITS = 3 };
    if (!r->nroot)
        return CT_EVAL_OK;
    for (size_t i = 0; i < r->e->nswitch; i++)
        r->visits[i] = crossed && crossed[i] ? VISITS - 1 : 0;
    for (;;) {
        const enum ct_eval e = ct_run_rhs(r, t, y, r->dy);
        if (e != CT_EVAL_OK)
            return e;
        const int i = ct_switches_find_contradicted(r->m, t, y, r->dy);
        if (i < 0)
            return CT_EVAL_OK;
        if (++r->visits[i] == VISITS)
            return report_held(r, t, i);
        ct_switches_follow(r->m, (size_t)i);
    }
}

enum ct_eval ct_run_resumed(void *user, double t, const double *y, const double *dy)
{
    struct ct_run *r = user;
    const int i = ct_switches_find_contradicted(r->m, t, y, dy);
    return i < 0 ? CT_EVAL_OK : report_held(r, t, i);
}

// Predict the next singular configuration again after a jump of speeds.
static enum ct_eval look_ahead(struct ct_run *r, double t, const double *y)
{
    const enum ct_eval e = ct_run_rhs(r, t, y, r->dy);
    if (e != CT_EVAL_OK)
        return e;
    ct_rank_monitor_reset(r->singular, t, y, r->dy);
    ct_evaluator_set(r->m, t, y);
    return CT_EVAL_OK;
}

// Sides at y, whose derivative is dy: that of a crossed root is known; the others follow from the
// direction of the motion.
static void set_sides(struct ct_run *r, double t, const double *y, const double *dy,
                      const signed char *crossed)
{
    r->pending = ct_run_next_event(r, t);
    for (int i = 0; i < r->nroot; i++)
        r->crossed[r->root_of[i]] = crossed[i];
    ct_switches_start(r->m, t, y, dy, r->crossed);
}

// Sides after an event on a crossing of a singular configuration. The motion of drivers is known in
// advance, and no speed jumps.
static enum ct_eval switch_in_gap(struct ct_run *r, double t, const double *y, const double *dy,
                                  const signed char *crossed)
{
    ct_evaluator_set(r->m, ct_run_time_before_event(r, t), y);
    set_sides(r, t, y, dy, crossed);
    ct_run_store_angle_rate(r, t, y);
    return CT_EVAL_OK;
}

enum ct_eval ct_run_event(void *user, double t, double *y, const double *dy,
                          const signed char *crossed, bool is_time)
{
    struct ct_run *r = user;
    struct ct_evaluator *m = r->m;
    r->last_event = t;
    if (dy)
        return switch_in_gap(r, t, y, dy, crossed);
    double *before = r->scratch + m->nu, *momentum = before + 2 * r->e->ndriver;
    ct_run_monitor_base(r, t, y, CT_MONITOR_EVENT);
    ct_evaluator_set(m, ct_run_time_before_event(r, t), y);
    ct_program_run(&m->driver, m->input);
    memcpy(before, m->driver.out, m->driver.nout * sizeof *before);
    ct_program_run(&m->momentum, m->input);
    memcpy(momentum, m->momentum.out, m->momentum.nout * sizeof *momentum);
    const double kinetic = ct_run_kinetic_energy(r, ct_run_time_before_event(r, t), y);

    if (!ct_run_tables_reach(r, t))
        return CT_EVAL_FATAL;
    enum ct_eval e = ct_run_rhs(r, t, y, r->dy);
    if (e != CT_EVAL_OK)
        return e;
    set_sides(r, t, y, r->dy, crossed);
    e = apply_impulse(r, t, y, before, momentum);
    if (e != CT_EVAL_OK)
        return e;
    y[r->ny - 1] += ct_run_kinetic_energy(r, t, y) - kinetic;
    ct_run_monitor_impulse(r, t, y);
    ct_run_store_angle_rate(r, t, y);
    // at a time event forces jump, and a root function may reverse
    e = ct_run_settle_switches(r, t, y, is_time ? NULL : r->crossed);
    if (e == CT_EVAL_OK && m->nrow && r->o->step == 0)
        e = look_ahead(r, t, y);
    return e;
}
