// The reduced equations of motion as expressions: the result of src/formulate.
//
//     q' = Z(q) u
//     M(q, t) u' = Q(q, u, t) + J(q, t)' lam        n_u rows
//     z' = rate(q, u, z, t)                         the model's states
//     Phi(q, t) = 0,  v = J u + Phi_t = 0,  J u' + gam = 0     m rows          (formulation 0.4)
//
// The states of the model are the last entries of u. They move no coordinate. Their mass is 1,
// their Q is their rate and their columns of J are zero, so that a solver of M u' = Q + J' lam
// needs no special case.
//
// What always holds: M holds its lower triangle, J its nonzeros, both in row order; all expressions
// live in x and use symbols of kind TIME, PARAM, Q, U, A, LAM, SWITCH, MEMORY, WORK only. A and LAM
// occur in outputs and in the power alone.
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

/// Kinds of elastic coordinates of a beam: axial, transverse, section rotation, modal.
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
    int q;            // the coordinate whose rate it is; -1: an angular velocity or a state
    int joint, body;  // the one that it belongs to; the other is -1
    int beam;         // number of the beam body for an elastic coordinate; 0: none
    enum ct_elastic_kind kind; // for elastic coordinates
    bool is_rotation;          // [rad/s]
};

struct ct_entry { // one entry of a sparse matrix
    int row, column;
    ct_ex value;
};

/// A constraint row and the wrench pair of its multiplier: force lam p, torque lam h on the head.
struct ct_row {
    const char *name;    // "pin2: y", "gear"
    int joint;           // in the model; -1: none
    ct_ex phi, v, gam;   // position, velocity J u + Phi_t, acceleration J u' + gam
    ct_ex lam;           // symbol
    ct_ex assembly_sign; // >= 0 in the correct assembly mode (4.4); 0: no condition
    bool is_length;      // of phi [m]
    const ct_ex3 *lever; // [m] vectors along the path of the row that rotations turn  (nlever)
    size_t nlever;
};

/// A comparison whose result is constant between events.
struct ct_switch {
    ct_ex symbol;
    enum ct_op op; // LT, LE, GT, GE
    ct_ex g;       // the symbol is 1 where g op 0
    bool is_time;  // g depends on t alone
    ct_ex written; // g as written in the model, with its signals
    struct ct_mark mark;
};

/// A value stored at each accepted step; update computes the next one.
struct ct_memory {
    ct_ex symbol, update;
    // ANGLE: a continuous angle; QUATERNION (four in a row): a continuous rotation; OFFSET:
    // constant, set at the start; TURNS: number of whole turns of an angle, constant, set before
    // the others
    enum ct_memory_kind {
        CT_MEMORY_ANGLE,
        CT_MEMORY_QUATERNION,
        CT_MEMORY_OFFSET,
        CT_MEMORY_TURNS
    } kind;
    ct_ex33 R;        // QUATERNION, first of four: the rotation matrix
    int joint, index; // ANGLE: the coordinate that gives the start value; joint -1: none
    bool is_sum;      // ANGLE: a sum of angles and whole turns; it does not need its last value
};

/// Does it change from step to step?
static inline bool ct_memory_is_updated(const struct ct_memory *m)
{
    return m->kind == CT_MEMORY_ANGLE || m->kind == CT_MEMORY_QUATERNION;
}

/// Does its update need its last value? Then the rotation within a step is limited.
static inline bool ct_memory_limits_steps(const struct ct_memory *m)
{
    return ct_memory_is_updated(m) && !m->is_sum;
}

struct ct_result {
    const char *name; // column
    ct_ex value;
    bool undetermined; // an out-of-plane reaction that a planar model does not determine
};

/// A driven coordinate: known branch coordinate with its value, rate and acceleration.
struct ct_driver {
    const char *name;
    int joint, index;
    struct ct_mark mark;
    ct_ex value, rate, acceleration; // functions of t (and of switches)
    ct_ex effort;                    // generalised force of the driver [N or N m]
};

/// The residual form for implicit integrators and the derivatives for their Newton iteration.
/// Positions are varied along the retraction, so that each direction of differentiation is numbered
/// by a speed.  (formulation 5.2, 8.2)
///
/// Auxiliary unknowns k are subexpressions of r; each depends on earlier ones only. Derivatives of
/// r are then taken with k constant, and rows nu + i are the derivatives of k_i. dk/dk is strictly
/// triangular, so that dr = r_q dq + r_k (1 - k_k)^-1 k_q dq.  (8.19)
struct ct_residual {
    ct_ex *r;                           // M u' - Q - J' lam  (nu)
    bool has_slopes;                    // the derivatives below exist
    ct_ex *auxiliary;                   // k (ninner)
    struct ct_slope *dq, *du, *da, *dk; // of r and k with respect to q, u, u', k
    struct ct_slope *dv;                // of the v of the constraint rows with respect to q
    size_t nauxiliary, ndq, ndu, nda, ndk, ndv;
    // along: NULL: slopes have expressions as values; else only the sparsity pattern is known
    struct ct_directional *along;
};

