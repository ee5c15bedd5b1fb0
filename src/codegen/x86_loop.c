// Machine code of rerolled loops. The body is emitted as a program of its own; its operands are
// addressed by registers that advance by a stride per row.
#include "codegen/emitter.h"

#include <assert.h>
#include <string.h>

static const uint32_t none = CT_VALUE_NONE;

static const int stream_register[CT_REROLL_STREAMS]
    = {CT_RCX, CT_R8, CT_R9, CT_R10, CT_R11, CT_R13, CT_R15};

// The body of a loop as a listing: values 0 ... period - 1 are its results, then operands in
// memory.
struct body {
    struct ct_emitter e;
    struct ct_listing l;
    struct ct_stream stream[CT_REROLL_STREAMS];
    unsigned nstream;
    int32_t together; // rows per iteration
    uint32_t *slot;   // 1 + value, by hash
    size_t mask;
    struct ct_operand *operand; // by value from period on
};

static unsigned stream_of(struct body *b, const struct ct_operand *o)
{
    const unsigned area = o->reach == CT_REACH_INPUT ? CT_AREA_INPUT
                        : o->reach == CT_REACH_OUT   ? CT_AREA_OUT
                                                     : CT_AREA_WORK;
    const struct ct_stream s
        = {area, o->stride, o->reach == CT_REACH_STRIP, o->reach == CT_REACH_NUMBER};
    unsigned i = 0;
    while (i < b->nstream
           && (b->stream[i].area != s.area || b->stream[i].stride != s.stride
               || b->stream[i].stays != s.stays || b->stream[i].is_number != s.is_number))
        i++;
    assert(i < CT_REROLL_STREAMS);
    if (i == b->nstream) {
        b->stream[b->nstream++] = s;
        b->e.base[CT_NAREA + i] = stream_register[i];
    }
    return CT_NAREA + i;
}

static bool is_same_operand(const struct ct_operand *a, const struct ct_operand *b)
{
    return a->reach == b->reach && a->at == b->at && a->stride == b->stride;
}

// Broadcast a constant or parameter to four doubles in the work array; each is copied once.
static struct ct_home spread(struct ct_emitter *e, uint32_t value)
{
    if (e->spread[value] == none) {
        e->spread[value] = e->nwork;
        for (int i = 0; i < 4; i++) {
            const struct ct_copy c = {value, e->nwork++};
            CT_PUSH(e->arena, e->reroll.table, e->reroll.ntable, e->reroll.table_cap, c);
        }
    }
    return (struct ct_home){CT_AREA_WORK, e->spread[value]};
}

static void place_fixed(struct body *b, const struct ct_emitter *outer, uint32_t v,
                        uint32_t value)
{
    const bool is_constant = outer->l->rate[value] != CT_RATE_CALL;
    b->e.home[v] = b->together > 1 && is_constant ? spread(&b->e, value) : outer->home[value];
    if (b->together > 1)
        b->e.layout[v] = is_constant ? CT_ROWS_FULL : CT_ROWS_SAME;
}

static void place_stream(struct body *b, uint32_t v, const struct ct_operand *o)
{
    b->e.home[v] = (struct ct_home){
        o->reach == CT_REACH_PLACE ? (unsigned)CT_AREA_WORK : stream_of(b, o), o->at};
    if (o->reach == CT_REACH_NUMBER)
        b->e.layout[v] = CT_ROWS_SAME;
    else if (b->together > 1)
        b->e.layout[v] = o->stride == 1 ? CT_ROWS_FULL : CT_ROWS_APART;
}

// The value that represents an operand; operands at one address are one value.
static uint32_t value_of(struct body *b, const struct ct_emitter *outer,
                         const struct ct_loop *loop, const struct ct_operand *o)
{
    if (o->reach == CT_REACH_ROW)
        return o->at;
    size_t h = (o->at * 31u + (uint32_t)o->stride) * 2654435761u + (unsigned)o->reach;
    for (;; h++) {
        uint32_t *slot = &b->slot[h & b->mask];
        if (*slot && !is_same_operand(&b->operand[*slot - 1 - loop->nslot], o))
            continue;
        if (!*slot) {
            const uint32_t v = (uint32_t)b->l.nvalue++;
            b->operand[v - loop->nslot] = *o;
            if (o->reach == CT_REACH_FIXED)
                place_fixed(b, outer, v, o->at);
            else
                place_stream(b, v, o);
            *slot = v + 1;
        }
        return *slot - 1;
    }
}

