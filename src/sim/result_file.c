// The results of a run as a file: CSV row by row, other formats by columns at the end.
#include "sim/sim.h"

#include "report/columns.h"
#include "report/csv.h"

#include <string.h>

// Limit: of the time to write
static const double seconds_between_flushes = 0.5; // results that an interruption may lose

struct ct_result_file {
    enum ct_suffix suffix;
    struct ct_csv csv;         // CSV: rows are written as they come
    struct ct_outfile whole;   // other formats: written at the end
    struct ct_columns columns; // other formats: samples so far
    size_t ncolumn;
    double flushed;
    bool is_by_row;
};

static const char *column_name(const struct ct_equations *e, size_t c)
{
    return c ? e->result[c - 1].name : "t";
}

bool ct_sim_open_results(struct ct_sim *sim, const char *path)
{
    const struct ct_equations *e = &sim->system->equations;
    struct ct_result_file *f = sim->file = CT_NEW(sim->own.model, struct ct_result_file);
    const size_t n = f->ncolumn = e->nresult + 1;
    if (!ct_suffix_read(&sim->own, path, CT_SUFFIX_TABLE, &f->suffix))
        return false;
    f->is_by_row = f->suffix == CT_SUFFIX_CSV || f->suffix == CT_SUFFIX_CSV_GZ;
    f->flushed = ct_monotonic_time();
    if (!f->is_by_row) {
        ct_columns_init(&f->columns, sim->own.model, "t", CT_COLUMN_NUMBER);
        for (size_t i = 1; i < n; i++)
            ct_columns_add(&f->columns, column_name(e, i), CT_COLUMN_NUMBER);
        return ct_outfile_open(&sim->own, &f->whole, path);
    }
    const char **name = CT_NEWN(sim->own.model, const char *, n);
    for (size_t i = 0; i < n; i++)
        name[i] = column_name(e, i);
    return ct_csv_open(&sim->own, &f->csv, strcmp(path, "-") == 0 ? NULL : path, f->suffix,
                       name, n);
}

// Flushes at intervals, so that a reader of the file, or an interruption, finds the rows up to
// half a second ago.
static bool write_csv_row(struct ct_sim *sim, double t, const double *value)
{
    struct ct_result_file *f = sim->file;
    const double now = ct_monotonic_time();
    ct_csv_number(&f->csv, t);
    for (size_t i = 0; i + 1 < f->ncolumn; i++)
        ct_csv_number(&f->csv, value[i]);
    if (!ct_csv_end_row(&sim->own, &f->csv))
        return false;
    if (now - f->flushed < seconds_between_flushes)
        return true;
    f->flushed = now;
    return ct_csv_flush(&sim->own, &f->csv);
}

bool ct_sim_write_row(struct ct_sim *sim, double t, const double *value)
{
    struct ct_result_file *f = sim->file;
    sim->nwritten++;
    if (f->is_by_row)
        return write_csv_row(sim, t, value);
    ct_columns_number(&f->columns, 0, t);
    for (size_t i = 1; i < f->ncolumn; i++)
        ct_columns_number(&f->columns, i, value[i - 1]);
    return true;
}

void ct_sim_abandon_results(struct ct_sim *sim)
{
    ct_csv_abandon(&sim->file->csv);
    ct_outfile_abandon(&sim->file->whole);
}

void ct_sim_interrupt_results(struct ct_sim *sim)
{
    ct_csv_abandon(&sim->file->csv);
    // writing it would take longer than an interruption may
    ct_outfile_discard(&sim->file->whole);
}

const char *ct_sim_results_path(const struct ct_sim *sim, bool is_partial)
{
    const struct ct_result_file *f = sim->file;
    if (!f)
        return NULL;
    const struct ct_outfile *o = f->is_by_row ? &f->csv.file : &f->whole;
    return !is_partial ? o->path : f->is_by_row ? o->partial : NULL;
}

bool ct_sim_close_results(struct ct_sim *sim, bool ok)
{
    struct ct_result_file *f = sim->file;
    if (ok && f->is_by_row)
        return ct_csv_close(&sim->own, &f->csv);
    if (!f->is_by_row)
        ok &= ct_columns_put(&sim->own, &f->columns, f->suffix, &f->whole);
    if (ok)
        return ct_outfile_close(&sim->own, &f->whole);
    ct_sim_abandon_results(sim);
    return false;
}
