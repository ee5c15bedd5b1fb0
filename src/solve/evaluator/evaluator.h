// The evaluator computes numbers from the symbolic equations of motion: compiled programs, their
// common input vector, and workspace for one run.
//
//     input   t | parameters | q | u | u' | lam | sides of switches | memories | work
//
// What always holds: an evaluator belongs to one run; the equations it was made from are constant.
// Evaluation allocates nothing. M is kept by its entries, J full (nrow x nu), column-major.
#ifndef CT_SOLVE_EVALUATOR_EVALUATOR_H
#define CT_SOLVE_EVALUATOR_EVALUATOR_H

#include "codegen/native.h"
#include "component/model.h"
#include "expr/tape.h"
#include "formulate/equations.h"
#include "numeric/sparse_pivots.h"

/// Form of the programs. All give the same bits, except for accelerations in closed form of
/// larger systems: native code fuses their products and sums, which rounds less often.
enum ct_backend {
    CT_BACKEND_BEST, // native code where it is available
    CT_BACKEND_TAPE,
    CT_BACKEND_NATIVE,
};

/// A row is dependent if its remainder after elimination, relative to its natural size (6.5a),
/// is below this; a constraint is satisfied if its residual is below this. Round-off of sums of
/// some hundred terms, at positions closed to 1e-13, is below 1e-12.
// Derived: a factor 1000 above that round-off and below 1e-6, the errors of data with six digits.
static const double ct_rank_tolerance = 1e-9;
/// The same for data with six digits, which have relative errors up to 5e-6; a row adds
/// several. If loops close only to that accuracy, a row with a smaller remainder counts as
/// dependent, provided that this holds along the motion.
// Derived: six times 5e-6.
static const double ct_data_tolerance = 3e-5;

/// Limit: number of constraint rows from which J is treated as sparse: dense factors then cost
/// more than a step.
enum { CT_LARGE_SYSTEM = 200 };

struct ct_evaluator {
    const struct ct_equations *e;
    const struct ct_model *model;
    struct ct_arena *arena; // its memory
    size_t nq, nu, nrow;

    double *input;
    size_t at_q, at_u, at_a, at_lam, at_switch, at_memory, at_work, ninput;

    struct ct_program { // compiled program with its outputs
        const struct ct_listing *listing;
        struct ct_native *native; // NULL: the tape is run
        struct ct_tape *tape;     // NULL until used
        double *out, *work;
        size_t nout;
        struct ct_program *next; // list of added programs
    } solved,       // u', q', pivots, if the equations have a closed-form solution; else empty
        motion,     // M, Q, J, gam, q'
        constraint, // phi, v, J
        result,     // output columns
        power,      // d(work)/dt
        validity,   // indicators of linear beams, then squared slopes of all beams
        // of linear beams with an error estimate: motion of the base (9), deflection of the end
        // (2)
        base_motion,
        beam_mode_state, // of the same: x, x' by shape
        energy,          // kinetic, potential
        root,            // g of each switch
        time_functions,  // functions of time alone
        memory,          // next values; of whole turns the present ones
        whole_turns,     // initial whole turns, from the stored angles
        momentum,        // dT/du, and the gradient of `continuity` where there is any
        driver,          // value, rate of each driver
        assembly_sign,   // of each row: not negative in the correct assembly mode
        residual,        // r, phi, v; like the next one empty if the equations have no residual
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

    double *M, *Q, *J, *gam, *rate; // of the last ct_evaluator_dynamics; M as e->M lists it
    int *mass_row;                  // (nu + 1) first entry of each row of M, its lower triangle
    double *phi, *v;                // of the last ct_evaluator_constraint (J as well)
    double *row_size, *speed_size;  // of the last ct_evaluator_measure_rows; 1 before
    double rank_tolerance;          // a row with a smaller relative remainder is dependent
    // If loops close only to the tolerance of the data: rows keep their initial residual `open`,
    // phi - open = 0; rows that depend on others to that tolerance are left out and are 0.
    bool is_inexact, *left_out; // (nrow)
    size_t most_rank;           // of J; nrow if the data are exact
    double *open;               // (nrow)
    double *symbol_value;       // workspace, by symbol of e->x
    double *g[2];               // values of root functions, for switches (nswitch)
    // (nswitch) positive if g and its rate are zero; g then counts as zero up to this times
    // ct_switches_size
    double *at_rest;
    bool has_rest;                  // some at_rest was positive when the sides were set
    double *turned, *ahead, *moved; // for ct_memory_angle_rate (nmemory, nq + nu + 1, nu)
    long evaluations;
    struct ct_program *added; // ct_evaluator_add_program
    enum ct_backend requested_backend;
    const char *backend; // of the programs of steps: "native" or "tape"
};

