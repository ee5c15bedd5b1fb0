// Text files for callers of the library: see ct_output_open in cotree.h.
#include "report/outfile.h"

#include "base/entry.h"

#include <cotree/cotree.h>

#include <stdlib.h>
#include <string.h>

struct ct_output {
    struct ct_outfile file;
};

struct work {
    struct ct_ctx *ctx;
    struct ct_output *o;
    const char *path;
    bool ok;
};

static bool open_output(void *task)
{
    const struct work *w = task;
    const bool is_standard = !w->path || strcmp(w->path, "-") == 0;
    return ct_outfile_open(w->ctx, &w->o->file, is_standard ? NULL : w->path);
}

struct ct_output *ct_output_open(struct ct_ctx *ctx, const char *path)
{
    if (!ctx)
        return NULL;
    struct work w = {ctx, ct_own_alloc(ctx, sizeof *w.o), path, false};
    if (w.o && ct_enter(ctx, open_output, &w))
        return w.o;
    free(w.o);
    return NULL;
}

FILE *ct_output_stream(const struct ct_output *o)
{
    return o ? o->file.stream : NULL;
}

static bool close_output(void *task)
{
    const struct work *w = task;
    if (w->ok)
        return ct_outfile_close(w->ctx, &w->o->file);
    ct_outfile_discard(&w->o->file);
    return false;
}

bool ct_output_close(struct ct_ctx *ctx, struct ct_output *o, bool ok)
{
    struct work w = {ctx, o, NULL, ok};
    if (!o)
        return false;
    const bool is_there = ct_enter(ctx, close_output, &w);
    ct_outfile_discard(&o->file); // where memory ran out
    free(o);
    return is_there;
}
