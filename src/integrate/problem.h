// The folder integrate holds numerical methods for initial value problems: explicit Runge-Kutta
// methods here, Radau IIA and generalised-alpha methods in implicit/. Around them are step size
// control, projection onto the constraints, event location, dense output, stiffness detection and
// steps across singular configurations. A problem is a set of arrays and callbacks; nothing here
// depends on a mechanical model.
//
// This file defines the problem, the method and the function that integrates:
//
//     y' = f(t, y)   with events, a projection after each step, and samples at given times
//
// What always holds: between two events f is smooth. Stages, at which f is evaluated, may lie off
// the constraint manifold; after `project` the state lies on it. Steps do not allocate.
#ifndef CT_INTEGRATE_PROBLEM_H
#define CT_INTEGRATE_PROBLEM_H

#include "base/ctx.h"

enum ct_eval {
    CT_EVAL_OK,
    CT_EVAL_RETRY, // take a smaller step
    CT_EVAL_FATAL, // cannot go on; a diagnostic is there
};

/// Sparsity patterns of K, C, M (nu x nu), D and J (most_rows x nu). The lists of entries follow
/// each other; each entry is listed once at most.
///
/// The residual r may depend on auxiliary unknowns k (nauxiliary), where k_i depends on the
/// unknowns before it alone. Then K, C and M have rows of r, followed by rows of k, as derivatives
/// at fixed k, and R = d(r, k)/dk. The whole derivative of r is r_q + r_k (1 - k_k)^-1 k_q, and so
/// on.  (8.19)
struct ct_jacobian_pattern {
    int nK, nC, nM, nR, nD, nJ; // in this order; K, C, M, R by row
    int nauxiliary;
    const int *row, *column;
};

/// Speeds that are not the derivative of one coordinate: three angular velocities of a rotation, in
/// turn, or a state variable of the model that moves no coordinate.
enum ct_no_coordinate { CT_MOVES_ROTATION = -1, CT_MOVES_NOTHING = -2 };

/// The same problem in the form that implicit methods solve: of second order, with constraints.
/// (theory 0.4, 8)
///
///     r(t, q, u, u', lam) = M u' - Q - J' lam = 0,   Phi(q, t) = 0,   v(q, u, t) = J u + Phi_t = 0
///
/// A position changes by an increment d (nu), written q (+) d: a sum for plain coordinates, a
/// rotation for a quaternion. Derivatives by q are derivatives by d. Only independent constraints
/// are among the rows.
struct ct_dae {
    void *user;
    int nq, nu;    // the states are q, u and perhaps quadratures, on which f does not depend
    int most_rows; // the largest number of rows
    const int
        *q_of; // (nu) the coordinate that moves with speed k alone; or of enum ct_no_coordinate
    double scale; // least size of positions for the round-off of residuals

    /// The present number of rows. *version changes whenever other rows are selected, which only
    /// `rhs`, `project` and `accepted` of the problem do.
    int (*rows)(void *user, long *version);
    /// q1 (nq, out) = q (+) d.
    void (*retract)(void *user, const double *q, const double *d, double *q1);
    /// rate (nu, out) = d', where q (+) d has the speeds w; T^-1(d) w for rotations.  (7.3)
    void (*chart_rate)(void *user, const double *d, const double *w, double *rate);
    /// a (nu, out), lam (rows, out) that satisfy r = 0 and the constraints on accelerations at y.
    enum ct_eval (*start)(void *user, double t, const double *y, double *a, double *lam);
    /// r (nu, out), phi, v (rows, out).
    enum ct_eval (*residual)(void *user, double t, const double *q, const double *u,
                             const double *a, const double *lam, double *r, double *phi,
                             double *v);
    /// M = dr/du', C = dr/du, K = dr/dq (nu x nu, out), J = dPhi/dq = dv/du and D = dv/dq (rows x
    /// nu, out).
    enum ct_eval (*tangent)(void *user, double t, const double *q, const double *u,
                            const double *a, const double *lam, double *M, double *C, double *K,
                            double *J, double *D);

