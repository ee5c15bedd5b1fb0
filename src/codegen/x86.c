// Register allocation and instruction selection over a listing; see x86.h.
#include "codegen/emitter.h"

#include <assert.h>
#include <string.h>

static const uint32_t none = CT_VALUE_NONE;

// ---- registers and homes of values -------------------------------------------------------------

uint32_t ct_emitter_place_size(const struct ct_emitter *e, unsigned area)
{
    return area >= CT_NAREA && e->stream[area - CT_NAREA].is_number ? sizeof(double)
                                                                    : e->place_size;
}

struct ct_rm ct_emitter_memory(const struct ct_emitter *e, struct ct_home h)
{
    assert(h.area != CT_AREA_NONE);
    return ct_in_memory(e->base[h.area], (int32_t)(h.slot * ct_emitter_place_size(e, h.area)));
}

// Index in the order of the next instruction that reads v; none if v is not read again.
static uint32_t next_use(const struct ct_emitter *e, uint32_t v)
{
    return e->next[v] < e->start[v + 1] ? e->use[e->next[v]] : none;
}

static bool is_spilled(const struct ct_emitter *e, uint32_t v)
{
    return e->home[v].area == CT_AREA_WORK && e->home[v].slot >= e->nfixed;
}

static void need_home(struct ct_emitter *e, uint32_t v)
{
    if (e->home[v].area != CT_AREA_NONE)
        return;
    if (!e->nfree) {
        e->free[e->nfree++] = e->nwork;
        e->nwork += e->width;
    }
    e->home[v] = (struct ct_home){CT_AREA_WORK, e->free[--e->nfree]};
    if (e->reg[v] >= 0)
        ct_put_store(&e->code, ct_emitter_memory(e, e->home[v]), e->reg[v]);
}

static void leave_register(struct ct_emitter *e, uint32_t v)
{
    if (e->reg[v] >= 0) {
        e->content[e->reg[v]] = none;
        e->used &= ~(1u << e->reg[v]);
    }
    e->reg[v] = -1;
}

// Mark the reads of v before an index in the order as done.
void ct_emitter_advance_uses(struct ct_emitter *e, uint32_t v, uint32_t at)
{
    while (next_use(e, v) < at)
        e->next[v]++;
    if (e->reg[v] >= 0)
        e->until[e->reg[v]] = next_use(e, v);
}

// A free register, else the one whose value has the farthest next use; -1 if all are pinned.
static int best_register(const struct ct_emitter *e)
{
    const unsigned unused = ~(e->used | e->pinned) & ((1u << CT_NREGISTER) - 1);
    if (unused)
        return __builtin_ctz(unused);
    int best = -1;
    for (unsigned left = e->used & ~e->pinned; left; left &= left - 1) {
        const int r = __builtin_ctz(left);
        if (best < 0 || e->until[r] > e->until[best])
            best = r;
    }
    return best;
}

// Allocate a register for v and pin it; v = none: for an intermediate result.
static int take_register(struct ct_emitter *e, uint32_t v)
{
    const int r = best_register(e);
    assert(r >= 0);
    if (e->content[r] != none) {
        need_home(e, e->content[r]);
        leave_register(e, e->content[r]);
    }
    e->content[r] = v;
    e->pinned |= 1u << r;
    if (v != none) {
        e->reg[v] = (signed char)r;
        e->until[r] = next_use(e, v);
        e->used |= 1u << r;
    }
    return r;
}

// Load four rows that are not contiguous.
static void gather(struct ct_emitter *e, int r, uint32_t v)
{
    const int32_t step = e->stream[e->home[v].area - CT_NAREA].stride * (int32_t)e->place_size;
    struct ct_rm m[4] = {ct_emitter_memory(e, e->home[v])};
    for (int i = 1; i < 4; i++) {
        m[i] = m[0];
        m[i].disp += i * step;
    }
    ct_put_gather(&e->code, r, take_register(e, none), m);
}

// Load v into a register and pin it.
int ct_emitter_load(struct ct_emitter *e, uint32_t v)
{
    if (e->reg[v] >= 0) {
        e->pinned |= 1u << e->reg[v];
        return e->reg[v];
    }
    const int r = take_register(e, v);
    if (!e->layout || e->layout[v] == CT_ROWS_FULL)
        ct_put_load(&e->code, r, ct_emitter_memory(e, e->home[v]));
    else if (e->layout[v] == CT_ROWS_SAME)
        ct_put_broadcast(&e->code, r, ct_emitter_memory(e, e->home[v]));
    else
        gather(e, r, v);
    return r;
}

