// Scheduling of calls: calls and their dependences come first, while few values are live. Sines and
// cosines of all angles that depend on no other function are one call.
#include "codegen/emitter.h"

#include <string.h>

// ---- the order of instructions ----------------------------------------------------------------

static bool is_call(const struct ct_emitter *e, const struct ct_instruction *i)
{
    return e->calls->by_op[i->op] != 0;
}

static bool is_wave(const struct ct_instruction *i)
{
    return i->op >= CT_OP_ANGLE_SIN && i->op <= CT_OP_ANGLE_SINCOS;
}

// Scheduling priority: dependences of angles, their sines and cosines, other calls with their
// dependences, the rest.
enum turn { FOR_ANGLES, ANGLES, FOR_CALLS, REST, NTURN };

// Find the angles: arguments of sines and cosines that depend on no call.
static void find_angles(const struct ct_emitter *e, unsigned char *turn)
{
    const struct ct_listing *l = e->l;
    unsigned char *behind
        = CT_NEWN(e->arena, unsigned char, l->nvalue); // by value: it is or depends on a call
    for (size_t i = l->nprologue; i < l->nins; i++) {
        const struct ct_instruction *ins = &l->ins[i];
        bool after = false;
        for (uint32_t k = 0; k < ins->narg; k++)
            after |= behind[ins->arg[k]];
        turn[i] = !after && is_wave(ins) ? ANGLES : REST;
        for (uint32_t k = 0; k < ins->nres; k++)
            behind[ins->res[k]] = after || is_call(e, ins);
    }
}

// Mark what calls depend on, and with higher priority what angles depend on.
static void mark_needed(const struct ct_emitter *e, unsigned char *turn)
{
    const struct ct_listing *l = e->l;
    unsigned char *latest = CT_NEWN(e->arena, unsigned char, l->nvalue); // by value
    memset(latest, REST, l->nvalue);
    for (size_t i = l->nins; i-- > l->nprologue;) {
        const struct ct_instruction *ins = &l->ins[i];
        for (uint32_t k = 0; k < ins->nres && turn[i] != ANGLES; k++)
            turn[i] = latest[ins->res[k]] < turn[i] ? latest[ins->res[k]] : turn[i];
        if (turn[i] == REST && is_call(e, ins))
            turn[i] = FOR_CALLS;
        const unsigned char before = turn[i] == ANGLES ? FOR_ANGLES : turn[i];
        for (uint32_t k = 0; k < ins->narg; k++)
            if (before < latest[ins->arg[k]])
                latest[ins->arg[k]] = before;
    }
}

// Stable sort by priority, else in the order of the listing.
bool ct_emitter_order(struct ct_emitter *e)
{
    const struct ct_listing *l = e->l;
    unsigned char *turn = CT_NEWN(e->arena, unsigned char, l->nins + 1);
    bool any = false;
    find_angles(e, turn);
    mark_needed(e, turn);
    e->order = CT_NEWN(e->arena, uint32_t, l->nins);
    for (int now = FOR_ANGLES; now < NTURN; now++) {
        if (now == ANGLES)
            e->first_angle = (uint32_t)e->norder;
        for (size_t i = l->nprologue; i < l->nins; i++)
            if (turn[i] == now)
                e->order[e->norder++] = (uint32_t)i;
        if (now == ANGLES)
            e->nangle = (uint32_t)e->norder - e->first_angle;
        any |= now < REST && e->norder > 0;
    }
    return any;
}

// ---- angles -----------------------------------------------------------------------------------

static const struct ct_instruction *wave(const struct ct_emitter *e, uint32_t k)
{
    return &e->l->ins[e->order[e->first_angle + k]];
}

// Sort by address of the angles, so that contiguous inputs are read without a copy.
static void sort_waves(struct ct_emitter *e)
{
    uint32_t *order = e->order + e->first_angle;
    for (uint32_t i = 1; i < e->nangle; i++) // insertion sort: few elements, mostly sorted
        for (uint32_t k = i; k > 0; k--) {
            const struct ct_home *a = &e->home[wave(e, k - 1)->arg[0]],
                                 *b = &e->home[wave(e, k)->arg[0]];
            if (a->area != CT_AREA_INPUT || b->area != CT_AREA_INPUT || a->slot <= b->slot)
                break;
            const uint32_t kept = order[k];
            order[k] = order[k - 1];
            order[k - 1] = kept;
        }
}

