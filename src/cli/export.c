// cotree export: writes the model as source code or as an FMU.
#include "cli/cli.h"

#include <string.h>

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    static const char *const formats[] = {"c", "fmu2", "fmu3"};
    bool is_known = !args->format;
    for (size_t i = 0; i < CLI_COUNT(formats) && !is_known; i++)
        is_known = strcmp(args->format, formats[i]) == 0;
    if (!is_known)
        return cli_complain(&cli_export, "--format is '%s'; there are c, fmu2 and fmu3",
                            args->format);
    if (!args->output || strcmp(args->output, "-") == 0)
        return cli_complain(&cli_export, "-o says where the files go: a folder, or NAME.fmu");
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
    .summary = "writes the model as C source or as an FMU",
    .use = CLI_EXPORT,
    .takes_model = true,
    .more = "\n"
            "A folder gets NAME.h, NAME.c, NAME_test.c and NAME.json: C99 that needs libm "
            "alone, what\n"
            "compares it with values and a motion computed here, and where each number stands. "
            "An FMU is\n"
            "one file for other simulators: model exchange and co-simulation, sources and a "
            "binary.\n",
    .examples = {"cotree export puma560.yaml --format c -o arm",
                 "cotree export four_bar.yaml --format fmu3 -o four_bar.fmu"},
    .run = run,
};
