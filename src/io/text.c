// See text.h.
#include "io/text.h"

#include "base/guard.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static enum ct_text_result read_all(struct ct_arena *a, FILE *f, size_t most, char **text,
                                    size_t *n)
{
    size_t used = 0, room = 1 << 14;
    char *buffer = ct_arena_alloc(a, room);
    for (;;) {
        const size_t got = fread(buffer + used, 1, room - used - 1, f);
        used += got;
        if (used > most)
            return CT_TEXT_TOO_BIG;
        if (got == 0)
            break;
        if (used == room - 1) {
            char *more = ct_arena_alloc(a, 2 * room);
            memcpy(more, buffer, used);
            buffer = more;
            room *= 2;
        }
    }
    buffer[used] = 0;
    *text = buffer;
    *n = used;
    return ferror(f) ? CT_TEXT_UNREADABLE : CT_TEXT_OK;
}

// Reads f and closes it.
static enum ct_text_result read_and_close(struct ct_arena *a, FILE *f, size_t most, char **text,
                                          size_t *n)
{
    struct stat s;
    if (fstat(fileno(f), &s) == 0 && S_ISDIR(s.st_mode)) {
        fclose(f);
        errno = EISDIR;
        return CT_TEXT_UNREADABLE;
    }
    // if memory runs out, f is closed before the error goes on
    struct ct_guard g;
    ct_guard_push(&g);
    if (setjmp(g.env)) {
        ct_guard_pop(&g);
        fclose(f);
        ct_guard_raise();
    }
    errno = 0;
    const enum ct_text_result result = read_all(a, f, most, text, n);
    ct_guard_pop(&g);
    const int reason = errno;
    fclose(f);
    errno = reason;
    return result;
}

enum ct_text_result ct_text_read(struct ct_arena *a, const char *path, size_t most, char **text,
                                 size_t *n)
{
    FILE *f = fopen(path, "rb");
    return f ? read_and_close(a, f, most, text, n) : CT_TEXT_UNREADABLE;
}

enum ct_text_result ct_text_read_regular(struct ct_arena *a, const char *path, size_t most,
                                         char **text, size_t *n)
{
    // O_NONBLOCK: does not wait for a FIFO
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat s;
    if (fd < 0)
        return CT_TEXT_UNREADABLE;
    const bool may_end = fstat(fd, &s) != 0 || S_ISREG(s.st_mode) || S_ISDIR(s.st_mode);
    FILE *f = may_end ? fdopen(fd, "rb") : NULL;
    if (f)
        return read_and_close(a, f, most, text, n);
    close(fd);
    return may_end ? CT_TEXT_UNREADABLE : CT_TEXT_ENDLESS;
}