static bool are_side_by_side(const struct ct_emitter *e)
{
    for (uint32_t k = 0; k < e->nangle; k++) {
        const struct ct_home *h = &e->home[wave(e, k)->arg[0]];
        if (h->area != CT_AREA_INPUT || h->slot != e->home[wave(e, 0)->arg[0]].slot + k)
            return false;
    }
    return true;
}

// Copy the angles to contiguous slots of the work array.
static struct ct_home gather_angles(struct ct_emitter *e)
{
    const struct ct_home first = {CT_AREA_WORK, e->nwork};
    e->nwork += e->nangle;
    for (uint32_t k = 0; k < e->nangle; k++) {
        const int r = ct_emitter_load(e, wave(e, k)->arg[0]);
        ct_put_store(&e->code,
                     ct_emitter_memory(e, (struct ct_home){CT_AREA_WORK, first.slot + k}), r);
        ct_emitter_advance_uses(e, wave(e, k)->arg[0], e->first_angle + e->nangle);
        ct_emitter_unpin(e, wave(e, k));
    }
    return first;
}

// The homes of sines and cosines are where the call writes them; slots of unused results become
// free.
static void place_waves(struct ct_emitter *e, uint32_t sines, uint32_t cosines)
{
    for (uint32_t k = 0; k < e->nangle; k++) {
        const struct ct_instruction *i = wave(e, k);
        const uint32_t at[2] = {sines + k, cosines + k};
        for (uint32_t r = 0; r < 2; r++) {
            if (i->nres == 2 || (i->op == CT_OP_ANGLE_COS) == (r == 1))
                e->home[i->res[i->nres == 2 ? r : 0]] = (struct ct_home){CT_AREA_WORK, at[r]};
            else
                e->free[e->nfree++] = at[r];
        }
    }
    for (uint32_t k = 0; k < e->nangle; k++) {
        const struct ct_instruction *i = wave(e, k);
        for (uint32_t r = 0; r < i->nres; r++)
            for (uint32_t o = e->first_output[i->res[r]]; o; o = e->next_output[o - 1])
                ct_put_store(&e->code,
                             ct_emitter_memory(e, (struct ct_home){CT_AREA_OUT, o - 1}),
                             ct_emitter_load(e, i->res[r]));
        ct_emitter_unpin(e, i);
        ct_emitter_free_slots(e, i->arg, 1);
        ct_emitter_free_slots(e, i->res, i->nres);
    }
}

// Emit one call for all angles.
void ct_emitter_angles(struct ct_emitter *e)
{
    struct ct_bytes *c = &e->code;
    sort_waves(e);
    const struct ct_home inputs = e->home[wave(e, 0)->arg[0]];
    const bool copied = !are_side_by_side(e);
    const struct ct_home angles = copied ? gather_angles(e) : inputs;
    for (uint32_t k = 0; k < e->nangle; k++)
        ct_emitter_advance_uses(e, wave(e, k)->arg[0], e->first_angle + e->nangle);
    const uint32_t sines = e->nwork, cosines = sines + e->nangle;
    e->nwork += 2 * e->nangle;
    ct_emitter_spill_all(e);
    ct_put_vzeroupper(c);
    ct_put_address(c, CT_RDI, ct_emitter_memory(e, (struct ct_home){CT_AREA_WORK, sines}));
    ct_put_address(c, CT_RSI, ct_emitter_memory(e, angles));
    ct_put_address(c, CT_RDX, ct_emitter_memory(e, (struct ct_home){CT_AREA_WORK, cosines}));
    ct_put_immediate(c, CT_RCX, (uint64_t)e->nangle * (uint64_t)c->lanes);
    ct_put_call(c, e->calls->sincos_many);
    place_waves(e, sines, cosines);
    for (uint32_t k = 0; copied && k < e->nangle; k++)
        e->free[e->nfree++] = angles.slot + k;
}
