// One step across a singular configuration: collocation whose stages stay away from it.
//
// f has a limit at the position but cannot be computed there or close by. Seen along the motion it
// is smooth, so a polynomial of high order through values of f on both sides carries it across.
#ifndef CT_INTEGRATE_CROSSING_H
#define CT_INTEGRATE_CROSSING_H

#include "integrate/stepper.h"

/// Not in ct_methods: only the driver takes such steps, centred on the position. *err is infinite
/// when there is no smooth motion across, since the polynomial leaves the constraints: the
/// mechanism only passes close by.
extern const struct ct_method ct_crossing;
/// Definition: of the method.
enum { CT_CROSSING_STAGES = 14 };

/// A smooth motion meets the constraints also in the middle, up to this [m, rad].
extern const double ct_crossing_mismatch_limit;

/// Near a singular configuration f has fewer digits: crossings may err by this part of the largest
/// state.
extern const double ct_crossing_roundoff;

/// The steps to come begin within what they cross, at this part of the whole: the rest of a
/// crossing that something has cut. 0, as at first: where it begins. Stages are those of the whole,
/// with f as it is then.  (8.37)
void ct_crossing_begin(void *work, double begin);

/// True where f is not to be computed.
bool ct_crossing_is_gap(const void *work, double theta);

/// dy (n, out): what f of the step just taken is at theta, interpolated between stages.
void ct_crossing_slope(void *work, int n, double theta, double *dy);

/// The stages of the step just taken from t by h, with weights for theta. Valid until the next one.
struct ct_gap_interpolation ct_crossing_interpolation(void *work, double t, double h,
                                                      double theta);

/// The state before (ny, out) at t - theta h, where a step h across a singular configuration
/// begins, of the motion that is at y at t, in the position or near it. dy: its derivative;
/// accelerations, which need not be known, are not used. *err (out): what the step errs by, as of
/// others; the tolerance of the step is its own, next to round-off. Its rest in the constraints is
/// the caller's to look at. (8.23)
enum ct_eval ct_crossing_initial_step(const struct ct_problem *p, double t, double h,
                                      double theta, const double *y, const double *dy,
                                      const struct ct_tolerance *tolerance, double *before,
                                      double *err, void *work,
                                      struct ct_integrate_stats *stats);

#endif
