// Memory layout of rerolled loops: results that are read later, loop distribution, strip mining,
// slots of the work array; see reroll_layout.h.
#include "codegen/reroll_layout.h"

static const uint32_t none = CT_VALUE_NONE;

#include <string.h>

// ---- live-out results ------------------------------------------------------------------------

// In this row of `reader`, does the operand come from the source that all rows have in common?
static bool is_taken_in_turn(const struct ct_repetitions *p, const struct ct_repetition *reader,
                             uint32_t operand, int32_t row, const struct ct_repetition *r,
                             uint32_t slot, int32_t its)
{
    const struct ct_source *from = &reader->reach[operand];
    return from->kind == CT_SOURCE_RESULTS && &p->repetition[from->other] == r
        && from->at == slot && from->row + row * from->step == its;
}

static void mark_live_out(struct ct_repetition *r, uint32_t slot, int32_t row)
{
    r->escapes[slot] = true;
    if ((uint32_t)row < r->least_row[slot])
        r->least_row[slot] = (uint32_t)row;
}

static void find_live_out(const struct ct_repetitions *p)
{
    int32_t row;
    uint32_t slot;
    for (size_t i = 0; i < p->nrepetition; i++)
        for (uint32_t k = 0; k < p->repetition[i].period && !p->repetition[i].is_dropped; k++)
            p->repetition[i].least_row[k] = UINT32_MAX;
    for (uint32_t i = 0; i < p->n; i++) {
        const uint32_t which = p->repetition_of[i];
        const struct ct_repetition *reader = which == none ? NULL : &p->repetition[which];
        const uint32_t at = reader ? i - reader->first : 0;
        for (uint32_t k = 0; k < ct_repetition_instruction(p, i)->narg; k++) {
            struct ct_repetition *r
                = ct_repetition_of(p, ct_repetition_operand(p, i, k), &row, &slot);
            if (!r)
                continue;
            if (r == reader)
                r->escapes[slot] |= at / r->period != (uint32_t)row;
            else if (reader
                     && is_taken_in_turn(p, reader, 3 * (at % reader->period) + k,
                                         (int32_t)(at / reader->period), r, slot, row))
                r->escapes[slot] = r->escapes_far[slot] = true;
            else
                mark_live_out(r, slot, row);
        }
    }
    for (size_t k = 0; k < p->l->nout; k++) {
        struct ct_repetition *r = ct_repetition_of(p, p->l->out[k], &row, &slot);
        if (r)
            mark_live_out(r, slot, row);
    }
}

// ---- vectorisation over rows -------------------------------------------------------------------

// Number of vectorised parts of a distributed loop. It affects the time only: on the twelve largest
// references and systems, 6 and 60 give the same loops, 1 a tenth fewer. Limit: passes over the
// instructions of a loop
enum { MOST_PARTS = 2 };

static bool reads_itself(const struct ct_repetitions *p, const struct ct_repetition *r,
                         const struct ct_source *from)
{
    return from->kind == CT_SOURCE_RESULTS && &p->repetition[from->other] == r;
}

static unsigned char part_of(const struct ct_repetitions *p, const struct ct_repetition *r,
                             uint32_t slot)
{
    unsigned char part = 0;
    for (uint32_t k = 0; k < ct_repetition_instruction(p, r->first + slot)->narg; k++) {
        const struct ct_source *from = &r->reach[3 * slot + k];
        unsigned char its = 0;
        if (from->kind == CT_SOURCE_ROW)
            its = r->part[from->at];
        else if (reads_itself(p, r, from))
            its = from->step == 1 && r->part[from->at] < MOST_PARTS ? r->part[from->at] + 1
                                                                    : MOST_PARTS;
        part = its > part ? its : part;
    }
    return part;
}

