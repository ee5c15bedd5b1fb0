// Commands and options as tables; parsing and help. See cli.h.
#include "cli/cli.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

const struct cli_command *const cli_commands[] = {&cli_simulate,   &cli_report,
                                                  &cli_equations,  &cli_graph,
                                                  &cli_draw,       &cli_accuracy,
                                                  &cli_sweep,      &cli_merge,
                                                  &cli_check,      &cli_equilibrium,
                                                  &cli_modes,      &cli_linearize,
                                                  &cli_buckling,   &cli_kinematics,
                                                  &cli_inverse,    &cli_export,
                                                  &cli_import,     &cli_components,
                                                  &cli_methods,    &cli_schema,
                                                  &cli_completion, NULL};

// ---- options -------------------------------------------------------------------------------

const struct cli_option cli_options[] = {
#define FIELD(f) offsetof(struct cli_args, f)
    {"output", 'o', "FILE", CLI_TEXT, FIELD(output), CLI_MODELS | CLI_LISTS | CLI_IMPORT, true,
     "where results go; the suffix says the type"},
    {"set", 0, "NAME=VALUE", CLI_LIST, FIELD(set), CLI_MODELS, true,
     "another value for a parameter; may be repeated"},
    {"input", 0, "FILE.csv", CLI_TEXT, FIELD(input), CLI_PLAYS, false,
     "plays inputs: columns by name and 't', linear between rows"},
    {"hold", 0, NULL, CLI_FLAG, FIELD(hold), CLI_PLAYS, false,
     "with --input: a row counts from its t on"},
    {"tree", 0, "CHOICE", CLI_TEXT, FIELD(tree), CLI_MODELS, true,
     "auto, joints, absolute, a number of 'graph --trees', or\n"
     "a YAML FILE: lists of branches translation and rotation",
     "auto joints absolute"},
    {"keep-all", 0, NULL, CLI_FLAG, FIELD(keep_all), CLI_MODELS, true,
     "leave nothing out: keep the spatial rows of planar models"},
    {"tolerance", 0, "T", CLI_NUMBER, FIELD(tolerance), CLI_STEPS | CLI_EXPORT, true,
     "wanted relative accuracy of the outputs"},
    {"method", 0, "NAME", CLI_TEXT, FIELD(method), CLI_STEPS, true,
     "auto, or a name that 'cotree methods' lists",
     "auto dop853 dopri5 rk4 radau5 generalized-alpha generalized-alpha-index3 hht newmark"},
    {"step", 0, "H", CLI_NUMBER, FIELD(step), CLI_STEPS, true,
     "fixed step in seconds, without step control"},
    {"until", 0, "T", CLI_NUMBER, FIELD(until), CLI_TIMES | CLI_DRAW | CLI_REPORT | CLI_EXPORT,
     true, "end time in seconds; the spacing of samples is kept"},
    {"samples", 0, "N", CLI_INTEGER, FIELD(samples), CLI_TIMES | CLI_DRAW | CLI_REPORT, true,
     "number of samples, both ends included"},
    {"backend", 0, "CHOICE", CLI_TEXT, FIELD(backend), CLI_STEPS, true,
     "what evaluates the equations: auto, native or tape", "auto native tape"},
    {"solver", 0, "CHOICE", CLI_TEXT, FIELD(solver),
     CLI_SIMULATE | CLI_REPORT | CLI_ACCURACY | CLI_CHECK, false,
     "what finds the accelerations of closed loops: auto,\n"
     "unrolled, one-system, sparse or dense",
     "auto unrolled one-system sparse dense"},
    {"summary", 0, "FILE.json", CLI_TEXT, FIELD(summary), CLI_MODELS, true,
     "what the system is and what the run did, for programs"},
    {"about", 0, "WHERE", CLI_TEXT, FIELD(about), CLI_ABOUT, false,
     "initial, equilibrium, or a time in seconds", "initial equilibrium"},
    {"inputs", 0, "NAMES", CLI_TEXT, FIELD(inputs), CLI_LINEARIZE, false,
     "J.effort, F.force.x, T.torque.z, parameters; a list"},
    {"load", 0, "NAME", CLI_TEXT, FIELD(load), CLI_BUCKLING, false,
     "a force, a torque, a joint with an effort, or gravity"},
    {"curve", 0, "FILE.csv", CLI_TEXT, FIELD(curve), CLI_BUCKLING, false,
     "the lowest frequencies against the load factor"},
    {"count", 0, "N", CLI_COUNT_OF, FIELD(count), CLI_MODES | CLI_BUCKLING, false,
     "number of rows, the lowest ones; 10"},
    {"hold-drivers", 0, NULL, CLI_FLAG, FIELD(hold_drivers), CLI_STATIC, false,
     "equilibrium: motions stand still, even steady ones"},
    {"vary", 0, "NAME=FROM:TO:N", CLI_LIST, FIELD(vary), CLI_VARIES, false,
     "N values of a parameter, both ends included;\n"
     "may be repeated"},
    {"sample", 0, "K", CLI_COUNT_OF, FIELD(sample), CLI_VARIES, false,
     "K random members instead of a grid"},
    {"seed", 0, "S", CLI_SEED, FIELD(seed), CLI_VARIES, false,
     "of the random numbers; 0. Same seed, same members"},
    {"members", 0, "FILE.csv", CLI_TEXT, FIELD(members), CLI_VARIES, false,
     "a member a row, its columns are parameters"},
    {"shard", 0, "I/N", CLI_SHARD, FIELD(shard), CLI_SWEEP, false,
     "every N-th member from the I-th on: one of N parts"},
    {"take", 0, "NAME=F(EXPR)", CLI_LIST, FIELD(take), CLI_SWEEP, false,
     "a column of what EXPR does over the run, F being max, min,\n"
     "mean, rms, final or time (first rise through zero)"},
    {"resume", 0, NULL, CLI_FLAG, FIELD(resume), CLI_SWEEP, false,
     "go on with the rows in FILE.partial"},
    {"threads", 0, "N", CLI_COUNT_OF, FIELD(threads), CLI_SWEEP, false,
     "at most so many; all cores"},
    {"lanes", 0, "N", CLI_COUNT_OF, FIELD(lanes), CLI_SWEEP | CLI_EXPORT, false,
     "1, 4 or 8 side by side: members in a core, inputs of programs"},
    {"verify", 0, NULL, CLI_FLAG, FIELD(verify), CLI_SIMULATE | CLI_REPORT, false,
     "a second run; the difference tells the global error"},
    {"accuracy", 0, NULL, CLI_FLAG, FIELD(accuracy), CLI_REPORT, false,
     "with the work-precision plot, as accuracy --plot draws it"},
    {"error", 0, "E", CLI_NUMBER, FIELD(error), CLI_ACCURACY, false,
     "the error that the cheapest setting must meet; 1e-6"},
    {"per-decade", 0, "N", CLI_COUNT_OF, FIELD(per_decade), CLI_ACCURACY, false,
     "N tolerances a power of ten, from 1e-2 on, or steps"},
    {"elements", 0, "LIST", CLI_TEXT, FIELD(elements), CLI_ACCURACY, false,
     "numbers of elements of the beams, as in 1,2,5"},
    {"formulations", 0, "LIST", CLI_TEXT, FIELD(formulations), CLI_ACCURACY, false,
     "formulations of the beams, as in linear,foreshortening",
     "linear foreshortening force-only stretch-linear"},
    {"reference", 0, "FILE.csv", CLI_TEXT, FIELD(reference), CLI_ACCURACY, false,
     "what to compare with, as simulate writes it"},
    {"plot", 0, "FILE.svg", CLI_TEXT, FIELD(plot), CLI_ACCURACY, false,
     "error against seconds, a line for each method"},
    {"plot", 0, "FILE.svg", CLI_TEXT, FIELD(plot), CLI_MODES, false,
     "shapes of the first modes"},
    {"report", 0, "FILE.html", CLI_TEXT, FIELD(report), CLI_MODES, false,
     "the modes animated, as one HTML page"},
    {"plot", 0, "FILE.svg", CLI_TEXT, FIELD(plot), CLI_SIMULATE, false,
     "the outputs over time, a panel for each unit"},
    {"columns", 0, "LIST", CLI_TEXT, FIELD(columns), CLI_SIMULATE, false,
     "of --plot: names of outputs, as in a,b; all"},
    {"view", 0, "VIEW", CLI_TEXT, FIELD(view), CLI_DRAW, false,
     "x, y, z: along this axis, or iso; planar mechanisms:\n"
     "along their normal, others: iso",
     "x y z iso"},
    {"time", 0, "T", CLI_TIME, FIELD(time), CLI_DRAW, false,
     "the motion is followed to this time in seconds first"},
    {"trace", 0, NULL, CLI_FLAG, FIELD(trace), CLI_DRAW, false,
     "with paths of points and beams' ends over the run"},
    {"trees", 0, NULL, CLI_FLAG, FIELD(trees), CLI_GRAPH, false,
     "the cheapest pairs of trees instead, for --tree"},
    {"show", 0, "STAGES", CLI_TEXT, FIELD(show), CLI_EQUATIONS, false,
     "terminal,graph,tree,cutset,circuit,reduced;\n"
     "standard is tree,reduced",
     "all terminal graph tree cutset circuit reduced"},
    {"full", 0, NULL, CLI_FLAG, FIELD(full), CLI_EQUATIONS, false,
     "all lines of lists, of systems of more than 100 speeds, too"},
    {"format", 0, "FORMAT", CLI_TEXT, FIELD(format), CLI_EQUATIONS, false,
     "text, latex, html, c or json", "text latex html c json"},
    {"format", 0, "FORMAT", CLI_TEXT, FIELD(format), CLI_GRAPH, false,
     "text, svg, png, dot or json", "text svg png dot json"},
    {"format", 0, "FORMAT", CLI_TEXT, FIELD(format), CLI_EXPORT, false, "c, fmu2 or fmu3",
     "c fmu2 fmu3"},
    {"quiet", 'q', NULL, CLI_FLAG, FIELD(quiet), CLI_MODELS, true,
     "no summary and no progress bar"},
    {"help", 'h', NULL, CLI_FLAG, FIELD(help), CLI_MODELS | CLI_LISTS, true, "this text"},
    {"version", 'V', NULL, CLI_FLAG, FIELD(version), 0, true, "the version of the program"},
#undef FIELD
};
const size_t cli_noption = CLI_COUNT(cli_options);

