// One run of a model: from consistent initial conditions the equations of motion are integrated in
// time, with projection onto the constraints, location of events, results at samples, and checks of
// energy and constraints. The method may change during the run if the motion becomes stiff. A run
// in which all freedoms are driven is a kinematic analysis instead.
#ifndef CT_SOLVE_RUN_RUN_H
#define CT_SOLVE_RUN_RUN_H

#include "beam_error/beam_error_modal.h"
#include "integrate/problem.h"
#include "integrate/take.h"
#include "solve/initial/assembly.h"
#include "solve/constraint/partition.h"

struct ct_rank_monitor;

/// Forecast of a long run, made at the time t.
struct ct_step_forecast {
    double t, step, to_come; // step: present step size [s]; to_come: number of steps left
    // coordinate with the largest part in the fastest possible motion; NULL: not found
    const char *fastest;
    double rate;           // of that motion [1/s]
    const char *demanding; // output for which all vibrations are resolved; NULL: there is none
};

struct ct_run_options {
    const struct ct_method *method;
    double duration, rtol, atol, step;
    // tolerance that motions of many periods may be tightened to; 0: all have rtol
    double least_rtol;
    /// The implicit method that takes over from an explicit one if the motion is stiff, with
    /// stiff_rtol and stiff_atol; NULL: none does.
    const struct ct_method *stiff_method;
    double output_rtol; // relative tolerance of outputs, for the choice of the method
    double stiff_rtol, stiff_atol;
    void (*want_residual)(void *user); // asks the owner to derive the residual of the equations
    size_t nsample;
    const enum ct_take_kind *take; // what is taken over the run from the last results  (ntake)
    size_t ntake;
    enum ct_rate_jumps rate_jumps;
    /// One row of results per sample; return false to stop.
    bool (*row)(void *user, double t, const double *value, size_t n);
    bool (*progress)(void *user, double t, double end);
    /// Called once when a million steps and more are to come. May be NULL.
    void (*forecast)(void *user, const struct ct_step_forecast *f);
    void *user;
};

struct ct_slope_report {
    double largest;   // slope of a node so far
    double passed_at; // when it passed CT_SLOPE_LIMIT; negative: never
};

/// Update the slopes at the time t from the last outputs of the evaluator's validity program.
void ct_slope_monitor(struct ct_slope_report *report, const struct ct_evaluator *m, double t);

struct ct_run_report {
    const struct ct_method *method; // in use at the end
    /// changed_at: time when the implicit method first took over; NaN: never. fast, slow: rates of
    /// the fastest possible motion and of the actual one there [1/s]. gain: time it advances per
    /// work, over that of the explicit method; NaN: the run began with it. returned_at: time when
    /// the explicit method took over again for good; NaN: it did not.
    double changed_at, fast, slow, gain, returned_at;
    struct ct_integrate_stats stats;
    struct ct_validity_report {
        // mean of the indicator over the last period of the beam, and its largest size so far
        double mean, largest;
        double
            beyond_since; // time since which the indicator is above the limit; negative: it is not
        double left_at; // that time when the mean first passed the limit; negative: never
        double error_beyond_since; // the same of the estimated error; negative: it is not
        struct ct_beam_error_modal modal;          // estimated error, by vibration modes
        struct ct_beam_error_coupled_run *coupled; // the same with a base that is free to move
    } * validity;                                  // by indicator of the equations
    struct ct_slope_report *slopes;                // by bent beam of the equations
    double energy_scale;                           // the largest energy
    double energy_drift;                           // largest |total - total(0)| over it
    double position_constraint, velocity_constraint; // largest residuals at samples
    int roundoff_limited; // result with fewer digits than the tolerance asks for; -1: none
    // its error over its largest value: by one round-off of states, and by the sum over all steps;
    // NAN: they do not add up
    double roundoff, roundoff_sum;
    long explicit_steps; // steps of explicit methods
    int rank;
    long switches;
    long factorizations;
    struct ct_solve_counts solves;
    const struct ct_rank_monitor
        *singular; // configurations passed; NULL: nothing was integrated
    // last row of results; functions taken over the run stand in place of the results they are of
    double *final;
    double *y; // last state: q, u, work
};

