// src/accuracy makes work-precision studies: it runs a system with several methods and tolerances,
// measures the time of each run and its error against a converged reference, and finds the cheapest
// setting for a wanted error. This header is shared by its files.
//
//     accuracy.c             ladders of tolerances and steps, the cheapest setting, the answers
//     accuracy_run.c         one run with a setting, and the distance of two runs
//     accuracy_reference.c   the reference: runs that agree, or a file
#ifndef CT_ACCURACY_H
#define CT_ACCURACY_H

#include "report/work_precision.h"
#include "report/progress.h"
#include "sim/sim.h"

/// The reference is good enough with this part of the wanted error; otherwise more runs are made
/// for it, and then a warning. Derived: the error of a run that is near the wanted one is then
/// known to a tenth of itself.
#define CT_REFERENCE_MARGIN 0.1

struct ct_accuracy {
    struct ct_ctx own;
    struct ct_ctx said; // diagnostics of single runs
    struct ct_system *system;
    const struct ct_accuracy_options *o; // valid during the study
    const struct ct_accuracy_variant
        *variant;       // variant of the system for the runs; NULL: there is only one
    struct ct_sim *sim; // the current run
    struct ct_progress progress;
    const char *name;
    double wanted;
    double duration;
    size_t nsample, nresult, nrow; // nrow: rows of the run so far
    double *store;                 // nsample x nresult: results of the run; NULL: not stored
    double *reference;             // nsample x nresult; NaN: unknown
    double *scale;                 // (nresult) largest |reference|; 0: column not compared
    struct ct_output_error_estimate *difference; // (nresult) workspace
    double worst;                                // error of the run so far
    const char *source;                          // of the reference
    double uncertainty;                          // NaN: unknown
    double reference_seconds;
    struct ct_work_precision_point *point;
    size_t npoint, point_cap;
    const struct ct_work_precision_point *best;
};

enum ct_ending {
    CT_RUN_DONE,
    CT_RUN_FAILED,
    CT_RUN_LATE,
    CT_RUN_REFUSED // the options are invalid
};

// Setting of a run: a method with a tolerance or a step.
struct ct_setting {
    const char *method;
    double tolerance, step; // one of the two
    double rtol; // > 0: relative tolerance of the steps, in place of the one simulate derives
};

// Create a->sim for a setting. False with a message in a->said.
bool ct_accuracy_start_run(struct ct_accuracy *a, const struct ct_setting *s);

// The work-precision plot as <svg> ... </svg>.
void ct_accuracy_print_plot(FILE *out, const struct ct_accuracy *a);

// Destroy a->sim.
void ct_accuracy_end_run(struct ct_accuracy *a);

// One run of at most `limit` seconds; each sample is passed to row. *p (out): cost of the run,
// without an error. a->sim is kept.
enum ct_ending ct_accuracy_start(struct ct_accuracy *a, const struct ct_setting *s,
                                 double limit,
                                 bool (*row)(void *, double, const double *, size_t),
                                 struct ct_work_precision_point *p);

// Repeat the same run in place; *seconds (out). False if it fails.
bool ct_accuracy_repeat(struct ct_accuracy *a,
                        bool (*row)(void *, double, const double *, size_t), double *seconds);

// As ct_accuracy_start; a->sim is destroyed afterwards.
enum ct_ending ct_accuracy_run(struct ct_accuracy *a, const struct ct_setting *s, double limit,
                               bool (*row)(void *, double, const double *, size_t),
                               struct ct_work_precision_point *p);

// Largest |y - x| / max |x| over the columns that exceed round-off; x, y (nsample, nresult); scale
// (nresult, out): max |x|, 0 for the other columns.
double ct_accuracy_compare(const struct ct_accuracy *a, const double *x, const double *y,
                           double *scale);

// Compute a->reference, scale, source and uncertainty by runs with tight tolerances that agree.
// Errors: CT_E_REFERENCE.
bool ct_accuracy_find_reference(struct ct_accuracy *a);

// Read the reference from a file of samples. Errors: CT_E_TABLE, CT_E_TABLE_DATA.
bool ct_accuracy_read_reference(struct ct_accuracy *a, const char *path);

#endif
