// src/codegen turns listings of instructions (expr/listing.h) into C source and into machine code
// of the running processor. c.h prints one function; export.h prints a whole system as C or as an
// FMU. For machine code, native.h is the entry, x86.h selects instructions and allocates registers,
// reroll.h finds loops, encode.h encodes instructions. All back ends execute the same operations on
// the same operands.
//
// This file is the just-in-time compiler: instruction listing -> x86-64 machine code with AVX
// registers.
//
//     void code(const double *input, double *out, double *work)     System V calls
//
// The body becomes straight-line code, with loops where a long body can be rerolled (reroll.h). VEX
// instructions work on scalar doubles (xmm) or on four SIMD lanes (ymm). Local register allocation
// spills the value with the farthest next use. Each value has a home in memory: its input, its
// output, or a slot of the work array. Operands without further use are memory operands of the
// instruction. Functions (sine, powers, tables) are calls that read and write memory. Calls and the
// instructions they depend on are scheduled first, while few values are live. Sines and cosines of
// all angles that depend on no other function, such as joint angles, are one call.
//
// Nothing here executes or allocates executable memory: that is native.c.
//
// Sources: instruction encoding, Intel 64 and IA-32 Architectures Software Developer's Manual, vol.
// 2, sections 2.3 (VEX) and 3-5; calling convention, System V ABI AMD64, section 3.2; replacement
// by farthest next use, Belady (1966), key belady1966.
#ifndef CT_CODEGEN_X86_H
#define CT_CODEGEN_X86_H

#include "codegen/reroll.h"

/// Functions that code calls for an operator, from memory to memory, `lanes` numbers each:
///
///     one argument    f(res, arg)             two arguments   f(res, arg, arg2)
///     sincos          f(sin, arg, cos)        table           f(res, arg, table, order)
///
/// Zero for operators that need none. sincos_many takes the angles that no other function leads to
/// at once: f(sin, angle, cos, n) with n numbers each, lanes counted.
struct ct_x86_calls {
    uintptr_t by_op[CT_NKIND];
    uintptr_t sincos_many;
    bool rows_together; // AVX2: rows of loops may be computed four at a time
};

struct ct_x86_code {
    const unsigned char
        *byte; // position independent but for the addresses of functions and tables
    size_t nbyte;
    size_t nwork;                // places of the work array, of `lanes` doubles
    const struct ct_copy *table; // constants and parameters, copied again whenever these change
    size_t ntable;
};

/// Emit the body of l. home[v]: index in the work array of constants, parameters and results of the
/// prologue that the body or the outputs need; indices from nhome on are free. lanes: 1 or 4.
/// Callee-saved registers are preserved. Needs AVX; FMA if l has fused operations.
struct ct_x86_code ct_x86_emit(struct ct_arena *a, const struct ct_listing *l, int lanes,
                               const uint32_t *home, size_t nhome,
                               const struct ct_x86_calls *calls);

#endif
