// Loop rerolling: straight-line code that repeats a sequence of operations (elements of a beam,
// bodies of a chain) becomes a loop. One iteration is called a row, a repeated sequence a stretch.
//
//     order     ... | body, row 0 | body, row 1 | ... | body, row count - 1 | ...
//     work      results that are read outside their row, row after row, `width` slots each
//
// Loop distribution separates instructions without loop-carried dependences from the others, such
// as running sums. The former are vectorised over rows: results of one instruction are contiguous
// over rows. Strip mining keeps the results of a distributed loop in the cache.
//
// An operand of the body is a result of the same row, a value that is the same in all rows, or at
//
//     place + row * stride     of the inputs or of the work array.
//
// Other operands, such as that of the first row of a running sum, are copied to such an address
// before the loop.
//
// What always holds: with and without loops, the same operations act on the same operands.
#ifndef CT_CODEGEN_REROLL_H
#define CT_CODEGEN_REROLL_H

#include "expr/listing.h"

/// Definition: strides that one loop can have: so many registers are free for them (x86.c).
enum { CT_REROLL_STREAMS = 7 };
/// Definition: rows computed together: doubles in a vector of 256 bits.
enum { CT_ROWS_TOGETHER = 4 };
/// Instructions that fit in a first-level instruction cache. Derived: 32 KiB / 8 B, with about 8
/// bytes per instruction.
enum { CT_REROLL_CACHED = 4096 };

enum ct_reach {
    CT_REACH_ROW,
    CT_REACH_FIXED,
    CT_REACH_INPUT,
    CT_REACH_WORK,
    CT_REACH_STRIP,
    CT_REACH_PLACE,
    CT_REACH_NUMBER,
    CT_REACH_OUT
};

struct ct_operand {
    enum ct_reach reach;
    // ROW: index of the instruction in the loop; FIXED: value; PLACE: slot of the work array, for
    // all rows; NUMBER: index of a double of the work array, the same for all lanes; OUT: output;
    // else the slot of row 0, in STRIP relative to the strip
    uint32_t at;
    int32_t stride;
};

/// Copy of a value to the work array. is_number: one double for all lanes; slot counts doubles.
struct ct_copy {
    uint32_t value, slot; // slot: index in the work array
    bool is_number;
};

/// In place of a slot: the value is stored as its first output.
#define CT_REROLL_OUT (CT_VALUE_NONE - 1)

struct ct_loop {
    uint32_t first, period,
        count;          // first: index in the order; period: instructions of a row; count: rows
    uint32_t strip;     // rows of a strip; 0: all
    bool is_vectorized; // rows may be computed together
    uint32_t nslot, *slot;      // instructions of a row that belong to this loop, ascending
    struct ct_operand *operand; // (3 x nslot)
    struct ct_operand
        *result; // (nslot) where the result is stored; CT_REACH_ROW: in a register only
    struct ct_copy *copy; // copies made before the loop
    size_t ncopy, copy_cap;
    // of the first loop of a stretch: slots of the strip whose last nbefore rows are copied in
    // front of those of the next strip
    uint32_t *carried, ncarried, nbefore;
};

struct ct_reroll {
    struct ct_loop *loop; // ascending; loops of one stretch are adjacent
    size_t nloop;
    // by value: slot of a result of a loop, or CT_REROLL_OUT; CT_VALUE_NONE for others
    uint32_t *slot;
    struct ct_copy *table; // constants and parameters by row: copied once, at prepare
    size_t ntable, table_cap;
    uint32_t nwork;   // size of the work array in slots
    size_t nstraight; // number of instructions in no loop
    size_t nresult;   // number of results that are stored in memory
};

/// Find the loops of n instructions, given in the order of execution. is_alone: by operator: never
/// part of a loop. Slots of the work array from nwork on are used, of `lanes` numbers each. rows:
/// that may be computed together; 1: none. Cost: about n.
struct ct_reroll ct_reroll_find(struct ct_arena *a, const struct ct_listing *l,
                                const uint32_t *order, uint32_t n,
                                const bool is_alone[CT_NKIND], uint32_t nwork, uint32_t rows,
                                uint32_t lanes);

#endif
