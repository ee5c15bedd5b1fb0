// Parameter studies: members of grids and samples, and what the command line may say.
#include "study/plan.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const char text[] = "cotree: 1\nparameters: {a: 1, b: 2, c: 3}\n";

struct fixture {
    struct ct_ctx ctx;
    struct ct_model model;
    struct ct_plan plan;
};

static bool read(struct fixture *f, const char *const *vary, size_t n, long sample,
                 uint64_t seed)
{
    f->ctx = (struct ct_ctx){.model = ct_arena_create(), .scratch = ct_arena_create()};
    assert_true(ct_model_parse(&f->ctx, "m.yaml", text, sizeof text - 1, NULL, 0, &f->model));
    return ct_plan_read(&f->ctx, &f->model, vary, n, sample, seed, &f->plan);
}

static void close(struct fixture *f)
{
    ct_arena_destroy(f->ctx.scratch);
    ct_arena_destroy(f->ctx.model);
}

static void the_last_axis_runs_fastest_and_ends_are_exact(void **state)
{
    (void)state;
    static const char *const vary[] = {"a=0.1:0.7:3", "b=5:9:1", "c=1:-1:4"};
    struct fixture f;
    assert_true(read(&f, vary, 3, 0, 0));
    assert_int_equal(f.plan.nmember, 12);
    for (long i = 0; i < 12; i++) {
        const double a[] = {0.1, 0.1 + (0.7 - 0.1) / 2, 0.7}, c[] = {1, 1. / 3, -1. / 3, -1};
        assert_true(fabs(ct_plan_value(&f.plan, i, 0) - a[i / 4]) < 1e-15);
        assert_true(ct_plan_value(&f.plan, i, 1) == 5);
        assert_true(fabs(ct_plan_value(&f.plan, i, 2) - c[i % 4]) < 1e-15);
    }
    assert_true(ct_plan_value(&f.plan, 11, 0) == 0.7);
    close(&f);
}

static void values_may_have_units(void **state)
{
    (void)state;
    static const char *const vary[] = {"a=100 mm:pi/4:2"};
    struct fixture f;
    assert_true(read(&f, vary, 1, 0, 0));
    assert_true(ct_plan_value(&f.plan, 0, 0) == 0.1);
    assert_true(fabs(ct_plan_value(&f.plan, 1, 0) - 0.78539816339744831) < 1e-16);
    close(&f);
}

// The first outputs of the authors' generator for the seed 1234567.
static void samples_are_numbers_of_splitmix64(void **state)
{
    (void)state;
    static const uint64_t stream[]
        = {6457827717110365317u, 3203168211198807973u, 9817491932198370423u};
    static const char *const vary[] = {"a=0:1", "b=-2:6:9"};
    struct fixture f;
    assert_true(read(&f, vary, 2, 7, 1234567));
    assert_int_equal(f.plan.nmember, 7);
    const double first = (double)(stream[0] >> 11) / 9007199254740992.0;
    const double third = (double)(stream[2] >> 11) / 9007199254740992.0;
    assert_true(ct_plan_value(&f.plan, 0, 0) == first);
    assert_true(ct_plan_value(&f.plan, 0, 1) == -2 + third * 8);
    close(&f);
}

static void normal_samples_have_mean_and_deviation(void **state)
{
    (void)state;
    enum { N = 20000 };
    static const char *const vary[] = {"a=normal:3:0.5"};
    struct fixture f;
    assert_true(read(&f, vary, 1, N, 5));
    double sum = 0, square = 0, fourth = 0;
    for (long i = 0; i < N; i++) {
        const double z = (ct_plan_value(&f.plan, i, 0) - 3) / 0.5;
        sum += z;
        square += z * z;
        fourth += z * z * z * z;
    }
    // five standard errors: 1, sqrt(2) and sqrt(96) over sqrt(N)
    assert_true(fabs(sum / N) < 5 / sqrt(N));
    assert_true(fabs(square / N - 1) < 5 * sqrt(2. / N));
    assert_true(fabs(fourth / N - 3) < 5 * sqrt(96. / N));
    close(&f);
}

static void what_makes_no_study_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *vary[2];
        long sample;
        const char *why;
    } cases[] = {
        {{"a=1:2"}, 0, "needs N"},
        {{"a=1:2:0"}, 0, "integer from 1"},
        {{"a=1:2:3:4"}, 0, "integer from 1"},
        {{"a=1"}, 0, "one value only"},
        {{"a"}, 0, "no NAME="},
        {{"=1:2:3"}, 0, "no NAME="},
        {{"d=1:2:3"}, 0, "no parameter 'd'"},
        {{"a=1:b:3"}, 0, "'b' is no constant value"},
        {{"a=1/0:2:3"}, 0, "'1/0' is no constant value"},
        {{"a=1:2:3", "a=1:2:3"}, 0, "varies already"},
        {{"a=normal:1:2"}, 0, "needs --sample"},
        {{"a=normal:1:-2"}, 9, "must not be negative"},
        {{"a=normal:1:2:3"}, 9, "something behind it"},
        {{"a=1:2:100000", "b=1:2:100000"}, 0, "members"},
        {{NULL}, 5, "nothing varies"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct fixture f;
        const size_t n = !cases[i].vary[0] ? 0 : cases[i].vary[1] ? 2 : 1;
        if (read(&f, cases[i].vary, n, cases[i].sample, 0))
            fail_msg("case %zu is accepted", i);
        if (!strstr(f.ctx.diagnostic[0].text, cases[i].why))
            fail_msg("case %zu: %s", i, f.ctx.diagnostic[0].text);
        assert_int_equal(f.ctx.diagnostic[0].code, CT_E_USAGE);
        close(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_last_axis_runs_fastest_and_ends_are_exact),
        cmocka_unit_test(values_may_have_units),
        cmocka_unit_test(samples_are_numbers_of_splitmix64),
        cmocka_unit_test(normal_samples_have_mean_and_deviation),
        cmocka_unit_test(what_makes_no_study_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
