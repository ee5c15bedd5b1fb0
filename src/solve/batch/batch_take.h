// Functions over the run in lanes: interpolants of all lanes, evaluated where the scan of any lane
// asks for it. Included by batch_step.c.
#ifndef CT_SOLVE_BATCH_BATCH_TAKE_H
#define CT_SOLVE_BATCH_BATCH_TAKE_H

#include "solve/batch/batch_solver.h"

// The point of the step at theta of each lane: ct_dense_tableau.
static inline void interpolate_step(struct ct_batch *s, vec theta, vec *out)
{
    const vec rest = 1 - theta, bubble = theta * theta * rest * rest;
    const int n = s->ny;
    for (int i = 0; i < n; i++) {
        const vec *F = s->take.F + i;
        const vec rise = s->end[i] - s->y[i], bend = s->h * s->dy[i] - rise;
        const vec cubic
            = s->y[i]
            + theta * (rise + rest * (bend + theta * (rise - s->h * s->dend[i] - bend)));
        out[i]
            = cubic + bubble * (F[0] + theta * (F[n] + rest * (F[2 * n] + theta * F[3 * n])));
    }
}

// The next times at which scans of these lanes need values, in t (inout). Returns the lanes that
// need one.
static inline set ask_scans(const struct ct_batch *s, set lanes, vec *t)
{
    set asked = 0;
    for (int l = 0; l < W; l++) {
        double when;
        if (!ct_has_lane(lanes, l) || !ct_take_scan_wants(s->take.scan[l], &when))
            continue;
        (*t)[l] = when;
        asked |= 1u << l;
    }
    return asked;
}

// Passes values of the functions to the scans of these lanes. Returns the lanes with values that
// are not finite.
static inline set answer_scans(struct ct_batch *s, set asked)
{
    set lost = 0;
    for (int l = 0; l < W; l++) {
        if (!ct_has_lane(asked, l))
            continue;
        bool is_good = true;
        ct_lane_take(s->take.one, s->take.program.out, l, s->take.n);
        for (size_t i = 0; i < s->take.n; i++)
            is_good &= isfinite(s->take.one[i]);
        if (is_good)
            ct_take_scan_give(s->take.scan[l], s->take.one);
        else
            lost |= 1u << l;
    }
    return lost;
}

#endif
