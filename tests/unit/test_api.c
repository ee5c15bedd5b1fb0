// The public interface: a run from file to values, what callers may do wrong, and memory that runs out.
#include "base/guard.h"

#include <cotree/cotree.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char pendulum[]
    = "cotree: 1\n"
      "gravity: [0, -g, 0]\n"
      "parameters: {l: 1, g: 9.81}\n"
      "bodies: {rod: {mass: 1, com: [0, -l, 0]}}\n"
      "joints:\n"
      "  pivot: {type: revolute, from: ground, to: rod, initial: {q: 1, u: 0}}\n"
      "outputs: [pivot.q, energy.total]\n"
      "simulation: {duration: 1, samples: 11}\n";
// a loop: assembling, redundant rows, a search for trees
static char four_bar[1024];

static char path[] = "/tmp/cotree-test-XXXXXX";

static int write_model(void **state)
{
    (void)state;
    const char *tests = getenv("CT_TEST_DIR");
    snprintf(four_bar, sizeof four_bar, "%s/../systems/four_bar/model.yaml",
             tests ? tests : "tests");
    const int fd = mkstemp(path);
    FILE *f = fd >= 0 ? fdopen(fd, "w") : NULL;
    return !f || fputs(pendulum, f) < 0 || fclose(f) != 0;
}

static int remove_model(void **state)
{
    (void)state;
    return remove(path);
}

static void values_follow_the_run(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = ct_system_load(ctx, path, NULL);
    assert_non_null(sys);
    assert_int_equal(ct_system_column_count(sys), 2);
    assert_string_equal(ct_system_column(sys, 0), "pivot.q");
    assert_null(ct_system_column(sys, 2));
    struct ct_sim *sim = ct_sim_create(ctx, sys, &(struct ct_sim_options){.verify = true});
    assert_non_null(sim);
    assert_true(ct_sim_value(sim, "pivot.q") == 1);
    assert_true(isnan(ct_sim_error(sim, "pivot.q")));
    assert_true(ct_sim_run(ctx, sim, NULL));
    assert_true(ct_sim_error(sim, "pivot.q") > 0 && ct_sim_error(sim, "pivot.q") < 1e-7);
    assert_true(isnan(ct_sim_error(sim, "nothing")));
    assert_true(ct_sim_time(sim) == 1);
    assert_true(ct_sim_value(sim, "pivot.q") < 0);
    assert_true(isnan(ct_sim_value(sim, "nothing")));
    assert_false(ct_sim_run(ctx, sim, NULL)); // once
    assert_int_equal(ct_ctx_fault(ctx), CT_FAULT_OPTION);
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

static bool stop_at_half(void *user, double t, const double *value, size_t n)
{
    int *rows = user;
    assert_int_equal(n, 2);
    assert_true(isfinite(value[0]));
    ++*rows;
    return t < 0.5;
}

static void runs_share_a_system_and_can_be_stopped(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = ct_system_load(ctx, path, NULL);
    struct ct_sim *one = ct_sim_create(ctx, sys, NULL), *two = ct_sim_create(ctx, sys, NULL);
    int rows = 0;
    assert_true(
        ct_sim_run(ctx, one, &(struct ct_sim_results){.row = stop_at_half, .user = &rows}));
    assert_int_equal(rows, 6);
    assert_true(ct_sim_run(ctx, two, NULL));
    assert_true(ct_sim_time(one) < ct_sim_time(two));
    assert_int_equal(ct_ctx_fault(ctx), CT_FAULT_NONE);
    ct_sim_destroy(one);
    ct_sim_destroy(two);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

static void failures_pass_through_a_chain(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = ct_system_load(ctx, "no such file", NULL);
    assert_null(sys);
    assert_null(ct_sim_create(ctx, sys, NULL));
    assert_false(ct_sim_run(ctx, NULL, NULL));
    assert_false(ct_sim_write_summary(ctx, NULL, "nothing"));
    assert_false(ct_system_print_graph(ctx, sys, NULL, stdout));
    assert_false(ct_system_print_equations(ctx, sys, NULL, NULL, stdout));
    assert_int_equal(ct_ctx_fault(ctx), CT_FAULT_MODEL);
    ct_sim_destroy(NULL);
    ct_system_destroy(NULL);
    ct_ctx_destroy(NULL);
    ct_ctx_destroy(ctx);
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    const struct ct_sim_options wrong[] = {
        {.tolerance = -1}, {.until = NAN},      {.step = INFINITY},
        {.samples = -3},   {.method = "euler"},
    };
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_system *sys = ct_system_load(ctx, path, NULL);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_null(ct_sim_create(ctx, sys, &wrong[i]));
    assert_int_equal(ct_ctx_fault(ctx), CT_FAULT_OPTION);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
}

// Everything there is, with the n-th allocation failing; true if all went well.
static bool use_all(const char *model, long n)
{
    struct ct_ctx *ctx = ct_ctx_create();
    FILE *out = tmpfile();
    ct_guard_fail_after(n);
    struct ct_system *sys
        = ct_system_load(ctx, model, &(struct ct_system_options){.keep_all = true});
    bool ok = ct_system_print_graph(ctx, sys, "json", out);
    ok &= ct_system_print_equations(ctx, sys, "all", "text", out);
    struct ct_sim *sim = ct_sim_create(ctx, sys, &(struct ct_sim_options){.until = 0.05});
    ok &= ct_sim_run(ctx, sim, NULL);
    ct_guard_fail_after(0);
    assert_int_equal(ok ? CT_FAULT_NONE : CT_FAULT_MODEL, ct_ctx_fault(ctx));
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    ct_ctx_destroy(ctx);
    fclose(out);
    return ok;
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    int failures = 0;
    for (long n = 1; n < 400; n += 1 + n / 50)
        failures += !use_all(n % 2 ? path : four_bar, n);
    assert_true(failures > 30);
    assert_true(use_all(path, 0));
    assert_true(use_all(four_bar, 0));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_follow_the_run),
        cmocka_unit_test(runs_share_a_system_and_can_be_stopped),
        cmocka_unit_test(failures_pass_through_a_chain),
        cmocka_unit_test(wrong_options_are_refused),
        cmocka_unit_test(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, write_model, remove_model);
}