// Loop distribution: an instruction that reads results of earlier rows moves to a later part.
// Recurrences, such as running sums, and what depends on them end in the last part, which is not
// vectorised. Cost: at most MOST_PARTS passes over the instructions of a row.
static void distribute_loop(const struct ct_repetitions *p, struct ct_repetition *r)
{
    for (bool changes = true; changes;) {
        changes = false;
        for (uint32_t slot = 0; slot < r->period; slot++) {
            const unsigned char part = part_of(p, r, slot);
            changes |= part != r->part[slot];
            r->part[slot] = part;
        }
    }
    uint32_t last = 0;
    for (uint32_t slot = 0; slot < r->period; slot++) {
        r->nlate += r->part[slot] == MOST_PARTS;
        if (r->part[slot] < MOST_PARTS && r->part[slot] > last)
            last = r->part[slot];
    }
    r->npart = last + 2;
    for (uint32_t slot = 0; slot < r->period; slot++)
        if (r->part[slot] == MOST_PARTS)
            r->part[slot] = (unsigned char)(last + 1);
}

static bool is_late(const struct ct_repetition *r, uint32_t slot)
{
    return r->part[slot] + 1u == r->npart;
}

// Number of operands that need a gather, because their rows are not contiguous.
static uint32_t count_gathered(const struct ct_repetitions *p, const struct ct_repetition *r)
{
    uint32_t n = 0;
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t k = 0;
             k < ct_repetition_instruction(p, r->first + slot)->narg && !is_late(r, slot);
             k++) {
            const struct ct_source *from = &r->reach[3 * slot + k];
            n += (from->kind == CT_SOURCE_INPUTS && from->step != 1)
              || (from->kind == CT_SOURCE_RESULTS && !reads_itself(p, r, from)
                  && (!p->repetition[from->other].is_vectorized || from->step != 1));
        }
    return n;
}

// Number of reads between the parts of a distributed loop.
static uint32_t count_crossing_reads(const struct ct_repetitions *p, struct ct_repetition *r)
{
    uint32_t n = 0;
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t k = 0; k < ct_repetition_instruction(p, r->first + slot)->narg; k++) {
            const struct ct_source *from = &r->reach[3 * slot + k];
            if (from->kind == CT_SOURCE_ROW && r->part[from->at] != r->part[slot]) {
                n += !r->escapes[from->at];
                r->escapes[from->at] = true;
            }
        }
    return n;
}

// Rows of a strip: four vectors, which are two cache lines of each result; or three or five, so
// that the last strip is full or fills a vector. A loop of one or two strips is not strip-mined.
static uint32_t strip_of(uint32_t count, uint32_t lanes)
{
    static const uint32_t vectors[] = {4, 3, 5};
    for (size_t i = 0; i < COUNT(vectors); i++) {
        const uint32_t strip = vectors[i] * lanes;
        if (count > 2 * strip && (count % strip == 0 || count % strip >= lanes))
            return strip;
    }
    return 0;
}

// Choose between one row and several at a time by a cost model: number of instructions.
static void choose_lanes(struct ct_repetitions *p, uint32_t lanes)
{
    // Derived: instructions: to gather four doubles two pairs of loads and a merge; to pass a value
    // to the next part, a store and a load
    enum { GATHER = 5, HAND_OVER = 2 };
    for (size_t i = 0; i < p->nrepetition && lanes > 1; i++) {
        struct ct_repetition *r = &p->repetition[i];
        if (r->is_dropped || r->count < lanes)
            continue;
        distribute_loop(p, r);
        const uint32_t n = r->period - r->nlate;
        const uint32_t more = GATHER * count_gathered(p, r) + HAND_OVER * r->nlate;
        r->is_vectorized = (lanes - 1) * n > more;
        if (!r->is_vectorized)
            continue;
        count_crossing_reads(p, r);
        r->strip = r->nstream < CT_REROLL_STREAMS ? strip_of(r->count, lanes) : 0;
    }
}

// ---- slots of the work array -------------------------------------------------------------------

static uint32_t place_of(const struct ct_repetition *r, uint32_t number, int32_t row)
{
    return (uint32_t)((int32_t)r->origin + row * (int32_t)r->row_stride
                      + (int32_t)(number * r->slot_stride));
}

