// Native code and lanes: the bits of the tape, on random graphs of all operators.
#include "codegen/native.h"
#include "expr/tape.h"
#include "random_ex.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double table_x[] = {-3, -1, 0, 1.5, 3}, table_y[] = {1, 2, 0, -1, 4},
                    table_m[] = {0.5, 0.1, -1, 0, 2};
static const struct ct_table tables[] = {{.n = 5, .x = table_x, .y = table_y},
                                         {.n = 5, .x = table_x, .y = table_y, .m = table_m}};

enum { NSYM = 12, NLANE = 8 };

struct fixture {
    struct ct_arena *arena;
    struct ct_exs x;
    ct_ex sym[NSYM]; // the even ones are parameters
    size_t slot[NSYM];
    double input[NLANE][NSYM];
};

static void start(struct fixture *f)
{
    *f = (struct fixture){.arena = ct_arena_create()};
    ct_exs_init(&f->x, f->arena);
    f->x.table = tables;
    f->x.ntable = COUNT(tables);
    for (size_t k = 0; k < NSYM; k++) {
        f->sym[k] = ct_ex_sym(&f->x, k % 2 ? CT_SYM_Q : CT_SYM_PARAM,
                              ct_arena_printf(f->arena, "s%zu", k), (uint32_t)k);
        f->slot[k] = NSYM - 1 - k;
    }
}

static void finish(struct fixture *f)
{
    ct_arena_destroy(f->arena);
}

// Now and then the numbers where comparisons, signs and minima are decided.
static double random_input(struct random *r)
{
    static const double odd[] = {0, -0.0, 1, -1, 1.0 / 0.0, -1.0 / 0.0, 5e-324};
    return random_below(r, 8) ? random_double(r) : odd[random_below(r, COUNT(odd))];
}

static void set_inputs(struct fixture *f, struct random *r, bool parameters)
{
    for (size_t lane = 0; lane < NLANE; lane++)
        for (size_t k = 0; k < NSYM; k++)
            if (parameters || k % 2)
                f->input[lane][f->slot[k]] = random_input(r);
}

static ct_ex *random_graph(struct fixture *f, struct random *r, size_t n, size_t back)
{
    ct_ex *e = CT_NEWN(f->arena, ct_ex, n + NSYM);
    memcpy(e, f->sym, sizeof f->sym);
    for (size_t k = NSYM; k < n + NSYM; k++) {
        const size_t from = k > back ? k - back : 0;
        e[k] = random_node(r, &f->x, e + from, k - from);
    }
    return e;
}

// All NaN count as one, their sign and payload depend on the instruction chosen.
static void assert_same(double got, double want, const char *who, size_t k)
{
    if (memcmp(&got, &want, sizeof got) && !(got != got && want != want))
        fail_msg("%s, output %zu: got %.17g, wanted %.17g", who, k, got, want);
}

// ---- each back end over all lanes ---------------------------------------------------------------

struct evaluator {
    const char *name;
    size_t lanes;
    const struct ct_tape *tape;
    const struct ct_native *native;
    double *input, *out, *work;
};

static void arrange(const struct fixture *f, struct evaluator *v, size_t first)
{
    for (size_t k = 0; k < NSYM; k++)
        for (size_t i = 0; i < v->lanes; i++)
            v->input[v->lanes * k + i] = f->input[first + i][k];
}

// Values of all lanes, want[NLANE * k + lane]; with `prepare` after new parameters.
static void evaluate(const struct fixture *f, struct evaluator *v, bool prepare, size_t nout,
                     double *got)
{
    for (size_t first = 0; first < NLANE; first += v->lanes) {
        arrange(f, v, first);
        if (prepare && v->tape)
            ct_tape_prepare_lanes(v->tape, (int)v->lanes, v->input, v->work);
        if (prepare && v->native)
            ct_native_prepare(v->native, v->input, v->work);
        if (v->tape)
            ct_tape_eval_lanes(v->tape, (int)v->lanes, v->input, v->out, v->work);
        else
            ct_native_eval(v->native, v->input, v->out, v->work);
        for (size_t k = 0; k < nout; k++)
            for (size_t i = 0; i < v->lanes; i++)
                got[NLANE * k + first + i] = v->out[v->lanes * k + i];
    }
}

