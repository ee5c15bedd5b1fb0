// Encoding of x86-64 instructions with AVX registers: bytes into a buffer that grows.
//
// Source: instruction encoding, Intel 64 and IA-32 Architectures Software Developer's Manual, vol.
// 2, sections 2.3 (VEX) and 3-5.
#ifndef CT_CODEGEN_ENCODE_H
#define CT_CODEGEN_ENCODE_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>

/// General registers by their number; RIP: the instruction pointer.
enum {
    CT_RAX,
    CT_RCX,
    CT_RDX,
    CT_RBX,
    CT_RSP,
    CT_RBP,
    CT_RSI,
    CT_RDI,
    CT_R8,
    CT_R9,
    CT_R10,
    CT_R11,
    CT_R12 = 12,
    CT_R13 = 13,
    CT_R14,
    CT_R15,
    CT_RIP
};

/// An instruction of the VEX map: prefix, map, opcode.
struct ct_vex {
    unsigned char prefix; // 0: none, 1: 66, 2: F3, 3: F2
    unsigned char map;    // 1: 0F, 2: 0F 38, 3: 0F 3A
    unsigned char w, op;
};

/// The last operand: a register, or memory at base + disp (base RIP: a constant of the pool).
struct ct_rm {
    int reg; // -1: memory
    int base;
    int32_t disp;
};

/// Bit patterns of the constant pool after the code, four copies each.
enum ct_pattern { CT_SIGN_BIT, CT_ALL_BUT_SIGN, CT_ONE, CT_NPATTERN };

struct ct_fixup {
    size_t at; // offset of the 32-bit displacement
    enum ct_pattern constant;
};

/// Code under construction; a register holds one number or four.
struct ct_bytes {
    struct ct_arena *arena;
    unsigned char *byte;
    size_t n, cap;
    struct ct_fixup *fixup;
    size_t nfixup, fixup_cap;
    int lanes;
};

static inline struct ct_rm ct_in_register(int reg)
{
    return (struct ct_rm){.reg = reg};
}

static inline struct ct_rm ct_in_memory(int base, int32_t disp)
{
    return (struct ct_rm){.reg = -1, .base = base, .disp = disp};
}

static inline struct ct_rm ct_in_pool(enum ct_pattern c)
{
    return ct_in_memory(CT_RIP, (int32_t)c);
}

void ct_put(struct ct_bytes *c, unsigned byte);
/// op reg, vvvv, rm. `wide`: 256 bits. Instructions with one source have vvvv = 0.
void ct_put_vex(struct ct_bytes *c, struct ct_vex i, bool wide, int reg, int vvvv,
                struct ct_rm rm);
/// Arithmetic on one double (xx..SD) or four (xx..PD).
void ct_put_arithmetic(struct ct_bytes *c, unsigned op, int reg, int vvvv, struct ct_rm rm);
/// Bitwise operation on a whole register: a scalar operand must not be in memory.
void ct_put_bitwise(struct ct_bytes *c, unsigned op, int reg, int vvvv, struct ct_rm rm);
/// Prefetch a cache line for writing.
void ct_put_fetch(struct ct_bytes *c, struct ct_rm line);
void ct_put_load(struct ct_bytes *c, int reg, struct ct_rm from);
/// Broadcast one number to four.
void ct_put_broadcast(struct ct_bytes *c, int reg, struct ct_rm from);
/// Gather four numbers from four addresses. spare: a register that is overwritten.
void ct_put_gather(struct ct_bytes *c, int reg, int spare, const struct ct_rm from[4]);
void ct_put_store(struct ct_bytes *c, struct ct_rm to, int reg);
/// All ones where the comparison holds, else zeros; rm is not in the pool.
void ct_put_compare(struct ct_bytes *c, int reg, int vvvv, struct ct_rm rm, unsigned predicate);
/// reg = mask ? yes : no, by the sign of each number of mask
void ct_put_blend(struct ct_bytes *c, int reg, int no, int yes, int mask);
void ct_put_vzeroupper(struct ct_bytes *c);
void ct_put_push(struct ct_bytes *c, int reg);
void ct_put_pop(struct ct_bytes *c, int reg);
/// 64-bit to = from
void ct_put_move(struct ct_bytes *c, int to, int from);
void ct_put_address(struct ct_bytes *c, int reg, struct ct_rm rm);
void ct_put_immediate(struct ct_bytes *c, int reg, uint64_t v);
void ct_put_call(struct ct_bytes *c, uintptr_t function);
void ct_put_advance(struct ct_bytes *c, int reg, int32_t by);
/// 64-bit to = from + stride * by; from: one of the lower eight registers, by: one of the upper
/// eight.
void ct_put_scaled(struct ct_bytes *c, int to, int from, int by, int32_t stride);
/// reg = 0, for one of the upper eight registers.
void ct_put_zero(struct ct_bytes *c, int reg);
/// Decrement RAX and jump back to byte `to` unless it is 0.
void ct_put_back(struct ct_bytes *c, size_t to);
/// Jump back to byte `to` while reg, one of the upper eight, is less than limit.
void ct_put_back_below(struct ct_bytes *c, int reg, int32_t limit, size_t to);
/// Append the constants in use after all code and set the displacements to them.
void ct_put_pool(struct ct_bytes *c);

#endif
