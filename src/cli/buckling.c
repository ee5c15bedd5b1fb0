// cotree buckling: critical load factors, at which the stiffness becomes singular.
#include "cli/cli.h"

static bool report(struct ct_ctx *ctx, struct ct_buckling *s, const struct cli_args *args)
{
    bool ok = ct_buckling_write(ctx, s, args->output);
    if (args->curve)
        ok = ct_buckling_write_curve(ctx, s, args->curve, args->count) && ok;
    if (!args->quiet)
        ct_buckling_print_summary(s, stderr);
    return ok;
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    if (!args->load)
        return cli_complain(&cli_buckling,
                            "--load is wanted: a force, a torque, a joint with an "
                            "effort, or gravity");
    const struct ct_system_options system = cli_analysis_options(args, CT_COLUMNS_OF_MODEL);
    struct ct_system *sys = ct_system_load(ctx, args->model, &system);
    const struct ct_buckling_options options
        = {.load = args->load, .count = args->count, .hold_drivers = args->hold_drivers};
    struct ct_buckling *s = ct_buckling_create(ctx, sys, &options);
    const bool ok = s && report(ctx, s, args) && cli_summarize(ctx, sys, args);
    ct_buckling_destroy(s);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_buckling = {
    .name = "buckling",
    .summary = "factors by which a load must grow until the system buckles",
    .use = CLI_BUCKLING,
    .takes_model = true,
    .more = "\n"
            "Prints mode and load factor, the lowest first; all other loads stay as they are. "
            "--curve\n"
            "follows the lowest frequencies from no load to the first factor.\n",
    .examples = {"cotree buckling column.yaml --load push",
                 "cotree buckling mast.yaml --load gravity --count 3 --curve frequencies.csv"},
    .run = run,
};
