// Encoding of x86-64 instructions; see encode.h.
#include "codegen/encode.h"

#include <assert.h>

static const uint64_t pattern[CT_NPATTERN]
    = {UINT64_C(1) << 63, ~(UINT64_C(1) << 63), UINT64_C(0x3FF) << 52};

void ct_put(struct ct_bytes *c, unsigned byte)
{
    if (c->n == c->cap)
        c->byte = ct_arena_grow(c->arena, c->byte, c->n, &c->cap, 1);
    c->byte[c->n++] = (unsigned char)byte;
}

static void put_number(struct ct_bytes *c, uint64_t v, int nbyte)
{
    for (int i = 0; i < nbyte; i++)
        ct_put(c, (unsigned)(v >> 8 * i & 0xFF));
}

// Encode ModRM and displacement. R14 as a base needs no SIB byte, R12 would.
static void put_operand(struct ct_bytes *c, int reg, struct ct_rm rm)
{
    const unsigned middle = (unsigned)(reg & 7) << 3;
    if (rm.reg >= 0) {
        ct_put(c, 0xC0 | middle | (unsigned)(rm.reg & 7));
    } else if (rm.base == CT_RIP) {
        ct_put(c, 0x05 | middle);
        const struct ct_fixup f = {c->n, (enum ct_pattern)rm.disp};
        CT_PUSH(c->arena, c->fixup, c->nfixup, c->fixup_cap, f);
        put_number(c, 0, 4);
    } else if (rm.disp >= -128 && rm.disp < 128) {
        ct_put(c, 0x40 | middle | (unsigned)(rm.base & 7));
        put_number(c, (uint64_t)rm.disp, 1);
    } else {
        ct_put(c, 0x80 | middle | (unsigned)(rm.base & 7));
        put_number(c, (uint64_t)rm.disp, 4);
    }
}

// op reg, vvvv, rm. `wide`: 256 bits. Instructions with one source have vvvv = 0.
void ct_put_vex(struct ct_bytes *c, struct ct_vex i, bool wide, int reg, int vvvv,
                struct ct_rm rm)
{
    const bool far_reg = reg >= 8,
               far_rm = rm.reg >= 0 ? rm.reg >= 8 : rm.base >= 8 && rm.base != CT_RIP;
    const unsigned low = (unsigned)(~vvvv & 15) << 3 | (wide ? 4 : 0) | i.prefix;
    if (i.map == 1 && !i.w && !far_rm) {
        ct_put(c, 0xC5);
        ct_put(c, (far_reg ? 0 : 0x80) | low);
    } else {
        ct_put(c, 0xC4);
        ct_put(c, (far_reg ? 0 : 0x80) | 0x40 | (far_rm ? 0 : 0x20) | i.map);
        ct_put(c, (i.w ? 0x80 : 0) | low);
    }
    ct_put(c, i.op);
    put_operand(c, reg, rm);
}

// Arithmetic on one double (xx..SD) or four (xx..PD).
void ct_put_arithmetic(struct ct_bytes *c, unsigned op, int reg, int vvvv, struct ct_rm rm)
{
    const struct ct_vex i = {c->lanes == 1 ? 3 : 1, 1, 0, (unsigned char)op};
    ct_put_vex(c, i, c->lanes > 1, reg, vvvv, rm);
}

// Bitwise operation on a whole register: a scalar operand must not be in memory.
void ct_put_bitwise(struct ct_bytes *c, unsigned op, int reg, int vvvv, struct ct_rm rm)
{
    ct_put_vex(c, (struct ct_vex){1, 1, 0, (unsigned char)op}, c->lanes > 1, reg, vvvv, rm);
}

void ct_put_fetch(struct ct_bytes *c, struct ct_rm line)
{
    if (line.base >= 8)
        ct_put(c, 0x41);
    ct_put(c, 0x0F); // prefetchw
    ct_put(c, 0x0D);
    put_operand(c, 1, line);
}

void ct_put_load(struct ct_bytes *c, int reg, struct ct_rm from)
{
    ct_put_arithmetic(c, 0x10, reg, 0, from); // vmovsd, vmovupd
}

void ct_put_broadcast(struct ct_bytes *c, int reg, struct ct_rm from)
{
    ct_put_vex(c, (struct ct_vex){1, 2, 0, 0x19}, true, reg, 0, from); // vbroadcastsd
}

void ct_put_gather(struct ct_bytes *c, int reg, int spare, const struct ct_rm from[4])
{
    const struct ct_vex low = {3, 1, 0, 0x10}, high = {1, 1, 0, 0x16}; // vmovsd, vmovhpd
    ct_put_vex(c, low, false, reg, 0, from[0]);
    ct_put_vex(c, high, false, reg, reg, from[1]);
    ct_put_vex(c, low, false, spare, 0, from[2]);
    ct_put_vex(c, high, false, spare, spare, from[3]);
    ct_put_vex(c, (struct ct_vex){1, 3, 0, 0x18}, true, reg, reg, ct_in_register(spare));
    ct_put(c, 1); // vinsertf128
}

void ct_put_store(struct ct_bytes *c, struct ct_rm to, int reg)
{
    ct_put_arithmetic(c, 0x11, reg, 0, to);
}

