// The command line of cotree. One table lists the commands, another the options; parsing, help
// and completion are derived from both.
//
//     cotree COMMAND MODEL.yaml [options]
//
// What always holds: each command is one file and uses the public API only. Results go to
// standard output, or to a file that appears when it is complete; messages go to standard
// error. Exit status: 0 success, 1 the model or the run failed, 2 the command line is wrong,
// 130 and 143 interrupted by a signal.
#ifndef CT_CLI_CLI_H
#define CT_CLI_CLI_H

#include <cotree/cotree.h>

enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_USAGE = 2 };

#define CLI_COUNT(a) (sizeof(a) / sizeof((a)[0]))

/// The values of all options; zero if not given.
struct cli_args {
    const char *model;
    const char *word; // the word given instead of a model
    const char *output, *summary, *format, *show, *tree, *method, *backend, *solver, *reference,
        *plot, *report, *columns, *view, *about, *inputs, *input, *load, *curve, *elements,
        *formulations, *members;
    struct cli_list { // what is given several times
        const char **text;
        size_t n;
    } set, vary, take,
        files, // files given instead of a model
        given; // options that affect results, as written, for the report
    double tolerance, step, until, error, time;
    long samples, count, sample, threads, lanes, per_decade, shard, shards;
    unsigned long long seed;
    bool has_time; // --time was given, which may be 0
    bool accuracy, trace, trees, full, hold, hold_drivers, keep_all, resume, verify, quiet,
        help, version,
        no_memory; // memory ran out while parsing
};

/// One bit for each command, for the table of options.
enum cli_use {
    CLI_SIMULATE = 1,
    CLI_EQUATIONS = 2,
    CLI_GRAPH = 4,
    CLI_CHECK = 8,
    CLI_COMPONENTS = 16,
    CLI_METHODS = 32,
    CLI_SCHEMA = 64,
    CLI_EXPORT = 128,
    CLI_ACCURACY = 256,
    CLI_EQUILIBRIUM = 512,
    CLI_MODES = 1024,
    CLI_LINEARIZE = 2048,
    CLI_KINEMATICS = 4096,
    CLI_INVERSE = 8192,
    CLI_BUCKLING = 16384,
    CLI_SWEEP = 32768,
    CLI_COMPLETION = 65536,
    CLI_DRAW = 131072,
    CLI_MERGE = 262144,
    CLI_REPORT = 524288,
    CLI_IMPORT = 1048576,
    CLI_LISTS = CLI_COMPLETION | CLI_COMPONENTS | CLI_METHODS | CLI_SCHEMA,
    CLI_DRIVEN = CLI_KINEMATICS | CLI_INVERSE,
    CLI_ABOUT = CLI_MODES | CLI_LINEARIZE, // linearise about a configuration
    CLI_STATIC = CLI_ABOUT | CLI_EQUILIBRIUM | CLI_BUCKLING,
    CLI_RUNS = CLI_SIMULATE | CLI_ACCURACY | CLI_SWEEP,
    CLI_STEPS = CLI_RUNS | CLI_DRAW | CLI_REPORT, // may integrate
    CLI_TIMES = CLI_RUNS | CLI_DRIVEN,
    CLI_TABLES = CLI_TIMES | CLI_STATIC,            // write a table to -o
    CLI_PLAYS = CLI_TABLES | CLI_DRAW | CLI_REPORT, // evaluate the model at one time or more
    CLI_VARIES = CLI_SWEEP | CLI_MODES | CLI_EQUILIBRIUM | CLI_DRIVEN,
    CLI_MODELS = CLI_TIMES | CLI_STATIC | CLI_EQUATIONS | CLI_GRAPH | CLI_DRAW | CLI_REPORT
               | CLI_CHECK | CLI_EXPORT
};

struct cli_command {
    const char *name, *summary; // one line
    enum cli_use use;
    bool takes_model;
    const char *takes_file;   // kind of file taken instead of a model; or NULL
    const char *const *words; // words taken instead of a model, NULL at the end; or NULL
    const char *files;        // the same for a list of files; or NULL
    const char *more;         // paragraph for the command's help
    const char *examples[2];  // to try
    int (*run)(struct ct_ctx *ctx, const struct cli_args *args);
};

extern const struct cli_command cli_simulate, cli_report, cli_equations, cli_graph, cli_draw,
    cli_accuracy, cli_check, cli_equilibrium, cli_modes, cli_linearize, cli_kinematics,
    cli_inverse, cli_buckling, cli_sweep, cli_merge, cli_export, cli_import, cli_components,
    cli_methods, cli_schema, cli_completion;
/// All commands in the order of --help; NULL at the end.
extern const struct cli_command *const cli_commands[];

