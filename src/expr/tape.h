// Straight-line program (tape) made from expressions, and its interpreter.
//
//     inputs (values of symbols)  ->  prologue (parameters only)  ->  body  ->  outputs
//
// The prologue is run when parameters change, the body at every call. Instructions are scheduled
// into runs of equal operations, each run one tight loop, because a mixed stream costs several
// times more in dispatch.
//
// Several sets of inputs are evaluated at once in SIMD lanes, 1, 4 or 8 numbers for each one,
//
//     input[lanes * slot + lane],   out[lanes * k + lane],   work: lanes * ct_tape_work
//
// and each lane has the bits it has alone.
//
// What always holds: evaluation allocates nothing; a tape is constant, the work array belongs to
// the caller and holds the prologue's results between calls; same inputs, same bits.
#ifndef CT_EXPR_TAPE_H
#define CT_EXPR_TAPE_H

#include "expr/listing.h"

struct ct_tape;

/// Compile a listing. Cost: its instructions.
struct ct_tape *ct_tape_create(struct ct_arena *a, const struct ct_listing *l);
/// List and compile; the arguments are those of ct_listing_create.
struct ct_tape *ct_tape_compile(struct ct_arena *a, const struct ct_exs *x, const ct_ex *out,
                                size_t nout, const ct_ex *in, const size_t *slot, size_t nin);

/// Number of doubles of the work array, for one lane.
size_t ct_tape_work(const struct ct_tape *t);
/// Run the prologue; needed once per work array and whenever a parameter changes.
void ct_tape_prepare(const struct ct_tape *t, const double *input, double *work);
/// Run the body: out[nout].
void ct_tape_eval(const struct ct_tape *t, const double *input, double *out, double *work);
struct ct_tape_counts ct_tape_counts(const struct ct_tape *t);

/// The same for 1, 4 or 8 lanes.
void ct_tape_prepare_lanes(const struct ct_tape *t, int lanes, const double *input,
                           double *work);
void ct_tape_eval_lanes(const struct ct_tape *t, int lanes, const double *input, double *out,
                        double *work);

#endif
