// cotree simulate: integrates and writes the outputs.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    return cli_run_motion(ctx, args, ".csv", CT_COLUMNS_OF_MODEL, ct_sim_run);
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
