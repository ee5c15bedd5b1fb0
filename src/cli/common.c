// What commands share: loading, formats, files.
#include "cli/cli.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct ct_system_options cli_system_options(const struct cli_args *args)
{
    return (struct ct_system_options){.set = args->set.text,
                                      .nset = args->set.n,
                                      .tree = args->tree,
                                      .keep_all = args->keep_all};
}

struct ct_system *cli_load(struct ct_ctx *ctx, const struct cli_args *args)
{
    return cli_load_with(ctx, args, CT_COLUMNS_OF_MODEL);
}

struct ct_system *cli_load_for_analysis(struct ct_ctx *ctx, const struct cli_args *args,
                                        enum ct_columns_more columns)
{
    struct ct_system_options options = cli_system_options(args);
    options.columns = columns;
    options.for_analysis = true;
    return ct_system_load(ctx, args->model, &options);
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
                         cli_motion *motion, cli_row *row, void *user)
{
    char *standard = args->output ? NULL : cli_standard_path(args->model, ".csv");
    const char *path = args->output ? args->output : standard;
    const struct ct_sim_results results = {.path = path ? path : "-",
                                           .progress = args->quiet ? NULL : stderr,
                                           .row = row,
                                           .user = user};
    bool ok = motion(ctx, sim, &results);
    if (ok && args->summary)
        ok = ct_sim_write_summary(ctx, sim, args->summary);
    if (ok && !args->quiet)
        ct_sim_print_summary(sim, stderr);
    free(standard);
    return ok;
}

bool cli_run_system(struct ct_ctx *ctx, const struct cli_args *args, struct ct_system *sys,
                    cli_motion *motion, cli_row *row, void *user)
{
    struct ct_sim *sim = cli_sim(ctx, sys, args);
    const bool ok = sim && write_motion(ctx, sim, args, motion, row, user);
    ct_sim_destroy(sim);
    return ok;
}

int cli_run_motion(struct ct_ctx *ctx, const struct cli_args *args,
                   enum ct_columns_more columns, cli_motion *motion)
{
    struct ct_system *sys = cli_load_with(ctx, args, columns);
    const bool ok = cli_run_system(ctx, args, sys, motion, NULL, NULL);
    ct_system_destroy(sys);
    return ok ? CLI_DONE : CLI_FAILED;
}

const char *cli_format(const struct cli_args *args, const char *const *formats,
                       const char *const *suffixes, size_t n)
{
    if (args->format)
        return args->format;
    const char *dot = args->output ? strrchr(args->output, '.') : NULL;
    for (size_t i = 0; dot && i < n; i++)
        if (strcmp(dot + 1, suffixes[i]) == 0)
            return formats[i];
    return formats[0];
}

// ---- files ---------------------------------------------------------------------------------------------

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

static void cannot(const char *what, const char *path, int error)
{
    fprintf(stderr, "cotree: error: cannot %s '%s': %s\n", what, path, strerror(error));
}

bool cli_output_open(struct cli_output *o, const char *path)
{
    *o = (struct cli_output){.stream = stdout, .path = "standard output"};
    if (!path || strcmp(path, "-") == 0)
        return true;
    o->path = path;
    struct stat st;
    if (stat(path, &st) != 0 || S_ISREG(st.st_mode)) { // not /dev/null and the like
        const size_t n = strlen(path) + sizeof ".partial";
        o->partial = malloc(n);
        if (!o->partial) {
            cannot("write", path, ENOMEM);
            return false;
        }
        snprintf(o->partial, n, "%s.partial", path);
    }
    o->stream = fopen(o->partial ? o->partial : path, "w");
    if (o->stream)
        return true;
    cannot("write", o->partial ? o->partial : path, errno);
    free(o->partial);
    return false;
}

int cli_output_close(struct cli_output *o, bool ok)
{
    errno = 0;
    bool written = fflush(o->stream) == 0 && !ferror(o->stream);
    if (o->stream != stdout)
        written = fclose(o->stream) == 0 && written;
    if (!written)
        cannot("write", o->path, errno ? errno : EIO);
    if (ok && written && o->partial && rename(o->partial, o->path) != 0) {
        cannot("replace", o->path, errno);
        written = false;
    }
    if (!ok && o->partial) // half a text is of no use
        remove(o->partial);
    free(o->partial);
    return ok && written ? CLI_DONE : CLI_FAILED;
}
