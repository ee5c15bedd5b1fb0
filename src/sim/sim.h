// A run: its options, its start, its results and what is said of it.
//
//     sim.c           options resolved, the start, the motion
//     solver.c        what finds the accelerations, as asked for
//     sim_beams.c     what is said of beams
//     verify.c        the error, by a second run
//     result_file.c   results as a file
//     summary.h       figures, for people and programs
//
// What always holds: a run owns a context, so that its memory is its alone; what it says is handed over to the caller's
// context, as copies, before an entry point returns.
#ifndef CT_SIM_H
#define CT_SIM_H

#include "report/progress.h"
#include "solve/run/run.h"
#include "system.h"

/// What multipliers leave open, at the start and at the end of a run.
struct ct_open {
    bool *row;    // of the equations: its multiplier is not unique
    bool *result; // depends on such a one
};

/// The estimated global error of an output.
struct ct_output_error_estimate {
    double absolute; // the largest over samples
    double scale;    // largest |value|
    double relative; // absolute / scale; NaN: the output is zero but for round-off
};

/// What a second run says about the first. See verify.c.
struct ct_estimate {
    const char *how;                         // the second run; NULL: none was made
    const char *why_not;                     // it failed
    struct ct_output_error_estimate *output; // (nresult); NULL: not known
    size_t which;                            // the output that is worst; nresult: there is none
    double worst;                            // its relative error; NaN: not known
    double holds_until;                      // the last sample up to which errors are as wanted
};

struct ct_sim {
    struct ct_ctx own;
    struct ct_system *system;
    const char *method_why;
    const char *solver; // asked for; NULL: the one predicted to be cheapest
    double tolerance;   // wanted of outputs
    double least_rtol;  // of steps: what double precision allows
    struct ct_run_options run_options;
    struct ct_initial_state start;
    struct ct_run *run;
    struct ct_run_report report;
    struct ct_open open;
    const enum ct_take_kind *take; // from the last results, over the run  (ntake)
    size_t ntake;
    bool is_verified; // a second run is wanted
    double *kept;     // rows so far, for it  (nkept x nresult)
    size_t nkept;
    struct ct_estimate estimate; // what it said
    const struct ct_sim_results *results;
    struct ct_ctx *caller;             // of the run: it may be cancelled
    struct ct_result_file *file;       // result_file.c; NULL: none is written
    long nwritten;                     // rows of it
    struct ct_progress bar, *progress; // NULL: none is shown
    long nstep;                        // accepted so far, for deadlines
    double begun;                      // on ct_input_sampling, when steps begin
    double deadline; // on ct_input_sampling, when the run is given up; 0: none
    bool has_run, is_done, is_late, is_interrupted, is_followed;
    double reached;                                   // by accepted steps
    double time;                                      // of the last sample
    double compile, integrate, write, verify_seconds; // seconds
};

/// What the options and the model's `simulation` say about runs, into sim->run_options. Errors: E003.
bool ct_sim_resolve(struct ct_sim *sim, const struct ct_sim_options *o);
/// Why members of a study with these options go one by one, or NULL: side by side (solve/batch/batch.h).
const char *ct_sim_refuses_batch(const struct ct_sim *sim);
/// A run that has no start yet (see ct_run_restart), in a ct_sim of zeros whose context is open.
bool ct_sim_prepare(struct ct_sim *sim, struct ct_system *sys, const struct ct_sim_options *o);

/// Solve by what `name` says, before the run begins; NULL: by the cheapest. Errors: E003.
bool ct_sim_choose_solver(struct ct_sim *sim, const char *name);
/// Is it solved as was asked, where the run begins? Systems without loops are solved in one way only. Errors: E003.
bool ct_sim_has_solver(struct ct_sim *sim);

/// Evaluate by what `name` says; NULL: by the best there is. Errors: E003.
bool ct_sim_choose_backend(struct ct_sim *sim, const char *name);
/// After the run has begun: notes, and warns, that it does so in a singular configuration.
void ct_sim_warn_of_singular_start(struct ct_sim *sim);

/// After a run that was made: the same again from its start, nothing made anew; for timing. Not of one that is verified or
/// followed.
bool ct_sim_run_again(struct ct_ctx *ctx, struct ct_sim *sim,
                      const struct ct_sim_results *results);

/// Results as a file, sim->file, in sim->own, in the format its suffix names; "-": CSV on standard output.
/// Errors: E002, E006, E007.
bool ct_sim_open_results(struct ct_sim *sim, const char *path);
bool ct_sim_write_row(struct ct_sim *sim, double t, const double *value);
/// ok: the run succeeded; else what there is stays in the partial file, and false.
bool ct_sim_close_results(struct ct_sim *sim, bool ok);
/// Without a word: what there is stays in the partial file.
void ct_sim_abandon_results(struct ct_sim *sim);

/// The same of a run that was interrupted: rows stay in the partial file, of the formats without rows nothing.
void ct_sim_interrupt_results(struct ct_sim *sim);
/// The file of the results, NULL where there is none; of partial ones NULL where they stay nowhere.
const char *ct_sim_results_path(const struct ct_sim *sim, bool is_partial);

/// After a run that kept its rows: another one, and what it says, in sim->estimate. Raises the guard.
void ct_sim_verify(struct ct_sim *sim);
/// True for a column whose largest value, scale, is round-off beside the largest column; deviation: how far
/// two runs differ there.
bool ct_is_rounding(double scale, double deviation, double largest);

/// Warn of joints that start more than a right angle or half the natural length from their guesses.
void ct_sim_warn_of_start(struct ct_sim *sim);
/// Warn of beams that bent too far for one frame.
void ct_slope_warn(struct ct_ctx *ctx, const struct ct_equations *e,
                   const struct ct_slope_report *report);
/// Beams whose motion left what their models hold for.
void ct_sim_warn_of_beams(struct ct_sim *sim);

#endif