bool cli_is_accepted(const struct cli_option *o, const struct cli_command *c)
{
    return !c || o->use & c->use || (o->is_common && (c->takes_model || o->kind == CLI_FLAG));
}

// ---- messages ------------------------------------------------------------------------------

int cli_complain(const struct cli_command *command, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    fputs("cotree: error: ", stderr);
    vfprintf(stderr, fmt, ap);
    fprintf(stderr, "\ntry: cotree %s%s--help\n", command ? command->name : "",
            command ? " " : "");
    va_end(ap);
    return CLI_USAGE;
}

static bool wrong(const struct cli_command *command, const char *what, const char *name,
                  const char *near)
{
    cli_complain(command, "%s '%s'%s%s%s", what, name, near ? "; did you mean '" : "",
                 near ? near : "", near ? "'?" : "");
    return false;
}

// ---- values --------------------------------------------------------------------------------

static bool parse_number(const char *text, double *v)
{
    char *end;
    *v = strtod(text, &end);
    return end != text && !*end && isfinite(*v) && *v > 0;
}

static bool parse_time(const char *text, double *v)
{
    char *end;
    *v = strtod(text, &end);
    return end != text && !*end && isfinite(*v) && *v >= 0;
}

static bool parse_integer(const char *text, long least, long *v)
{
    // Limit: with a message
    const long most = 1000000000; // what the model file allows
    char *end;
    errno = 0;
    *v = strtol(text, &end, 10);
    return end != text && !*end && !errno && *v >= least && *v <= most;
}

