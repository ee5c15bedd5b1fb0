// The file of rows of a study. Rows are in order; the file appears when all are there; rows of
// an interrupted sweep are taken over.
#include "study/study.h"

#include "base/guard.h"
#include "io/text.h"
#include "report/columns.h"
#include "report/number.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const struct ct_mark none = {0};
static const double seconds_between_flushes
    = 0.5; // Limit: results that an interruption may lose [s].

// ---- rows ----------------------------------------------------------------------------------

static const char **column_names(struct ct_study *s, size_t *n)
{
    const struct ct_equations *e = &s->system->equations;
    const char **name = CT_NEWN(s->own.model, const char *, s->plan.naxis + e->nresult + 2);
    *n = 0;
    name[(*n)++] = "run";
    for (size_t i = 0; i < s->plan.naxis; i++)
        name[(*n)++] = s->plan.axis[i].name;
    for (size_t i = 0; i < e->nresult; i++)
        name[(*n)++] = e->result[i].name;
    name[(*n)++] = "status";
    return name;
}

static bool write_row(struct ct_study *s, long member, const double *value)
{
    struct ct_csv *w = &s->sink.csv;
    const size_t n = s->system->equations.nresult;
    ct_csv_number(w, (double)ct_plan_number(&s->plan, member));
    for (size_t i = 0; i < s->plan.naxis; i++)
        ct_csv_number(w, ct_plan_value(&s->plan, member, i));
    for (size_t i = 0; i < n; i++)
        if (value && !isnan(value[i])) // NaN: the time of an event that does not occur
            ct_csv_number(w, value[i]);
        else
            ct_csv_text(w, "");
    ct_csv_number(w, value ? 0 : 1);
    if (!ct_csv_end_row(&s->own, w))
        return false;
    const double now = ct_monotonic_time();
    if (now - s->sink.flushed < seconds_between_flushes)
        return true;
    s->sink.flushed = now;
    return ct_csv_flush(&s->own, w);
}

static bool give_row(struct ct_study *s, long member, const struct ct_study_row *row)
{
    const struct ct_study_results *r = s->results;
    if (!r->row)
        return true;
    for (size_t i = 0; i < s->plan.naxis; i++)
        s->varied[i] = ct_plan_value(&s->plan, member, i);
    return r->row(r->user, ct_plan_number(&s->plan, member), s->varied, row->value,
                  row->message);
}

// Writes the rows that are complete, from the first on; later rows wait.
void ct_study_write_rows(struct ct_study *s)
{
    for (; s->written < s->plan.nmember && !s->is_stopped; s->written++) {
        struct ct_study_row *row = &s->row[s->written];
        if (row->state == CT_ROW_PENDING)
            return;
        if (row->state == CT_ROW_RESUMED || row->state == CT_ROW_RESUMED_FAILED)
            continue;
        const bool is_csv = s->sink.is_open && s->sink.is_by_row;
        if (is_csv && !write_row(s, s->written, row->value))
            s->is_stopped = s->sink.has_failed = true;
        else if (!give_row(s, s->written, row))
            s->is_stopped = true;
        if (s->sink.is_by_row || !s->sink.is_open) {
            free(row->value);
            row->value = NULL;
        }
    }
}

// The first error as FILE:LINE:COLUMN: TEXT [CODE], on the heap.
static char *message_of(const struct ct_ctx *ctx, int *code)
{
    for (size_t i = 0; i < ctx->ndiagnostic; i++) {
        const struct ct_finding *d = &ctx->diagnostic[i];
        if (d->severity != CT_SEVERITY_ERROR)
            continue;
        const size_t n = strlen(d->text) + (d->mark.file ? strlen(d->mark.file) : 0) + 64;
        char *text = malloc(n);
        *code = (int)d->code;
        if (text && d->mark.file)
            snprintf(text, n, "%s:%d:%d: %s [E%03d]", d->mark.file, d->mark.line + 1,
                     d->mark.column + 1, d->text, *code);
        else if (text)
            snprintf(text, n, "%s [E%03d]", d->text, *code);
        return text;
    }
    *code = CT_E_MEMORY;
    return strdup("out of memory");
}

static double *copy_values(const double *value, size_t n)
{
    double *copy = malloc((n + 1) * sizeof *copy);
    if (copy)
        memcpy(copy, value, n * sizeof *copy);
    return copy;
}

