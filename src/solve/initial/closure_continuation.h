// Closure by continuation: loops that beams must be bent to close.  (formulation 9.1)
#ifndef CT_SOLVE_INITIAL_CLOSURE_CONTINUATION_H
#define CT_SOLVE_INITIAL_CLOSURE_CONTINUATION_H

#include "solve/initial/static_residual.h"

/// What is open now becomes the gaps of s.
void ct_closure_continuation_begin(struct ct_static_residual *s);
/// A part of them is open; of turns the same axis and a part of the angle.
void ct_closure_continuation_set(struct ct_static_residual *s, double part);
/// Largest |phi| of all rows, those that depend on others included; its row.
double ct_closure_continuation_remaining(struct ct_static_residual *s, size_t *row);
/// From the open start to closed loops, in equilibrium with what is still open all the way: part by
/// part, by Newton's method, and where that finds nothing stable even for a small part, down the
/// energy. False if it gets stuck.
bool ct_closure_continuation_run(struct ct_static_residual *s, struct ct_arena *a);

#endif
