// See roll.h. Loops are sought as repeats in the sequence of operators, together with how far back near operands are;
// a loop whose operands cannot be reached is left as it was, and all are settled again without it.
#include "codegen/roll.h"

#include <string.h>

static const uint32_t none = CT_VALUE_NONE;

enum {
    WINDOW = 16, // instructions that must repeat to be looked at
    NEAR = 64,   // operands so close belong to what repeats
    MOST_PERIOD = 8192,
    MOST_TRIES = 64,
    LEAST_ROWS = 4,
    LEAST_SAVED = 48, // instructions
    MOST_CUTS = 3,    // see cut
};

// ---- repeats ----------------------------------------------------------------------------------

struct plan {
    struct ct_arena *arena;
    const struct ct_listing *l;
    const uint32_t *order;
    uint32_t n;
    uint32_t *at;     // by value: the place in the order that makes it, or none
    uint64_t *sign;   // by place: what must repeat
    uint32_t *again;  // by place: the next one whose window has the same hash, or none
    bool *is_swapped; // by place, see operand_at
    struct repeat *repeat;
    size_t nrepeat, repeat_cap;
    uint32_t *of_place; // the repeat of a place, or none
};

// A result of a repeat that is put where the row before its first or behind its last one would be.
struct edge {
    int32_t row;
    uint32_t value;
    uint32_t next;  // 1 + index of the next one of the instruction
    uint32_t asker; // the repeat that needs it first
};

// A sequence of operands that is copied to places of its own.
struct column {
    uint32_t operand; // 3 slot + k that it is the sequence of
    bool is_copied;   // in each evaluation
};

// How an operand is reached, before places are known.
struct reach {
    enum { OPEN, ROW, FIXED, INPUTS, RESULTS, COLUMN } kind; // OPEN: not known yet
    uint32_t
        at; // instruction of the body; value; input at row 0; instruction of the other body; column
    uint32_t other;    // RESULTS: repeat
    int32_t row, step; // RESULTS: its row at row 0, rows per row; INPUTS: step is the stride
};

struct stream {
    int kind;
    uint32_t other;
    int32_t step;
};

struct repeat {
    uint32_t first, period, count;
    uint32_t ncut, whole_first, whole_count; // before it was cut
    bool is_dropped;
    struct reach *reach; // (3 x period)
    bool *escapes;       // (period) read beyond its row
    uint32_t *edge_of;   // (period) 1 + the first edge
    struct edge *edge;
    size_t nedge, edge_cap;
    struct column *column;
    size_t ncolumn, column_cap;
    struct stream stream[CT_ROLL_STREAMS];
    int nstream;
    int32_t before, behind; // rows for edges
    bool *is_late; // (period) reads what another row has made, or what such an instruction has
    uint32_t nlate;
    bool is_side_by_side;
    uint32_t origin;                  // place of row 0
    uint32_t *offset;                 // (period) number of the result
    uint32_t row_stride, slot_stride; // places between rows, between results
    uint32_t nresult;
};

static const struct ct_instruction *instruction(const struct plan *p, uint32_t place)
{
    return &p->l->ins[p->order[place]];
}

// Operand k of what is at a place. The first two of sums and products are taken in an order of their own: the store sorts
// them by age, so that a constant that something else has made before comes first in one row and second in another.
static uint32_t operand_at(const struct plan *p, uint32_t place, uint32_t k)
{
    return instruction(p, place)->arg[k < 2 && p->is_swapped[place] ? 1 - k : k];
}

static bool is_commutative(unsigned op)
{
    return op == CT_OP_ADD || op == CT_OP_MUL || op == CT_OP_FMA || op == CT_OP_FMS
        || op == CT_OP_FNMA;
}

// Constants and parameters, inputs, results.
static uint32_t age(const struct plan *p, uint32_t v)
{
    return p->at[v] != none ? p->at[v] + 2 : p->l->rate[v] == CT_RATE_CALL;
}

static void order_operands(struct plan *p)
{
    for (uint32_t i = 0; i < p->n; i++) {
        const struct ct_instruction *ins = instruction(p, i);
        p->is_swapped[i] = is_commutative(ins->op) && age(p, ins->arg[0]) < age(p, ins->arg[1]);
    }
}

