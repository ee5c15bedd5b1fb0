// What is taken from functions of time over a whole run, not its samples: extremes, means, the
// first zero.
//
//     begin -> [ step -> { wants -> give } ] -> results
//
// In each accepted step a function is interpolated in the Chebyshev points of degree 8 of an
// interval, which is the step at first; where the last two coefficients are larger than the
// tolerance allows the interval is halved.  Source: trefethen2013
//
//     max, min   of the interpolant; intervals that stay below the largest value so far need five points
//     mean       integral of the interpolant over the length of the run (Clenshaw-Curtis); rms: of the square
//     time       the first zero of the interpolant behind a place where it is negative
//
// What always holds: what is taken depends on the steps and the functions alone, so runs side by
// side and runs alone do the same. Kinks and jumps inside of steps cost intervals, and are found to
// round-off; a step gets no more than MOST_INTERVALS of them. Nothing allocates after create.
#ifndef CT_INTEGRATE_TAKE_H
#define CT_INTEGRATE_TAKE_H

#include "base/ctx.h"

enum ct_take_kind {
    CT_TAKE_FINAL, // of the caller: nothing is asked for it
    CT_TAKE_MAX,
    CT_TAKE_MIN,
    CT_TAKE_MEAN,
    CT_TAKE_RMS,
    CT_TAKE_TIME, // [s] first rise through zero; NaN: there is none
};

struct ct_take_scan;

/// kind (n) must live as long. All in a.
struct ct_take_scan *ct_take_scan_create(struct ct_arena *a, const enum ct_take_kind *kind,
                                         size_t n);
/// A new run. Functions are followed to rtol times their largest value so far, and atol.
void ct_take_scan_begin(struct ct_take_scan *s, double rtol, double atol);
/// A step from t0 to t1 > t0 was accepted; the one before is done.
void ct_take_scan_step(struct ct_take_scan *s, double t0, double t1);
/// The time in the step at which the functions are wanted next; false: the step is done.
bool ct_take_scan_wants(const struct ct_take_scan *s, double *t);
/// f (n): the functions there, all finite.
void ct_take_scan_give(struct ct_take_scan *s, const double *f);
/// out (n, in: the functions at the end of the run): what was taken; FINAL stays. A run of no
/// length has what it ends with.
void ct_take_scan_results(const struct ct_take_scan *s, double *out);

#endif
