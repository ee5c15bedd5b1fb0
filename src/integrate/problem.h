// An initial value problem as integrators see it: arrays and callbacks, no model.
//
//     y' = f(t, y)   with  events, a projection after each step and samples on the way
//
// What always holds: between two events f is smooth; f is called at stage points that may lie off
// the constraint manifold; after `project` the state lies on it. Nothing allocates while stepping.
#ifndef CT_INTEGRATE_PROBLEM_H
#define CT_INTEGRATE_PROBLEM_H

#include "base/ctx.h"

enum ct_eval {
    CT_EVAL_OK,
    CT_EVAL_RETRY, // take a smaller step
    CT_EVAL_FATAL, // diagnosed
};

/// Where K, C, M (nu x nu), D and J (most_rows x nu) have entries, each place at most once: lists
/// one behind the other.
///
/// With inner values k (ninner) that r depends on, K, C, M and R have rows of r, then of k, with k
/// held but in R = d(r, k)/dk, in which k_i depends on those before it alone: the matrices are r_q
/// + r_k (1 - k_k)^-1 k_q and so on.  (8.19)
struct ct_slopes {
    int nK, nC, nM, nR, nD, nJ; // in this order; K, C, M, R by row
    int nauxiliary;
    const int *row, *column;
};

/// What a speed moves that is not the rate of one coordinate: a rotation, of size one, three in a
/// row; nothing, as it is a state of its own.
enum ct_no_coordinate { CT_MOVES_ROTATION = -1, CT_MOVES_NOTHING = -2 };

/// The same problem as implicit methods solve it: second order, with constraints.  (formulation
/// 0.4, 8)
///
///     r(t, q, u, u', lam) = M u' - Q - J' lam = 0,   Phi(q, t) = 0,   v(q, u, t) = J u + Phi_t = 0
///
/// Positions move by q (+) d, d (nu) a small motion in the speeds: sums for plain coordinates,
/// rotations where q is a quaternion. Derivatives by q are taken along it. Of the constraints only
/// independent rows count.
struct ct_dae {
    void *user;
    int nq, nu;    // the states are q, u and perhaps quadratures: their rate feeds nothing back
    int most_rows; // rows there can be
    const int
        *q_of; // (nu) the coordinate that moves with speed k alone; or of enum ct_no_coordinate
    double scale; // of places: residuals are rounded as where places are at least as large

    /// The number of rows now; *version changes when they become other rows. Only `rhs`, `project`
    /// and `accepted` of the problem change them.
    int (*rows)(void *user, long *version);
    /// q1 (nq, out) = q (+) d.
    void (*retract)(void *user, const double *q, const double *d, double *q1);
    /// rate (nu, out) = d' where q (+) d moves at speeds w.  T^-1(d) w for rotations, (7.3)
    void (*chart_rate)(void *user, const double *d, const double *w, double *rate);
    /// a (nu, out), lam (rows, out) that satisfy r = 0 and the rows' accelerations at y.
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

    /// The same derivatives as lists of entries; NULL: they are not known as such.
    const struct ct_slopes *slopes;
    /// *value (out): those of K, C, M, R, D, J, one list behind the other, until the next call.
    enum ct_eval (*evaluate_slopes)(void *user, double t, const double *q, const double *u,
                                    const double *a, const double *lam, const double **value);
    /// The rows that count now, of most_rows, in the order of lam.
    const int *(*active_rows)(void *user);
    const struct ct_newton_pattern *plan[2]; // stabilised: 1; NULL: full matrices serve as well

    // what makes steps cheaper, where it is known
    bool
        // coordinate k moves with speed k: q (+) d = q + d, and rates in the chart are speeds
        is_plain;
    bool has_no_power; // rates of quadratures are zero
    int nstate;        // the last speeds are states of their own, which move no coordinate
};

/// States that are components of one thing, as those of a vector: all are measured by the largest
/// of them.
struct ct_groups {
    int n;
    const int *of; // per state: 0 ... n - 1; -1: measured by itself
    double *size;  // workspace (n)
};

/// What an error is measured against: rtol * max(|y_i| at either end of the step) + atol, of a
/// group the largest |y_i|.
struct ct_tolerance {
    double rtol, atol;
};

