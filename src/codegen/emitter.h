// State of the code emitter: register allocation, homes of values in memory, loops; see x86.c,
// x86_angles.c, x86_loop.c.
#ifndef CT_CODEGEN_EMITTER_H
#define CT_CODEGEN_EMITTER_H

#include "codegen/encode.h"
#include "codegen/reroll.h"
#include "codegen/x86.h"

// Definition: vector registers of AVX2
enum { CT_NREGISTER = 16 };

// Beyond CT_AREA_WORK: what a stream of a loop points at.
enum ct_area { CT_AREA_NONE, CT_AREA_INPUT, CT_AREA_OUT, CT_AREA_WORK, CT_NAREA };

// How four rows of a value stand in memory: side by side, one number for all, further apart.
// SAME in four lanes too, for constants.
enum ct_row_layout { CT_ROWS_FULL, CT_ROWS_SAME, CT_ROWS_APART };

// What the streams of a loop point at.
struct ct_stream {
    unsigned area;
    int32_t stride;
    bool stays;     // with each strip of rows where it was
    bool is_number; // places are of one double, for all lanes
};

struct ct_home {
    unsigned area; // enum ct_area, or CT_NAREA + a stream
    uint32_t slot;
};

struct ct_emitter {
    struct ct_bytes code;
    struct ct_arena *arena;
    const struct ct_listing *l;
    const struct ct_x86_calls *calls;
    int base[CT_NAREA + CT_REROLL_STREAMS]; // register that points at each area
    struct ct_reroll reroll;
    const bool *is_kept; // by value, in loops: it is stored at its home at once
    uint32_t *order;     // of the body's instructions
    size_t norder;
    uint32_t first_angle, nangle; // in the order: sines and cosines that are one call

    // reads of a value: places in the order, ascending; those before next[v] are done
    uint32_t *start, *use, *next;
    struct ct_home *home;           // by value
    signed char *reg;               // by value: its register or -1
    uint32_t content[CT_NREGISTER]; // by register: its value or none
    uint32_t until[CT_NREGISTER];   // by register: next read of its value, or none
    unsigned used,
        pinned; // registers with a value; those not to be given away by this instruction
    uint32_t *first_output, *next_output; // by value, by output: 1 + k of the next one
    uint32_t *free;                       // places of the work array to be used again
    uint32_t nfree, nwork, nfixed;
    uint32_t place_size;            // bytes of a place
    uint32_t width;                 // places of a value that leaves its register
    enum ct_row_layout *layout;     // by value, in loops; else NULL
    const struct ct_stream *stream; // of the loop
    uint32_t *spread; // by value: the first of four places that hold a constant, or none
};

// ---- x86.c ------------------------------------------------------------------------------------

/// Bytes of a place of an area or stream.
uint32_t ct_emitter_place_size(const struct ct_emitter *e, unsigned area);
struct ct_rm ct_emitter_memory(const struct ct_emitter *e, struct ct_home h);
/// v in a register, pinned.
int ct_emitter_load(struct ct_emitter *e, uint32_t v);
/// Free the registers of values without further use.
void ct_emitter_release(struct ct_emitter *e, const uint32_t *v, uint32_t n);
/// Pins come off, and values of an instruction that are not read again leave.
void ct_emitter_unpin(struct ct_emitter *e, const struct ct_instruction *i);
/// Spill all live values and empty all registers.
void ct_emitter_spill_all(struct ct_emitter *e);
/// Reads of all values, none of them done.
void ct_emitter_list_uses(struct ct_emitter *e);
void ct_emitter_instruction(struct ct_emitter *e, uint32_t at);
/// Reads of v before a place in the order are done.
void ct_emitter_advance_uses(struct ct_emitter *e, uint32_t v, uint32_t at);
/// Free the slots in the work array of dead values.
void ct_emitter_free_slots(struct ct_emitter *e, const uint32_t *v, uint32_t n);

// ---- x86_angles.c -----------------------------------------------------------------------------

/// Schedule the body: first what angles need, then what calls need, then the rest. Is there a call?
bool ct_emitter_order(struct ct_emitter *e);
/// One call for all angles.
void ct_emitter_angles(struct ct_emitter *e);

// ---- x86_loop.c -------------------------------------------------------------------------------

/// The loops of one stretch. Returns the one behind them.
const struct ct_loop *ct_emitter_loops(struct ct_emitter *e, const struct ct_loop *loop,
                                       const struct ct_loop *end);

#endif
