// Tolerance scaling for periodic motion: counts the periods of a motion and reduces the tolerance
// of steps for the number expected up to the end of the run. The error of a step changes the
// energy, and with it the frequency of all periods that follow. So over n periods the error of the
// solution grows with n^2.
//
// Periods are counted from the path lengths of coordinates and of speeds, each over the largest
// distance reached, or over the size below which the absolute tolerance counts. The smaller number
// counts. So neither small vibrations nor steady rotations are counted as periods.
#ifndef CT_INTEGRATE_PERIODIC_TOLERANCE_H
#define CT_INTEGRATE_PERIODIC_TOLERANCE_H

#include "integrate/problem.h"

struct ct_periodic_tolerance {
    double t0, t1; // of the run
    double
        least_size; // distances and speeds below it are measured against the absolute tolerance
    double path_q,
        // of coordinates: path length, square of the largest distance from the start
        range_q;
    double path_u, range_u; // of speeds: sum of their changes, square of the largest
    double factor;          // factor on the tolerance of a step
};

/// The tolerance of steps: rtol and atol times the factor, where rtol is not to fall below `least`.
struct ct_tolerance ct_periodic_tolerance_find(const struct ct_periodic_tolerance *r,
                                               double rtol, double atol, double least);
/// Before the first step, for steps with this tolerance; factor = 1.
struct ct_periodic_tolerance ct_periodic_tolerance_start(double t0, double t1,
                                                         const struct ct_tolerance *tolerance);
/// A step has ended at t: squared lengths of its change of the coordinates, of their distance from
/// the start, of its change of the speeds, of the speeds. True if the factor has changed.
bool ct_periodic_tolerance_add(struct ct_periodic_tolerance *r, double t, double dq, double q,
                               double du, double u);
/// The same for a step from y to y1 in a run that started at y0, with nq coordinates and nu speeds.
bool ct_periodic_tolerance_step(struct ct_periodic_tolerance *r, double t, const double *y0,
                                const double *y, const double *y1, int nq, int nu);

#endif
