// A run from inside: what its parts share. For run.c and the files beside it that it is made of.
//
//     run.c  evaluation, creation, samples
//     event.c     events, jumps of driven rates      kinematic_run.c    motions driven all through
//     impulse.c      speeds after those
//     method_switch.c    the choice of the method, when the motion turns stiff
//     step_forecast.c    what is said of runs that take long
//     run_diagnostics.c    and of those that end before their time
//     roundoff_limit.c     outputs that have few digits
//     beam_monitor.c  beams that leave what their models hold for
#ifndef CT_SOLVE_RUN_RUN_INTERNAL_H
#define CT_SOLVE_RUN_RUN_INTERNAL_H

#include "integrate/stiffness.h"
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
    double *largest; // of each result, over the samples
    double *event;   // times
    size_t nevent;
    int *root_of; // switches of the state, in order (nroot)
    int nroot;
    signed char *crossed;      // by switch: as `crossed` of an event (nswitch)
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
    double pending;            // time of the event ahead; INFINITY if there is none
    double turning, t_turning; // how fast followed angles turn [rad/s], and when that was
    double
        t0; // where steps begin: before 0 if the start is in or near a singular configuration
    bool started;
    // the choice of the method
    const struct ct_method *method;       // that steps now
    struct ct_integrate_stats stats;      // of it
    struct ct_take_scan *take;            // of steps; NULL: nothing is taken
    double *taken, *inside;               // results, a state in a step
    struct ct_stiffness *stiffness;       // watched for; NULL: not
    struct ct_stiffness *start_stiffness; // of starts, for ct_run_begins_implicit
    const struct ct_problem *problem;     // that is integrated
    bool is_announced;                    // that it takes long
    struct ct_trial *trial;               // under way
    struct ct_trial implicit;             // what the implicit method gains since it took over
    double explicit_pace;                 // what was gained before
    double spent;                         // by the last trial
    bool is_suspect;                      // steps ended to think of another method
    bool resolves_vibrations;             // or to hold them to the phase of vibrations
    bool has_sensitive_outputs;           // outputs do, at the start
    const char
        *singular_joints; // whose constraints depend at the start and not elsewhere; NULL: none
    bool *is_given;       // (nu) speeds whose coordinates the start is given by
    bool has_jumped;      // speeds have, since the method was chosen
    double
        vibration_effect; // part of an output that vibrations make which an explicit method follows
    double t_before, last_event; // times
    size_t ngiven;               // samples
    double t_sample;             // the last one
};

/// The problem of a run whose options are set. watched: by state (ny), what error control looks at;
/// lives as long.
void ct_run_pose(struct ct_run *r, struct ct_problem *p, const bool *watched);

/// The time to evaluate at for t.
static inline double ct_run_time_before_event(const struct ct_run *r, double t)
{
    return t < r->pending ? t : ct_time_just_before(t, r->pending);
}

/// Multipliers that belong to them, into the evaluator's input.
void ct_run_find_multipliers(struct ct_run *r);
double ct_run_kinetic_energy(struct ct_run *r, double t, const double *y);

/// Angles and rotations that are followed from step to step may make less than half a turn in each:
/// note how fast they turn at t, y.
void ct_run_note_turning(struct ct_run *r, double t, const double *y);
/// The longest step from there.
double ct_run_longest_step(void *user);
/// False where a step from there to t, y is too long, else noted.
bool ct_run_turns_are_followed(struct ct_run *r, double t, const double *y);

/// A sample, results and ledger; false to stop, with a diagnostic if that is an error. user is the
/// run.
bool ct_run_at_sample(void *user, double t, const double *y);
bool ct_run_at_step(void *user, double t, const double *y);