// v as last operand: a register if v is in one, or if its next use is earlier than that of some
// value in a register; else memory.
static struct ct_rm operand(struct ct_emitter *e, uint32_t v)
{
    if (e->reg[v] < 0 && (!e->layout || e->layout[v] == CT_ROWS_FULL)) {
        const uint32_t again = next_use(e, v);
        const int r = again == none ? -1 : best_register(e);
        if (r < 0 || (e->used >> r & 1 && e->until[r] <= again))
            return ct_emitter_memory(e, e->home[v]);
    }
    return ct_in_register(ct_emitter_load(e, v));
}

// Which of two commutative operands must be in a register: one that already is, else the one with
// the earlier next use.
static bool prefer_second(const struct ct_emitter *e, uint32_t a, uint32_t b)
{
    const bool has_a = e->reg[a] >= 0, has_b = e->reg[b] >= 0;
    return has_a != has_b ? has_b : next_use(e, b) < next_use(e, a);
}

// ---- instructions -----------------------------------------------------------------------------

void ct_emitter_release(struct ct_emitter *e, const uint32_t *v, uint32_t n)
{
    for (uint32_t k = 0; k < n; k++)
        if (e->reg[v[k]] >= 0 && e->until[e->reg[v[k]]] == none)
            leave_register(e, v[k]);
}

// Unpin the registers of an instruction and free those whose values are not read again.
void ct_emitter_unpin(struct ct_emitter *e, const struct ct_instruction *i)
{
    e->pinned = 0;
    ct_emitter_release(e, i->arg, i->narg);
    ct_emitter_release(e, i->res, i->nres);
}

// Register of the result. It may be that of an operand: if the operand is read again it is stored
// first, and instructions read before they write.
static int result(struct ct_emitter *e, const struct ct_instruction *i)
{
    ct_emitter_unpin(e, i);
    return take_register(e, i->res[0]);
}

static void emit_binary(struct ct_emitter *e, const struct ct_instruction *i, unsigned op,
                        bool commutes)
{
    const bool swap = commutes && prefer_second(e, i->arg[0], i->arg[1]);
    const int a = ct_emitter_load(e, i->arg[swap]);
    const struct ct_rm b = operand(e, i->arg[!swap]);
    ct_put_arithmetic(&e->code, op, result(e, i), a, b);
}

static void emit_sqrt(struct ct_emitter *e, const struct ct_instruction *i)
{
    const int a = ct_emitter_load(e, i->arg[0]), d = result(e, i);
    ct_put_arithmetic(&e->code, 0x51, d, e->code.lanes == 1 ? a : 0, ct_in_register(a));
}

// Flip or clear the sign.
static void emit_sign_bit(struct ct_emitter *e, const struct ct_instruction *i, unsigned op,
                          enum ct_pattern c)
{
    const int a = ct_emitter_load(e, i->arg[0]);
    ct_put_bitwise(&e->code, op, result(e, i), a, ct_in_pool(c));
}

// Definition: opcodes
enum { AND = 0x54, XOR = 0x57 };
enum { EQ_OQ = 0x00, NEQ_UQ = 0x04, LT_OQ = 0x11, LE_OQ = 0x12, GE_OQ = 0x1D, GT_OQ = 0x1E };

// AND of the comparison mask (all ones or all zeros) with the bits of 1.0 gives 1 or 0.
static void emit_comparison(struct ct_emitter *e, const struct ct_instruction *i,
                            unsigned predicate)
{
    const int a = ct_emitter_load(e, i->arg[0]);
    const struct ct_rm b = operand(e, i->arg[1]);
    const int d = result(e, i);
    ct_put_compare(&e->code, d, a, b, predicate);
    ct_put_bitwise(&e->code, AND, d, d, ct_in_pool(CT_ONE));
}

