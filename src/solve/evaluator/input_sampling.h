// Input sampling: functions of time alone in loads and drivers are sampled before a run, so that
// steps do not pass over pulses.
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

/// Samples the functions of the equations up to the end of a run, with the parameters of the
/// evaluator's input. c is zero, or was filled for this evaluator before; its memory in a is then
/// used again.
void ct_input_sampling_sample(struct ct_arena *a, struct ct_evaluator *m, double end,
                              struct ct_input_sampling *c);

/// The longest of h, h/2, h/4 ... for which each function is resolved: its largest change within a
/// step from t is at most 2.4 times that at the method's stages, or at most the part
/// `negligible_change` of its range. Pulses shorter than end/CT_INPUT_SAMPLES may be missed, and
/// steps of up to four such pieces are not tested.
double ct_input_sampling_limit_step(const struct ct_input_sampling *c,
                                    const struct ct_method *method, double t, double h,
                                    double negligible_change);

#endif