/// Beams, into the report: of the results just found; from the start of a run on.
void ct_run_monitor_sample(struct ct_run *r, double t);
void ct_run_monitor_start(struct ct_run *r, double t, const double *y);
/// How their bases move at t, y: at the start; after a step, which may be passed over; before an
/// event and after an impulse there; after a jump that beams do not feel.
enum ct_monitor_when { CT_MONITOR_START, CT_MONITOR_STEP, CT_MONITOR_EVENT, CT_MONITOR_SMOOTH };
void ct_run_monitor_base(struct ct_run *r, double t, const double *y, enum ct_monitor_when how);
void ct_run_monitor_impulse(struct ct_run *r, double t, const double *y);
double ct_run_sample_time(const struct ct_run_options *o, size_t i);

struct ct_impulse *ct_impulse_create(struct ct_arena *a, const struct ct_evaluator *m);
/// Speeds u (nu, in and out) after driven rates have jumped to those the evaluator has now; before:
/// its `momentum` program then.
enum ct_eval ct_impulse_apply(struct ct_run *r, const double *before, double *u);

// Events of ct_problem, user being the run.
double ct_run_next_event(void *user, double t);
/// Do the tables tell what follows t? An error if not (E310).
bool ct_run_tables_reach(struct ct_run *r, double t);
enum ct_eval ct_run_root(void *user, double t, const double *y, double *g);
void ct_run_sides(void *user, signed char *side);
enum ct_eval ct_run_event(void *user, double t, double *y, const double *dy,
                          const signed char *crossed, bool is_time);
/// In the gap of a crossing, where f is not computed but known, dy: an error (E406) where a switch
/// is contradicted.
enum ct_eval ct_run_resumed(void *user, double t, const double *y, const double *dy);
/// Notes that name the drivers that move at t, y, and where they are.
void ct_run_note_drivers(struct ct_run *r, double t, const double *y);
/// With the sides of switches set for an earlier derivative: makes those consistent whose g is
/// zero. CT_EVAL_FATAL with CT_E_STUCK where the forces on both sides of a switch lead back to it.
/// crossed (nswitch): those that have just crossed; NULL: none, or forces and speeds jump as well.
enum ct_eval ct_run_settle_switches(struct ct_run *r, double t, const double *y,
                                    const signed char *crossed);
/// Of a driver's value or rate, beside round-off [rad, m, 1/s].
extern const double ct_run_jump_tolerance;
/// Always false, with CT_E_DRIVER_JUMP.
bool ct_run_report_jump(struct ct_run *r, const char *name, struct ct_mark mark, double jump,
                        double t);
/// At the last ct_evaluator_constraint. False with CT_E_DRIVER_JUMP.
bool ct_run_chords_are_closed(struct ct_run *r, double t);

/// Brings the first state to where steps begin: in or near a singular configuration a little before
/// it. False with a diagnostic.
bool ct_run_start_steps(struct ct_run *r);

/// For ct_integrate: tells that the end is many steps away, once.
void ct_run_forecast(void *user, double t, const double *y, double step, double to_come);
extern const double ct_run_many_steps;
/// Notes on what holds a run up that would take more steps than are allowed.
void ct_run_explain_count(struct ct_run *r);
/// A result with few digits.
struct ct_roundoff_limit {
    int output; // -1: there is none
    double one,
        sum; // what one round-off of states is of its largest value, and those of all steps; NAN: they do not add up
};
/// At the end of a run, which may change `value`: the result with the fewest digits, if one
/// round-off is more than half of `held`, what steps are held to, or those of all steps more than
/// `wanted`, of its largest value at samples.
struct ct_roundoff_limit ct_run_find_roundoff_limit(struct ct_run *r, double held,
                                                    double wanted);
/// Notes on why steps have ended, after its error.
void ct_run_explain_end(struct ct_run *r);
/// From start to end, with another method from where that pays.
bool ct_run_integrate(struct ct_run *r, struct ct_problem *p, struct ct_integrate_options io);
/// Is another method worth a thought after this step?
bool ct_run_suspects_stiffness(struct ct_run *r, double t, const double *y);

#endif
