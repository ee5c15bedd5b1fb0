// This folder runs parameter studies (sweeps): it plans the members, runs them on all cores,
// writes a row for each in order, resumes an interrupted sweep and joins shards. This header is
// what its files share.
//
//     study.c            creating, running and querying a study
//     worker.c           running members, in lanes or one by one, on all cores
//     study_file.c       the file of rows, and how it is resumed
//     study_settings.c   the settings that rows depend on
//     study_summary.c    the summary
//     takes.c            functions of outputs over a run
//     merge.c            joining shards
//     variation.c        analyses for each member, without a study
#ifndef CT_STUDY_H
#define CT_STUDY_H

#include "io/yaml.h"
#include "report/csv.h"
#include "report/progress.h"
#include "sim/sim.h"
#include "study/plan.h"

#include <pthread.h>

struct ct_study_row {
    enum {
        CT_ROW_PENDING,
        CT_ROW_DONE,
        CT_ROW_FAILED,
        CT_ROW_RESUMED,
        CT_ROW_RESUMED_FAILED
    } state;
    int code;      // code of the first error
    double *value; // nresult values, until the row is written
    char *message;
};

struct ct_study {
    struct ct_ctx own;
    const char *path;
    char *text; // of the model file
    size_t ntext;
    const struct ct_node *root;              // the same, parsed
    struct ct_system_options system_options; // strings are in own.model
    struct ct_sim_options run;
    struct ct_plan plan;
    enum ct_take_kind *take; // functions over the run, from the last results  (ntake)
    size_t ntake;
    double *base;             // values of the axes in the file
    struct ct_system *system; // system with the values of the file; belongs to the first worker
    bool is_derived;          // each member needs equations of its own
    const char *derived_by;   // the parameter that is the reason
    const char *alone_by;     // reason why no member runs in a lane; NULL: members do
    int threads, lanes;
    const char *method, *backend;
    double tolerance;
    const struct ct_study_results *results;
    const struct ct_ctx *caller; // context of the caller, which may cancel the run
    struct ct_result_sink {
        enum ct_suffix suffix;
        bool is_by_row, is_open, has_failed;
        struct ct_csv csv;
        struct ct_outfile whole; // columns, written at the end
        double flushed;
    } sink;
    const char *path_written; // path of the rows once the file is complete
    struct ct_progress progress;
    struct ct_study_row *row;
    double *varied; // values of the axes in a row  (naxis)
    // next: index of the member to run next
    long next, written, ndone, nfailed, nresumed, nalone;
    long steps, rejected;
    bool is_stopped, no_memory, has_run;
    pthread_mutex_t rows; // held while a member is taken or recorded
    double seconds;
};

// ---- worker.c ------------------------------------------------------------------------------

/// Run all members that are pending.
void ct_study_run_members(struct ct_study *s);
/// Loads the system with the varied parameters as numbers, so that all members have the same
/// order of parameters.
struct ct_system *ct_study_load_system(struct ct_ctx *ctx, const struct ct_study *s);

// ---- takes.c -------------------------------------------------------------------------------

/// Reads "NAME=FUNCTION(EXPRESSION)" (n texts) into s->take and adds their expressions to the
/// outputs of the system. Errors: E003.
bool ct_study_read_takes(struct ct_study *s, const char *const *text, size_t n);
/// The word for a kind.
const char *ct_study_take_name(enum ct_take_kind kind);

// ---- study_file.c --------------------------------------------------------------------------

/// Opens the file, or resumes the file of an interrupted sweep. Errors: E002, E003.
bool ct_study_open(struct ct_study *s);
/// Stores the results of a member, or its errors from ctx, as its row, and writes all rows that
/// are next in order.
void ct_study_record(struct ct_study *s, long member, const double *value,
                     const struct ct_ctx *ctx);
/// Writes the rows that are complete, from the first on; later rows wait.
void ct_study_write_rows(struct ct_study *s);
/// ok: all rows are complete. False if they are not, or could not be written. Errors: E002.
bool ct_study_close(struct ct_study *s, bool ok);

// ---- study_settings.c ----------------------------------------------------------------------

/// Returns the settings that the rows of a study depend on, one line for each; in s->own.model.
const char *ct_study_settings(struct ct_study *s);
/// The first setting that differs between two such texts; NULL: a text lacks it.
/// ct_study_find_difference returns false if none differs.
struct ct_setting_difference {
    const char *name, *before, *now;
};
bool ct_study_find_difference(struct ct_arena *a, const char *before, const char *now,
                              struct ct_setting_difference *out);
/// Is this setting the checksum of a file?
bool ct_setting_is_file(const char *name);
/// Describes the first difference between old and new settings; NULL if none differs.
const char *ct_study_compare_settings(struct ct_arena *a, const char *before, const char *now);

#endif