// (0 < a) - (a < 0), each comparison as 0 or 1.
static void emit_signum(struct ct_emitter *e, const struct ct_instruction *i)
{
    const int a = ct_emitter_load(e, i->arg[0]), plus = take_register(e, none),
              minus = take_register(e, none);
    ct_put_bitwise(&e->code, XOR, minus, minus, ct_in_register(minus));
    ct_put_compare(&e->code, plus, minus, ct_in_register(a), LT_OQ);
    ct_put_compare(&e->code, minus, a, ct_in_register(minus), LT_OQ);
    ct_put_bitwise(&e->code, AND, plus, plus, ct_in_pool(CT_ONE));
    ct_put_bitwise(&e->code, AND, minus, minus, ct_in_pool(CT_ONE));
    ct_put_arithmetic(&e->code, 0x5C, result(e, i), plus, ct_in_register(minus));
}

static void emit_if(struct ct_emitter *e, const struct ct_instruction *i)
{
    const int yes = ct_emitter_load(e, i->arg[1]), no = ct_emitter_load(e, i->arg[2]),
              mask = take_register(e, none);
    const struct ct_rm condition = operand(e, i->arg[0]);
    ct_put_bitwise(&e->code, XOR, mask, mask, ct_in_register(mask));
    ct_put_compare(&e->code, mask, mask, condition, NEQ_UQ);
    ct_put_blend(&e->code, result(e, i), no, yes, mask);
}

// Fused multiply-add has three forms, by the operand that the result overwrites. `op` is that of
// form 132.
//
//     132: d = d * rm + v      213: d = v * d + rm      231: d = v * rm + d
static void emit_fused(struct ct_emitter *e, const struct ct_instruction *i, unsigned op)
{
    const bool swap = prefer_second(e, i->arg[0], i->arg[1]);
    const int a = ct_emitter_load(e, i->arg[swap]), b = ct_emitter_load(e, i->arg[!swap]);
    const struct ct_rm c = operand(e, i->arg[2]);
    const struct ct_vex form = {1, 2, 1, (unsigned char)(op + (e->code.lanes == 1))};
    const struct ct_vex f132 = form, f213 = {1, 2, 1, form.op + 0x10},
                        f231 = {1, 2, 1, form.op + 0x20};
    const bool wide = e->code.lanes > 1;
    const int d = result(e, i);
    if (d == a)
        ct_put_vex(&e->code, f213, wide, d, b, c);
    else if (d == b)
        ct_put_vex(&e->code, f213, wide, d, a, c);
    else if (c.reg == d)
        ct_put_vex(&e->code, f231, wide, d, a, ct_in_register(b));
    else if (c.reg >= 0) {
        ct_put_vex(&e->code, (struct ct_vex){1, 1, 0, 0x28}, wide, d, 0,
                   ct_in_register(a)); // vmovapd
        ct_put_vex(&e->code, f132, wide, d, c.reg, ct_in_register(b));
    } else {
        ct_put_load(&e->code, d, c);
        ct_put_vex(&e->code, f231, wide, d, a, ct_in_register(b));
    }
}

// Emit a call; all registers are caller-saved.
static void emit_call(struct ct_emitter *e, const struct ct_instruction *i)
{
    struct ct_bytes *c = &e->code;
    for (int r = 0; r < CT_NREGISTER; r++) {
        const uint32_t v = e->content[r];
        bool is_argument = false;
        for (uint32_t k = 0; v != none && k < i->narg; k++)
            is_argument |= i->arg[k] == v;
        if (v != none && (is_argument || next_use(e, v) != none))
            need_home(e, v);
        if (v != none)
            leave_register(e, v);
    }
    for (uint32_t r = 0; r < i->nres; r++)
        need_home(e, i->res[r]);
    ct_put_vzeroupper(c);
    ct_put_address(c, CT_RDI, ct_emitter_memory(e, e->home[i->res[0]]));
    ct_put_address(c, CT_RSI, ct_emitter_memory(e, e->home[i->arg[0]]));
    if (i->nres == 2) {
        ct_put_address(c, CT_RDX, ct_emitter_memory(e, e->home[i->res[1]]));
    } else if (i->op == CT_OP_TABLE) {
        ct_put_immediate(c, CT_RDX, (uintptr_t)&e->l->table[i->table]);
        ct_put_immediate(c, CT_RCX, i->order);
    } else if (i->narg > 1) {
        ct_put_address(c, CT_RDX, ct_emitter_memory(e, e->home[i->arg[1]]));
    }
    ct_put_call(c, e->calls->by_op[i->op]);
}

