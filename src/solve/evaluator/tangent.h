// Jacobians of the residual by derivatives along directions: four colours at a time, one a lane.
#ifndef CT_SOLVE_EVALUATOR_TANGENT_H
#define CT_SOLVE_EVALUATOR_TANGENT_H

#include "expr/listing.h"
#include "formulate/equations.h"

// Definition: doubles of a vector
enum { CT_TANGENT_LANES = 4 };

struct ct_tangent_lanes;

/// l: the derivatives `along` of f, which reads its seeds after ninput numbers of an evaluator.
/// Everything lives in a. Call `use` first.
struct ct_tangent_lanes *ct_tangent_lanes_create(struct ct_arena *a,
                                                 const struct ct_residual *f,
                                                 const struct ct_listing *l, size_t nu,
                                                 size_t ninput);
/// By native code, where it is wanted and available, or the tape.
void ct_tangent_lanes_use(struct ct_arena *a, struct ct_tangent_lanes *t, bool native,
                          const double *input);
/// Parameters have changed.
void ct_tangent_lanes_prepare(struct ct_tangent_lanes *t, const double *input);
/// slope (out): values of the slopes dq, du, da, dk, dv of the residual at an input.
void ct_tangent_lanes_run(struct ct_tangent_lanes *t, const double *input, double *slope);
/// Operations of all evaluations, lanes counted by their cost.
double ct_tangent_lanes_operations(const struct ct_tangent_lanes *t);
size_t ct_tangent_lanes_code_size(const struct ct_tangent_lanes *t);

#endif