static uint32_t place_of_slot(const struct ct_repetition *r, uint32_t slot, int32_t row)
{
    switch (r->keep[slot]) {
    case CT_KEEP_STRIP:
        return (uint32_t)((int32_t)(r->local_origin + r->offset[slot] * r->local_stride) + row);
    case CT_KEEP_PLACE:
        return r->passed_origin + r->offset[slot];
    case CT_KEEP_OUT:
        return CT_REROLL_OUT;
    default:
        return place_of(r, r->offset[slot], row);
    }
}

static uint32_t rounded_up(uint32_t n, uint32_t to)
{
    return (n + to - 1) / to * to;
}

// Pad to an odd number of vectors, so that columns do not map to the same cache sets.
static uint32_t odd_rows(uint32_t rows, uint32_t lanes)
{
    return rows / lanes % 2 == 0 ? rows + lanes : rows;
}

// First row of the last strip, from which on results stay in memory.
static uint32_t last_strip(const struct ct_repetition *r)
{
    return (r->count - 1) / r->strip * r->strip;
}

// Find results that need one slot only: each is read by the next row, before that row writes its
// own, and elsewhere only after the last row.
static void find_passed(const struct ct_repetitions *p, struct ct_repetition *r)
{
    for (uint32_t slot = 0; slot < r->period; slot++)
        if (r->escapes[slot] && !r->escapes_far[slot] && r->least_row[slot] >= r->count - 1)
            r->keep[slot] = CT_KEEP_PLACE;
    for (uint32_t slot = 0; slot < r->period; slot++)
        for (uint32_t k = 0; k < ct_repetition_instruction(p, r->first + slot)->narg; k++) {
            const struct ct_source *from = &r->reach[3 * slot + k];
            if (reads_itself(p, r, from) && r->keep[from->at] == CT_KEEP_PLACE
                && (from->step != 1 || from->row != -1 || from->at < slot))
                r->keep[from->at] = CT_KEEP_ROWS;
        }
}

static uint32_t output_of(const struct ct_repetitions *p, const struct ct_repetition *r,
                          uint32_t slot, uint32_t row)
{
    const uint32_t at = r->first + row * r->period + slot;
    return p->output[ct_repetition_instruction(p, at)->res[0]] - 1;
}

static bool is_output_by_row(const struct ct_repetitions *p, const struct ct_repetition *r,
                             uint32_t slot)
{
    const uint32_t first = output_of(p, r, slot, 0), step = output_of(p, r, slot, 1) - first;
    for (uint32_t row = 0; row < r->count; row++) {
        const uint32_t k = output_of(p, r, slot, row);
        if (k == none || k != first + row * step)
            return false;
    }
    return true;
}

// Find results that are outputs in each row and that no row reads. nstream: streams of the loop so
// far.
static void find_outputs(const struct ct_repetitions *p, struct ct_repetition *r, int nstream)
{
    int32_t stride[CT_REROLL_STREAMS];
    int n = 0;
    bool *is_read = CT_NEWN(p->scratch, bool, r->period);
    for (uint32_t i = 0; i < 3 * r->period; i++)
        if (i % 3 < ct_repetition_instruction(p, r->first + i / 3)->narg
            && reads_itself(p, r, &r->reach[i]))
            is_read[r->reach[i].at] = true;
    for (uint32_t slot = 0; slot < r->period; slot++) {
        if (!r->escapes[slot] || r->escapes_far[slot] || is_read[slot]
            || !is_output_by_row(p, r, slot))
            continue;
        r->offset[slot] = output_of(p, r, slot, 0);
        r->out_stride[slot] = (int32_t)(output_of(p, r, slot, 1) - r->offset[slot]);
        int i = 0;
        while (i < n && stride[i] != r->out_stride[slot])
            i++;
        if (i == n && nstream + n == CT_REROLL_STREAMS)
            continue;
        if (i == n)
            stride[n++] = r->out_stride[slot];
        r->keep[slot] = CT_KEEP_OUT;
    }
}

