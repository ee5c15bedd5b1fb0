// A run in quadruple precision, as a reference for the round-off and truncation errors of runs in
// double precision.
//
// The listings of an evaluator are evaluated in __float128, the states by extrapolation of the
// midpoint rule; parameters, numbers of the model and the start are those of the evaluator, rounded
// to double. Some hundred times slower.
//
// What always holds: only open systems whose accelerations have a closed form, without switches and
// tables, can be run, and no measured quaternions; without the library (libquadmath) none can.
#ifndef CT_SOLVE_RUN_QUAD_RUN_H
#define CT_SOLVE_RUN_QUAD_RUN_H

#include "solve/evaluator/evaluator.h"

bool ct_quad_can_run(const struct ct_evaluator *m);

/// out (nsample x nresult) = results at equally spaced times from 0 to the duration, both included,
/// from y (q, u, work) at
/// 0. The error of a step is below `tolerance`, relative to the larger of 1 and the state. False if
/// `go_on`, which is called before every step, returns false, or if steps become too small.
/// Workspace is taken from a.
bool ct_quad_run(struct ct_arena *a, const struct ct_evaluator *m, const double *y,
                 double duration, size_t nsample, double tolerance, bool (*go_on)(void *user),
                 void *user, double *out);

#endif
