// cotree schema: prints the JSON Schema of the model file.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    struct cli_output o;
    (void)ctx;
    if (!cli_output_open(&o, args->output))
        return CLI_FAILED;
    ct_schema_print(o.stream);
    return cli_output_close(&o, true);
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
