// cotree kinematics, cotree inverse: kinematics and inverse dynamics of a motion
// prescribed by drivers.
#include "cli/cli.h"

static int follow(struct ct_ctx *ctx, const struct cli_command *command,
                  const struct cli_args *args, const char *suffix, enum ct_columns_more columns)
{
    struct ct_system_options system = cli_system_options(args);
    const struct ct_vary_options vary
        = {.analysis = CT_VARY_DRIVEN, .run = cli_sim_options(args)};
    int status;
    system.columns = columns;
    return cli_vary(ctx, command, args, &system, &vary, suffix, &status)
             ? status
             : cli_run_motion(ctx, args, suffix, columns, ct_sim_follow);
}

static int run_kinematics(struct ct_ctx *ctx, const struct cli_args *args)
{
    return follow(ctx, &cli_kinematics, args, ".kinematics.csv", CT_COLUMNS_COORDINATES);
}

static int run_inverse(struct ct_ctx *ctx, const struct cli_args *args)
{
    return follow(ctx, &cli_inverse, args, ".inverse.csv", CT_COLUMNS_EFFORTS);
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
      "speeds and accelerations of all joints. Results go where simulate puts them. With "
      "--vary:\n"
      "run and the parameters before t, for each of their values.\n",
    .examples
    = {"cotree kinematics robot.yaml", "cotree kinematics robot.yaml --samples 11 -o -"},
    .run = run_kinematics,
};

const struct cli_command cli_inverse = {
    .name = "inverse",
    .summary = "efforts that produce given motions, and the reactions of all joints",
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
