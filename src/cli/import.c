// cotree import: converts a robot description to a model file.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    char *text = ct_import_urdf(ctx, args->model, args->output);
    struct ct_output *o = text ? ct_output_open(ctx, args->output) : NULL;
    const bool ok = o && fputs(text, ct_output_stream(o)) >= 0;
    const bool is_there = ct_output_close(ctx, o, ok);
    ct_free(text);
    return ok && is_there ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_import = {
    .name = "import",
    .summary = "writes a model file from a robot description (URDF)",
    .use = CLI_IMPORT,
    .takes_file = "ROBOT.urdf",
    .more = "\n"
            "Links become bodies, joints joints, mimic a gear, visuals shapes; limits stand in "
            "comments.\n"
            "What is ignored is named with its line. Without -o to standard output.\n",
    .examples
    = {"cotree import robot.urdf -o robot.yaml", "cotree draw robot.yaml -o robot.svg"},
    .run = run,
};
