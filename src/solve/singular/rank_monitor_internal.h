// Singular configurations from inside: what the files of singular.h share.
//
//     rank_monitor.c               what is ahead
//     rank_monitor_record.c        what has been passed, and where steps have ended
//     singular.c, end_of_reach.c   hooks of the integration
//     singular_start.c             is a start in a singular configuration?
//     singular_initial_step.c      the first step from there
//     singular_dense_output.c      results within a crossing
//     singularity_test_function.c  sign of a determinant that changes at a singular configuration
#ifndef CT_SOLVE_SINGULAR_RANK_MONITOR_INTERNAL_H
#define CT_SOLVE_SINGULAR_RANK_MONITOR_INTERNAL_H

#include "solve/evaluator/switch_state.h"
#include "solve/singular/singular.h"

struct ct_rank_test { // along q' and q'' as they are at an accepted state
    double t, pending;
    const double *y, *dy;
};

/// The smallest pivot at y, where the time is t.
double ct_rank_monitor_pivot(struct ct_rank_monitor *w, double t, const double *y);
/// The same s seconds later.
double ct_rank_monitor_pivot_after(struct ct_rank_monitor *w, const struct ct_rank_test *a,
                                   double s);
/// Does the way from the last state, with these pivots at its ends, come across a position or close
/// by one?
bool ct_rank_monitor_is_crossed(struct ct_rank_monitor *w, const struct ct_rank_test *to,
                                double before, double behind);

/// How far [rad, m] y at t, where steps begin, is from a position: above 0 ahead along the motion,
/// below 0 behind; as the smallest pivot changes within s seconds, infinite where it does not
/// change or does not tell.
double ct_rank_monitor_distance(struct ct_rank_monitor *w, double t, const double *y,
                                const double *dy, double s);
/// Beside a position, at y: farther off the smallest pivot is so many times what it is here.
void ct_rank_monitor_scale_pivot(struct ct_rank_monitor *w, double t, const double *y,
                                 double times);
/// At y, where steps begin, a position so much ahead is known of that is nearer than positions are
/// where they are foreseen: the largest pivot is taken to be so many times the one of now.
void ct_rank_monitor_start_near(struct ct_rank_monitor *w, double t, const double *y, double in,
                                double times);
/// At y, where the time is t, it is known of a position so much ahead: the first step from there is
/// to cross it, whatever round-off beside the position makes of it, as none from nearer by would be
/// better.
void ct_rank_monitor_announce(struct ct_rank_monitor *w, double t, const double *y, double in);
/// Is y so near to one that round-off of accelerations in double precision is felt?
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
