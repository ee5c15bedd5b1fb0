// cotree graph: draws the linear graph and its trees.
#include "cli/cli.h"

#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

// Graphviz turns what is in `source` into SVG on the file descriptor out.
static bool run_dot(FILE *source, int out)
{
    const pid_t child = fork();
    if (child == 0) {
        if (lseek(fileno(source), 0, SEEK_SET) == 0 && dup2(fileno(source), STDIN_FILENO) >= 0
            && dup2(out, STDOUT_FILENO) >= 0)
            execlp("dot", "dot", "-Tsvg", (char *)NULL);
        _exit(127);
    }
    int status = -1;
    if (child >= 0 && waitpid(child, &status, 0) == child && status == 0)
        return true;
    fputs(status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 127
              ? "cotree: error: svg is drawn by Graphviz, whose program 'dot' is not there; "
                "--format dot prints what it reads\n"
              : "cotree: error: Graphviz ('dot') failed\n",
          stderr);
    return false;
}

static bool draw_svg(struct ct_ctx *ctx, struct ct_system *sys, FILE *out)
{
    FILE *source = tmpfile();
    if (!source) {
        fputs("cotree: error: cannot write a temporary file\n", stderr);
        return false;
    }
    const bool ok = ct_system_print_graph(ctx, sys, "dot", source) && fflush(source) == 0
                 && fflush(out) == 0 && run_dot(source, fileno(out));
    fclose(source);
    return ok;
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    static const char *const formats[] = {"text", "svg", "dot", "dot", "json"};
    static const char *const suffixes[] = {"txt", "svg", "dot", "gv", "json"};
    const char *format = cli_format(args, formats, suffixes, CLI_COUNT(formats));
    bool is_known = false;
    for (size_t i = 0; i < CLI_COUNT(formats); i++)
        is_known |= strcmp(format, formats[i]) == 0;
    if (!is_known)
        return cli_complain(&cli_graph, "--format is '%s'; there are text, svg, dot and json",
                            format);
    struct ct_system *sys = cli_load(ctx, args);
    struct cli_output o;
    int status = CLI_FAILED;
    if (sys && cli_output_open(&o, args->output)) {
        const bool ok = strcmp(format, "svg") == 0
                          ? draw_svg(ctx, sys, o.stream)
                          : ct_system_print_graph(ctx, sys, format, o.stream);
        status = cli_output_close(&o, ok);
    }
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
    .examples = {"cotree graph four_bar.yaml", "cotree graph four_bar.yaml -o four_bar.svg"},
    .run = run,
};
