// Joins shards into one file: the rows of all members in order, byte for byte those of the
// whole sweep.
//
//     PART.settings   what the rows depend on, and a line `shard  I of N, of M members`
//     row k (from 0)  the next one of shard k mod N + 1
#include "study/study.h"

#include "io/text.h"
#include "report/outfile.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const struct ct_mark none = {0};

struct part {
    const char *path;
    const char *settings; // without the line of the shard
    long shard, nshard, nall;
    FILE *in;
    char *line; // the line read last  (size)
    size_t size, length;
    long nline;
};

struct merge {
    struct ct_ctx *ctx;
    const char *path;
    struct part *part;
    size_t n;
    struct part **of_shard; // (nshard of the first part)
    struct ct_outfile out;
};

// ---- parts ---------------------------------------------------------------------------------

static bool is_there(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0;
}

static bool open_part(struct merge *m, struct part *p)
{
    struct stat st;
    p->in = fopen(p->path, "r");
    if (p->in && fstat(fileno(p->in), &st) == 0 && S_ISREG(st.st_mode))
        return true;
    const char *partial = ct_arena_printf(m->ctx->model, "%s.partial", p->path);
    if (!p->in && errno == ENOENT && is_there(partial))
        return ct_error(m->ctx, none, CT_E_PART_MISSING,
                        "the part '%s' is not complete: there is only '%s', of a sweep that is "
                        "running or was interrupted; the same command with --resume goes on",
                        p->path, partial);
    return ct_error(m->ctx, none, CT_E_PART_MISSING, "the part '%s' is missing: %s", p->path,
                    p->in ? "it is no regular file" : strerror(errno));
}

// Reads the settings and removes the line of the shard from them.
static bool read_settings(struct merge *m, struct part *p)
{
    // Limit: with a message.
    enum { MOST_TEXT = 1 << 20 };
    struct ct_arena *a = m->ctx->model;
    const char *path = ct_arena_printf(a, "%s.settings", p->path);
    char *text, *shard;
    size_t n;
    int end = 0;
    if (ct_text_read_regular(a, path, MOST_TEXT, &text, &n) != CT_TEXT_OK)
        return ct_error(m->ctx, none, CT_E_PART_OTHER,
                        "there is no '%s' that says which sweep '%s' is a part of: it is "
                        "written by 'sweep --shard', and goes with its file",
                        path, p->path);
    shard = strstr(text, "\nshard ");
    if (!shard
        || sscanf(shard, " shard %ld of %ld, of %ld members%n", &p->shard, &p->nshard, &p->nall,
                  &end)
               != 3
        || !end || p->shard < 1 || p->shard > p->nshard || p->nall > CT_MOST_MEMBERS)
        return ct_error(m->ctx, none, CT_E_PART_OTHER,
                        "'%s' is no part of a sweep: '%s' names no shard; parts are written by "
                        "'sweep --shard I/N'",
                        p->path, path);
    const char *rest = shard + end;
    p->settings = ct_arena_printf(a, "%.*s%s", (int)(shard - text), text, rest);
    return true;
}

static bool compare(struct merge *m, const struct part *p)
{
    const struct part *first = &m->part[0];
    struct ct_setting_difference d;
    if (p->nshard != first->nshard || p->nall != first->nall)
        return ct_error(m->ctx, none, CT_E_PART_OTHER,
                        "'%s' is a part of another sweep: it is shard %ld of %ld of %ld "
                        "members, and '%s' is shard %ld of %ld of %ld members",
                        p->path, p->shard, p->nshard, p->nall, first->path, first->shard,
                        first->nshard, first->nall);
    if (!ct_study_find_difference(m->ctx->model, first->settings, p->settings, &d))
        return true;
    if (ct_setting_is_file(d.name) && d.before && d.now)
        return ct_error(m->ctx, none, CT_E_PART_OTHER,
                        "'%s' is a part of another sweep: its %s is not that of '%s'", p->path,
                        strcmp(d.name, "member") == 0 ? "file of members" : d.name,
                        first->path);
    return ct_error(m->ctx, none, CT_E_PART_OTHER,
                    "'%s' is a part of another sweep: '%s' is %s there and %s in '%s'", p->path,
                    d.name, d.now ? d.now : "not given", d.before ? d.before : "not given",
                    first->path);
}

// Checks that all shards are there, each once.
static bool find_shards(struct merge *m)
{
    // Layout: of a message
    enum { MOST_NAMED = 10 };
    const long n = m->part[0].nshard;
    long missing = 0;
    const char *names = "";
    bool ok = true;
    m->of_shard = CT_NEWN(m->ctx->model, struct part *, (size_t)n);
    for (size_t i = 0; i < m->n; i++) {
        struct part *p = &m->part[i], **there = &m->of_shard[p->shard - 1];
        if (*there)
            ok = ct_error(m->ctx, none, CT_E_PART_OTHER, "'%s' and '%s' are both shard %ld/%ld",
                          (*there)->path, p->path, p->shard, n);
        *there = p;
    }
    for (long k = 0; k < n; k++)
        if (!m->of_shard[k] && missing++ < MOST_NAMED)
            names = ct_arena_printf(m->ctx->model, "%s%s%ld/%ld", names, *names ? ", " : "",
                                    k + 1, n);
    if (missing)
        ok = ct_error(m->ctx, none, CT_E_PART_MISSING, "%s missing: %s%s",
                      missing == 1 ? "a part of the sweep is" : "parts of the sweep are", names,
                      missing > MOST_NAMED ? ", ..." : "");
    return ok;
}

