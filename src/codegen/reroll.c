// Loop rerolling: addresses of operands. A repetition becomes a loop if every operand belongs to
// the same row, is invariant, or has an address affine in the row. Otherwise irregular rows at the
// ends are dropped, or the code stays straight. See reroll.h.
#include "codegen/reroll_layout.h"

#include <string.h>

static const uint32_t none = CT_VALUE_NONE;

// ---- addresses of operands ---------------------------------------------------------------------

static bool is_made_before(const struct ct_repetitions *p, const struct ct_repetition *r,
                           uint32_t v)
{
    return p->at[v] == none || p->at[v] < r->first;
}

static bool use_stream(struct ct_repetition *r, int kind, uint32_t other, int32_t step)
{
    for (int i = 0; i < r->nstream; i++)
        if (r->stream[i].kind == kind && r->stream[i].other == other
            && r->stream[i].step == step)
            return true;
    if (r->nstream == CT_REROLL_STREAMS)
        return false;
    r->stream[r->nstream++] = (struct ct_repetition_stream){kind, other, step};
    return true;
}

// Resolve operands from the same row and loop invariants.
static void resolve_row_and_fixed(const struct ct_repetitions *p, const struct ct_repetition *r)
{
    for (uint32_t i = 0; i < 3 * r->period; i++)
        r->reach[i] = (struct ct_source){.kind = CT_SOURCE_OPEN};
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t k = 0; k < ct_repetition_instruction(p, r->first + slot)->narg; k++) {
            const uint32_t v = ct_repetition_argument(p, r, 0, 3 * slot + k), at = p->at[v];
            struct ct_source *out = &r->reach[3 * slot + k];
            if (at != none && at >= r->first && at < r->first + r->period)
                *out = (struct ct_source){.kind = CT_SOURCE_ROW, .at = at - r->first};
            else if (is_made_before(p, r, v))
                *out = (struct ct_source){.kind = CT_SOURCE_FIXED, .at = v};
        }
    for (uint32_t row = 1; row < r->count; row++)
        for (uint32_t slot = 0; slot < r->period; slot++)
            for (uint32_t k = 0; k < ct_repetition_instruction(p, r->first + slot)->narg; k++) {
                struct ct_source *out = &r->reach[3 * slot + k];
                if (out->kind == CT_SOURCE_OPEN)
                    continue;
                const uint32_t v = ct_repetition_argument(p, r, row, 3 * slot + k);
                if (out->kind == CT_SOURCE_ROW
                        ? p->at[v] != r->first + row * r->period + out->at
                        : v != out->at)
                    out->kind = CT_SOURCE_OPEN;
            }
}

static uint32_t input_of(const struct ct_repetitions *p, uint32_t v)
{
    return p->l->rate[v] == CT_RATE_CALL && p->l->is_leaf[v] ? p->l->input[v] : none;
}

// Is v the input at index first + rows * stride?
static bool is_input_at(const struct ct_repetitions *p, uint32_t v, uint32_t first,
                        int32_t stride, int32_t rows)
{
    const uint32_t at = input_of(p, v);
    return at != none && (int64_t)at == (int64_t)first + (int64_t)rows * stride;
}

static bool resolve_inputs(const struct ct_repetitions *p, struct ct_repetition *r,
                           uint32_t operand, struct ct_source *out)
{
    const uint32_t first = input_of(p, ct_repetition_argument(p, r, 0, operand)),
                   second = input_of(p, ct_repetition_argument(p, r, 1, operand));
    if (first == none || second == none)
        return false;
    const int32_t stride = (int32_t)(second - first);
    for (uint32_t row = 0; row < r->count; row++)
        if (!is_input_at(p, ct_repetition_argument(p, r, row, operand), first, stride,
                         (int32_t)row))
            return false;
    *out = (struct ct_source){.kind = CT_SOURCE_INPUTS, .at = first, .step = stride};
    return use_stream(r, CT_SOURCE_INPUTS, 0, stride);
}

// May v be stored as the result of `other` in a row beyond its ends (a peeled iteration)? *is_new:
// not stored there yet.
static bool is_edge_free(const struct ct_repetition *other, uint32_t slot, int32_t row,
                         uint32_t v, bool *is_new)
{
    *is_new = true;
    for (uint32_t i = other->edge_of[slot]; i; i = other->edge[i - 1].next)
        if (other->edge[i - 1].row == row) {
            *is_new = false;
            return other->edge[i - 1].value == v;
        }
    return true;
}

// Extend the results to hold an edge at this row.
static void make_room(struct ct_repetition *r, int32_t row)
{
    if (-row > r->before)
        r->before = -row;
    if (row - (int32_t)r->count + 1 > r->behind)
        r->behind = row - (int32_t)r->count + 1;
}

