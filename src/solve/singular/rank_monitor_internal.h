// Declarations shared by the files that implement singular.h.
//
//     rank_monitor.c               prediction of singular configurations
//     rank_monitor_record.c        records those that were crossed; is the last step near one?
//     singular.c, end_of_reach.c   callbacks of the integrator
//     singular_start.c             is the initial state a singular configuration?
//     singular_initial_step.c      first step from a singular configuration
//     singular_dense_output.c      results within a crossing
//     singularity_test_function.c  determinant that changes its sign at a singular configuration
#ifndef CT_SOLVE_SINGULAR_RANK_MONITOR_INTERNAL_H
#define CT_SOLVE_SINGULAR_RANK_MONITOR_INTERNAL_H

#include "solve/evaluator/switch_state.h"
#include "solve/singular/singular.h"

struct ct_rank_test { // an accepted state, extrapolated with its q' and q''
    double t, pending;
    const double *y, *dy;
};

/// The smallest pivot at y, where the time is t.
double ct_rank_monitor_pivot(struct ct_rank_monitor *w, double t, const double *y);
/// The same at the extrapolated state s seconds later.
double ct_rank_monitor_pivot_after(struct ct_rank_monitor *w, const struct ct_rank_test *a,
                                   double s);
/// Does the motion from the last state, with these pivots at its ends, cross a singular
/// configuration or pass near one?
bool ct_rank_monitor_is_crossed(struct ct_rank_monitor *w, const struct ct_rank_test *to,
                                double before, double behind);

/// Distance [rad, m] of the initial state y at t from a singular configuration, extrapolated
/// from the change of the smallest pivot within s seconds: positive if the motion leads to it,
/// negative after it, infinite if the pivot does not change or is unknown.
double ct_rank_monitor_distance(struct ct_rank_monitor *w, double t, const double *y,
                                const double *dy, double s);
/// At y, t, a singular configuration is `in` seconds ahead. The first step crosses it, even if
/// round-off is large there, since no later step would have less.
void ct_rank_monitor_announce(struct ct_rank_monitor *w, double t, const double *y, double in);
/// Is y so near to a singular configuration that the round-off of accelerations exceeds its
/// share of the tolerance?
bool ct_rank_monitor_is_roundoff_limited(struct ct_rank_monitor *w, double t, const double *y);
/// The hook `passed`: finds and records the singular configurations on a crossing.
bool ct_rank_monitor_record(struct ct_rank_monitor *w, const struct ct_stepper_span *span,
                            double begin, double t1);
/// The hook `ends_motion`.  (end_of_reach.c)
bool ct_singular_ends_motion(void *user, double t, const double *y, double in);
/// The time of evaluation for t: just before a pending event.
static inline double ct_rank_monitor_time(const struct ct_rank_monitor *w, double t)
{
    return t < *w->pending ? t : ct_time_just_before(t, *w->pending);
}

#endif
