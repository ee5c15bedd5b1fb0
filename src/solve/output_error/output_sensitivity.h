// Sensitive outputs: outputs that amplify errors of positions and speeds, such as forces of stiff
// springs, k (length - natural length). An output g is sensitive if errors of states within their
// tolerance change it by more than the 10 T that are promised of outputs:
//
//     |g(y + d) - g(y)| > 10 (rtol max |g| + atol),   d_i = w_i rtol y_i, 1 <= w_i < 2     (8.11)
//
// and d_i = w_i (rtol |y_i| + atol) for accelerations and reactions during steps.
//
// Implicit methods for stiff systems damp fast motions in each step. With them a stiff force is
// accurate at the ends of steps if these are controlled for it, but not between.
#ifndef CT_SOLVE_OUTPUT_ERROR_OUTPUT_SENSITIVITY_H
#define CT_SOLVE_OUTPUT_ERROR_OUTPUT_SENSITIVITY_H

#include "solve/output_error/constrained_output.h"

struct ct_output_sensitivity;

/// Lives in a. Outputs that constrained_output (may be NULL) and record find constrained are not
/// sensitive.
struct ct_output_sensitivity *
ct_output_sensitivity_create(struct ct_arena *a, struct ct_controlled_outputs *outputs,
                             struct ct_constrained_output *constrained_output,
                             struct ct_constrained_output_record *record);
/// Reset before a run.
void ct_output_sensitivity_start(struct ct_output_sensitivity *p);
/// Root mean square of the errors of the sensitive outputs at y (ny) for errors e (ny) of the
/// states. 1 is the tolerance, relative to the largest value so far or `largest` (n), and not less
/// than two round-off errors of states allow. 0 if no output is sensitive. Sensitivities of outputs
/// of accelerations are found at every eighth state.
double ct_output_sensitivity_error(struct ct_output_sensitivity *p, double t, const double *y,
                                   const double *e, const double *largest,
                                   const struct ct_tolerance *tolerance);
/// Is any output sensitive at y? Does not change what later calls test.
bool ct_output_sensitivity_any(struct ct_output_sensitivity *p, double t, const double *y,
                               const struct ct_tolerance *tolerance);
/// The output that one round-off of states changes most, relative to its largest value: *part (out)
/// of `largest` (n), or of the largest value in tests. -1 if all outputs larger than `small` can be
/// accurate to `wanted`.
int ct_output_sensitivity_roundoff_limit(struct ct_output_sensitivity *p, double t,
                                         const double *y, const double *largest, double wanted,
                                         double small, double *part);
/// Was output i sensitive at the last test?
bool ct_output_sensitivity_is_sensitive(const struct ct_output_sensitivity *p, size_t i);

#endif
