// Events of a run: switches change side, rates of drivers jump, and impulses change speeds. See
// run_internal.h.
#include "solve/run/run_internal.h"

#include "expr/print.h"
#include "numeric/roundoff.h"

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

// Pieces of a function meet to within the digits of its numbers. Such jumps do not add up, since a
// driven coordinate is known for each time.
bool ct_run_is_coordinate_jump(double jump, double size)
{
    return fabs(jump) > CT_HALF_DIGITS * fmax(1, fabs(size));
}

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
        if (ct_run_is_coordinate_jump(r->m->phi[i], 0)) {
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

// What an event may change, just before it: values and rates of drivers alternating, the rates of
// rows without speeds (dPhi/dt), momenta.
struct before_event {
    double *driver, *momentum, *phi_t; // (2 ndriver), (momentum.nout), (nrow)
};

// phi_t (nrow) at t, y: drivers that are chords have their rate there. Leaves t, y set.
static void find_phi_t(struct ct_evaluator *m, double t, const double *y, double *phi_t)
{
    if (!m->nrow)
        return;
    memset(m->input + m->at_u, 0, m->nu * sizeof *m->input);
    ct_evaluator_constraint(m);
    memcpy(phi_t, m->v, m->nrow * sizeof *phi_t);
    ct_evaluator_set(m, t, y);
}

// Do two rates differ by more than their round-off? Speeds follow the sum of all jumps of a rate,
// those of a finely sampled table among them: no jump is too small to count.
static bool rates_differ(double a, double b)
{
    // Derived: round-off of the few operations of a slope or a function, in units of the last
    // digit. An impulse for one that is more than that and still round-off changes speeds by
    // round-off.
    enum { ROUNDOFF = 8 };
    return fabs(a - b) > ROUNDOFF * DBL_EPSILON * fmax(fabs(a), fabs(b));
}

static bool has_rate_jump(const struct ct_run *r, const struct before_event *before,
                          const double *phi_t)
{
    bool has = false;
    for (size_t i = 0; i < r->e->ndriver; i++)
        has |= rates_differ(before->driver[2 * i + 1], r->m->driver.out[2 * i + 1]);
    for (size_t i = 0; i < r->m->nrow; i++)
        has |= rates_differ(before->phi_t[i], phi_t[i]);
    return has;
}

// Do speeds u (nu) differ from u0 (nu) by more than the tolerance of the run?
static bool exceeds_tolerance(const struct ct_run *r, const double *u0, const double *u)
{
    bool exceeds = false;
    for (size_t i = 0; i < r->m->nu; i++)
        exceeds |= fabs(u[i] - u0[i]) > r->o->rtol * fmax(fabs(u0[i]), fabs(u[i])) + r->o->atol;
    return exceeds;
}

// Driven values after a change of switches. With an impulse or without, the speeds must fit the new
// rates. (8.5)
static enum ct_eval apply_impulse(struct ct_run *r, double t, double *y,
                                  const struct before_event *before)
{
    struct ct_evaluator *m = r->m;
    ct_evaluator_set(m, t, y);
    ct_program_run(&m->driver, m->input);
    for (size_t i = 0; i < r->e->ndriver; i++) {
        const double jump = m->driver.out[2 * i] - before->driver[2 * i];
        if (ct_run_is_coordinate_jump(jump, before->driver[2 * i])) {
            ct_run_report_jump(r, r->e->driver[i].name, r->e->driver[i].mark, jump, t);
            return CT_EVAL_FATAL;
        }
    }
    double *u0 = r->scratch, *phi_t = before->phi_t + m->nrow;
    find_phi_t(m, t, y, phi_t);
    ct_evaluator_constraint(m);
    if (!ct_run_chords_are_closed(r, t))
        return CT_EVAL_FATAL;
    if (!has_rate_jump(r, before, phi_t))
        return CT_EVAL_OK;
    memcpy(u0, y + m->nq, m->nu * sizeof *u0);
    const enum ct_eval e = ct_impulse_apply(r, before->momentum, y + m->nq);
    if (e != CT_EVAL_OK)
        return e;
    r->has_jumped |= exceeds_tolerance(r, u0, y + m->nq);
    return switch_at_new_speeds(r, t, y);
}

// Reports that on both sides of switch i the force leads back to it (dry friction at rest): f
// describes no such motion.
static enum ct_eval report_stuck(struct ct_run *r, double t, int i)
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

// The sides were chosen for the derivative before they changed. If the derivative with the new
// sides leads a switch back, the switch changes its side again. If the derivative leads it back
// from that side, too, the motion is stuck: an error. A switch that has just crossed its root is
// known to be led back from its previous side.
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
            return report_stuck(r, t, i);
        ct_switches_follow(r->m, (size_t)i);
    }
}

enum ct_eval ct_run_resumed(void *user, double t, const double *y, const double *dy)
{
    struct ct_run *r = user;
    const int i = ct_switches_find_contradicted(r->m, t, y, dy);
    return i < 0 ? CT_EVAL_OK : report_stuck(r, t, i);
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
    const double t_before = ct_run_time_before_event(r, t);
    struct before_event before = {.driver = r->scratch + m->nu};
    before.momentum = before.driver + m->driver.nout;
    before.phi_t = before.momentum + m->momentum.nout;
    ct_run_monitor_base(r, t, y, CT_MONITOR_EVENT);
    ct_evaluator_set(m, t_before, y);
    ct_program_run(&m->driver, m->input);
    memcpy(before.driver, m->driver.out, m->driver.nout * sizeof *before.driver);
    ct_program_run(&m->momentum, m->input);
    memcpy(before.momentum, m->momentum.out, m->momentum.nout * sizeof *before.momentum);
    find_phi_t(m, t_before, y, before.phi_t);
    const double kinetic = ct_run_kinetic_energy(r, t_before, y);

    if (!ct_run_tables_reach(r, t))
        return CT_EVAL_FATAL;
    enum ct_eval e = ct_run_rhs(r, t, y, r->dy);
    if (e != CT_EVAL_OK)
        return e;
    set_sides(r, t, y, r->dy, crossed);
    e = apply_impulse(r, t, y, &before);
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
