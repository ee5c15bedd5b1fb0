// Loops of native code: random sweeps over rows have the bits of the tape, in strips and side by
// side.
#include "codegen/reroll.h"
#include "codegen/native.h"
#include "expr/tape.h"
#include "random_ex.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST_ROWS = 1100, MOST_SWEEPS = 6, MOST_STEPS = 60, MOST_KEPT = 4, PER_ROW = 3 };
enum { NIN = PER_ROW * MOST_ROWS + 2, NGUARD = 16 };

// ---- programs -----------------------------------------------------------------------------------

// Where a step of a row takes an operand from.
struct operand {
    enum { STEP, INPUT, CONSTANT, SAME, RESULT, MIRRORED, OWN, NKIND } kind;
    size_t at, sweep; // step, input, constant; result of an earlier sweep, of the row before
    int shift;        // rows
};

struct step {
    enum ct_op op;
    struct operand a, b;
};

// All rows of a sweep do the same steps; the last nkept ones are what others read.
struct sweep {
    bool backwards;
    size_t nstep, nkept;
    struct step step[MOST_STEPS];
};

struct program {
    struct ct_arena *arena;
    struct ct_exs x;
    size_t nrow, nsweep;
    struct sweep sweep[MOST_SWEEPS];
    ct_ex q[NIN], same; // q: the last one is a parameter
    size_t slot[NIN];
    ct_ex kept[MOST_SWEEPS][MOST_ROWS][MOST_KEPT];
    ct_ex out[MOST_SWEEPS * MOST_ROWS];
    size_t nout;
    const struct ct_listing *listing;
};

static struct operand random_operand(struct random *r, const struct program *p, size_t sweep,
                                     size_t step)
{
    struct operand o = {.kind = (int)random_below(r, NKIND)};
    if (step && random_below(r, 2))
        o.kind = STEP;
    if ((o.kind == STEP && !step) || ((o.kind == RESULT || o.kind == MIRRORED) && !sweep)
        || (o.kind == OWN && random_below(r, 8)))
        o.kind = INPUT;
    o.shift = (int)random_below(r, 3) - 1;
    if (o.kind == STEP)
        o.at = step - 1 - random_below(r, step < 8 ? step : 8);
    else if (o.kind == RESULT || o.kind == MIRRORED)
        o.at = random_below(r, p->sweep[o.sweep = random_below(r, sweep)].nkept);
    else if (o.kind == OWN)
        o.at = random_below(r, p->sweep[sweep].nkept);
    else
        o.at = random_below(r, PER_ROW);
    return o;
}

static void draw_sweep(struct random *r, struct program *p, size_t k)
{
    static const enum ct_op op[] = {CT_OP_ADD, CT_OP_SUB, CT_OP_MUL, CT_OP_MUL, CT_OP_MIN};
    struct sweep *s = &p->sweep[k];
    s->backwards = random_below(r, 3) == 0;
    s->nkept = 1 + random_below(r, MOST_KEPT);
    s->nstep = s->nkept + 12 + random_below(r, MOST_STEPS - MOST_KEPT - 12);
    for (size_t i = 0; i < s->nstep; i++) {
        s->step[i] = (struct step){.op = op[random_below(r, COUNT(op))],
                                   .a = random_operand(r, p, k, i),
                                   .b = random_operand(r, p, k, i)};
        if (i) // nothing is left out
            s->step[i].a = (struct operand){.kind = STEP, .at = i - 1};
    }
}

// Rows beyond the ends are what all rows have in common, or the parameter.
static ct_ex result_at(const struct program *p, size_t sweep, long row, size_t at)
{
    if (row < 0)
        return p->same;
    return row < (long)p->nrow ? p->kept[sweep][row][at] : p->q[NIN - 1];
}

static ct_ex value_of(struct program *p, const struct operand *o, size_t sweep, size_t row,
                      const ct_ex *step)
{
    const long at = (long)row + o->shift;
    switch (o->kind) {
    case STEP:
        return step[o->at];
    case INPUT:
        return p->q[PER_ROW * row + o->at];
    case CONSTANT:
        return ct_ex_const(&p->x, 0.5 + 0.01 * (double)(row * PER_ROW + o->at));
    case RESULT:
        return result_at(p, o->sweep, at, o->at);
    case MIRRORED:
        return result_at(p, o->sweep, (long)p->nrow - 1 - at, o->at);
    case OWN:
        return result_at(p, sweep, (long)row + (p->sweep[sweep].backwards ? 1 : -1), o->at);
    default:
        return p->same;
    }
}

