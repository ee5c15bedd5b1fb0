// cotree components: lists component types with their terminal equations and keys.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    return cli_print_list(ctx, &cli_components, args, "txt", ct_components_print);
}

const struct cli_command cli_components = {
    .name = "components",
    .summary = "lists component types with their terminal equations and keys",
    .use = CLI_COMPONENTS,
    .more
    = "\n"
      "Across variables are d, S (place and axes of `to` seen from `from`), through variables\n"
      "F, T (force and torque on `to`). Units stand in brackets, defaults in parentheses.\n",
    .examples = {"cotree components", "cotree components -o components.txt"},
    .run = run,
};
