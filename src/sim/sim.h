// This folder makes runs: it resolves the options of a simulation, assembles its start,
// integrates or follows the motion, estimates its error, and writes results and summaries. This
// header declares a run and the interfaces between its files.
//
//     sim.c           options, the start, the motion
//     solver.c        the linear solver of closed loops
//     sim_beams.c     warnings about beams
//     verify.c        estimate of the error by a second run
//     result_file.c   the file of results
//     summary.h       figures for the summaries
//
// What always holds: a run has a context of its own, so that its memory is not shared. Its
// diagnostics are copied to the caller's context before an entry point returns.
#ifndef CT_SIM_H
#define CT_SIM_H

#include "report/progress.h"
#include "solve/run/run.h"
#include "system.h"

/// Which multipliers are not unique, at the start and at the end of a run.
struct ct_open {
    bool *row;    // by row of the equations: its multiplier is not unique
    bool *result; // by output: it depends on such a multiplier
};

/// The estimated global error of an output.
struct ct_output_error_estimate {
    double absolute; // largest over the samples
    double scale;    // largest |value|
    double relative; // absolute / scale; NaN: the output is zero up to round-off
};

/// The estimate of the error from a second run; see verify.c.
struct ct_estimate {
    const char *how;     // description of the second run; NULL: there was none
    const char *why_not; // reason why the second run failed
    struct ct_output_error_estimate *output; // (nresult); NULL: no estimate
    size_t which;       // index of the output with the largest relative error; nresult: none
    double worst;       // its relative error; NaN: no estimate
    double holds_until; // time of the last sample up to which errors are within the limit
};

struct ct_sim {
    struct ct_ctx own;
    struct ct_system *system;
    const char *method_why;
    const char *solver; // as requested; NULL: the cheapest as predicted
    double tolerance;   // wanted accuracy of outputs
    double least_rtol;  // smallest tolerance of steps that double precision allows
    struct ct_run_options run_options;
    struct ct_initial_state start;
    struct ct_run *run;
    struct ct_run_report report;
    struct ct_open open;
    const enum ct_take_kind *take; // functions of the last outputs over the run  (ntake)
    size_t ntake;
    bool is_verified; // a second run is requested
    double *kept;     // samples so far, for the second run  (nkept x nresult)
    size_t nkept;
    struct ct_estimate estimate; // result of the second run
    const struct ct_sim_results *results;
    struct ct_result_file *file;       // NULL: no file
    long nwritten;                     // number of rows written
    struct ct_progress bar, *progress; // NULL: no progress bar
    long nstep;                        // accepted steps, for deadlines
    double begun;                      // ct_monotonic_time when integration began [s]
    double deadline; // ct_monotonic_time when the run is abandoned [s]; 0: none
    bool has_run, is_done, is_late, is_interrupted, is_followed;
    double reached;                                   // time reached by accepted steps
    double time;                                      // time of the last sample
    double compile, integrate, write, verify_seconds; // durations [s]
};

/// Sets sim->run_options from the options and the model's `simulation`. Errors: E003.
bool ct_sim_resolve(struct ct_sim *sim, const struct ct_sim_options *o);
/// Returns the reason why members of a study with these options cannot run as a batch
/// (solve/batch/batch.h); NULL: they can.
const char *ct_sim_refuses_batch(const struct ct_sim *sim);
/// Prepares a run without a start (see ct_run_restart), in a zeroed ct_sim whose context is
/// open.
bool ct_sim_prepare(struct ct_sim *sim, struct ct_system *sys, const struct ct_sim_options *o);

/// Chooses the solver by name before the run begins; NULL: the cheapest. Errors: E003.
bool ct_sim_choose_solver(struct ct_sim *sim, const char *name);
/// Checks that the requested solver is available where the run begins. Systems without loops
/// have only one solver. Errors: E003.
bool ct_sim_has_solver(struct ct_sim *sim);

/// Chooses what evaluates the equations by name; NULL: the fastest available. Errors: E003.
bool ct_sim_choose_backend(struct ct_sim *sim, const char *name);
/// After the run has begun: records and warns if the start is a singular configuration.
void ct_sim_warn_of_singular_start(struct ct_sim *sim);

/// After a complete run: repeats it from its start without new allocations, for timing. Not for
/// runs that are verified or follow a motion.
bool ct_sim_run_again(struct ct_ctx *ctx, struct ct_sim *sim,
                      const struct ct_sim_results *results);

/// Opens the file of results, sim->file, in sim->own. The suffix of path determines the format;
/// "-" is CSV on standard output. Errors: E002, E006, E007.
bool ct_sim_open_results(struct ct_sim *sim, const char *path);
bool ct_sim_write_row(struct ct_sim *sim, double t, const double *value);
/// Closes the file. ok: the run succeeded; otherwise the rows stay in the partial file, and
/// false is returned.
bool ct_sim_close_results(struct ct_sim *sim, bool ok);
/// Closes the file without a diagnostic. The rows stay in the partial file.
void ct_sim_abandon_results(struct ct_sim *sim);

/// The same for an interrupted run: rows of CSV stay in the partial file, other formats leave
/// no file.
void ct_sim_interrupt_results(struct ct_sim *sim);
/// Path of the file of results, NULL if there is none. is_partial: path of the partial file,
/// NULL if the format leaves none.
const char *ct_sim_results_path(const struct ct_sim *sim, bool is_partial);

/// After a run that kept its samples: makes a second run and sets sim->estimate. Raises the
/// guard.
void ct_sim_verify(struct ct_sim *sim);
/// Sets `relative` of n outputs from scale and absolute. An output is zero up to round-off if it is
/// that small relative to the largest one, or if the two runs agree in no digit of it and the
/// errors of the other outputs are as large. Examples: a sum of energies that cancel, a momentum
/// that stays zero.
void ct_output_errors_relate(struct ct_output_error_estimate *o, size_t n);

/// Warns of joints that start more than a right angle or half the natural length from their
/// guesses.
void ct_sim_warn_of_start(struct ct_sim *sim);
/// Warns of beams whose sections rotate too far relative to the frame of the beam.
void ct_slope_warn(struct ct_ctx *ctx, const struct ct_equations *e,
                   const struct ct_slope_report *report);
/// Warns of beams whose motion is outside the range of validity of their models.
void ct_sim_warn_of_beams(struct ct_sim *sim);

#endif
