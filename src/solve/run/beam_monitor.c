// Monitoring of beams during a run: largest slopes, validity indicators of linear beams, and their
// estimated error. See run_internal.h.
//
// Indicators and slopes are evaluated at samples. The estimated error depends on the motion of the
// beam's base, so it is updated at every step.
#include "beam_error/beam_error_coupled.h"
#include "beam_error/validity.h"
#include "solve/run/run_internal.h"

static const double two_pi = 6.283185307179586; // Definition: of mathematics

void ct_slope_monitor(struct ct_slope_report *report, const struct ct_evaluator *m, double t)
{
    const double *square = m->validity.out + m->e->nvalidity;
    for (size_t i = 0; i < m->e->nbent_beam; i++) {
        for (size_t k = 0; k < m->e->bent_beam[i].n; k++)
            report[i].largest = fmax(report[i].largest, sqrt(*square++));
        if (report[i].largest > CT_SLOPE_LIMIT && report[i].passed_at < 0)
            report[i].passed_at = t;
    }
}

// The indicator is averaged over a period of the beam, so that faster vibrations do not count. The
// mean comes late by that period: the time reported is that from which on the indicator itself has
// been beyond the limit.
static void monitor_indicator(const struct ct_run *r, size_t i, double t)
{
    struct ct_validity_report *v = &r->report->validity[i];
    const double now = r->m->validity.out[i], period = two_pi / r->e->validity[i].omega;
    const double share = r->ngiven ? -expm1(-(t - r->t_sample) / period) : 1;
    v->mean += share * (now - v->mean);
    v->largest = fmax(v->largest, fabs(v->mean));
    if (fabs(now) <= CT_VALIDITY_LIMIT)
        v->beyond_since = -1;
    else if (v->beyond_since < 0)
        v->beyond_since = t;
    if (v->largest > CT_VALIDITY_LIMIT && v->left_at < 0)
        v->left_at = v->beyond_since < 0 ? t : v->beyond_since;
}

void ct_run_monitor_sample(struct ct_run *r, double t)
{
    if (!r->m->validity.nout)
        return;
    ct_program_run(&r->m->validity, r->m->input);
    ct_slope_monitor(r->report->slopes, r->m, t);
    for (size_t i = 0; i < r->e->nvalidity; i++)
        monitor_indicator(r, i, t);
    r->t_sample = t;
}

// ---- the error estimated ------------------------------------------------------------------------

void ct_run_monitor_start(struct ct_run *r, double t, const double *y)
{
    struct ct_run_report *report = r->report;
    const struct ct_equations *e = r->e;
    report->validity = CT_NEWN(r->arena, struct ct_validity_report, e->nvalidity + 1);
    report->slopes = CT_NEWN(r->arena, struct ct_slope_report, e->nbent_beam + 1);
    for (size_t i = 0; i < e->nbent_beam; i++)
        report->slopes[i].passed_at = -1;
    for (size_t i = 0; i < e->nvalidity; i++) {
        struct ct_validity_report *v = &report->validity[i];
        v->beyond_since = v->left_at = v->error_beyond_since = -1;
        if (e->validity[i].coupled)
            v->coupled = ct_beam_error_coupled_run_create(r->arena, e->validity[i].coupled);
    }
    ct_run_monitor_base(r, t, y, CT_MONITOR_START);
}

// out (11) of the program `base_motion`: the base's motion, the beam's end. start: x, x' by shape.
static void advance_error(const struct ct_validity *v, struct ct_validity_report *report,
                          double t, const double *out, const double *start,
                          enum ct_monitor_when how)
{
    struct ct_beam_error_modal *s = &report->modal;
    if (how == CT_MONITOR_SMOOTH && !v->coupled) {
        ct_beam_error_modal_reset_base(s, out);
        return;
    }
    if (how == CT_MONITOR_START)
        ct_validity_begin(v, start, s);
    if (v->coupled && how == CT_MONITOR_START)
        ct_beam_error_coupled_begin(report->coupled, s);
    else if (v->coupled)
        ct_beam_error_coupled_advance(report->coupled, s, t, ct_validity_interval(v));
    else
        ct_beam_error_modal_advance(s, t, out);
    if (how == CT_MONITOR_START && v->starts_static)
        ct_beam_error_modal_start_static(s);
    ct_beam_error_modal_compare(s, out + 9);
    const bool is_off = ct_beam_error_modal_error(s, CT_BEAM_MODEL_LINEAR) > CT_VALIDITY_LIMIT;
    if (!is_off)
        report->error_beyond_since = -1;
    else if (report->error_beyond_since < 0)
        report->error_beyond_since = t;
}

// Is the error of beam i estimated at this time?
static bool is_due(const struct ct_run *r, size_t i, double t, enum ct_monitor_when how)
{
    const struct ct_validity *v = &r->e->validity[i];
    return v->estimates_error
        && (how != CT_MONITOR_STEP
            || t - r->report->validity[i].modal.t >= ct_validity_interval(v));
}

void ct_run_monitor_base(struct ct_run *r, double t, const double *y, enum ct_monitor_when how)
{
    bool any = false;
    if (!r->m->base_motion.nout
        || r->trial) // a trial integrates a part of the motion that is repeated later
        return;
    for (size_t i = 0; i < r->e->nvalidity; i++)
        any |= is_due(r, i, t, how);
    if (!any)
        return;
    ct_evaluator_set(r->m, ct_run_time_before_event(r, t), y);
    ct_program_run(&r->m->base_motion, r->m->input);
    if (how == CT_MONITOR_START)
        ct_program_run(&r->m->beam_mode_state, r->m->input);
    const double *out = r->m->base_motion.out, *start = r->m->beam_mode_state.out;
    for (size_t i = 0; i < r->e->nvalidity; i++) {
        if (is_due(r, i, t, how))
            advance_error(&r->e->validity[i], &r->report->validity[i], t, out, start, how);
        if (r->e->validity[i].estimates_error) {
            out += 11;
            start += 2 * r->e->validity[i].nshape;
        }
    }
}

void ct_run_monitor_impulse(struct ct_run *r, double t, const double *y)
{
    ct_run_monitor_base(
        r, t, y, r->o->rate_jumps == CT_RATE_CONTINUOUS ? CT_MONITOR_SMOOTH : CT_MONITOR_EVENT);
}