// Records a finished member. value NULL: it failed with the errors in ctx.
void ct_study_record(struct ct_study *s, long member, const double *value,
                     const struct ct_ctx *ctx)
{
    // the member was interrupted and has not failed: it runs again on resuming
    if (!value && ct_guard_is_interrupted())
        return;
    struct ct_study_row row = {.state = value ? CT_ROW_DONE : CT_ROW_FAILED};
    if (value)
        row.value = copy_values(value, s->system->equations.nresult);
    else
        row.message = message_of(ctx, &row.code);
    pthread_mutex_lock(&s->rows);
    s->no_memory |= value ? !row.value : !row.message;
    if (value && !row.value)
        row.state = CT_ROW_PENDING;
    s->row[member] = row;
    s->ndone++;
    s->nfailed += !value;
    ct_study_write_rows(s);
    ct_progress_update(&s->progress, (double)s->ndone / (double)s->plan.nmember);
    if (s->results->progress
        && !s->results->progress(s->results->user, (double)s->ndone, (double)s->plan.nmember))
        s->is_stopped = true;
    pthread_mutex_unlock(&s->rows);
}

// ---- the file ------------------------------------------------------------------------------

// The header of the file.
static const char *header_text(struct ct_study *s)
{
    size_t n;
    const char **name = column_names(s, &n);
    struct ct_csv w = {.ncolumn = n, .arena = s->own.model};
    for (size_t i = 0; i < n; i++)
        ct_csv_text(&w, name[i]);
    return ct_arena_printf(s->own.model, "%.*s\n", (int)w.n, w.text);
}

// Reads a field that is a number; *line (inout) moves behind its comma.
static bool read_number(const char **line)
{
    char text[CT_NUMBER_SIZE];
    const size_t n = strcspn(*line, ",\n");
    const double v = strtod(*line, NULL);
    const bool is_number = n > 0 && n == strlen(ct_number_format(text, v))
                        && memcmp(*line, text, n) == 0 && (*line)[n] == ',';
    *line += n + 1;
    return is_number;
}

static bool read_empty(const char **line)
{
    return *(*line)++ == ',';
}

// The same for a field that must have this value.
static bool read_value(const char **line, double v)
{
    char text[CT_NUMBER_SIZE];
    const size_t n = strlen(ct_number_format(text, v));
    const bool is_it = strncmp(*line, text, n) == 0 && (*line)[n] == ',';
    *line += n + 1;
    return is_it;
}

// Is this line the complete row of the member? Returns its status, or -1 if it is not.
static int read_status(const struct ct_study *s, long member, const char *line)
{
    const size_t length = strlen(line);
    const int status = length > 2 && strcmp(line + length - 3, ",0\n") == 0 ? 0
                     : length > 2 && strcmp(line + length - 3, ",1\n") == 0 ? 1
                                                                            : -1;
    bool ok = status >= 0 && read_value(&line, (double)ct_plan_number(&s->plan, member));
    for (size_t i = 0; ok && i < s->plan.naxis; i++)
        ok = read_value(&line, ct_plan_value(&s->plan, member, i));
    const size_t n = s->system->equations.nresult;
    for (size_t i = 0; ok && i < n; i++) {
        const bool may_be_empty
            = i + s->ntake >= n && s->take[i + s->ntake - n] == CT_TAKE_TIME && *line == ',';
        ok = status || may_be_empty ? read_empty(&line) : read_number(&line);
    }
    return ok && strlen(line) == 2 ? status : -1;
}

static bool not_resumable(struct ct_study *s, const char *path, const char *why)
{
    return ct_error(&s->own, none, CT_E_USAGE,
                    "cannot resume from '%s': %s; without --resume the sweep starts anew", path,
                    why);
}

// Takes over the complete rows of a file; *kept (out): their size in bytes.
static bool read_rows(struct ct_study *s, FILE *in, const char *path, long *kept)
{
    char *line = NULL;
    const char *header = header_text(s);
    size_t size = 0;
    ssize_t n = getline(&line, &size, in);
    bool ok = true;
    *kept = 0;
    if (n > 0 && line[n - 1] == '\n') {
        ok = strcmp(line, header) == 0 || not_resumable(s, path, "its columns are others");
        *kept = n;
    }
    for (long i = 0; ok && *kept && (n = getline(&line, &size, in)) > 0; i++) {
        if (line[n - 1] != '\n')
            break; // an incomplete line
        const int status = i < s->plan.nmember ? read_status(s, i, line) : -1;
        ok = status >= 0
          || not_resumable(s, path,
                           ct_arena_printf(s->own.model,
                                           "row %ld is damaged, or not one of this sweep",
                                           i + 1));
        if (!ok)
            break;
        s->row[i].state = status ? CT_ROW_RESUMED_FAILED : CT_ROW_RESUMED;
        s->ndone++;
        s->nresumed++;
        s->nfailed += status;
        *kept += n;
    }
    free(line);
    return ok;
}

