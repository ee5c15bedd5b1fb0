// cotree draw: the mechanism as a line drawing.
#include "cli/cli.h"

#include <string.h>

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    if (args->trace && args->has_time)
        return cli_complain(&cli_draw, "--time and --trace exclude each other: --trace shows "
                                       "the start");
    struct ct_system *sys = cli_load(ctx, args);
    const bool to_file = args->output && strcmp(args->output, "-") != 0;
    const struct ct_draw_options options = {.view = args->view,
                                            .time = args->time,
                                            .trace = args->trace,
                                            .run = cli_sim_options(args),
                                            .path = to_file ? args->output : NULL,
                                            .bar = args->quiet ? NULL : stderr};
    int status = ct_system_draw(ctx, sys, &options) ? CLI_DONE : CLI_FAILED;
    if (status == CLI_DONE && !cli_summarize(ctx, sys, args))
        status = CLI_FAILED;
    ct_system_destroy(sys);
    return status;
}

const struct cli_command cli_draw = {
    .name = "draw",
    .summary = "draws the mechanism: bodies, joints by symbol, beams as they bend",
    .use = CLI_DRAW,
    .takes_model = true,
    .more
    = "\n"
      "SVG, at the assembled start; without -o to standard output. Names stand where there "
      "is room.\n",
    .examples = {"cotree draw slider_crank.yaml -o slider_crank.svg",
                 "cotree draw arm.yaml --trace --view iso -o arm.svg"},
    .run = run,
};
