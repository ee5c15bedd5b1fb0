// The reduced equations of motion as expressions: what formulate hands on.
//
//     q' = Z(q) u
//     M(q, t) u' = Q(q, u, t) + J(q, t)' lam        n_u rows
//     z' = rate(q, u, z, t)                         the model's states
//     Phi(q, t) = 0,  v = J u + Phi_t = 0,  J u' + gam = 0     m rows          (formulation 0.4)
//
// States of the model are the last of the speeds u: they move no coordinate, their mass is 1, Q is their rate and J is
// zero, so that all that solves M u' = Q + J' lam solves them, too.
//
// What always holds: M holds its lower triangle, J its nonzeros, both in row order; all expressions
// live in x and use symbols of kind TIME, PARAM, Q, U, A, LAM, MODE, MEMORY, WORK only. A and LAM occur
// in outputs and in the power alone.
#ifndef CT_FORMULATE_EQUATIONS_H
#define CT_FORMULATE_EQUATIONS_H

#include "component/model.h"
#include "formulate/bending_mode.h"
#include "graph/graph.h"

/// A stored coordinate.
struct ct_q {
    const char *name;
    ct_ex symbol;
    ct_ex rate;     // in terms of u
    int quaternion; // -1, or which of the four numbers of a quaternion this is
};

/// What elastic coordinates of a beam are: along its axis, across, rotations of sections; shares of modes.
enum ct_elastic_kind {
    CT_ELASTIC_ALONG,
    CT_ELASTIC_ACROSS,
    CT_ELASTIC_TURN,
    CT_ELASTIC_MODE,
};

struct ct_u {
    const char *name; // "crank.u"
    ct_ex symbol;     // speed
    ct_ex derivative; // the symbol u'
    int q;            // the coordinate whose rate it is; -1: angular velocities, states
    int joint, body;  // whose it is; the other is -1
    int beam;         // body whose elastic coordinate it belongs to; 0: none
    enum ct_elastic_kind kind; // of those
    bool is_rotation;          // [rad/s]
};

struct ct_entry { // of a sparse matrix
    int row, column;
    ct_ex value;
};

/// A constraint row and the wrench pair its multiplier stands for: force lam p, torque lam h on the head.
struct ct_row {
    const char *name;  // "pin2: y", "gear"
    int joint;         // in the model; -1: none
    ct_ex phi, v, gam; // position, velocity J u + Phi_t, acceleration J u' + gam
    ct_ex lam;         // symbol
    ct_ex
        assembly_sign; // >= 0 in the right assembly (half-turn solutions of (4.4)); 0 where none
    bool is_length;    // of phi [m]
    const ct_ex3 *lever; // [m] vectors along the row's path that its speeds turn  (nlever)
    size_t nlever;
};

/// A comparison whose outcome is held between events.
struct ct_switch {
    ct_ex symbol;
    enum ct_op op; // LT, LE, GT, GE
    ct_ex g;       // the symbol is 1 where g op 0
    bool is_time;  // g depends on t alone
    ct_ex written; // g with the signals that the model names
    struct ct_mark mark;
};

/// A value kept from the last accepted step: update gives the next one.
struct ct_memory {
    ct_ex symbol, update;
    // ANGLE follows an angle; QUATERNION (four in a row) a rotation; OFFSET keeps its value at the start, and so does
    // TURNS, the whole turns of an angle, found before the others
    enum ct_memory_kind {
        CT_MEMORY_ANGLE,
        CT_MEMORY_QUATERNION,
        CT_MEMORY_OFFSET,
        CT_MEMORY_TURNS
    } kind;
    ct_ex33 R;        // QUATERNION, first of four: the rotation itself
    int joint, index; // ANGLE: the coordinate, to start from a given value; joint -1: none
    bool is_sum;      // ANGLE: a sum of angles and whole turns, found without its last value
};

