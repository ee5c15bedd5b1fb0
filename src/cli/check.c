// cotree check: reads and assembles a model and prints its properties.
#include "cli/cli.h"

static bool check(struct ct_ctx *ctx, struct ct_sim *sim, const struct cli_args *args)
{
    struct ct_output *o = sim ? ct_output_open(ctx, args->output) : NULL;
    if (!o)
        return false;
    ct_sim_print_check(sim, ct_output_stream(o));
    const bool ok = ct_sim_print_loops(ctx, sim, ct_output_stream(o), args->summary);
    return ct_output_close(ctx, o, ok);
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    static const char *const formats[] = {"text"}, *const suffixes[] = {"txt"};
    if (!cli_format(&cli_check, args, formats, suffixes, CLI_COUNT(formats)))
        return CLI_USAGE;
    struct ct_system *sys = cli_load(ctx, args);
    struct ct_sim *sim = cli_sim(ctx, sys, args);
    const bool ok = check(ctx, sim, args);
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_check = {
    .name = "check",
    .summary = "reads and assembles the model: freedoms, redundancy, trees, costs",
    .use = CLI_CHECK,
    .takes_model = true,
    .more = "\n"
            "Freedoms are the speeds of the chosen trees less the rank of the constraints. "
            "Constraints\n"
            "beyond the rank are redundant; they are named, and so is what they leave "
            "undetermined.\n",
    .examples
    = {"cotree check four_bar.yaml", "cotree check four_bar.yaml --keep-all --tree joints"},
    .run = run,
};
