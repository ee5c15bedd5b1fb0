// cotree equations: prints the derivation of the equations of motion.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    static const char *const formats[] = {"text", "latex", "html", "html", "c", "json"};
    static const char *const suffixes[] = {"txt", "tex", "html", "htm", "c", "json"};
    const char *format
        = cli_format(&cli_equations, args, formats, suffixes, CLI_COUNT(formats));
    if (!format)
        return CLI_USAGE;
    struct ct_system *sys = cli_load(ctx, args);
    struct ct_output *o = sys ? ct_output_open(ctx, args->output) : NULL;
    const bool ok = o
                 && (args->full ? ct_system_print_equations : ct_system_summarize_equations)(
                        ctx, sys, args->show, format, ct_output_stream(o));
    int status = ct_output_close(ctx, o, ok) ? CLI_DONE : CLI_FAILED;
    if (status == CLI_DONE && !cli_summarize(ctx, sys, args))
        status = CLI_FAILED;
    ct_system_destroy(sys);
    return status;
}

const struct cli_command cli_equations = {
    .name = "equations",
    .summary = "prints the equations of motion and their derivation",
    .use = CLI_EQUATIONS,
    .takes_model = true,
    .more = "\n"
            "Each stage of the derivation can be shown: what components say (terminal), how "
            "they are\n"
            "connected (graph), what becomes a coordinate (tree), balances (cutset), closures "
            "(circuit)\n"
            "and the result (reduced). The format follows the suffix of -o when --format is "
            "not given.\n"
            "Systems of more than 100 speeds are printed in recursive form; lists show their "
            "first and\n"
            "last lines unless --full is given.\n",
    .examples = {"cotree equations pendulum.yaml --show all",
                 "cotree equations four_bar.yaml --tree joints -o four_bar.tex"},
    .run = run,
};
