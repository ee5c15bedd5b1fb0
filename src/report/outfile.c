// See outfile.h.
#include "report/outfile.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

static bool cannot(struct ct_ctx *ctx, const char *what, const char *path, int error)
{
    const struct ct_mark nowhere = {0};
    return ct_error(ctx, nowhere, CT_E_FILE, "cannot %s '%s': %s", what, path, strerror(error));
}

static const char *written_path(const struct ct_outfile *o)
{
    return o->partial ? o->partial : o->path;
}

bool ct_outfile_open(struct ct_ctx *ctx, struct ct_outfile *o, const char *path)
{
    *o = (struct ct_outfile){0};
    if (!path) {
        o->path = "standard output";
        o->stream = stdout;
        return true;
    }
    o->path = ct_arena_strdup(ctx->model, path);
    struct stat st;
    if (stat(path, &st) != 0 || S_ISREG(st.st_mode))
        o->partial = ct_arena_printf(ctx->model, "%s.partial", path);
    o->stream = fopen(written_path(o), "w");
    return o->stream || cannot(ctx, "write", written_path(o), errno);
}

bool ct_outfile_flush(struct ct_ctx *ctx, struct ct_outfile *o)
{
    errno = 0;
    if (fflush(o->stream) == 0 && !ferror(o->stream))
        return true;
    return cannot(ctx, "write", written_path(o), errno ? errno : EIO);
}

bool ct_outfile_close(struct ct_ctx *ctx, struct ct_outfile *o)
{
    const bool written = ct_outfile_flush(ctx, o);
    FILE *stream = o->stream;
    o->stream = NULL;
    if (stream != stdout && fclose(stream) != 0 && written)
        return cannot(ctx, "write", written_path(o), errno);
    if (!written)
        return false;
    if (o->partial && rename(o->partial, o->path) != 0)
        return cannot(ctx, "replace", o->path, errno);
    return true;
}

void ct_outfile_abandon(struct ct_outfile *o)
{
    if (o->stream && o->stream != stdout)
        fclose(o->stream);
    o->stream = NULL;
}
