// cotree simulate: integrates and writes the outputs.
#include "cli/cli.h"

// The same run with a plot of its samples. Columns that do not exist are rejected before it
// begins.
static int run_and_plot(struct ct_ctx *ctx, const struct cli_args *args)
{
    struct ct_system *sys = cli_load(ctx, args);
    struct ct_plot *plot = ct_plot_create(ctx, sys, args->columns);
    const bool ok = plot
                 && cli_run_system(ctx, args, ".csv", sys, ct_sim_run, ct_plot_row, plot)
                 && ct_plot_write(ctx, plot, args->plot);
    ct_plot_destroy(plot);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    if (args->columns && !args->plot)
        return cli_complain(&cli_simulate,
                            "--columns says what --plot shows; there is no --plot");
    return args->plot ? run_and_plot(ctx, args)
                      : cli_run_motion(ctx, args, ".csv", CT_COLUMNS_OF_MODEL, ct_sim_run);
}

const struct cli_command cli_simulate = {
    .name = "simulate",
    .summary = "integrates the motion and writes the outputs",
    .use = CLI_SIMULATE,
    .takes_model = true,
    .more
    = "\n"
      "Without -o the results go to the model's file name with .csv in the current folder;\n"
      "'-' is standard output. Suffixes: .csv, .csv.gz, .json (an object of columns), .npz "
      "for\n"
      "NumPy, .mat for MATLAB. A run that fails leaves what it has in FILE.partial.\n",
    .examples = {"cotree simulate pendulum.yaml -o pendulum.csv",
                 "cotree simulate pendulum.yaml --set l=2 --until 5 --tolerance 1e-10"},
    .run = run,
};
