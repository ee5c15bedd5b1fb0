// Detection of repetitions by a rolling hash (Rabin-Karp) of operators and of distances to near
// operands; see reroll_layout.h.
#include "codegen/reroll_layout.h"

static const uint32_t none = CT_VALUE_NONE;

// Window of the rolling hash, in instructions; distances to operands within the window are hashed.
// It affects the time only: a window ten times as long misses only loops with shorter rows; one a
// tenth as long gives more windows to compare. Limit: of the time of the search
enum { WINDOW = 16 };

static bool is_commutative(unsigned op)
{
    return op == CT_OP_ADD || op == CT_OP_MUL || op == CT_OP_FMA || op == CT_OP_FMS
        || op == CT_OP_FNMA;
}

// Age of v: 0 for constants and parameters, 1 for inputs, then results in the order of execution.
static uint32_t age(const struct ct_repetitions *p, uint32_t v)
{
    return p->at[v] != none ? p->at[v] + 2 : p->l->rate[v] == CT_RATE_CALL;
}

static void order_operands(struct ct_repetitions *p)
{
    for (uint32_t i = 0; i < p->n; i++) {
        const struct ct_instruction *ins = ct_repetition_instruction(p, i);
        p->is_swapped[i] = is_commutative(ins->op) && age(p, ins->arg[0]) < age(p, ins->arg[1]);
    }
}

static uint64_t mix(uint64_t h, uint64_t v)
{
    h = (h ^ v) * UINT64_C(0x9E3779B97F4A7C15);
    return h ^ h >> 29;
}

static void hash_instructions(struct ct_repetitions *p, const bool is_alone[CT_NKIND])
{
    for (uint32_t i = 0; i < p->n; i++) {
        const struct ct_instruction *ins = ct_repetition_instruction(p, i);
        uint64_t h = mix(ins->op, ins->nres);
        if (is_alone[ins->op] || ins->nres != 1)
            h = mix(h, (uint64_t)i + CT_NKIND);
        for (uint32_t k = 0; k < ins->narg; k++) {
            const uint32_t from = p->at[ct_repetition_operand(p, i, k)];
            h = mix(h, from != none && i - from < WINDOW ? i - from : 0);
        }
        p->sign[i] = h;
    }
}

static void link_windows(struct ct_repetitions *p)
{
    size_t size = 64;
    while (size < 2 * (size_t)p->n)
        size *= 2;
    uint32_t *last = CT_NEWN(p->scratch, uint32_t, size); // by hash: 1 + index
    // h = sum of sign[i + k] base^k over the window, updated for the next index. Definition: 2^64 /
    // golden ratio, odd
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

// Instructions that a loop adds to each row. Derived: at most one addition per stride, a comparison
// and a branch. The gain is about one instruction for each one that is not fetched.
enum { ADDED = CT_REROLL_STREAMS + 2 };

// The repetition at index i that saves most instructions. Rows beyond the size of the instruction
// cache gain nothing.
static struct ct_repetition best_repeat(const struct ct_repetitions *p, uint32_t i,
                                        uint32_t *longest)
{
    struct ct_repetition best = {.first = i};
    uint32_t saved = 0, c = p->again[i];
    while (c > i && c != none && c - i <= CT_REROLL_CACHED) {
        const uint32_t period = c - i;
        uint32_t same = 0;
        if (best.count
            && period % best.period == 0) { // a multiple of the best period saves less
            c = p->again[c];
            continue;
        }
        // the last of the fewest instructions that must be the same for a gain
        const uint32_t rest = (CT_LEAST_ROWS - 1) * period - 1,
                       end = rest > saved ? rest : saved;
        if (c + end >= p->n || p->sign[i + end] != p->sign[c + end]) {
            c = p->again[c];
            continue;
        }
        while (c + same < p->n && p->sign[i + same] == p->sign[c + same])
            same++;
        const uint32_t count = same / period + 1;
        if (count >= CT_LEAST_ROWS && (count - 1) * period > saved
            && (count - 1) * period > count * ADDED) {
            saved = (count - 1) * period;
            best.period = period;
            best.count = count;
            *longest = same;
        }
        c = p->again[c];
    }
    return best;
}

// Do fewer rows fill the SIMD lanes nearly as well (7/8) as before?
static bool fills_lanes(uint32_t rows, uint32_t before, uint32_t lanes)
{
    return 8 * (rows / lanes) >= 7 * (before / lanes);
}

// Choose the boundary between rows with the fewest live values across it. same: number of
// instructions that equal those one row earlier. Cost: two rows.
static void choose_row_boundary(const struct ct_repetitions *p, struct ct_repetition *r,
                                uint32_t same, uint32_t lanes)
{
    const uint32_t n = r->period, begin = r->first + (r->count / 2 - 1) * n;
    uint32_t *last = CT_NEWN(p->scratch, uint32_t, n);
    int32_t *across = CT_NEWN(p->scratch, int32_t,
                              2 * n + 1); // by index: change of the number of live values
    for (uint32_t place = begin; place < begin + 2 * n; place++)
        for (uint32_t k = 0; k < ct_repetition_instruction(p, place)->narg; k++) {
            const uint32_t from = p->at[ct_repetition_operand(p, place, k)];
            if (from != none && from >= begin && from < begin + n)
                last[from - begin] = place - begin;
        }
    for (uint32_t from = 0; from < n; from++)
        if (last[from]) {
            across[from + 1]++;
            across[last[from] + 1]--;
        }
    for (uint32_t i = 1; i < 2 * n; i++)
        across[i] += across[i - 1];
    uint32_t best = 0;
    for (uint32_t i = 1; i < n && i <= same; i++)
        if (across[i] + across[i + n] < across[best] + across[best + n]
            && fills_lanes((same - i) / n + 1, r->count, lanes))
            best = i;
    r->first += best;
    r->count = (same - best) / n + 1;
}

void ct_repetitions_find(struct ct_repetitions *p, const bool is_alone[CT_NKIND], uint32_t rows)
{
    order_operands(p);
    hash_instructions(p, is_alone);
    link_windows(p);
    for (uint32_t i = 0; i < p->n; i++)
        p->repetition_of[i] = none;
    for (uint32_t i = 0; i < p->n;) {
        uint32_t same = 0;
        struct ct_repetition r = best_repeat(p, i, &same);
        if (!r.count) {
            i++;
            continue;
        }
        if ((same - r.period) / r.period + 1 >= CT_LEAST_ROWS)
            choose_row_boundary(p, &r, same, rows);
        for (uint32_t k = 0; k < r.period * r.count; k++)
            p->repetition_of[r.first + k] = (uint32_t)p->nrepetition;
        i = r.first + r.period * r.count;
        CT_PUSH(p->arena, p->repetition, p->nrepetition, p->repetition_cap, r);
    }
}