static void make_sweep(struct program *p, size_t k)
{
    const struct sweep *s = &p->sweep[k];
    ct_ex step[MOST_STEPS];
    for (size_t i = 0; i < p->nrow; i++) {
        const size_t row = s->backwards ? p->nrow - 1 - i : i;
        for (size_t n = 0; n < s->nstep; n++) {
            const ct_ex a = value_of(p, &s->step[n].a, k, row, step),
                        b = value_of(p, &s->step[n].b, k, row, step);
            step[n] = s->step[n].op == CT_OP_ADD ? ct_ex_add(&p->x, a, b)
                    : s->step[n].op == CT_OP_SUB ? ct_ex_sub(&p->x, a, b)
                    : s->step[n].op == CT_OP_MUL // never a product of products
                        ? ct_ex_sub(&p->x, p->same, ct_ex_mul(&p->x, a, b))
                        : ct_ex_fun2(&p->x, CT_OP_MIN, a, b);
        }
        for (size_t n = 0; n < s->nkept; n++)
            p->kept[k][row][n] = step[s->nstep - s->nkept + n];
        p->out[p->nout++] = step[s->nstep - 1];
    }
}

static void start(struct program *p, size_t nrow, size_t nsweep)
{
    *p = (struct program){.arena = ct_arena_create(), .nrow = nrow, .nsweep = nsweep};
    ct_exs_init(&p->x, p->arena);
    for (size_t i = 0; i < NIN; i++) {
        p->q[i] = ct_ex_sym(&p->x, i + 1 < NIN ? CT_SYM_Q : CT_SYM_PARAM, "q", (uint32_t)i);
        p->slot[i] = i;
    }
    p->same = ct_ex_fun(&p->x, CT_OP_SIN, p->q[NIN - 2]);
}

static void finish(struct program *p)
{
    for (size_t k = 0; k < p->nsweep; k++)
        make_sweep(p, k);
    p->listing
        = ct_listing_create(p->arena, &p->x, p->out, p->nout, p->q, p->slot, NIN, CT_FUSE_NO);
}

// ---- tests --------------------------------------------------------------------------------------

static void assert_same_bits(const struct program *p, size_t lanes, struct random *r)
{
    enum { MOST_LANES = 4 };
    static double input[MOST_LANES * NIN], want[MOST_LANES * MOST_SWEEPS * MOST_ROWS],
        got[COUNT(want)];
    const struct ct_tape *tape = ct_tape_create(p->arena, p->listing);
    const struct ct_native *native = ct_native_create(p->arena, p->listing, (int)lanes);
    double *work = CT_NEWN(p->arena, double, lanes *ct_tape_work(tape) + 1),
           *mine = CT_NEWN(p->arena, double, ct_native_work(native) + NGUARD);
    double *const behind = mine + ct_native_work(native);
    for (size_t i = 0; i < NGUARD; i++)
        behind[i] = 1e9 + (double)i;
    for (size_t i = 0; i < lanes * NIN; i++)
        input[i] = random_double(r);
    ct_tape_prepare_lanes(tape, (int)lanes, input, work);
    ct_native_prepare(native, input, mine);
    for (int again = 0; again < 2; again++) { // nothing is left behind
        for (size_t i = 0; i < lanes * (NIN - 1); i++)
            input[i] = random_double(r) / 4;
        ct_tape_eval_lanes(tape, (int)lanes, input, want, work);
        ct_native_eval(native, input, got, mine);
        for (size_t k = 0; k < lanes * p->nout; k++)
            if (memcmp(&want[k], &got[k], sizeof *want)
                && (want[k] == want[k] || got[k] == got[k]))
                fail_msg("%zu lanes, %zu rows, %zu sweeps, output %zu: %.17g, wanted %.17g",
                         lanes, p->nrow, p->nsweep, k / lanes, got[k], want[k]);
    }
    for (size_t i = 0; i < NGUARD; i++) // nothing is written behind the work array
        assert_true(behind[i] == 1e9 + (double)i);
}

static void random_sweeps_have_the_bits_of_the_tape(void **unused)
{
    (void)unused;
    if (!ct_native_is_available(1))
        skip();
    struct random r = random_start(__func__);
    struct program *p = malloc(sizeof *p);
    for (int n = 0; n < 150; n++) {
        start(p, 12 + random_below(&r, n % 4 ? 120 : MOST_ROWS - 12),
              2 + random_below(&r, MOST_SWEEPS - 1));
        for (size_t k = 0; k < p->nsweep; k++)
            draw_sweep(&r, p, k);
        finish(p);
        for (size_t lanes = 1; lanes <= 4 && ct_native_is_available((int)lanes); lanes += 3)
            assert_same_bits(p, lanes, &r);
        ct_arena_destroy(p->arena);
    }
    free(p);
}

