// Repetitions in a program; shared by the files that detect them (reroll_find.c), find the
// addresses of their operands (reroll.c) and lay out their results in memory (reroll_layout.c).
#ifndef CT_CODEGEN_REROLL_LAYOUT_H
#define CT_CODEGEN_REROLL_LAYOUT_H

#include "codegen/reroll.h"

struct ct_repetitions {
    struct ct_arena *arena, *scratch; // scratch: until the loops are made
    const struct ct_listing *l;
    const uint32_t *order;
    uint32_t n;
    uint32_t *at;     // by value: index in the order of its instruction, or none
    uint64_t *sign;   // by index: what must be equal in each row
    uint32_t *again;  // by index: the next one whose window has the same hash, or none
    bool *is_swapped; // by index, see ct_repetition_argument
    struct ct_repetition *repetition;
    size_t nrepetition, repetition_cap;
    uint32_t *repetition_of; // by index: its stretch, or none
    uint32_t *output;        // by value: 1 + its first output, or 0
};

// A value from outside that is stored as if a row before the first, or after the last one, had
// computed it (peeled iteration).
struct ct_repetition_edge {
    int32_t row;
    uint32_t value;
    uint32_t next;  // 1 + index of the next edge of the instruction
    uint32_t asker; // index of the first repetition that needs it
};

// A column: the values of one operand in all rows, copied to contiguous slots.
struct ct_repetition_column {
    uint32_t operand; // operand 3 slot + k whose values these are
    bool is_copied;   // changes, so it is copied in each evaluation
    bool is_number;   // constants: one double for all lanes
    uint32_t at;      // index among the columns of its kind
};

// Where an operand comes from, before slots are assigned.
struct ct_source {
    enum {
        CT_SOURCE_OPEN, // not resolved yet
        CT_SOURCE_ROW,
        CT_SOURCE_FIXED,
        CT_SOURCE_INPUTS,
        CT_SOURCE_RESULTS,
        CT_SOURCE_COLUMN
    } kind;
    // instruction of the body; value; input at row 0; instruction of the other body; column
    uint32_t at;
    uint32_t other; // CT_SOURCE_RESULTS: index of the repetition
    int32_t row,
        // CT_SOURCE_RESULTS: its row for row 0, and its rows per row; CT_SOURCE_INPUTS: step is the
        // stride
        step;
};

// Storage of a result that is read outside its row. ROWS: all rows. STRIP: one strip of rows.
// PLACE: one slot for all rows, if each row reads it before it writes. OUT: the output itself, with
// out_stride between rows.
enum ct_keep { CT_KEEP_ROWS, CT_KEEP_STRIP, CT_KEEP_PLACE, CT_KEEP_OUT };

struct ct_repetition_stream {
    int kind;
    uint32_t other;
    int32_t step;
};

struct ct_repetition {
    uint32_t first, period, count;
    uint32_t ncut, whole_first, whole_count; // before it was split
    bool is_dropped;
    struct ct_source *reach; // (3 x period)
    bool *escapes;           // (period) read outside its row, or by another part of the loop
    bool *escapes_far;       // (period) read by another stretch, in each row
    uint32_t *least_row;     // (period) first row that is read from outside
    uint32_t *edge_of;       // (period) 1 + the first edge
    struct ct_repetition_edge *edge;
    size_t nedge, edge_cap;
    struct ct_repetition_column *column;
    size_t ncolumn, column_cap;
    struct ct_repetition_stream stream[CT_REROLL_STREAMS];
    int nstream;
    int32_t before, behind;           // rows reserved for edges
    uint32_t keep_first, keep_behind; // see drop_end_rows

    // rows are computed together, see choose_lanes
    bool is_vectorized;
    unsigned char
        *part; // (period) number of its loop; npart - 1: the loop that is not vectorised
    uint32_t npart, nlate;

    // slots
    uint32_t origin;                  // slot of row 0
    enum ct_keep *keep;               // (period)
    uint32_t *offset;                 // (period) number of the result, or output of row 0
    int32_t *out_stride;              // (period)
    uint32_t row_stride, slot_stride; // slots between rows, and between results
    uint32_t nresult;
    uint32_t strip; // rows of a strip; 0: all
    uint32_t local_origin, local_stride, nlocal;
    uint32_t passed_origin, npassed;
    uint32_t number_origin,
        nnumber; // columns of constants, one double for all lanes: index of row 0; doubles per row
};

static inline const struct ct_instruction *
ct_repetition_instruction(const struct ct_repetitions *p, uint32_t place)
{
    return &p->l->ins[p->order[place]];
}

/// Operand k of an instruction. Commutative operands are put into a canonical order, because their
/// order in the expression store depends on age and may differ between rows.
static inline uint32_t ct_repetition_operand(const struct ct_repetitions *p, uint32_t place,
                                             uint32_t k)
{
    return ct_repetition_instruction(p, place)->arg[k < 2 && p->is_swapped[place] ? 1 - k : k];
}

/// Operand 3 slot + k of a row.
static inline uint32_t ct_repetition_argument(const struct ct_repetitions *p,
                                              const struct ct_repetition *r, uint32_t row,
                                              uint32_t operand)
{
    return ct_repetition_operand(p, r->first + row * r->period + operand / 3, operand % 3);
}

/// The stretch that computes v, with its row and instruction; NULL if none.
static inline struct ct_repetition *ct_repetition_of(const struct ct_repetitions *p, uint32_t v,
                                                     int32_t *row, uint32_t *slot)
{
    const uint32_t at = p->at[v];
    if (at == CT_VALUE_NONE || p->repetition_of[at] == CT_VALUE_NONE)
        return NULL;
    struct ct_repetition *r = &p->repetition[p->repetition_of[at]];
    *row = (int32_t)((at - r->first) / r->period);
    *slot = (at - r->first) % r->period;
    return r;
}

enum { CT_LEAST_ROWS = CT_ROWS_TOGETHER }; // rows that fill a vector

/// Find all repetitions, ascending. is_alone, rows: as in ct_reroll_find.
void ct_repetitions_find(struct ct_repetitions *p, const bool is_alone[CT_NKIND],
                         uint32_t rows);
/// Assign slots to all results that need one, and make the loops. Arguments as in ct_reroll_find.
void ct_repetition_lay_out(struct ct_repetitions *p, uint32_t rows, uint32_t lanes,
                           struct ct_reroll *out);

#endif