// ---- settings beside the rows --------------------------------------------------------------

//
//     FILE.partial, FILE.partial.settings  -- complete -->  FILE
//                          with `resume`, and for shards:   FILE, then FILE.settings
//
// Settings stay beside complete rows only if `resume` or a shard needs them later: to recognise
// a complete sweep, or to check that shards belong together. At no time do rows stand beside
// the settings of other rows.

static const char *settings_path(struct ct_study *s, const char *rows)
{
    return ct_arena_printf(s->own.model, "%s.settings", rows);
}

// Writes the settings before the first row.
static bool write_settings(struct ct_study *s)
{
    const struct ct_outfile *rows = &s->sink.csv.file;
    struct ct_outfile o;
    if (!rows->partial) // standard output has no settings
        return true;
    if (!ct_outfile_open(&s->own, &o, settings_path(s, rows->partial)))
        return false;
    fputs(ct_study_settings(s), o.stream);
    return ct_outfile_close(&s->own, &o);
}

// Removes the settings of an earlier file of the same name.
static bool remove_old_settings(struct ct_study *s)
{
    const struct ct_outfile *rows = &s->sink.csv.file;
    if (!rows->partial)
        return true;
    const char *old = settings_path(s, rows->path);
    return remove(old) == 0 || errno == ENOENT
        || ct_error(&s->own, none, CT_E_FILE, "cannot remove '%s': %s", old, strerror(errno));
}

static bool move_settings(struct ct_study *s)
{
    const struct ct_outfile *rows = &s->sink.csv.file;
    if (!rows->partial)
        return true;
    const char *from = settings_path(s, rows->partial), *to = settings_path(s, rows->path);
    if (!s->results->resume && !s->plan.nshard)
        return remove(from) == 0
            || ct_error(&s->own, none, CT_E_FILE, "cannot remove '%s': %s", from,
                        strerror(errno));
    return rename(from, to) == 0
        || ct_error(&s->own, none, CT_E_FILE, "cannot write '%s': %s", to, strerror(errno));
}

// Renames the complete file of rows. From then on another sweep may write to the partial file,
// so the settings must be in place before.
static bool finish_rows(struct ct_study *s)
{
    const struct ct_outfile *rows = &s->sink.csv.file;
    struct ct_outfile lock = {0};
    if (rows->partial && !ct_outfile_open(&s->own, &lock, settings_path(s, rows->partial)))
        return false;
    const bool ok
        = remove_old_settings(s) && ct_csv_close(&s->own, &s->sink.csv) && move_settings(s);
    ct_outfile_discard(&lock);
    return ok;
}

// Returns the first setting that differs from those of existing rows; NULL: none does.
static const char *find_difference(struct ct_study *s, const char *rows)
{
    // Limit: a longer file is not one of settings.
    enum { MOST_TEXT = 1 << 20 };
    char *text;
    size_t n;
    const char *path = settings_path(s, rows);
    if (ct_text_read(s->own.model, path, MOST_TEXT, &text, &n) != CT_TEXT_OK)
        return ct_arena_printf(s->own.model, "there is no '%s' that says how it was made",
                               path);
    return ct_study_compare_settings(s->own.model, ct_arena_strndup(s->own.model, text, n),
                                     ct_study_settings(s));
}

// ---- going on ------------------------------------------------------------------------------

// Resumes after the last complete row of a partial file. *found is false if there is no such
// file.
static bool resume(struct ct_study *s, const char *path, bool *found)
{
    struct ct_csv *w = &s->sink.csv;
    struct stat rows;
    const char *partial = ct_arena_printf(s->own.model, "%s.partial", path);
    long kept;
    *found = lstat(partial, &rows) == 0 && rows.st_size > 0;
    if (!*found)
        return true;
    *w = (struct ct_csv){.arena = s->own.model};
    column_names(s, &w->ncolumn);
    if (!ct_outfile_reopen(&s->own, &w->file, path))
        return false;
    const char *difference = find_difference(s, partial);
    if (difference)
        return not_resumable(s, partial, difference);
    if (!read_rows(s, w->file.stream, partial, &kept))
        return false;
    if (kept == 0) { // not even the header is complete
        ct_outfile_abandon(&w->file);
        *found = false;
        return true;
    }
    return (fseek(w->file.stream, kept, SEEK_SET) == 0
            && ftruncate(fileno(w->file.stream), kept) == 0)
        || not_resumable(s, partial, "it cannot be written");
}

