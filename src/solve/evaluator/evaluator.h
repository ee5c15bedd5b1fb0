// The evaluator computes numbers from the symbolic equations of motion: compiled programs, their
// common input vector, and workspace for one run.
//
//     input   t | parameters | q | u | u' | lam | sides of switches | memories | work
//
// What always holds: an evaluator belongs to one run; the equations it was made from are constant.
// Evaluation allocates nothing. M is kept full (both triangles), J by rows (nrow x nu),
// column-major.
#ifndef CT_SOLVE_EVALUATOR_EVALUATOR_H
#define CT_SOLVE_EVALUATOR_EVALUATOR_H

#include "codegen/native.h"
#include "component/model.h"
#include "expr/tape.h"
#include "formulate/equations.h"
#include "numeric/sparse_pivots.h"

/// Which form of the programs is run. All give the same bits, but for the accelerations in closed
/// form of larger systems: native code fuses their products and sums, which rounds less often.
enum ct_backend {
    CT_BACKEND_BEST, // native code where it is available
    CT_BACKEND_TAPE,
    CT_BACKEND_NATIVE,
};

/// A row is dependent if the part of it that is left after elimination, relative to its natural
/// size (6.5a), is below this; a row whose residual is below this is met. Round-off of sums of some
/// hundred terms, at positions closed to 1e-13, is below 1e-12.
// Derived: between both, three digits from either.
static const double ct_rank_tolerance = 1e-9;
/// The same for data with six digits, which err by 5e-6 of their size at most; a row adds up a few
/// of them. If loops close to that accuracy only, a row with less left than this counts as
/// dependent, provided that it stays so along the motion.
// Derived: six times 5e-6.
static const double ct_data_tolerance = 3e-5;

/// Limit: of so many constraint rows on, J is treated as sparse: dense factors cost more than a
/// step does.
enum { CT_LARGE_SYSTEM = 200 };

struct ct_evaluator {
    const struct ct_equations *e;
    const struct ct_model *model;
    struct ct_arena *arena; // that it lives in
    size_t nq, nu, nrow;

    double *input;
    size_t at_q, at_u, at_a, at_lam, at_switch, at_memory, at_work, ninput;

    struct ct_program { // with its outputs
        const struct ct_listing *listing;
        struct ct_native *native; // NULL: the tape is run
        struct ct_tape *tape;     // NULL until it is needed
        double *out, *work;
        size_t nout;
        struct ct_program *next; // of those added later
    } solved,       // u', q', pivots, where the equations have a solution; else empty
        motion,     // M, Q, J, gam, q'
        constraint, // phi, v, J
        result,     // output columns
        power,      // d(work)/dt
        validity,   // indicators of linear beams, then squared slopes of all beams
        // of linear beams whose error is estimated: how the base moves (9), the beam's end (2)
        base_motion,
        beam_mode_state, // of the same: x, x' by shape
        energy,          // kinetic, potential
        root,            // g of each switch
        time_functions,  // functions of time alone
        memory,          // next values; of whole turns their present ones
        whole_turns,     // of those: at a start, from the stored angles
        momentum,        // dT/du, and the gradient of `continuity` where there is any
        driver,          // value, rate of each driver
        assembly_sign,   // of each row: not negative in the right assembly
        residual, // r, phi, v; nothing if the equations have no residual, and so the next
        // dr/dq, dr/du, dr/du', dv/dq, J: the entries; J alone where the rest is found along
        // directions
        tangent;
    struct ct_tangent_lanes *lanes; // the derivatives along directions, or NULL
    double *
        // of the last ct_evaluator_tangent: dr/dq, dr/du, dr/du', dr/dk, dv/dq, J, as the residual
        // lists them
        slopes;
    double *auxiliary; // workspace (inner values x nu)
    size_t nslope;

