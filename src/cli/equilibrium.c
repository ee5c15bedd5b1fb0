// cotree equilibrium: finds the equilibrium of a system and its stability.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    const struct ct_system_options system = cli_analysis_options(args, CT_COLUMNS_COORDINATES);
    const struct ct_vary_options vary = {.analysis = CT_VARY_EQUILIBRIUM,
                                         .equilibrium = {.hold_drivers = args->hold_drivers}};
    int status;
    if (cli_vary(ctx, &cli_equilibrium, args, &system, &vary, NULL, &status))
        return status;
    struct ct_system *sys = ct_system_load(ctx, args->model, &system);
    struct ct_equilibrium *q = ct_equilibrium_create(ctx, sys, &vary.equilibrium);
    const bool ok
        = q && ct_equilibrium_write(ctx, q, args->output) && cli_summarize(ctx, sys, args);
    if (ok && !args->quiet)
        ct_equilibrium_print_summary(q, stderr);
    ct_equilibrium_destroy(q);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_equilibrium = {
    .name = "equilibrium",
    .summary = "where the system rests under the loads at t = 0, and whether it is stable",
    .use = CLI_EQUILIBRIUM,
    .takes_model = true,
    .more
    = "\n"
      "Prints one row of outputs. From the assembled start the forces are followed down to "
      "the\n"
      "nearest equilibrium. Motions with a constant rate go on, so that a system on a turning\n"
      "shaft finds its place in the turning frame; other motions are held. With --vary: a row\n"
      "for each value, with run and the parameters before the outputs.\n",
    .examples
    = {"cotree equilibrium governor.yaml", "cotree equilibrium governor.yaml -o rest.json"},
    .run = run,
};
