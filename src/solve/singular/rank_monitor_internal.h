// Singular configurations from inside: what the files of rank_monitor.h share.
//
//     rank_monitor.c         what is ahead
//     rank_monitor_record.c    what has been passed, and where steps have ended
//     singular_start.c   starts in one
#ifndef CT_SOLVE_SINGULAR_RANK_MONITOR_INTERNAL_H
#define CT_SOLVE_SINGULAR_RANK_MONITOR_INTERNAL_H

#include "solve/singular/rank_monitor.h"

struct ct_rank_test { // along q' and q'' as they are at an accepted state
    double t, pending;
    const double *y, *dy;
};

/// The smallest pivot at y, where the time is t.
double ct_rank_monitor_pivot(struct ct_rank_monitor *w, double t, const double *y);
/// The same s seconds later.
double ct_rank_monitor_pivot_after(struct ct_rank_monitor *w, const struct ct_rank_test *a,
                                   double s);
/// Does the way from the last state, with these pivots at its ends, come across a position or close by one?
bool ct_rank_monitor_is_crossed(struct ct_rank_monitor *w, const struct ct_rank_test *to,
                                double before, double behind);

#endif
