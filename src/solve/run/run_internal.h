// Declarations that the files of a run share.
//
//     run.c               evaluation, creation, integration, samples
//     event.c             events, jumps of driven rates
//     impulse.c           speeds after such a jump
//     kinematic_run.c     kinematic analysis, with all freedoms driven
//     method_switch.c     choice between the explicit and the implicit method
//     step_forecast.c     forecast of long runs
//     run_diagnostics.c   notes on why a run ended early
//     roundoff_limit.c    outputs that have few digits
//     beam_monitor.c      beams beyond the validity of their models
#ifndef CT_SOLVE_RUN_RUN_INTERNAL_H
#define CT_SOLVE_RUN_RUN_INTERNAL_H

#include "integrate/stiffness.h"
#include "numeric/roundoff.h"
#include "solve/evaluator/input_sampling.h"
#include "solve/output_error/output_error.h"
#include "solve/evaluator/switch_state.h"
#include "solve/run/run.h"
#include "solve/singular/singular.h"

#include <math.h>

struct ct_run {
    struct ct_ctx *ctx;
    struct ct_arena *arena;
    const struct ct_model *model;
    const struct ct_equations *e;
    struct ct_evaluator *m;
    struct ct_partition *s;
    size_t ny;
    double *assembled; // state at the start  (ny)
    double *y, *dy, *stage, *scratch, *value, *next;
    struct ct_tangent_basis *basis[2]; // of kinematic analysis, at both ends of a step
    double *largest;                   // of each result, over the samples
    double *event;                     // times
    size_t nevent;
    int *root_of; // switches of the state, in order (nroot)
    int nroot;
    signed char *crossed;      // by switch: as `crossed` of ct_switches_start (nswitch)
    int *visits;               // of ct_run_settle_switches (nswitch)
    bool needs_lam, has_power; // needs_lam: the power does
    bool has_turns;            // angles or rotations found from their last values
    bool has_lam_results;      // outputs or indicators depend on multipliers
    struct ct_impulse *impulse;
    struct ct_output_error *output_error; // of outputs; NULL: none is controlled
    const struct ct_run_options *o;
    struct ct_run_report *report;
    double energy0, energy_scale;
    struct ct_rank_monitor *singular;
    struct ct_singularities singularities; // hooks of that monitor
    struct ct_singular_dense_output *singular_dense_output;
    struct ct_input_sampling input_sampling;
    double pending; // time of the next event; INFINITY: there is none
    double angle_rate,
        t_angle_rate; // rate of angles that are counted over turns [rad/s], and its time
    double t0; // time of the first step; before 0 if the start is near a singular configuration
    bool started;
    // the choice of the method
    const struct ct_method *method;       // in use
    struct ct_integrate_stats stats;      // of the integration
    struct ct_take_scan *take;            // functions taken over the run; NULL: none
    double *taken, *inside;               // results, a state inside a step
    struct ct_stiffness *stiffness;       // stiffness detection; NULL: off
    struct ct_stiffness *start_stiffness; // at starts, for ct_run_begins_implicit
    const struct ct_problem *problem;     // that is integrated
    bool is_announced;                    // the forecast has been given
    struct ct_trial *trial;               // trial in progress; NULL: none
    struct ct_trial implicit;      // time and work of the implicit method since it took over
    double explicit_time_per_work; // time per work of the explicit method before
    double spent;                  // work of the last trial
    bool is_suspect;               // steps were ended to consider another method
    bool resolves_vibrations;      // steps are limited by the phase of vibrations
    bool has_sensitive_outputs;    // some output is sensitive at the start
    // joints whose constraints are dependent at the start only; NULL: none
    const char *singular_joints;
    bool *is_given;  // (nu) speeds whose coordinates are given at the start
    bool has_jumped; // speeds have jumped since the method was chosen
    // part of an output that is due to vibrations which an explicit method resolves
    double vibration_effect;
    double t_before, last_event; // times
    size_t ngiven;               // samples
    double t_sample;             // the last one
};

/// Fill in the problem of a run whose options are set. watched (ny): states that error control
/// uses; it must live as long as p.
void ct_run_pose(struct ct_run *r, struct ct_problem *p, const bool *watched);

/// The time at which to evaluate: t, or just before the next event.
static inline double ct_run_time_before_event(const struct ct_run *r, double t)
{
    return t < r->pending ? t : ct_time_just_before(t, r->pending);
}

/// Multipliers of the last accelerations, into the evaluator's input.
void ct_run_find_multipliers(struct ct_run *r);
double ct_run_kinetic_energy(struct ct_run *r, double t, const double *y);

