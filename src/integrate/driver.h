// ct_integrate from inside: what its files share.
//
//     driver.c           steps and events
//     driver_step_size.c      how long the next step is to be
//     driver_samples.c   samples on the way
//     driver_roundoff.c     what round-off makes of f
#ifndef CT_INTEGRATE_DRIVER_H
#define CT_INTEGRATE_DRIVER_H

#include "integrate/step_control.h"
#include "integrate/crossing.h"
#include "integrate/periodic_tolerance.h"
#include "integrate/event_location.h"

// A step h that erred too much, and the longest one tried from the same place; 0: there was none.
struct ct_refusal {
    double longest, h, error;
};

struct ct_driver {
    struct ct_ctx *ctx;
    const struct ct_method *method;
    const struct ct_problem *p;
    const struct ct_integrate_options *o;
    struct ct_integrate_stats *stats;
    struct ct_tolerance tolerance;
    struct ct_periodic_tolerance periodic;
    double *y0; // where the run began
    struct ct_event_location events;
    double t;    // time of y and dy
    double stop; // where steps must end next, a time event or not; before t: to be found
    bool is_stop_time;
    struct ct_fixed_steps { // steps of fixed length up to a stop, from the next one's start on
        double stop, next, left;
    } even;
    struct ct_step_control control;
    struct ct_pace pace;
    bool is_announced;      // that it takes long
    double *y, *dy;         // (ny) each, as all that follow
    double *y1, *dy1;       // end of the step as the method gives it
    double *put_y, *put_dy; // y, dy before speeds were put onto the constraints for a crossing
    double *end, *dend; // the same, projected: y1, dy1 themselves where that changes nothing
    double *moved, *dmoved; // where end, dend are others
    double *point;          // a state to spare
    void *work;             // the method's own
    void *sample_work;      // the same for steps to samples; NULL: its interpolant always holds
    double *sample_end, *dsample_end; // their ends  (ny)
    int unchecked; // interpolants to come that are taken as the last one compared with such a step
    bool has_erred;      // it did
    int trusted;         // so many are not compared after one that held
    double fastest;      // rate of the fastest motion that steps have seen of late
    void *crossing_work; // of ct_crossing; NULL: there are no singular configurations to cross
    double singular_in;  // time to the next one, from t
    double reach;        // crossing it is to begin this long before
    double
        crossing_begin;   // time before it where crossings of it begin, if that is over; else 0
    int failed_crossings; // of it
    bool is_locked;       // the motion ends in it
    double predicted_at;  // when it was to come as the last of them was begun
    bool is_open;         // the last step met everything but the constraints
    size_t sample;        // the next one to give
    bool ends_on_samples; // steps end on samples: between them outputs err too much
    double *roundoff;     // of f, of problem.noise once that has been felt  (ny)
    double *arithmetic_roundoff; // of f: what its arithmetic leaves by itself  (ny)
    double *other;               // a derivative to spare  (ny)
    int roundoff_steps;          // since it was measured
    struct ct_refusal refusal;   // of the step before this try
    struct ct_problem problem;   // the caller's, with what is found here
    struct ct_crossing_remainder {
        double h, first;   // its length, and as it was tried first; 0: there is none
        bool is_known;     // sides of roots are, with f as it is now
        bool is_announced; // the position has been, by what came before the event
    } remainder; // of a crossing that an event has cut where f cannot be computed: the next step  (8.37)
};

// A step as planned: to t1, which is t + h but for round-off, or the end of the run before that.
struct ct_planned_step {
    const struct ct_method *method;
    void *work; // the method's
    double h, t1;
    double begin; // of a crossing: where the step begins, as part of the whole; 0 but for rests
    bool reaches_stop;     // t1 is the stop it was planned for
    bool is_event;         // a state event ends it
    bool leaves_rest;      // a root has left its rest on zero: an event where the step begins
    bool leaves_remainder; // of a crossing, which is to be the next step
    bool is_interpolated;  // the method is ready to interpolate it
    bool is_off_between;   // outputs err too much in a sample before its end
    bool is_damping;       // a motion that it does not follow: samples have steps of their own
    double error;
};

/// Largest step allowed.
double ct_driver_step_limit(const struct ct_driver *r);
/// Samples this close before an event count as on it: times of samples are rounded, too.
double ct_driver_event_margin(bool is_event, double t, double h);
/// Where steps must end next; *is_time tells that a time event is there.
double ct_driver_next_stop(const struct ct_driver *r, bool *is_time);
/// s (out): the next step, towards the stop.
void ct_driver_plan_step(struct ct_driver *r, double stop, bool is_time,
                         struct ct_planned_step *s);
bool ct_driver_is_too_small(const struct ct_driver *r, const struct ct_planned_step *s);
/// Time to the next singular configuration from t, up to where steps have been accepted, and where
/// to begin to cross it.
void ct_driver_look_ahead(struct ct_driver *r, double t);
void ct_driver_adapt_after_refusal(struct ct_driver *r, double h, double error);
void ct_driver_adapt_after_crossing(struct ct_driver *r, const struct ct_planned_step *s);
void ct_driver_adapt_after_failed_crossing(struct ct_driver *r, double error);

/// Has an event cut a crossing where f cannot be computed, so that the next step is its rest?
static inline bool ct_driver_has_remainder(const struct ct_driver *r)
{
    return r->remainder.h > 0;
}
/// Is t in the gap of a crossing, where only its interpolant tells the state?
bool ct_driver_is_in_gap(const struct ct_driver *r, const struct ct_planned_step *s, double t);
/// A step h was refused for this error: is it round-off of f, which is taken off errors from now
/// on?
bool ct_driver_is_roundoff(struct ct_driver *r, double h, double error);
/// A step h was accepted; the same question.
void ct_driver_note_step(struct ct_driver *r, double h, double error);

/// Is there a sample inside the step?
bool ct_driver_has_sample(const struct ct_driver *r, const struct ct_planned_step *s);
/// Does the step, ready to be interpolated, damp a motion that it does not follow, so that its
/// interpolant does not hold?
bool ct_driver_is_damping(struct ct_driver *r, const struct ct_planned_step *s);
/// Samples before `end`, from the interpolant of the step; in the gap of a crossing also the one on
/// its end.
bool ct_driver_give_samples_before(struct ct_driver *r, const struct ct_planned_step *s,
                                   double end);
/// Those due at the state of now.
bool ct_driver_give_samples_here(struct ct_driver *r);

#endif
