// Loop rerolling: straight-line code that repeats one sequence of operations (elements of a beam,
// bodies of a chain) becomes a loop. An iteration is called a row.
//
//     order     ... | body, row 0 | body, row 1 | ... | body, row count - 1 | ...
//     work      results of a row that something beyond it reads, row after row, `width` places each
//
// Loop distribution separates instructions without loop-carried dependences, which are vectorised
// over rows (results of one instruction contiguous over rows), from the others, such as running
// sums. Strip mining keeps results of a distributed loop in the cache.
//
// Operands of the body are results of the same row, values that are the same in all rows, or at
//
//     place + row * stride     of the inputs or of the work array.
//
// Operands that are not, as at the first row of a running sum, are copied there before the loop.
//
// What always holds: with and without loops, the same operations act on the same operands.
#ifndef CT_CODEGEN_REROLL_H
#define CT_CODEGEN_REROLL_H

#include "expr/listing.h"

/// Definition: strides that one loop can have, as many registers are free for them (x86.c).
enum { CT_REROLL_STREAMS = 7 };
/// Definition: rows that are done together, doubles in a vector of 256 bits.
enum { CT_ROWS_TOGETHER = 4 };
/// Instructions that a first-level instruction cache of 32 KiB holds, about 8 bytes each.
/// Derived: 32 KiB / 8 B
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
    // ROW: number of the loop's own instruction; FIXED: value; PLACE: of the work array, for all
    // rows; NUMBER: one double for all lanes, counted in doubles of the work array; OUT: output;
    // else the place at row 0, STRIP: of the strip
    uint32_t at;
    int32_t stride;
};

/// CT_REACH_NUMBER: place is that of a double
struct ct_copy {
    uint32_t value, slot; // of the work array
    bool is_number;
};

/// Not a place of the work array: the first output that the value is.
#define CT_REROLL_OUT (CT_VALUE_NONE - 1)

struct ct_loop {
    uint32_t first, period, count; // places in the order: the first one, of a row; rows
    uint32_t strip;                // rows of a strip; 0: all
    bool is_vectorized;            // rows may be done together
    uint32_t nslot, *slot;         // instructions of a row that are its own, ascending
    struct ct_operand *operand;    // (3 x nslot)
    struct ct_operand *result;     // (nslot) where it is kept; CT_REACH_ROW: nowhere
    struct ct_copy *copy;          // before the loop
    size_t ncopy, copy_cap;
    // of the first loop of a stretch: places of the strip whose last nbefore rows stand before
    // those of the next strip
    uint32_t *carried, ncarried, nbefore;
};

struct ct_reroll {
    struct ct_loop *loop; // ascending; two of one stretch follow each other
    size_t nloop;
    uint32_t *
        slot; // by value: where a result of a loop is kept, CT_REROLL_OUT; CT_VALUE_NONE: others
    struct ct_copy *table; // constants and parameters by row: copied once
    size_t ntable, table_cap;
    uint32_t nwork;   // places of the work array, up to here
    size_t nstraight; // instructions in no loop
    size_t nresult;   // of rows that are kept in memory
};

/// The loops of n instructions in the order of their execution. is_alone: by operator, not in
/// loops. Places of the work array from nwork on are used, each of `lanes` numbers. rows: that can
/// be done side by side; 1: none. Cost: about n.
struct ct_reroll ct_reroll_find(struct ct_arena *a, const struct ct_listing *l,
                                const uint32_t *order, uint32_t n,
                                const bool is_alone[CT_NKIND], uint32_t nwork, uint32_t rows,
                                uint32_t lanes);

#endif