static uint64_t mix(uint64_t h, uint64_t v)
{
    h = (h ^ v) * UINT64_C(0x9E3779B97F4A7C15);
    return h ^ h >> 29;
}

static void sign_places(struct plan *p, const bool is_alone[CT_NKIND])
{
    for (uint32_t i = 0; i < p->n; i++) {
        const struct ct_instruction *ins = instruction(p, i);
        uint64_t h = mix(ins->op, ins->nres);
        if (is_alone[ins->op] || ins->nres != 1)
            h = mix(h, (uint64_t)i + CT_NKIND);
        for (uint32_t k = 0; k < ins->narg; k++) {
            const uint32_t from = p->at[operand_at(p, i, k)];
            h = mix(h, from != none && i - from < NEAR ? i - from : 0);
        }
        p->sign[i] = h;
    }
}

static void link_windows(struct plan *p)
{
    size_t size = 64;
    while (size < 2 * (size_t)p->n)
        size *= 2;
    uint32_t *last = CT_NEWN(p->arena, uint32_t, size); // 1 + place, by hash
    // h = sum of sign[i + k] base^k over the window, moved on by one place
    const uint64_t base = UINT64_C(0x9E3779B97F4A7C15);
    uint64_t h = 0, leaving = 1;
    for (int k = 0; k < WINDOW; k++)
        leaving *= base;
    for (uint32_t i = p->n; i-- > 0;) {
        h = p->sign[i] + base * h - (i + WINDOW < p->n ? leaving * p->sign[i + WINDOW] : 0);
        p->again[i] = none;
        if (i + WINDOW > p->n)
            continue;
        uint32_t *slot = &last[mix(0, h) & (size - 1)];
        p->again[i] = *slot ? *slot - 1 : none;
        *slot = i + 1;
    }
}

// The repeat that starts at i and saves most.
static struct repeat best_repeat(const struct plan *p, uint32_t i)
{
    struct repeat best = {.first = i};
    uint32_t saved = LEAST_SAVED - 1, c = p->again[i];
    for (int tries = 0; tries < MOST_TRIES && c > i && c != none && c - i <= MOST_PERIOD;
         tries++) {
        const uint32_t period = c - i;
        uint32_t same = 0;
        if (best.count && period % best.period == 0) { // saves less than that did
            c = p->again[c];
            continue;
        }
        while (c + same < p->n && p->sign[i + same] == p->sign[c + same])
            same++;
        const uint32_t count = same / period + 1;
        if (count >= LEAST_ROWS && (count - 1) * period > saved) {
            saved = (count - 1) * period;
            best.period = period;
            best.count = count;
        }
        c = p->again[c];
    }
    return best;
}

static void find_repeats(struct plan *p)
{
    for (uint32_t i = 0; i < p->n; i++)
        p->of_place[i] = none;
    for (uint32_t i = 0; i < p->n;) {
        struct repeat r = best_repeat(p, i);
        if (!r.count) {
            i++;
            continue;
        }
        for (uint32_t k = 0; k < r.period * r.count; k++)
            p->of_place[i + k] = (uint32_t)p->nrepeat;
        i += r.period * r.count;
        CT_PUSH(p->arena, p->repeat, p->nrepeat, p->repeat_cap, r);
    }
}

// ---- how operands are reached -----------------------------------------------------------------

static uint32_t argument(const struct plan *p, const struct repeat *r, uint32_t row,
                         uint32_t operand)
{
    return operand_at(p, r->first + row * r->period + operand / 3, operand % 3);
}

// The repeat that makes v, with its row and instruction; NULL if none does.
static struct repeat *maker(const struct plan *p, uint32_t v, int32_t *row, uint32_t *slot)
{
    const uint32_t at = p->at[v];
    if (at == none || p->of_place[at] == none)
        return NULL;
    struct repeat *r = &p->repeat[p->of_place[at]];
    *row = (int32_t)((at - r->first) / r->period);
    *slot = (at - r->first) % r->period;
    return r;
}

static bool is_made_before(const struct plan *p, const struct repeat *r, uint32_t v)
{
    return p->at[v] == none || p->at[v] < r->first;
}

static bool use_stream(struct repeat *r, int kind, uint32_t other, int32_t step)
{
    for (int i = 0; i < r->nstream; i++)
        if (r->stream[i].kind == kind && r->stream[i].other == other
            && r->stream[i].step == step)
            return true;
    if (r->nstream == CT_ROLL_STREAMS)
        return false;
    r->stream[r->nstream++] = (struct stream){kind, other, step};
    return true;
}