struct ct_stepper_span;

/// Singular configurations: there f has a limit along the motion that cannot be computed. Methods
/// with step control cross one in a single step that does not evaluate f close to it, see
/// crossing.h.
struct ct_singularities {
    void *user;
    /// Time from the last accepted state to the next singular configuration as far as it can be
    /// predicted, else INFINITY. *reach (out): the time before and after it in which f is better
    /// not computed.
    double (*time_to_next)(void *user, double *reach);
    /// Is y so near to a singular configuration that f has too few digits?
    bool (*is_near)(void *user, double t, const double *y);
    /// Evaluations from now on belong to a crossing, none of them close to the singular
    /// configuration; or do not any more.
    void (*set_crossing)(void *user, bool is_crossing);
    /// How far y is from the constraints. *dependent (out): the same of the combination of
    /// constraints that becomes dependent. It vanishes with the square of the distance from a
    /// singular configuration, and does not if y is only nearly singular.
    double (*residual)(void *user, double t, const double *y, double *dependent);
    /// A step has crossed a singular configuration. It ends at t1 or later, and is the crossing
    /// without its first part `begin`. False if the configuration does not lie before t1.
    bool (*passed)(void *user, const struct ct_stepper_span *step, double begin, double t1);
    /// Asked after a crossing has failed: does the motion end in the configuration that is `in`
    /// seconds ahead of y, the last accepted state, because the constraints cannot be met behind
    /// it?
    bool (*ends_motion)(void *user, double t, const double *y, double in);
};

struct ct_problem {
    void *user;
    int ny;     // states
    int nq, nu; // the first are coordinates, those behind them their speeds; 0: not known
    /// What implicit methods need beside the rest; NULL: none can be used.
    const struct ct_dae *dae;
    /// Per state: counts in error control (quadratures do not). NULL: all do.
    const bool *error_controlled;
    /// Per speed (nu), and per coordinate that moves with it: is wanted of the run itself, and not
    /// only what it leads to in outputs. NULL, both: all are.
    const bool *requested_speeds, *requested_positions;
    /// So that the total energy is kept to the accuracy, however little of it vibrates; or the last
    /// quadrature, a work.
    bool keeps_energy, keeps_work;
    double accuracy,
        duration; // wanted of the outputs, relative, over the whole run; its length. 0: not known
    /// Round-off of f, per state (ny), where it is felt in the errors of steps as long as
    /// `roundoff_step` or shorter. NULL: it is not.
    const double *roundoff;
    double roundoff_step;
    /// NULL: every state is measured by itself.
    const struct ct_groups *groups;

    /// What an error e (ny) of the state y at the end of a step means for what is wanted of the
    /// run, where 1 is the tolerance; `states` is the norm of e. 0 where that is enough. NULL: it
    /// always is.
    double (*output_error)(void *user, double t, const double *y, const double *e,
                           const struct ct_tolerance *tolerance, double states);
    /// The most that an output changes by for a change e (ny) of y, over its largest value so far.
    /// With least > 0 over that if it is more, or over what is expected, and without outputs that
    /// amplify errors of states. NULL: there is none but states.
    double (*output_change)(void *user, double t, const double *y, const double *e,
                            double least);
    /// Outputs are expected to become as large as so many `times` what they change by for a change
    /// way (ny) of y. NULL as above.
    void (*expect_output)(void *user, double t, const double *y, const double *way,
                          double times);
    /// The same of the outputs that amplify errors of states, which output_error leaves to this
    /// where it is not NULL; 0 where there are none.  (8.11)
    double (*sensitive_output_error)(void *user, double t, const double *y, const double *e,
                                     const struct ct_tolerance *tolerance, double states);

    /// dy (ny, out) = f(t, y).
    enum ct_eval (*rhs)(void *user, double t, const double *y, double *dy);

    /// Move y onto the constraints; called on accepted steps and on interpolated samples. May be
    /// NULL.
    enum ct_eval (*project)(void *user, double t, double *y);

    /// After a step was accepted and projected: update memories and choices that keep f the same
    /// function. May be NULL. Before it answers CT_EVAL_RETRY it must have changed nothing. dy
    /// belongs to y. is_across: the step was made to cross a singular configuration.
    enum ct_eval (*accepted)(void *user, double t, const double *y, const double *dy,
                             bool is_across);

