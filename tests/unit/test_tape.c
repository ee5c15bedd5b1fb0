// The tape agrees with the slow evaluator to the bit and runs no more than it needs.
#include "expr/sincos.h"
#include "expr/tape.h"
#include "random_ex.h"
#include "tests/check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static const double table_x[] = {-3, -1, 0, 1.5, 3}, table_y[] = {1, 2, 0, -1, 4},
                    table_m[] = {0.5, 0.1, -1, 0, 2};
static const struct ct_table tables[] = {{.n = 5, .x = table_x, .y = table_y},
                                         {.n = 5, .x = table_x, .y = table_y, .m = table_m}};

struct fixture {
    struct ct_arena *arena;
    struct ct_exs x;
    ct_ex sym[8]; // the even ones are parameters
    double input[16], value[8];
    size_t slot[8]; // symbol k is input 2 (7 - k) + 1
};

static void set_inputs(struct fixture *f, struct random *r)
{
    for (size_t k = 0; k < 8; k++)
        f->value[k] = f->input[f->slot[k]] = random_double(r);
}

static void start(struct fixture *f, struct random *r)
{
    *f = (struct fixture){.arena = ct_arena_create()};
    ct_exs_init(&f->x, f->arena);
    f->x.table = tables;
    f->x.ntable = COUNT(tables);
    for (size_t k = 0; k < 8; k++) {
        f->sym[k] = ct_ex_sym(&f->x, k % 2 ? CT_SYM_Q : CT_SYM_PARAM,
                              ct_arena_printf(f->arena, "s%zu", k), (uint32_t)k);
        f->slot[k] = 2 * (7 - k) + 1;
    }
    set_inputs(f, r);
}

static void finish(struct fixture *f)
{
    ct_arena_destroy(f->arena);
}

// Nodes that a listing takes by ct_sincos.
static bool *find_angles(struct fixture *f, const struct ct_listing *l)
{
    bool *is_angle = CT_NEWN(f->arena, bool, f->x.nnode);
    for (size_t i = l->nprologue; i < l->nins; i++)
        for (uint32_t k = 0; k < l->ins[i].nres; k++)
            is_angle[l->node[l->ins[i].res[k]]]
                = l->ins[i].op >= CT_OP_ANGLE_SIN && l->ins[i].op <= CT_OP_ANGLE_SINCOS;
    return is_angle;
}

static double wave(uint32_t op, double angle)
{
    double s, c;
    ct_sincos(angle, &s, &c);
    return op == CT_OP_SIN ? s : c;
}

// All nodes by the operator rules alone, each once: ct_ex_value would walk the tree.
static double *all_values(struct fixture *f, const bool *is_angle)
{
    double *v = CT_NEWN(f->arena, double, f->x.nnode), c;
    for (uint32_t id = 0; id < f->x.nnode; id++) {
        const struct ct_exnode *n = &f->x.node[id];
        if (ct_ex_is_const(&f->x, (ct_ex){id}, &c))
            v[id] = c;
        else if (n->op == CT_OP_SYM)
            v[id] = f->value[n->a];
        else if (n->op == CT_OP_TABLE)
            v[id] = ct_table_value(&tables[n->b], n->c, v[n->a]);
        else if (is_angle[id])
            v[id] = wave(n->op, v[n->a]);
        else
            v[id] = ct_op_apply((enum ct_op)n->op, v[n->a],
                                ct_op_info[n->op].narg > 1 ? v[n->b] : 0,
                                ct_op_info[n->op].narg > 2 ? v[n->c] : 0);
    }
    return v;
}

// Same bits; all NaN count as one, their sign and payload depend on the instruction chosen.
static void assert_same(double got, double want)
{
    if (memcmp(&got, &want, sizeof got) && !(got != got && want != want))
        fail_msg("got %.17g, wanted %.17g", got, want);
}

static ct_ex *random_graph(struct fixture *f, struct random *r, size_t n)
{
    ct_ex *e = CT_NEWN(f->arena, ct_ex, n + 8);
    memcpy(e, f->sym, sizeof f->sym);
    for (size_t k = 8; k < n + 8; k++)
        e[k] = random_node(r, &f->x, e, k);
    return e;
}

