// Step size control: how long the next step is to be, from the error of the last one.
//
// The PI controller of Gustafsson (1991), key gustafsson1991, with the constants of Hairer, Norsett
// and Wanner (1993), II.4, key hairer1993; the first step is the one of the same section.
#ifndef CT_INTEGRATE_STEP_CONTROL_H
#define CT_INTEGRATE_STEP_CONTROL_H

#include "integrate/problem.h"

#include <float.h>
#include <math.h>

struct ct_step_control {
    double h;          // size the next step should have
    double log_before; // log2 of the error of the last accepted step, at least log_least
    double log_least;
    // values of the method of the last step, computed when the method changes
    const struct ct_method *method;
    double alpha, beta; // powers of the errors of this step and the one before
    double log_safety, log_kept_range[2]; // log2
    bool was_refused;                     // the last attempt was refused
    bool is_starting; // since the start or an event errors are far below the tolerance
};

/// Before the first step.
struct ct_step_control ct_step_control_start(void);
/// The step wanted, adapted to the time left to a stop, so that no very short step remains before
/// it.
static inline double ct_step_control_fit(double rest, double wanted)
{
    // A step may be longer by this factor to end on a stop. Derived: with the safety factors of
    // step_control.c, 0.8 and 0.9, its error is still expected to be below the tolerance
    const double stretch = 1.1;
    if (rest <= stretch * wanted)
        return rest;
    return rest < 2 * wanted ? rest / 2 : wanted;
}
/// Is h, which does not end on a stop, too small against the round-off of times up to t or up to
/// the duration `run` [s]?
static inline bool ct_step_control_is_below_roundoff(double h, double t, double run)
{
    // Derived: the stage times of DOPRI5, at least h/16 apart, then differ by a round-off of t.
    const double least_step = 16 * DBL_EPSILON;
    return h <= least_step * (fabs(t) > run ? fabs(t) : run);
}
/// A step of size h was accepted, its error 1 at the tolerance.
void ct_step_control_accept(struct ct_step_control *c, const struct ct_method *m, double h,
                            double error);
/// A step was refused, for its error if that is greater than 1.
void ct_step_control_refuse(struct ct_step_control *c, const struct ct_method *m, double h,
                            double error);

/// The time gained with each thousandth of the steps allowed; all zero before the first.
struct ct_step_progress {
    double t, gain;       // where the last thousandth ended, and its length
    long next;            // number of steps at its end
    double step, to_come; // then: mean step, steps up to the end; 0 while steps still grow
};
/// After so many of `most` steps t is reached, and `rest` is left: would the rest take several
/// times the steps allowed? False while steps still grow.
bool ct_step_control_exceeds_limit(struct ct_step_progress *p, long steps, long most, double t,
                                   double rest);

/// The length of the Euler step that estimates y'', from the norms d0, d1 of y and y' over the
/// tolerance.
double ct_step_control_euler_step(double d0, double d1, double limit);
/// A first step whose error should be near a hundredth of the tolerance; d1, d2: norms of y' and of
/// its change over the Euler step h, divided by h.
double ct_step_control_first(const struct ct_method *m, double h, double d1, double d2,
                             double limit);
/// A first step for a motion of a known `rate` [1/s]: the first term of its Taylor series in the
/// estimated error, (rate h)^n/n!, is a hundredth of the tolerance.
double ct_step_control_first_at_rate(const struct ct_method *m, double rate, double rtol);

#endif
