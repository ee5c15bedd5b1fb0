// Programs of an evaluator evaluated in quadruple precision: the same instructions on __float128.
// Only where the library (libquadmath) is there; without it this header declares nothing.
#ifndef CT_SOLVE_EVALUATOR_QUAD_PROGRAM_H
#define CT_SOLVE_EVALUATOR_QUAD_PROGRAM_H

#include "solve/evaluator/evaluator.h"

#ifdef CT_HAVE_QUADMATH

__extension__ typedef __float128 ct_quad;

/// A listing with its values.
struct ct_quad_program {
    const struct ct_listing *l; // NULL where the program has no outputs
    ct_quad *value;             // (l->nvalue)
};

/// Tables are not supported: their values are NaN. Everything lives in a.
struct ct_quad_program ct_quad_load(struct ct_arena *a, const struct ct_program *p);
/// out (nout) at an input in the evaluator's layout.
void ct_quad_evaluate(const struct ct_quad_program *p, const ct_quad *input, ct_quad *out);

#endif
#endif