static bool read_parts(struct merge *m, const char *const *path)
{
    bool ok = true;
    if (!m->n)
        return ct_error(m->ctx, none, CT_E_USAGE, "there are no parts to merge");
    for (size_t i = 0; i < m->n; i++) {
        m->part[i].path = path[i];
        ok &= open_part(m, &m->part[i]);
    }
    for (size_t i = 0; i < m->n && ok; i++)
        ok = read_settings(m, &m->part[i]);
    for (size_t i = 1; i < m->n && ok; i++)
        ok = compare(m, &m->part[i]);
    return ok && find_shards(m);
}

// ---- rows ----------------------------------------------------------------------------------

static bool next_line(struct part *p)
{
    const ssize_t n = getline(&p->line, &p->size, p->in);
    p->length = n > 0 ? (size_t)n : 0;
    p->nline++;
    return n > 0 && p->line[n - 1] == '\n';
}

static bool is_damaged(struct merge *m, const struct part *p, const char *why)
{
    return ct_error(m->ctx, (struct ct_mark){.file = p->path, .line = (int)p->nline - 1},
                    CT_E_PART_DAMAGED, "the part is not whole: %s", why);
}

// Counts the commas between fields. Names of columns may be quoted.
static size_t count_commas(const char *line)
{
    size_t n = 0;
    bool is_quoted = false;
    for (; *line; line++) {
        is_quoted ^= *line == '"';
        n += *line == ',' && !is_quoted;
    }
    return n;
}

static bool merge_headers(struct merge *m)
{
    struct part *first = &m->part[0];
    for (size_t i = 0; i < m->n; i++) {
        struct part *p = &m->part[i];
        if (!next_line(p) || strncmp(p->line, "run,", 4) != 0)
            return is_damaged(m, p, "it does not begin with the names of columns");
        if (i && strcmp(p->line, first->line) != 0)
            return ct_error(m->ctx, (struct ct_mark){.file = p->path}, CT_E_PART_OTHER,
                            "'%s' is a part of another sweep: its columns are not those of "
                            "'%s'",
                            p->path, first->path);
    }
    fputs(first->line, m->out.stream);
    return true;
}

// Is the line read last a row with this run number and a field for each column?
static bool is_row(const struct part *p, long run, size_t ncomma)
{
    char *end;
    return strtol(p->line, &end, 10) == run && *end == ',' && count_commas(p->line) == ncomma
        && p->length > 3
        && (strcmp(p->line + p->length - 3, ",0\n") == 0
            || strcmp(p->line + p->length - 3, ",1\n") == 0);
}

static bool merge_rows(struct merge *m, size_t ncomma)
{
    const long nshard = m->part[0].nshard, nall = m->part[0].nall;
    for (long k = 0; k < nall; k++) {
        struct part *p = m->of_shard[k % nshard];
        if (!next_line(p))
            return is_damaged(
                m, p, ct_arena_printf(m->ctx->model, "the row of run %ld is missing", k + 1));
        if (!is_row(p, k + 1, ncomma))
            return is_damaged(
                m, p, ct_arena_printf(m->ctx->model, "this is not the row of run %ld", k + 1));
        fwrite(p->line, 1, p->length, m->out.stream);
    }
    for (size_t i = 0; i < m->n; i++)
        if (next_line(&m->part[i]) || m->part[i].length)
            return is_damaged(m, &m->part[i], "there is more behind its last row");
    return true;
}

// Removes the settings of an earlier file of the same name, which do not belong to the new
// rows.
static bool remove_old_settings(struct merge *m)
{
    if (!m->out.partial)
        return true;
    const char *old = ct_arena_printf(m->ctx->model, "%s.settings", m->path);
    return remove(old) == 0 || errno == ENOENT
        || ct_error(m->ctx, none, CT_E_FILE, "cannot remove '%s': %s", old, strerror(errno));
}

static bool is_a_part(const struct merge *m, const char *path)
{
    struct stat out, st;
    if (!path || stat(path, &out) != 0 || !S_ISREG(out.st_mode))
        return false;
    for (size_t i = 0; i < m->n; i++)
        if (fstat(fileno(m->part[i].in), &st) == 0 && st.st_dev == out.st_dev
            && st.st_ino == out.st_ino)
            return true;
    return false;
}

// ---- all of it -----------------------------------------------------------------------------

struct task {
    struct merge *m;
    const char *const *path;
};

static bool merge(void *task)
{
    const struct task *t = task;
    struct merge *m = t->m;
    enum ct_suffix suffix;
    m->part = CT_NEWN(m->ctx->model, struct part, m->n + 1);
    if (!ct_suffix_read(m->ctx, m->path, CT_SUFFIX_CSV, &suffix) || !read_parts(m, t->path))
        return false;
    if (is_a_part(m, m->path))
        return ct_error(m->ctx, none, CT_E_USAGE, "'%s' is a part: write to another file",
                        m->path);
    return ct_outfile_open(m->ctx, &m->out, m->path) && merge_headers(m)
        && merge_rows(m, count_commas(m->part[0].line)) && remove_old_settings(m)
        && ct_outfile_close(m->ctx, &m->out);
}

bool ct_study_merge(struct ct_ctx *ctx, const char *path, const char *const *part, size_t n)
{
    if (!ctx || (n && !part))
        return false;
    struct merge m = {.ctx = ctx, .path = path && strcmp(path, "-") != 0 ? path : NULL, .n = n};
    struct task t = {&m, part};
    const bool ok = ct_enter(ctx, merge, &t);
    ct_outfile_discard(&m.out);
    for (size_t i = 0; m.part && i < n; i++) {
        if (m.part[i].in)
            fclose(m.part[i].in);
        free(m.part[i].line);
    }
    return ok;
}