static void emit_operation(struct ct_emitter *e, const struct ct_instruction *i)
{
    switch (i->op) {
    case CT_OP_ADD:
        emit_binary(e, i, 0x58, true);
        break;
    case CT_OP_MUL:
        emit_binary(e, i, 0x59, true);
        break;
    case CT_OP_SUB:
        emit_binary(e, i, 0x5C, false);
        break;
    case CT_OP_DIV:
        emit_binary(e, i, 0x5E, false);
        break;
    // the second operand if neither is smaller, as a < b ? a : b
    case CT_OP_MIN:
        emit_binary(e, i, 0x5D, false);
        break;
    case CT_OP_MAX:
        emit_binary(e, i, 0x5F, false);
        break;
    case CT_OP_SQRT:
        emit_sqrt(e, i);
        break;
    case CT_OP_NEG:
        emit_sign_bit(e, i, XOR, CT_SIGN_BIT);
        break;
    case CT_OP_ABS:
        emit_sign_bit(e, i, AND, CT_ALL_BUT_SIGN);
        break;
    case CT_OP_SIGN:
        emit_signum(e, i);
        break;
    case CT_OP_LT:
        emit_comparison(e, i, LT_OQ);
        break;
    case CT_OP_LE:
        emit_comparison(e, i, LE_OQ);
        break;
    case CT_OP_GT:
        emit_comparison(e, i, GT_OQ);
        break;
    case CT_OP_GE:
        emit_comparison(e, i, GE_OQ);
        break;
    case CT_OP_EQ:
        emit_comparison(e, i, EQ_OQ);
        break;
    case CT_OP_IF:
        emit_if(e, i);
        break;
    case CT_OP_FMA:
        emit_fused(e, i, 0x98);
        break;
    case CT_OP_FMS:
        emit_fused(e, i, 0x9A);
        break;
    case CT_OP_FNMA:
        emit_fused(e, i, 0x9C);
        break;
    default:
        emit_call(e, i);
    }
}

// Free the slots in the work array of values that are dead.
void ct_emitter_free_slots(struct ct_emitter *e, const uint32_t *v, uint32_t n)
{
    for (uint32_t k = 0; k < n; k++)
        if (next_use(e, v[k]) == none && is_spilled(e, v[k])) {
            e->free[e->nfree++] = e->home[v[k]].slot;
            e->home[v[k]].area = CT_AREA_NONE;
        }
}

// A result that is an output is stored at once; its first output becomes its home.
static void claim_output(struct ct_emitter *e, uint32_t v)
{
    if (e->first_output[v])
        e->home[v] = (struct ct_home){CT_AREA_OUT, e->first_output[v] - 1};
}

static void store_outputs(struct ct_emitter *e, uint32_t v)
{
    uint32_t k = e->first_output[v];
    if (k && e->reg[v] < 0) // a called function has written it there
        k = e->next_output[k - 1];
    for (; k; k = e->next_output[k - 1])
        ct_put_store(&e->code, ct_emitter_memory(e, (struct ct_home){CT_AREA_OUT, k - 1}),
                     ct_emitter_load(e, v));
}

static void keep_result(struct ct_emitter *e, uint32_t v)
{
    if (e->is_kept && e->is_kept[v])
        ct_put_store(&e->code, ct_emitter_memory(e, e->home[v]), ct_emitter_load(e, v));
}

void ct_emitter_instruction(struct ct_emitter *e, uint32_t at)
{
    const struct ct_instruction *i = &e->l->ins[e->order[at]];
    for (uint32_t k = 0; k < i->narg; k++) {
        ct_emitter_advance_uses(e, i->arg[k], at + 1);
        if (e->reg[i->arg[k]] >= 0)
            e->pinned |= 1u << e->reg[i->arg[k]];
    }
    for (uint32_t r = 0; r < i->nres; r++)
        claim_output(e, i->res[r]);
    emit_operation(e, i);
    for (uint32_t r = 0; r < i->nres; r++) {
        store_outputs(e, i->res[r]);
        keep_result(e, i->res[r]);
    }
    ct_emitter_unpin(e, i);
    ct_emitter_free_slots(e, i->arg, i->narg);
    ct_emitter_free_slots(e, i->res, i->nres);
}

