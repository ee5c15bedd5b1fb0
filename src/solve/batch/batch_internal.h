// Data shared by the files of this folder: values of all lanes, and the state of each lane. See
// batch.h.
//
//   batch.c          creation; start and end of members
//   batch_step.c     a try of a step in all lanes: stages, error, projection, step control
//   batch_solver.h   accelerations and projection by symbolic solvers in lanes
//   batch_take.h     functions over a run
//   batch_event.c    location and handling of events of one lane
//   batch_event_location.h   may a root function of some lane have changed sign?
//   batch_single.c   one lane as a run alone, by the functions of a single run
#ifndef CT_SOLVE_BATCH_BATCH_INTERNAL_H
#define CT_SOLVE_BATCH_BATCH_INTERNAL_H

#include "integrate/step_control.h"
#include "integrate/periodic_tolerance.h"
#include "integrate/event_location.h"
#include "solve/evaluator/input_sampling.h"
#include "solve/output_error/output_error.h"
#include "solve/batch/batch.h"

enum { W = CT_LANES };

// One value of each lane; arenas align to 16 bytes only.
typedef double vec __attribute__((vector_size(W * sizeof(double)), aligned(8), may_alias));
// A mask by lane: all bits set, or none.
typedef long long mask __attribute__((vector_size(W * sizeof(long long)), may_alias));
// A set of lanes: bit l is lane l.
typedef unsigned set;

// A generated program for all lanes at once.
struct ct_lane_program {
    const struct ct_tape *tape;
    struct ct_native *native; // NULL: the tape is run
    vec *out;
    double *work;
    size_t nout;
};

// Outputs of one kind that are controlled.
struct ct_lane_outputs {
    struct ct_lane_program program; // empty if there are none
    bool needs_lam;
    vec *at, *probed;                      // (n)
    double *one_at, *one_probed, *one_off; // of one lane
};

// The symbolic solver of one choice of rows and columns, and the lanes with that choice.
struct ct_lane_solver {
    struct ct_solver *solver;
    struct ct_solver_code code;
    struct ct_lane_program solved, checked, closing;
    set lanes;
};

// A stage of a method without the zeros of its tableau: sum over i of a[i] k[at[i]].
struct ct_lane_sum {
    int n;
    size_t at[CT_MOST_DENSE_STAGES]; // in the vectors of all stages, as doubles
    double a[CT_MOST_DENSE_STAGES];
};

// Functions over a run, such as extreme values; see integrate/take.h.
struct ct_lane_takes {
    size_t n;                       // 0: nothing
    struct ct_lane_program program; // (n)
    bool needs_accelerations, needs_lam;
    struct ct_take_scan *scan[CT_LANES]; // made by the first member
    struct ct_lane_sum stage[CT_MOST_DENSE_STAGES], correction[CT_DENSE_CORRECTIONS];
    vec *F,
        *dy; // corrections of the interpolant (ny x CT_DENSE_CORRECTIONS), a derivative (ny)
    double *one; // values of one lane  (n)
};

// A lane as user data of a problem: its root functions.
struct ct_lane_user {
    struct ct_batch *s;
    int lane;
};

// Events of one member. A step with a state event is repeated up to the estimated root until the
// root function vanishes there.
struct ct_lane_events {
    struct ct_run_options options;
    struct ct_arena *arena; // of the member's times
    double *time;           // of time events (ntime)
    size_t ntime;
    double pending; // the next of them; INFINITY
    struct ct_input_sampling input_sampling;
    struct ct_problem problem;
    struct ct_lane_user user;
    struct ct_event_location location;
    double *dy, *dend; // of the step in which a root is located (ny)
    double whole;      // its length; 0: no root is located
    double whole_end, error;
    double h;      // length of the next try
    int tries;     // of it
    bool is_event; // a state event ends this step
};