static struct ct_tape *compile(struct fixture *f, const ct_ex *out, size_t nout)
{
    return ct_tape_compile(f->arena, &f->x, out, nout, f->sym, f->slot, 8);
}

static void random_graphs_have_the_bits_of_the_operators(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    for (int round = 0; round < 300; round++) {
        struct fixture f;
        start(&f, &r);
        size_t n = 1 + random_below(&r, 400), nout = 1 + random_below(&r, 30);
        ct_ex *e = random_graph(&f, &r, n), out[30];
        for (size_t k = 0; k < nout; k++)
            out[k] = e[8 + random_below(&r, n)];
        const struct ct_listing *l
            = ct_listing_create(f.arena, &f.x, out, nout, f.sym, f.slot, 8, CT_FUSE_NO);
        struct ct_tape *t = ct_tape_create(f.arena, l);
        const bool *is_angle = find_angles(&f, l);
        double *w = CT_NEWN(f.arena, double, ct_tape_work(t)), got[30];
        ct_tape_prepare(t, f.input, w);
        for (int call = 0; call < 3; call++) {
            double *want = all_values(&f, is_angle);
            ct_tape_eval(t, f.input, got, w);
            for (size_t k = 0; k < nout; k++)
                assert_same(got[k], want[out[k].id]);
            // only coordinates move: the prologue is not run again
            for (size_t k = 1; k < 8; k += 2)
                f.value[k] = f.input[f.slot[k]] = random_double(&r);
        }
        set_inputs(&f, &r);
        ct_tape_prepare(t, f.input, w);
        double *want = all_values(&f, is_angle);
        ct_tape_eval(t, f.input, got, w);
        for (size_t k = 0; k < nout; k++)
            assert_same(got[k], want[out[k].id]);
        finish(&f);
    }
}

static void small_graphs_have_the_bits_of_ct_ex_value(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    for (int round = 0; round < 300; round++) {
        struct fixture f;
        start(&f, &r);
        ct_ex *e = random_graph(&f, &r, 20);
        struct ct_tape *t = compile(&f, e, 28);
        double *w = CT_NEWN(f.arena, double, ct_tape_work(t)), got[28];
        ct_tape_prepare(t, f.input, w);
        ct_tape_eval(t, f.input, got, w);
        for (size_t k = 0; k < 28; k++)
            assert_same(got[k], ct_ex_value(&f.x, e[k], f.value));
        finish(&f);
    }
}

// Several angles are taken at once, but not one that is a sine itself.
static void sines_of_sines_beside_other_angles_are_right(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    struct fixture f;
    start(&f, &r);
    ct_ex out[10] = {0}; // sine and cosine of three symbols, of a sine, and of a sine of a sine
    for (size_t k = 0; k < 10; k++) {
        const ct_ex angle = k < 6 ? f.sym[k / 2 * 2 + 1] : k < 8 ? out[0] : out[6];
        out[k] = ct_ex_fun(&f.x, k % 2 ? CT_OP_COS : CT_OP_SIN, angle);
    }
    const struct ct_listing *l
        = ct_listing_create(f.arena, &f.x, out, 10, f.sym, f.slot, 8, CT_FUSE_NO);
    struct ct_tape *t[] = {ct_tape_create(f.arena, l),
                           ct_tape_create(f.arena, ct_listing_for_lanes(f.arena, l))};
    for (size_t i = 0; i < COUNT(t); i++) {
        double *w = CT_NEWN(f.arena, double, ct_tape_work(t[i])), got[10];
        ct_tape_prepare(t[i], f.input, w);
        for (int call = 0; call < 2; call++) { // slots hold values of the call before
            f.input[f.slot[1]] = f.value[1] = random_double(&r);
            ct_tape_eval(t[i], f.input, got, w);
            for (size_t k = 0; k < 10; k++)
                CHECK_CLOSE(got[k], ct_ex_value(&f.x, out[k], f.value), 1e-15, 1e-15);
        }
    }
    finish(&f);
}

