// The public interface: a run from file to values, what callers may do wrong, and memory that runs
// out.
#include "base/guard.h"

#include <cotree/cotree.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

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

struct rows {
    double value[64];
    char message[256];
    long n, stop;
};

static bool take_row(void *user, long run, const double *varied, const double *value,
                     const char *message)
{
    struct rows *r = user;
    assert_int_equal(run, ++r->n);
    if (value) {
        r->value[run - 1] = value[0];
        assert_true(isfinite(varied[0]));
        assert_null(message);
    } else {
        snprintf(r->message, sizeof r->message, "%s", message);
    }
    return run != r->stop;
}

static void members_of_a_study_come_in_order(void **state)
{
    (void)state;
    // l = -1: the rod stands upside down and swings, l = 0: no inertia
    static const char *const vary[] = {"l=-1:1:3"};
    for (long lanes = 0; lanes < 2; lanes++) {
        struct ct_ctx *ctx = ct_ctx_create();
        const struct ct_study_options o
            = {.vary = vary, .nvary = 1, .threads = 1, .lanes = lanes};
        struct ct_study *study = ct_study_create(ctx, path, NULL, &o);
        struct rows rows = {.n = 0};
        assert_non_null(study);
        assert_int_equal(ct_study_count(study), 3);
        assert_true(ct_study_run(ctx, study,
                                 &(struct ct_study_results){.row = take_row, .user = &rows}));
        assert_int_equal(rows.n, 3);
        assert_int_equal(ct_study_failed(study), 1);
        assert_non_null(strstr(rows.message, "moves no mass"));
        // length -1 seen from the other side: the same pendulum, half a turn away
        assert_true(rows.value[2] < 0 && rows.value[0] > 1);
        assert_int_equal(ct_ctx_fault(ctx), CT_FAULT_NONE);
        assert_false(ct_study_run(ctx, study, NULL)); // once
        ct_study_destroy(study);
        ct_ctx_destroy(ctx);
    }
}

static void a_study_can_be_stopped(void **state)
{
    (void)state;
    static const char *const vary[] = {"l=1:2:40"};
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_study *study = ct_study_create(
        ctx, path, NULL, &(struct ct_study_options){.vary = vary, .nvary = 1, .threads = 1});
    struct rows rows = {.stop = 3};
    assert_true(
        ct_study_run(ctx, study, &(struct ct_study_results){.row = take_row, .user = &rows}));
    assert_int_equal(rows.n, 3);
    assert_null(ct_study_create(ctx, path, NULL, &(struct ct_study_options){.nvary = 0}));
    assert_null(
        ct_study_create(ctx, "no such file", NULL, &(struct ct_study_options){.nvary = 0}));
    assert_false(ct_study_run(ctx, NULL, NULL));
    ct_study_destroy(NULL);
    ct_study_destroy(study);
    ct_ctx_destroy(ctx);
}

struct sums {
    double value;
    long n;
};

static bool add_row(void *user, long run, const double *varied, const double *value,
                    const char *message)
{
    struct sums *s = user;
    assert_null(message);
    s->value += (double)run * varied[0] * value[0];
    s->n++;
    return true;
}

static struct ct_study *two_threads(struct ct_ctx *ctx)
{
    static const char *const vary[] = {"l=1:2:24"};
    return ct_study_create(ctx, path, NULL,
                           &(struct ct_study_options){.vary = vary, .nvary = 1, .threads = 2});
}

static struct sums run_two_threads(struct ct_ctx *ctx, struct ct_study *study)
{
    struct sums s = {0};
    assert_non_null(study);
    assert_true(
        ct_study_run(ctx, study, &(struct ct_study_results){.row = add_row, .user = &s}));
    assert_int_equal(s.n, 24);
    return s;
}

// As Python's multiprocessing does: of one that has run, one that was made before, one that the
// child makes.
static void studies_run_in_a_child_process(void **state)
{
    (void)state;
    struct ct_ctx *ctx = ct_ctx_create();
    struct ct_study *first = two_threads(ctx), *made = two_threads(ctx);
    const double want = run_two_threads(ctx, first).value;
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        alarm(60); // what hangs ends
        struct ct_study *own = two_threads(ctx);
        const bool ok = run_two_threads(ctx, made).value == want
                     && run_two_threads(ctx, own).value == want;
        _exit(ok ? 0 : 1);
    }
    int status = -1;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    assert_true(run_two_threads(ctx, made).value == want); // the parent's is its own
    ct_study_destroy(made);
    ct_study_destroy(first);
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

// A member that finds no memory fails alone, if the others find some.
static bool use_study(const char *model, const char *const *vary, long n)
{
    struct ct_ctx *ctx = ct_ctx_create();
    const struct ct_study_options o
        = {.run.until = 0.05, .vary = vary, .nvary = 1, .threads = 1};
    ct_guard_fail_after(n);
    struct ct_study *study = ct_study_create(ctx, model, NULL, &o);
    const bool ok = ct_study_run(ctx, study, NULL);
    ct_guard_fail_after(0);
    assert_int_equal(ok ? CT_FAULT_NONE : CT_FAULT_MODEL, ct_ctx_fault(ctx));
    const bool all = ok && ct_study_failed(study) == 0;
    ct_study_destroy(study);
    ct_ctx_destroy(ctx);
    return all;
}

static void memory_may_run_out_in_a_study(void **state)
{
    (void)state;
    static const char *const length[] = {"l=1:2:5"}, *const crank[] = {"a=0.2:0.21:5"};
    int failures = 0;
    for (long n = 1; n < 600; n += 1 + n / 40) {
        failures += !use_study(path, length, n);
        failures += !use_study(four_bar, crank, n);
    }
    assert_true(failures > 60);
    assert_true(use_study(path, length, 0));
    assert_true(use_study(four_bar, crank, 0));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_follow_the_run),
        cmocka_unit_test(runs_share_a_system_and_can_be_stopped),
        cmocka_unit_test(failures_pass_through_a_chain),
        cmocka_unit_test(wrong_options_are_refused),
        cmocka_unit_test(members_of_a_study_come_in_order),
        cmocka_unit_test(a_study_can_be_stopped),
        cmocka_unit_test(studies_run_in_a_child_process),
        cmocka_unit_test(memory_may_run_out_anywhere),
        cmocka_unit_test(memory_may_run_out_in_a_study),
    };
    return cmocka_run_group_tests(tests, write_model, remove_model);
}
