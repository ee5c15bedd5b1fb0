// cotree merge: joins the shards of a sweep.
#include "cli/cli.h"

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    const struct cli_list *files = &args->files;
    if (files->n < 2)
        return cli_complain(&cli_merge, "parts are wanted behind '%s'", files->text[0]);
    return ct_study_merge(ctx, files->text[0], files->text + 1, files->n - 1) ? CLI_DONE
                                                                              : CLI_FAILED;
}

const struct cli_command cli_merge = {
    .name = "merge",
    .summary = "joins the files of 'sweep --shard' to that of the whole sweep",
    .use = CLI_MERGE,
    .files = "OUT.csv PART...",
    .more
    = "\n"
      "Parts may come in any order. Beside each is PART.settings, which says what sweep it\n"
      "belongs to. Where a part is missing, not whole or of another sweep, the message says\n"
      "which, and OUT.csv is not written.\n",
    .examples = {"cotree merge pendulum.csv pendulum.sweep.*-of-4.csv",
                 "cotree merge - part1.csv part2.csv"},
    .run = run,
};