static size_t list_evaluators(struct fixture *f, const struct ct_listing *l,
                              struct evaluator v[6])
{
    static const char *const name[]
        = {"tape", "tape x4", "tape x8", "native", "native x4", "native x8"};
    static const int lanes[] = {1, 4, 8, 1, 4, 8};
    const struct ct_tape *tape = ct_tape_create(f->arena, l);
    size_t n = 0;
    for (size_t i = 0; i < COUNT(lanes); i++) {
        v[n] = (struct evaluator){.name = name[i], .lanes = (size_t)lanes[i]};
        if (i < 3)
            v[n].tape = tape;
        else
            v[n].native = ct_native_create(f->arena, l, lanes[i]);
        if (!v[n].tape && !v[n].native)
            continue;
        const size_t nwork
            = v[n].tape ? v[n].lanes * ct_tape_work(tape) : ct_native_work(v[n].native);
        v[n].input = CT_NEWN(f->arena, double, v[n].lanes *NSYM);
        v[n].out = CT_NEWN(f->arena, double, v[n].lanes * l->nout);
        v[n].work = CT_NEWN(f->arena, double, nwork);
        n++;
    }
    return n;
}

// The tape of one lane is compared with the operators themselves in test_tape.c.
static void compare(struct fixture *f, struct random *r, const struct ct_listing *l)
{
    struct evaluator v[6];
    const size_t n = list_evaluators(f, l, v);
    double *want = CT_NEWN(f->arena, double, NLANE * l->nout),
           *got = CT_NEWN(f->arena, double, NLANE * l->nout);
    for (int round = 0; round < 4; round++) {
        set_inputs(f, r, true);
        evaluate(f, &v[0], true, l->nout, want);
        for (size_t i = 1; i < n; i++) {
            evaluate(f, &v[i], true, l->nout, got);
            for (size_t k = 0; k < NLANE * l->nout; k++)
                assert_same(got[k], want[k], v[i].name, k / NLANE);
        }
    }
}

static void check_graphs(struct random *r, int ngraph, size_t largest, enum ct_fuse fuse)
{
    for (int g = 0; g < ngraph; g++) {
        struct fixture f;
        start(&f);
        const size_t n = 1 + random_below(r, largest), nout = 1 + random_below(r, 40);
        const size_t back = random_below(r, 2) ? 30 : n + NSYM;
        ct_ex *e = random_graph(&f, r, n, back), *out = CT_NEWN(f.arena, ct_ex, nout);
        for (size_t k = 0; k < nout; k++)
            out[k] = e[k % 3 ? random_below(r, n + NSYM) : n + NSYM - 1 - random_below(r, 9)];
        compare(&f, r, ct_listing_create(f.arena, &f.x, out, nout, f.sym, f.slot, NSYM, fuse));
        finish(&f);
    }
}

static void all_back_ends_have_the_same_bits(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    check_graphs(&r, 2500, 60, CT_FUSE_NO);
    check_graphs(&r, 500, 600, CT_FUSE_NO);
}

static void also_with_fused_products(void **unused)
{
    (void)unused;
    if (getenv("CT_VALGRIND")) // its fused multiply-add loses the sign of some zeros
        skip();
    struct random r = random_start(__func__);
    check_graphs(&r, 500, 60, CT_FUSE_YES);
    check_graphs(&r, 200, 600, CT_FUSE_YES);
}

