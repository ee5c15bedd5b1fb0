// A step of a method of high order across a singular configuration, where its steps are long enough.
//
// The stages of such a method leave a part of the step without evaluations. With the position in the middle of that part,
// and the stages put onto the constraints, the step is one like others: a fifth of the evaluations of a crossing.
#ifndef CT_INTEGRATE_CROSSING_STAGE_GAP_H
#define CT_INTEGRATE_CROSSING_STAGE_GAP_H

#include "integrate/stepper.h"

struct ct_stage_gap;

/// NULL if the method or the problem does not allow it.
struct ct_stage_gap *ct_stage_gap_create(struct ct_arena *a, const struct ct_method *method,
                                         const struct ct_problem *p);

/// The step to make next, with a position `in` ahead that is not to be evaluated within `reach`, where `wanted` is as long as
/// steps may be: 0: stride from here, by ct_stage_gap_length; INFINITY: steps are too short to stride.
double ct_stage_gap_approach(const struct ct_stage_gap *s, double in, double reach,
                             double wanted);
double ct_stage_gap_length(const struct ct_stage_gap *s, double in);

/// The method's step, ready to be interpolated. *err is infinite where the motion is not smooth across: the constraints
/// cannot be met in the middle, since the mechanism only passes close by.
enum ct_eval ct_stage_gap_step(struct ct_stage_gap *s, double t, double h, const double *y,
                               const double *dy, const struct ct_tolerance *tolerance,
                               double *y1, double *dy1, double *err, void *work,
                               struct ct_integrate_stats *stats);

/// True where f is not to be computed, from `from` to `to` of the step.
bool ct_stage_gap_contains(const struct ct_stage_gap *s, double theta, double *from,
                           double *to);

#endif