/// Angles that are counted over several turns may change by less than half a turn in a step: store
/// their rate at t, y.
void ct_run_store_angle_rate(struct ct_run *r, double t, const double *y);
/// The longest step that this allows.
double ct_run_longest_step(void *user);
/// False if the step to t, y was too long for it; else store the rate there.
bool ct_run_turns_are_followed(struct ct_run *r, double t, const double *y);

/// Results and checks at a sample; false to stop, with a diagnostic if that is an error. user is
/// the run.
bool ct_run_at_sample(void *user, double t, const double *y);
bool ct_run_at_step(void *user, double t, const double *y);

/// Monitor of beams, for the report: after the results of a sample; at the start of a run.
void ct_run_monitor_sample(struct ct_run *r, double t);
void ct_run_monitor_start(struct ct_run *r, double t, const double *y);
/// Pass the motion of the beams' bases at t, y to the estimate of their error: at the start; after
/// a step, which may be skipped; before an event and after an impulse there; after a jump that does
/// not act on beams.
enum ct_monitor_when { CT_MONITOR_START, CT_MONITOR_STEP, CT_MONITOR_EVENT, CT_MONITOR_SMOOTH };
void ct_run_monitor_base(struct ct_run *r, double t, const double *y, enum ct_monitor_when how);
void ct_run_monitor_impulse(struct ct_run *r, double t, const double *y);
double ct_run_sample_time(const struct ct_run_options *o, size_t i);

struct ct_impulse *ct_impulse_create(struct ct_arena *a, const struct ct_evaluator *m);
/// Speeds u (nu, in and out) after driven rates have jumped to those of the evaluator. before:
/// outputs of its `momentum` program before the jump.
enum ct_eval ct_impulse_apply(struct ct_run *r, const double *before, double *u);

// Events of ct_problem, user being the run.
double ct_run_next_event(void *user, double t);
/// Do all tables extend beyond t? If not, an error (E310).
bool ct_run_tables_reach(struct ct_run *r, double t);
enum ct_eval ct_run_root(void *user, double t, const double *y, double *g);
void ct_run_sides(void *user, signed char *side);
enum ct_eval ct_run_event(void *user, double t, double *y, const double *dy,
                          const signed char *crossed, bool is_time);
/// After an event while a singular configuration is crossed, where f is not computed but known as
/// dy: an error (E406) if a switch does not agree with it.
enum ct_eval ct_run_resumed(void *user, double t, const double *y, const double *dy);
/// Notes that name the drivers that move at t, y, with their values.
void ct_run_note_drivers(struct ct_run *r, double t, const double *y);
/// Make the sides of switches with g = 0 consistent with the derivative, which depends on the
/// sides. CT_EVAL_FATAL with CT_E_STUCK if the forces on both sides of a switch lead back to it.
/// crossed (nswitch): switches that have just crossed; NULL: none, or forces and speeds jump as
/// well.
enum ct_eval ct_run_settle_switches(struct ct_run *r, double t, const double *y,
                                    const signed char *crossed);
/// Is a change of a driven coordinate of this size at an event, or the residual of a row after it,
/// more than round-off [rad, m]?
bool ct_run_is_coordinate_jump(double jump, double size);
/// Always false, with CT_E_DRIVER_JUMP.
bool ct_run_report_jump(struct ct_run *r, const char *name, struct ct_mark mark, double jump,
                        double t);
/// At the last ct_evaluator_constraint. False with CT_E_DRIVER_JUMP.
bool ct_run_chords_are_closed(struct ct_run *r, double t);

/// If the start is in or near a singular configuration, move the first state a little before it.
/// False with a diagnostic.
bool ct_run_start_steps(struct ct_run *r);

/// For ct_integrate: report once that many steps are to come.
void ct_run_forecast(void *user, double t, const double *y, double step, double to_come);
extern const double ct_run_many_steps;
/// Notes on the cause when a run would take more steps than are allowed.
void ct_run_explain_count(struct ct_run *r);
/// A result with few digits.
struct ct_roundoff_limit {
    int output; // -1: there is none
    // its error over its largest value: by one round-off of states, and by the sum over all steps;
    // NAN: they do not add up
    double one, sum;
};
/// At the end of a run: the result with the fewest digits. It is reported if, relative to its
/// largest value at samples, one round-off of states is more than a twentieth of `wanted`, or the
/// sum of round-off over all steps is more than `wanted`. `value` of the run may change.
struct ct_roundoff_limit ct_run_find_roundoff_limit(struct ct_run *r, double wanted);
/// After the error of a run that ended early: notes on the cause.
void ct_run_explain_end(struct ct_run *r);
/// Integrate from start to end, and change the method when that pays.
bool ct_run_integrate(struct ct_run *r, struct ct_problem *p, struct ct_integrate_options io);
/// Should another method be considered after this step?
bool ct_run_suspects_stiffness(struct ct_run *r, double t, const double *y);

#endif
