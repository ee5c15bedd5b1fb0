// cotree modes: natural frequencies, damping and shapes.
#include "cli/cli.h"

static bool report(struct ct_ctx *ctx, struct ct_modes *modes, const struct cli_args *args)
{
    bool ok = ct_modes_write(ctx, modes, args->output);
    if (args->plot)
        ok = ct_modes_draw(ctx, modes, args->plot) && ok;
    if (!args->quiet)
        ct_modes_print_summary(modes, stderr);
    return ok;
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    const struct ct_system_options system = cli_analysis_options(args, CT_COLUMNS_OF_MODEL);
    const struct ct_vary_options vary = {.analysis = CT_VARY_MODES,
                                         .modes = {.about = args->about,
                                                   .count = args->count,
                                                   .hold_drivers = args->hold_drivers,
                                                   .run = cli_sim_options(args)}};
    int status;
    if (cli_vary(ctx, &cli_modes, args, &system, &vary, NULL, &status))
        return status;
    struct ct_system *sys = ct_system_load(ctx, args->model, &system);
    struct ct_modes *modes = ct_modes_create(ctx, sys, &vary.modes);
    const bool ok = modes && report(ctx, modes, args) && cli_summarize(ctx, sys, args);
    ct_modes_destroy(modes);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_modes = {
    .name = "modes",
    .summary = "natural frequencies, damping and shapes about a configuration",
    .use = CLI_MODES,
    .takes_model = true,
    .more = "\n"
            "Prints mode, frequency, |s| and damping of the eigenvalues s, the lowest first; "
            "growing\n"
            "motions have a negative damping. FILE.json has the shapes, too.\n"
            "With --vary: run, the parameters, then these columns, for each of their values.\n",
    .examples = {"cotree modes suspension.yaml --about equilibrium",
                 "cotree modes suspension.yaml --count 3 --plot shapes.svg -o modes.json"},
    .run = run,
};