// Those of the row itself, or the same in all: the most. Row by row, as they lie in memory.
static void reach_alike(const struct plan *p, const struct repeat *r)
{
    for (uint32_t i = 0; i < 3 * r->period; i++)
        r->reach[i] = (struct reach){.kind = OPEN};
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t k = 0; k < instruction(p, r->first + slot)->narg; k++) {
            const uint32_t v = argument(p, r, 0, 3 * slot + k), at = p->at[v];
            if (at != none && at >= r->first && at < r->first + r->period)
                r->reach[3 * slot + k] = (struct reach){.kind = ROW, .at = at - r->first};
            else if (is_made_before(p, r, v))
                r->reach[3 * slot + k] = (struct reach){.kind = FIXED, .at = v};
        }
    for (uint32_t row = 1; row < r->count; row++)
        for (uint32_t slot = 0; slot < r->period; slot++)
            for (uint32_t k = 0; k < instruction(p, r->first + slot)->narg; k++) {
                struct reach *out = &r->reach[3 * slot + k];
                if (out->kind == OPEN)
                    continue;
                const uint32_t v = argument(p, r, row, 3 * slot + k);
                if (out->kind == ROW ? p->at[v] != r->first + row * r->period + out->at
                                     : v != out->at)
                    out->kind = OPEN;
            }
}

static uint32_t input_of(const struct plan *p, uint32_t v)
{
    return p->l->rate[v] == CT_RATE_CALL && p->l->is_leaf[v] ? p->l->input[v] : none;
}

static bool reach_inputs(const struct plan *p, struct repeat *r, uint32_t operand,
                         struct reach *out)
{
    const uint32_t first = input_of(p, argument(p, r, 0, operand)),
                   second = input_of(p, argument(p, r, 1, operand));
    if (first == none || second == none)
        return false;
    const int32_t stride = (int32_t)(second - first);
    for (uint32_t row = 0; row < r->count; row++)
        if (input_of(p, argument(p, r, row, operand))
            != (uint32_t)((int32_t)first + (int32_t)row * stride))
            return false;
    *out = (struct reach){.kind = INPUTS, .at = first, .step = stride};
    return use_stream(r, INPUTS, 0, stride);
}

// v at a row of `other` that it does not have: true if that place is free or holds v. *is_new: it must be put there.
static bool is_edge_free(const struct repeat *other, uint32_t slot, int32_t row, uint32_t v,
                         bool *is_new)
{
    *is_new = true;
    for (uint32_t i = other->edge_of[slot]; i; i = other->edge[i - 1].next)
        if (other->edge[i - 1].row == row) {
            *is_new = false;
            return other->edge[i - 1].value == v;
        }
    return true;
}

static void add_edge(const struct plan *p, const struct repeat *r, struct repeat *other,
                     uint32_t slot, int32_t row, uint32_t v)
{
    const struct edge e = {row, v, other->edge_of[slot], (uint32_t)(r - p->repeat)};
    CT_PUSH(p->arena, other->edge, other->nedge, other->edge_cap, e);
    other->edge_of[slot] = (uint32_t)other->nedge;
    if (-row > other->before)
        other->before = -row;
    if (row - (int32_t)other->count + 1 > other->behind)
        other->behind = row - (int32_t)other->count + 1;
}

