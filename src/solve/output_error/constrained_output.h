// Constrained outputs, those that the constraints determine: along all motions that these allow
// they do not change, as a coordinate that a loop keeps at zero. What a step leaves of them is how
// far the loops are open, which is not for its error to hold.
//
//     |g(y') - g(y)| <= min{ 1e6 eps |g(y + d) - g(y)| s/h,  (|g(y)| + a)/4 h/s },   s = max{ 1, |y| + a },   a = absolute/T   (8.41)
//
// with y, y' where loops are closed, y' = y + d in its independent coordinates and speeds, d_i = h
// w_i, 1 <= w_i < 2, |y| the largest of all.
//
// The first says that it changes by nothing but round-off of what it is made of; the second that
// errors within the tolerance of states, along the constraints, are less than a quarter of its own,
// whatever is small beside what.
#ifndef CT_SOLVE_OUTPUT_ERROR_CONSTRAINED_OUTPUT_H
#define CT_SOLVE_OUTPUT_ERROR_CONSTRAINED_OUTPUT_H

#include "solve/output_error/controlled_output.h"

/// What is known of the outputs of a run.
struct ct_constrained_output_record {
    size_t n;
    bool *is_found;   // (n) determined by the constraints where it was looked last
    bool *is_settled; // (n) it is not, and is not looked at again
    int skip;         // calls that do not look
    int between;      // of them, planned at the last look
};

struct ct_constrained_output;

/// Of the outputs g (n of them). NULL if none can be one. Everything lives in a.
struct ct_constrained_output *
ct_constrained_output_create(struct ct_arena *a, struct ct_controlled_outputs *outputs,
                             const ct_ex *g);
/// Of n outputs; all zero.
struct ct_constrained_output_record ct_constrained_output_record(struct ct_arena *a, size_t n);
/// A new run begins: nothing is known. p may be NULL, all are settled then. leaves_speeds: as of
/// methods, outputs of speeds err across the constraints.
void ct_constrained_output_clear(const struct ct_constrained_output *p,
                                 struct ct_constrained_output_record *r, bool leaves_speeds);
/// Which are determined by the constraints at y (ny)? Where any is, only every second, fourth, then
/// every eighth call looks; an output that is not is settled. Nothing is found where loops do not
/// close. True: outputs were evaluated elsewhere.
bool ct_constrained_output_find(struct ct_constrained_output *p,
                                struct ct_constrained_output_record *r, double t,
                                const double *y, const struct ct_tolerance *tolerance);

#endif