    /// Longest step from the last accepted state, or from where the start or an event has put it.
    /// May be NULL.
    double (*longest_step)(void *user);
    /// The longest step from t, of at most h, that does not pass over what f does by time alone.
    /// May be NULL.
    double (*input_limited_step)(void *user, double t, double h);
    /// NULL: none are looked for.
    const struct ct_singularities *singular;

    /// Root functions on the state, g (nroot, out); a sign change within a step is an event. g is
    /// continuous within the step.
    int nroot;
    enum ct_eval (*root)(void *user, double t, const double *y, double *g);
    /// side (nroot, out): the sides of zero that f stands for, -1 or 1, at a start and after an
    /// event; 0 for a root at rest on zero. NULL: those to which roots go from there.
    void (*sides)(void *user, signed char *side);

    /// The first time event after t (never t itself), or INFINITY. May be NULL. Steps end exactly
    /// on it.
    double (*next_time_event)(void *user, double t);

    /// At an event: t and y are those of the event, crossed[i] (nroot) is -1 or +1 for the roots
    /// that changed sign downwards or upwards, 0 else; is_time tells that a time event is due.
    /// Changes modes and may change y (impulses). Integration restarts after it. dy: f before the
    /// event where it cannot be computed, in the gap of a crossing; else NULL.
    enum ct_eval (*event)(void *user, double t, double *y, const double *dy,
                          const signed char *crossed, bool is_time);
    /// After an event in the gap of a crossing: dy is f there as it is now, found by a step from
    /// there. May be NULL.
    enum ct_eval (*resumed)(void *user, double t, const double *y, const double *dy);
};

/// Times and states around a sample where f cannot be computed, and their weights in what is
/// interpolated there.
struct ct_gap_interpolation {
    int n;
    const double *t, *weight; // (n)
    const double *y;          // (ny x n)
};

/// An accepted step as it is handed on.
struct ct_step_view {
    double t0, t1;
    void *driver;
    const void *step;
};

struct ct_integrate_options {
    double t0, t1;
    double rtol, atol;    // tolerance of the states; see ct_integrate
    double least_rtol;    // > 0: motions that repeat themselves often get less, down to this
    double step;          // > 0: fixed step, see ct_integrate
    double first_step;    // 0: chosen
    long max_steps;       // 0: 100 million
    const double *sample; // nsample times in [t0, t1], ascending
    size_t nsample;
    /// Called once for each sample, in order. A sample on an event is given after it. y may be used
    /// freely; dy is not given. Return false to stop (a diagnostic is there).
    bool (*at_sample)(void *user, double t, const double *y);
    /// The same for samples in singular configurations or close to them. NULL: at_sample.
    bool (*at_singular_sample)(void *user, double t, const double *y,
                               const struct ct_gap_interpolation *b);
    /// Called after each accepted step, before the samples in it; ct_step_state gives the states.
    /// Return false to stop (a diagnostic is there). NULL: nobody looks into steps.
    bool (*over_step)(void *user, const struct ct_step_view *step);
    /// Called once if the end is foreseen to be more than so many steps away, with their present
    /// size. May be NULL.
    void (*forecast)(void *user, double t, const double *y, double step, double to_come);
    double many_steps;
    /// Called after each accepted step for progress; may be NULL. Return false to stop quietly.
    bool (*at_step)(void *user, double t, const double *y);
};

struct ct_integrate_stats {
    long steps, rejected_steps, evaluations, jacobians, factorizations, events;
    long inaccurate_steps; // of those rejected: for their error; the others could not be done
    double last_time;      // reached, also on failure
    double last_rtol;      // that its steps were held to in the end; 0: to none
    double next_step;      // that step control would take next
};

enum { CT_MOST_STAGES = 13 }; // Definition: of a tableau, those of dop853

