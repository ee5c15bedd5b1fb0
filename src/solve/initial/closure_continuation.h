// Closure by continuation: closes loops that close only with bent beams. Constraint offsets are
// reduced from the initial residuals to zero; the equilibrium is found at each step.
// (formulation 9.1)
#ifndef CT_SOLVE_INITIAL_CLOSURE_CONTINUATION_H
#define CT_SOLVE_INITIAL_CLOSURE_CONTINUATION_H

#include "solve/initial/assembly.h"
#include "solve/initial/static_residual.h"

/// Set the constraint offsets of s to the present residuals.
void ct_closure_continuation_begin(struct ct_static_residual *s);
/// Set all offsets to the fraction `part` of the initial residuals; for rotations, the same
/// axis and that fraction of the angle.
void ct_closure_continuation_set(struct ct_static_residual *s, double part);
/// Largest |phi| of all rows, redundant ones included; row (out): its index.
double ct_closure_continuation_remaining(struct ct_static_residual *s, size_t *row);
/// Reduce the offsets step by step to zero. The equilibrium of each step is found by Newton's
/// method. Where that finds no stable equilibrium for a small step, the potential energy is
/// minimised. False if both fail.
bool ct_closure_continuation_run(struct ct_static_residual *s, struct ct_arena *a,
                                 const struct ct_initial_state *start);

#endif
