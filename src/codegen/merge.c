// See merge.h. Every instruction gets a time, and the new order is that of times, else that before: an instruction of a loop
// has that of its row, rows counted from where all of them find their operands done; any other one comes as soon as its
// operands are there.
#include "codegen/merge.h"

#include <string.h>

enum {
    FIRST_TIME
    = 16, // of loops that need no other one; what these need row by row may begin before
    MOST_ELEMENTS = 4, // that a row is of
};

struct clock {
    const struct ct_listing *l;
    const uint32_t *order;
    uint32_t *time;  // by value; 0: no loop leads to it
    uint32_t *place; // by value: 1 + the place that makes it, of those that have been seen
    uint32_t *when;  // by place
};

static const struct ct_instruction *instruction(const struct clock *c, uint32_t place)
{
    return &c->l->ins[c->order[place]];
}

static void set_time(struct clock *c, uint32_t place, uint32_t t)
{
    const struct ct_instruction *i = instruction(c, place);
    c->when[place] = t;
    for (uint32_t k = 0; k < i->nres; k++) {
        c->time[i->res[k]] = t;
        c->place[i->res[k]] = place + 1;
    }
}

static void time_straight(struct clock *c, uint32_t place)
{
    const struct ct_instruction *i = instruction(c, place);
    uint32_t t = 0;
    for (uint32_t k = 0; k < i->narg; k++)
        if (c->time[i->arg[k]] > t)
            t = c->time[i->arg[k]];
    set_time(c, place, t);
}

// Time of row 0 such that no row comes before its operands. step: time between rows.
static uint32_t start_of(struct clock *c, const struct ct_loop *loop, uint32_t step)
{
    int64_t start = 0;
    for (uint32_t i = 0; i < loop->period * loop->count; i++) {
        const uint32_t place = loop->first + i;
        const struct ct_instruction *ins = instruction(c, place);
        for (uint32_t k = 0; k < ins->narg; k++) {
            const uint32_t v = ins->arg[k];
            const int64_t need = (int64_t)c->time[v] - (int64_t)(i / loop->period * step);
            if (c->place[v] <= loop->first && c->time[v] && (!start || need > start))
                start = need > 1 ? need : 1;
        }
        set_time(c, place, 0); // its own operands do not count
    }
    return start ? (uint32_t)start : FIRST_TIME;
}

// most: rows of the longest loop.
static void time_loop(struct clock *c, const struct ct_loop *loop, uint32_t most)
{
    const uint32_t elements = (most + loop->count / 2) / loop->count,
                   step = elements > MOST_ELEMENTS ? 1 : elements,
                   start = start_of(c, loop, step);
    for (uint32_t i = 0; i < loop->period * loop->count; i++)
        set_time(c, loop->first + i, start + i / loop->period * step);
}

static uint32_t longest(const struct ct_roll *r)
{
    uint32_t most = 0;
    for (size_t i = 0; i < r->nloop; i++)
        most = r->loop[i].count > most ? r->loop[i].count : most;
    return most;
}

static void sort_by_time(struct ct_arena *a, const struct clock *c, uint32_t n,
                         uint32_t *sorted)
{
    uint32_t last = 0;
    for (uint32_t at = 0; at < n; at++)
        last = c->when[at] > last ? c->when[at] : last;
    uint32_t *start = CT_NEWN(a, uint32_t, last + 2);
    for (uint32_t at = 0; at < n; at++)
        start[c->when[at] + 1]++;
    for (uint32_t t = 0; t <= last; t++)
        start[t + 1] += start[t];
    for (uint32_t at = 0; at < n; at++)
        sorted[start[c->when[at]]++] = c->order[at];
}