    /// The sparsity patterns of the same derivatives; NULL: not known.
    const struct ct_jacobian_pattern *jacobian_pattern;
    /// *value (out): the entries of K, C, M, R, D, J in turn, valid until the next call.
    enum ct_eval (*evaluate_jacobian)(void *user, double t, const double *q, const double *u,
                                      const double *a, const double *lam, const double **value);
    /// Indices of the present rows among most_rows, in the order of lam.
    const int *(*active_rows)(void *user);
    /// Symbolic analysis of the Newton matrix, [1] for stabilised forms; NULL: dense matrices.
    const struct ct_newton_pattern *plan[2];

    // special cases that make steps cheaper
    bool is_plain;                 // speed k is the derivative of coordinate k: q (+) d = q + d
    bool quadratures_are_constant; // rates of quadratures are zero
    int nstate; // the last speeds are state variables, which move no coordinate
};

/// Groups of states that are components of one quantity, such as a vector. The largest component is
/// the scale of errors for the whole group.
struct ct_groups {
    int n;
    const int *of; // per state: 0 ... n - 1; -1: measured by itself
    double *size;  // workspace (n)
};

/// The weight of an error is rtol * max(|y_i| at either end of the step) + atol; in a group with
/// the largest |y_i|.
struct ct_tolerance {
    double rtol, atol;
};

struct ct_stepper_span;

/// Singular configurations, in which constraints become dependent. Along the motion f has a limit
/// there that cannot be computed directly. With step size control one is crossed in a single step
/// that does not evaluate f close to it, see crossing.h.
struct ct_singularities {
    void *user;
    /// The predicted time from the last accepted state to the next singular configuration, or
    /// INFINITY. *reach (out): the time before and after it within which f has too few digits.
    double (*time_to_next)(void *user, double *reach);
    /// Is y so near to a singular configuration that f has too few digits?
    bool (*is_near)(void *user, double t, const double *y);
    /// Tells whether the evaluations that follow belong to a crossing, and are not close to the
    /// singular configuration.
    void (*set_crossing)(void *user, bool is_crossing);
    /// The residual of the constraints at y. *dependent (out): that of the combination of
    /// constraints that becomes dependent. At a singular configuration it vanishes; at one that is
    /// only nearly singular it does not.
    double (*residual)(void *user, double t, const double *y, double *dependent);
    /// A step has crossed a singular configuration. It ends at t1 or later, and is the crossing
    /// without its first part `begin`. False if the configuration does not lie before t1.
    bool (*passed)(void *user, const struct ct_stepper_span *step, double begin, double t1);
    /// Called after a crossing has failed: does the motion end in the configuration `in` seconds
    /// after y, the last accepted state, because the constraints have no solution beyond it?
    bool (*ends_motion)(void *user, double t, const double *y, double in);
};

struct ct_problem {
    void *user;
    int ny;     // states
    int nq, nu; // y begins with nq coordinates and nu speeds; 0: not known
    /// The form for implicit methods; NULL: none can be used.
    const struct ct_dae *dae;
    /// Per state: is its error controlled? Those of quadratures are not. NULL: all are.
    const bool *error_controlled;
    /// Per speed (nu), and per coordinate of that speed: is it an output itself? NULL: all are.
    const bool *requested_speeds, *requested_positions;
    /// Is the total energy an output, so that even small vibrations must keep theirs? Is the last
    /// quadrature, a work, one?
    bool keeps_energy, keeps_work;
    double accuracy; // relative, wanted of outputs over the whole run; 0: not known
    double duration; // of the run [s]; 0: not known
    /// Round-off of f, per state (ny), that is subtracted from error estimates of steps up to
    /// `roundoff_step`. NULL: it does not matter.
    const double *roundoff;
    double roundoff_step;
    /// NULL: every state has its own scale of errors.
    const struct ct_groups *groups;

