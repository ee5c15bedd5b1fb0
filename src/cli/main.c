// cotree: reads the command line, runs the command, prints the diagnostics.
#include "cli/cli.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

static int run(const struct cli_command *command, const struct cli_args *args)
{
    struct ct_ctx *ctx = ct_ctx_create();
    if (!ctx) {
        fputs("cotree: error: out of memory\n", stderr);
        return CLI_FAILED;
    }
    cli_interrupt_cancels(ctx);
    int status = cli_check_suffixes(ctx, command, args);
    if (status == CLI_DONE)
        status = command->run(ctx, args);
    const int fault = (int)ct_ctx_fault(ctx);
    ct_ctx_print_diagnostics(ctx, stderr);
    cli_interrupt_cancels(NULL);
    ct_ctx_destroy(ctx);
    return fault ? fault : status;
}

// Flushes standard output, since help and version are results too; reports an error.
static int finish(void)
{
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return CLI_DONE;
    fprintf(stderr, "cotree: error: cannot write 'standard output': %s [E002]\n",
            strerror(errno ? errno : EIO));
    return CLI_FAILED;
}

// Occupies the standard streams that the caller has closed. Otherwise the next file opened
// would take their place.
static bool occupy_standard_streams(void)
{
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        if (fcntl(fd, F_GETFD) == -1
            && open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) != fd)
            return false;
    return true;
}

// If the BLAS is OpenBLAS, it starts one thread for each core even for matrices of ten rows.
// This costs more than it saves, and results would depend on the machine.
extern void openblas_set_num_threads(int n) __attribute__((weak));

int main(int argc, char **argv)
{
    if (openblas_set_num_threads)
        openblas_set_num_threads(1);
    const struct cli_command *command;
    struct cli_args args;
    if (!occupy_standard_streams())
        return CLI_FAILED;
    cli_interrupt_begin();
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
    } else if (args.no_memory) {
        status = CLI_FAILED;
    }
    cli_args_finish(&args);
    return cli_interrupt_status(status);
}