static void outputs_may_be_inputs_constants_and_repeated(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    struct fixture f;
    start(&f, &r);
    ct_ex s = ct_ex_fun(&f.x, CT_OP_SIN, f.sym[1]);
    const ct_ex out[]
        = {f.sym[1], f.sym[0], ct_ex_const(&f.x, 2.5), CT_EX_ZERO, s, f.sym[1], s};
    struct ct_tape *t = compile(&f, out, COUNT(out));
    double *w = CT_NEWN(f.arena, double, ct_tape_work(t)), got[COUNT(out)];
    ct_tape_prepare(t, f.input, w);
    for (int call = 0; call < 2; call++) {
        ct_tape_eval(t, f.input, got, w);
        for (size_t k = 0; k < COUNT(out); k++)
            assert_same(got[k], ct_ex_value(&f.x, out[k], f.value));
    }
    finish(&f);
}

static void no_outputs_need_nothing(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    struct fixture f;
    start(&f, &r);
    struct ct_tape *t = ct_tape_compile(f.arena, &f.x, NULL, 0, NULL, NULL, 0);
    assert_int_equal(ct_tape_work(t), 0);
    ct_tape_prepare(t, NULL, NULL);
    ct_tape_eval(t, NULL, NULL, NULL);
    finish(&f);
}

static void unused_inputs_and_dead_nodes_take_no_room(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    struct fixture f;
    start(&f, &r);
    random_graph(&f, &r, 1000);
    ct_ex e = ct_ex_mul(&f.x, f.sym[1], f.sym[3]);
    struct ct_tape *t = compile(&f, &e, 1);
    assert_int_equal(ct_tape_work(t), 2); // the product overwrites a factor
    finish(&f);
}

static void parameters_are_free_and_pairs_count_twice(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    struct fixture f;
    start(&f, &r);
    struct ct_exs *x = &f.x;
    ct_ex p = ct_ex_mul(x, f.sym[0], ct_ex_add(x, f.sym[2], f.sym[4])); // free
    ct_ex s = ct_ex_fun(x, CT_OP_SIN, f.sym[1]), c = ct_ex_fun(x, CT_OP_COS, f.sym[1]);
    ct_ex e = ct_ex_sub(x, ct_ex_mul(x, p, s), ct_ex_div(x, c, f.sym[3]));
    ct_ex out[] = {e, ct_ex_neg(x, s)};
    const struct ct_tape_counts all[]
        = {ct_ex_count(f.arena, x, out, 2), ct_tape_counts(compile(&f, out, 2))};
    for (size_t k = 0; k < 2; k++) {
        assert_int_equal(all[k].multiplications, 1);
        assert_int_equal(all[k].additions, 1);
        assert_int_equal(all[k].divisions, 1);
        assert_int_equal(all[k].functions, 2);
    }
    finish(&f);
}

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// n nodes over recent ones, the shape recursions have: every node is used a few times, soon. Nodes
// are kept small by the sines, so that the bits stay finite.
static ct_ex *layered_graph(struct fixture *f, struct random *r, size_t n)
{
    ct_ex *e = CT_NEWN(f->arena, ct_ex, n + 8);
    memcpy(e, f->sym, sizeof f->sym);
    for (size_t k = 8; k < n + 8; k++) {
        size_t back = k < 100 ? k : 100;
        ct_ex a = e[k - 1 - random_below(r, back)], b = e[k - 1 - random_below(r, back)];
        if (k % 8 == 0) // keeps all symbols alive
            b = f->sym[random_below(r, 8)];
        static const enum ct_op op[] = {CT_OP_ADD, CT_OP_SUB, CT_OP_MUL, CT_OP_MUL};
        e[k] = k % 50 ? ct_ex_fun2(&f->x, op[random_below(r, 4)], a, b)
                      : ct_ex_fun(&f->x, k % 100 ? CT_OP_SIN : CT_OP_COS, a);
    }
    return e;
}

