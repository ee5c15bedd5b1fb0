// cotree accuracy: speed against error, and the cheapest setting that is accurate enough.
#include "cli/cli.h"

static bool report(struct ct_ctx *ctx, const struct ct_accuracy *a, const struct cli_args *args)
{
    bool ok = ct_accuracy_write(ctx, a, args->output);
    if (args->plot)
        ok = ct_accuracy_draw(ctx, a, args->plot) && ok;
    if (!args->quiet)
        ct_accuracy_print_summary(a, stderr);
    return ok;
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    struct ct_system *sys = cli_load(ctx, args);
    const struct ct_accuracy_options options = {.run = cli_sim_options(args),
                                                .error = args->error,
                                                .reference = args->reference,
                                                .progress = args->quiet ? NULL : stderr};
    struct ct_accuracy *a = ct_accuracy_create(ctx, sys, &options);
    const bool ok = a && report(ctx, a, args);
    ct_accuracy_destroy(a);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_accuracy = {
    .name = "accuracy",
    .summary = "speed against error: methods x tolerances against a reference",
    .use = CLI_ACCURACY,
    .takes_model = true,
    .more
    = "\n"
      "Prints a table: the error of a run is the largest difference of an output to the\n"
      "reference, against the largest value of that output. Says which setting is the "
      "cheapest\n"
      "that meets --error. Without --reference tight runs of two methods must agree.\n"
      "\n"
      "--method is a list here, as in dopri5,dop853. --tolerance and --step, where they are\n"
      "given, are the only ones tried. Takes up to a minute, longer for large systems.\n",
    .examples = {"cotree accuracy pendulum.yaml --error 1e-8 --plot pendulum.svg",
                 "cotree accuracy pendulum.yaml --method dopri5,rk4 -o pendulum.csv"},
    .run = run,
};