void ct_emitter_spill_all(struct ct_emitter *e)
{
    for (int r = 0; r < CT_NREGISTER; r++) {
        const uint32_t v = e->content[r];
        if (v != none && next_use(e, v) != none)
            need_home(e, v);
        if (v != none)
            leave_register(e, v);
    }
}

void ct_emitter_list_uses(struct ct_emitter *e)
{
    const struct ct_listing *l = e->l;
    uint32_t nuse = 0;
    e->start = CT_NEWN(e->arena, uint32_t, l->nvalue + 1);
    e->next = CT_NEWN(e->arena, uint32_t, l->nvalue);
    for (size_t i = l->nprologue; i < l->nins; i++)
        for (uint32_t k = 0; k < l->ins[i].narg; k++)
            e->start[l->ins[i].arg[k]]++;
    for (size_t v = 0; v <= l->nvalue; v++) {
        const uint32_t n = e->start[v];
        e->start[v] = nuse;
        nuse += n;
        if (v < l->nvalue)
            e->next[v] = e->start[v];
    }
    e->use = CT_NEWN(e->arena, uint32_t, nuse);
    for (uint32_t at = 0; at < e->norder; at++)
        for (uint32_t k = 0; k < l->ins[e->order[at]].narg; k++)
            e->use[e->next[l->ins[e->order[at]].arg[k]]++] = at;
    for (size_t v = 0; v < l->nvalue; v++)
        e->next[v] = e->start[v];
}

static void roll_up(struct ct_emitter *e)
{
    bool is_alone[CT_NKIND];
    for (int op = 0; op < CT_NKIND; op++)
        is_alone[op] = e->calls->by_op[op] != 0;
    if (e->norder < CT_REROLL_CACHED)
        return; // the whole body fits in the instruction cache
    e->reroll
        = ct_reroll_find(e->arena, e->l, e->order, (uint32_t)e->norder, is_alone, e->nfixed,
                         e->calls->rows_together && e->code.lanes == 1 ? CT_ROWS_TOGETHER : 1,
                         (uint32_t)e->code.lanes);
    e->spread = CT_NEWN(e->arena, uint32_t, e->l->nvalue);
    for (size_t v = 0; v < e->l->nvalue; v++)
        e->spread[v] = none;
    e->nfixed = e->nwork = e->reroll.nwork;
}

// ---- entry point -------------------------------------------------------------------------------

static void place_values(struct ct_emitter *e, const uint32_t *home)
{
    const struct ct_listing *l = e->l;
    e->home = CT_NEWN(e->arena, struct ct_home, l->nvalue);
    e->reg = CT_NEWN(e->arena, signed char, l->nvalue);
    e->free = CT_NEWN(e->arena, uint32_t, l->nvalue + 3 * (size_t)e->nangle + 1);
    for (size_t v = 0; v < l->nvalue; v++) {
        e->reg[v] = -1;
        if (l->rate[v] != CT_RATE_CALL)
            e->home[v] = (struct ct_home){CT_AREA_WORK, home[v]};
        else if (l->is_leaf[v])
            e->home[v] = (struct ct_home){CT_AREA_INPUT, l->input[v]};
        else if (e->reroll.nloop && e->reroll.slot[v] < CT_REROLL_OUT)
            e->home[v] = (struct ct_home){CT_AREA_WORK, e->reroll.slot[v]};
    }
    for (int r = 0; r < CT_NREGISTER; r++)
        e->content[r] = none;
    e->first_output = CT_NEWN(e->arena, uint32_t, l->nvalue);
    e->next_output = CT_NEWN(e->arena, uint32_t, l->nout);
    for (size_t k = l->nout; k-- > 0;) {
        const uint32_t v = l->out[k];
        e->next_output[k] = e->first_output[v];
        e->first_output[v] = (uint32_t)k + 1;
        if (e->reroll.nloop && e->reroll.slot[v] == CT_REROLL_OUT)
            e->home[v] = (struct ct_home){CT_AREA_OUT, (uint32_t)k};
    }
}

