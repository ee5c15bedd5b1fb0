// Beams watched during a run: slopes, indicators of linear ones, and the error that these will have. See run.h.
//
// Indicators and slopes are looked at with each sample; what foretells the error follows the base from step to step.
#include "formulate/recoil.h"
#include "formulate/validity.h"
#include "solve/run.h"

static const double two_pi = 6.283185307179586;

void ct_slope_watch(struct ct_slope_report *report, const struct ct_machine *m, double t)
{
    const double *square = m->validity.out + m->e->nvalidity;
    for (size_t i = 0; i < m->e->nbend; i++) {
        for (size_t k = 0; k < m->e->bend[i].n; k++)
            report[i].largest = fmax(report[i].largest, sqrt(*square++));
        if (report[i].largest > CT_SLOPE_LIMIT && report[i].passed_at < 0)
            report[i].passed_at = t;
    }
}

// Averaged over a period of the beam: what rings faster than it can follow does not count. The mean comes late by that
// period; the beam has left from where on the indicator itself is beyond the limit.
static void watch_indicator(const struct ct_run *r, size_t i, double t)
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

void ct_run_watch_sample(struct ct_run *r, double t)
{
    if (!r->m->validity.nout)
        return;
    ct_program_run(&r->m->validity, r->m->input);
    ct_slope_watch(r->report->bend, r->m, t);
    for (size_t i = 0; i < r->e->nvalidity; i++)
        watch_indicator(r, i, t);
    r->t_sample = t;
}

// ---- the error foretold -------------------------------------------------------------------------------------

void ct_run_watch_start(struct ct_run *r, double t, const double *y)
{
    struct ct_run_report *report = r->report;
    const struct ct_equations *e = r->e;
    report->validity = CT_NEWN(r->arena, struct ct_validity_report, e->nvalidity + 1);
    report->bend = CT_NEWN(r->arena, struct ct_slope_report, e->nbend + 1);
    for (size_t i = 0; i < e->nbend; i++)
        report->bend[i].passed_at = -1;
    for (size_t i = 0; i < e->nvalidity; i++) {
        struct ct_validity_report *v = &report->validity[i];
        v->beyond_since = v->left_at = v->off_since = -1;
        if (e->validity[i].recoil)
            v->recoil = ct_recoil_run_create(r->arena, e->validity[i].recoil);
    }
    ct_run_watch_base(r, t, y, CT_WATCH_START);
}

// out (11) of the program `carried`: the base's motion, the beam's end. start: x, x' by shape.
static void follow(const struct ct_validity *v, struct ct_validity_report *report, double t,
                   const double *out, const double *start, enum ct_watch_when how)
{
    struct ct_swings *s = &report->swings;
    if (how == CT_WATCH_KEPT && !v->recoil) {
        ct_swings_regrip(s, out);
        return;
    }
    if (how == CT_WATCH_START)
        ct_validity_begin(v, start, s);
    if (v->recoil && how == CT_WATCH_START)
        ct_recoil_begin(report->recoil, s);
    else if (v->recoil)
        ct_recoil_follow(report->recoil, s, t, ct_validity_glance(v));
    else
        ct_swings_follow(s, t, out);
    if (how == CT_WATCH_START && v->settles)
        ct_swings_settle(s);
    ct_swings_compare(s, out + 9);
    const bool is_off = ct_swings_error(s, CT_SWING_LINEAR) > CT_VALIDITY_LIMIT;
    if (!is_off)
        report->off_since = -1;
    else if (report->off_since < 0)
        report->off_since = t;
}

// Is beam i looked at now?
static bool is_due(const struct ct_run *r, size_t i, double t, enum ct_watch_when how)
{
    const struct ct_validity *v = &r->e->validity[i];
    return v->foretells
        && (how != CT_WATCH_STEP
            || t - r->report->validity[i].swings.t >= ct_validity_glance(v));
}

void ct_run_watch_base(struct ct_run *r, double t, const double *y, enum ct_watch_when how)
{
    bool any = false;
    if (!r->m->carried.nout || r->trial) // a trial meets events of a motion that starts again
        return;
    for (size_t i = 0; i < r->e->nvalidity; i++)
        any |= is_due(r, i, t, how);
    if (!any)
        return;
    ct_machine_set(r->m, ct_run_before(r, t), y);
    ct_program_run(&r->m->carried, r->m->input);
    if (how == CT_WATCH_START)
        ct_program_run(&r->m->poised, r->m->input);
    const double *out = r->m->carried.out, *start = r->m->poised.out;
    for (size_t i = 0; i < r->e->nvalidity; i++) {
        if (is_due(r, i, t, how))
            follow(&r->e->validity[i], &r->report->validity[i], t, out, start, how);
        if (r->e->validity[i].foretells) {
            out += 11;
            start += 2 * r->e->validity[i].nshape;
        }
    }
}

void ct_run_watch_jump(struct ct_run *r, double t, const double *y)
{
    ct_run_watch_base(r, t, y,
                      r->o->rate_jumps == CT_RATE_CONTINUOUS ? CT_WATCH_KEPT : CT_WATCH_EVENT);
}
