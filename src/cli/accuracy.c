// cotree accuracy: compares methods by error and run time, and finds the cheapest accurate
// setting.
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

static bool report(struct ct_ctx *ctx, const struct ct_accuracy *a, const struct cli_args *args)
{
    bool ok = ct_accuracy_write(ctx, a, args->output);
    if (args->plot)
        ok = ct_accuracy_draw(ctx, a, args->plot) && ok;
    if (!args->quiet)
        ct_accuracy_print_summary(a, stderr);
    return ok;
}

// Limit: with a message
enum { MOST = 16 }; // entries of a list, so 256 variants

// Splits "a,b,c" in place; returns the number of entries, 0 for NULL, -1 for too many.
static int split(char *text, char *entry[MOST])
{
    int n = 0;
    for (char *e = text; e; n++) {
        char *comma = strchr(e, ',');
        if (n == MOST)
            return -1;
        entry[n] = e;
        e = comma ? comma + 1 : NULL;
        if (comma)
            *comma = 0;
    }
    return n;
}

// The beam variants to compare, and that of the reference: twice the largest number of elements
// and the last formulation.
struct beams {
    char *text[2], *entry[2][MOST];
    int n[2];
    long elements[MOST], most;
    struct ct_accuracy_variant variant[MOST * MOST];
    size_t nvariant;
};

static bool read_lists(struct beams *b, const struct cli_args *args, int *status)
{
    const char *const given[2] = {args->elements, args->formulations};
    for (int k = 0; k < 2; k++) {
        b->text[k] = given[k] ? strdup(given[k]) : NULL;
        if (given[k] && !b->text[k]) {
            fputs("cotree: error: out of memory [E001]\n", stderr);
            *status = CLI_FAILED;
            return false;
        }
        b->n[k] = split(b->text[k], b->entry[k]);
        if (b->n[k] < 0)
            return cli_complain(&cli_accuracy, "at most %d entries in a list of beams", MOST),
                   false;
    }
    for (int i = 0; i < b->n[0]; i++) {
        char *end;
        b->elements[i] = strtol(b->entry[0][i], &end, 10);
        if (*end || end == b->entry[0][i] || b->elements[i] < 1 || b->elements[i] > 1000)
            return cli_complain(&cli_accuracy, "--elements: '%s' is no number of elements",
                                b->entry[0][i]),
                   false;
        b->most = b->elements[i] > b->most ? b->elements[i] : b->most;
    }
    return true;
}

static struct ct_system *load(struct ct_ctx *ctx, const struct cli_args *args, long elements,
                              const char *formulation)
{
    struct ct_system_options o = cli_system_options(args);
    o.beam_elements = elements;
    o.beam_formulation = formulation;
    return ct_system_load(ctx, args->model, &o);
}

static bool load_variants(struct ct_ctx *ctx, const struct cli_args *args, struct beams *b)
{
    for (int i = 0; i < (b->n[0] ? b->n[0] : 1); i++)
        for (int k = 0; k < (b->n[1] ? b->n[1] : 1); k++) {
            struct ct_accuracy_variant *v = &b->variant[b->nvariant++];
            v->elements = b->n[0] ? b->elements[i] : 0;
            v->formulation = b->n[1] ? b->entry[1][k] : NULL;
            v->system = load(ctx, args, v->elements, v->formulation);
            if (!v->system)
                return false;
        }
    return true;
}

static bool study(struct ct_ctx *ctx, const struct cli_args *args, struct beams *b)
{
    const bool varies = b->n[0] || b->n[1];
    if (varies && !load_variants(ctx, args, b))
        return false;
    struct ct_system *sys
        = load(ctx, args, 2 * b->most, b->n[1] ? b->entry[1][b->n[1] - 1] : NULL);
    const struct ct_accuracy_options options = {.run = cli_sim_options(args),
                                                .error = args->error,
                                                .per_decade = (int)args->per_decade,
                                                .variant = varies ? b->variant : NULL,
                                                .nvariant = b->nvariant,
                                                .reference = args->reference,
                                                .bar = args->quiet ? NULL : stderr};
    struct ct_accuracy *a = ct_accuracy_create(ctx, sys, &options);
    const bool ok = a && report(ctx, a, args) && cli_summarize(ctx, sys, args);
    ct_accuracy_destroy(a);
    ct_system_destroy(sys);
    return ok;
}

static int run(struct ct_ctx *ctx, const struct cli_args *args)
{
    struct beams b = {0};
    int status = CLI_USAGE;
    if (read_lists(&b, args, &status))
        status = study(ctx, args, &b) ? CLI_DONE : CLI_FAILED;
    for (size_t i = 0; i < b.nvariant; i++)
        ct_system_destroy(b.variant[i].system);
    for (int k = 0; k < 2; k++)
        free(b.text[k]);
    return status;
}

const struct cli_command cli_accuracy = {
    .name = "accuracy",
    .summary = "computing time against error, for several methods and tolerances",
    .use = CLI_ACCURACY,
    .takes_model = true,
    .more
    = "\n"
      "Prints a table: the error of a run is the largest difference of an output to the\n"
      "reference, against the largest value of that output. Says which setting is the "
      "cheapest\n"
      "that meets --error. Without --reference tight runs of two methods must agree.\n"
      "\n"
      "--method is a list here, as in auto,dopri5. --tolerance and --step, where they are\n"
      "given, are the only ones tried. Takes up to a minute, longer for large systems.\n"
      "\n"
      "--elements and --formulations try beams other than the file's. The reference has twice "
      "the\n"
      "largest number of elements and the last formulation.\n",
    .examples = {"cotree accuracy pendulum.yaml --error 1e-8 --plot pendulum.svg",
                 "cotree accuracy pendulum.yaml --method dopri5,rk4 -o pendulum.csv"},
    .run = run,
};
