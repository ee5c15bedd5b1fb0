// cotree linearize: state-space matrices with named states, inputs and outputs.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    struct ct_system *sys = cli_load(ctx, args);
    const struct ct_linearize_options options = {.about = args->about,
                                                 .inputs = args->inputs,
                                                 .hold_drivers = args->hold_drivers,
                                                 .run = cli_sim_options(args)};
    struct ct_linearization *s = ct_linearize(ctx, sys, &options);
    const bool ok
        = s && ct_linearization_write(ctx, s, args->output) && cli_summarize(ctx, sys, args);
    if (ok && !args->quiet)
        ct_linearization_print_summary(s, stderr);
    ct_linearization_destroy(s);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_linearize = {
    .name = "linearize",
    .summary = "matrices A, B, C, D about a configuration",
    .use = CLI_LINEARIZE,
    .takes_model = true,
    .more
    = "\n"
      "x' = A x + B u, y = C x + D u for deviations from the configuration; y are the "
      "outputs.\n"
      "Inputs add to what the model says: J.effort, F.force.x, T.torque.z, or are parameters.\n"
      "Without --inputs they are those of the model; without any its efforts and forces.\n"
      "Suffixes of -o: .csv (the rows of A B and C D), .json, .npz for NumPy.\n",
    .examples = {"cotree linearize crane.yaml --about equilibrium -o crane.npz",
                 "cotree linearize crane.yaml --inputs trolley.effort,wind.force.x"},
    .run = run,
};