// Is the file the complete result of this sweep?
static bool is_complete(struct ct_study *s, const char *path)
{
    struct stat rows;
    long kept;
    FILE *in = stat(path, &rows) == 0 && S_ISREG(rows.st_mode) ? fopen(path, "r") : NULL;
    if (!in)
        return false;
    const size_t before = s->own.ndiagnostic, errors = s->own.nerror;
    const bool ok = !find_difference(s, path) && read_rows(s, in, path, &kept)
                 && s->nresumed == s->plan.nmember;
    fclose(in);
    s->own.ndiagnostic = before;
    s->own.nerror = errors;
    if (ok)
        return true;
    for (long i = 0; i < s->plan.nmember; i++)
        s->row[i].state = CT_ROW_PENDING;
    s->ndone = s->nresumed = s->nfailed = 0;
    return false;
}

static bool begin_file(struct ct_study *s, const char *path)
{
    size_t n;
    const char **name = column_names(s, &n);
    s->sink.is_open = ct_csv_open(&s->own, &s->sink.csv, strcmp(path, "-") == 0 ? NULL : path,
                                  s->sink.suffix, name, n);
    return s->sink.is_open && write_settings(s);
}

bool ct_study_open(struct ct_study *s)
{
    const struct ct_study_results *r = s->results;
    const char *path = r->path;
    struct ct_result_sink *k = &s->sink;
    if (!ct_suffix_read(&s->own, path, CT_SUFFIX_TABLE, &k->suffix))
        return false;
    if (r->resume && (k->suffix != CT_SUFFIX_CSV || strcmp(path, "-") == 0))
        return ct_error(&s->own, none, CT_E_USAGE,
                        "only a sweep into a CSV file can be resumed");
    if (s->plan.nshard && (k->suffix != CT_SUFFIX_CSV || strcmp(path, "-") == 0))
        return ct_error(&s->own, none, CT_E_USAGE,
                        "a shard is written to a .csv file, for 'cotree merge'");
    s->path_written
        = strcmp(path, "-") == 0 ? "standard output" : ct_arena_strdup(s->own.model, path);
    k->is_by_row = k->suffix == CT_SUFFIX_CSV || k->suffix == CT_SUFFIX_CSV_GZ;
    if (!k->is_by_row) {
        k->is_open = ct_outfile_open(&s->own, &k->whole, path);
        return k->is_open;
    }
    if (r->resume && is_complete(s, path))
        return true;
    if (r->resume && !resume(s, path, &s->sink.is_open))
        return false;
    return s->sink.is_open || begin_file(s, path);
}

// ---- the end -------------------------------------------------------------------------------

// Value of a member in a column; NaN if the member failed.
static double cell(const struct ct_study *s, long member, size_t c, size_t ncolumn)
{
    const struct ct_study_row *row = &s->row[member];
    return c == 0             ? (double)ct_plan_number(&s->plan, member)
         : c <= s->plan.naxis ? ct_plan_value(&s->plan, member, c - 1)
         : c + 1 == ncolumn   ? row->state == CT_ROW_FAILED
         : row->value         ? row->value[c - 1 - s->plan.naxis]
                              : (double)NAN;
}

// Writes the columns for the members up to the first that is not finished.
static bool put_columns(struct ct_study *s)
{
    size_t ncolumn;
    const char **name = column_names(s, &ncolumn);
    struct ct_columns t;
    ct_columns_init(&t, s->own.model, name[0], CT_COLUMN_NUMBER);
    for (size_t c = 1; c < ncolumn; c++)
        ct_columns_add(&t, name[c], CT_COLUMN_NUMBER);
    for (size_t c = 0; c < ncolumn; c++)
        for (long i = 0; i < s->written; i++)
            ct_columns_number(&t, c, cell(s, i, c, ncolumn));
    return ct_columns_put(&s->own, &t, s->sink.suffix, &s->sink.whole);
}

bool ct_study_close(struct ct_study *s, bool ok)
{
    struct ct_result_sink *k = &s->sink;
    if (!k->is_open)
        return ok;
    if (!k->is_by_row)
        ok &= put_columns(s);
    if (ok)
        ok = k->is_by_row ? finish_rows(s) : ct_outfile_close(&s->own, &k->whole);
    ct_csv_abandon(&k->csv);
    ct_outfile_abandon(&k->whole);
    return ok;
}

// ---- columns -------------------------------------------------------------------------------

size_t ct_study_column_count(const struct ct_study *study)
{
    return study ? 1 + study->plan.naxis + study->system->equations.nresult : 0;
}

const char *ct_study_column(const struct ct_study *study, size_t i)
{
    if (i >= ct_study_column_count(study))
        return NULL;
    return i == 0 ? "run"
         : i <= study->plan.naxis
             ? study->plan.axis[i - 1].name
             : study->system->equations.result[i - 1 - study->plan.naxis].name;
}
