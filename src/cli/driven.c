// cotree kinematics, cotree inverse: the samples of a motion that is driven all through.
#include "cli/cli.h"

#include <stdlib.h>

static bool follow(struct ct_ctx *ctx, struct ct_sim *sim, const struct cli_args *args)
{
    char *standard = args->output ? NULL : cli_standard_path(args->model, ".csv");
    const char *path = args->output ? args->output : standard;
    const struct ct_sim_results results
        = {.path = path ? path : "-", .progress = args->quiet ? NULL : stderr};
    bool ok = ct_sim_follow(ctx, sim, &results);
    if (ok && args->summary)
        ok = ct_sim_write_summary(ctx, sim, args->summary);
    if (ok && !args->quiet)
        ct_sim_print_summary(sim, stderr);
    free(standard);
    return ok;
}

static int run(struct ct_ctx *ctx, const struct cli_args *args, enum ct_columns_more columns)
{
    struct ct_system *sys = cli_load_with(ctx, args, columns);
    struct ct_sim *sim = cli_sim(ctx, sys, args);
    const bool ok = sim && follow(ctx, sim, args);
    ct_sim_destroy(sim);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

static int run_kinematics(struct ct_ctx *ctx, const struct cli_args *args)
{
    return run(ctx, args, CT_COLUMNS_COORDINATES);
}

static int run_inverse(struct ct_ctx *ctx, const struct cli_args *args)
{
    return run(ctx, args, CT_COLUMNS_EFFORTS);
}

const struct cli_command cli_kinematics = {
    .name = "kinematics",
    .summary = "follows motions that drive all freedoms",
    .use = CLI_KINEMATICS,
    .takes_model = true,
    .more
    = "\n"
      "Writes the outputs at the samples; nothing is integrated, so each sample is as good as\n"
      "the last. Each freedom needs a motion. A model without outputs gets the coordinates,\n"
      "speeds and accelerations of all joints. Results go where simulate puts them.\n",
    .examples
    = {"cotree kinematics robot.yaml", "cotree kinematics robot.yaml --samples 11 -o -"},
    .run = run_kinematics,
};

const struct cli_command cli_inverse = {
    .name = "inverse",
    .summary = "the efforts that motions need, and the reactions of all joints",
    .use = CLI_INVERSE,
    .takes_model = true,
    .more
    = "\n"
      "As kinematics; behind the outputs come the efforts of all motions (J.effort) and the\n"
      "forces and torques of all joints. A model whose efforts are tables of that file, as in\n"
      "effort: {table: robot.csv, column: J.effort, interpolate: cubic}, moves the same way.\n",
    .examples
    = {"cotree inverse robot.yaml", "cotree inverse robot.yaml --samples 11 -o robot.json"},
    .run = run_inverse,
};
