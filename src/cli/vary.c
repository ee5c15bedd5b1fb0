// Analyses of a varied model: the part that their commands share.
#include "cli/cli.h"

#include <stdlib.h>

static const char *excluded(const struct cli_args *args)
{
    return args->summary ? "--summary"
         : args->plot    ? "--plot"
         : args->report  ? "--report"
                         : NULL;
}

bool cli_vary(struct ct_ctx *ctx, const struct cli_command *command,
              const struct cli_args *args, const struct ct_system_options *system,
              const struct ct_vary_options *analysis, const char *suffix, int *status)
{
    if (!args->vary.n && !args->members && !args->sample)
        return false;
    if (excluded(args)) {
        *status = cli_complain(command, "%s is of one run: it goes without %s", excluded(args),
                               args->members ? "--members" : "--vary");
        return true;
    }
    struct ct_vary_options o = *analysis;
    o.vary = args->vary.text;
    o.nvary = args->vary.n;
    o.sample = args->sample;
    o.seed = args->seed;
    o.members = args->members;
    o.bar = args->quiet ? NULL : stderr;
    char *standard = args->output || !suffix ? NULL : cli_standard_path(args->model, suffix);
    const char *path = args->output ? args->output : standard;
    *status = ct_vary(ctx, args->model, system, &o, path) ? CLI_DONE : CLI_FAILED;
    free(standard);
    return true;
}
