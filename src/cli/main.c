// cotree: reads the command line, runs the command, prints what there is to say.
#include "cli/cli.h"

static int run(const struct cli_command *command, const struct cli_args *args)
{
    struct ct_ctx *ctx = ct_ctx_create();
    if (!ctx) {
        fputs("cotree: error: out of memory\n", stderr);
        return CLI_FAILED;
    }
    const int status = command->run(ctx, args);
    const int fault = (int)ct_ctx_fault(ctx);
    ct_ctx_print_diagnostics(ctx, stderr);
    ct_ctx_destroy(ctx);
    return fault ? fault : status;
}

// Help and version are results, too: standard output must have taken them.
static int finish(void)
{
    struct cli_output o;
    return cli_output_open(&o, NULL) ? cli_output_close(&o, true) : CLI_FAILED;
}

// OpenBLAS, where it is the BLAS, starts a thread a core even for matrices of ten rows: that costs
// more than it gives, and results would depend on the machine.
extern void openblas_set_num_threads(int n) __attribute__((weak));

int main(int argc, char **argv)
{
    if (openblas_set_num_threads)
        openblas_set_num_threads(1);
    const struct cli_command *command;
    struct cli_args args;
    int status = CLI_USAGE;
    if (cli_parse(argc, argv, &command, &args)) {
        if (args.help) {
            cli_print_help(stdout, command);
            status = finish();
        } else if (args.version) {
            printf("cotree %s\n", ct_version());
            status = finish();
        } else {
            status = run(command, &args);
        }
    }
    cli_args_finish(&args);
    return status;
}