static void list_body(struct body *b, const struct ct_emitter *outer,
                      const struct ct_loop *loop)
{
    struct ct_arena *a = b->e.arena;
    const size_t most = 4 * (size_t)loop->nslot;
    bool *is_kept = CT_NEWN(a, bool, most);
    for (b->mask = 64; b->mask < 2 * most; b->mask *= 2)
        ;
    b->slot = CT_NEWN(a, uint32_t, b->mask);
    b->mask--;
    b->operand = CT_NEWN(a, struct ct_operand, most);
    b->l.ins = CT_NEWN(a, struct ct_instruction, loop->nslot);
    b->l.nvalue = loop->nslot;
    b->e.home = CT_NEWN(a, struct ct_home, most);
    b->e.order = CT_NEWN(a, uint32_t, loop->nslot);
    b->e.layout = CT_NEWN(a, enum ct_row_layout, most); // CT_ROWS_FULL
    for (uint32_t i = 0; i < loop->nslot; i++) {
        struct ct_instruction *ins = &b->l.ins[b->l.nins++];
        *ins = outer->l->ins[outer->order[loop->first + loop->slot[i]]];
        for (uint32_t k = 0; k < ins->narg; k++)
            ins->arg[k] = value_of(b, outer, loop, &loop->operand[3 * i + k]);
        ins->res[0] = b->e.order[i] = i;
        is_kept[i] = loop->result[i].reach != CT_REACH_ROW;
        if (is_kept[i])
            place_stream(b, i, &loop->result[i]);
    }
    b->e.norder = loop->nslot;
    b->e.is_kept = is_kept;
    b->e.reg = CT_NEWN(a, signed char, b->l.nvalue);
    memset(b->e.reg, -1, b->l.nvalue);
    b->e.first_output = CT_NEWN(a, uint32_t, b->l.nvalue);
    b->e.free = CT_NEWN(a, uint32_t, b->l.nvalue + 1);
    b->e.nfixed = b->e.nwork; // values from outside the loop keep their slots
    b->e.nfree = 0;
    ct_emitter_list_uses(&b->e);
}

// Advance the streams by a number of rows.
static void move_streams(struct body *b, int32_t rows)
{
    for (unsigned i = 0; i < b->nstream; i++)
        ct_put_advance(&b->e.code, stream_register[i],
                       rows * b->stream[i].stride
                           * (int32_t)ct_emitter_place_size(&b->e, CT_NAREA + i));
}

// Set the streams to their first row, or to the first row of a strip.
static void start_streams(struct body *b, const struct ct_loop *loop)
{
    for (unsigned i = 0; i < b->nstream; i++) {
        const int from = b->e.base[b->stream[i].area];
        if (loop->strip && !b->stream[i].stays)
            ct_put_scaled(&b->e.code, stream_register[i], from, CT_R12, b->stream[i].stride);
        else
            ct_put_move(&b->e.code, stream_register[i], from);
    }
}

// Prefetch the next row. In SIMD lanes the results of a row fill several cache lines.
static void fetch_next_row(struct body *b)
{
    // Definition: bytes of a cache line
    enum { LINE = 64 };
    for (unsigned k = 0; k < b->nstream && b->e.code.lanes > 1; k++) {
        int32_t first = INT32_MAX, last = INT32_MIN;
        for (size_t v = 0; v < b->l.nins; v++)
            if (b->e.is_kept[v] && b->e.home[v].area == CT_NAREA + k) {
                const int32_t at = ct_emitter_memory(&b->e, b->e.home[v]).disp;
                first = at < first ? at : first;
                last = at > last ? at : last;
            }
        const int32_t step
            = b->stream[k].stride * (int32_t)ct_emitter_place_size(&b->e, CT_NAREA + k);
        for (int32_t at = first; at <= last; at += LINE)
            ct_put_fetch(&b->e.code, ct_in_memory(stream_register[k], at + step));
    }
}

// Emit `times` rows, or groups of rows, from the present position of the streams, which then stand
// after them.
static void emit_rows(struct ct_emitter *e, const struct ct_loop *loop, uint32_t times,
                      bool starts, int32_t back)
{
    const int32_t together = loop->is_vectorized ? CT_ROWS_TOGETHER : 1;
    struct body b = {.e = *e, .together = together};
    b.e.l = &b.l;
    b.e.stream = b.stream;
    b.e.width = (uint32_t)together;
    list_body(&b, e, loop);
    struct ct_bytes *c = &b.e.code;
    if (starts)
        start_streams(&b, loop);
    if (back)
        move_streams(&b, -back);
    ct_put_immediate(c, CT_RAX, times);
    const size_t start = c->n;
    fetch_next_row(&b);
    if (together > 1)
        c->lanes = together;
    for (uint32_t at = 0; at < b.e.norder; at++)
        ct_emitter_instruction(&b.e, at);
    if (times > 1 || starts) {
        move_streams(&b, together);
        ct_put_back(c, start);
    }
    c->lanes = e->code.lanes;
    e->code = *c;
    e->nwork = b.e.nwork;
    e->reroll.table = b.e.reroll.table;
    e->reroll.ntable = b.e.reroll.ntable;
    e->reroll.table_cap = b.e.reroll.table_cap;
}

