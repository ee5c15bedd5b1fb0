// Expressions -> C source: one function of doubles, for export and to check the tape.
//
//     void name(const double *in, double *out)        in[slot] of the symbols, out[nout]
//
// One statement per operation, `const double t12 = t3 * t7;`, in the order of the listing. The code
// has exactly the instructions of the listing with the same operands. Its bits therefore agree with
// tape and native code, if the compiler neither contracts nor reorders operations
// (-ffp-contract=off, no -ffast-math).
//
// What always holds: the same expressions give the same text; C99 without warnings; no globals but
// constant tables. A long body is split into functions of `split` statements, because compile time
// grows faster than linearly with the length of a function. Values that several functions use are
// passed in an array on the stack.
#ifndef CT_CODEGEN_C_H
#define CT_CODEGEN_C_H

#include "expr/listing.h"

/// All zero: the defaults.
struct ct_c_options {
    const char *name;  // of the function; NULL: "evaluate". Also the prefix of its helpers
    const char *title; // for the comment at the top; NULL: none
    size_t split;      // statements in one function; 0: 800
    bool is_static;    // static linkage
    unsigned lanes; // SIMD lanes: sets of inputs, in[lanes * slot + lane], out likewise; 0: 1
    /// Text for a symbol, a C identifier; NULL: ct_c_name of its name. Inputs are called
    /// i<slot>_<text>, so texts need not differ.
    const char *(*symbol)(void *data, struct ct_arena *a, const struct ct_sym *s);
    void *data;
};

/// C source of a listing; parameters are inputs like the others. The text lives in a.
const char *ct_c_listing(struct ct_arena *a, const struct ct_listing *l,
                         const struct ct_c_options *options);

/// A copy of s that is safe inside a C comment of one line.
const char *ct_c_comment(struct ct_arena *a, const char *s);

#endif
