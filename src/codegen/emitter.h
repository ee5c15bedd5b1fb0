// State of the code emitter: register allocation, homes of values in memory, loops; see x86.c,
// x86_angles.c, x86_loop.c.
#ifndef CT_CODEGEN_EMITTER_H
#define CT_CODEGEN_EMITTER_H

#include "codegen/encode.h"
#include "codegen/reroll.h"
#include "codegen/x86.h"

// Definition: vector registers of AVX2
enum { CT_NREGISTER = 16 };

// Areas of memory. Numbers above CT_AREA_WORK are streams of a loop.
enum ct_area { CT_AREA_NONE, CT_AREA_INPUT, CT_AREA_OUT, CT_AREA_WORK, CT_NAREA };

// Layout in memory of four rows of a value: contiguous, one number for all four, or apart. SAME
// with four lanes too, for constants.
enum ct_row_layout { CT_ROWS_FULL, CT_ROWS_SAME, CT_ROWS_APART };

// Memory that a stream of a loop addresses.
struct ct_stream {
    unsigned area;
    int32_t stride;
    bool stays;     // starts at the same address for each strip of rows
    bool is_number; // elements are one double, for all lanes
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
    int base[CT_NAREA + CT_REROLL_STREAMS]; // by area: base register
    struct ct_reroll reroll;
    const bool *is_kept; // by value, in loops: stored at its home at once
    uint32_t *order;     // of the body's instructions
    size_t norder;
    uint32_t first_angle, nangle; // range of the order: sines and cosines that are one call

    // reads of a value: indices in the order, ascending; those before next[v] are done
    uint32_t *start, *use, *next;
    struct ct_home *home;           // by value
    signed char *reg;               // by value: its register or -1
    uint32_t content[CT_NREGISTER]; // by register: its value or none
    uint32_t until[CT_NREGISTER];   // by register: next use of its value, or none
    unsigned used,
        pinned; // registers in use; registers that this instruction must not reassign
    uint32_t *first_output,
        *next_output; // by value, by output: lists of 1 + k of the outputs k that a value is
    uint32_t *free;   // free slots of the work array
    uint32_t nfree, nwork, nfixed;
    uint32_t place_size;            // bytes of a slot
    uint32_t width;                 // number of slots for a spilled value
    enum ct_row_layout *layout;     // by value, in loops; else NULL
    const struct ct_stream *stream; // of the loop
    uint32_t *spread; // by value: first of four slots with a broadcast constant, or none
};

// ---- x86.c ------------------------------------------------------------------------------------

/// Bytes of an element of an area or stream.
uint32_t ct_emitter_place_size(const struct ct_emitter *e, unsigned area);
struct ct_rm ct_emitter_memory(const struct ct_emitter *e, struct ct_home h);
/// Load v into a register and pin it.
int ct_emitter_load(struct ct_emitter *e, uint32_t v);
/// Free the registers of values without further use.
void ct_emitter_release(struct ct_emitter *e, const uint32_t *v, uint32_t n);
/// Unpin the registers of an instruction and free those whose values are not read again.
void ct_emitter_unpin(struct ct_emitter *e, const struct ct_instruction *i);
/// Spill all live values and empty all registers.
void ct_emitter_spill_all(struct ct_emitter *e);
/// List the reads of all values; none is done.
void ct_emitter_list_uses(struct ct_emitter *e);
void ct_emitter_instruction(struct ct_emitter *e, uint32_t at);
/// Mark the reads of v before an index in the order as done.
void ct_emitter_advance_uses(struct ct_emitter *e, uint32_t v, uint32_t at);
/// Free the slots in the work array of dead values.
void ct_emitter_free_slots(struct ct_emitter *e, const uint32_t *v, uint32_t n);

// ---- x86_angles.c -----------------------------------------------------------------------------

/// Schedule the body: dependences of angles first, then those of calls, then the rest. Is there a
/// call?
bool ct_emitter_order(struct ct_emitter *e);
/// Emit one call for all angles.
void ct_emitter_angles(struct ct_emitter *e);

// ---- x86_loop.c -------------------------------------------------------------------------------

/// Emit the loops of one stretch. Returns the first loop after them.
const struct ct_loop *ct_emitter_loops(struct ct_emitter *e, const struct ct_loop *loop,
                                       const struct ct_loop *end);

#endif