static bool parse_seed(const char *text, unsigned long long *v)
{
    char *end;
    errno = 0;
    *v = strtoull(text, &end, 10);
    return text[0] >= '0' && text[0] <= '9' && !*end && !errno;
}

// Parses I/N. The library checks that I is one of N.
static bool parse_shard(const char *text, long *shard, long *shards)
{
    const size_t n = strcspn(text, "/");
    char first[32];
    if (!text[n] || n >= sizeof first)
        return false;
    snprintf(first, sizeof first, "%.*s", (int)n, text);
    return parse_integer(first, 1, shard) && parse_integer(text + n + 1, 1, shards)
        && *shard <= *shards;
}

static bool wrong_value(const struct cli_command *c, const struct cli_option *o,
                        const char *value, const char *wanted)
{
    return cli_complain(c, "--%s is '%s'; %s is wanted", o->name, value, wanted), false;
}

static bool store(const struct cli_command *c, const struct cli_option *o, const char *value,
                  struct cli_args *args)
{
    void *field = (char *)args + o->field;
    switch (o->kind) {
    case CLI_FLAG:
        *(bool *)field = true;
        return true;
    case CLI_TEXT:
        *(const char **)field = value;
        return *value || (cli_complain(c, "--%s is empty", o->name), false);
    case CLI_LIST: {
        struct cli_list *list = field;
        list->text[list->n++] = value;
        return true;
    }
    case CLI_NUMBER:
        return parse_number(value, field)
            || wrong_value(c, o, value, "a number greater than 0");
    case CLI_TIME:
        args->has_time = true;
        return parse_time(value, field)
            || wrong_value(c, o, value, "a number of seconds, 0 or greater");
    case CLI_SEED:
        return parse_seed(value, field)
            || wrong_value(c, o, value, "an integer from 0 to 18446744073709551615");
    case CLI_SHARD:
        return parse_shard(value, field, &args->shards)
            || wrong_value(c, o, value, "I/N with I from 1 to N");
    case CLI_COUNT_OF:
        return parse_integer(value, 1, field)
            || wrong_value(c, o, value, "an integer from 1 to 1000000000");
    default: // both ends
        return parse_integer(value, 2, field)
            || wrong_value(c, o, value, "an integer from 2 to 1000000000");
    }
}