static void find_strips(struct ct_repetition *r)
{
    for (uint32_t slot = 0; slot < r->period && r->strip; slot++)
        if (r->escapes[slot] && !r->escapes_far[slot] && r->least_row[slot] >= last_strip(r))
            r->keep[slot] = CT_KEEP_STRIP;
}

static bool is_constant(const struct ct_repetitions *p, const struct ct_repetition *r,
                        uint32_t operand)
{
    for (uint32_t row = 0; row < r->count; row++)
        if (p->l->rate[ct_repetition_argument(p, r, row, operand)] != CT_RATE_NEVER)
            return false;
    return true;
}

// Number the columns. Constants by row are the same in all lanes. Returns the number of the other
// columns.
static uint32_t number_columns(const struct ct_repetitions *p, struct ct_repetition *r,
                               uint32_t lanes)
{
    uint32_t n = 0;
    for (size_t i = 0; i < r->ncolumn; i++) {
        struct ct_repetition_column *c = &r->column[i];
        c->is_number
            = lanes > 1 && r->nstream < CT_REROLL_STREAMS && is_constant(p, r, c->operand);
        c->at = c->is_number ? r->nnumber++ : n++;
    }
    return n;
}

static void choose_keep(const struct ct_repetitions *p, struct ct_repetition *r)
{
    if (r->is_vectorized) {
        find_strips(r);
    } else {
        find_passed(p, r);
        find_outputs(p, r, r->nstream + (r->nnumber > 0));
    }
    uint32_t *const number[] = {&r->nresult, &r->nlocal, &r->npassed};
    for (uint32_t slot = 0; slot < r->period; slot++)
        if (r->escapes[slot] && r->keep[slot] != CT_KEEP_OUT)
            r->offset[slot] = (*number[r->keep[slot]])++;
}

static void place_rows(const struct ct_repetitions *p, struct ct_repetition *r, uint32_t *nwork,
                       uint32_t together, uint32_t lanes)
{
    const uint32_t ncolumn = number_columns(p, r, lanes);
    choose_keep(p, r);
    const uint32_t width = r->nresult + ncolumn,
                   before = rounded_up((uint32_t)r->before, together);
    uint32_t rows = before + rounded_up(r->count + (uint32_t)r->behind, together);
    if (r->is_vectorized)
        rows = odd_rows(rows, together);
    r->row_stride = r->is_vectorized ? 1 : width;
    r->slot_stride = r->is_vectorized ? rows : 1;
    *nwork = rounded_up(*nwork, together);
    r->origin = *nwork + before * r->row_stride;
    *nwork += rows * width;
    r->local_stride = odd_rows(before + r->strip, together);
    r->local_origin = *nwork + before;
    *nwork += r->nlocal * r->local_stride;
    r->passed_origin = *nwork;
    *nwork += r->npassed;
    r->number_origin = *nwork * lanes;
    *nwork += rounded_up(r->count * r->nnumber, lanes) / lanes;
}

// ---- the loops ----------------------------------------------------------------------------------

static struct ct_operand result_of(const struct ct_repetition *r, uint32_t slot, int32_t row,
                                   int32_t step)
{
    static const enum ct_reach reach[] = {[CT_KEEP_ROWS] = CT_REACH_WORK,
                                          [CT_KEEP_STRIP] = CT_REACH_STRIP,
                                          [CT_KEEP_PLACE] = CT_REACH_PLACE};
    if (r->keep[slot] == CT_KEEP_OUT)
        return (struct ct_operand){CT_REACH_OUT, r->offset[slot], r->out_stride[slot]};
    return (struct ct_operand){reach[r->keep[slot]], place_of_slot(r, slot, row),
                               step * (int32_t)r->row_stride};
}

