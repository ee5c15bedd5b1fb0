// Straight-line program (tape) made from expressions, and its interpreter.
//
//     inputs (values of symbols)  ->  prologue (parameters only)  ->  body  ->  outputs
//
// The prologue runs when parameters change, the body at every call. Instructions are sorted into
// runs of equal operations. Each run is one tight loop, because dispatch of a mixed stream costs
// several times more.
//
// Several sets of inputs can be evaluated at once in SIMD lanes: 1, 4 or 8 numbers take the place
// of one,
//
//     input[lanes * slot + lane],   out[lanes * k + lane],   work: lanes * ct_tape_work
//
// Each lane gives the same bits as an evaluation of that set alone.
//
// What always holds: evaluation allocates nothing. A tape is constant. The work array belongs to
// the caller and holds the results of the prologue between calls. Same inputs, same bits.
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
