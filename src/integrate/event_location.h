// Event location: which root functions (state events) change sign within a step, and when.
//
//     side      the last sign of each root function, -1 or 1; 0: it stays zero
//     at rest   a root function that stays zero fires as soon as it is not zero, at the start of
//               that step, since a smooth motion leaves zero at once or at an event
//     probes    g is evaluated at a few times in a step, and where a parabola through three of
//               them has a minimum near zero, so that two sign changes in one step are found
//
// What always holds between steps: g0 is g at the start of the next step. A root function that has
// just fired has the sign given by p->sides, or the sign to which it is moving. So it cannot fire
// twice for one sign change, and an immediate change back (a bounce) is still found.
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
    int accumulated; // state events in a row at the same time, but for its resolution
};

/// Corrections to the time of an event. Derived: each Newton correction doubles the digits; dense
/// output has two or more of the 12 to which times are resolved.
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

/// The assumed error of a parabola through three probes, as part of its second difference.
extern const double ct_event_location_margin;
/// May a smooth function that is a, b, c > 0 at three equidistant places be less than zero between
/// them?
bool ct_event_location_may_dip(double a, double b, double c);

void ct_event_location_init(struct ct_event_location *w, const struct ct_problem *p,
                            struct ct_arena *a);

/// Finds the signs of the root functions at the start, or after an event in which `crossed` fired;
/// clears `crossed`. Without p->sides the sign of a root that fired is found a small part of h
/// later, h the usual step.
enum ct_eval ct_event_location_start(struct ct_event_location *w, double t, double h,
                                     const double *y, const double *dy);

/// Looks for the first event in a step that ends in y_end (projected). *theta (out): its time as
/// part of the step, 0 where a root function that stayed zero changes, or 2 if there is none.
/// `crossed` tells which roots fire. It is called again for each new attempt at the step.
enum ct_eval ct_event_location_search(struct ct_event_location *w,
                                      const struct ct_stepper_span *s, const double *y_end,
                                      double *theta);

/// The step was repeated up to the event and ended in y. *dt (out): the correction to the time of
/// the event, from the slope of the first root that fired.
enum ct_eval ct_event_location_refine(struct ct_event_location *w, double t, const double *y,
                                      double *dt);

/// The step to y is accepted. With an event there: roots that fire with it join `crossed`.
enum ct_eval ct_event_location_accept(struct ct_event_location *w, double t, double h,
                                      const double *y, bool is_event);

#endif
