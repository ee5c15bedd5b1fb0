// print_equations MODEL STAGES FORMAT [absolute]: the derivation of a model on standard output, for
// golden files.
#include "formulate/formulate.h"
#include "report/equations_print.h"

#include <string.h>

static unsigned stages_of(const char *list)
{
    unsigned stages = 0;
    while (*list) {
        const size_t n = strcspn(list, ",");
        stages |= ct_stage_find(list, n);
        list += n + (list[n] == ',');
    }
    return stages;
}

static bool print(struct ct_ctx *ctx, const char *path, unsigned stages,
                  enum ct_equations_format format, enum ct_tree_choice tree)
{
    struct ct_model m;
    struct ct_equations e;
    struct ct_tree_report report;
    const struct ct_formulate_options o = {.tree = tree};
    return ct_model_read(ctx, path, NULL, 0, &m)
        && ct_formulate(ctx, ctx->model, &m, &o, &e, &report)
        && ct_equations_print(stdout, ctx->scratch, &e, &m, stages, format, false);
}

int main(int argc, char **argv)
{
    enum ct_equations_format format;
    const bool is_absolute = argc == 5 && !strcmp(argv[4], "absolute");
    if ((argc != 4 && !is_absolute) || !ct_equations_format_find(argv[3], &format)) {
        fprintf(stderr,
                "usage: print_equations MODEL STAGES text|latex|html|c|json [absolute]\n");
        return 2;
    }
    struct ct_ctx ctx = {.model = ct_arena_create(), .scratch = ct_arena_create()};
    const bool ok = ctx.model && ctx.scratch
                 && print(&ctx, argv[1], stages_of(argv[2]), format,
                          is_absolute ? CT_TREE_ABSOLUTE : CT_TREE_AUTO);
    if (!ok)
        ct_ctx_print(&ctx, stderr);
    ct_arena_destroy(ctx.scratch);
    ct_arena_destroy(ctx.model);
    return !ok;
}
