// cotree methods: lists the methods of integration.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    return cli_print_list(ctx, &cli_methods, args, "txt", ct_methods_print);
}

const struct cli_command cli_methods = {
    .name = "methods",
    .summary = "lists the methods of integration",
    .use = CLI_METHODS,
    .more = "\n"
            "Names for --method and for the key simulation.method.\n",
    .examples = {"cotree methods", "cotree simulate pendulum.yaml --method dop853"},
    .run = run,
};