static struct ct_operand column_of(const struct ct_repetition *r, uint32_t column)
{
    const uint32_t at = r->column[column].at;
    if (r->column[column].is_number)
        return (struct ct_operand){CT_REACH_NUMBER, r->number_origin + at, (int32_t)r->nnumber};
    return (struct ct_operand){CT_REACH_WORK, place_of(r, r->nresult + at, 0),
                               (int32_t)r->row_stride};
}

static struct ct_operand operand_of(const struct ct_repetitions *p,
                                    const struct ct_repetition *r, const struct ct_source *from)
{
    switch (from->kind) {
    case CT_SOURCE_ROW:
        return (struct ct_operand){.reach = CT_REACH_ROW, .at = from->at};
    case CT_SOURCE_FIXED:
        return (struct ct_operand){.reach = CT_REACH_FIXED, .at = from->at};
    case CT_SOURCE_INPUTS:
        return (struct ct_operand){CT_REACH_INPUT, from->at, from->step};
    case CT_SOURCE_RESULTS:
        return result_of(&p->repetition[from->other], from->at, from->row, from->step);
    default:
        return column_of(r, from->at);
    }
}

static void add_columns(const struct ct_repetitions *p, const struct ct_repetition *r,
                        struct ct_loop *loop, struct ct_reroll *out)
{
    for (uint32_t i = 0; i < r->ncolumn; i++)
        for (uint32_t row = 0; row < r->count; row++) {
            const struct ct_operand o = column_of(r, i);
            const struct ct_copy c = {ct_repetition_argument(p, r, row, r->column[i].operand),
                                      o.at + row * (uint32_t)o.stride, r->column[i].is_number};
            if (!r->column[i].is_copied)
                CT_PUSH(p->arena, out->table, out->ntable, out->table_cap, c);
            else
                CT_PUSH(p->arena, loop->copy, loop->ncopy, loop->copy_cap, c);
        }
}

// Add the copies for edges of all stretches that this one needs.
static void add_edges(const struct ct_repetitions *p, uint32_t asker, struct ct_loop *loop)
{
    for (uint32_t i = 0; i <= asker; i++) {
        const struct ct_repetition *r = &p->repetition[i];
        for (uint32_t slot = 0; slot < r->period && !r->is_dropped && r->nedge; slot++)
            for (uint32_t k = r->edge_of[slot]; k; k = r->edge[k - 1].next) {
                const struct ct_repetition_edge *e = &r->edge[k - 1];
                const struct ct_copy c = {e->value, place_of_slot(r, slot, e->row)};
                if (e->asker == asker)
                    CT_PUSH(p->arena, loop->copy, loop->ncopy, loop->copy_cap, c);
            }
    }
}

// Fill a loop with the instructions of one part of a row, or all of them.
static void fill_loop(const struct ct_repetitions *p, const struct ct_repetition *r,
                      uint32_t part, struct ct_loop *loop)
{
    uint32_t *number = CT_NEWN(p->arena, uint32_t,
                               r->period); // by instruction of the row: its index in the loop
    loop->slot = CT_NEWN(p->arena, uint32_t, r->period);
    loop->operand = CT_NEWN(p->arena, struct ct_operand, 3 * r->period);
    loop->result = CT_NEWN(p->arena, struct ct_operand, r->period);
    for (uint32_t slot = 0; slot < r->period; slot++) {
        if (r->is_vectorized && r->part[slot] != part)
            continue;
        const uint32_t i = number[slot] = loop->nslot++;
        loop->slot[i] = slot;
        loop->result[i] = r->escapes[slot] ? result_of(r, slot, 0, 1)
                                           : (struct ct_operand){.reach = CT_REACH_ROW};
        for (uint32_t k = 0; k < ct_repetition_instruction(p, r->first + slot)->narg; k++) {
            const struct ct_source *from = &r->reach[3 * slot + k];
            struct ct_operand *o = &loop->operand[3 * i + k];
            *o = operand_of(p, r, from);
            if (from->kind != CT_SOURCE_ROW)
                continue;
            if (r->is_vectorized && r->part[from->at] != part)
                *o = result_of(r, from->at, 0, 1);
            else
                o->at = number[from->at];
        }
    }
}

