// What the files of speed against error share.
//
//     accuracy.c             ladders of tolerances and steps, the cheapest setting, the questions
//     accuracy_run.c         one run with a setting, and the distance of two
//     accuracy_reference.c   the reference: runs that agree, or a file
#ifndef CT_ACCURACY_H
#define CT_ACCURACY_H

#include "report/work_precision.h"
#include "report/progress.h"
#include "sim/sim.h"

struct ct_accuracy {
    struct ct_ctx own;
    struct ct_ctx said; // what single runs say
    struct ct_system *system;
    const struct ct_accuracy_options *o; // while it works
    const struct ct_accuracy_variant
        *variant;       // of the system that runs; NULL: there is one only
    struct ct_sim *sim; // the one that runs
    struct ct_progress progress;
    const char *name;
    double wanted;
    double duration;
    size_t nsample, nresult, nrow; // nrow: rows of the run so far
    double *store;                 // nsample x nresult: where the run goes; NULL: nowhere
    double *reference;             // nsample x nresult; NaN: not known
    double *scale;                 // (nresult) largest |reference|; 0: not compared
    double *deviation;             // (nresult) to spare
    double worst;                  // error of the run so far
    const char *source;            // of the reference
    double uncertainty;            // NaN: not known
    double reference_seconds;
    struct ct_work_precision_point *point;
    size_t npoint, point_cap;
    const struct ct_work_precision_point *best;
};

enum ct_ending {
    CT_RUN_DONE,
    CT_RUN_FAILED,
    CT_RUN_LATE,
    CT_RUN_REFUSED // the options are wrong
};

// How one run is made: a method with a tolerance or a step.
struct ct_setting {
    const char *method;
    double tolerance, step; // one of them
    double rtol;            // > 0: tolerance of the steps, whatever simulate makes of one
};

// Makes a->sim of a setting. False with a message in a->said.
bool ct_accuracy_start_run(struct ct_accuracy *a, const struct ct_setting *s);

// The work-precision plot as <svg> ... </svg>.
void ct_accuracy_print_plot(FILE *out, const struct ct_accuracy *a);

// Destroys a->sim.
void ct_accuracy_end_run(struct ct_accuracy *a);

// One run of at most `limit` seconds, each sample given to row; *p (out): what it cost, without an
// error. a->sim stays.
enum ct_ending ct_accuracy_start(struct ct_accuracy *a, const struct ct_setting *s,
                                 double limit,
                                 bool (*row)(void *, double, const double *, size_t),
                                 struct ct_work_precision_point *p);

// The same run again in place; *seconds (out). False if it fails.
bool ct_accuracy_repeat(struct ct_accuracy *a,
                        bool (*row)(void *, double, const double *, size_t), double *seconds);

// The first with nothing left of it.
enum ct_ending ct_accuracy_run(struct ct_accuracy *a, const struct ct_setting *s, double limit,
                               bool (*row)(void *, double, const double *, size_t),
                               struct ct_work_precision_point *p);

// Largest |y - x| / max |x| over the columns that are more than round-off; x, y (nsample, nresult);
// scale (nresult, out): max |x|, 0 for those that are not.
double ct_accuracy_compare(const struct ct_accuracy *a, const double *x, const double *y,
                           double *scale);

// Fills a->reference, scale, source and uncertainty by tight runs that agree. Errors:
// CT_E_REFERENCE.
bool ct_accuracy_find_reference(struct ct_accuracy *a);

// The same from a file of samples. Errors: CT_E_TABLE, CT_E_TABLE_DATA.
bool ct_accuracy_read_reference(struct ct_accuracy *a, const char *path);

#endif