    /// The error of outputs, where 1 is the tolerance, that follows from an error e (ny) of the
    /// state y at the end of a step. `states` is the norm of e. 0: the error of states is enough.
    /// NULL: it always is.
    double (*output_error)(void *user, double t, const double *y, const double *e,
                           const struct ct_tolerance *tolerance, double states);
    /// The largest relative change of an output for a change e (ny) of y, relative to its largest
    /// value so far. With least > 0 it is relative to `least`, or to the predicted value, if these
    /// are larger, and sensitive outputs (8.11) do not count. NULL: outputs are states only.
    double (*output_change)(void *user, double t, const double *y, const double *e,
                            double least);
    /// Predicts outputs: they will change by `times` their change for a change way (ny) of y. NULL
    /// as above.
    void (*predict_output)(void *user, double t, const double *y, const double *way,
                           double times);
    /// As output_error, for sensitive outputs, which amplify errors of states (8.11). Where it is
    /// not NULL output_error leaves them out. 0: there are none.
    double (*sensitive_output_error)(void *user, double t, const double *y, const double *e,
                                     const struct ct_tolerance *tolerance, double states);

    /// dy (ny, out) = f(t, y).
    enum ct_eval (*rhs)(void *user, double t, const double *y, double *dy);

    /// Move y onto the constraints; called on accepted steps and on interpolated samples. May be
    /// NULL.
    enum ct_eval (*project)(void *user, double t, double *y);

    /// Called after a step was accepted and projected, dy = f(t, y). Here the problem may change
    /// its internal choices, such as independent coordinates, as long as f stays the same function.
    /// If it returns CT_EVAL_RETRY it must not have changed anything. is_across: the step has
    /// crossed a singular configuration. May be NULL.
    enum ct_eval (*accepted)(void *user, double t, const double *y, const double *dy,
                             bool is_across);

    /// The longest step allowed from the present state. May be NULL.
    double (*longest_step)(void *user);
    /// The longest step from t, up to h, that does not miss changes of time-dependent inputs. May
    /// be NULL.
    double (*input_limited_step)(void *user, double t, double h);
    /// NULL: singular configurations are not treated.
    const struct ct_singularities *singular;

    /// Root functions on the state, g (nroot, out); a sign change within a step is an event. g is
    /// continuous within the step.
    int nroot;
    enum ct_eval (*root)(void *user, double t, const double *y, double *g);
    /// side (nroot, out): the sign of each root function that f assumes at a start and after an
    /// event, -1 or 1; 0 for a root that stays zero. NULL: the sign to which the root function
    /// moves.
    void (*sides)(void *user, signed char *side);

    /// The first time event after t (never t itself), or INFINITY. May be NULL. Steps end exactly
    /// on it.
    double (*next_time_event)(void *user, double t);

    /// Called at an event, with its t and y. crossed[i] (nroot) is -1 or 1 for root functions that
    /// changed sign downwards or upwards, else 0; is_time: a time event is due. It changes discrete
    /// states and may change y (impulses). Integration restarts after it. dy: f before the event in
    /// the gap of a crossing, where f cannot be computed; else NULL.
    enum ct_eval (*event)(void *user, double t, double *y, const double *dy,
                          const signed char *crossed, bool is_time);
    /// Called after an event in the gap of a crossing, when a step from there has found the new f,
    /// dy. May be NULL.
    enum ct_eval (*resumed)(void *user, double t, const double *y, const double *dy);
};

/// The stages of a crossing and their interpolation weights for a time in its gap, where f cannot
/// be computed.
struct ct_gap_interpolation {
    int n;
    const double *t, *weight; // (n)
    const double *y;          // (ny x n)
};

/// An accepted step, for ct_step_state.
struct ct_step_view {
    double t0, t1;
    void *driver;
    const void *step;
};