// Every operator alone, on all pairs of special numbers.
static void operators_have_the_bits_of_ct_op_apply(void **unused)
{
    (void)unused;
    static const double odd[] = {0, -0.0, 1, -1, 1.0 / 0.0, -1.0 / 0.0, 0.0 / 0.0, 2.5};
    struct random r = random_start(__func__);
    for (int op = CT_OP_ADD; op < CT_OP_TABLE; op++) {
        struct fixture f;
        start(&f);
        const ct_ex a = f.sym[1], b = f.sym[3], c = f.sym[5];
        const ct_ex e = op == CT_OP_IF           ? ct_ex_if(&f.x, a, b, c)
                      : ct_op_info[op].narg == 1 ? ct_ex_fun(&f.x, (enum ct_op)op, a)
                                                 : ct_ex_fun2(&f.x, (enum ct_op)op, a, b);
        const struct ct_listing *l
            = ct_listing_create(f.arena, &f.x, &e, 1, f.sym, f.slot, NSYM, CT_FUSE_NO);
        struct evaluator v[6];
        const size_t n = list_evaluators(&f, l, v);
        for (size_t i = 0; i < COUNT(odd); i++)
            for (size_t j = 0; j < COUNT(odd); j++) {
                double got[NLANE];
                set_inputs(&f, &r, true);
                f.input[0][f.slot[1]] = odd[i];
                f.input[0][f.slot[3]] = odd[j];
                for (size_t k = 0; k < n; k++) {
                    evaluate(&f, &v[k], true, 1, got);
                    assert_same(
                        got[0],
                        ct_op_apply((enum ct_op)op, odd[i], odd[j], f.input[0][f.slot[5]]),
                        ct_op_info[op].name, k);
                }
            }
        finish(&f);
    }
}

// A product read once, in a sum, is fused; a product read twice, or an output, is not.
static void only_lonely_products_are_fused(void **unused)
{
    (void)unused;
    struct fixture f;
    start(&f);
    struct ct_exs *x = &f.x;
    const ct_ex a = f.sym[1], b = f.sym[3], c = f.sym[5], d = f.sym[7];
    const ct_ex ab = ct_ex_mul(x, a, b), cd = ct_ex_mul(x, c, d), bd = ct_ex_mul(x, b, d);
    const ct_ex out[] = {ct_ex_add(x, ab, c), ct_ex_sub(x, d, cd), cd, ct_ex_sub(x, bd, a)};
    const struct ct_listing *l
        = ct_listing_create(f.arena, x, out, 4, f.sym, f.slot, NSYM, CT_FUSE_YES);
    assert_int_equal(l->nins, 4);
    int nfused = 0;
    for (size_t i = 0; i < l->nins; i++)
        nfused += l->ins[i].op == CT_OP_FMA || l->ins[i].op == CT_OP_FMS;
    assert_int_equal(nfused, 2);
    assert_int_equal(l->counts.multiplications, 3);
    assert_int_equal(l->counts.additions, 3);
    finish(&f);
}

static void same_listing_same_code(void **unused)
{
    (void)unused;
    if (!ct_native_is_available(1))
        skip();
    struct random r = random_start(__func__);
    struct fixture f;
    start(&f);
    ct_ex *e = random_graph(&f, &r, 2000, 50);
    const struct ct_listing *l
        = ct_listing_create(f.arena, &f.x, e + 1900, 100, f.sym, f.slot, NSYM, CT_FUSE_NO);
    const struct ct_native *p = ct_native_create(f.arena, l, 1),
                           *q = ct_native_create(f.arena, l, 1);
    assert_int_equal(ct_native_code_size(p), ct_native_code_size(q));
    assert_memory_equal(ct_native_code(p), ct_native_code(q), ct_native_code_size(p));
    finish(&f);
}

// ---- loops --------------------------------------------------------------------------------------

enum {
    NROW = 5000,
    ODD = 701
}; // so many that four lanes are rolled up, too; every ODD-th row does more

static ct_ex shift(struct ct_exs *x, int e)
{
    return ct_ex_const(x, 3 + 0.11 * e);
}

