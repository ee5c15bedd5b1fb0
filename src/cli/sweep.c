// cotree sweep: a run for each combination of parameters, a row for each run.
#include "cli/cli.h"

#include <stdlib.h>

static bool sweep(struct ct_ctx *ctx, struct ct_study *s, const struct cli_args *args)
{
    char suffix[64] = ".sweep.csv";
    if (args->shards)
        snprintf(suffix, sizeof suffix, ".sweep.%ld-of-%ld.csv", args->shard, args->shards);
    char *standard = args->output ? NULL : cli_standard_path(args->model, suffix);
    const char *path = args->output ? args->output : standard;
    const struct ct_study_results results = {
        .path = path ? path : "-", .resume = args->resume, .bar = args->quiet ? NULL : stderr};
    char text[512];
    snprintf(text, sizeof text,
             ": whole rows may be in '%s.partial'; the same command with --resume goes on",
             results.path);
    cli_interrupt_explain(text);
    bool ok = ct_study_run(ctx, s, &results);
    cli_interrupt_explain(NULL);
    if (ok && args->summary)
        ok = ct_study_write_summary(ctx, s, args->summary);
    if (ok && !args->quiet)
        ct_study_print_summary(s, stderr);
    free(standard);
    return ok;
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    const struct ct_study_options options = {.run = cli_sim_options(args),
                                             .vary = args->vary.text,
                                             .nvary = args->vary.n,
                                             .sample = args->sample,
                                             .seed = args->seed,
                                             .threads = args->threads,
                                             .lanes = args->lanes,
                                             .members = args->members,
                                             .take = args->take.text,
                                             .ntake = args->take.n,
                                             .shard = args->shard,
                                             .shards = args->shards};
    const struct ct_system_options system = cli_system_options(args);
    struct ct_study *s = ct_study_create(ctx, args->model, &system, &options);
    const bool ok = s && sweep(ctx, s, args);
    ct_study_destroy(s);
    return ok ? CLI_DONE : CLI_FAILED;
}

const struct cli_command cli_sweep = {
    .name = "sweep",
    .summary = "runs over ranges of parameters, a row for each",
    .use = CLI_SWEEP,
    .takes_model = true,
    .more
    = "\n"
      "Writes run, the parameters that vary, the outputs at the end time, and status: 0\n"
      "done, 1 failed (outputs empty; the summary says why). Several --vary span a grid,\n"
      "the last one runs fastest. With --sample K members are drawn at random: uniform in\n"
      "NAME=FROM:TO, or NAME=normal:MEAN:DEVIATION. Rows do not depend on --threads.\n"
      "\n"
      "Without -o: the model's file name with .sweep.csv, in this folder.\n",
    .examples = {"cotree sweep pendulum.yaml --vary length=0.5:2:100",
                 "cotree sweep crank.yaml --vary r='140 mm:160 mm' --sample 1000 --seed 7"},
    .run = run,
};