// Four rows at a time. The last four may overlap rows already computed, which are then computed
// again.
static void emit_side_by_side(struct ct_emitter *e, const struct ct_loop *loop, uint32_t rows)
{
    const uint32_t times = rows / CT_ROWS_TOGETHER, left = rows % CT_ROWS_TOGETHER;
    const int lanes = e->code.lanes;
    emit_rows(e, loop, times, true, 0);
    if (left)
        emit_rows(e, loop, 1, false, (int32_t)(CT_ROWS_TOGETHER - left));
    e->code.lanes = CT_ROWS_TOGETHER;
    ct_put_vzeroupper(&e->code);
    e->code.lanes = lanes;
}

// Mark the reads within a loop as done and free the slots of values that are not read again.
static void pass_loop(struct ct_emitter *e, const struct ct_loop *loop)
{
    const uint32_t end = loop->first + loop->period * loop->count;
    for (uint32_t at = loop->first; at < end; at++) {
        const struct ct_instruction *i = &e->l->ins[e->order[at]];
        for (uint32_t k = 0; k < i->narg; k++)
            ct_emitter_advance_uses(e, i->arg[k], end);
        ct_emitter_free_slots(e, i->arg, i->narg);
    }
}

static void emit_part(struct ct_emitter *e, const struct ct_loop *loop, uint32_t rows)
{
    if (loop->is_vectorized)
        emit_side_by_side(e, loop, rows);
    else
        emit_rows(e, loop, rows, true, 0);
}

// Copy the last rows of a strip in front of the first row of the next one, a whole vector at a
// time.
static void carry_over(struct ct_emitter *e, const struct ct_loop *loop)
{
    const int lanes = e->code.lanes;
    e->code.lanes = CT_ROWS_TOGETHER;
    for (uint32_t i = 0; i < loop->ncarried; i++)
        for (uint32_t back = CT_ROWS_TOGETHER; back < loop->nbefore + CT_ROWS_TOGETHER;
             back += CT_ROWS_TOGETHER) {
            const struct ct_home to = {CT_AREA_WORK, loop->carried[i] - back},
                                 from = {CT_AREA_WORK, to.slot + loop->strip};
            const int r = (int)(i % CT_NREGISTER);
            ct_put_load(&e->code, r, ct_emitter_memory(e, from));
            ct_put_store(&e->code, ct_emitter_memory(e, to), r);
        }
    ct_put_vzeroupper(&e->code);
    e->code.lanes = lanes;
}

// Emit the strip-mined loops: all parts of a strip before the next strip. R12: byte offset of the
// strip within one result.
static void emit_strips(struct ct_emitter *e, const struct ct_loop *loop,
                        const struct ct_loop *end)
{
    const uint32_t rest = loop->count % loop->strip, times = loop->count / loop->strip;
    const int32_t step = (int32_t)(loop->strip * e->place_size);
    ct_put_zero(&e->code, CT_R12);
    const size_t start = e->code.n;
    for (const struct ct_loop *part = loop; part < end; part++)
        emit_part(e, part, part->strip);
    carry_over(e, loop);
    ct_put_advance(&e->code, CT_R12, step);
    ct_put_back_below(&e->code, CT_R12, (int32_t)times * step, start);
    for (const struct ct_loop *part = loop; part < end && rest; part++)
        emit_part(e, part, rest);
}

static void emit_copies(struct ct_emitter *e, const struct ct_loop *loop)
{
    for (size_t i = 0; i < loop->ncopy; i++) {
        const int r = ct_emitter_load(e, loop->copy[i].value);
        ct_put_store(&e->code,
                     ct_emitter_memory(e, (struct ct_home){CT_AREA_WORK, loop->copy[i].slot}),
                     r);
        e->pinned = 0;
        ct_emitter_release(e, &loop->copy[i].value, 1);
    }
    ct_emitter_spill_all(e);
}

// Emit the loops of one stretch. Returns the first loop after them.
const struct ct_loop *ct_emitter_loops(struct ct_emitter *e, const struct ct_loop *loop,
                                       const struct ct_loop *end)
{
    const struct ct_loop *first = loop;
    while (loop < end && loop->first == first->first)
        loop++;
    emit_copies(e, first);
    if (first->strip)
        emit_strips(e, first, loop);
    else
        for (const struct ct_loop *part = first; part < loop; part++)
            emit_part(e, part, part->count);
    pass_loop(e, first);
    return loop;
}