// A sweep forwards with a running sum and a neighbour, one backwards as a banded solve does it, a
// third that reads both; constants by row, parameters, what is the same in all rows. Of the
// constants some are older than what they are added to, without a period, which turns the operands
// of a sum round. out: 2 nrow + 1.
static void sweeps(struct ct_exs *x, int nrow, const ct_ex *q, ct_ex p, ct_ex *out)
{
    static ct_ex r[NROW], t[NROW], sum[NROW], y[NROW];
    const ct_ex all = ct_ex_fun(x, CT_OP_SIN, q[3 * nrow]);
    for (int e = 0; e < nrow; e++)
        if (__builtin_popcount((unsigned)e) % 2)
            shift(x, e);
    for (int e = 0; e < nrow; e++) {
        const ct_ex a = q[3 * e], b = q[3 * e + 1], c = q[3 * e + 2];
        r[e] = ct_ex_add(x, ct_ex_mul(x, a, b),
                         ct_ex_mul(x, ct_ex_const(x, 1 + 0.37 * e), ct_ex_add(x, c, p)));
        r[e] = ct_ex_add(x, r[e], shift(x, e));
        t[e] = ct_ex_sub(
            x, ct_ex_mul(x, r[e], a),
            ct_ex_div(x, ct_ex_mul(x, all, b), ct_ex_add(x, CT_EX_ONE, ct_ex_mul(x, c, c))));
        if (e)
            t[e] = ct_ex_add(x, t[e], ct_ex_mul(x, r[e - 1], b));
        if (e % ODD == 0)
            t[e] = ct_ex_fun(x, CT_OP_SQRT, ct_ex_add(x, CT_EX_ONE, ct_ex_mul(x, t[e], t[e])));
        sum[e] = ct_ex_add(x, e ? sum[e - 1] : p, ct_ex_mul(x, t[e], r[e]));
    }
    for (int e = nrow; e-- > 0;) {
        const ct_ex down = ct_ex_add(x, ct_ex_const(x, 2), ct_ex_mul(x, r[e], r[e]));
        const ct_ex next = e + 1 < nrow ? y[e + 1] : all;
        y[e] = ct_ex_div(x, ct_ex_sub(x, t[e], ct_ex_mul(x, next, q[3 * e])), down);
    }
    for (int e = 0; e < nrow; e++) {
        out[e] = y[e];
        out[nrow + e] = ct_ex_sub(x, ct_ex_mul(x, y[nrow - 1 - e], sum[e]),
                                  ct_ex_mul(x, sum[nrow - 1], t[e]));
    }
    out[2 * nrow] = sum[nrow - 1];
}

// Much work on few inputs, with constants by row, parameters, what is the same in all rows and a
// running sum over it; a second sweep that reads the first forwards and backwards. out: 2 nrow + 1.
static void heavy_rows(struct ct_exs *x, int nrow, const ct_ex *q, ct_ex p, ct_ex *out)
{
    static ct_ex v[NROW];
    const ct_ex all = ct_ex_fun(x, CT_OP_SIN, q[3 * nrow]);
    ct_ex sum = p;
    for (int e = 0; e < nrow; e++) {
        const ct_ex a = q[3 * e], b = q[3 * e + 1];
        v[e] = ct_ex_add(x, a, shift(x, e));
        for (int k = 0; k < 12; k++) {
            const ct_ex by = k % 3 ? ct_ex_const(x, 0.7 + k) : k % 2 ? p : all;
            v[e] = ct_ex_sub(x, ct_ex_mul(x, v[e], b), ct_ex_mul(x, by, a));
        }
        v[e] = ct_ex_div(x, v[e], ct_ex_add(x, CT_EX_ONE, ct_ex_mul(x, v[e], v[e])));
        sum = ct_ex_add(x, sum, ct_ex_mul(x, sum, v[e]));
        out[nrow + e] = ct_ex_add(x, ct_ex_fun(x, CT_OP_ABS, v[e]), ct_ex_mul(x, sum, b));
    }
    for (int e = 0; e < nrow; e++) {
        ct_ex w = ct_ex_sub(x, v[nrow - 1 - e], q[3 * e + 2]);
        for (int k = 0; k < 12; k++)
            w = ct_ex_sub(x, ct_ex_mul(x, w, v[e]), k % 2 ? all : p);
        out[e] = ct_ex_mul(x, w, sum);
    }
    out[2 * nrow] = sum;
}

