// Native code: a listing compiled to a function for the running processor.
//
//     listing -> prologue, interpreted, at prepare    body, compiled, at every call
//
// Available on x86-64 with AVX and the System V calling convention, where the system allows
// executable memory. Memory is writable while code is written and executable afterwards, never
// both.
//
// What always holds: results have the bits of the tape (tape.h) of the same listing, in each lane,
// unless the listing leaves fusing to native code. Evaluation allocates nothing. The function is
// constant; the work array belongs to the caller and holds the prologue's results between calls.
#ifndef CT_CODEGEN_NATIVE_H
#define CT_CODEGEN_NATIVE_H

#include "expr/listing.h"

struct ct_native;

/// Can this processor run native code of 1, 4 or 8 lanes?
bool ct_native_is_available(int lanes);
/// Compile for 1, 4 or 8 SIMD lanes, eight as twice four (native_wide.h); l must outlive the
/// result. NULL where native code is not available: use the tape. The code is freed with the arena.
/// Cost: instructions of l.
struct ct_native *ct_native_create(struct ct_arena *a, const struct ct_listing *l, int lanes);

/// Number of doubles of the work array, all lanes together.
size_t ct_native_work(const struct ct_native *f);
size_t ct_native_code_size(const struct ct_native *f);
/// The code itself, for a disassembler.
const unsigned char *ct_native_code(const struct ct_native *f);
/// Run the prologue; needed once per work array and whenever a parameter changes. Arrays are laid
/// out as in tape.h: input[lanes * slot + lane].
void ct_native_prepare(const struct ct_native *f, const double *input, double *work);
/// Run the body. out may not overlap the others.
void ct_native_eval(const struct ct_native *f, const double *input, double *out, double *work);

#endif
