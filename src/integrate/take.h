// Extrema, means and the first zero of functions of time over a whole run, independent of its
// samples.
//
//     begin -> [ step -> { wants -> give } ] -> results
//
// In each accepted step a function is interpolated in the Chebyshev points of degree 8 of an
// interval, which is the step at first; where the last two coefficients are larger than the
// tolerance allows the interval is halved.  Source: trefethen2013
//     max, min   of the interpolant; five points show that an interval stays below the maximum so far
//     mean, rms  integral of the interpolant, or of its square, over the run (Clenshaw-Curtis)
//     time       the first zero of the interpolant after a time at which it is negative
// What always holds: results depend on the steps and the functions alone, so a run in a batch gives
// the same as a single run. Kinks and jumps within steps are resolved by more intervals, at most
// MOST_INTERVALS in a step. Nothing allocates after create.
#ifndef CT_INTEGRATE_TAKE_H
#define CT_INTEGRATE_TAKE_H

#include "base/ctx.h"

enum ct_take_kind {
    CT_TAKE_FINAL, // the value at the end of the run, from the caller
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
/// Starts a run. Interpolants are accurate to rtol times the largest value so far, and atol.
void ct_take_scan_begin(struct ct_take_scan *s, double rtol, double atol);
/// A step from t0 to t1 > t0 was accepted; the one before is done.
void ct_take_scan_step(struct ct_take_scan *s, double t0, double t1);
/// The time in the step at which the functions are wanted next; false: the step is done.
bool ct_take_scan_wants(const struct ct_take_scan *s, double *t);
/// f (n): the functions there, all finite.
void ct_take_scan_give(struct ct_take_scan *s, const double *f);
/// out (n, in: the functions at the end of the run, out: the results). CT_TAKE_FINAL stays as it
/// is, and all values do in a run of no length.
void ct_take_scan_results(const struct ct_take_scan *s, double *out);

#endif
