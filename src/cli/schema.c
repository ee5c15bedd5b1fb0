// cotree schema: prints the JSON Schema of the model file.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    return cli_print_list(ctx, &cli_schema, args, "json", ct_schema_print);
}

const struct cli_command cli_schema = {
    .name = "schema",
    .summary = "prints the JSON Schema of the model file",
    .use = CLI_SCHEMA,
    .more = "\n"
            "Draft 2020-12, made from the tables of the components; for editors that check and "
            "complete YAML.\n",
    .examples = {"cotree schema", "cotree schema -o cotree.schema.json"},
    .run = run,
};
