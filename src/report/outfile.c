// See outfile.h.
#include "report/outfile.h"

#include <cotree/cotree.h>

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const struct ct_mark nowhere = {0};

static bool cannot(struct ct_ctx *ctx, const char *what, const char *path, int error)
{
    return ct_error(ctx, nowhere, CT_E_FILE, "cannot %s '%s': %s", what, path, strerror(error));
}

static const char *written_path(const struct ct_outfile *o)
{
    return o->partial ? o->partial : o->path;
}

// ---- the partial file ----------------------------------------------------------------------

enum lock { LOCKED, LOST, REFUSED };

static bool is_at(const struct stat *file, const char *path)
{
    struct stat there;
    return lstat(path, &there) == 0 && there.st_dev == file->st_dev
        && there.st_ino == file->st_ino;
}

// Locks the partial file. LOST: another process has renamed it between opening and locking.
static enum lock lock(struct ct_ctx *ctx, const struct ct_outfile *o, int fd)
{
    struct stat file;
    if (fstat(fd, &file) != 0)
        return cannot(ctx, "write", o->partial, errno), REFUSED;
    if (!S_ISREG(file.st_mode) || file.st_nlink > 1)
        return ct_error(ctx, nowhere, CT_E_FILE,
                        "cannot write '%s': it is a link or no regular file; remove it",
                        o->partial),
               REFUSED;
    if (flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return ct_error(ctx, nowhere, CT_E_BUSY,
                        "'%s' is being written by another run ('%s' is locked): wait for its "
                        "end, or write to another file",
                        o->path, o->partial),
               REFUSED;
    return is_at(&file, o->partial) ? LOCKED : LOST;
}

// The descriptor of the partial file, locked, or -1.
static int open_partial(struct ct_ctx *ctx, const struct ct_outfile *o)
{
    for (;;) {
        // without O_NONBLOCK a FIFO of that name would block
        const int fd
            = open(o->partial, O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
        if (fd < 0)
            return errno == ELOOP
                     ? (ct_error(ctx, nowhere, CT_E_FILE,
                                 "cannot write '%s': it is a link; remove it", o->partial),
                        -1)
                     : (cannot(ctx, "write", o->partial, errno), -1);
        const enum lock g = lock(ctx, o, fd);
        if (g == LOCKED)
            return fd;
        close(fd);
        if (g == REFUSED)
            return -1;
    }
}

static bool open_file(struct ct_ctx *ctx, struct ct_outfile *o, const char *path, bool is_kept)
{
    *o = (struct ct_outfile){0};
    if (!path) {
        o->path = "standard output";
        o->stream = stdout;
        return true;
    }
    o->path = ct_arena_strdup(ctx->model, path);
    struct stat st;
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode)) {
        o->stream = fopen(path, "w");
        return o->stream || cannot(ctx, "write", path, errno);
    }
    o->partial = ct_arena_printf(ctx->model, "%s.partial", path);
    const int fd = open_partial(ctx, o);
    if (fd < 0)
        return false;
    const bool is_ready = is_kept || ftruncate(fd, 0) == 0;
    o->stream = is_ready ? fdopen(fd, "r+") : NULL;
    if (o->stream)
        return true;
    cannot(ctx, "write", o->partial, errno);
    close(fd);
    return false;
}

bool ct_outfile_open(struct ct_ctx *ctx, struct ct_outfile *o, const char *path)
{
    return open_file(ctx, o, path, false);
}

bool ct_outfile_reopen(struct ct_ctx *ctx, struct ct_outfile *o, const char *path)
{
    return open_file(ctx, o, path, true);
}

// ---- writing and the end -------------------------------------------------------------------

bool ct_outfile_flush(struct ct_ctx *ctx, struct ct_outfile *o)
{
    errno = 0;
    if (fflush(o->stream) == 0 && !ferror(o->stream))
        return true;
    return cannot(ctx, "write", written_path(o), errno ? errno : EIO);
}

// The lock is held until the file has its name.
static bool keep_partial(struct ct_ctx *ctx, struct ct_outfile *o)
{
    if (fsync(fileno(o->stream)) != 0 && errno != EINVAL)
        return cannot(ctx, "write", o->partial, errno);
    return rename(o->partial, o->path) == 0 || cannot(ctx, "replace", o->path, errno);
}

bool ct_outfile_close(struct ct_ctx *ctx, struct ct_outfile *o)
{
    bool ok = ct_outfile_flush(ctx, o);
    if (ok && o->partial)
        ok = keep_partial(ctx, o);
    FILE *stream = o->stream;
    o->stream = NULL;
    if (stream != stdout && fclose(stream) != 0 && ok)
        return cannot(ctx, "write", o->path, errno);
    return ok;
}

void ct_outfile_abandon(struct ct_outfile *o)
{
    if (o->stream && o->stream != stdout)
        fclose(o->stream);
    o->stream = NULL;
}

void ct_outfile_discard(struct ct_outfile *o)
{
    if (o->stream && o->partial) // while it is locked
        remove(o->partial);
    ct_outfile_abandon(o);
}