// Registers saved for loops; R12 twice, to keep the stack aligned, see emit_entry.
static const int loop_register[] = {CT_R12, CT_R12, CT_R13, CT_R15};

// Function prologue. The areas are addressed by the argument registers or, if there are calls, by
// callee-saved registers. Three pushes and the return address keep the stack aligned to 16 bytes;
// further pushes come in pairs.
static void emit_entry(struct ct_emitter *e, bool calls)
{
    if (calls) {
        ct_put_push(&e->code, CT_RBX);
        ct_put_push(&e->code, CT_RBP);
        ct_put_push(&e->code, CT_R14);
        ct_put_move(&e->code, CT_RBP, CT_RDI);
        ct_put_move(&e->code, CT_R14, CT_RSI);
        ct_put_move(&e->code, CT_RBX, CT_RDX);
    }
    for (size_t i = 0; i < COUNT(loop_register) && e->reroll.nloop; i++)
        ct_put_push(&e->code, loop_register[i]);
    e->base[CT_AREA_INPUT] = calls ? CT_RBP : CT_RDI;
    e->base[CT_AREA_OUT] = calls ? CT_R14 : CT_RSI;
    e->base[CT_AREA_WORK] = calls ? CT_RBX : CT_RDX;
}

// Store the outputs that are not stored when they are computed: those of the prologue and of loops.
static void copy_outputs(struct ct_emitter *e)
{
    for (uint32_t k = 0; k < e->l->nout; k++) {
        const uint32_t v = e->l->out[k];
        const bool is_rolled = e->reroll.nloop && e->reroll.slot[v] != none;
        if (e->l->rate[v] == CT_RATE_CALL && !e->l->is_leaf[v]
            && (!is_rolled || (e->home[v].area == CT_AREA_OUT && e->home[v].slot == k)))
            continue;
        ct_put_load(&e->code, 0, ct_emitter_memory(e, e->home[v]));
        ct_put_store(&e->code, ct_emitter_memory(e, (struct ct_home){CT_AREA_OUT, k}), 0);
    }
}

static void emit_return(struct ct_emitter *e, bool calls)
{
    ct_put_vzeroupper(&e->code);
    for (size_t i = COUNT(loop_register); i-- > 0 && e->reroll.nloop;)
        ct_put_pop(&e->code, loop_register[i]);
    if (calls) {
        ct_put_pop(&e->code, CT_R14);
        ct_put_pop(&e->code, CT_RBP);
        ct_put_pop(&e->code, CT_RBX);
    }
    ct_put(&e->code, 0xC3);
}

struct ct_x86_code ct_x86_emit(struct ct_arena *a, const struct ct_listing *l, int lanes,
                               const uint32_t *home, size_t nhome,
                               const struct ct_x86_calls *calls)
{
    struct ct_emitter e = {.arena = a,
                           .l = l,
                           .calls = calls,
                           .code = {.arena = a, .lanes = lanes},
                           .nfixed = (uint32_t)nhome,
                           .nwork = (uint32_t)nhome,
                           .place_size = 8 * (uint32_t)lanes,
                           .width = 1};
    const bool any_call = ct_emitter_order(&e);
    // Limit: initial size of the buffer, which grows
    const size_t usual = 10; // bytes of an instruction with its share of loads and stores
    e.code.cap = usual * e.norder + 512;
    e.code.byte = CT_NEWN(a, unsigned char, e.code.cap);
    roll_up(&e);
    ct_emitter_list_uses(&e);
    place_values(&e, home);
    emit_entry(&e, any_call);
    const struct ct_loop *loop = e.reroll.loop, *end = loop + e.reroll.nloop;
    for (uint32_t at = 0; at < e.norder; at++) {
        if (loop < end && at == loop->first) {
            at += loop->period * loop->count - 1;
            loop = ct_emitter_loops(&e, loop, end);
            continue;
        }
        const bool angles = e.nangle && at == e.first_angle;
        if (angles)
            ct_emitter_angles(&e);
        else
            ct_emitter_instruction(&e, at);
        at += angles ? e.nangle - 1 : 0;
    }
    copy_outputs(&e);
    emit_return(&e, any_call);
    ct_put_pool(&e.code);
    return (struct ct_x86_code){e.code.byte, e.code.n, e.nwork, e.reroll.table,
                                e.reroll.ntable};
}