/// Does it change from step to step?
static inline bool ct_memory_is_updated(const struct ct_memory *m)
{
    return m->kind == CT_MEMORY_ANGLE || m->kind == CT_MEMORY_QUATERNION;
}

/// Is it found from its last value, so that it must not turn far in a step?
static inline bool ct_memory_limits_steps(const struct ct_memory *m)
{
    return ct_memory_is_updated(m) && !m->is_sum;
}

struct ct_result {
    const char *name; // column
    ct_ex value;
    bool undetermined; // a reaction out of the plane that a planar model leaves open
};

/// A driven coordinate: known branch coordinate with its value, rate and acceleration.
struct ct_driver {
    const char *name;
    int joint, index;
    struct ct_mark mark;
    ct_ex value, rate, acceleration; // functions of t (and of modes)
    ct_ex effort;                    // generalised force the driver gives [N or N m]
};

/// The equations as implicit methods solve them, and the derivatives their iteration needs. Positions are
/// varied along the retraction, so that an entry's direction is a speed's index.  (formulation 5.2, 8.2)
///
/// Where there are inner values k (nodes below r, each of them of earlier ones), slopes of r are those with k held, and rows nu + i are
/// those of k_i: with the strict triangle of dk/dk, dr = r_q dq + r_k (1 - k_k)^-1 k_q dq.  (8.19)
struct ct_residual {
    ct_ex *r;                           // M u' - Q - J' lam  (nu)
    bool has_slopes;                    // those below are derived
    ct_ex *auxiliary;                   // k (ninner)
    struct ct_slope *dq, *du, *da, *dk; // of r and k by q, u, u', k
    struct ct_slope *dv;                // of the rows' v by q
    size_t nauxiliary, ndq, ndu, nda, ndk, ndv;
    struct ct_directional
        *along; // NULL: the slopes have values as expressions; else their places only
};

/// Derivatives along a motion (places, speeds, u': nu numbers each, and inner values), from which slopes are read colour by colour.
struct ct_directional {
    ct_ex *seed;      // symbols of these numbers (nseed)
    ct_ex *rate;      // of r (nu) and inner values, and of v (nrow) along the places
    uint32_t *colour; // by seed: those of one colour share no row
    size_t nseed;
    uint32_t ncolour;
};

/// Results beside the outputs of the model.
enum ct_more_outputs {
    CT_MORE_NONE,
    CT_MORE_COORDINATES, // if the model lists no outputs: coordinates, speeds, accelerations of all joints
    CT_MORE_EFFORTS // efforts of motions, forces and torques of all joints
};

struct ct_beam_error_coupled;

/// Validity indicator of a linear beam.
struct ct_validity {
    const char *beam;
    struct ct_mark mark;
    ct_ex eta;
    double omega; // first bending frequency of the beam in its frame [rad/s]
    // What estimates the error of a linear beam  (beam_error_modal.h)
    bool
        estimates_error; // its base moves as time tells or can be foreseen, nothing but bodies welded to it hangs on it or loads it
    const struct ct_beam_error_coupled *
        coupled; // its base is not driven, but moves as can be foreseen (beam_error_coupled.h); else NULL
    bool starts_static;    // it starts in equilibrium
    ct_ex3 base_motion[3]; // w, v, weight per mass of the base, axes of the beam
    ct_ex end[2];          // deflection of its end along y and z
    int nshape;
    struct ct_bending_shape {
        struct ct_beam_mode mode;
        ct_ex state[2];  // x, x'
        double start[2]; // with `initial: {v: ...}`
        const double
            *moved; // phi at places along the beam, times roots of the masses there  (nmoved)
        int nmoved;
    } shape[CT_BENDING_SHAPES];
};

/// How far a beam bends: squared slopes of its nodes against its frame.
struct ct_bent_beam {
    const char *beam;
    struct ct_mark mark;
    ct_ex *square;
    size_t n;
};

struct ct_left_out {
    const char *what, *why;
};

