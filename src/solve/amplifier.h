// Outputs that amplify errors of places and speeds, as forces of stiff springs do, k (length - natural length).
//
//     amplified   |g(y + d) - g(y)| > 10 (rtol max |g| + atol),   d_i = w_i rtol y_i, 1 <= w_i < 2          (8.11)
//
// and d_i = w_i (rtol |y_i| + atol) for accelerations and reactions during steps.
//
// States that are right to the tolerance leave more of it in such an output than the 10 T that are promised. Methods for stiff
// systems bring what is stiff back to its slow motion in each step, so forces are good at the ends of steps where steps
// are controlled for them, but not between.
#ifndef CT_SOLVE_AMPLIFIER_H
#define CT_SOLVE_AMPLIFIER_H

#include "solve/invariant.h"

struct ct_amplifier;

/// Lives in a. invariant (may be NULL), record: those that constraints determine do not amplify.
struct ct_amplifier *ct_amplifier_create(struct ct_arena *a, struct ct_outputs *outputs,
                                         struct ct_invariant *invariant,
                                         struct ct_invariant_record *record);
/// A new run begins: nothing is known of the sizes of outputs.
void ct_amplifier_start(struct ct_amplifier *p);
/// Root mean square over the outputs that amplify of their errors at y (ny) for errors e (ny), where 1 is the tolerance of them or of
/// `largest` (n), and no more is asked than roundings of states allow; 0 if there are none. Where there were none, only every
/// eighth call looks.
double ct_amplifier_error(struct ct_amplifier *p, double t, const double *y, const double *e,
                          const double *largest, const struct ct_tolerance *tolerance);
/// Is there one at y? That look counts as none.
bool ct_amplifier_any(struct ct_amplifier *p, double t, const double *y,
                      const struct ct_tolerance *tolerance);
/// The output, of those that must be good to `wanted` of their largest values, that one rounding of states moves most of its
/// largest value, *part (out): `largest` (n), or what looks have seen. -1 where steps can be held to what is wanted of all that are
/// larger than `small`.
int ct_amplifier_blunt(struct ct_amplifier *p, double t, const double *y, const double *largest,
                       double wanted, double small, double *part);
/// Does output i, at the last look?
bool ct_amplifier_has(const struct ct_amplifier *p, size_t i);

#endif
