// Closure by continuation: loops that close only with bent beams. Constraint offsets are reduced
// from the gaps of the open start to zero, with an equilibrium at each step.  (formulation 9.1)
#ifndef CT_SOLVE_INITIAL_CLOSURE_CONTINUATION_H
#define CT_SOLVE_INITIAL_CLOSURE_CONTINUATION_H

#include "solve/initial/static_residual.h"

/// Set the constraint offsets of s to the present gaps.
void ct_closure_continuation_begin(struct ct_static_residual *s);
/// Set all offsets to a part of the first gaps; for rotations, a part of the angle about the same
/// axis.
void ct_closure_continuation_set(struct ct_static_residual *s, double part);
/// Largest |phi| of all rows, redundant ones included; row (out): where.
double ct_closure_continuation_remaining(struct ct_static_residual *s, size_t *row);
/// Reduce the offsets step by step to zero. Each equilibrium is found by Newton's method, or by
/// descent of the potential energy if that finds no stable one even for a small step. False if both
/// fail.
bool ct_closure_continuation_run(struct ct_static_residual *s, struct ct_arena *a);

#endif
