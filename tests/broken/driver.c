// Reads each model named and prints what the reader has to say.
//   driver [--set NAME=VALUE]... MODEL.yaml...
// Exit status: 0 all were read, 1 some were refused.
#include "base/guard.h"
#include "component/model.h"

#include <string.h>

static bool read_one(const char *path, const struct ct_set *set, size_t nset)
{
    struct ct_ctx ctx = {.model = ct_arena_create(), .scratch = ct_arena_create()};
    struct ct_model model;
    bool ok = false;
    struct ct_guard g;
    ct_guard_push(&g);
    if (setjmp(g.env))
        puts("out of memory");
    else
        ok = ct_model_read(&ctx, path, set, nset, &model);
    ct_guard_pop(&g);
    ct_ctx_print(&ctx, stdout);
    if (!ok && !ctx.nerror)
        puts("refused without a word");
    if (ok && ctx.nerror)
        puts("read in spite of an error");
    ct_arena_destroy(ctx.model);
    ct_arena_destroy(ctx.scratch);
    return ok;
}

int main(int argc, char **argv)
{
    enum { MOST = 16 };
    struct ct_set set[MOST] = {{0}};
    size_t nset = 0;
    bool ok = true;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--set") == 0 && i + 1 < argc && nset < MOST)
            set[nset++].text = argv[++i];
        else
            ok &= read_one(argv[i], set, nset);
    }
    return ok ? 0 : 1;
}
