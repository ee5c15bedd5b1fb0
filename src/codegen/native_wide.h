// Eight lanes of native code: the code for four lanes, run for the lower and for the upper half.
//
//     input[8 * slot + lane]  -> half ->  four lanes  -> code ->  four lanes  -> out[8 * k + lane]
//
// Vectors of eight numbers need AVX-512; this code needs AVX only.
#ifndef CT_CODEGEN_NATIVE_WIDE_H
#define CT_CODEGEN_NATIVE_WIDE_H

#include "codegen/native.h"

// Definition: two vectors of four
enum { CT_NATIVE_WIDE_LANES = 8 };

struct ct_native_wide;

/// Wrap the code for four lanes made from l, which must outlive the result.
struct ct_native_wide *ct_native_wide_create(struct ct_arena *a, const struct ct_native *four,
                                             const struct ct_listing *l);
/// Number of doubles of the work array.
size_t ct_native_wide_work(const struct ct_native_wide *p);
/// As the functions of native.h, for eight lanes.
void ct_native_wide_prepare(const struct ct_native_wide *p, const double *input, double *work);
void ct_native_wide_eval(const struct ct_native_wide *p, const double *input, double *out,
                         double *work);

#endif
