// What commands share: loading, formats, files.
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

struct ct_system_options cli_system_options(const struct cli_args *args)
{
    return (struct ct_system_options){.set = args->set.text,
                                      .nset = args->set.n,
                                      .tree = args->tree,
                                      .keep_all = args->keep_all,
                                      .input = args->input,
                                      .hold_input = args->hold};
}

struct ct_system *cli_load(struct ct_ctx *ctx, const struct cli_args *args)
{
    return cli_load_with(ctx, args, CT_COLUMNS_OF_MODEL);
}

struct ct_system_options cli_analysis_options(const struct cli_args *args,
                                              enum ct_columns_more columns)
{
    struct ct_system_options options = cli_system_options(args);
    options.columns = columns;
    options.for_analysis = true;
    return options;
}

struct ct_system *cli_load_with(struct ct_ctx *ctx, const struct cli_args *args,
                                enum ct_columns_more columns)
{
    struct ct_system_options options = cli_system_options(args);
    options.columns = columns;
    return ct_system_load(ctx, args->model, &options);
}

struct ct_sim_options cli_sim_options(const struct cli_args *args)
{
    return (struct ct_sim_options){.method = args->method,
                                   .tolerance = args->tolerance,
                                   .step = args->step,
                                   .until = args->until,
                                   .samples = args->samples,
                                   .verify = args->verify,
                                   .backend = args->backend,
                                   .solver = args->solver};
}

struct ct_sim *cli_sim(struct ct_ctx *ctx, struct ct_system *sys, const struct cli_args *args)
{
    const struct ct_sim_options options = cli_sim_options(args);
    return ct_sim_create(ctx, sys, &options);
}

bool cli_summarize(struct ct_ctx *ctx, struct ct_system *sys, const struct cli_args *args)
{
    if (!args->summary)
        return true;
    struct ct_sim *sim = cli_sim(ctx, sys, args);
    const bool ok = sim && ct_sim_write_summary(ctx, sim, args->summary);
    ct_sim_destroy(sim);
    return ok;
}

static bool write_motion(struct ct_ctx *ctx, struct ct_sim *sim, const struct cli_args *args,
                         const char *suffix, cli_motion *motion, cli_row *row, void *user)
{
    char *standard = args->output ? NULL : cli_standard_path(args->model, suffix);
    const char *path = args->output ? args->output : standard;
    const struct ct_sim_results results = {.path = path ? path : "-",
                                           .bar = args->quiet ? NULL : stderr,
                                           .row = row,
                                           .user = user};
    char text[512];
    snprintf(text, sizeof text, ": whole rows may be in '%s.partial'", results.path);
    cli_interrupt_explain(text);
    bool ok = motion(ctx, sim, &results);
    cli_interrupt_explain(NULL);
    if (ok && args->summary)
        ok = ct_sim_write_summary(ctx, sim, args->summary);
    if (ok && !args->quiet)
        ct_sim_print_summary(sim, stderr);
    free(standard);
    return ok;
}

bool cli_run_system(struct ct_ctx *ctx, const struct cli_args *args, const char *suffix,
                    struct ct_system *sys, cli_motion *motion, cli_row *row, void *user)
{
    struct ct_sim *sim = cli_sim(ctx, sys, args);
    const bool ok = sim && write_motion(ctx, sim, args, suffix, motion, row, user);
    ct_sim_destroy(sim);
    return ok;
}

int cli_run_motion(struct ct_ctx *ctx, const struct cli_args *args, const char *suffix,
                   enum ct_columns_more columns, cli_motion *motion)
{
    struct ct_system *sys = cli_load_with(ctx, args, columns);
    const bool ok = cli_run_system(ctx, args, suffix, sys, motion, NULL, NULL);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

static bool is_one_of(const char *word, const char *const *words, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(word, words[i]) == 0)
            return true;
    return false;
}

const char *cli_format(const struct cli_command *command, const struct cli_args *args,
                       const char *const *formats, const char *const *suffixes, size_t n)
{
    if (args->format)
        return args->format;
    const char *slash = args->output ? strrchr(args->output, '/') : NULL;
    const char *base = slash ? slash + 1 : args->output;
    const char *dot = base && *base ? strrchr(base + 1, '.') : NULL;
    for (size_t i = 0; dot && i < n; i++)
        if (strcmp(dot + 1, suffixes[i]) == 0)
            return formats[i];
    if (!dot)
        return formats[0];
    char list[128] = "";
    for (size_t i = 0; i < n; i++)
        if (!is_one_of(suffixes[i], suffixes, i))
            snprintf(list + strlen(list), sizeof list - strlen(list), "%s.%s",
                     *list ? ", " : "", suffixes[i]);
    cli_complain(command, "'%s': nothing here is written as '%s'; the suffix may be %s%s",
                 args->output, dot, list, n > 1 ? ", or any with --format" : "");
    return NULL;
}

// ---- files ---------------------------------------------------------------------------------

char *cli_standard_path(const char *model, const char *suffix)
{
    const char *slash = strrchr(model, '/');
    const char *base = slash ? slash + 1 : model;
    const char *dot = strrchr(base, '.');
    const size_t n = dot && dot > base ? (size_t)(dot - base) : strlen(base);
    const size_t size = n + strlen(suffix) + 1;
    char *path = malloc(size);
    if (path)
        snprintf(path, size, "%.*s%s", (int)n, base, suffix);
    return path;
}

int cli_check_suffixes(struct ct_ctx *ctx, const struct cli_command *command,
                       const struct cli_args *args)
{
    const struct {
        const char *path;
        enum ct_contents contents;
    } file[] = {{command->use & CLI_TABLES ? args->output : NULL, CT_CONTENTS_TABLE},
                {args->curve, CT_CONTENTS_TABLE},
                {args->summary, CT_CONTENTS_SUMMARY},
                {args->plot, CT_CONTENTS_PLOT}};
    for (size_t i = 0; i < CLI_COUNT(file); i++)
        if (file[i].path && !ct_can_write(ctx, file[i].contents, file[i].path))
            return CLI_USAGE;
    return CLI_DONE;
}

int cli_print_list(struct ct_ctx *ctx, const struct cli_command *command,
                   const struct cli_args *args, const char *suffix, void (*print)(FILE *out))
{
    static const char *const formats[] = {"text"};
    if (!cli_format(command, args, formats, &suffix, 1))
        return CLI_USAGE;
    struct ct_output *o = ct_output_open(ctx, args->output);
    if (!o)
        return CLI_FAILED;
    print(ct_output_stream(o));
    return ct_output_close(ctx, o, true) ? CLI_DONE : CLI_FAILED;
}
