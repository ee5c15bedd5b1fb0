// Dense output across a singular configuration: accelerations and multipliers in the gap of a crossing, from what they are at its stages.
//
// Accelerations are smooth across a singular configuration, and interpolated. Multipliers are not: what bears on the motion that is blocked
// there but for the position, forces that do not vanish, is carried by rows that come to depend, and grows like 1/(t - t_k) towards a
// position at t_k. Less that part they are smooth:
//
//     lam(t) = P(t) + sum_k R_k/(t - t_k),   R_k = [lam prod_l (t - t_l)](t_k)/prod_{l != k} (t_k - t_l)           (8.43)
//
// with the product in brackets, and P, interpolated between stages, and those positions that stages tell of. Results that are linear in multipliers are interpolated so themselves:
// what y errs by in the gap times loads without bound would be seen in those that have no part in them.
#ifndef CT_SOLVE_SINGULAR_SINGULAR_DENSE_OUTPUT_H
#define CT_SOLVE_SINGULAR_SINGULAR_DENSE_OUTPUT_H

#include "solve/run/run_internal.h"

struct ct_singular_dense_output;

/// For the results of m; everything lives in a.
struct ct_singular_dense_output *ct_singular_dense_output_create(struct ct_arena *a,
                                                                 const struct ct_evaluator *m);
/// value (nresult, out): results at (t, y) in the gap that b bridges, with the positions of the last crossing. False where they cannot be
/// computed at the stages.
bool ct_run_singular_dense_output(struct ct_run *r, double t, const double *y,
                                  const struct ct_gap_interpolation *b, double *value);

#endif