// Data of one member that is not computed in lanes.
struct ct_lane {
    enum ct_lane_state state;
    double t1; // end of the run
    struct ct_step_control control;
    double h;       // of this step as step control planned it
    double end;     // time at the end of this step
    double error;   // of it
    double longest; // step
    double scale;   // as in partition.h
    double *unit;
    bool has_units;
    double kappa_chosen, sigma_chosen, sigma_best;
    double pivot_last, pivot_time; // see predict_singular
    struct ct_strength strength;   // of its solver
    struct ct_output_error_record outputs[CT_OUTPUT_KINDS];
    int *row, *dependent, *independent; // as in partition.h
    struct ct_periodic_tolerance periodic;
    struct ct_tolerance
        tolerance; // before it is tightened for many periods (periodic_tolerance.h)
    double least_rtol;
    long steps;
    struct ct_lane_events events;
    bool is_watched; // stiffness detection is on
    int nstiff, nother;
};

struct ct_batch {
    const struct ct_equations *e;
    struct ct_run *run; // for computations of one lane at a time
    struct ct_evaluator *m;
    struct ct_partition *partition;
    struct ct_arena *arena;
    int nq, nu, nrow, ny, rank;
    bool is_solved, has_power, needs_lam, has_quaternion, is_used; // needs_lam: the power does
    int whose; // the lane whose parameters the run has; -1: unknown
    struct ct_lane_program motion, power, memory; // motion: u', q' themselves if is_solved
    struct ct_lane_outputs output[CT_OUTPUT_KINDS];
    struct ct_lane_takes take;
    struct ct_lane_program root; // of all switches
    struct ct_lane lane[W];
    struct ct_batch_counts count;
    const struct ct_method *method;
    struct ct_lane_sum *stage, error, third; // of the method
    const struct ct_groups *groups;          // of states, for the error
    vec *group_size;
    int *coordinate_of; // of the coordinate that a speed moves (nu); without quaternions
    // symbolic solvers; their orders of pivots are those of the file's own values
    struct ct_lane_solver **solver;
    size_t nsolver, solver_cap;
    double *origin;        // the evaluator's input there; NULL: there are no symbolic solvers
    bool solver_has_power; // in addition to the accelerations
    set needs_refinement;  // the last check found the solver not accurate enough
    set near_singular; // near a singular configuration: pivots are chosen at every evaluation,
    set alike;         // if strength and sigma are not known to fall alike
    vec low, high, strength; // of solvers: bounds of validity, and the present strength
    vec slope;               // sigma over strength where both fall alike, else 0
    vec kappa, sigma;        // as in partition.h
    vec pivot_most;          // the largest sigma so far
    vec t, h, joint;         // of this step: start, length, error of its states
    vec before;         // the last time of evaluation before the next event by time; INFINITY
    int nroot;          // switches of the state
    const int *root_of; // (nroot) their indices among the switches
    vec *side, *g0,
        // of them: see event_location.h, at the start and, extrapolated a little, at the end of the
        // step
        *g;
    vec *g_before;  // and a probe before that
    set unsettled;  // lanes in which a root function rests on zero or has just changed sign
    vec rtol, atol; // of the steps
    vec *input;
    // states (ny), stages (ny x stages), with those of the interpolant
    vec *start, *y, *dy, *y1, *dy1, *end, *dend, *point, *late, *weight, *k;
    double *one_y, *one_dy, *one_point, *one_end; // a single lane's states
};

// ---- sets of lanes ------------------------------------------------------------------------------

static const set ct_all_lanes = (1u << W) - 1;

// Lanes that cannot use their symbolic solvers now.
static inline set ct_batch_lanes_without_solver(const struct ct_batch *s)
{
    return s->needs_refinement | (s->near_singular & ~s->alike);
}

static inline bool ct_has_lane(set s, int l)
{
    return s >> l & 1;
}

// ---- programs -----------------------------------------------------------------------------------