struct ct_integrate_options {
    double t0, t1;
    double rtol, atol;    // tolerance of the states; see ct_integrate
    double least_rtol;    // > 0: for periodic motions rtol may be reduced down to this
    double step;          // > 0: fixed step, see ct_integrate
    double first_step;    // 0: chosen
    long max_steps;       // 0: 100 million
    const double *sample; // nsample times in [t0, t1], ascending
    size_t nsample;
    /// Called once for each sample, in order. A sample on an event is given after it. y may be used
    /// freely; dy is not given. Return false to stop (a diagnostic is there).
    bool (*at_sample)(void *user, double t, const double *y);
    /// The same for samples in the gap of a crossing. NULL: at_sample.
    bool (*at_singular_sample)(void *user, double t, const double *y,
                               const struct ct_gap_interpolation *b);
    /// Called after each accepted step, before the samples in it; ct_step_state gives the states.
    /// Return false to stop (a diagnostic is there). May be NULL.
    bool (*over_step)(void *user, const struct ct_step_view *step);
    /// Called once if more than `many_steps` steps of the present size are to come. May be NULL.
    void (*forecast)(void *user, double t, const double *y, double step, double to_come);
    double many_steps;
    /// Called after each accepted step for progress; may be NULL. Return false to stop quietly.
    bool (*at_step)(void *user, double t, const double *y);
};

struct ct_integrate_stats {
    long steps, rejected_steps, evaluations, jacobians, factorizations, events;
    long inaccurate_steps; // steps rejected for their error; others could not be computed
    double last_time;      // reached, also on failure
    double last_rtol;      // relative tolerance of the last steps; 0: fixed steps
    double next_step;      // step size for the next step
};

enum { CT_MOST_STAGES = 13 }; // Definition: of a tableau, those of dop853

/// The Butcher tableau of an explicit method whose last stage is the end of the step (first same as
/// last). Stage s is at t + C_s h, y + h sum_j A_sj k_j. The error estimate is h sum E_j k_j or,
/// with a second solution B3 of order 3, |e| / hypot(1, |e3| / (10 |e|)) in the norms of both.
struct ct_tableau {
    int stages, stride;           // A has rows of `stride` numbers
    const double *C, *A, *E, *B3; // B3: NULL without
    int nerror;                   // length of E and B3
};

/// Dense output of an explicit method. It has additional stages with the coefficients C, A, as in
/// the tableau. With F_j = h sum_i D_ji k_i, t = theta and s = 1 - theta,
///
///     y(t + theta h) = Hermite(theta) + t^2 s^2 (F_0 + t (F_1 + s (F_2 + t F_3)))
///
/// A and D have rows of `stride` numbers; D has `corrections` of them, the other F are zero.
struct ct_dense_tableau {
    int stages, corrections, stride; // stages: of the step and the additional ones
    const double *C, *A, *D;
};
/// Definition: those of dop853.
enum { CT_MOST_DENSE_STAGES = 16, CT_DENSE_CORRECTIONS = 4 };