// So many steps from a first operand, each behind the last one; nothing repeats within a row.
static void set_steps(struct sweep *s, size_t nstep, struct operand first)
{
    s->nstep = nstep;
    s->nkept = 1;
    for (size_t i = 0; i < nstep; i++)
        s->step[i] = (struct step){
            .op = i * i % 7 < 3 ? CT_OP_ADD : CT_OP_MUL,
            .a = i ? (struct operand){.kind = STEP, .at = i - 1} : first,
            .b = {.kind = i % 8 ? STEP : INPUT, .at = i % 8 ? i / 2 : i % PER_ROW}};
}

static struct ct_reroll loops_of(const struct program *p, uint32_t rows, uint32_t lanes)
{
    const struct ct_listing *l = p->listing;
    const uint32_t n = (uint32_t)(l->nins - l->nprologue);
    uint32_t *order = CT_NEWN(p->arena, uint32_t, n);
    const bool is_alone[CT_NKIND] = {false};
    for (uint32_t i = 0; i < n; i++)
        order[i] = (uint32_t)l->nprologue + i;
    return ct_reroll_find(p->arena, l, order, n, is_alone, 0, rows, lanes);
}

// Side by side but for a running sum; what the sum alone reads has places for one strip.
static void many_rows_are_done_in_strips(void **unused)
{
    (void)unused;
    struct program *p = malloc(sizeof *p);
    start(p, 100, 1);
    set_steps(&p->sweep[0], 40, (struct operand){.kind = SAME});
    p->sweep[0].step[39].b = (struct operand){.kind = OWN};
    finish(p);
    const struct ct_reroll r = loops_of(p, 4, 1);
    assert_int_equal(r.nloop, 2);
    assert_true(r.loop[0].is_vectorized && !r.loop[1].is_vectorized);
    assert_int_equal(r.loop[0].nslot + r.loop[1].nslot, r.loop[0].period);
    assert_true(r.loop[0].strip > 0 && r.loop[0].strip < r.loop[0].count);
    uint32_t nlocal = 0;
    for (uint32_t i = 0; i < r.loop[0].nslot; i++)
        nlocal += r.loop[0].result[i].reach == CT_REACH_STRIP;
    assert_true(nlocal > 0);
    ct_arena_destroy(p->arena);
    free(p);
}

static uint32_t count_results(const struct ct_loop *loop, enum ct_reach reach)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < loop->nslot; i++)
        n += loop->result[i].reach == reach;
    return n;
}

// In lanes: what the next row alone reads has one place, what it reads too late for that one a row;
// outputs are stored where they belong; constants by row are one double for all lanes.
static void rows_leave_little_in_memory(void **unused)
{
    (void)unused;
    struct program *p = malloc(sizeof *p);
    start(p, 100, 1);
    set_steps(&p->sweep[0], 40, (struct operand){.kind = SAME});
    p->sweep[0].nkept = 3;
    p->sweep[0].step[1].b = (struct operand){.kind = OWN, .at = 1};
    p->sweep[0].step[38].b = (struct operand){.kind = OWN, .at = 0};
    p->sweep[0].step[9].b = (struct operand){.kind = CONSTANT, .at = 1};
    finish(p);
    const struct ct_reroll r = loops_of(p, 1, 4);
    assert_int_equal(r.nloop, 1);
    assert_int_equal(count_results(&r.loop[0], CT_REACH_PLACE), 1);
    assert_int_equal(count_results(&r.loop[0], CT_REACH_WORK), 1);
    assert_int_equal(count_results(&r.loop[0], CT_REACH_OUT), 1);
    uint32_t nnumber = 0;
    for (uint32_t i = 0; i < 3 * r.loop[0].nslot; i++)
        nnumber += r.loop[0].operand[i].reach == CT_REACH_NUMBER;
    assert_true(nnumber > 0);
    for (size_t i = 0; i < r.ntable; i++)
        assert_true(r.table[i].is_number);
    ct_arena_destroy(p->arena);
    free(p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_sweeps_have_the_bits_of_the_tape),
        cmocka_unit_test(many_rows_are_done_in_strips),
        cmocka_unit_test(rows_leave_little_in_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
