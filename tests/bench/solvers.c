// What solving for accelerations takes by each solver, beside what it is predicted to take.
//
//     solvers MODEL.yaml ...
//
// One line for each model and solver: unknowns (speeds and kept rows), predicted operations,
// machine code of one evaluation, seconds from the equations to programs that run, and the time of
// an evaluation: of eleven samples of processor time, taken alternately over the solvers, the
// least. The solver that `cotree check` chooses is marked.
#include "sim/sim.h"
#include "codegen/native.h"
#include "solve/constraint/solver.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

enum { NSAMPLE = 11, MOST_DENSE = 400 };

static const char *const names[] = {"auto", "unrolled", "one-system", "sparse", "dense"};
enum { NSOLVER = COUNT(names) };

struct subject {
    struct ct_sim *sim;
    double made, least; // [s]
    long n;             // evaluations of a sample
};

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double sample(struct subject *s)
{
    struct ct_partition *e = ct_run_partition(s->sim->run);
    const double start = now();
    for (long i = 0; i < s->n; i++)
        ct_partition_solve(e);
    return (now() - start) / (double)s->n;
}

static void open_subject(struct ct_ctx *ctx, struct subject *s, struct ct_system *sys,
                         const char *solver)
{
    const double start = now(), wanted = 5e-3;
    s->sim = ct_sim_create(ctx, sys, &(struct ct_sim_options){.solver = solver});
    s->made = now() - start;
    s->n = 1;
    s->least = INFINITY;
    if (s->sim)
        s->n += (long)(wanted / sample(s));
}

static void show(const struct subject *s, const char *name, double dense)
{
    const struct ct_partition *e = ct_run_partition(s->sim->run);
    const struct ct_solver *f = e->has_solver ? e->solver[0] : NULL;
    const struct ct_program *p = f ? ct_solver_code(f).solved : NULL;
    const double cost = f ? f->cost : dense;
    printf("| %zu | %s | %.0f | %zu KiB | %.3g s | %.4g us | %.3g |\n",
           e->m->nu + (size_t)e->rank, name, cost,
           p && p->native ? ct_native_code_size(p->native) / 1024 : 0, s->made, 1e6 * s->least,
           1e9 * s->least / cost);
}

static bool measure(struct ct_ctx *ctx, const char *path)
{
    struct ct_system *sys = ct_system_load(ctx, path, NULL);
    struct subject s[NSOLVER] = {0};
    if (!sys)
        return false;
    open_subject(ctx, &s[0], sys, NULL);
    if (!s[0].sim)
        return false;
    const struct ct_partition *chosen = ct_run_partition(s[0].sim->run);
    const struct ct_solver_costs c = chosen->costs;
    for (size_t i = 1; i < NSOLVER; i++)
        if (i < NSOLVER - 1 || chosen->m->nu <= MOST_DENSE)
            open_subject(ctx, &s[i], sys, names[i]);
    for (int k = 0; k < NSAMPLE; k++)
        for (size_t i = 0; i < NSOLVER; i++)
            if (s[i].sim)
                s[i].least = fmin(s[i].least, sample(&s[i]));
    printf("\n%s: predicted unrolled %.0f, one-system %.0f, sparse %.0f, dense %.0f\n\n", path,
           c.symbolic, c.symbolic_kkt, c.sparse, c.dense);
    printf("| unknowns | solver | operations | code | made in | evaluation | ns/operation |\n"
           "|---|---|---:|---:|---:|---:|---:|\n");
    for (size_t i = 0; i < NSOLVER; i++)
        if (s[i].sim) {
            show(&s[i], names[i], c.dense);
            ct_sim_destroy(s[i].sim);
        }
    fflush(stdout);
    ct_system_destroy(sys);
    return true;
}

int main(int argc, char **argv)
{
    struct ct_ctx *ctx = ct_ctx_create();
    bool ok = ctx != NULL;
    for (int i = 1; i < argc && ok; i++)
        ok = measure(ctx, argv[i]);
    if (ctx)
        ct_ctx_print_diagnostics(ctx, stderr);
    ct_ctx_destroy(ctx);
    return !ok;
}