// ---- parsing -------------------------------------------------------------------------------

struct parser {
    int argc, at;
    char **argv;
    const struct cli_command *command;
    const struct cli_option *option; // the last one
    struct cli_args *args;
};

// The name that was probably meant: one that begins with the text, else a similar one; NULL:
// none.
static const char *find_meant(const char *text, const char *const *names, size_t n)
{
    const size_t length = strlen(text);
    for (size_t i = 0; i < n && length > 1; i++)
        if (strncmp(names[i], text, length) == 0)
            return names[i];
    return ct_did_you_mean(text, names, n);
}

// For an option that this command does not have: false, after a message that names a command
// that has it.
static bool is_nowhere(const struct parser *p, const char *name)
{
    for (size_t i = 0; i < cli_noption; i++)
        for (const struct cli_command *const *c = cli_commands; p->command && *c; c++)
            if (strcmp(cli_options[i].name, name) == 0 && cli_options[i].use & (*c)->use) {
                cli_complain(p->command, "'%s' has no option --%s; '%s' has", p->command->name,
                             name, (*c)->name);
                return false;
            }
    return true;
}

static bool unknown_option(const struct parser *p, const char *name)
{
    const char *names[CLI_COUNT(cli_options)], *plain = name + strspn(name, "-");
    char text[64];
    size_t n = 0;
    for (size_t i = 0; i < cli_noption; i++)
        if (cli_is_accepted(&cli_options[i], p->command))
            names[n++] = cli_options[i].name;
    const char *near = find_meant(plain, names, n);
    if (!near && !is_nowhere(p, plain))
        return false;
    if (near)
        snprintf(text, sizeof text, "--%s", near);
    return wrong(p->command, "no such option:", name, near ? text : NULL);
}

