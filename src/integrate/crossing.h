// One step across a singular configuration, by collocation with stages that are not close to it.
//
// At a singular configuration f has a limit, but cannot be computed there or close by. Along the
// motion it is smooth, so a polynomial of high degree through values of f on both sides
// interpolates it.
#ifndef CT_INTEGRATE_CROSSING_H
#define CT_INTEGRATE_CROSSING_H

#include "integrate/stepper.h"

/// Not in ct_methods: only the driver takes such steps, centred on the singular configuration. *err
/// is infinite where the polynomial does not satisfy the constraints. Then no smooth motion leads
/// across, or the mechanism is only nearly singular.
extern const struct ct_method ct_crossing;
/// Definition: of the method.
enum { CT_CROSSING_STAGES = 14 };

/// The largest residual of the constraints in the middle of a crossing [m, rad].
extern const double ct_crossing_mismatch_limit;

/// Near a singular configuration f has fewer digits: crossings may err by this part of the largest
/// state.
extern const double ct_crossing_roundoff;

/// Steps that follow are the remainder of a crossing from `begin` on, as part of the whole
/// crossing; 0: whole crossings, as at first. Stages are those of the whole crossing, with the
/// present f.  (8.37)
void ct_crossing_begin(void *work, double begin);

/// True where f is not to be computed.
bool ct_crossing_is_gap(const void *work, double theta);

/// dy (n, out): f at theta of the last step, interpolated between stages.
void ct_crossing_slope(void *work, int n, double theta, double *dy);

/// The stages of the last step, from t by h, with interpolation weights for theta. Valid until the
/// next step.
struct ct_gap_interpolation ct_crossing_interpolation(void *work, double t, double h,
                                                      double theta);

/// Starts a motion at a singular configuration, or near it, from the state y at t. A crossing of
/// length h that contains y is computed backwards to its start: before (ny, out) = the state at t -
/// theta h. dy: derivative of y, of which only the speeds need be known. *err (out): error
/// estimate. The caller must check the constraints at `before`.  (8.23)
enum ct_eval ct_crossing_initial_step(const struct ct_problem *p, double t, double h,
                                      double theta, const double *y, const double *dy,
                                      const struct ct_tolerance *tolerance, double *before,
                                      double *err, void *work,
                                      struct ct_integrate_stats *stats);

#endif