static double time_of_compile(struct random *r, size_t n, bool measure)
{
    struct fixture f;
    start(&f, r);
    ct_ex *e = layered_graph(&f, r, n), *out = e + n + 8 - 50;
    double t0 = seconds();
    struct ct_tape *t = compile(&f, out, 50);
    double compiling = seconds() - t0;
    const bool *is_angle = find_angles(
        &f, ct_listing_create(f.arena, &f.x, out, 50, f.sym, f.slot, 8, CT_FUSE_NO));
    double *w = CT_NEWN(f.arena, double, ct_tape_work(t)), got[50];
    double *want = all_values(&f, is_angle);
    ct_tape_prepare(t, f.input, w);
    ct_tape_eval(t, f.input, got, w);
    for (size_t k = 0; k < 50; k++)
        assert_same(got[k], want[out[k].id]);
    if (measure) {
        struct ct_tape_counts c = ct_tape_counts(t);
        long nop = c.additions + c.multiplications + c.functions;
        int calls = (int)(20000000 / n) + 1;
        t0 = seconds();
        for (int k = 0; k < calls; k++)
            ct_tape_eval(t, f.input, got, w);
        double eval = (seconds() - t0) / calls;
        printf("%zu nodes: compiled in %.2f ms, %ld operations (%ld sin, cos), work %zu, "
               "%.2f ns per operation\n",
               n, 1e3 * compiling, nop, c.functions, ct_tape_work(t), 1e9 * eval / (double)nop);
    }
    finish(&f);
    return compiling;
}

static void compiling_is_linear_in_the_graph(void **unused)
{
    (void)unused;
    struct random r = random_start(__func__);
    time_of_compile(&r, 10000, false); // warm
    double small = time_of_compile(&r, 10000, false),
           large = time_of_compile(&r, 100000, false);
    // ten times the nodes; a quadratic pass would take a hundred times as long
    printf("10000 nodes %.2f ms, 100000 nodes %.2f ms\n", 1e3 * small, 1e3 * large);
    assert_true(large < 40 * small + 0.02);
}

// Points that crowd at either end, or are spaced equally: between two of them and at each the value
// is that of the interval which a search from the first one on finds.
static void tables_with_uneven_points_are_read_right(void **unused)
{
    (void)unused;
    enum { N = 300 };
    double x[N], y[N];
    for (int shape = 0; shape < 3; shape++) {
        for (int i = 0; i < N; i++) {
            x[i] = shape == 0 ? 0.1 * i : shape == 1 ? ldexp(1, i - N) : -ldexp(1, -i);
            y[i] = i % 7;
        }
        const struct ct_table t = {.n = N, .x = x, .y = y},
                              held = {.n = N, .x = x, .y = y, .holds = true};
        for (int i = 0; i < N - 1; i++)
            for (int k = 0; k < 3; k++) {
                const double at = x[i] + 0.25 * k * (x[i + 1] - x[i]);
                const double want
                    = y[i] + (at - x[i]) * ((y[i + 1] - y[i]) / (x[i + 1] - x[i]));
                assert_true(ct_table_value(&t, 0, at) == want);
                assert_true(ct_table_value(&held, 0, at) == y[i]);
            }
        CHECK_CLOSE(ct_table_value(&t, 0, x[N - 1]), y[N - 1], 1e-14, 1e-14);
        assert_true(isnan(ct_table_value(&t, 0, x[0] - 1))
                    && isnan(ct_table_value(&t, 0, NAN)));
    }
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "--time")) {
        struct random r = random_start("time");
        for (size_t n = 300; n <= 100000; n *= 3)
            time_of_compile(&r, n, true);
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_graphs_have_the_bits_of_the_operators),
        cmocka_unit_test(small_graphs_have_the_bits_of_ct_ex_value),
        cmocka_unit_test(sines_of_sines_beside_other_angles_are_right),
        cmocka_unit_test(outputs_may_be_inputs_constants_and_repeated),
        cmocka_unit_test(no_outputs_need_nothing),
        cmocka_unit_test(unused_inputs_and_dead_nodes_take_no_room),
        cmocka_unit_test(parameters_are_free_and_pairs_count_twice),
        cmocka_unit_test(tables_with_uneven_points_are_read_right),
        cmocka_unit_test(compiling_is_linear_in_the_graph),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