static bool give(struct parser *p, const struct cli_option *o, const char *value)
{
    p->option = o;
    if (o->kind == CLI_FLAG) {
        if (value)
            return cli_complain(p->command, "--%s takes no value", o->name), false;
    } else if (!value) {
        if (p->at + 1 >= p->argc)
            return cli_complain(p->command, "--%s needs a value: %s", o->name, o->value), false;
        value = p->argv[++p->at];
    }
    return store(p->command, o, value, p->args);
}

// --name, --name=value
static bool parse_long(struct parser *p, const char *text)
{
    const size_t n = strcspn(text, "=");
    for (size_t i = 0; i < cli_noption; i++) {
        const struct cli_option *o = &cli_options[i];
        if (strlen(o->name) == n && strncmp(text, o->name, n) == 0
            && cli_is_accepted(o, p->command))
            return give(p, o, text[n] ? text + n + 1 : NULL);
    }
    char name[64];
    snprintf(name, sizeof name, "--%.*s", (int)n, text);
    return unknown_option(p, name);
}

// -o FILE, -oFILE
static bool parse_short(struct parser *p, const char *text)
{
    for (size_t i = 0; i < cli_noption; i++) {
        const struct cli_option *o = &cli_options[i];
        if (o->letter && o->letter == text[1] && cli_is_accepted(o, p->command)
            && (!text[2] || o->kind != CLI_FLAG))
            return give(p, o, text[2] ? text + 2 : NULL);
    }
    return unknown_option(p, text);
}

static bool parse_command(struct parser *p, const char *name)
{
    const char *names[CLI_COUNT(cli_commands)];
    size_t n = 0;
    for (const struct cli_command *const *c = cli_commands; *c; c++) {
        if (strcmp((*c)->name, name) == 0) {
            p->command = *c;
            return true;
        }
        names[n++] = (*c)->name;
    }
    names[n++] = "help"; // in the place of the NULL
    if (strcmp(name, "help") == 0)
        return p->args->help = true;
    const char *dot = strrchr(name, '.');
    if (dot && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0))
        return cli_complain(NULL, "a command is wanted before the model: cotree simulate %s",
                            name),
               false;
    return wrong(NULL, "no such command:", name, find_meant(name, names, n));
}

// Parses one of the words that a command takes instead of a model.
static bool parse_word(struct parser *p, const char *text)
{
    const char *const *words = p->command->words;
    size_t n = 0;
    if (p->args->word)
        return cli_complain(p->command, "one word is enough: '%s' and '%s'", p->args->word,
                            text),
               false;
    p->args->word = text;
    for (; words[n]; n++)
        if (strcmp(words[n], text) == 0)
            return true;
    const char *near = find_meant(text, words, n);
    return cli_complain(p->command, "'%s' knows no '%s'%s%s%s", p->command->name, text,
                        near ? "; did you mean '" : "", near ? near : "", near ? "'?" : ""),
           false;
}

static bool parse_plain(struct parser *p, const char *text)
{
    if (!p->command)
        return parse_command(p, text);
    if (p->command->words)
        return parse_word(p, text);
    if (p->command->files) {
        p->args->files.text[p->args->files.n++] = text;
        return true;
    }
    if (!p->command->takes_model && !p->command->takes_file)
        return cli_complain(p->command, "'%s' takes no model: '%s'", p->command->name, text),
               false;
    if (p->args->model)
        return cli_complain(p->command, "one model is enough: '%s' and '%s'", p->args->model,
                            text),
               false;
    p->args->model = text;
    return true;
}

