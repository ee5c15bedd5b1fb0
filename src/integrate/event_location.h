// Event location: which root functions (state events) change sign within a step, and when.
//
//     side      -1 or +1 for each root: where it was last seen; 0: at rest on zero
//     rest      a root at rest fires as soon as it is not zero: at the start of the step in which
//               it is seen to have left, since smooth motions leave zero at once or at an event
//     probes    g is evaluated in a few places of a step, and where a parabola through three of
//               them turns about zero, so that a root that crosses and comes back is seen
//
// What always holds between steps: g0 is g at the start of the next step, and a root that has
// just fired has the side of p->sides, or else the side to which it is moving. So it cannot fire
// twice for one crossing, and a root that comes back at once (a bounce) is still seen.
#ifndef CT_INTEGRATE_EVENT_LOCATION_H
#define CT_INTEGRATE_EVENT_LOCATION_H

#include "integrate/stepper.h"

struct ct_event_location {
    const struct ct_problem *p;
    signed char *side, *crossed; // (nroot)
    double *g0;                  // g at the start of the step  (nroot)
    double *g, *low, *high;      // (nroot) each
    double *recently_fired;      // > 0: fired, and |g| has not been above this since (nroot)
    double *slope;               // dg/dt at the event  (nroot)
    double *probed;              // g at the start of the step and at the probes  (nroot x 5)
    double *point;               // (ny)
    double last_event;           // time of the last state event
    int accumulated;             // state events in a row without time going on
};

/// Corrections to the time of an event. Derived: Newton's method doubles digits, and the
/// interpolant has two or more of the 12 to which times are resolved.
enum { CT_EVENT_CORRECTIONS = 3 };
/// State events in a row, each close to the one before, that are an infinite number.
/// Default: with more, times stop to go on before they are counted. Test: events.
enum { CT_EVENT_ACCUMULATION = 100 };

/// Times closer than this to an event cannot be told from it.
double ct_event_location_resolution(double t, double h);
/// With events, the longest step of a run of this length.
double ct_event_location_longest_step(double run);
/// A state event at t is one of an infinite number.
bool ct_event_location_accumulates(struct ct_event_location *w, double t, double run);

/// Between probes roots are taken for parabolas that err by this part of their second difference.
extern const double ct_event_location_margin;
/// May a smooth function that is a, b, c > 0 at three equidistant places be less than zero between
/// them?
bool ct_event_location_may_dip(double a, double b, double c);

void ct_event_location_init(struct ct_event_location *w, const struct ct_problem *p,
                            struct ct_arena *a);

/// Take bearings at the start, or after an event in which `crossed` fired; clears `crossed`.
/// h is the size of a usual step: without p->sides a root that fired is looked at a tiny part of it
/// later.
enum ct_eval ct_event_location_start(struct ct_event_location *w, double t, double h,
                                     const double *y, const double *dy);

/// Look for the first event in a step that ends in y_end (projected). *theta (out): its place, 0
/// where a root leaves its rest, or 2 if there is none. The roots that fire there are in `crossed`.
/// When this or a later stage refuses the step, look again after the next try.
enum ct_eval ct_event_location_search(struct ct_event_location *w,
                                      const struct ct_stepper_span *s, const double *y_end,
                                      double *theta);

/// The step was taken again up to the event, which gave y: *dt (out), how much later the first
/// root that fired is zero, from its slope.
enum ct_eval ct_event_location_refine(struct ct_event_location *w, double t, const double *y,
                                      double *dt);

/// The step to y is accepted. With an event there: roots that fire with it join `crossed`.
enum ct_eval ct_event_location_accept(struct ct_event_location *w, double t, double h,
                                      const double *y, bool is_event);

#endif
