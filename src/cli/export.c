// cotree export: writes the equations as source code.
#include "cli/cli.h"

#include <string.h>

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    if (args->format && strcmp(args->format, "c") != 0)
        return cli_complain(&cli_export, "--format is '%s'; there is c", args->format);
    if (!args->output || strcmp(args->output, "-") == 0)
        return cli_complain(&cli_export, "-o FOLDER says where the files go");
    struct ct_system *sys = cli_load(ctx, args);
    struct ct_sim *sim = cli_sim(ctx, sys, args);
    bool ok = ct_sim_export_lanes(ctx, sim, args->format, args->output, args->lanes);
    if (ok && args->summary)
        ok = ct_sim_write_summary(ctx, sim, args->summary);
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_export = {
    .name = "export",
    .summary = "writes the equations of motion as C source",
    .use = CLI_EXPORT,
    .takes_model = true,
    .more
    = "\n"
      "The folder gets NAME.h, NAME.c, NAME_test.c and NAME.json: C99 that needs libm alone, "
      "what\n"
      "compares it with values and a motion computed here, and where each number stands.\n",
    .examples = {"cotree export puma560.yaml --format c -o arm",
                 "cotree export four_bar.yaml --tree absolute -o bars"},
    .run = run,
};