// Keeps an option as it was written, from argument `first` on, if it affects results.
static void keep_option(struct parser *p, int first)
{
    static const char *const other[] = {"output", "summary", "quiet", "help", "version"};
    struct cli_list *list = &p->args->given;
    for (size_t i = 0; i < CLI_COUNT(other); i++)
        if (strcmp(p->option->name, other[i]) == 0)
            return;
    for (int i = first; i <= p->at; i++)
        list->text[list->n++] = p->argv[i];
}

static bool parse_all(struct parser *p)
{
    bool options_end = false;
    for (p->at = 1; p->at < p->argc; p->at++) {
        const char *text = p->argv[p->at];
        const int first = p->at;
        p->option = NULL;
        bool ok;
        if (options_end || text[0] != '-' || !text[1])
            ok = parse_plain(p, text);
        else if (strcmp(text, "--") == 0)
            ok = options_end = true;
        else
            ok = text[1] == '-' ? parse_long(p, text + 2) : parse_short(p, text);
        if (!ok)
            return false;
        if (p->option)
            keep_option(p, first);
    }
    return true;
}

// Checks that the value of an option is one of its words.
static bool check_word(const struct parser *p, const char *name, const char *value)
{
    const struct cli_option *o = cli_options;
    char text[128];
    size_t n = 0;
    while (strcmp(o->name, name) != 0)
        o++;
    for (const char *w = o->words; *w; w += strspn(w, " ")) {
        const size_t length = strcspn(w, " ");
        if (!value || (strlen(value) == length && strncmp(value, w, length) == 0))
            return true;
        n += (size_t)snprintf(text + n, sizeof text - n, "%s%.*s", n ? ", " : "", (int)length,
                              w);
        w += length;
    }
    return cli_complain(p->command, "--%s is '%s'; there are %s", name, value, text), false;
}

static bool check_words(const struct parser *p)
{
    return check_word(p, "backend", p->args->backend)
        && check_word(p, "solver", p->args->solver);
}

static bool is_same_file(const char *a, const char *b)
{
    struct stat x, y;
    const bool has_a = stat(a, &x) == 0, has_b = stat(b, &y) == 0;
    if (has_a && has_b)
        return S_ISREG(x.st_mode) && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
    return !has_a && !has_b && strcmp(a, b) == 0;
}

// Checks that no output file is an input file or the file of another option.
static bool check_files(const struct parser *p)
{
    const struct cli_args *args = p->args;
    const char *const file[]
        = {args->output, args->summary,   args->plot, args->curve,   args->report,
           args->model,  args->reference, args->tree, args->members, args->input};
    // Definition: of the list below
    enum { WRITTEN = 5 };
    for (size_t i = 0; i < WRITTEN; i++)
        for (size_t j = i + 1; j < CLI_COUNT(file); j++)
            if (file[i] && file[j] && strcmp(file[i], "-") != 0
                && is_same_file(file[i], file[j]))
                return cli_complain(p->command,
                                    j < WRITTEN ? "'%s' is to be written twice: name two files"
                                                : "'%s' is read: write to another file",
                                    file[i]),
                       false;
    return true;
}