// Rows are done four at a time: the code leaves the upper halves of registers clean.
static bool has_rows_together(const struct ct_native *f)
{
    const unsigned char *code = ct_native_code(f);
    for (size_t i = 0; i + 3 <= ct_native_code_size(f); i++)
        if (code[i] == 0xC5 && code[i + 1] == 0xF8 && code[i + 2] == 0x77)
            return true;
    return false;
}

typedef void (*rows_fn)(struct ct_exs *x, int nrow, const ct_ex *q, ct_ex p, ct_ex *out);

static void have_the_same_bits(rows_fn rows, int nrow, bool together)
{
    enum { NIN = 3 * NROW + 2, NOUT = 2 * NROW + 1, MOST = 4 };
    const size_t nin = 3 * (size_t)nrow + 2, nout = 2 * (size_t)nrow + 1;
    static ct_ex q[NIN], out[NOUT];
    static size_t slot[NIN];
    static double input[MOST * NIN], want[NOUT], alone[NIN], got[MOST * NOUT];
    struct random r = random_start(__func__);
    struct ct_arena *a = ct_arena_create();
    struct ct_exs x;
    ct_exs_init(&x, a);
    for (size_t i = 0; i < nin; i++) {
        q[i] = ct_ex_sym(&x, i + 1 < nin ? CT_SYM_Q : CT_SYM_PARAM, "q", (uint32_t)i);
        slot[i] = i;
    }
    rows(&x, nrow, q, q[nin - 1], out);
    const struct ct_listing *l = ct_listing_create(a, &x, out, nout, q, slot, nin, CT_FUSE_NO);
    const struct ct_tape *tape = ct_tape_create(a, l);
    double *work = CT_NEWN(a, double, ct_tape_work(tape) + 1);
    for (int lanes = 1; lanes <= MOST; lanes += 3) {
        const struct ct_native *f = ct_native_create(a, l, lanes);
        if (!f)
            continue;
        const size_t straight = 6;      // bytes of an instruction at least
        if (lanes == 1 || nrow == NROW) // shorter ones stay straight in four lanes
            assert_true(ct_native_code_size(f) < straight * l->nins);
        if (lanes == 1 && ct_native_is_available(4))
            assert_true(has_rows_together(f) == together);
        for (size_t i = 0; i < (size_t)lanes * nin; i++)
            input[i] = random_double(&r);
        double *mine = CT_NEWN(a, double, ct_native_work(f) + 1);
        ct_native_prepare(f, input, mine);
        for (int again = 0; again < 2; again++) // nothing is left behind
            ct_native_eval(f, input, got, mine);
        for (int lane = 0; lane < lanes; lane++) {
            for (size_t i = 0; i < nin; i++)
                alone[i] = input[(size_t)lanes * i + (size_t)lane];
            ct_tape_prepare(tape, alone, work);
            ct_tape_eval(tape, alone, want, work);
            for (size_t k = 0; k < nout; k++)
                assert_same(got[(size_t)lanes * k + (size_t)lane], want[k], "native", k);
        }
    }
    ct_arena_destroy(a);
}

static void loops_have_the_same_bits(void **unused)
{
    (void)unused;
    have_the_same_bits(sweeps, NROW, false);
    have_the_same_bits(heavy_rows, NROW,
                       true); // in strips: all rows are more than the nearest cache holds
    for (int nrow = 200; nrow < 204; nrow++) // with each number of rows left over
        have_the_same_bits(heavy_rows, nrow, true);
}