/// One integration method: a constant table in a file of its own.
struct ct_method {
    const char *name;                             // as in `simulation.method`
    const char *summary;                          // one line for `cotree methods`
    const char *source;                           // key into docs/references.bib
    const struct ct_tableau *tableau;             // NULL: not an explicit Runge-Kutta method
    const struct ct_dense_tableau *dense_tableau; // of those that have a tableau
    int order;
    int error_order; // the error of a step behaves as h^(error_order + 1), for step control
    /// Needs problem.dae, and solves the constraints itself: its steps are not projected.
    bool is_implicit;
    /// Its speeds meet the velocity constraints only to the order of the method.
    bool violates_velocity_constraints;
    /// Step size control; 0: the usual values. The step size is kept where it would change by a
    /// factor between steady[0] and steady[1], which saves a factorisation.
    double most_growth, kept_range[2];
    const void *coefficients; // of families of methods
    /// The workspace for a run. `restart` clears what it keeps from earlier steps, `accept` adds
    /// the last step; both may be NULL.
    void *(*create)(struct ct_arena *a, const struct ct_method *method,
                    const struct ct_problem *p);
    /// Called before the first step and after each event.
    void (*restart)(void *work);
    /// The last step was accepted; the next one starts at its end.
    void (*accept)(void *work);
    /// One step from (t, y) with derivative dy by h: y1 (out), dy1 (out) = f(t + h, y1) before
    /// projection, *err (out) scaled so that 1 is the tolerance. Without a tolerance (NULL) no
    /// error is wanted and *err stays.
    enum ct_eval (*step)(const struct ct_problem *p, double t, double h, const double *y,
                         const double *dy, const struct ct_tolerance *tolerance, double *y1,
                         double *dy1, double *err, void *work,
                         struct ct_integrate_stats *stats);
    /// h times the estimated largest eigenvalue of df/dy, from the last two stages of a step, which
    /// are at the same time. Beyond `resolved_limit` the step damps that mode instead of resolving
    /// it, and dense output is inaccurate. NULL: it is accurate.
    double resolved_limit;
    double (*stiffness_estimate)(const struct ct_problem *p, double h, const double *y,
                                 const double *y1, void *work);
    /// The limit of stability: up to this value a step does not amplify damped or undamped modes.
    /// Beyond it the error estimate does not see the growth. 0: it does.
    double stability_limit;
    /// Called once for a step before its first `dense`, for additional stages. May be NULL. With
    /// has_rough_dense, `dense` without it is accurate enough to find roots.
    bool has_rough_dense;
    enum ct_eval (*prepare)(const struct ct_problem *p, double t, double h, const double *y,
                            const double *y1, void *work, struct ct_integrate_stats *stats);
    /// y (ny, out) at t + theta h, 0 <= theta <= 1, from the step just taken; y1 as it came from
    /// `step`.
    void (*dense)(const struct ct_problem *p, double h, double theta, const double *y,
                  const double *y1, void *work, double *out);
    /// *err (out): the error of sensitive outputs (8.11) in that point, where 1 is the tolerance. y
    /// is overwritten. NULL: no more than at the end of the step.
    enum ct_eval (*dense_error)(const struct ct_problem *p, double t, double h, double theta,
                                double *y, void *work, double *err,
                                struct ct_integrate_stats *stats);
};

extern const struct ct_method *const ct_methods[];
extern const int ct_nmethod;
/// NULL if there is none of that name.
const struct ct_method *ct_method_find(const char *name);

/// Integrate y (ny, in: start, out: end) from t0 to t1 >= t0. The error of a step is held below
/// rtol * max(|y_i|, ...) + atol in the controlled states (weighted root mean square) and, with
/// output_error, in outputs. Implicit methods of order 2 control the errors of coordinates,
/// quadratures and outputs, not of speeds.
///
/// With least_rtol, nq and nu, the tolerance is reduced for a motion of many periods up to t1, see
/// periodic_tolerance.h.
///
/// Steps end exactly on time events and on t1. Samples between step ends are interpolated and
/// projected. State events are located on the interpolant; the step is then taken again up to the
/// event, so that the state there is as accurate as any other.
///
/// With a fixed step, steps also end on samples, and the time between two such ends is divided
/// evenly into the fewest steps that are not longer than `step`. There is no error control, and a
/// refused step is an error.
///
/// Errors: E301 to E307, with the time reached. Owner: workspace is taken from ctx->model before
/// the first step.
bool ct_integrate(struct ct_ctx *ctx, const struct ct_method *method,
                  const struct ct_problem *p, const struct ct_integrate_options *options,
                  double *y, struct ct_integrate_stats *stats);

/// For over_step: y (ny, out) = the state at t, t0 <= t <= t1, without projection. gap (out): the
/// interpolation in the gap of a crossing; elsewhere its n is 0. False with a diagnostic.
bool ct_step_state(const struct ct_step_view *step, double t, double *y,
                   struct ct_gap_interpolation *gap);

#endif
