// Singular positions from inside: what the files of singular.h share.
//
//     singular.c         what is ahead
//     singular_pass.c    what has been passed, and where steps have ended
//     singular_start.c   starts in one
#ifndef CT_SOLVE_SIGHT_H
#define CT_SOLVE_SIGHT_H

#include "solve/singular.h"

struct ct_sight { // along q' and q'' as they are at an accepted state
    double t, pending;
    const double *y, *dy;
};

/// The smallest pivot at y, where the time is t.
double ct_singular_pivot(struct ct_singular *w, double t, const double *y);
/// The same s seconds later.
double ct_singular_pivot_after(struct ct_singular *w, const struct ct_sight *a, double s);
/// Does the way from the last state, with these pivots at its ends, come across a position or close by one?
bool ct_singular_is_over(struct ct_singular *w, const struct ct_sight *to, double before,
                         double behind);

#endif
