// Results of a run as a file: rows as CSV, columns as JSON.
#include "sim/sim.h"

#include "report/csv.h"
#include "report/json.h"
#include "report/outfile.h"

#include <string.h>

struct ct_result_file {
    bool is_json;
    struct ct_csv csv;
    struct ct_outfile json;
    double *value; // JSON is written by columns: rows are kept until the end
    size_t nvalue, value_cap, ncolumn;
    const char **column; // "t" first
};

static bool has_suffix(const char *path, const char *suffix)
{
    const size_t n = strlen(path), k = strlen(suffix);
    return n >= k && strcmp(path + n - k, suffix) == 0;
}

bool ct_sim_open_results(struct ct_sim *sim, const char *path)
{
    const struct ct_equations *e = &sim->system->equations;
    struct ct_result_file *f = sim->file = CT_NEW(sim->own.model, struct ct_result_file);
    f->ncolumn = e->nresult + 1;
    f->column = CT_NEWN(sim->own.model, const char *, f->ncolumn);
    f->column[0] = "t";
    for (size_t i = 0; i < e->nresult; i++)
        f->column[i + 1] = e->result[i].name;
    f->is_json = has_suffix(path, ".json");
    if (f->is_json)
        return ct_outfile_open(&sim->own, &f->json, path);
    return ct_csv_open(&sim->own, &f->csv, strcmp(path, "-") == 0 ? NULL : path, f->column,
                       f->ncolumn);
}

bool ct_sim_write_row(struct ct_sim *sim, double t, const double *value)
{
    struct ct_result_file *f = sim->file;
    if (!f->is_json) {
        ct_csv_number(&f->csv, t);
        for (size_t i = 0; i + 1 < f->ncolumn; i++)
            ct_csv_number(&f->csv, value[i]);
        return ct_csv_end_row(&sim->own, &f->csv);
    }
    CT_PUSH(sim->own.model, f->value, f->nvalue, f->value_cap, t);
    for (size_t i = 0; i + 1 < f->ncolumn; i++)
        CT_PUSH(sim->own.model, f->value, f->nvalue, f->value_cap, value[i]);
    return true;
}

static void write_columns(struct ct_sim *sim)
{
    const struct ct_result_file *f = sim->file;
    const size_t n = f->nvalue / f->ncolumn;
    double *one = CT_NEWN(sim->own.model, double, n + 1);
    struct ct_json j;
    ct_json_init(&j, f->json.stream);
    ct_json_object(&j, NULL);
    for (size_t c = 0; c < f->ncolumn; c++) {
        for (size_t i = 0; i < n; i++)
            one[i] = f->value[i * f->ncolumn + c];
        ct_json_numbers(&j, f->column[c], one, n);
    }
    ct_json_end(&j);
}

void ct_sim_abandon_results(struct ct_sim *sim)
{
    ct_csv_abandon(&sim->file->csv);
    ct_outfile_abandon(&sim->file->json);
}

bool ct_sim_close_results(struct ct_sim *sim, bool ok)
{
    struct ct_result_file *f = sim->file;
    if (f->is_json)
        write_columns(sim);
    if (ok)
        return f->is_json ? ct_outfile_close(&sim->own, &f->json)
                          : ct_csv_close(&sim->own, &f->csv);
    ct_sim_abandon_results(sim);
    return false;
}