// Bytes of code of rows that do the same on q, but in the first and the last one on something else;
// and whether their results are those of the tape.
static size_t size_of_rows(bool first_differs, bool last_differs)
{
    enum { NIN = 3 * NROW + 2 };
    static ct_ex q[NIN], out[NROW];
    static size_t slot[NIN];
    static double input[NIN], want[NROW], got[NROW];
    struct random r = random_start(__func__);
    struct ct_arena *a = ct_arena_create();
    struct ct_exs x;
    ct_exs_init(&x, a);
    for (size_t i = 0; i < NIN; i++) {
        q[i] = ct_ex_sym(&x, i + 1 < NIN ? CT_SYM_Q : CT_SYM_PARAM, "q", (uint32_t)i);
        slot[i] = i;
        input[i] = random_double(&r);
    }
    const ct_ex all = ct_ex_mul(&x, q[NIN - 2], q[NIN - 2]);
    for (int e = 0; e < NROW; e++) {
        const bool differs = (e == 0 && first_differs) || (e == NROW - 1 && last_differs);
        const ct_ex sum = ct_ex_add(&x, ct_ex_mul(&x, q[3 * e], q[3 * e + 2]), q[3 * e + 1]);
        out[e] = ct_ex_mul(&x, sum, differs ? q[NIN - 1] : all);
    }
    const struct ct_listing *l = ct_listing_create(a, &x, out, NROW, q, slot, NIN, CT_FUSE_NO);
    const struct ct_tape *tape = ct_tape_create(a, l);
    const struct ct_native *f = ct_native_create(a, l, 1);
    double *work = CT_NEWN(a, double, ct_tape_work(tape) + 1),
           *mine = CT_NEWN(a, double, ct_native_work(f) + 1);
    ct_tape_prepare(tape, input, work);
    ct_tape_eval(tape, input, want, work);
    ct_native_prepare(f, input, mine);
    ct_native_eval(f, input, got, mine);
    for (size_t k = 0; k < NROW; k++)
        assert_same(got[k], want[k], "native", k);
    const size_t size = ct_native_code_size(f);
    ct_arena_destroy(a);
    return size;
}

static void rows_at_the_ends_may_differ(void **unused)
{
    (void)unused;
    if (!ct_native_is_available(1))
        skip();
    const size_t same = size_of_rows(false, false), row = 200; // bytes of a few rows at most
    assert_true(size_of_rows(true, false) < same + row);
    assert_true(size_of_rows(false, true) < same + row);
    assert_true(size_of_rows(true, true) < same + row);
}

// Programs of less than 256 instructions have the bits of the tape; longer ones are fused.
static void long_programs_alone_are_fused(void **state)
{
    (void)state;
    for (int n = 100; n <= 200; n += 100) { // two instructions each
        struct fixture f;
        start(&f);
        ct_ex e = f.sym[1];
        for (int k = 0; k < n; k++)
            e = ct_ex_add(&f.x, ct_ex_mul(&f.x, e, f.sym[3 + 2 * (k % 3)]),
                          f.sym[9 + 2 * (k % 2)]);
        const struct ct_listing *l
            = ct_listing_create(f.arena, &f.x, &e, 1, f.sym, f.slot, NSYM, CT_FUSE_NATIVE);
        const struct ct_tape *tape = ct_tape_create(f.arena, l);
        const struct ct_native *native = ct_native_create(f.arena, l, 1);
        double *work = CT_NEWN(f.arena, double, ct_tape_work(tape) + 1), want[1], got[1];
        bool is_same = true;
#ifdef __x86_64__
        const bool can_fuse = native && __builtin_cpu_supports("fma");
        double *room = CT_NEWN(f.arena, double, can_fuse ? ct_native_work(native) + 1 : 1);
        for (int i = 0; i < 20 && can_fuse; i++) {
            double input[NSYM];
            for (size_t k = 0; k < NSYM; k++)
                input[k] = 0.9 + 0.013 * (double)k + 0.0017 * i;
            ct_tape_prepare(tape, input, work);
            ct_tape_eval(tape, input, want, work);
            ct_native_prepare(native, input, room);
            ct_native_eval(native, input, got, room);
            is_same = is_same && memcmp(got, want, sizeof got) == 0;
        }
        assert_true(is_same == (n == 100) || !can_fuse);
#else
        (void)native, (void)want, (void)got, (void)is_same;
#endif
        finish(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(operators_have_the_bits_of_ct_op_apply),
        cmocka_unit_test(all_back_ends_have_the_same_bits),
        cmocka_unit_test(also_with_fused_products),
        cmocka_unit_test(only_lonely_products_are_fused),
        cmocka_unit_test(same_listing_same_code),
        cmocka_unit_test(loops_have_the_same_bits),
        cmocka_unit_test(rows_at_the_ends_may_differ),
        cmocka_unit_test(long_programs_alone_are_fused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