/// How accelerations of an open system are formulated. CUTSETS: mass matrix and forces by cutset sums in ground axes;
/// COMPOSITE: the same in axes of the bodies; ARTICULATED: without a mass matrix.
enum ct_formulation {
    CT_FORMULATION_AUTO,
    CT_FORMULATION_CUTSETS,
    CT_FORMULATION_COMPOSITE,
    CT_FORMULATION_ARTICULATED,
    CT_NFORMULATION
};

struct ct_equations {
    struct ct_exs *x;
    struct ct_q *q;
    size_t nq, q_cap;
    struct ct_u *u;
    size_t nu, u_cap;
    size_t nmotion,
        nstate; // of these: speeds of joints and beams; behind them the model's states, in its order
    struct ct_entry *M; // lower triangle, row by row
    size_t nM, M_cap;
    ct_ex *solution; // u' of an open system in closed form (nu), or NULL
    ct_ex *pivot;    // of each speed in that solution (nu): not positive where it moves no mass
    enum ct_formulation formulation; // of the solution; AUTO where no choice was made
    // operations by formulation, the solution included; INFINITY: it does not apply or cannot win
    double formulation_cost[CT_NFORMULATION];
    bool has_dynamics; // M and Q are derived; else ct_formulate_dynamics does it
    bool is_open;      // joints close no loop: J keeps its rank on any trees
    bool is_analysed;  // to be linearised, not to be integrated: a few evaluations
    ct_ex *Q;          // nu
    const struct ct_beam_augmented
        *augmented;     // of closed systems, with the solution (beam_augmented.h); or NULL
    struct ct_entry *J; // row by row
    size_t nJ, J_cap;
    struct ct_row *row;
    size_t nrow, row_cap;
    struct ct_switch *switches;
    size_t nswitch, switch_cap;
    ct_ex *
        time_function; // functions of t alone that loads and drivers have, each as large as it can be
    size_t ntime_function, time_function_cap;
    struct ct_memory *memory;
    size_t nmemory, memory_cap;
    struct ct_constraint_offset *offset; // of rows (constraint_offset.h)
    size_t noffset, offset_cap;
    struct ct_driver *driver;
    size_t ndriver, driver_cap;
    struct ct_result *result; // outputs, one per column
    size_t nresult, result_cap;
    enum ct_more_outputs more; // among them
    ct_ex work_symbol;
    ct_ex power; // d(work)/dt, in terms of u' and lam where drivers push; 0 when nothing works
    ct_ex kinetic, potential, strain; // strain: of beams
    ct_ex total;                      // energy less the work put in: constant
    ct_ex closure_error
        [2]; // largest of phi, of v: constraint.position, constraint.velocity; zero where neither is asked for
    ct_ex
        continuity; // of `rate_jumps: continuous`: what a jump leaves as it is, as half a sum of squares of speeds; else 0
    struct ct_residual *residual; // NULL if not asked for
    bool is_planar;
    int bare_beam,
        bare_joint; // body whose first section has no inertia, the joint it turns on; 0: none
    const bool *is_small; // by speed: M and Q are cut to first order in these; NULL: not cut
    struct ct_validity *validity;
    size_t nvalidity, validity_cap;
    struct ct_bent_beam *bent_beam;
    size_t nbent_beam, bent_beam_cap;
    struct ct_left_out *left_out;
    size_t nleft_out, left_out_cap;
    struct ct_coordinate *coordinate; // of all joints and bodies (build.h)
    size_t ncoordinate;
    struct ct_build *build; // for what is asked for later: terminal equations, further signals
    // topology, for reports
    const struct ct_graph *graph;
    const struct ct_tree *T, *R;
    const char *const *node_name, *const *edge_name, *const *edge_kind;
    const int *weight_t, *weight_r;
    const char *how; // the trees were chosen, for reports; NULL: not known
};

/// Is speed k a state of the model?
static inline bool ct_speed_is_state(const struct ct_equations *e, size_t k)
{
    return k >= e->nmotion && k < e->nmotion + e->nstate;
}

#endif
