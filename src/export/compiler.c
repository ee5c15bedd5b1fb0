// Compiles the source of an FMU to a shared library by the system's compiler. See fmu.h.
//
// What always holds: the same source and the same compiler give the same bytes, because the
// library contains no debugging information and no path.
#include "export/fmu.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static bool write_text(struct ct_arena *a, const char *folder, const char *name,
                       const char *text)
{
    FILE *file = fopen(ct_arena_printf(a, "%s/%s", folder, name), "w");
    if (!file)
        return false;
    const bool ok = fputs(text, file) >= 0;
    return fclose(file) == 0 && ok;
}

// Returns the exit status of cc; 127 if there is no cc.
static int run_compiler(struct ct_arena *a, const char *folder, const char *name)
{
    char *const argument[] = {ct_arena_strdup(a, "cc"),
                              ct_arena_strdup(a, "-std=c99"),
                              ct_arena_strdup(a, "-O1"),
                              ct_arena_strdup(a, "-ffp-contract=off"),
                              ct_arena_strdup(a, "-fPIC"),
                              ct_arena_strdup(a, "-shared"),
                              ct_arena_strdup(a, "-fvisibility=hidden"),
                              ct_arena_strdup(a, "-s"),
                              ct_arena_strdup(a, "-o"),
                              ct_arena_printf(a, "%s/%s.so", folder, name),
                              ct_arena_printf(a, "%s/fmu.c", folder),
                              ct_arena_strdup(a, "-lm"),
                              NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return 127;
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO,
                                     ct_arena_printf(a, "%s/said", folder),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0666);
    const int failed = posix_spawnp(&child, "cc", &actions, NULL, argument, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed)
        return 127;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return 127;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 126;
}

static unsigned char *read_whole(struct ct_arena *a, const char *path, size_t *n)
{
    FILE *file = fopen(path, "rb");
    long size = -1;
    if (file && fseek(file, 0, SEEK_END) == 0)
        size = ftell(file);
    unsigned char *b = size >= 0 ? CT_NEWN(a, unsigned char, (size_t)size + 1) : NULL;
    const bool ok
        = b && fseek(file, 0, SEEK_SET) == 0 && fread(b, 1, (size_t)size, file) == (size_t)size;
    if (file)
        fclose(file);
    *n = ok ? (size_t)size : 0;
    return ok ? b : NULL;
}

// First line of the messages of cc.
static const char *first_line(struct ct_arena *a, const char *folder)
{
    size_t n;
    char *text = (char *)read_whole(a, ct_arena_printf(a, "%s/said", folder), &n);
    if (!text || !n)
        return "it failed";
    text[strcspn(text, "\n")] = 0;
    const char *own = strstr(text, folder); // removes the path of the temporary folder
    return own ? own + strlen(folder) + 1 : text;
}

static void remove_all(struct ct_arena *a, const char *folder, const char *name)
{
    const char *const files[] = {"fmu.c", "said"};
    const char *const suffix[] = {"c", "h", "so"};
    for (size_t i = 0; i < COUNT(files); i++)
        remove(ct_arena_printf(a, "%s/%s", folder, files[i]));
    for (size_t i = 0; i < COUNT(suffix); i++)
        remove(ct_arena_printf(a, "%s/%s.%s", folder, name, suffix[i]));
    rmdir(folder);
}

struct ct_compiled ct_compile_library(struct ct_arena *a, const char *name, const char *header,
                                      const char *source, const char *fmu)
{
    struct ct_compiled out = {0};
    const char *place = getenv("TMPDIR");
    char *folder = ct_arena_printf(a, "%s/cotree-XXXXXX", place && *place ? place : "/tmp");
    if (!mkdtemp(folder)) {
        out.why_not = ct_arena_printf(a, "cannot make a folder in '%s': %s",
                                      place && *place ? place : "/tmp", strerror(errno));
        return out;
    }
    if (!write_text(a, folder, ct_arena_printf(a, "%s.h", name), header)
        || !write_text(a, folder, ct_arena_printf(a, "%s.c", name), source)
        || !write_text(a, folder, "fmu.c", fmu)) {
        out.why_not = "cannot write where temporary files are";
    } else {
        const int status = run_compiler(a, folder, name);
        if (status == 127)
            out.why_not = "there is no C compiler 'cc'";
        else if (status != 0)
            out.why_not = ct_arena_printf(a, "cc: %s", first_line(a, folder));
        else
            out.b = read_whole(a, ct_arena_printf(a, "%s/%s.so", folder, name), &out.n);
    }
    remove_all(a, folder, name);
    if (!out.b && !out.why_not)
        out.why_not = "cc wrote nothing";
    return out;
}
