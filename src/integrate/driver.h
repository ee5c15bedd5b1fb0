// The integration loop ct_integrate: data and functions that its files share.
//
//     driver.c             steps and events
//     driver_step_size.c   the length of the next step
//     driver_samples.c     samples by dense output
//     driver_roundoff.c    round-off of f in error estimates
#ifndef CT_INTEGRATE_DRIVER_H
#define CT_INTEGRATE_DRIVER_H

#include "integrate/step_control.h"
#include "integrate/crossing.h"
#include "integrate/periodic_tolerance.h"
#include "integrate/event_location.h"

// The last refused step h and its error, and the longest step refused from the same state; 0: none.
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
    struct ct_step_progress progress;
    bool is_announced; // `forecast` has been called
    double *y, *dy;    // the last accepted state and its derivative  (ny), as all that follow
    double *y1, *dy1;  // end of the step before projection
    double *unprojected_y, *unprojected_dy; // y, dy before speeds were projected for a crossing
    double *end, *dend;                     // end of the step after projection; may be y1, dy1
    double *moved, *dmoved; // storage of end, dend where they differ from y1, dy1
    double *point;          // workspace
    void *work;             // workspace of the method
    void *sample_work; // for separate steps to samples; NULL: dense output is always accurate
    double *sample_end, *dsample_end; // ends of those steps  (ny)
    int checks_to_skip;  // steps to come whose dense output is not compared with such a step
    bool was_inaccurate; // dense output was inaccurate at the last comparison
    int skipped_checks;  // steps without comparison after an agreement
    double fastest;      // rate of the fastest mode in recent steps  [1/s]
    // the next singular configuration
    void *crossing_work;    // workspace of ct_crossing; NULL: none are crossed
    double singular_in;     // time from t to it
    double reach;           // the crossing begins this long before it
    double crossing_begin;  // the same, where that time has passed already; else 0
    int failed_crossings;   // attempts to cross it
    bool is_locked;         // the motion ends in it
    double predicted_at;    // its time as predicted at the last attempt
    bool projection_failed; // the last step failed in the projection onto the constraints alone
    size_t sample;          // index of the next sample
    bool ends_on_samples;   // sensitive outputs are inaccurate between steps
    double *roundoff;       // round-off of f, once it has shown in error estimates  (ny)
    double *arithmetic_roundoff; // the part from the arithmetic of f itself  (ny)
    double *dpoint;              // workspace  (ny)
    int roundoff_steps;          // steps since it was measured
    struct ct_refusal refusal;   // of the attempt before this one
    struct ct_problem problem;   // a copy of the caller's, with the round-off of f
    struct ct_crossing_remainder {
        double h, first;   // its length, now and at the first attempt; 0: there is none
        bool is_known;     // the signs of root functions with the present f are known
        bool is_announced; // `passed` has been called for this singular configuration
    } remainder; // the second part of a crossing with an event in its gap: the next step  (8.37)
};

// A planned step from t to t1, which is t + h but for round-off, or the end of the run if that is
// before.
struct ct_planned_step {
    const struct ct_method *method;
    void *work; // the method's
    double h, t1;
    double begin; // start of the remainder of a crossing, as part of the whole crossing; else 0
    bool reaches_stop; // t1 is the stop it was planned for
    bool is_event;     // it ends with a state event
    bool leaves_zero;  // a root that was zero changes: an event at the start of the step
    bool
        leaves_remainder; // a crossing with an event in its gap: the remainder is the next step
    bool is_interpolated; // the method is prepared for dense output
    bool is_inaccurate_between; // sensitive outputs are inaccurate at a sample before its end
    bool damps_fast_mode;       // it damps a fast mode: samples are computed by separate steps
    double error;
};

/// Largest step allowed.
double ct_driver_step_limit(const struct ct_driver *r);
/// Samples this close before an event count as on it, since their times are rounded.
double ct_driver_event_margin(bool is_event, double t, double h);
/// Where steps must end next; *is_time tells that a time event is there.
double ct_driver_next_stop(const struct ct_driver *r, bool *is_time);
/// s (out): the next step, towards the stop.
void ct_driver_plan_step(struct ct_driver *r, double stop, bool is_time,
                         struct ct_planned_step *s);
bool ct_driver_is_too_small(const struct ct_driver *r, const struct ct_planned_step *s);
/// Predicts the time from t, the end of the last accepted step, to the next singular configuration,
/// and where its crossing begins.
void ct_driver_predict_singularity(struct ct_driver *r, double t);
void ct_driver_adapt_after_refusal(struct ct_driver *r, double h, double error);
void ct_driver_adapt_after_crossing(struct ct_driver *r, const struct ct_planned_step *s);
void ct_driver_adapt_after_failed_crossing(struct ct_driver *r, double error);

/// Has an event in the gap ended a crossing, so that the next step is its second part?
static inline bool ct_driver_has_remainder(const struct ct_driver *r)
{
    return r->remainder.h > 0;
}
/// Is t in the gap of a crossing, where the state comes from its interpolant?
bool ct_driver_is_in_gap(const struct ct_driver *r, const struct ct_planned_step *s, double t);
/// A step h was refused for this error: is the cause round-off of f? Then it is subtracted from
/// error estimates from now on.
bool ct_driver_is_roundoff(struct ct_driver *r, double h, double error);
/// The same for an accepted step h.
void ct_driver_note_step(struct ct_driver *r, double h, double error);

/// Is there a sample inside the step?
bool ct_driver_has_sample(const struct ct_driver *r, const struct ct_planned_step *s);
/// Does the step damp a fast mode that it does not resolve, so that its dense output is inaccurate?
bool ct_driver_damps_fast_mode(struct ct_driver *r, const struct ct_planned_step *s);
/// Samples before `end`, by dense output; in the gap of a crossing also the one at the end.
bool ct_driver_give_samples_before(struct ct_driver *r, const struct ct_planned_step *s,
                                   double end);
/// Samples at the present time.
bool ct_driver_give_samples_here(struct ct_driver *r);

#endif