// Results of one instruction of a repeat, a row further every time; at the ends perhaps of what takes its place there.
static bool reach_results(const struct plan *p, struct repeat *r, uint32_t operand,
                          struct reach *out)
{
    enum { MOST_EDGES = 4 };
    const uint32_t middle = r->count / 2;
    int32_t row[2];
    uint32_t slot[2], nedge = 0;
    struct repeat *other = maker(p, argument(p, r, middle, operand), &row[0], &slot[0]);
    if (!other || maker(p, argument(p, r, middle + 1, operand), &row[1], &slot[1]) != other
        || slot[0] != slot[1])
        return false;
    const int32_t step = row[1] - row[0], first = row[0] - (int32_t)middle * step;
    bool is_new;
    for (uint32_t i = 0; i < r->count; i++) {
        const uint32_t v = argument(p, r, i, operand);
        const int32_t at = first + (int32_t)i * step;
        int32_t its;
        uint32_t which;
        if (maker(p, v, &its, &which) == other && its == at && which == slot[0])
            continue;
        if ((at >= 0 && at < (int32_t)other->count) || !is_made_before(p, r, v)
            || ++nedge > MOST_EDGES || !is_edge_free(other, slot[0], at, v, &is_new))
            return false;
    }
    if (!use_stream(r, RESULTS, (uint32_t)(other - p->repeat), step))
        return false;
    for (uint32_t i = 0; i < r->count && nedge; i++) {
        const int32_t at = first + (int32_t)i * step;
        const uint32_t v = argument(p, r, i, operand);
        if ((at < 0 || at >= (int32_t)other->count)
            && is_edge_free(other, slot[0], at, v, &is_new) && is_new)
            add_edge(p, r, other, slot[0], at, v);
    }
    *out = (struct reach){.kind = RESULTS,
                          .at = slot[0],
                          .other = (uint32_t)(other - p->repeat),
                          .row = first,
                          .step = step};
    return true;
}

static bool is_same_sequence(const struct plan *p, const struct repeat *r, uint32_t a,
                             uint32_t b)
{
    for (uint32_t row = 0; row < r->count; row++)
        if (argument(p, r, row, a) != argument(p, r, row, b))
            return false;
    return true;
}

// Copied, if everything is there before the loop.
static bool reach_column(const struct plan *p, struct repeat *r, uint32_t operand,
                         struct reach *out)
{
    for (uint32_t row = 0; row < r->count; row++)
        if (!is_made_before(p, r, argument(p, r, row, operand)))
            return false;
    *out = (struct reach){.kind = COLUMN, .at = (uint32_t)r->ncolumn};
    for (size_t i = 0; i < r->ncolumn; i++)
        if (is_same_sequence(p, r, r->column[i].operand, operand)) {
            out->at = (uint32_t)i;
            return true;
        }
    CT_PUSH(p->arena, r->column, r->ncolumn, r->column_cap, (struct column){operand});
    return true;
}

// ---- which loops there are --------------------------------------------------------------------

// Columns that hold something else than constants and parameters. Row by row, as operands lie in memory.
static size_t count_copied(const struct plan *p, const struct repeat *r)
{
    size_t n = 0;
    for (size_t i = 0; i < r->ncolumn; i++)
        r->column[i].is_copied = false;
    for (uint32_t row = 0; row < r->count; row++)
        for (size_t i = 0; i < r->ncolumn; i++) {
            struct column *c = &r->column[i];
            const uint32_t v = argument(p, r, row, c->operand);
            if (!c->is_copied && p->l->rate[v] == CT_RATE_CALL) {
                c->is_copied = true;
                n++;
            }
        }
    return n;
}

static bool reach_operands(const struct plan *p, struct repeat *r)
{
    reach_alike(p, r);
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t k = 0; k < instruction(p, r->first + slot)->narg; k++) {
            const uint32_t operand = 3 * slot + k;
            struct reach *out = &r->reach[operand];
            if (out->kind == OPEN && !reach_inputs(p, r, operand, out)
                && !reach_results(p, r, operand, out) && !reach_column(p, r, operand, out))
                return false;
        }
    // a copy of an operand costs as much as two instructions
    const size_t ncopied = count_copied(p, r);
    return 8 * ncopied <= r->period && use_stream(r, RESULTS, (uint32_t)(r - p->repeat), 1);
}

static void clear(const struct plan *p, struct repeat *r)
{
    struct ct_arena *a = p->arena;
    if (!r->reach) {
        r->reach = CT_NEWN(a, struct reach, 3 * (size_t)r->period);
        r->escapes = CT_NEWN(a, bool, r->period);
        r->edge_of = CT_NEWN(a, uint32_t, r->period);
        r->offset = CT_NEWN(a, uint32_t, r->period);
        r->is_late = CT_NEWN(a, bool, r->period);
    }
    memset(r->edge_of, 0, r->period * sizeof *r->edge_of);
    r->nedge = r->ncolumn = 0;
    r->nstream = 0;
    r->before = r->behind = 0;
}

static void set_places(const struct plan *p, const struct repeat *r, uint32_t to)
{
    for (uint32_t k = 0; k < r->period * r->count; k++)
        p->of_place[r->first + k] = to;
}