    double *M, *Q, *J, *gam, *rate; // of the last ct_evaluator_dynamics
    double *phi, *v;                // of the last ct_evaluator_constraint (J as well)
    double *row_size, *speed_size;  // of the last ct_evaluator_measure_rows; 1 before
    double rank_tolerance;          // a row with less left, relative to its size, is dependent
    // Data close to their tolerance only: rows keep their gap at the start, phi - open = 0; rows
    // that are left out, since they depend on others to that tolerance, read 0.
    bool is_inexact, *left_out; // (nrow)
    size_t most_rank;           // of J; nrow where data are exact
    double *open;               // (nrow)
    double *symbol_value;       // workspace of it, by symbol of e->x
    double *g[2];               // values of root functions, for switches (nswitch)
    // (nswitch) > 0: g rests on zero, and counts as zero up to this times ct_switches_size
    double *at_rest;
    bool has_rest;                  // one did when the sides were set
    double *turned, *ahead, *moved; // for ct_memory_angle_rate (nmemory, nq + nu + 1, nu)
    long evaluations;
    struct ct_program *added; // ct_evaluator_add_program
    enum ct_backend requested_backend;
    const char *backend; // of what steps evaluate: "native" or "tape"
};

/// Compile all that the equations hold, what steps evaluate (motion, constraint, residual, tangent)
/// to native code where it is available. Everything lives in a.
struct ct_evaluator *ct_evaluator_create(struct ct_arena *a, const struct ct_model *model,
                                         const struct ct_equations *e);

/// Adds the programs of a residual that was derived later. a must be the evaluator's arena.
void ct_evaluator_add_residual(struct ct_arena *a, struct ct_evaluator *m);

/// Switches to another back end. False if native code is asked for and is not available; the tape
/// is run then. Not for the inner loop. a must be the evaluator's arena.
bool ct_evaluator_use(struct ct_arena *a, struct ct_evaluator *m, enum ct_backend backend);

/// Index of a symbol's value in the input; seeds come behind it. False for trial symbols and
/// signals, which do not occur in the equations.
bool ct_evaluator_slot(const struct ct_evaluator *m, const struct ct_sym *s, size_t *slot);
/// Listing of n expressions of x, a copy of the equations' store that may have grown, on the
/// evaluator's input.
const struct ct_listing *ct_evaluator_list(struct ct_arena *a, const struct ct_evaluator *m,
                                           const struct ct_exs *x, const ct_ex *out, size_t n);
/// A further program on the evaluator's input: out (n) from x, a copy of the equations' store that
/// may have grown. `use` and `prepare` include it until it is removed; a and x must live as long.
void ct_evaluator_add_program(struct ct_arena *a, struct ct_evaluator *m,
                              const struct ct_exs *x, const ct_ex *out, size_t n,
                              struct ct_program *p);
/// The same of a solution in closed form: native code fuses its products and sums.
void ct_evaluator_add_solution(struct ct_arena *a, struct ct_evaluator *m,
                               const struct ct_exs *x, const ct_ex *out, size_t n,
                               struct ct_program *p);
void ct_evaluator_remove_program(struct ct_evaluator *m, const struct ct_program *p);

/// The input by symbol of x (nsym), for ct_ex_value and ct_ex_jacobian_at; NaN for those that are
/// no inputs.
void ct_evaluator_values(const struct ct_evaluator *m, const struct ct_exs *x, double *value);
/// out (n) = v, copied one by one: a wider read would wait for numbers that have just been written
/// one by one.
static inline void ct_evaluator_copy(double *out, const volatile double *v, size_t n)
{
    size_t i = 0;
    for (; i + 4 <= n; i += 4) {
        const double one = v[i], two = v[i + 1], three = v[i + 2], four = v[i + 3];
        out[i] = one;
        out[i + 1] = two;
        out[i + 2] = three;
        out[i + 3] = four;
    }
    for (; i < n; i++)
        out[i] = v[i];
}