static void add_edge(const struct ct_repetitions *p, const struct ct_repetition *r,
                     struct ct_repetition *other, uint32_t slot, int32_t row, uint32_t v)
{
    const struct ct_repetition_edge e
        = {row, v, other->edge_of[slot], (uint32_t)(r - p->repetition)};
    CT_PUSH(p->arena, other->edge, other->nedge, other->edge_cap, e);
    other->edge_of[slot] = (uint32_t)other->nedge;
    make_room(other, row);
}

// Resolve an operand as results of one instruction of a repetition at constant row distance; values
// before its first and after its last row are stored next to them.
static bool resolve_results(const struct ct_repetitions *p, struct ct_repetition *r,
                            uint32_t operand, struct ct_source *out)
{
    const uint32_t middle = r->count / 2;
    int32_t row[2];
    uint32_t slot[2], nedge = 0;
    struct ct_repetition *other
        = ct_repetition_of(p, ct_repetition_argument(p, r, middle, operand), &row[0], &slot[0]);
    if (!other
        || ct_repetition_of(p, ct_repetition_argument(p, r, middle + 1, operand), &row[1],
                            &slot[1])
               != other
        || slot[0] != slot[1])
        return false;
    const int32_t step = row[1] - row[0], first = row[0] - (int32_t)middle * step;
    bool is_new;
    for (uint32_t i = 0; i < r->count; i++) {
        const uint32_t v = ct_repetition_argument(p, r, i, operand);
        const int32_t at = first + (int32_t)i * step;
        int32_t its;
        uint32_t which;
        if (ct_repetition_of(p, v, &its, &which) == other && its == at && which == slot[0])
            continue;
        if ((at >= 0 && at < (int32_t)other->count) || !is_made_before(p, r, v)
            || !is_edge_free(other, slot[0], at, v, &is_new))
            return false;
        nedge++;
    }
    if (!use_stream(r, CT_SOURCE_RESULTS, (uint32_t)(other - p->repetition), step))
        return false;
    for (uint32_t i = 0; i < r->count && nedge; i++) {
        const int32_t at = first + (int32_t)i * step;
        const uint32_t v = ct_repetition_argument(p, r, i, operand);
        if ((at < 0 || at >= (int32_t)other->count)
            && is_edge_free(other, slot[0], at, v, &is_new) && is_new)
            add_edge(p, r, other, slot[0], at, v);
    }
    *out = (struct ct_source){.kind = CT_SOURCE_RESULTS,
                              .at = slot[0],
                              .other = (uint32_t)(other - p->repetition),
                              .row = first,
                              .step = step};
    return true;
}

static bool is_same_sequence(const struct ct_repetitions *p, const struct ct_repetition *r,
                             uint32_t a, uint32_t b)
{
    for (uint32_t row = 0; row < r->count; row++)
        if (ct_repetition_argument(p, r, row, a) != ct_repetition_argument(p, r, row, b))
            return false;
    return true;
}

// Resolve an operand as a column of values that are copied before the loop; all must be computed
// before it.
static bool resolve_column(const struct ct_repetitions *p, struct ct_repetition *r,
                           uint32_t operand, struct ct_source *out)
{
    for (uint32_t row = 0; row < r->count; row++)
        if (!is_made_before(p, r, ct_repetition_argument(p, r, row, operand)))
            return false;
    *out = (struct ct_source){.kind = CT_SOURCE_COLUMN, .at = (uint32_t)r->ncolumn};
    for (size_t i = 0; i < r->ncolumn; i++)
        if (is_same_sequence(p, r, r->column[i].operand, operand)) {
            out->at = (uint32_t)i;
            return true;
        }
    CT_PUSH(p->arena, r->column, r->ncolumn, r->column_cap,
            (struct ct_repetition_column){operand});
    return true;
}

// ---- which loops there are --------------------------------------------------------------------

// Number of columns that change with each evaluation and are copied each time.
static size_t count_copied(const struct ct_repetitions *p, const struct ct_repetition *r)
{
    size_t n = 0;
    for (size_t i = 0; i < r->ncolumn; i++)
        r->column[i].is_copied = false;
    for (uint32_t row = 0; row < r->count; row++)
        for (size_t i = 0; i < r->ncolumn; i++) {
            struct ct_repetition_column *c = &r->column[i];
            const uint32_t v = ct_repetition_argument(p, r, row, c->operand);
            if (!c->is_copied && p->l->rate[v] == CT_RATE_CALL) {
                c->is_copied = true;
                n++;
            }
        }
    return n;
}

