// What the files of lanes share: numbers of all lanes at once, and the lanes themselves. See
// batch.h.
//
//     batch.c        members come and go
//     batch_step.c    a try in all lanes: stages, error, projection, step control
//     batch_solver.h    of that, closed forms and the projection by them
//     batch_take.h    what is taken over steps
//     batch_event.c   events of one lane: where they are, what they change; batch_event_location.h: is there one in any?
//     batch_single.c   one lane as a run alone: what is rare, by the run's own functions
#ifndef CT_SOLVE_BATCH_BATCH_INTERNAL_H
#define CT_SOLVE_BATCH_BATCH_INTERNAL_H

#include "integrate/step_control.h"
#include "integrate/periodic_tolerance.h"
#include "integrate/event_location.h"
#include "solve/evaluator/input_sampling.h"
#include "solve/output_error/output_error.h"
#include "solve/batch/batch.h"

enum { W = CT_LANES };

// One number of each lane; arenas align to 16 bytes only.
typedef double vec __attribute__((vector_size(W * sizeof(double)), aligned(8), may_alias));
// Bits of such: all or none where something holds.
typedef long long mask __attribute__((vector_size(W * sizeof(long long)), may_alias));
// Some of the lanes: bit l is lane l.
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
    double *one_at, *one_probed, *one_off; // of a single lane
};

// A closed form for one choice of rows and columns, and the lanes that have made it.
struct ct_lane_solver {
    struct ct_solver *solver;
    struct ct_solver_code code;
    struct ct_lane_program solved, checked, closing;
    set lanes;
};

// The stages of a method without the zeros of its table: sum over i of a[i] k[at[i]].
struct ct_lane_sum {
    int n;
    size_t at[CT_MOST_DENSE_STAGES]; // in the vectors of all stages, as doubles
    double a[CT_MOST_DENSE_STAGES];
};

// What is taken over runs, by the functions that are its outputs; see integrate/take.h.
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

// A lane as the user of a problem: its root functions.
struct ct_lane_user {
    struct ct_batch *s;
    int lane;
};

// Events of one member. A step with a state event is taken again, to where the root function should
// vanish, until it does.
struct ct_lane_events {
    struct ct_run_options options;
    struct ct_arena *arena; // of the member's times
    double *time;           // of events by time alone  (ntime)
    size_t ntime;
    double pending; // the next of them; INFINITY
    struct ct_input_sampling input_sampling;
    struct ct_problem problem;
    struct ct_lane_user user;
    struct ct_event_location location;
    double *dy, *dend; // of the step that is searched  (ny)
    double whole;      // its length; 0: none is searched
    double whole_end, error;
    double h;      // of the next try
    int tries;     // of it
    bool is_event; // a state event ends this try
};

// What belongs to one member and is not computed in lanes.
struct ct_lane {
    enum ct_lane_state state;
    double t1; // end of the run
    struct ct_step_control control;
    double h;       // of this try as step control has planned it
    double end;     // time at the end of this try
    double error;   // of it
    double longest; // step
    double scale;   // as in partition.h
    double *unit;
    bool has_units;
    double kappa_chosen, sigma_chosen, sigma_best;
    double pivot_last, pivot_time; // see foresee_singular
    struct ct_strength strength;   // of its form
    struct ct_output_error_record outputs[CT_OUTPUT_KINDS];
    int *row, *dependent, *independent; // as in partition.h
    struct ct_periodic_tolerance periodic;
    struct ct_tolerance tolerance; // before repeats count
    double least_rtol;
    long steps;
    struct ct_lane_events events;
    bool is_watched; // for stiffness
    int nstiff, nother;
};

