// cotree report: the model, its equations and its motion as one HTML page.
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

// The command `cotree report MODEL.yaml` with the options that affect the page; NULL if memory
// is exhausted.
static const char **list_command(const struct cli_args *args, size_t *n)
{
    const char **word = calloc(args->given.n + 3, sizeof *word);
    if (!word)
        return NULL;
    word[0] = "cotree";
    word[1] = cli_report.name;
    word[2] = args->model;
    for (size_t i = 0; i < args->given.n; i++)
        word[i + 3] = args->given.text[i];
    *n = args->given.n + 3;
    return word;
}

// Runs `accuracy` with its default methods and tolerances.
static struct ct_accuracy *study(struct ct_ctx *ctx, struct ct_system *sys,
                                 const struct cli_args *args)
{
    const struct ct_accuracy_options o
        = {.run = {.until = args->until, .samples = args->samples},
           .bar = args->quiet ? NULL : stderr};
    return ct_accuracy_create(ctx, sys, &o);
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    char *standard = args->output ? NULL : cli_standard_path(args->model, ".html");
    const char *path = args->output ? args->output : standard;
    struct ct_report_options options = {.run = cli_sim_options(args),
                                        .path = path && strcmp(path, "-") != 0 ? path : NULL,
                                        .bar = args->quiet ? NULL : stderr};
    const char **command = list_command(args, &options.ncommand);
    options.command = command;
    struct ct_system *sys = cli_load(ctx, args);
    struct ct_accuracy *accuracy = args->accuracy ? study(ctx, sys, args) : NULL;
    options.accuracy = accuracy;
    const bool is_ready = sys && (accuracy || !args->accuracy);
    int status = is_ready && ct_system_report(ctx, sys, &options) ? CLI_DONE : CLI_FAILED;
    if (status == CLI_DONE && !cli_summarize(ctx, sys, args))
        status = CLI_FAILED;
    if (status == CLI_DONE && options.path && !args->quiet)
        fprintf(stderr, "page         %s\n", options.path);
    ct_accuracy_destroy(accuracy);
    ct_system_destroy(sys);
    free(command);
    free(standard);
    return status;
}

const struct cli_command cli_report = {
    .name = "report",
    .summary = "the model, its equations and its motion as one HTML page",
    .use = CLI_REPORT,
    .takes_model = true,
    .more = "\n"
            "Without -o the page goes to the model's file name with .html in the current "
            "folder;\n"
            "'-' is standard output. The page needs nothing else: it opens in any browser, "
            "offline.\n"
            "The run is always verified by a second one. docs/report.md says what is on it.\n",
    .examples = {"cotree report slider_crank.yaml",
                 "cotree report arm.yaml --set l=2 --until 5 -o arm.html"},
    .run = run,
};
