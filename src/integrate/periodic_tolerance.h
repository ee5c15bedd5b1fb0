// Tolerance scaling for periodic motion: how often a motion repeats itself until the end of a run,
// and how much better its steps have to be for that.
//
// The error of a step changes the energy and with it the pace of all turns that follow: over n
// turns the error of the solution grows with n^2. Turns are counted by the ways of all coordinates
// and of all speeds, against how far they get, and not less than what the tolerance sees as small:
// the smaller number counts, so that neither vibrations that are small, whether beside the motion
// or beside a unit, nor steady rotations are turns.
#ifndef CT_INTEGRATE_PERIODIC_TOLERANCE_H
#define CT_INTEGRATE_PERIODIC_TOLERANCE_H

#include "integrate/problem.h"

struct ct_periodic_tolerance {
    double t0, t1; // of the run
    double small;  // distances and speeds below it are measured against the absolute tolerance
    double path_q,
        // of coordinates: the way so far, the square of the largest distance from the start
        range_q;
    double path_u, range_u; // of speeds: the sum of their changes, the square of the largest
    int steps;              // since the last look
    double share;           // of the tolerance of a step
};

/// What is left of a tolerance at this share, where rtol is not to fall below `least`.
struct ct_tolerance ct_periodic_tolerance_find(const struct ct_periodic_tolerance *r,
                                               double rtol, double atol, double least);
/// Before the first step, of steps to this tolerance; share = 1.
struct ct_periodic_tolerance ct_periodic_tolerance_start(double t0, double t1,
                                                         const struct ct_tolerance *tolerance);
/// A step has ended at t: squared lengths of its change of the coordinates, of their distance from
/// the start, of its change of the speeds, of the speeds. True if share is another now.
bool ct_periodic_tolerance_add(struct ct_periodic_tolerance *r, double t, double dq, double q,
                               double du, double u);
/// The same of a step from y to y1 in a run from y0, of nq coordinates and nu speeds.
bool ct_periodic_tolerance_step(struct ct_periodic_tolerance *r, double t, const double *y0,
                                const double *y, const double *y1, int nq, int nu);

#endif