// Some operand cannot be reached. The rows at the ends may do it on something else, as the first beam of a chain does that
// nothing hangs on: without the first row, without the last one, without both; then none.
static void cut(struct plan *p, struct repeat *r)
{
    static const struct {
        unsigned first, less; // rows
    } without[MOST_CUTS] = {{1, 1}, {0, 1}, {1, 2}};
    set_places(p, r, none);
    if (r->ncut == 0) {
        r->whole_first = r->first;
        r->whole_count = r->count;
    }
    r->is_dropped = r->ncut == MOST_CUTS || r->whole_count < without[r->ncut].less + LEAST_ROWS;
    if (r->is_dropped)
        return;
    r->first = r->whole_first + without[r->ncut].first * r->period;
    r->count = r->whole_count - without[r->ncut].less;
    r->ncut++;
    set_places(p, r, (uint32_t)(r - p->repeat));
}

// False if a repeat had to be cut: others may rely on it.
static bool settle(struct plan *p)
{
    for (size_t i = 0; i < p->nrepeat; i++)
        if (!p->repeat[i].is_dropped)
            clear(p, &p->repeat[i]);
    for (size_t i = 0; i < p->nrepeat; i++) {
        struct repeat *r = &p->repeat[i];
        if (r->is_dropped || reach_operands(p, r))
            continue;
        cut(p, r);
        return false;
    }
    return true;
}

// ---- places -----------------------------------------------------------------------------------

static void mark_escapes(const struct plan *p)
{
    int32_t row;
    uint32_t slot;
    for (uint32_t i = 0; i < p->n; i++) {
        const struct ct_instruction *ins = instruction(p, i);
        for (uint32_t k = 0; k < ins->narg; k++) {
            struct repeat *r = maker(p, ins->arg[k], &row, &slot);
            if (r && (i - r->first) / r->period != (uint32_t)row)
                r->escapes[slot] = true;
        }
    }
    for (size_t k = 0; k < p->l->nout; k++) {
        struct repeat *r = maker(p, p->l->out[k], &row, &slot);
        if (r)
            r->escapes[slot] = true;
    }
}

// ---- rows side by side --------------------------------------------------------------------------

static void mark_late(const struct plan *p, struct repeat *r)
{
    for (uint32_t slot = 0; slot < r->period; slot++) {
        for (uint32_t k = 0; k < instruction(p, r->first + slot)->narg; k++) {
            const struct reach *from = &r->reach[3 * slot + k];
            r->is_late[slot] |= (from->kind == ROW && r->is_late[from->at])
                             || (from->kind == RESULTS && &p->repeat[from->other] == r);
        }
        r->nlate += r->is_late[slot];
    }
}

// Reads whose rows are not side by side.
static uint32_t count_gathered(const struct plan *p, const struct repeat *r)
{
    uint32_t n = 0;
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t k = 0; k < instruction(p, r->first + slot)->narg && !r->is_late[slot];
             k++) {
            const struct reach *from = &r->reach[3 * slot + k];
            n += (from->kind == INPUTS && from->step != 1)
              || (from->kind == RESULTS
                  && (!p->repeat[from->other].is_side_by_side || from->step != 1));
        }
    return n;
}

// What the late instructions of a row read of the others.
static void hand_over(const struct plan *p, struct repeat *r)
{
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t k = 0; k < instruction(p, r->first + slot)->narg && r->is_late[slot];
             k++) {
            const struct reach *from = &r->reach[3 * slot + k];
            if (from->kind == ROW && !r->is_late[from->at])
                r->escapes[from->at] = true;
        }
}

// Bytes that rows leave behind.
static size_t size_of_results(const struct plan *p)
{
    size_t n = 0;
    for (size_t i = 0; i < p->nrepeat; i++) {
        const struct repeat *r = &p->repeat[i];
        size_t width = r->ncolumn;
        for (uint32_t slot = 0; slot < r->period && !r->is_dropped; slot++)
            width += r->escapes[slot];
        n += r->is_dropped ? 0 : r->count * width * sizeof(double);
    }
    return n;
}