// Does the operand in this row follow the same rule as in the middle row?
static bool is_alike(const struct ct_repetitions *p, const struct ct_repetition *r,
                     uint32_t operand, int kind, uint32_t row)
{
    const uint32_t middle = r->count / 2, v = ct_repetition_argument(p, r, row, operand),
                   w = ct_repetition_argument(p, r, middle, operand),
                   next = ct_repetition_argument(p, r, middle + 1, operand);
    const int32_t ahead = (int32_t)row - (int32_t)middle;
    const uint32_t begin = r->first + middle * r->period;
    int32_t at[3];
    uint32_t slot[3];
    switch (kind) {
    case CT_SOURCE_ROW:
        return p->at[w] != none && p->at[w] >= begin && p->at[w] < begin + r->period
            && p->at[v] == p->at[w] + (uint32_t)ahead * r->period;
    case CT_SOURCE_FIXED:
        return v == w && is_made_before(p, r, v);
    case CT_SOURCE_INPUTS: {
        const uint32_t a = input_of(p, w), b = input_of(p, next);
        return a != none && b != none && is_input_at(p, v, a, (int32_t)(b - a), ahead);
    }
    default: {
        const struct ct_repetition *other = ct_repetition_of(p, w, &at[0], &slot[0]);
        return other && ct_repetition_of(p, next, &at[1], &slot[1]) == other
            && slot[0] == slot[1] && ct_repetition_of(p, v, &at[2], &slot[2]) == other
            && slot[2] == slot[0] && at[2] == at[0] + ahead * (at[1] - at[0]);
    }
    }
}

// Find the longest range of rows around the middle in which an operand follows one rule.
static void regular_rows(const struct ct_repetitions *p, const struct ct_repetition *r,
                         uint32_t operand, uint32_t *first, uint32_t *behind)
{
    const uint32_t middle = r->count / 2;
    *first = *behind = middle;
    for (int kind = CT_SOURCE_ROW; kind <= CT_SOURCE_RESULTS; kind++) {
        uint32_t lo = middle, hi = middle;
        while (hi < r->count && is_alike(p, r, operand, kind, hi))
            hi++;
        while (hi > middle && lo > 0 && is_alike(p, r, operand, kind, lo - 1))
            lo--;
        if (hi - lo > *behind - *first) {
            *first = lo;
            *behind = hi;
        }
    }
}

// Drop irregular rows at the ends if an operand would otherwise be copied or has no address.
static void drop_end_rows(const struct ct_repetitions *p, struct ct_repetition *r,
                          uint32_t operand)
{
    uint32_t first, behind;
    regular_rows(p, r, operand, &first, &behind);
    r->keep_first = first > r->keep_first ? first : r->keep_first;
    r->keep_behind = behind < r->keep_behind ? behind : r->keep_behind;
}

static uint32_t dropped_rows(const struct ct_repetition *r)
{
    return r->count - (r->keep_behind - r->keep_first);
}

// Do copies cost more than straight-line code for the end rows? A copy is a load and a store; an
// instruction of straight-line code costs about one instruction fetch more than one of a loop.
static bool copies_cost_more(const struct ct_repetitions *p, struct ct_repetition *r)
{
    size_t nsaved = 0;
    for (size_t i = 0; i < r->ncolumn; i++)
        if (r->column[i].is_copied) {
            drop_end_rows(p, r, r->column[i].operand);
            nsaved++;
        }
    return 2 * nsaved * r->count > dropped_rows(r) * r->period;
}

static bool resolve_operands(const struct ct_repetitions *p, struct ct_repetition *r)
{
    bool all = true;
    r->keep_first = 0;
    r->keep_behind = r->count;
    resolve_row_and_fixed(p, r);
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t k = 0; k < ct_repetition_instruction(p, r->first + slot)->narg; k++) {
            const uint32_t operand = 3 * slot + k;
            struct ct_source *out = &r->reach[operand];
            if (out->kind != CT_SOURCE_OPEN || resolve_inputs(p, r, operand, out)
                || resolve_results(p, r, operand, out) || resolve_column(p, r, operand, out))
                continue;
            drop_end_rows(p, r, operand);
            all = false;
        }
    const size_t ncopied = count_copied(p, r);
    if (!all || copies_cost_more(p, r))
        return false;
    r->keep_first = 0;
    r->keep_behind = r->count;
    // a copy is a load and a store: a quarter of what a row does at most
    return 8 * ncopied <= r->period
        && use_stream(r, CT_SOURCE_RESULTS, (uint32_t)(r - p->repetition), 1);
}