/// Create a run: evaluator, coordinate partitioning and the assembled state at t = 0, with rows and
/// columns chosen and switches set. NULL with a diagnostic on failure.
struct ct_run *ct_run_create(struct ct_ctx *ctx, struct ct_arena *a,
                             const struct ct_model *model, const struct ct_equations *e,
                             const struct ct_initial_state *start);
/// Create the evaluator and the partitioning only; ct_run_begin or ct_run_restart must follow.
struct ct_run *ct_run_prepare(struct ct_ctx *ctx, struct ct_arena *a,
                              const struct ct_model *model, const struct ct_equations *e);
/// Set the state to the start, choose rows and columns, set switches. False with a diagnostic.
bool ct_run_begin(struct ct_run *r, const struct ct_initial_state *start);
/// Begin anew from another start, with the present values of the model's parameters. False with a
/// diagnostic.
bool ct_run_restart(struct ct_run *r, const struct ct_initial_state *start);
struct ct_evaluator *ct_run_evaluator(struct ct_run *r);
struct ct_partition *ct_run_partition(struct ct_run *r);
/// Is the start near a singular configuration, so that the first step needs special treatment? To
/// be called after begin or restart.
bool ct_run_starts_near_singular(struct ct_run *r);
/// Note that the start is in a singular configuration. joints: quoted names of the joints whose
/// constraints are dependent there only; the text must stay.
void ct_run_note_singular_start(struct ct_run *r, const char *joints);
const char *ct_run_singular_joints(const struct ct_run *r);
/// State at the start: q, u, work.
const double *ct_run_state(const struct ct_run *r);
/// The same as assembled, before the projection onto the constraints. In a singular configuration
/// the projection may change speeds by round-off divided by a pivot that is nearly zero.
const double *ct_run_assembled(const struct ct_run *r);
/// Groups of states with a common scale in the error norm; NULL: none. Allocated in the run's arena
/// at each call.
const struct ct_groups *ct_run_groups(struct ct_run *r);
/// The error control of outputs; NULL: no output is controlled.
const struct ct_output_error *ct_run_output_error(const struct ct_run *r);
/// Does a run with these options, from the state at the start, begin with the implicit method
/// because of its outputs?
bool ct_run_begins_implicit(struct ct_run *r, const struct ct_run_options *o);
/// dy (out) = f(t, y), for y as ct_run_state has it.
enum ct_eval ct_run_rhs(struct ct_run *r, double t, const double *y, double *dy);
/// Accelerations, multipliers and results at t, y; out has nresult entries.
enum ct_eval ct_run_results(struct ct_run *r, double t, const double *y, double *out);

/// What redundant constraints leave undetermined at t, y: set row[i] if the multiplier of row i is
/// not unique, result[i] if the result depends on such multipliers. Other entries do not change.
void ct_run_find_undetermined(struct ct_run *r, double t, const double *y, bool *row,
                              bool *result);

/// Kinematic analysis of a run in which all freedoms are driven: at each sample coordinates by
/// Newton's method, speeds and accelerations from the constraints. Only the work is integrated.
/// Errors: CT_E_NOT_DRIVEN, CT_E_DRIVER_JUMP, CT_E_SAMPLE_REFUSED, CT_E_SINGULAR.
bool ct_run_kinematic(struct ct_run *r, const struct ct_run_options *o,
                      struct ct_run_report *report);

/// Scan of steps for extreme values and other functions over the run, which follow the results. All
/// in a; NULL: none is wanted.
struct ct_take_scan *ct_run_take_create(struct ct_arena *a, const struct ct_run_options *o);
void ct_run_take_begin(struct ct_take_scan *s, const struct ct_run_options *o);

/// Integrate over the duration.
bool ct_run_simulate(struct ct_run *r, const struct ct_run_options *o,
                     struct ct_run_report *report);

#endif