/// Compile all programs; those of steps (motion, constraint, residual, tangent) to native code
/// if available. Everything lives in a.
struct ct_evaluator *ct_evaluator_create(struct ct_arena *a, const struct ct_model *model,
                                         const struct ct_equations *e);

/// Adds the programs of a residual that was derived later. a must be the evaluator's arena.
void ct_evaluator_add_residual(struct ct_arena *a, struct ct_evaluator *m);

/// Switches to another back end. False if native code is requested and not available; then the
/// tape is used. Not for the inner loop. a must be the evaluator's arena.
bool ct_evaluator_use(struct ct_arena *a, struct ct_evaluator *m, enum ct_backend backend);

/// Index of a symbol's value in the input; seeds follow after it. False for trial symbols and
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

/// Values of the symbols of x (nsym), for ct_ex_value and ct_ex_jacobian_at; NaN for symbols
/// that are no inputs.
void ct_evaluator_values(const struct ct_evaluator *m, const struct ct_exs *x, double *value);
/// out (n) = v, copied one by one: a wider load would wait for preceding narrow stores.
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
/// M_kk of the last ct_evaluator_dynamics.
static inline double ct_evaluator_inertia(const struct ct_evaluator *m, size_t k)
{
    const int last = m->mass_row[k + 1] - 1;
    return last >= m->mass_row[k] && m->e->M[last].column == (int)k ? m->M[last] : 0;
}
/// Full M of the first n speeds: both triangles of M (n x n, in: zeros or an earlier M, out).
void ct_evaluator_fill_mass(const struct ct_evaluator *m, double *M, size_t n);
/// u' (nu, out) and q' at the input by the closed-form solution; false if there is none. M, Q
/// do not change.
bool ct_evaluator_solved(struct ct_evaluator *m, double *a);
/// phi, v, J at the input.
void ct_evaluator_constraint(struct ct_evaluator *m);
/// Natural sizes of rows and speeds at the input, for rank tests.  (6.5a)
void ct_evaluator_measure_rows(struct ct_evaluator *m);
/// Declares that loops close only to the tolerance of the data; the input is the initial state,
/// with this number of freedoms of joints on any trees.
void ct_evaluator_set_inexact(struct ct_evaluator *m, size_t freedoms);
/// For such data: leaves out all rows after the first `rank` of row (nrow).
void ct_evaluator_leave_out(struct ct_evaluator *m, const int *row, int rank);
/// Rank of J (nrow x nu): number of rows with a relative remainder above `least`. row (nrow,
/// out): the independent ones first. A (nu x nrow), tau (nrow), work (ct_qr_pivot_work(nu,
/// nrow)): workspace.
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
/// p (4) / |p|; zeros do not change.
void ct_quaternion_normalise(double *p);

/// Initialises memories at the input: quaternions from their rotation (scalar part >= 0), angles
/// near their present memory, offsets with their present values.
void ct_memory_start(struct ct_evaluator *m);
/// p [w x y z], w >= 0 (out): unit quaternion of a rotation R (3 x 3, column-major), the largest of
/// the four numbers found first.
void ct_quaternion_of(const double *R, double *p);
/// Updates memories after a step, except offsets. Correct if angles and rotations have changed
/// by less than half a turn.
void ct_memory_update(struct ct_evaluator *m);
/// Are there continuous angles or rotations, computed from their last values?
bool ct_memory_limits(const struct ct_equations *e);
/// The largest rate of those angles at t, y [rad/s], from a difference over dt; 0 if there are
/// none.
double ct_memory_angle_rate(struct ct_evaluator *m, double t, const double *y, double dt);

#endif