// Does it pay? Only as long as the nearest cache holds what rows leave behind: on beams whose rows leave more, one row at a time was
// measured as fast. A read that gathers four numbers costs about five instructions, a result that the others read two.
static void choose_lanes(struct plan *p, uint32_t lanes)
{
    enum { GATHER = 5, HAND_OVER = 2, NEAREST_CACHE = 32 * 1024 };
    if (lanes == 1 || size_of_results(p) > NEAREST_CACHE)
        return;
    for (size_t i = 0; i < p->nrepeat; i++) {
        struct repeat *r = &p->repeat[i];
        if (r->is_dropped || r->count < lanes)
            continue;
        mark_late(p, r);
        const uint32_t n = r->period - r->nlate;
        const uint32_t more = GATHER * count_gathered(p, r) + HAND_OVER * r->nlate;
        r->is_side_by_side = (lanes - 1) * n > more && n >= WINDOW;
        if (r->is_side_by_side)
            hand_over(p, r);
    }
}

static uint32_t place_of(const struct repeat *r, uint32_t number, int32_t row)
{
    return (uint32_t)((int32_t)r->origin + row * (int32_t)r->row_stride
                      + (int32_t)(number * r->slot_stride));
}

static uint32_t rounded_up(uint32_t n, uint32_t to)
{
    return (n + to - 1) / to * to;
}

static void place_rows(const struct plan *p, uint32_t *nwork, uint32_t lanes)
{
    for (size_t i = 0; i < p->nrepeat; i++) {
        struct repeat *r = &p->repeat[i];
        if (r->is_dropped)
            continue;
        for (uint32_t slot = 0; slot < r->period; slot++)
            if (r->escapes[slot])
                r->offset[slot] = r->nresult++;
        const uint32_t width = r->nresult + (uint32_t)r->ncolumn,
                       before = rounded_up((uint32_t)r->before, lanes);
        uint32_t rows = before + rounded_up(r->count + (uint32_t)r->behind, lanes);
        if (r->is_side_by_side && rows / lanes % 2 == 0)
            rows += lanes; // an odd stride reaches all sets of a cache
        r->row_stride = r->is_side_by_side ? 1 : width;
        r->slot_stride = r->is_side_by_side ? rows : 1;
        *nwork = rounded_up(*nwork, lanes);
        r->origin = *nwork + before * r->row_stride;
        *nwork += rows * width;
    }
}

// ---- the result -------------------------------------------------------------------------------

static struct ct_operand operand_of(const struct plan *p, const struct repeat *r,
                                    const struct reach *from)
{
    const struct repeat *other = from->kind == RESULTS ? &p->repeat[from->other] : r;
    switch (from->kind) {
    case ROW:
        return (struct ct_operand){.reach = CT_REACH_ROW, .at = from->at};
    case FIXED:
        return (struct ct_operand){.reach = CT_REACH_FIXED, .at = from->at};
    case INPUTS:
        return (struct ct_operand){CT_REACH_INPUT, from->at, from->step};
    case RESULTS:
        return (struct ct_operand){CT_REACH_WORK,
                                   place_of(other, other->offset[from->at], from->row),
                                   from->step * (int32_t)other->row_stride};
    default:
        return (struct ct_operand){CT_REACH_WORK, place_of(r, r->nresult + from->at, 0),
                                   (int32_t)r->row_stride};
    }
}

static void add_columns(const struct plan *p, const struct repeat *r, struct ct_loop *loop,
                        struct ct_roll *out)
{
    for (uint32_t i = 0; i < r->ncolumn; i++)
        for (uint32_t row = 0; row < r->count; row++) {
            const uint32_t operand = r->column[i].operand;
            const struct ct_copy c
                = {argument(p, r, row, operand), place_of(r, r->nresult + i, (int32_t)row)};
            if (!r->column[i].is_copied)
                CT_PUSH(p->arena, out->table, out->ntable, out->table_cap, c);
            else
                CT_PUSH(p->arena, loop->copy, loop->ncopy, loop->copy_cap, c);
        }
}

// Edges of all repeats that this one asks for.
static void add_edges(const struct plan *p, uint32_t asker, struct ct_loop *loop)
{
    for (uint32_t i = 0; i <= asker; i++) {
        const struct repeat *r = &p->repeat[i];
        for (uint32_t slot = 0; slot < r->period && !r->is_dropped && r->nedge; slot++)
            for (uint32_t k = r->edge_of[slot]; k; k = r->edge[k - 1].next) {
                const struct edge *e = &r->edge[k - 1];
                const struct ct_copy c = {e->value, place_of(r, r->offset[slot], e->row)};
                if (e->asker == asker)
                    CT_PUSH(p->arena, loop->copy, loop->ncopy, loop->copy_cap, c);
            }
    }
}