/// Copy time and state into the input. y: q, u, work.
void ct_evaluator_set(struct ct_evaluator *m, double t, const double *y);
/// M, Q, J, gam and q' at the input. Without dynamics in the equations M and Q are zero.
void ct_evaluator_dynamics(struct ct_evaluator *m);
/// u' (nu, out) and q' at the input where the equations have a solution; else false. M, Q stay as
/// they were.
bool ct_evaluator_solved(struct ct_evaluator *m, double *a);
/// phi, v, J at the input.
void ct_evaluator_constraint(struct ct_evaluator *m);
/// Natural sizes of rows and speeds at the input, which ranks are judged against.  (6.5a)
void ct_evaluator_measure_rows(struct ct_evaluator *m);
/// Declares that data close to their tolerance only; the input is the start, with so many freedoms
/// of joints on any trees.
void ct_evaluator_set_inexact(struct ct_evaluator *m, size_t freedoms);
/// Of such data: leaves out the rows behind the first `rank` of row (nrow).
void ct_evaluator_leave_out(struct ct_evaluator *m, const int *row, int rank);
/// Rank of J (nrow x nu): rows of which more than `least` is left against their sizes. row (nrow,
/// out): the independent ones first. A (nu x nrow), tau (nrow), work (ct_qr_pivot_work(nu, nrow)):
/// workspace.
int ct_evaluator_order_rows(const struct ct_evaluator *m, const double *J, double least,
                            int *row, double *A, double *tau, double *work);
/// Entries of J, each times scale_row of its row and scale_column of its column (NULL: 1). In
/// scratch.
struct ct_sparse_entries ct_evaluator_sparse_J(const struct ct_evaluator *m,
                                               struct ct_arena *scratch, const double *J,
                                               const double *scale_row,
                                               const double *scale_column);
/// Derivatives of the residual at the input, into slopes.
void ct_evaluator_tangent(struct ct_evaluator *m);
/// K, C, M (nu x nu, out) from the slopes, with auxiliary unknowns eliminated; returns the values
/// of dv. (8.19)
const double *ct_evaluator_scatter(const struct ct_evaluator *m, double *K, double *C,
                                   double *M);
/// Operations of an evaluation of the tangent; those in lanes count for one lane.
double ct_evaluator_tangent_operations(const struct ct_evaluator *m);
void ct_program_run(struct ct_program *p, const double *input);
/// Bytes of machine code of all programs.
size_t ct_evaluator_code_size(struct ct_evaluator *m);
/// Parameters have changed: run the prologues again.
void ct_evaluator_prepare(struct ct_evaluator *m);
/// Runs the prologues of motion, constraint and power only, as ct_evaluator_dynamics and
/// ct_evaluator_constraint need them.
void ct_evaluator_prepare_dynamics(struct ct_evaluator *m);
/// Resets the evaluator, with the present values of the model's parameters.
void ct_evaluator_reset(struct ct_evaluator *m);

/// q (+) d for a small motion d (nu) in the speeds; quaternions are composed and normalised.  (7.4)
void ct_evaluator_retract(const struct ct_evaluator *m, double *q, const double *d);
/// rate (nu, out) = d' when q (+) d moves at speeds w: T^-1(d) w for rotations.  (7.3)
void ct_evaluator_chart_rate(const struct ct_evaluator *m, const double *d, const double *w,
                             double *rate);
/// Normalise the quaternions of q.
void ct_evaluator_normalise(const struct ct_evaluator *m, double *q);
/// p (4) / |p|; zeros stay.
void ct_quaternion_normalise(double *p);

/// Initialises memories at the input: quaternions from their rotation (scalar part >= 0), angles
/// near their present memory, offsets with their present values.
void ct_memory_start(struct ct_evaluator *m);
/// p [w x y z], w >= 0 (out): unit quaternion of a rotation R (3 x 3, column-major), the largest of
/// the four numbers found first.
void ct_quaternion_of(const double *R, double *p);
/// Updates memories after a step; offsets stay. Correct if angles and rotations have turned by less
/// than half a turn.
void ct_memory_update(struct ct_evaluator *m);
/// Are there angles or rotations that are computed from their last values?
bool ct_memory_limits(const struct ct_equations *e);
/// The largest rate of those angles at t, y [rad/s], from a difference over dt; 0 if there are
/// none.
double ct_memory_angle_rate(struct ct_evaluator *m, double t, const double *y, double dt);

#endif