static inline void ct_lane_run(struct ct_lane_program *p, const vec *input)
{
    if (p->nout && p->native)
        ct_native_eval(p->native, (const double *)input, (double *)p->out, p->work);
    else if (p->nout)
        ct_tape_eval_lanes(p->tape, W, (const double *)input, (double *)p->out, p->work);
}

// ---- batch.c ------------------------------------------------------------------------------------

/// Copy numbers (n) of a lane out of vectors, or into them.
void ct_lane_take(double *out, const vec *v, int lane, size_t n);
void ct_lane_put(vec *v, int lane, const double *in, size_t n);
/// Copies the run's choice of rows and columns to the lane and selects its solver. False if there
/// is none.
bool ct_lane_choose(struct ct_batch *s, int lane);
/// Limits the next step of the lane, whose state the run has at t, y, so that followed angles stay
/// within half a turn.
void ct_lane_limit_turn(struct ct_batch *s, int lane, double t, const double *y);

// ---- batch_event.c ------------------------------------------------------------------------------

/// Allocates the data of events of all lanes.
void ct_lane_make_events(struct ct_batch *s);
/// Sets the sides of switches of this lane, with whose member and options the run was started.
/// False: the motion cannot begin.
bool ct_lane_begin_events(struct ct_batch *s, int lane, const struct ct_run_options *o);
/// At t, y, where a member begins or an event has put it. False: roots cannot be evaluated.
bool ct_lane_reinitialize(struct ct_batch *s, int lane, double t, const double *y,
                          const double *dy);
/// Plans the time at which steps must end next.
double ct_lane_stop(const struct ct_lane *lane);
/// A step with an event in it.
void ct_lane_plan_again(struct ct_batch *s, int lane);
/// The step ends in s->end at lane->end. It is accepted (with an event at its end if
/// events.is_event), rejected, or repeated up to an event.
enum ct_lane_found {
    CT_LANE_GOES_ON,
    CT_LANE_REFUSED,
    CT_LANE_AGAIN
} ct_lane_search(struct ct_batch *s, int lane);
/// Handles the event at t, y, the end of an accepted step, if there is one. The lane may be given
/// up.
void ct_lane_pass(struct ct_batch *s, int lane);

// ---- batch_single.c -----------------------------------------------------------------------------

/// Copies parameters, memories, choices and the state y at t of a lane to the run, for evaluation
/// by matrices, or completely.
void ct_lane_load_run_whole(struct ct_batch *s, int lane, double t, const vec *y);
void ct_lane_load_run(struct ct_batch *s, int lane, double t, const vec *y);
/// dy by matrices at (t, y), the power if solvers have it, and kappa and sigma. False if it cannot
/// be computed.
bool ct_lane_solve(struct ct_batch *s, int lane, double t, const vec *y, vec *dy);
/// Projects y of the lane onto the constraints at t by matrices; may give the lane up.
bool ct_lane_project(struct ct_batch *s, int lane, double t, vec *y);
/// Chooses rows and columns anew at (t, y).
void ct_lane_renew(struct ct_batch *s, int lane, double t, const vec *y);
/// ct_partition_pivot at (t, y).
double ct_lane_pivot(struct ct_batch *s, int lane, double t, const vec *y);
/// Multipliers at (t, y) into the input, u' as in dy.
void ct_lane_multipliers(struct ct_batch *s, int lane, double t, const vec *y, const vec *dy);
/// Which outputs of this kind do constraints determine, at the end of the step as it was tried?
void ct_lane_find_constrained_outputs(struct ct_batch *s, enum ct_output_kind kind, int lane,
                                      const struct ct_tolerance *tolerance);
/// Angles and rotations that are followed may turn by so much in a step [rad], else the member runs
/// alone, where steps are held back: less than a fifth of a turn, as the step that follows may be
/// five times as long.
static const double ct_lane_most_turn = 1;
/// Records the strength of the lane's solver together with its sigma, which was just computed by
/// matrices.
void ct_lane_compare(struct ct_batch *s, int lane);
void ct_lane_give_up(struct ct_batch *s, int lane);

#endif
