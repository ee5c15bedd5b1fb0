// A run: equations, consistent start, integration with projection, events, samples and ledger.
#ifndef CT_SOLVE_RUN_RUN_H
#define CT_SOLVE_RUN_RUN_H

#include "beam_error/beam_error_modal.h"
#include "integrate/problem.h"
#include "integrate/take.h"
#include "solve/initial/assembly.h"
#include "solve/constraint/partition.h"

struct ct_rank_monitor;

/// How a long run goes on, as it looks at t.
struct ct_step_forecast {
    double t, step, to_come; // step: of now [s]; to_come: so many
    const char
        *fastest; // the coordinate of the fastest motion possible; NULL: it cannot be told
    double rate;  // of that motion [1/s]
    const char
        *demanding; // an output that all vibrations are followed for; NULL: there is none
};

struct ct_run_options {
    const struct ct_method *method;
    double duration, rtol, atol, step;
    double
        least_rtol; // motions with many turns may be held to as little; 0: all are held to rtol
    /// Taken over where the run of an explicit method turns out stiff, with these tolerances; NULL:
    /// never.
    const struct ct_method *stiff_method;
    double output_rtol; // of outputs, relative: for the choice of the method
    double stiff_rtol, stiff_atol;
    void (*want_residual)(void *user); // it will be needed: the equations must get it
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

/// Slopes at the time t, of what the validity program of the evaluator has just found.
void ct_slope_monitor(struct ct_slope_report *report, const struct ct_evaluator *m, double t);

struct ct_run_report {
    const struct ct_method *method; // that came to the end
    /// Where the implicit method first took over as the motion was stiff: rates of the fastest
    /// motion possible and of the one there was [1/s], and how many times as far it got for the
    /// same work (NaN: it began). changed_at is NaN if it did not, returned_at if it was not last
    /// left as not faster any more.
    double changed_at, fast, slow, gain, returned_at;
    struct ct_integrate_stats stats;
    struct ct_validity_report {
        double mean,
            largest; // of the indicator: over the last period of the beam, and its largest size so far
        double
            beyond_since; // from when on the indicator itself is beyond the limit; negative: it is not
        double left_at; // the same when the mean passed the limit, too; negative: it never did
        double
            error_beyond_since; // from when on the error estimated is beyond it; negative: it is not
        struct ct_beam_error_modal modal;            // that estimate it
        struct ct_beam_error_coupled_run *coupled;   // the base of theirs that is not driven
    } * validity;                                    // by indicator of the equations
    struct ct_slope_report *slopes;                  // by bent beam of the equations
    double energy_scale;                             // the largest energy
    double energy_drift;                             // largest |total - total(0)| over it
    double position_constraint, velocity_constraint; // largest residuals at samples
    int roundoff_limited; // result with fewer digits than the tolerance asks for; -1: none
    double roundoff,
        roundoff_sum; // of its largest value: one round-off of states, and those of all steps that remain; NAN: they do not add up
    long explicit_steps; // steps of explicit methods
    int rank;
    long switches;
    long factorizations;
    struct ct_solve_counts solves;
    const struct ct_rank_monitor *singular; // positions passed; NULL: nothing was integrated
    double *
        final; // last row; what is taken over the run instead of the results that it is taken from
    double *y; // last state: q, u, work
};

/// Machine, embedding and state at t = 0, assembled; choices made and modes set. NULL with a
/// diagnostic on failure.
struct ct_run *ct_run_create(struct ct_ctx *ctx, struct ct_arena *a,
                             const struct ct_model *model, const struct ct_equations *e,
                             const struct ct_initial_state *start);
/// Machine and embedding only: it has to be started, by begin, or by restart.
struct ct_run *ct_run_prepare(struct ct_ctx *ctx, struct ct_arena *a,
                              const struct ct_model *model, const struct ct_equations *e);
/// To the start; choices made and modes set. False with a diagnostic.
bool ct_run_begin(struct ct_run *r, const struct ct_initial_state *start);
/// The run as new from another start, with the values that the model's parameters have now. False
/// with a diagnostic.
bool ct_run_restart(struct ct_run *r, const struct ct_initial_state *start);
struct ct_evaluator *ct_run_evaluator(struct ct_run *r);
struct ct_partition *ct_run_partition(struct ct_run *r);
/// Is the start near a singular configuration, so that steps begin before it or are told of it?
/// After begin or restart.
bool ct_run_starts_near_singular(struct ct_run *r);
/// The start is in a singular configuration: constraints of these joints, quoted names that stay,
/// depend on others there alone.
void ct_run_note_singular_start(struct ct_run *r, const char *joints);
const char *ct_run_singular_joints(const struct ct_run *r);
/// State at the start: q, u, work.
const double *ct_run_state(const struct ct_run *r);
/// The same as it was assembled, before rows took off what they see of it: in a singular
/// configuration they see it by round-off alone.
const double *ct_run_assembled(const struct ct_run *r);
/// Which states are measured together for the error of steps; NULL: none. In the run's arena, anew
/// at each call.
const struct ct_groups *ct_run_groups(struct ct_run *r);
/// The control of outputs; NULL: none is controlled.
const struct ct_output_error *ct_run_output_error(const struct ct_run *r);
/// Does a run with these options, from the state at the start, begin with the implicit method
/// because of its outputs?
bool ct_run_begins_implicit(struct ct_run *r, const struct ct_run_options *o);
/// dy (out) = f(t, y), for y as ct_run_state has it.
enum ct_eval ct_run_rhs(struct ct_run *r, double t, const double *y, double *dy);
/// Accelerations, multipliers and results at t, y; out has nresult entries.
enum ct_eval ct_run_results(struct ct_run *r, double t, const double *y, double *out);

/// What redundant constraints leave open at t, y: row[i] becomes true if the multiplier of row i is
/// not unique, result[i] if the result changes with such multipliers. What is true already stays.
void ct_run_find_undetermined(struct ct_run *r, double t, const double *y, bool *row,
                              bool *result);

/// Follow the motions of a run that has no freedom left, sample by sample: places by Newton's
/// method, speeds and accelerations from the rows. Nothing is integrated but the work. Errors:
/// CT_E_NOT_DRIVEN, CT_E_DRIVER_JUMP, CT_E_SAMPLE_REFUSED, CT_E_SINGULAR.
bool ct_run_kinematic(struct ct_run *r, const struct ct_run_options *o,
                      struct ct_run_report *report);

/// A scan for these options, with the functions that it is given behind all results. All in a;
/// NULL: nothing is taken.
struct ct_take_scan *ct_run_take_create(struct ct_arena *a, const struct ct_run_options *o);
void ct_run_take_begin(struct ct_take_scan *s, const struct ct_run_options *o);

/// Integrate over the duration.
bool ct_run_simulate(struct ct_run *r, const struct ct_run_options *o,
                     struct ct_run_report *report);

#endif
