// What the files of a parameter study share.
//
//     study.c            a study is made, run and asked
//     worker.c           members run, in lanes or one by one, on all cores
//     study_file.c       rows in order, their file, and how it is resumed
//     study_settings.c   what rows depend on besides their own values
//     study_summary.c    what was done
//     takes.c            what is taken over runs
//     merge.c            shards become one file
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
    int code;      // of the first error
    double *value; // nresult, until it is written
    char *message;
};

struct ct_study {
    struct ct_ctx own;
    const char *path;
    char *text; // of the model file
    size_t ntext;
    const struct ct_node *root;              // the same, parsed
    struct ct_system_options system_options; // with strings in own.model
    struct ct_sim_options run;
    struct ct_plan plan;
    enum ct_take_kind *take; // over the run, from the last results  (ntake)
    size_t ntake;
    double *base;             // what the file says of its axes
    struct ct_system *system; // with the values of the file; that of the first worker
    bool is_derived;          // each member needs equations of its own
    const char *derived_by;   // the parameter that is why
    const char *alone_by;     // why no member is in lanes; NULL: they are
    int threads, lanes;
    const char *method, *backend;
    double tolerance;
    const struct ct_study_results *results;
    struct ct_ctx *caller;         // of the run: it may be cancelled
    struct ct_interrupt interrupt; // of the caller, for all threads
    struct ct_result_sink {
        enum ct_suffix suffix;
        bool is_by_row, is_open, has_failed;
        struct ct_csv csv;
        struct ct_outfile whole; // columns, written at the end
        double flushed;
    } sink;
    const char *path_written; // the file of rows, once it is complete
    struct ct_progress progress;
    struct ct_study_row *row;
    double *varied;                                       // values of a row  (naxis)
    long next, written, ndone, nfailed, nresumed, nalone; // next: member to run
    long steps, rejected;
    bool is_stopped, no_memory, has_run;
    pthread_mutex_t rows; // held by who takes a member or records one
    double seconds;
};

// ---- worker.c -----------------------------------------------------------------------------------------

/// Run all members that are pending.
void ct_study_run_members(struct ct_study *s);
/// The system with what varies as numbers, so that all members order their parameters alike.
struct ct_system *ct_study_load_system(struct ct_ctx *ctx, const struct ct_study *s);

// ---- takes.c --------------------------------------------------------------------------------------------

/// "NAME=FUNCTION(EXPRESSION)" (n) into s->take, and what they are taken from into the outputs of the system. Errors: E003.
bool ct_study_read_takes(struct ct_study *s, const char *const *text, size_t n);
/// The word for a kind.
const char *ct_study_take_name(enum ct_take_kind kind);

// ---- study_file.c -------------------------------------------------------------------------------------

/// Open the file, or go on with what an interrupted sweep has left. Errors: E002, E003.
bool ct_study_open(struct ct_study *s);
/// Put a member's results, or the reasons why there are none in ctx, into its row, and write the rows that are due.
void ct_study_record(struct ct_study *s, long member, const double *value,
                     const struct ct_ctx *ctx);
/// Rows that are complete from the first on go out; the rest waits for them.
void ct_study_write_rows(struct ct_study *s);
/// ok: all rows are there. False if they are not, or not in the file. Errors: E002.
bool ct_study_close(struct ct_study *s, bool ok);

// ---- study_settings.c ---------------------------------------------------------------------------------

/// What the rows of a study depend on, a line for each setting; in s->own.model.
const char *ct_study_settings(struct ct_study *s);
/// The first setting that differs in two such texts; NULL: a text does not have it. False: none does.
struct ct_setting_difference {
    const char *name, *before, *now;
};
bool ct_study_find_difference(struct ct_arena *a, const char *before, const char *now,
                              struct ct_setting_difference *out);
/// Is it the checksum of what a file has?
bool ct_setting_is_file(const char *name);
/// The same for people, of settings that were and are now; NULL: none differs.
const char *ct_study_compare_settings(struct ct_arena *a, const char *before, const char *now);

#endif
