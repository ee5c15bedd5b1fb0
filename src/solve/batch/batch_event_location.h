// Root functions in lanes: may one have changed sign, so that batch_event.c must search?
// Included by batch_step.c.
#ifndef CT_SOLVE_BATCH_BATCH_EVENT_LOCATION_H
#define CT_SOLVE_BATCH_BATCH_EVENT_LOCATION_H

#include "solve/batch/batch_solver.h"

// The point of the step at theta: the cubic of ct_stepper_hermite.
static inline void interpolate_lanes(struct ct_batch *s, double theta)
{
    const double rest = 1 - theta;
    for (int i = 0; i < s->ny; i++) {
        const vec rise = s->end[i] - s->y[i], bend = s->h * s->dy[i] - rise;
        s->point[i]
            = s->y[i]
            + theta * (rise + rest * (bend + theta * (rise - s->h * s->dend[i] - bend)));
    }
}

// As ct_event_location_may_dip.
static inline mask may_dip(vec a, vec b, vec c)
{
    const vec bend = a - 2 * b + c, slope = (c - a) / 2,
              most = (1 + ct_event_location_margin) * bend;
    return (bend > 0) & (slope * slope <= most * most)
         & (2 * bend * b - slope * slope <= 2 * ct_event_location_margin * bend * bend);
}

// Lanes of `wanted` in which root functions may have changed sign, evaluated at the points of
// event_location.c. Lanes with values that are not finite are removed from it.
static inline set suspects(struct ct_batch *s, vec end, set *wanted)
{
    // Limit: of the search within a step
    enum { PROBES = 4 };
    // Derived: half the digits of g
    const double ahead
        = 1e-6; // of the distance between points: a root just behind a point is searched for, too
    vec odd = {0};
    mask hit = {0};
    copy(s->g, s->g0, s->nroot);
    for (int k = 1; k <= PROBES; k++) {
        if (k < PROBES) {
            interpolate_lanes(s, (double)k / PROBES);
            set_input(s, s->t + (double)k / PROBES * s->h, s->point);
        } else {
            set_input(s, end, s->end);
        }
        ct_lane_run(&s->root, s->input);
        for (int i = 0; i < s->nroot; i++) {
            const vec g = s->root.out[s->root_of[i]];
            hit |= s->side[i] * (g + ahead * (g - s->g[i])) <= 0;
            if (k > 1)
                hit |= may_dip(s->side[i] * s->g_before[i], s->side[i] * s->g[i],
                               s->side[i] * g);
            odd += 0 * g;
            s->g_before[i] = s->g[i];
            s->g[i] = g;
        }
    }
    *wanted &= set_of(odd == 0);
    return *wanted & (set_of(hit) | s->unsettled);
}

// Returns the lanes whose steps may be accepted; those whose steps are repeated up to an event are
// added to `again`.
static inline set locate_events(struct ct_batch *s, vec end, set wanted, set *again)
{
    *again = 0;
    if (!s->nroot || !wanted)
        return wanted;
    set look = suspects(s, end, &wanted);
    for (int l = 0; l < W; l++) {
        if (!ct_has_lane(look, l) && !(ct_has_lane(wanted, l) && s->lane[l].events.whole > 0))
            continue;
        const enum ct_lane_found found = ct_lane_search(s, l);
        if (found != CT_LANE_GOES_ON)
            wanted &= ~(1u << l);
        if (found == CT_LANE_AGAIN)
            *again |= 1u << l;
    }
    return wanted;
}

#endif