static uint32_t *merged_order(struct ct_arena *a, const struct ct_listing *l,
                              const uint32_t *order, uint32_t n, uint32_t nfixed,
                              const struct ct_roll *r)
{
    struct clock c = {.l = l,
                      .order = order,
                      .time = CT_NEWN(a, uint32_t, l->nvalue + 1),
                      .place = CT_NEWN(a, uint32_t, l->nvalue + 1),
                      .when = CT_NEWN(a, uint32_t, n + 1)};
    uint32_t *sorted = CT_NEWN(a, uint32_t, n + 1);
    const uint32_t most = longest(r);
    size_t next = 0;
    for (uint32_t at = 0; at < nfixed; at++)
        set_time(&c, at, 0);
    for (uint32_t at = nfixed; at < n;) {
        while (next < r->nloop
               && r->loop[next].first < at) // parts of a loop that has been timed
            next++;
        if (next == r->nloop || r->loop[next].first != at) {
            time_straight(&c, at++);
            continue;
        }
        time_loop(&c, &r->loop[next], most);
        at += r->loop[next].period * r->loop[next].count;
    }
    sort_by_time(a, &c, n, sorted);
    return sorted;
}

// Cycles until a result can be read, on processors of the last ten years.
static unsigned latency(unsigned op)
{
    return op == CT_OP_DIV ? 14 : op == CT_OP_SQRT ? 18 : op == CT_OP_NEG ? 1 : 4;
}

// Instructions that could be done while others wait for their operands. Two a cycle are done; how far a processor looks beyond
// one that waits is what its scheduler holds (60 to 97 entries), and what was made before more instructions than there are
// registers comes from memory.
static double count_waiting(struct ct_arena *a, const struct ct_listing *l,
                            const uint32_t *order, uint32_t n)
{
    enum { AHEAD = 96, A_CYCLE = 2, NREGISTER = 16, LOAD = 5 };
    struct made {
        uint32_t at, ready; // place; in halves of a cycle, 0: leaves
    } *made = CT_NEWN(a, struct made, l->nvalue + 1);
    uint32_t *done = CT_NEWN(a, uint32_t, n + 1); // by place, with all before it
    for (uint32_t i = 0; i < n; i++) {
        const struct ct_instruction *ins = &l->ins[order[i]];
        uint32_t t = i < AHEAD ? 0 : done[i - AHEAD];
        for (uint32_t k = 0; k < ins->narg; k++) {
            const struct made *m = &made[ins->arg[k]];
            const uint32_t its
                = m->ready + (m->ready && i - m->at > NREGISTER ? A_CYCLE * LOAD : 0);
            t = its > t ? its : t;
        }
        t += A_CYCLE * latency(ins->op);
        for (uint32_t k = 0; k < ins->nres; k++)
            made[ins->res[k]] = (struct made){i, t};
        done[i] = i && done[i - 1] >= t ? done[i - 1] + 1 : t;
    }
    return n ? (double)done[n - 1] - (double)n : 0;
}

// In instructions. Straight code is fetched once and for nothing else; a result of a row is stored and read again. The weight
// was chosen on the beams of tests/bench, of 10 to 100 elements (25 of 29 cases, one lane). With what waits, the faster one is taken in 38 of 46
// programs of beams and chains, for one lane and four; the times of those chosen are 2 % longer on average than of the faster ones.
static double cost_of(const struct ct_roll *r, double waiting)
{
    return (double)r->nstraight + 1.5 * (double)r->nresult + waiting;
}

// Where the nearest cache holds what rows leave, loops for themselves are as good.
static bool is_worth_a_try(const struct ct_roll *r, uint32_t lanes)
{
    const size_t nearest_cache = 32 << 10;
    return r->nloop > 1 && r->nresult * lanes * sizeof(double) > nearest_cache;
}

struct ct_roll ct_merge_loops(struct ct_arena *a, const struct ct_listing *l, uint32_t *order,
                              uint32_t n, uint32_t nfixed, const bool is_alone[CT_NKIND],
                              uint32_t nwork, uint32_t rows, uint32_t lanes)
{
    const struct ct_roll found = ct_roll_find(a, l, order, n, is_alone, nwork, rows, lanes);
    if (!is_worth_a_try(&found, lanes))
        return found;
    struct ct_arena *scratch = ct_arena_create_under(a);
    uint32_t *other = merged_order(scratch, l, order, n, nfixed, &found);
    const struct ct_roll merged = ct_roll_find(a, l, other, n, is_alone, nwork, rows, lanes);
    const bool is_better = cost_of(&merged, count_waiting(scratch, l, other, n))
                         < cost_of(&found, count_waiting(scratch, l, order, n));
    if (is_better)
        memcpy(order, other, n * sizeof *order);
    ct_arena_destroy(scratch);
    return is_better ? merged : found;
}