// Find the results in the last rows of a strip that the next strip reads.
static void add_carried(const struct ct_repetitions *p, const struct ct_repetition *r,
                        struct ct_loop *loop)
{
    bool *is_carried = CT_NEWN(p->arena, bool, r->period);
    for (uint32_t slot = 0; slot < r->period && r->strip; slot++)
        for (uint32_t k = 0; k < ct_repetition_instruction(p, r->first + slot)->narg; k++) {
            const struct ct_source *from = &r->reach[3 * slot + k];
            if (reads_itself(p, r, from))
                is_carried[from->at] = r->keep[from->at] == CT_KEEP_STRIP;
        }
    loop->ncarried = 0;
    loop->carried = CT_NEWN(p->arena, uint32_t, r->period);
    for (uint32_t slot = 0; slot < r->period; slot++)
        if (is_carried[slot])
            loop->carried[loop->ncarried++] = place_of_slot(r, slot, 0);
    loop->nbefore = (uint32_t)r->before;
}

static void keep_places(const struct ct_repetitions *p, const struct ct_repetition *r,
                        struct ct_reroll *out)
{
    for (uint32_t slot = 0; slot < r->period; slot++) {
        const uint32_t from = r->keep[slot] == CT_KEEP_STRIP ? last_strip(r)
                            : r->keep[slot] == CT_KEEP_PLACE ? r->count - 1
                                                             : 0;
        for (uint32_t row = from; row < r->count && r->escapes[slot]; row++) {
            const uint32_t at = r->first + row * r->period + slot;
            out->slot[ct_repetition_instruction(p, at)->res[0]]
                = place_of_slot(r, slot, (int32_t)(row - from));
        }
    }
}

static void add_loops(const struct ct_repetitions *p, uint32_t which, struct ct_reroll *out)
{
    const struct ct_repetition *r = &p->repetition[which];
    const uint32_t npart = r->is_vectorized ? r->npart : 1;
    const uint32_t first = (uint32_t)out->nloop;
    for (uint32_t part = 0; part < npart; part++) {
        struct ct_loop *loop = &out->loop[out->nloop];
        *loop = (struct ct_loop){.first = r->first,
                                 .period = r->period,
                                 .count = r->count,
                                 .strip = r->strip,
                                 .is_vectorized = r->is_vectorized && part + 1 < npart};
        fill_loop(p, r, part, loop);
        out->nloop += loop->nslot > 0;
    }
    struct ct_loop *loop = &out->loop[first];
    keep_places(p, r, out);
    add_edges(p, which, loop);
    add_columns(p, r, loop, out);
    add_carried(p, r, loop);
}

void ct_repetition_lay_out(struct ct_repetitions *p, uint32_t rows, uint32_t lanes,
                           struct ct_reroll *out)
{
    p->output = CT_NEWN(p->scratch, uint32_t, p->l->nvalue + 1);
    for (size_t k = p->l->nout; k-- > 0;)
        p->output[p->l->out[k]] = (uint32_t)k + 1;
    find_live_out(p);
    choose_lanes(p, rows);
    for (size_t i = 0; i < p->nrepetition; i++)
        if (!p->repetition[i].is_dropped)
            place_rows(p, &p->repetition[i], &out->nwork, rows, lanes);
    out->nstraight = p->n;
    out->loop = CT_NEWN(p->arena, struct ct_loop, (MOST_PARTS + 1) * p->nrepetition + 1);
    for (uint32_t i = 0; i < p->nrepetition; i++)
        if (!p->repetition[i].is_dropped) {
            const struct ct_repetition *r = &p->repetition[i];
            out->nstraight -= r->period * r->count;
            out->nresult += (r->nresult + r->nlocal + r->npassed) * r->count;
            add_loops(p, i, out);
        }
}