void ct_put_compare(struct ct_bytes *c, int reg, int vvvv, struct ct_rm rm, unsigned predicate)
{
    assert(rm.reg >= 0
           || rm.base
                  != CT_RIP); // the immediate byte would shift a displacement relative to RIP
    ct_put_arithmetic(c, 0xC2, reg, vvvv, rm);
    ct_put(c, predicate);
}

// reg = mask ? yes : no, by the sign of each number of mask
void ct_put_blend(struct ct_bytes *c, int reg, int no, int yes, int mask)
{
    ct_put_vex(c, (struct ct_vex){1, 3, 0, 0x4B}, c->lanes > 1, reg, no, ct_in_register(yes));
    ct_put(c, (unsigned)mask << 4);
}

void ct_put_vzeroupper(struct ct_bytes *c)
{
    if (c->lanes > 1)
        put_number(c, 0x77F8C5, 3);
}

void ct_put_push(struct ct_bytes *c, int reg)
{
    if (reg >= 8)
        ct_put(c, 0x41);
    ct_put(c, 0x50 | (unsigned)(reg & 7));
}

void ct_put_pop(struct ct_bytes *c, int reg)
{
    if (reg >= 8)
        ct_put(c, 0x41);
    ct_put(c, 0x58 | (unsigned)(reg & 7));
}

// 64-bit to = from, for one of the lower eight registers.
void ct_put_move(struct ct_bytes *c, int to, int from)
{
    ct_put(c, 0x48 | (to >= 8) | (from >= 8) << 2);
    ct_put(c, 0x89);
    ct_put(c, 0xC0 | (unsigned)(from & 7) << 3 | (unsigned)(to & 7));
}

void ct_put_address(struct ct_bytes *c, int reg, struct ct_rm rm)
{
    ct_put(c, rm.base >= 8 ? 0x49 : 0x48);
    ct_put(c, 0x8D);
    put_operand(c, reg, rm);
}

void ct_put_immediate(struct ct_bytes *c, int reg, uint64_t v)
{
    ct_put(c, 0x48);
    ct_put(c, 0xB8 | (unsigned)reg);
    put_number(c, v, 8);
}

void ct_put_call(struct ct_bytes *c, uintptr_t function)
{
    ct_put_immediate(c, CT_RAX, function);
    ct_put(c, 0xFF);
    ct_put(c, 0xD0);
}

void ct_put_advance(struct ct_bytes *c, int reg, int32_t by)
{
    ct_put(c, reg >= 8 ? 0x49 : 0x48);
    ct_put(c, 0x81);
    ct_put(c, 0xC0 | (unsigned)(reg & 7));
    put_number(c, (uint64_t)by, 4);
}

void ct_put_scaled(struct ct_bytes *c, int to, int from, int by, int32_t stride)
{
    const unsigned upper = to >= 8;
    ct_put(c, 0x49 | upper << 2); // imul to, by, stride
    ct_put(c, 0x69);
    ct_put(c, 0xC0 | (unsigned)(to & 7) << 3 | (unsigned)(by & 7));
    put_number(c, (uint64_t)stride, 4);
    ct_put(c, 0x48 | upper); // add to, from
    ct_put(c, 0x01);
    ct_put(c, 0xC0 | (unsigned)from << 3 | (unsigned)(to & 7));
}

void ct_put_zero(struct ct_bytes *c, int reg)
{
    ct_put(c, 0x45); // xor reg, reg
    ct_put(c, 0x31);
    ct_put(c, 0xC0 | (unsigned)(reg & 7) << 3 | (unsigned)(reg & 7));
}

void ct_put_back_below(struct ct_bytes *c, int reg, int32_t limit, size_t to)
{
    ct_put(c, 0x49); // cmp reg, limit
    ct_put(c, 0x81);
    ct_put(c, 0xF8 | (unsigned)(reg & 7));
    put_number(c, (uint64_t)limit, 4);
    put_number(c, 0x8C0F, 2); // jl
    put_number(c, (uint64_t)to - (uint64_t)(c->n + 4), 4);
}

// Decrement RAX and jump back to byte `to` unless it is 0.
void ct_put_back(struct ct_bytes *c, size_t to)
{
    put_number(c, 0xC8FF48, 3); // dec rax
    put_number(c, 0x850F, 2);   // jnz
    put_number(c, (uint64_t)to - (uint64_t)(c->n + 4), 4);
}

// Append the constants in use and set the displacements to them. RIP is the address of the next
// instruction, four bytes after the displacement.
void ct_put_pool(struct ct_bytes *c)
{
    size_t at[CT_NPATTERN] = {0};
    while (c->n % 32)
        ct_put(c, 0xCC);
    for (size_t k = 0; k < c->nfixup; k++) {
        const struct ct_fixup *f = &c->fixup[k];
        if (!at[f->constant]) {
            at[f->constant] = c->n;
            for (int i = 0; i < 4; i++)
                put_number(c, pattern[f->constant], 8);
        }
        const uint32_t disp = (uint32_t)(at[f->constant] - (f->at + 4));
        for (int i = 0; i < 4; i++)
            c->byte[f->at + (size_t)i] = (unsigned char)(disp >> 8 * i);
    }
}