/// An option: the member of cli_args that takes its value, and its description for help and
/// completion.
struct cli_option {
    const char *name;
    char letter;       // 0: none
    const char *value; // name of the value in the help; NULL: it has none
    enum cli_kind {
        CLI_FLAG,
        CLI_TEXT,
        CLI_LIST,
        CLI_NUMBER,
        CLI_TIME,
        CLI_INTEGER,
        CLI_COUNT_OF,
        CLI_SEED,
        CLI_SHARD
    } kind;
    size_t field;
    unsigned use;      // bits of the commands that use it
    bool is_common;    // accepted without effect by all commands that take a model
    const char *help;  // lines are broken by hand
    const char *words; // its possible values, separated by blanks; NULL: any value
};
/// All options in the order of --help.
extern const struct cli_option cli_options[];
extern const size_t cli_noption;
/// Does the command accept the option? command NULL: no command was given.
bool cli_is_accepted(const struct cli_option *o, const struct cli_command *command);

/// Parses argv: the command (NULL: none was given) and its arguments. False after a message;
/// exit status 2.
bool cli_parse(int argc, char **argv, const struct cli_command **command,
               struct cli_args *args);
void cli_args_finish(struct cli_args *args);
/// Prints the help of the program (command NULL) or of one command.
void cli_print_help(FILE *out, const struct cli_command *command);
/// Prints a message about the command line, with a hint to the help. Returns CLI_USAGE.
int cli_complain(const struct cli_command *command, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

/// Options of systems from the arguments.
struct ct_system_options cli_system_options(const struct cli_args *args);
/// The same for analyses about a configuration, with additional columns.
struct ct_system_options cli_analysis_options(const struct cli_args *args,
                                              enum ct_columns_more columns);
/// Loads the system of the arguments; NULL on failure.
struct ct_system *cli_load(struct ct_ctx *ctx, const struct cli_args *args);
/// The same with additional columns.
struct ct_system *cli_load_with(struct ct_ctx *ctx, const struct cli_args *args,
                                enum ct_columns_more columns);
/// Options of runs from the arguments.
struct ct_sim_options cli_sim_options(const struct cli_args *args);
/// Creates a run with the options of the arguments; NULL on failure.
struct ct_sim *cli_sim(struct ct_ctx *ctx, struct ct_system *sys, const struct cli_args *args);

/// If the arguments vary parameters, runs the whole analysis and returns true, with the exit
/// status in *status. Without -o the table goes to a file named after the model with `suffix`;
/// NULL: to standard output.
bool cli_vary(struct ct_ctx *ctx, const struct cli_command *command,
              const struct cli_args *args, const struct ct_system_options *system,
              const struct ct_vary_options *analysis, const char *suffix, int *status);

/// Writes the file of --summary, if requested, for a command without a run: the properties of
/// the system.
bool cli_summarize(struct ct_ctx *ctx, struct ct_system *sys, const struct cli_args *args);

/// Integrates (ct_sim_run) or follows a motion prescribed by drivers (ct_sim_follow).
typedef bool cli_motion(struct ct_ctx *ctx, struct ct_sim *sim,
                        const struct ct_sim_results *results);
/// Receives each sample, as `row` of struct ct_sim_results.
typedef bool cli_row(void *user, double t, const double *value, size_t n);
/// Makes a run of a system (NULL: returns false) and writes its samples; row may be NULL.
bool cli_run_system(struct ct_ctx *ctx, const struct cli_args *args, const char *suffix,
                    struct ct_system *sys, cli_motion *motion, cli_row *row, void *user);
/// A whole command that writes the samples of a motion; returns its exit status. Without -o the
/// results go to a file named after the model with `suffix`.
int cli_run_motion(struct ct_ctx *ctx, const struct cli_args *args, const char *suffix,
                   enum ct_columns_more columns, cli_motion *motion);

/// The format from --format or the suffix of -o; suffixes[i] belongs to formats[i]. NULL after
/// a message.
const char *cli_format(const struct cli_command *command, const struct cli_args *args,
                       const char *const *formats, const char *const *suffixes, size_t n);

/// The model's file name with another suffix (".csv"), in the current folder; to be freed. NULL
/// if memory is exhausted.
char *cli_standard_path(const char *model, const char *suffix);

/// A command that prints a list, to a file with this suffix if requested.
int cli_print_list(struct ct_ctx *ctx, const struct cli_command *command,
                   const struct cli_args *args, const char *suffix, void (*print)(FILE *out));

/// Checks, before anything is read, that there is a format for every output file. CLI_DONE or
/// CLI_USAGE.
int cli_check_suffixes(struct ct_ctx *ctx, const struct cli_command *command,
                       const struct cli_args *args);

// ---- interrupt.c ---------------------------------------------------------------------------

/// Makes SIGINT and SIGTERM cancel the present context; the process ends within a second in any
/// case. Call before other threads are created.
void cli_interrupt_begin(void);
/// Has a signal arrived?
bool cli_is_interrupted(void);
/// Sets the context that a signal cancels. If one has arrived, cancels it at once. NULL: none.
void cli_interrupt_cancels(struct ct_ctx *ctx);
/// Sets the text to be printed if the process must be ended; NULL: none.
void cli_interrupt_explain(const char *what_stays);
/// Returns the exit status: 128 + the signal number if one arrived and the work failed; else
/// `status`.
int cli_interrupt_status(int status);
/// Restores the signals, for a child process.
void cli_interrupt_end(void);

#endif
