// Declarations that the files behind singular.h share.
//
//     rank_monitor.c               prediction along the motion
//     rank_monitor_record.c        configurations that were crossed; the end of steps near one
//     singular.c, end_of_reach.c   hooks of the integration
//     singular_start.c             is a start in a singular configuration?
//     singular_initial_step.c      the first step from there
//     singular_dense_output.c      results within a crossing
//     singularity_test_function.c  sign of a determinant that changes at a singular configuration
#ifndef CT_SOLVE_SINGULAR_RANK_MONITOR_INTERNAL_H
#define CT_SOLVE_SINGULAR_RANK_MONITOR_INTERNAL_H

#include "solve/evaluator/switch_state.h"
#include "solve/singular/singular.h"

struct ct_rank_test { // an accepted state, continued with its q' and q''
    double t, pending;
    const double *y, *dy;
};

/// The smallest pivot at y, where the time is t.
double ct_rank_monitor_pivot(struct ct_rank_monitor *w, double t, const double *y);
/// The same s seconds later.
double ct_rank_monitor_pivot_after(struct ct_rank_monitor *w, const struct ct_rank_test *a,
                                   double s);
/// Does the motion from the last state, with these pivots at its ends, cross a singular
/// configuration or pass near one?
bool ct_rank_monitor_is_crossed(struct ct_rank_monitor *w, const struct ct_rank_test *to,
                                double before, double behind);

/// Distance [rad, m] of y at t, where steps begin, from a singular configuration, extrapolated
/// from the change of the smallest pivot within s seconds: positive if the motion leads to it,
/// negative behind it, infinite if the pivot does not change or is not known.
double ct_rank_monitor_distance(struct ct_rank_monitor *w, double t, const double *y,
                                const double *dy, double s);
/// y is near a singular configuration: assume that the smallest pivot is this many times larger
/// elsewhere.
void ct_rank_monitor_scale_pivot(struct ct_rank_monitor *w, double t, const double *y,
                                 double times);
/// At y, where steps begin, a singular configuration is `in` seconds ahead, nearer than usual
/// predictions are made: assume a largest pivot that is `times` the present one.
void ct_rank_monitor_start_near(struct ct_rank_monitor *w, double t, const double *y, double in,
                                double times);
/// At y, t, a singular configuration is `in` seconds ahead: the first step crosses it, even if
/// round-off near it is large, since no later step would have less.
void ct_rank_monitor_announce(struct ct_rank_monitor *w, double t, const double *y, double in);
/// Is y so near to a singular configuration that round-off of accelerations exceeds its share
/// of the tolerance?
bool ct_rank_monitor_is_roundoff_limited(struct ct_rank_monitor *w, double t, const double *y);
/// The hook `passed`: finds singular configurations on a crossing and keeps them.
bool ct_rank_monitor_record(struct ct_rank_monitor *w, const struct ct_stepper_span *span,
                            double begin, double t1);
/// The hook `ends_motion`.  (end_of_reach.c)
bool ct_singular_ends_motion(void *user, double t, const double *y, double in);
/// The time to evaluate at for t: before the event that is pending.
static inline double ct_rank_monitor_time(const struct ct_rank_monitor *w, double t)
{
    return t < *w->pending ? t : ct_time_just_before(t, *w->pending);
}

#endif