struct ct_batch {
    const struct ct_equations *e;
    struct ct_run *run; // for what is done one by one
    struct ct_evaluator *m;
    struct ct_partition *partition;
    struct ct_arena *arena;
    int nq, nu, nrow, ny, rank;
    bool is_solved, has_power, needs_lam, has_quaternion, is_used; // needs_lam: the power does
    int whose; // the lane whose parameters the run has for matrices; -1: not known
    struct ct_lane_program motion, power, memory; // motion: u', q' themselves if is_solved
    struct ct_lane_outputs output[CT_OUTPUT_KINDS];
    struct ct_lane_takes take;
    struct ct_lane_program root; // of all modes
    struct ct_lane lane[W];
    struct ct_batch_counts count;
    const struct ct_method *method;
    struct ct_lane_sum *stage, error, third; // of the method
    const struct ct_groups *groups;          // of states, for the error
    vec *group_size;
    int *coordinate_of; // of the coordinate that a speed moves (nu); without quaternions
    // closed forms: their orders of pivots are those of the file's own values
    struct ct_lane_solver **solver;
    size_t nsolver, solver_cap;
    double *origin;        // the evaluator's input there; NULL: there are no forms
    bool solver_has_power; // beside the accelerations
    set needs_refinement;  // the last check found the form not good enough
    set near_singular; // near a singular configuration: pivots are sought at every evaluation,
    set alike;         // if strength and sigma are not known to fall alike
    vec low, high, strength; // of the forms: sound between, and now
    vec slope;               // sigma for their strength where both fall alike, else 0
    vec kappa, sigma;        // as in partition.h
    vec pivot_most;          // the largest sigma so far
    vec t, h, joint;         // of this try: from, how far, the error of its states
    vec before;         // the last time of evaluation before the next event by time; INFINITY
    int nroot;          // state modes
    const int *root_of; // (nroot) their places among the modes
    vec *side, *g0,
        // of them: see event_location.h, at the start and, extrapolated a little, at the end of the
        // step
        *g;
    vec *g_before;  // and a probe before that
    set unsettled;  // lanes in which one rests on zero or has just fired
    vec rtol, atol; // of the steps
    vec *input;
    // states (ny), stages (ny x stages), with those of the interpolant
    vec *start, *y, *dy, *y1, *dy1, *end, *dend, *point, *late, *weight, *k;
    double *one_y, *one_dy, *one_point, *one_end; // a single lane's states
};

// ---- sets of lanes ------------------------------------------------------------------------------

static const set ct_all_lanes = (1u << W) - 1;

// Lanes that cannot use their forms now.
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

/// Take numbers (n) of a lane out of vectors, or put them there.
void ct_lane_take(double *out, const vec *v, int lane, size_t n);
void ct_lane_put(vec *v, int lane, const double *in, size_t n);
/// The lane takes the choice of rows and columns that the run has now, and the form for it. False
/// if there is none.
bool ct_lane_choose(struct ct_batch *s, int lane);
/// The next step of the lane, which the run has become at t, y, follows what turns.
void ct_lane_limit_turn(struct ct_batch *s, int lane, double t, const double *y);

// ---- batch_event.c ------------------------------------------------------------------------------

/// Room for the events of all lanes.
void ct_lane_make_events(struct ct_batch *s);
/// The run has been started with the member of this lane, which has these options: the sides it is
/// on. False: the motion cannot begin.
bool ct_lane_begin_events(struct ct_batch *s, int lane, const struct ct_run_options *o);
/// At t, y, where a member begins or an event has put it. False: roots cannot be evaluated.
bool ct_lane_take_bearings(struct ct_batch *s, int lane, double t, const double *y,
                           const double *dy);
/// Where steps must end next.
double ct_lane_stop(const struct ct_lane *lane);
/// A try of a step that has an event in it.
void ct_lane_plan_again(struct ct_batch *s, int lane);
/// The try ends in s->end at lane->end. It may be accepted, then with an event at its end if
/// events.is_event; it is refused; or it is taken again, to an event.
enum ct_lane_found {
    CT_LANE_GOES_ON,
    CT_LANE_REFUSED,
    CT_LANE_AGAIN
} ct_lane_search(struct ct_batch *s, int lane);
/// The lane has come to t, y, which ends the try: what the event there changes, if there is one. It
/// may be given up.
void ct_lane_pass(struct ct_batch *s, int lane);

// ---- batch_single.c -----------------------------------------------------------------------------

/// The run gets parameters, memories and choices of a lane, and its state y at t; for matrices, or
/// for everything.
void ct_lane_load_run_whole(struct ct_batch *s, int lane, double t, const vec *y);
void ct_lane_load_run(struct ct_batch *s, int lane, double t, const vec *y);
/// dy by matrices at (t, y), the power if forms have it, and what they say of kappa and sigma.
/// False: not there.
bool ct_lane_solve(struct ct_batch *s, int lane, double t, const vec *y, vec *dy);
/// The lane of y onto the constraints at t by matrices; may give it up.
bool ct_lane_project(struct ct_batch *s, int lane, double t, vec *y);
/// Rows and columns anew at (t, y).
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
/// The strength of the lane's form belongs to its sigma, found by matrices just now.
void ct_lane_compare(struct ct_batch *s, int lane);
void ct_lane_give_up(struct ct_batch *s, int lane);

#endif
