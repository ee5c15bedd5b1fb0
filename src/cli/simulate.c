// cotree simulate: integrates and writes the outputs.
#include "cli/cli.h"

#include <stdlib.h>

static bool simulate(struct ct_ctx *ctx, struct ct_sim *sim, const struct cli_args *args)
{
    char *standard = args->output ? NULL : cli_standard_path(args->model, ".csv");
    const char *path = args->output ? args->output : standard;
    const struct ct_sim_results results
        = {.path = path ? path : "-", .progress = args->quiet ? NULL : stderr};
    bool ok = ct_sim_run(ctx, sim, &results);
    if (ok && args->summary)
        ok = ct_sim_write_summary(ctx, sim, args->summary);
    if (ok && !args->quiet)
        ct_sim_print_summary(sim, stderr);
    free(standard);
    return ok;
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    struct ct_system *sys = cli_load(ctx, args);
    struct ct_sim *sim = cli_sim(ctx, sys, args);
    const bool ok = sim && simulate(ctx, sim, args);
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_simulate = {
    .name = "simulate",
    .summary = "integrates the motion and writes the outputs",
    .use = CLI_SIMULATE,
    .takes_model = true,
    .more
    = "\n"
      "Without -o the results go to the model's file name with .csv in the current folder;\n"
      "FILE.json makes an object of columns, '-' is standard output. A run that fails leaves\n"
      "what it has in FILE.partial.\n",
    .examples = {"cotree simulate pendulum.yaml -o pendulum.csv",
                 "cotree simulate pendulum.yaml --set l=2 --until 5 --tolerance 1e-10"},
    .run = run,
};
