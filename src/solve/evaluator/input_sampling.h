// Input sampling: what loads and drivers do by time alone, looked at before a run: steps must not
// pass over it unseen.
#ifndef CT_SOLVE_EVALUATOR_INPUT_SAMPLING_H
#define CT_SOLVE_EVALUATOR_INPUT_SAMPLING_H

#include "integrate/problem.h"
#include "solve/evaluator/evaluator.h"

// Limit: of memory and time; docs/format.md says that shorter pulses may be missed
enum { CT_INPUT_SAMPLES = 1024 };

/// Functions of time at even times from 0 on. None: zero.
struct ct_input_sampling {
    size_t n;
    double piece;  // of time between values [s]
    double *value; // (CT_INPUT_SAMPLES + 1 by function)
    double *range; // of each function's values (n)
};

/// Those of the equations up to the end of a run, with the parameters that the evaluator's input
/// has. c is zero, or of this machine from before, whose memory in a is used again.
void ct_input_sampling_sample(struct ct_arena *a, struct ct_evaluator *m, double end,
                              struct ct_input_sampling *c);

/// The longest of h, h/2, h/4 ... such that of no function the largest change within a step from t
/// is more than twice the largest at times where the method evaluates, and more than the part
/// `negligible_change` of its range. Changes that come and go within end/CT_INPUT_SAMPLES may be
/// missed, and steps of up to four such pieces are not looked at.
double ct_input_sampling_limit_step(const struct ct_input_sampling *c,
                                    const struct ct_method *method, double t, double h,
                                    double negligible_change);

#endif