bool cli_parse(int argc, char **argv, const struct cli_command **command, struct cli_args *args)
{
    const size_t n = (size_t)argc + 1;
    *args = (struct cli_args){.set.text = calloc(n, sizeof(char *)),
                              .vary.text = calloc(n, sizeof(char *)),
                              .take.text = calloc(n, sizeof(char *)),
                              .files.text = calloc(n, sizeof(char *)),
                              .given.text = calloc(n, sizeof(char *))};
    struct parser p = {.argc = argc, .argv = argv, .args = args};
    const bool has_room = args->set.text && args->vary.text && args->take.text
                       && args->files.text && args->given.text;
    bool ok = has_room || (fputs("cotree: error: out of memory [E001]\n", stderr), false);
    args->no_memory = !has_room;
    ok = ok && parse_all(&p);
    *command = p.command;
    if (!ok || args->help || args->version)
        return ok;
    if (!p.command)
        return cli_complain(NULL, "a command is wanted"), false;
    if (p.command->words && !args->word)
        return cli_complain(p.command, "'%s' needs a word: %s", p.command->name,
                            p.command->examples[0]),
               false;
    if (p.command->files && !args->files.n)
        return cli_complain(p.command, "'%s' needs files: %s", p.command->name,
                            p.command->files),
               false;
    if (p.command->takes_model && !args->model)
        return cli_complain(p.command, "'%s' needs a model: cotree %s MODEL.yaml",
                            p.command->name, p.command->name),
               false;
    if (p.command->takes_file && !args->model)
        return cli_complain(p.command, "'%s' needs a file: cotree %s %s", p.command->name,
                            p.command->name, p.command->takes_file),
               false;
    if (args->hold && !args->input)
        return cli_complain(p.command,
                            "--hold says how the rows of --input count; there is no --input"),
               false;
    return check_words(&p) && check_files(&p);
}

void cli_args_finish(struct cli_args *args)
{
    free(args->set.text);
    free(args->vary.text);
    free(args->take.text);
    free(args->files.text);
    free(args->given.text);
}

// ---- help ----------------------------------------------------------------------------------

static void print_option(FILE *out, const struct cli_option *o)
{
    char left[40];
    const bool is_output = strcmp(o->name, "output") == 0; // it is listed by its letter
    if (is_output)
        snprintf(left, sizeof left, "-%c, --%s %s", o->letter, o->name, o->value);
    else
        snprintf(left, sizeof left, "%s--%s%s%s",
                 o->letter ? (char[]){'-', o->letter, ',', ' ', 0} : "", o->name,
                 o->value ? " " : "", o->value ? o->value : "");
    const char *line = o->help;
    for (const char *title = left;; title = "") {
        const int n = (int)strcspn(line, "\n");
        fprintf(out, "  %-22s %.*s\n", title, n, line);
        if (!line[n])
            return;
        line += n + 1;
    }
}

static void print_program_help(FILE *out)
{
    fputs("usage: cotree COMMAND MODEL.yaml [options]\n\n"
          "Equations of motion of a mechanism from its linear graph, and its motion.\n\n",
          out);
    for (const struct cli_command *const *c = cli_commands; *c; c++)
        fprintf(out, "  %-12s %s\n", (*c)->name, (*c)->summary);
    fputs("\n  cotree help COMMAND     the options of a command; also COMMAND --help\n"
          "  cotree --version        the version of the program; also -V\n\n"
          "Results go to standard output or to -o FILE, messages to standard error.\n"
          "Exit status: 0 done, 1 the model or the run failed, 2 the command line is wrong.\n\n"
          "try:\n"
          "  cotree equations pendulum.yaml\n"
          "  cotree simulate pendulum.yaml -o pendulum.csv\n",
          out);
}

void cli_print_help(FILE *out, const struct cli_command *command)
{
    if (!command) {
        print_program_help(out);
        return;
    }
    fprintf(out, "usage: cotree %s%s%s [options]\n\n%s\n%s\n", command->name,
            command->takes_file || command->files ? " " : "",
            command->takes_file    ? command->takes_file
            : command->takes_model ? " MODEL.yaml"
            : command->words       ? " SHELL"
            : command->files       ? command->files
                                   : "",
            command->summary, command->more);
    for (size_t i = 0; i < cli_noption; i++)
        if (cli_options[i].use & command->use)
            print_option(out, &cli_options[i]);
    fputs("\ntry:\n", out);
    for (size_t i = 0; i < CLI_COUNT(command->examples); i++)
        fprintf(out, "  %s\n", command->examples[i]);
}