/// Directional derivatives along q, u, u' (nu numbers each) and auxiliary unknowns. The Jacobian is
/// read from them colour by colour.
struct ct_directional {
    ct_ex *seed;      // symbols of the direction (nseed)
    ct_ex *rate;      // derivatives of r (nu), of auxiliary unknowns, and of v (nrow)
    uint32_t *colour; // by seed: seeds of one colour have no row in common
    size_t nseed;
    uint32_t ncolour;
};

/// Results in addition to the outputs of the model.
enum ct_more_outputs {
    // if the model lists no outputs: coordinates, speeds, accelerations of all joints
    CT_MORE_NONE,
    CT_MORE_COORDINATES,
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
    // estimates_error: the motion of its base is prescribed or can be estimated, and only
    // bodies welded to it load it
    bool estimates_error;
    // coupled: its base is not driven, but its motion can be estimated (beam_error_coupled.h);
    // else NULL
    const struct ct_beam_error_coupled *coupled;
    bool starts_static;    // it starts in equilibrium
    ct_ex3 base_motion[3]; // w, v and gravity at the base, in axes of the beam
    ct_ex end[2];          // deflection of its end along y and z
    int nshape;
    struct ct_bending_shape {
        struct ct_beam_mode mode;
        ct_ex state[2];  // x, x'
        double start[2]; // with `initial: {v: ...}`
        // phi at stations along the beam, times the square roots of their masses  (nmoved)
        const double *moved;
        int nmoved;
    } shape[CT_BENDING_SHAPES];
};

/// Deflection of a beam: squared slopes of its nodes relative to its frame.
struct ct_bent_beam {
    const char *beam;
    struct ct_mark mark;
    ct_ex *square;
    size_t n;
};

struct ct_left_out {
    const char *what, *why;
};

/// How accelerations of an open system are formulated. CUTSETS: mass matrix and forces by cutset
/// sums in ground axes; COMPOSITE: composite bodies in body axes; ARTICULATED: articulated bodies,
/// no mass matrix.
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
    // nmotion: number of speeds of joints and beams; nstate: number of states of the model,
    // which follow them
    size_t nmotion, nstate;
    struct ct_entry *M; // lower triangle, row by row
    size_t nM, M_cap;
    ct_ex *solution; // u' of an open system in closed form (nu), or NULL
    // of each speed in that solution (nu): zero or negative if the speed moves no mass
    ct_ex *pivot;
    enum ct_formulation formulation; // of the solution; AUTO where no choice was made
    // operation count of each formulation with its solution; INFINITY: not applicable or too
    // expensive
    double formulation_cost[CT_NFORMULATION];
    bool has_dynamics; // M and Q are derived; else ct_formulate_dynamics does it
    bool is_open;      // no joint closes a loop: J has constant rank for any choice of trees
    bool is_analysed;  // for linearisation only, with few evaluations
    ct_ex *Q;          // nu
    // of closed systems, with the solution (beam_augmented.h); or NULL
    const struct ct_beam_augmented *augmented;
    struct ct_entry *J; // row by row
    size_t nJ, J_cap;
    struct ct_row *row;
    size_t nrow, row_cap;
    struct ct_switch *switches;
    size_t nswitch, switch_cap;
    // time_function: the largest subexpressions of loads and drivers that depend on t alone
    ct_ex *time_function;
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
    ct_ex power; // d(work)/dt, of loads and drivers, in terms of u' and lam; 0: none
    ct_ex kinetic, potential, strain; // strain: of beams
    ct_ex total;                      // energy minus work done on the system: constant
    // largest |phi| and |v|: outputs constraint.position, constraint.velocity; zero if not
    // requested
    ct_ex closure_error[2];
    // continuity: for `rate_jumps: continuous`, half the weighted sum of squares of the speeds
    // that a jump changes least; else 0
    ct_ex continuity;
    struct ct_residual *residual; // NULL if not requested
    bool is_planar;
    // bare_beam, bare_joint: beam whose first section has no inertia, and the joint at that
    // section; 0: none
    int bare_beam, bare_joint;
    const bool *is_small; // by speed: M and Q are of first order in these; NULL: exact
    struct ct_validity *validity;
    size_t nvalidity, validity_cap;
    struct ct_bent_beam *bent_beam;
    size_t nbent_beam, bent_beam_cap;
    struct ct_left_out *left_out;
    size_t nleft_out, left_out_cap;
    struct ct_coordinate *coordinate; // of all joints and bodies (build.h)
    size_t ncoordinate;
    struct ct_build *build; // for later requests: reactions, further signals
    // topology, for reports
    const struct ct_graph *graph;
    const struct ct_tree *T, *R;
    const char *const *node_name, *const *edge_name, *const *edge_kind;
    const int *weight_t, *weight_r;
    const char *how; // how the trees were chosen, for reports; NULL: not known
};

/// Is speed k a state of the model?
static inline bool ct_speed_is_state(const struct ct_equations *e, size_t k)
{
    return k >= e->nmotion && k < e->nmotion + e->nstate;
}

#endif
