// A straight-line program made from expressions: the form in which they are evaluated.
//
//     inputs (values of symbols)  ->  prologue (parameters only)  ->  body  ->  outputs
//
// Only what the outputs need is in it. The prologue is run when parameters change, the body at every
// call. Instructions are scheduled into runs of equal operations, each run one tight loop, because
// a mixed stream costs several times more in dispatch.
//
// What always holds: evaluation allocates nothing; a tape is constant, the work array belongs to the
// caller and holds the prologue's results between calls; same inputs, same bits.
#ifndef CT_EXPR_TAPE_H
#define CT_EXPR_TAPE_H

#include "expr/ex.h"

struct ct_tape;

struct ct_tape_counts {
    long multiplications, additions, divisions,
        functions; // of the body; functions: sin, cos, ...
};

/// Compile nout expressions. Inputs: in[k] is a symbol whose value is read from the input vector at
/// slot[k] (distinct). Symbols of kind PARAM among them feed the prologue. A symbol that is needed
/// but not listed is a program error (asserted).
struct ct_tape *ct_tape_compile(struct ct_arena *a, const struct ct_exs *x, const ct_ex *out,
                                size_t nout, const ct_ex *in, const size_t *slot, size_t nin);

/// Number of doubles of the work array.
size_t ct_tape_work(const struct ct_tape *t);
/// Run the prologue; needed once per work array and whenever a parameter changes.
void ct_tape_prepare(const struct ct_tape *t, const double *input, double *work);
/// Run the body: out[nout].
void ct_tape_eval(const struct ct_tape *t, const double *input, double *out, double *work);
struct ct_tape_counts ct_tape_counts(const struct ct_tape *t);

/// Operations below a set of expressions without compiling: unique nodes, parameter-only ones free.
/// + includes -; negation is free. Cost: the nodes below.
struct ct_tape_counts ct_ex_count(struct ct_arena *scratch, const struct ct_exs *x,
                                  const ct_ex *e, size_t n);

#endif