// The instructions of a row that are late, or those that are not.
static void fill_loop(const struct plan *p, const struct repeat *r, bool late,
                      struct ct_loop *loop)
{
    uint32_t *number = CT_NEWN(p->arena, uint32_t, r->period); // of the loop's own
    loop->slot = CT_NEWN(p->arena, uint32_t, r->period);
    loop->operand = CT_NEWN(p->arena, struct ct_operand, 3 * r->period);
    loop->result = CT_NEWN(p->arena, uint32_t, r->period);
    for (uint32_t slot = 0; slot < r->period; slot++) {
        if (r->is_side_by_side && r->is_late[slot] != late)
            continue;
        const uint32_t i = number[slot] = loop->nslot++;
        loop->slot[i] = slot;
        loop->result[i] = r->escapes[slot] ? place_of(r, r->offset[slot], 0) : none;
        for (uint32_t k = 0; k < instruction(p, r->first + slot)->narg; k++) {
            const struct reach *from = &r->reach[3 * slot + k];
            struct ct_operand *o = &loop->operand[3 * i + k];
            *o = operand_of(p, r, from);
            if (from->kind != ROW)
                continue;
            if (r->is_side_by_side && r->is_late[from->at] != late)
                *o = (struct ct_operand){CT_REACH_WORK, place_of(r, r->offset[from->at], 0),
                                         (int32_t)r->row_stride};
            else
                o->at = number[from->at];
        }
    }
}

static void keep_places(const struct plan *p, const struct repeat *r, struct ct_roll *out)
{
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t row = 0; row < r->count && r->escapes[slot]; row++) {
            const uint32_t v = instruction(p, r->first + row * r->period + slot)->res[0];
            out->place[v] = place_of(r, r->offset[slot], (int32_t)row);
        }
}

static void add_loop(const struct plan *p, uint32_t which, struct ct_roll *out)
{
    const struct repeat *r = &p->repeat[which];
    struct ct_loop *loop = &out->loop[out->nloop++];
    *loop = (struct ct_loop){.first = r->first,
                             .period = r->period,
                             .count = r->count,
                             .width = (int32_t)r->row_stride,
                             .is_side_by_side = r->is_side_by_side};
    struct ct_loop late = *loop;
    late.is_side_by_side = false;
    fill_loop(p, r, false, loop);
    keep_places(p, r, out);
    add_edges(p, which, loop);
    add_columns(p, r, loop, out);
    if (!r->is_side_by_side || !r->nlate)
        return;
    fill_loop(p, r, true, &late);
    out->loop[out->nloop++] = late;
}

struct ct_roll ct_roll_find(struct ct_arena *a, const struct ct_listing *l,
                            const uint32_t *order, uint32_t n, const bool is_alone[CT_NKIND],
                            uint32_t nwork, uint32_t lanes)
{
    struct plan p = {.arena = a, .l = l, .order = order, .n = n};
    struct ct_roll out = {.place = CT_NEWN(a, uint32_t, l->nvalue + 1), .nwork = nwork};
    p.at = CT_NEWN(a, uint32_t, l->nvalue + 1);
    p.sign = CT_NEWN(a, uint64_t, n + 1);
    p.again = CT_NEWN(a, uint32_t, n + 1);
    p.of_place = CT_NEWN(a, uint32_t, n + 1);
    p.is_swapped = CT_NEWN(a, bool, n + 1);
    for (size_t v = 0; v < l->nvalue; v++)
        p.at[v] = out.place[v] = none;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < instruction(&p, i)->nres; k++)
            p.at[instruction(&p, i)->res[k]] = i;
    order_operands(&p);
    sign_places(&p, is_alone);
    link_windows(&p);
    find_repeats(&p);
    while (!settle(&p))
        ;
    mark_escapes(&p);
    choose_lanes(&p, lanes);
    place_rows(&p, &out.nwork, lanes);
    out.loop = CT_NEWN(a, struct ct_loop, 2 * p.nrepeat + 1);
    for (uint32_t i = 0; i < p.nrepeat; i++)
        if (!p.repeat[i].is_dropped)
            add_loop(&p, i, &out);
    return out;
}
