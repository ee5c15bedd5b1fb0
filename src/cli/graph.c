// cotree graph: draws the linear graph and its trees.
#include "cli/cli.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

// Limit: of the time of Graphviz, with a message (graphs of thousands of edges take seconds);
// and [ms] between checks for a signal.
enum { MOST_SECONDS = 60, LOOK_MS = 50 };

// Starts Graphviz, which reads `source` and writes to `out`.
static pid_t start_dot(FILE *source, int out, const char *type)
{
    const pid_t child = fork();
    if (child == 0) {
        setpgid(0, 0); // Ctrl-C goes to cotree only, which ends dot and reports it
        cli_interrupt_end();
        if (lseek(fileno(source), 0, SEEK_SET) == 0 && dup2(fileno(source), STDIN_FILENO) >= 0
            && dup2(out, STDOUT_FILENO) >= 0)
            execlp("dot", "dot", type, (char *)NULL);
        _exit(127);
    }
    return child;
}

enum end { ENDED, INTERRUPTED, TOO_LONG };

// Copies `in` to `out` until its end; *n (out): number of bytes.
static enum end copy(int in, FILE *out, size_t *n)
{
    const time_t start = time(NULL);
    char text[4096];
    for (*n = 0;;) {
        struct pollfd p = {.fd = in, .events = POLLIN};
        if (cli_is_interrupted())
            return INTERRUPTED;
        if (time(NULL) - start > MOST_SECONDS)
            return TOO_LONG;
        if (poll(&p, 1, LOOK_MS) <= 0)
            continue;
        const ssize_t got = read(in, text, sizeof text);
        if (got == 0 || (got < 0 && errno != EINTR))
            return ENDED;
        if (got > 0)
            *n += fwrite(text, 1, (size_t)got, out);
    }
}

static bool dot_failed(enum end end, int status, size_t n)
{
    const bool is_missing
        = end == ENDED && status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 127;
    if (end == INTERRUPTED) // reported at the end
        return true;
    if (end == TOO_LONG)
        fprintf(stderr,
                "cotree: error: Graphviz ('dot') has drawn nothing within %d s; --format dot "
                "prints what it reads\n",
                MOST_SECONDS);
    else if (is_missing)
        fputs("cotree: error: svg and png are drawn by Graphviz, whose program 'dot' is not "
              "there; --format dot prints what it reads\n",
              stderr);
    else if (status != 0)
        fputs("cotree: error: Graphviz ('dot') failed\n", stderr);
    else if (n == 0)
        fputs("cotree: error: Graphviz ('dot') has drawn nothing\n", stderr);
    else
        return false;
    return true;
}

static bool run_dot(FILE *source, FILE *out, const char *type)
{
    int channel[2], status = -1;
    size_t n = 0;
    if (pipe(channel) != 0) {
        fprintf(stderr, "cotree: error: cannot start 'dot': %s\n", strerror(errno));
        return false;
    }
    const pid_t child = start_dot(source, channel[1], type);
    close(channel[1]);
    const enum end end = child >= 0 ? copy(channel[0], out, &n) : ENDED;
    close(channel[0]);
    if (child >= 0 && end != ENDED)
        kill(child, SIGKILL);
    if (child >= 0 && waitpid(child, &status, 0) != child)
        status = -1;
    return !dot_failed(end, status, n);
}

static bool draw(struct ct_ctx *ctx, struct ct_system *sys, FILE *out, const char *type)
{
    FILE *source = tmpfile();
    if (!source) {
        fputs("cotree: error: cannot write a temporary file\n", stderr);
        return false;
    }
    const bool ok = ct_system_print_graph(ctx, sys, "dot", source) && fflush(source) == 0
                 && run_dot(source, out, type);
    fclose(source);
    return ok;
}

static bool print_graph(struct ct_ctx *ctx, struct ct_system *sys, const char *format,
                        bool with_trees, FILE *out)
{
    return with_trees                 ? ct_system_print_trees(ctx, sys, format, out)
         : strcmp(format, "svg") == 0 ? draw(ctx, sys, out, "-Tsvg")
         : strcmp(format, "png") == 0 ? draw(ctx, sys, out, "-Tpng")
                                      : ct_system_print_graph(ctx, sys, format, out);
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    static const char *const formats[] = {"text", "svg", "png", "dot", "dot", "json"};
    static const char *const suffixes[] = {"txt", "svg", "png", "dot", "gv", "json"};
    const char *format = cli_format(&cli_graph, args, formats, suffixes, CLI_COUNT(formats));
    bool is_known = false;
    if (!format)
        return CLI_USAGE;
    for (size_t i = 0; i < CLI_COUNT(formats); i++)
        is_known |= strcmp(format, formats[i]) == 0;
    if (!is_known)
        return cli_complain(&cli_graph,
                            "--format is '%s'; there are text, svg, png, dot and json", format);
    if (args->trees && strcmp(format, "text") != 0 && strcmp(format, "json") != 0)
        return cli_complain(&cli_graph, "--trees prints text or json, not %s", format);
    struct ct_system *sys = cli_load(ctx, args);
    struct ct_output *o = sys ? ct_output_open(ctx, args->output) : NULL;
    const bool ok = o && print_graph(ctx, sys, format, args->trees, ct_output_stream(o));
    int status = ct_output_close(ctx, o, ok) ? CLI_DONE : CLI_FAILED;
    if (status == CLI_DONE && !cli_summarize(ctx, sys, args))
        status = CLI_FAILED;
    ct_system_destroy(sys);
    return status;
}

const struct cli_command cli_graph = {
    .name = "graph",
    .summary = "draws the linear graph, the branches of its trees bold",
    .use = CLI_GRAPH,
    .takes_model = true,
    .more = "\n"
            "Text lists nodes, edges, the incidence matrix, cutsets and circuits. The format "
            "follows\n"
            "the suffix of -o when --format is not given.\n",
    .examples
    = {"cotree graph four_bar.yaml -o four_bar.svg", "cotree graph four_bar.yaml --trees"},
    .run = run,
};
