// Constrained outputs: outputs that the constraints determine, such as a coordinate that a loop
// keeps at zero. They do not change along any motion that the constraints allow. Their error after
// a step is only the residual of the constraints, so it must not limit the step. An output counts
// as constrained if
//
//     |g(y') - g(y)| <= min{ 1e6 eps |g(y + d) - g(y)| s/h,  (|g(y)| + a)/4 h/s }     (8.41)
//     s = max{ 1, |y| + a },   a = absolute/T
//
// y and y' satisfy the constraints; y' has the independent coordinates and speeds of y + d, with
// d_i = h w_i, 1 <= w_i < 2; |y| is the largest state.
//
// The first bound says that g changes only by the round-off of its terms. The second says that
// errors of states along the constraints, within their tolerance, change g by less than a quarter
// of its own tolerance.
#ifndef CT_SOLVE_OUTPUT_ERROR_CONSTRAINED_OUTPUT_H
#define CT_SOLVE_OUTPUT_ERROR_CONSTRAINED_OUTPUT_H

#include "solve/output_error/controlled_output.h"

/// Results of the test for the outputs of a run.
struct ct_constrained_output_record {
    size_t n;
    bool *is_found;   // (n) determined by the constraints at the last test
    bool *is_settled; // (n) not constrained, and not tested again
};

struct ct_constrained_output;

/// Of the outputs g (n of them). NULL if none can be one. Everything lives in a.
struct ct_constrained_output *
ct_constrained_output_create(struct ct_arena *a, struct ct_controlled_outputs *outputs,
                             const ct_ex *g);
/// Of n outputs; all zero.
struct ct_constrained_output_record ct_constrained_output_record(struct ct_arena *a, size_t n);
/// Reset before a run. p may be NULL: then no output is constrained.
/// violates_velocity_constraints: as in struct ct_method, speeds may violate the constraints
/// after a step, so their outputs are controlled.
void ct_constrained_output_clear(const struct ct_constrained_output *p,
                                 struct ct_constrained_output_record *r,
                                 bool violates_velocity_constraints);
/// Test which outputs the constraints determine at y (ny). Outputs that are not determined are not
/// tested again.
/// Nothing is found if the loops at y' cannot be closed. True: outputs were evaluated at another
/// state.
bool ct_constrained_output_find(struct ct_constrained_output *p,
                                struct ct_constrained_output_record *r, double t,
                                const double *y, const struct ct_tolerance *tolerance);

#endif