static void reset(const struct ct_repetitions *p, struct ct_repetition *r)
{
    if (!r->reach) {
        r->reach = CT_NEWN(p->scratch, struct ct_source, 3 * (size_t)r->period);
        r->escapes = CT_NEWN(p->scratch, bool, r->period);
        r->edge_of = CT_NEWN(p->scratch, uint32_t, r->period);
        r->offset = CT_NEWN(p->scratch, uint32_t, r->period);
        r->escapes_far = CT_NEWN(p->scratch, bool, r->period);
        r->least_row = CT_NEWN(p->scratch, uint32_t, r->period);
        r->part = CT_NEWN(p->scratch, unsigned char, r->period);
        r->keep = CT_NEWN(p->scratch, enum ct_keep, r->period);
        r->out_stride = CT_NEWN(p->scratch, int32_t, r->period);
    }
    memset(r->edge_of, 0, r->period * sizeof *r->edge_of);
    r->nedge = r->ncolumn = 0;
    r->nstream = 0;
    r->before = r->behind = 0;
}

static void assign_range(const struct ct_repetitions *p, const struct ct_repetition *r,
                         uint32_t to)
{
    for (uint32_t k = 0; k < r->period * r->count; k++)
        p->repetition_of[r->first + k] = to;
}

// An operand has no address: try without irregular end rows, then without the first row, the last
// row, both; then give up.
static void trim_rows(struct ct_repetitions *p, struct ct_repetition *r)
{
    static const struct {
        unsigned first, less; // number of rows
    } without[] = {{1, 1}, {0, 1}, {1, 2}};
    assign_range(p, r, none);
    const uint32_t left = dropped_rows(r);
    if (r->ncut == 0 && left && r->count >= left + CT_LEAST_ROWS) {
        r->first += r->keep_first * r->period;
        r->count -= left;
        assign_range(p, r, (uint32_t)(r - p->repetition));
        return;
    }
    if (r->ncut == 0) {
        r->whole_first = r->first;
        r->whole_count = r->count;
    }
    r->is_dropped
        = r->ncut == COUNT(without) || r->whole_count < without[r->ncut].less + CT_LEAST_ROWS;
    if (r->is_dropped)
        return;
    r->first = r->whole_first + without[r->ncut].first * r->period;
    r->count = r->whole_count - without[r->ncut].less;
    r->ncut++;
    assign_range(p, r, (uint32_t)(r - p->repetition));
}

// Remove the edges that were added last for `asker`.
static void remove_edges(struct ct_repetition *r, uint32_t asker)
{
    size_t n = r->nedge;
    while (n && r->edge[n - 1].asker == asker)
        n--;
    if (n == r->nedge)
        return;
    for (uint32_t slot = 0; slot < r->period; slot++)
        while (r->edge_of[slot] > n)
            r->edge_of[slot] = r->edge[r->edge_of[slot] - 1].next;
    r->nedge = n;
    r->before = r->behind = 0;
    for (size_t i = 0; i < n; i++)
        make_room(r, r->edge[i].row);
}

static void withdraw_edges(struct ct_repetitions *p, const struct ct_repetition *r)
{
    for (int i = 0; i < r->nstream; i++)
        if (r->stream[i].kind == CT_SOURCE_RESULTS)
            remove_edges(&p->repetition[r->stream[i].other], (uint32_t)(r - p->repetition));
}

// Resolve all repetitions in order. Each reads results of itself and of earlier ones only. Trimming
// one changes earlier ones only by the edges that it has added to them.
static void resolve_all(struct ct_repetitions *p)
{
    for (size_t i = 0; i < p->nrepetition; i++) {
        struct ct_repetition *r = &p->repetition[i];
        reset(p, r);
        while (!r->is_dropped && !resolve_operands(p, r)) {
            withdraw_edges(p, r);
            trim_rows(p, r);
            reset(p, r);
        }
    }
}

struct ct_reroll ct_reroll_find(struct ct_arena *a, const struct ct_listing *l,
                                const uint32_t *order, uint32_t n,
                                const bool is_alone[CT_NKIND], uint32_t nwork, uint32_t rows,
                                uint32_t lanes)
{
    struct ct_repetitions p = {.arena = a, .l = l, .order = order, .n = n};
    struct ct_reroll out = {.slot = CT_NEWN(a, uint32_t, l->nvalue + 1), .nwork = nwork};
    struct ct_arena *scratch = p.scratch = ct_arena_create_under(a);
    p.at = CT_NEWN(scratch, uint32_t, l->nvalue + 1);
    p.sign = CT_NEWN(scratch, uint64_t, n + 1);
    p.again = CT_NEWN(scratch, uint32_t, n + 1);
    p.repetition_of = CT_NEWN(scratch, uint32_t, n + 1);
    p.is_swapped = CT_NEWN(scratch, bool, n + 1);
    for (size_t v = 0; v < l->nvalue; v++)
        p.at[v] = out.slot[v] = none;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < ct_repetition_instruction(&p, i)->nres; k++)
            p.at[ct_repetition_instruction(&p, i)->res[k]] = i;
    ct_repetitions_find(&p, is_alone, rows);
    resolve_all(&p);
    ct_repetition_lay_out(&p, rows, lanes, &out);
    ct_arena_destroy(scratch);
    return out;
}
