// Sensitive outputs: those that amplify errors of positions and speeds, as forces of stiff springs
// do, k (length - natural length).
//
//     amplified   |g(y + d) - g(y)| > 10 (rtol max |g| + atol),   d_i = w_i rtol y_i, 1 <= w_i < 2          (8.11)
//
// and d_i = w_i (rtol |y_i| + atol) for accelerations and reactions during steps.
//
// States that are right to the tolerance leave more of it in such an output than the 10 T that are
// promised. Methods for stiff systems bring what is stiff back to its slow motion in each step, so
// forces are good at the ends of steps where steps are controlled for them, but not between.
#ifndef CT_SOLVE_OUTPUT_ERROR_OUTPUT_SENSITIVITY_H
#define CT_SOLVE_OUTPUT_ERROR_OUTPUT_SENSITIVITY_H

#include "solve/output_error/constrained_output.h"

struct ct_output_sensitivity;

/// Lives in a. invariant (may be NULL), record: those that constraints determine do not amplify.
struct ct_output_sensitivity *
ct_output_sensitivity_create(struct ct_arena *a, struct ct_controlled_outputs *outputs,
                             struct ct_constrained_output *invariant,
                             struct ct_constrained_output_record *record);
/// A new run begins: nothing is known of the sizes of outputs.
void ct_output_sensitivity_start(struct ct_output_sensitivity *p);
/// Root mean square over the outputs that amplify of their errors at y (ny) for errors e (ny),
/// where 1 is the tolerance of them or of `largest` (n), and no more is asked than round-off errors
/// of states allow; 0 if there are none. Where there were none, only every eighth call looks.
double ct_output_sensitivity_error(struct ct_output_sensitivity *p, double t, const double *y,
                                   const double *e, const double *largest,
                                   const struct ct_tolerance *tolerance);
/// Is there one at y? That look counts as none.
bool ct_output_sensitivity_any(struct ct_output_sensitivity *p, double t, const double *y,
                               const struct ct_tolerance *tolerance);
/// The output, of those that must be good to `wanted` of their largest values, that one round-off
/// of states moves most of its largest value, *part (out): `largest` (n), or what looks have seen.
/// -1 where steps can be held to what is wanted of all that are larger than `small`.
int ct_output_sensitivity_roundoff_limit(struct ct_output_sensitivity *p, double t,
                                         const double *y, const double *largest, double wanted,
                                         double small, double *part);
/// Does output i, at the last look?
bool ct_output_sensitivity_is_sensitive(const struct ct_output_sensitivity *p, size_t i);

#endif