/// The numbers of an explicit method whose last stage is the end of the step: for those who step by
/// themselves. Stage s is at t + C_s h, y + h sum_j A_sj k_j; its error is h sum E_j k_j or, with a
/// result B3 of order 3, |e| / hypot(1, |e3| / (10 |e|)) in the norms of both.
struct ct_tableau {
    int stages, stride;           // A has rows of `stride` numbers
    const double *C, *A, *E, *B3; // B3: NULL without
    int nerror;                   // length of E and B3
};

/// What an explicit method's interpolant is made of: with y1 and f there as the last stage of the
/// step, more stages C, A as those of its tableau, then F_j = h sum_i D_ji k_i and, t = theta, s =
/// 1 - theta,
///
///     y(t + theta h) = Hermite(theta) + t^2 s^2 (F_0 + t (F_1 + s (F_2 + t F_3)))
///
/// A and D have rows of `stride` numbers; D has `corrections` of them, the other F are zero.
struct ct_dense_tableau {
    int stages, corrections, stride; // stages: those of the step and these
    const double *C, *A, *D;
};
/// Definition: those of dop853.
enum { CT_MOST_DENSE_STAGES = 16, CT_DENSE_CORRECTIONS = 4 };

/// One integration method: a constant table in a file of its own.
struct ct_method {
    const char *name;                             // as in `simulation.method`
    const char *summary;                          // one line for `cotree methods`
    const char *source;                           // key into docs/references.bib
    const struct ct_tableau *tableau;             // NULL: it is more than its numbers
    const struct ct_dense_tableau *dense_tableau; // of those that have a tableau
    int order;
    int error_order; // the error of a step behaves as h^(error_order + 1), for step control
    /// Needs problem.dae, and meets the constraints by itself: the driver does not project its
    /// steps.
    bool is_implicit;
    /// But those of speeds only to its order: speeds err across the constraints.
    bool leaves_speeds;
    /// Rules of step control; 0: the usual ones. A next step that differs from the last by a factor
    /// between steady[0] and steady[1] is not made: it would cost a factorisation.
    double most_growth, steady[2];
    const void *coefficients; // of families of methods
    /// The private workspace for a run. What it keeps from step to step begins with `restart` and
    /// moves on with `accept`; both may be NULL.
    void *(*create)(struct ct_arena *a, const struct ct_method *method,
                    const struct ct_problem *p);
    /// Before the first step and after each event: nothing is known of the time before.
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
    /// h times the rate of the fastest motion that the last two stages of a step have seen, at one
    /// time. Beyond `resolved_limit` the step does not follow that motion but damps it, and `dense`
    /// does not hold inside the step. NULL: it does.
    double resolved_limit;
    double (*stiffness_estimate)(const struct ct_problem *p, double h, const double *y,
                                 const double *y1, void *work);
    /// Up to so much of it a step makes nothing that is damped, or turns, larger; beyond, the
    /// estimate does not see what does. 0: it does.
    double stability_limit;
    /// Called once for a step before its first `dense`: extra stages. May be NULL. With
    /// has_rough_dense, `dense` works without it, too, well enough to find roots.
    bool has_rough_dense;
    enum ct_eval (*prepare)(const struct ct_problem *p, double t, double h, const double *y,
                            const double *y1, void *work, struct ct_integrate_stats *stats);
    /// y (ny, out) at t + theta h, 0 <= theta <= 1, from the step just taken; y1 as it came from
    /// `step`.
    void (*dense)(const struct ct_problem *p, double h, double theta, const double *y,
                  const double *y1, void *work, double *out);
    /// *err (out): what the outputs that amplify err by in that point, where 1 is the tolerance; y
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
/// rtol * max(|y_i|, ...) + atol in each watched state (weighted root mean square) and, with
/// output_error, in outputs. The methods of order 2 among the implicit ones measure coordinates,
/// quadratures and outputs, not speeds.
///
/// With least_rtol, nq and nu, a motion that repeats itself for more than some turns up to t1 is
/// held to a smaller part of the tolerance, see periodic_tolerance.h.
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

/// For over_step: y (ny, out) at t, t0 <= t <= t1, as samples have it but for the projection. gap
/// (out): in the gap of a crossing, where f cannot be computed, what is interpolated there; else
/// its n is 0. False with a diagnostic.
bool ct_step_state(const struct ct_step_view *step, double t, double *y,
                   struct ct_gap_interpolation *gap);

#endif
