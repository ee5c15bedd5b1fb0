// What a step of each method costs beside its evaluations of a model of one degree of freedom:
// Markdown tables.
//
//     steps [--quick]
//
// The models are systems/pendulum, and systems/four_bar with a loop, two samples, tolerance 1e-6.
// Evaluations are those of the accelerations and, for implicit methods, of the residual and of its
// derivatives: what `evaluations` and Jacobians of the summary count. Each of them is taken to cost
// what one of the accelerations does on which the next one waits; the time of one of the residual
// is printed beside it. Times are processor time, the least of several runs, which take turns so
// that a busy machine slows all of them.
#include "sim/sim.h"
#include "solve/constraint/dae.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 7, CALLS = 20000, MOST_METHODS = 16, MOST_STATES = 16 };

static const double assumed
    = 50e-9; // of an evaluation: what the steps are to be compared with  [s]

struct subject {
    const char *method;
    double step, until;
    double seconds; // of the fastest run
    struct ct_integrate_stats stats;
};

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void give_up(const struct ct_ctx *ctx)
{
    ct_ctx_print(ctx, stderr);
    exit(1);
}

static struct ct_sim *prepare(struct ct_ctx *ctx, struct ct_system *system,
                              const struct subject *s)
{
    const struct ct_sim_options options = {.method = s->method,
                                           .tolerance = 1e-6,
                                           .step = s->step,
                                           .samples = 2,
                                           .until = s->until};
    struct ct_sim *sim = ct_sim_create(ctx, system, &options);
    if (!sim)
        give_up(ctx);
    return sim;
}

static void run(struct ct_ctx *ctx, struct ct_system *system, struct subject *s)
{
    struct ct_sim *sim = prepare(ctx, system, s);
    const double start = now();
    if (!ct_sim_run(ctx, sim, NULL))
        give_up(ctx);
    s->seconds = fmin(s->seconds, now() - start);
    s->stats = sim->report.stats;
    ct_sim_destroy(sim);
}

// Of an evaluation that begins with what the one before has found.
static double evaluation(struct ct_ctx *ctx, struct ct_system *system, const struct subject *s)
{
    struct ct_sim *sim = prepare(ctx, system, s);
    const struct ct_evaluator *m = ct_run_evaluator(sim->run);
    const size_t n = m->nq + m->nu + 1;
    double y[MOST_STATES], dy[MOST_STATES];
    memcpy(y, ct_run_state(sim->run), n * sizeof *y);
    const double start = now();
    for (int i = 0; i < CALLS; i++) {
        if (ct_run_rhs(sim->run, 0, y, dy) != CT_EVAL_OK)
            give_up(ctx);
        y[0] += 1e-16 * dy[n - 2];
    }
    const double spent = now() - start;
    ct_sim_destroy(sim);
    return spent / CALLS;
}

// The same of the residual.
static double residual(struct ct_ctx *ctx, struct ct_system *system, const struct subject *s)
{
    struct ct_sim *sim = prepare(ctx, system, s);
    const struct ct_dae *dae = ct_dae_create(sim->own.model, ct_run_partition(sim->run));
    const struct ct_evaluator *m = ct_run_evaluator(sim->run);
    const double none[MOST_STATES] = {0};
    double y[MOST_STATES], r[MOST_STATES] = {0}, left[2][MOST_STATES] = {{0}};
    memcpy(y, ct_run_state(sim->run), (m->nq + m->nu) * sizeof *y);
    const double start = now();
    for (int i = 0; i < CALLS; i++) {
        if (dae->residual(dae->user, 0, y, y + m->nq, none, none, r, left[0], left[1])
            != CT_EVAL_OK)
            give_up(ctx);
        y[0] += 1e-16 * r[0];
    }
    const double spent = now() - start;
    ct_sim_destroy(sim);
    return spent / CALLS;
}

// Each method with step control, over a time in which it makes some thousands of steps, then with
// fixed ones.
static int list_subjects(struct subject *all)
{
    int n = 0;
    for (int is_fixed = 0; is_fixed < 2; is_fixed++)
        for (int i = 0; i < ct_nmethod; i++) {
            const struct ct_method *m = ct_methods[i];
            const double until = is_fixed || m->order > 2 ? 20 : 1;
            all[n++] = (struct subject){.method = m->name,
                                        .step = is_fixed ? 0.01 : 0,
                                        .until = until,
                                        .seconds = INFINITY};
        }
    return n;
}

static void print_row(const struct subject *s, double one)
{
    const double n
        = (double)(s->stats.evaluations + s->stats.jacobians) / (double)s->stats.steps;
    const double step = s->seconds / (double)s->stats.steps;
    printf("| %s%s | %.0f | %.2g | %.0f | %.0f | %.0f |\n", s->method,
           s->step > 0 ? ", fixed steps" : "", 1e9 * step, n, 1e9 * n * one,
           1e9 * (step - n * one), 1e9 * n * assumed);
}

static void print_table(struct ct_ctx *ctx, const char *name, int rounds)
{
    const char *root = getenv("CT_SOURCE_DIR");
    char path[512];
    snprintf(path, sizeof path, "%s/systems/%s/model.yaml", root ? root : ".", name);
    struct ct_system *system = ct_system_load(ctx, path, NULL);
    if (!system)
        give_up(ctx);
    struct subject all[2 * MOST_METHODS];
    const struct subject some_explicit = {.method = "rk4", .step = 0.01, .until = 1},
                         some_implicit = {.method = "radau5", .until = 1};
    const int n = list_subjects(all);
    double one = INFINITY, other = INFINITY;
    for (int i = 0; i < rounds; i++) {
        one = fmin(one, evaluation(ctx, system, &some_explicit));
        other = fmin(other, residual(ctx, system, &some_implicit));
        for (int k = 0; k < n; k++)
            run(ctx, system, &all[k]);
    }
    printf("%s: an evaluation %.1f ns, of the residual %.1f ns\n\n", name, 1e9 * one,
           1e9 * other);
    printf("| method | a step [ns] | evaluations | time of these [ns] | rest [ns] | "
           "evaluations at %g "
           "ns [ns] |\n| --- | --- | --- | --- | --- | --- |\n",
           1e9 * assumed);
    for (int k = 0; k < n; k++)
        print_row(&all[k], one);
    printf("\n");
    ct_system_destroy(system);
}

int main(int argc, char **argv)
{
    const int rounds = argc > 1 && strcmp(argv[1], "--quick") == 0 ? 1 : ROUNDS;
    struct ct_ctx *ctx = ct_ctx_create();
    print_table(ctx, "pendulum", rounds);
    print_table(ctx, "four_bar", rounds);
    ct_ctx_destroy(ctx);
    return 0;
}
